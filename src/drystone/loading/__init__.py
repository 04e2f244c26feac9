"""What acts on a structure: dead loads, and the pattern that the load multiplier scales."""

from drystone.loading.acting import Acting, dead_load
from drystone.loading.base import NO_MASSES, DeadLoad, LoadPattern, Masses
from drystone.loading.dead_forces import DeadForces
from drystone.loading.mass import MassPattern

__all__ = [
    "NO_MASSES",
    "Acting",
    "DeadForces",
    "DeadLoad",
    "LoadPattern",
    "MassPattern",
    "Masses",
    "dead_load",
]
