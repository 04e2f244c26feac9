"""What acts on a structure: dead loads, and the pattern that the load multiplier scales."""

from drystone.model.loading.acceleration import Acceleration, AccelerationPattern
from drystone.model.loading.acting import Acting, dead_load
from drystone.model.loading.base import (
    NO_MASSES,
    DeadLoad,
    LoadPattern,
    Masses,
    dead_words,
    masses_of,
    stages_of,
)
from drystone.model.loading.dead import FaceLoad, FillLoad, ForceLoad, SurchargeLoad
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.loading.forces import ForcesPattern
from drystone.model.loading.mass import MassPattern
from drystone.model.loading.modal import ModalPattern, Mode
from drystone.model.loading.still import NoPattern
from drystone.model.loading.targets import PointForce
from drystone.model.loading.tilt import TiltPattern
from drystone.model.loading.triangular import TriangularPattern
from drystone.model.loading.uniform import UniformPattern

__all__ = [
    "NO_MASSES",
    "Acceleration",
    "AccelerationPattern",
    "Acting",
    "DeadForces",
    "DeadLoad",
    "FaceLoad",
    "FillLoad",
    "ForceLoad",
    "ForcesPattern",
    "LoadPattern",
    "MassPattern",
    "Masses",
    "ModalPattern",
    "Mode",
    "NoPattern",
    "PointForce",
    "SurchargeLoad",
    "TiltPattern",
    "TriangularPattern",
    "UniformPattern",
    "dead_load",
    "dead_words",
    "masses_of",
    "stages_of",
]
