"""Models put together in Python: builders of every kind, placed and made one, the benchmark."""

from drystone.builders.arch import circular_arch
from drystone.builders.column import column, stack
from drystone.builders.describe import model_to_dict
from drystone.builders.errors import ModelError
from drystone.builders.extrude import extruded
from drystone.builders.kinds.arch import arch
from drystone.builders.kinds.barrel_vault import barrel_vault
from drystone.builders.kinds.bridge import bridge
from drystone.builders.kinds.buttress import buttress
from drystone.builders.kinds.dome import dome
from drystone.builders.kinds.drum_column import drum_column
from drystone.builders.kinds.groin_vault import groin_vault
from drystone.builders.kinds.openings import Opening
from drystone.builders.kinds.panel import panel
from drystone.builders.kinds.placing import placed
from drystone.builders.kinds.plan import plan
from drystone.builders.kinds.portal import portal
from drystone.builders.kinds.pyramid import pyramid
from drystone.builders.kinds.rubble import rubble
from drystone.builders.kinds.spiral import spiral
from drystone.builders.kinds.tower import tower
from drystone.builders.model import make_model
from drystone.builders.published import PUBLISHED_WALLS, PublishedWall, published_wall
from drystone.builders.wall import coursed_wall

__all__ = [
    "PUBLISHED_WALLS",
    "ModelError",
    "Opening",
    "PublishedWall",
    "arch",
    "barrel_vault",
    "bridge",
    "buttress",
    "circular_arch",
    "column",
    "coursed_wall",
    "dome",
    "drum_column",
    "extruded",
    "groin_vault",
    "make_model",
    "model_to_dict",
    "panel",
    "placed",
    "plan",
    "portal",
    "published_wall",
    "pyramid",
    "rubble",
    "spiral",
    "stack",
    "tower",
]
