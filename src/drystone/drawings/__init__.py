"""Geometry from elsewhere: files of drawing and modelling programs as blocks, and back."""

from drystone.drawings.blocks import TOLERANCE, Imported, ImportSettings, imported
from drystone.drawings.drawing import UNITS, Drawing, Shape
from drystone.drawings.formats import FORMATS, format_of, read_drawing

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
