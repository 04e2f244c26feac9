"""Joints that are crushed, in limit analysis: a largest normal force at every contact point.

A joint of the plane carries a block of stress: with the width a = N / f_c t its resultant is no
nearer to an edge than a / 2.  It is taken as a row of points, those at the ends with half the area
of the others, of which each carries at most f_c times its area.  Their region of normal force and
moment is a polygon around that of the block: the resultant comes nearer to the edge, by h^2 / 8a at
most, h the distance of the points, and so multipliers are a little high.

For the programs a largest force C is one contact point more, on no block and without friction: it
carries what is left of C, which is not negative, and a row of its own holds the two together.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from drystone.limit.joints import ContactPoints

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Points of a joint that may be crushed: its resultant is known to length^2 / 8192 a.
POINTS = 33


def in_rows(points: ContactPoints) -> ContactPoints:
    """The points of a plane, those of joints that may be crushed as rows of `POINTS` instead.

    The two points of a joint follow each other.
    """
    crushed = np.isfinite(points.crushing)
    if points.dimension == 3:  # joints there are taken as strong, where they matter: `collapse`
        return replace(points, crushing=np.full(points.n_contacts, np.inf))
    if not crushed.any():
        return points
    first = np.flatnonzero(crushed)[::2]
    share = np.linspace(0.0, 1.0, POINTS)
    part = np.full(POINTS, 1.0 / (POINTS - 1))
    part[[0, -1]] *= 0.5
    begin, end = points.position[first, None], points.position[first + 1, None]
    position = (begin + share[:, None] * (end - begin)).reshape(-1, points.dimension)
    area = 2.0 * points.area[first]

    def spread(name: str) -> Any:
        own = getattr(points, name)
        if name == "position":
            more = position
        elif name in ("area", "cohesion", "tension", "crushing"):
            more = (own[first] / points.area[first] * area)[:, None] * part
            more = more.ravel()
        else:
            more = np.repeat(own[first], POINTS, axis=0)
        return np.concatenate((own[~crushed], more))

    return ContactPoints(**{key.name: spread(key.name) for key in fields(ContactPoints)})


def with_rests(points: ContactPoints, still: int) -> tuple[ContactPoints, IntArray]:
    """The points, then one on the body ``still`` for each of those that may be crushed, whose rows
    come too."""
    crushed = np.flatnonzero(np.isfinite(points.crushing))
    n, nothing = len(crushed), np.zeros(len(crushed))
    rest = replace(
        points,
        block_a=np.full(n, still),
        block_b=np.full(n, still),
        position=points.position[crushed],
        frame=points.frame[crushed],
        **dict.fromkeys(("area", "friction", "dilatancy", "cohesion", "tension"), nothing),
        crushing=np.full(n, np.inf),
    )
    both = {
        key.name: np.concatenate((getattr(points, key.name), getattr(rest, key.name)))
        for key in fields(ContactPoints)
    }
    return ContactPoints(**both), crushed


def rows_of(points: ContactPoints, crushed: IntArray, force: float) -> tuple[csc_array, Array]:
    """Rows that hold every such point and its rest together, and their dead load, scaled."""
    n, dim = len(crushed), points.dimension
    row = np.concatenate((np.arange(n), np.arange(n)))
    rest = points.n_contacts - n + np.arange(n)
    column = dim * np.concatenate((crushed, rest))
    matrix = csc_array((np.ones(2 * n), (row, column)), shape=(n, points.n_contacts * dim))
    return matrix, -points.crushing[crushed] / force
