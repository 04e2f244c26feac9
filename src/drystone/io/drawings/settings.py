"""How a file of another program is read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from drystone.geometry.mended import FANS

#: Largest distance by which vertices are moved: of solids over the shortest edge of their block, of
#: outlines over their least width, see `outlines.measure_of`.
TOLERANCE = 0.02


@dataclass(frozen=True, kw_only=True)
class ImportSettings:
    """How a file is read. Settings that the file itself contains may be left out."""

    file: Path
    format: str | None = None  # by the file's ending
    unit: str | None = None  # of its numbers: "m", "cm", "mm", "in", "ft"
    up: str | None = None  # the axis that points up in it: "z" or "y"
    material: str | None = None  # of what lies on no layer that a material is named after
    support: tuple[str, ...] = ()  # ids, groups or layers, * for any letters and ? for one
    support_below: float | None = None  # m; blocks that reach below this height are supports
    tolerance: float = TOLERANCE  # over the shortest edge, in the plane the least width, of a block
    bent_faces: str = FANS  # in space, how faces are cut that are farther off a plane: "fans" from
    # their first corners, as programs that draw do, or along their "bends"
    overlap: float = 0.0  # m, up to which faces that stand in each other are put in one plane, in
    # the plane corners made one, and what is left is cut off, where the tolerance is less
    name: str | None = None  # goes before the ids, "name/..."
    group: str | None = None  # that all blocks belong to
    origin: tuple[float, ...] = ()  # m, where the drawing's origin is put
    rotation: tuple[float, ...] = ()  # degrees: in space one about z, or three about x, y and z
