"""Limit analysis: the load that brings rigid blocks down, and how."""

from drystone.limit.collapse import (
    ASSOCIATIVE,
    FLOWS,
    NON_ASSOCIATIVE,
    Collapse,
    collapse_load,
    collapse_loads,
    stands,
)
from drystone.limit.non_associative import NonAssociativeSettings
from drystone.limit.search import least_standing

__all__ = [
    "ASSOCIATIVE",
    "FLOWS",
    "NON_ASSOCIATIVE",
    "Collapse",
    "NonAssociativeSettings",
    "collapse_load",
    "collapse_loads",
    "least_standing",
    "stands",
]
