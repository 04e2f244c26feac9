"""drystone: pushover curves of masonry made of blocks, past the peak and down to nothing."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from drystone.analysis import pushover
    from drystone.builders import published_wall
    from drystone.curve import CapacityCurve, CurvePoint
    from drystone.limit import Collapse, collapse_load
    from drystone.model import Model
    from drystone.modelfile import ModelError, read_model, write_model

# Heavy imports wait until a name is used, so that the command line starts at once.
_PLACES = {
    "CapacityCurve": "drystone.curve",
    "Collapse": "drystone.limit",
    "CurvePoint": "drystone.curve",
    "Model": "drystone.model",
    "ModelError": "drystone.modelfile",
    "collapse_load": "drystone.limit",
    "published_wall": "drystone.builders",
    "pushover": "drystone.analysis",
    "read_model": "drystone.modelfile",
    "write_model": "drystone.modelfile",
}

__all__ = [*_PLACES, "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'drystone' has no attribute {name!r}")
    return getattr(import_module(_PLACES[name]), name)
