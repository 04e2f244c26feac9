"""What acts on a structure: dead loads, and the pattern that the load multiplier scales."""

from drystone.loading.acceleration import Acceleration, AccelerationPattern
from drystone.loading.acting import Acting, dead_load
from drystone.loading.base import NO_MASSES, DeadLoad, LoadPattern, Masses, masses_of
from drystone.loading.dead import FaceLoad, FillLoad, ForceLoad, SurchargeLoad
from drystone.loading.dead_forces import DeadForces
from drystone.loading.forces import ForcesPattern
from drystone.loading.mass import MassPattern
from drystone.loading.modal import ModalPattern, Mode
from drystone.loading.still import NoPattern
from drystone.loading.targets import PointForce
from drystone.loading.tilt import TiltPattern
from drystone.loading.triangular import TriangularPattern
from drystone.loading.uniform import UniformPattern

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
    "masses_of",
]
