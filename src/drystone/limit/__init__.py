"""Limit analysis: the load that brings rigid blocks down, and how."""

from drystone.limit.beside import Beside, limits_beside, on_what_moves, range_text
from drystone.limit.collapse import (
    ASSOCIATIVE,
    FLOWS,
    NON_ASSOCIATIVE,
    Collapse,
    at_rest,
    collapse_load,
    collapse_loads,
    default_paths,
    is_locked,
    stands,
)
from drystone.limit.non_associative import NonAssociativeSettings
from drystone.limit.search import least_standing
from drystone.limit.watch import watched

__all__ = [
    "ASSOCIATIVE",
    "FLOWS",
    "NON_ASSOCIATIVE",
    "Beside",
    "Collapse",
    "NonAssociativeSettings",
    "at_rest",
    "collapse_load",
    "collapse_loads",
    "default_paths",
    "is_locked",
    "least_standing",
    "limits_beside",
    "on_what_moves",
    "range_text",
    "stands",
    "watched",
]
