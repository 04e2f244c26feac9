"""Limit analysis: the load under which rigid blocks collapse, and their mechanism."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from drystone.limit.beside import (
    Beside,
    limits_beside,
    multiplier_text,
    on_what_moves,
    range_text,
)
from drystone.limit.flows import ASSOCIATIVE, FLOWS, NON_ASSOCIATIVE

if TYPE_CHECKING:
    from drystone.limit.collapse import (
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

#: Modules of the other names.  They take long to import, so they are imported when a name is used.
_PLACES = {
    "Collapse": "collapse",
    "NonAssociativeSettings": "non_associative",
    "at_rest": "collapse",
    "collapse_load": "collapse",
    "collapse_loads": "collapse",
    "default_paths": "collapse",
    "is_locked": "collapse",
    "least_standing": "search",
    "stands": "collapse",
    "watched": "watch",
}

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
    "multiplier_text",
    "on_what_moves",
    "range_text",
    "stands",
    "watched",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
