"""Joints that are crushed, in limit analysis: a largest normal force at every contact point.

A crushed joint carries a block of constant stress f_c of width a = N / f_c t, so that its resultant
is no nearer to an edge than a / 2.  Here the joint has many points, of which each carries at most
f_c times its share of the area.  Any stress is distributed to the points by functions that are
linear between points, one at their own point and zero at the others.  This keeps force and moments.
So the possible forces and moments form a polyhedron around those of the stress block.  The
resultant may come nearer to the edge, by h^2 / 8a at most, with the distance h of the points where
the block ends.  So multipliers are slightly too high.

In the plane the points are a row at equal distances.  In space every corner of the joint has a
grid, in the quadrilateral between it, the middles of its two sides and the joint's middle; the
points of a rectangle are at (1 - cos(k pi / n)) / 2 of its sides, so that h^2 / 8a is no more than
(pi / n)^2 / 8 of them, however small a is.

In the programs, a largest force C is represented by a further contact point, on no block and
without friction.  It carries the remaining strength, which is not negative.  A row of its own
states that both forces add up to C.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
from scipy.sparse import csc_array

from drystone.common.arrays import Array, IntArray
from drystone.geometry.patches import spread_over
from drystone.limit.joints import ContactPoints, contact_points, joined
from drystone.model.assembly import Assembly

#: Strength of a point over the heaviest weight from which its rest has a unit of its own.
LARGE = 100.0


def spread(points: ContactPoints) -> ContactPoints:
    """The points of a structure, those of joints that may be crushed as many instead."""
    crushed = np.isfinite(points.crushing)
    if not crushed.any():
        return points
    among = np.flatnonzero(crushed)
    begins = np.flatnonzero(np.diff(points.joint[among], prepend=-1))
    joints = np.split(among, begins[1:])
    found = [spread_over(points.position[corners]) for corners in joints]
    first = np.repeat(among[begins], [len(share) for _, share in found])
    own = {key.name: getattr(points, key.name)[first] for key in fields(ContactPoints)}
    own["position"] = np.concatenate([place for place, _ in found])
    for name in ("area", "cohesion", "tension", "crushing"):
        whole = np.add.reduceat(getattr(points, name)[among], begins)
        own[name] = np.concatenate(
            [total * share for total, (_, share) in zip(whole, found, strict=True)]
        )
    return ContactPoints(
        **{name: np.concatenate((getattr(points, name)[~crushed], own[name])) for name in own}
    )


def n_points(assembly: Assembly) -> int:
    """Number of contact points of the programs; it is the points of joints that may be crushed that
    make large programs of small structures."""
    return spread(contact_points(assembly)).n_contacts


def with_crushing_points(points: ContactPoints, still: int) -> tuple[ContactPoints, IntArray]:
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
        joint=np.full(n, -1),
    )
    return joined(points, rest), crushed


def rows_of(points: ContactPoints, crushed: IntArray, force: float) -> tuple[csc_array, Array]:
    """Rows that couple every such point and its remaining strength, and their dead load, scaled.

    Of points that are stronger than `LARGE` the rest is measured in so much more: programs want
    numbers of the order of one.
    """
    n, dim = len(crushed), points.dimension
    most = points.crushing[crushed] / force
    unit = np.maximum(most / LARGE, 1.0)
    row = np.concatenate((np.arange(n), np.arange(n)))
    rest = points.n_contacts - n + np.arange(n)
    column = dim * np.concatenate((crushed, rest))
    values = np.concatenate((1.0 / unit, np.ones(n)))
    matrix = csc_array((values, (row, column)), shape=(n, points.n_contacts * dim))
    return matrix, -most / unit
