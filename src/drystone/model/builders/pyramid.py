"""Stepped pyramids of whole units."""

from __future__ import annotations

from typing import Annotated

from drystone.model.assembly import Block
from drystone.model.builders.base import Builder, Count, Pair, UnitsAlongY
from drystone.model.builders.stones import Mason, at_least, unit_problems
from drystone.model.construction.errors import ModelError


def pyramid(
    *,
    side: Annotated[Count, "units of the lowest course"],
    unit: Annotated[Pair, "[length, height] of a unit in metres"],
    unit_weight: float,
    courses: Count | None = None,
    depth: UnitsAlongY = None,
    material: str = "",
) -> list[Block]:
    """Courses of whole units, each one unit shorter than that below and set back by half of one.

    Parameters
    ----------
    side
        Units of the lowest course along x, the first at the origin.
    unit
        Length and height of a unit [m]; in space as wide as long.
    unit_weight
        N/m3.
    courses
        How many; up to a single row by default, which is the most.
    depth
        Units of the lowest course along y; none in the plane.

    Returns
    -------
    list of Block
        ``c{course}u{number}``, in space ``c{course}u{number}r{row}``.  Groups are "course 1", ...

    Raises
    ------
    ModelError
        There are no units, or more courses than the lowest one bears.
    """
    most = side if depth is None else min(side, depth)
    problems = unit_problems(unit) + at_least(1, side=side)
    if depth is not None:
        problems += at_least(1, depth=depth)
    courses = most if courses is None else courses
    if not problems and not 1 <= courses <= most:
        nearest = min(max(courses, 1), most)
        problems.append(f"courses: {courses} do not fit: the nearest that fits is {nearest}")
    if problems:
        raise ModelError(problems)
    mason = Mason(unit_weight=unit_weight, material=material)
    length, height = unit
    made = []
    for k in range(courses):
        shift, low, high = 0.5 * k * length, k * height, (k + 1) * height
        group = f"course {k + 1}"
        for i in range(side - k):
            x0, x1 = shift + i * length, shift + (i + 1) * length
            name = f"c{k + 1}u{i + 1}"
            if depth is None:
                made.append(mason.box(name, (x0, low), (x1, high), group))
                continue
            for j in range(depth - k):
                y0, y1 = shift + j * length, shift + (j + 1) * length
                made.append(mason.box(f"{name}r{j + 1}", (x0, y0, low), (x1, y1, high), group))
    return made


PYRAMID = Builder(make=pyramid)
