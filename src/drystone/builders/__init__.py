"""Models put together in Python: coursed walls, arches, columns, the published benchmark."""

from drystone.builders.arch import circular_arch
from drystone.builders.column import column, stack
from drystone.builders.describe import model_to_dict
from drystone.builders.errors import ModelError
from drystone.builders.extrude import extruded
from drystone.builders.model import make_model
from drystone.builders.published import PUBLISHED_WALLS, PublishedWall, published_wall
from drystone.builders.wall import coursed_wall

__all__ = [
    "PUBLISHED_WALLS",
    "ModelError",
    "PublishedWall",
    "circular_arch",
    "column",
    "coursed_wall",
    "extruded",
    "make_model",
    "model_to_dict",
    "published_wall",
    "stack",
]
