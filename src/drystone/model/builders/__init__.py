"""Models put together in Python: builders of every kind, placed and made one, the benchmark."""

from drystone.model.builders.arch import arch
from drystone.model.builders.barrel_vault import barrel_vault
from drystone.model.builders.bridge import bridge
from drystone.model.builders.buttress import buttress
from drystone.model.builders.circular_arch import circular_arch
from drystone.model.builders.column import column, stack
from drystone.model.builders.dome import dome
from drystone.model.builders.drum_column import drum_column
from drystone.model.builders.groin_vault import groin_vault
from drystone.model.builders.openings import Opening
from drystone.model.builders.panel import panel
from drystone.model.builders.placing import placed
from drystone.model.builders.plan import plan
from drystone.model.builders.portal import portal
from drystone.model.builders.published import PUBLISHED_WALLS, PublishedWall, published_wall
from drystone.model.builders.pyramid import pyramid
from drystone.model.builders.rubble import rubble
from drystone.model.builders.spiral import spiral
from drystone.model.builders.tower import tower
from drystone.model.builders.wall import coursed_wall
from drystone.model.construction.describe import model_to_dict
from drystone.model.construction.errors import ModelError
from drystone.model.construction.extrude import extruded
from drystone.model.construction.model import make_model

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
