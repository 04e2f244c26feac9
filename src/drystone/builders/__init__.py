"""Models put together in Python: coursed walls, the published benchmark, any set of blocks."""

from drystone.builders.describe import model_to_dict
from drystone.builders.errors import ModelError
from drystone.builders.model import make_model
from drystone.builders.published import PUBLISHED_WALLS, PublishedWall, published_wall
from drystone.builders.wall import coursed_wall

__all__ = [
    "PUBLISHED_WALLS",
    "ModelError",
    "PublishedWall",
    "coursed_wall",
    "make_model",
    "model_to_dict",
    "published_wall",
]
