"""What a number of a model or an analysis may be: one table for files and for Python.

The ranges are generous: anything that a structure or an analysis could have, and nothing whose
squares, quotients or counts a computer cannot hold.
"""

from __future__ import annotations

import math
import numbers
import re
from dataclasses import dataclass
from typing import Any

from drystone.common.names import quoted

_NUMBER = re.compile(r"[-+]?\d+\.?\d*([eE][-+]?\d+)?")


@dataclass(frozen=True, kw_only=True)
class Range:
    """Numbers from `least` to `most`, both allowed."""

    least: float
    most: float
    unit: str = ""  # for messages; "" for a pure number
    whole: bool = False

    def problem(self, value: Any) -> str | None:
        """What is wrong with a value, as the end of a sentence that begins with its key."""
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            return f"must be a number, it is {found(value)}{_without_quotes(value)}"
        try:
            number = float(value)
        except OverflowError:
            return f"must be a number, it is {found(value)}"
        if not math.isfinite(number):
            return f"must be a finite number, it is {number}"
        if self.whole and not number.is_integer():
            return f"must be a whole number, it is {number:g}"
        if number <= 0.0 < self.least < 1.0:
            return f"must be greater than 0, it is {number:g}"
        if number < self.least:
            return f"must be at least {self.least:g}, it is {number:g}{self._mend()}"
        if number > self.most:
            return f"must be at most {self.most:g}, it is {number:g}{self._mend()}"
        return None

    def _mend(self) -> str:
        return f": give it in {self.unit}" if self.unit and self.least else ""


#: Any factor that is one.
POSITIVE = Range(least=1e-9, most=1e9)

#: By the names that files and functions know them under.
RANGES = {
    "thickness": Range(least=1e-6, most=1e6, unit="m"),
    "drawing_tolerance": Range(least=0.0, most=0.05),
    "tolerance": Range(least=0.0, most=0.2),
    "overlap": Range(least=0.0, most=1e3, unit="m"),
    "angle": Range(least=-360.0, most=360.0, unit="degrees"),
    "unit_weight": Range(least=1e-3, most=1e9, unit="N/m3"),
    "density": Range(least=1e-4, most=1e8, unit="kg/m3"),
    "mortar_thickness": Range(least=1e-9, most=1e3, unit="m"),
    "young_modulus": Range(least=1e-3, most=1e20, unit="Pa"),
    "shear_modulus": Range(least=1e-3, most=1e20, unit="Pa"),
    "poisson_ratio": Range(least=0.0, most=0.5),
    "radius": Range(least=0.0, most=1e6, unit="m"),
    "chamfer": Range(least=0.0, most=1e6, unit="m"),
    "unit": Range(least=1e-6, most=1e6, unit="m"),
    "coordinate": Range(least=-1e8, most=1e8, unit="m"),
    "direction": Range(least=-1e9, most=1e9),
    "force": Range(least=-1e15, most=1e15, unit="N"),
    "pressure": Range(least=-1e15, most=1e15, unit="Pa"),
    "acceleration": Range(least=-1e6, most=1e6),
    "stiffness": Range(least=1e-6, most=1e20, unit="N/m"),
    "area": Range(least=1e-12, most=1e6, unit="m2"),
    "yield_force": Range(least=1e-6, most=1e15, unit="N"),
    "pretension": Range(least=-1e15, most=1e15, unit="N"),
    "breaking_elongation": Range(least=1e-9, most=1e6, unit="m"),
    "settlement": Range(least=1e-9, most=1e6),
    "within": Range(least=0.0, most=90.0, unit="degrees"),
    "at_rest": Range(least=0.0, most=10.0),
    "stop_multiplier": Range(least=1e-9, most=1e6),
    "ground": Range(least=-1e8, most=1e8, unit="m"),
    "event_share": Range(least=1e-3, most=1e3),
    "max_penetration": Range(least=1e-6, most=10.0),
    "increment": Range(least=1e-9, most=1e3),
    "overshoot": Range(least=1.0, most=100.0),
    "balance_tolerance": Range(least=1e-12, most=1e3),
    "patience": Range(least=0, most=1_000_000_000, whole=True),
    "bend_share": Range(least=1e-6, most=1.0),
    "jump_steps": Range(least=1, most=1_000_000_000, whole=True),
    "displacement_step": Range(least=1e-9, most=1e6, unit="m"),
    "column_time": Range(least=-1e6, most=1e6, unit="s"),
    "column_value": Range(least=-1e6, most=1e6),
    "time_step": Range(least=1e-9, most=1e6, unit="s"),
    "max_steps": Range(least=1, most=1_000_000_000, whole=True),
    "max_points": Range(least=1, most=1_000_000_000, whole=True),
    "max_time": Range(least=1e-3, most=1e9, unit="s"),
    "max_displacement": Range(least=1e-9, most=1e8, unit="m"),
    "mechanism_displacement": Range(least=0.0, most=1e8, unit="m"),
}


#: Structures of more blocks, in the plane and in space, are left out where limit analysis is only
#: asked beside something else: it would take seconds.
MOST_BLOCKS = {2: 2000, 3: 500}


def most_blocks(dimension: int) -> int:
    """See `MOST_BLOCKS`."""
    return MOST_BLOCKS[dimension]


#: What is counted before any work on it, so that what nobody means is refused at once.  Twice the
#: largest wall that was traced (benchmarks/results/scale.md), and drawings of as many solids with
#: ten vertices and faces each; files have some 300 bytes for each of these.
LARGEST = {
    "blocks": 20_000,
    "vertices": 200_000,
    "faces": 200_000,
    "corners of faces": 1_000_000,  # five of each face
    "rows of elements": 1_000_000,  # of a PLY file: vertices, faces, edges and what else it has
    "entities": 100_000,  # of a drawing, with those that its references stand for
    "reentrant corners": 150,  # of one outline: cutting takes the third power of their number
    "faces of one solid": 5_000,  # with each of which each of its vertices is compared
    "ties": 5_000,
    "dead loads": 5_000,
    "values": 3_000_000,  # and tables of a model file: six coordinates in a row for each vertex
    "keys": 20_000,  # of one table: a material of its own for each block
    "rows": 100_000,  # of a spectrum or a record; 500 s in steps of 5 ms
    "file": 64_000_000,  # bytes
    "name": 200,  # letters
    "displacements of a history": 1_000_000,
}
#: Pairs of boxes that meet, over the number of boxes, from 2 million pairs on: bricks have 6 to 26,
#: and blocks on the same place as many as there are.
CROWDED, CROWD = 500, 2_000_000


def too_many(what: str, count: float) -> str | None:
    """What is wrong with so many of something, as the end of a sentence."""
    most = LARGEST[what]
    if count <= most:
        return None
    return f"has {count:,.0f} {what}, and {most:,} are the most that are read: take a part of it"


def problem(name: str, value: Any) -> str | None:
    """What is wrong with the number of that name, as a sentence "name: must be ..."."""
    found_wrong = RANGES[name].problem(value) if name in RANGES else None
    return None if found_wrong is None else f"{name}: {found_wrong}"


def found(value: Any) -> str:
    """A value as a message shows it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f"the text {quoted(value)}"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, int) and abs(value) > 1e15:
        return "a whole number of too many digits"
    return f"{value:g}" if isinstance(value, int | float) else f"a {type(value).__name__}"


def _without_quotes(value: Any) -> str:
    return ": take the quotes off" if isinstance(value, str) and _NUMBER.fullmatch(value) else ""
