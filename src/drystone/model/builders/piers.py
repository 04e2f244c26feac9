"""Piers under arches: coursed, with skewbacks where springing joints are not level."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.builders.coursing import Bond, Line
from drystone.model.builders.stones import Mason
from drystone.model.builders.strip import Strip

#: Height of a springing joint, over its length, that counts as none.
LEVEL = 1e-9


# Many, each a fact of the pier.
def pier(
    mason: Mason, unit: Sequence[float], sides: tuple[float, float], height: float,
    depth: float | None, prefix: str, *groups: str,
) -> list[Block]:  # fmt: skip
    """A pier from x to x and from z = 0 to its height [m], in running bond.

    Its courses are cut to fit: the nearest whole number of equal ones.
    """
    n = max(1, round(height / unit[1]))
    strip = Strip(
        mason=mason,
        bond=Bond(name="running", unit=unit[0]),
        thickness=depth,
        prefix=prefix,
        groups=groups,
        anchor=sides[0],
    )
    made: list[Block] = []
    for course in range(n):
        levels = course * height / n, (course + 1) * height / n
        made += strip.course(course, levels, Line(sides[0]), Line(sides[1]))
    return made


def skewback(
    mason: Mason, sides: tuple[float, float], level: float, left: Array | None, right: Array | None,
    depth: float | None, name: str, *groups: str,
) -> list[Block]:  # fmt: skip
    """The stone between a pier's top and springing joints that slope.

    Parameters
    ----------
    left, right
        Outer end of the joint (2,) [m] of the arch that springs from the pier's left and from its
        right side; None where there is no arch.

    Returns
    -------
    list of Block
        None where the joints are level.
    """
    ends = [end for end in (left, right) if end is not None]
    top = max(float(end[1]) for end in ends)
    if top - level <= LEVEL * (sides[1] - sides[0]):
        return []
    outline = [(sides[0], level), (sides[1], level)]
    outline.append((sides[1], top) if right is None else (float(right[0]), top))
    outline.append((sides[0], top) if left is None else (float(left[0]), top))
    corners = np.array(outline)
    if corners[3, 0] >= corners[2, 0] - LEVEL * (sides[1] - sides[0]):  # they meet over the pier
        corners = corners[:3]
    across = None if depth is None else (0.0, depth)
    return [mason.upright(name, corners, across, *groups)]


def springing(joints_outer: Array, inner: Array) -> float:
    """How far a springing joint reaches beyond the intrados along x [m]."""
    return abs(float(joints_outer[0] - inner[0]))
