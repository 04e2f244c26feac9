"""Geometry from elsewhere: files of drawing and modelling programs as blocks, and back."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drystone.io.drawings.blocks import Imported, imported
    from drystone.io.drawings.drawing import UNITS, Drawing, Shape
    from drystone.io.drawings.formats import format_of, read_drawing
    from drystone.io.drawings.registry import FORMATS
    from drystone.io.drawings.settings import TOLERANCE, ImportSettings

#: Where each name is: most models import nothing, and need not wait for it.
_PLACES = {
    "FORMATS": "registry",
    "TOLERANCE": "settings",
    "UNITS": "drawing",
    "Drawing": "drawing",
    "ImportSettings": "settings",
    "Imported": "blocks",
    "Shape": "drawing",
    "format_of": "formats",
    "imported": "blocks",
    "read_drawing": "formats",
}

__all__ = [
    "FORMATS",
    "TOLERANCE",
    "UNITS",
    "Drawing",
    "ImportSettings",
    "Imported",
    "Shape",
    "format_of",
    "imported",
    "read_drawing",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'drystone.io.drawings' has no attribute {name!r}")
    return getattr(import_module(f"drystone.io.drawings.{_PLACES[name]}"), name)
