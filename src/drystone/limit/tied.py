"""Ties in limit analysis: bars with a strength, in their designed directions.

A tie carries T between -S or zero and its strength S.  For the programs it is two contact points
without friction.  The first, between its two blocks, has the normal force -T and the tensile
strength S.  The second is on no block and carries T less the least T, which is not negative; a row
of its own in the balance couples the two.  Elongation and pretension do not count.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_array

from drystone.common.arrays import Array
from drystone.geometry.motion import couple_about
from drystone.limit.joints import ContactPoints, joined
from drystone.model.assembly import Assembly
from drystone.model.ties import Tie, TieEnd
from drystone.model.ties import spring as spring_between

#: Strength of what has none, such as springs, over the weight of all blocks.  Where it is reached,
#: there is no finite multiplier.
UNBOUNDED = 1e3

#: How far off a bar is that holds a rotation, over the block's radius of gyration: its force is no
#: more than the share of a billionth, and all but a couple.
FAR = 1e9


def with_ties(
    points: ContactPoints, assembly: Assembly, ties: Sequence[Tie], lever: Array
) -> ContactPoints:
    """The contact points, then two for each tie: first the ones between blocks, then the others.

    Forces of ties are measured in units that are one over the ``lever`` (n_ties,).
    """
    n, dim = len(ties), points.dimension
    if n == 0:
        return points
    along = np.array([np.subtract(tie.end.point, tie.start.point) / tie.length for tie in ties])
    frame = np.zeros((n, dim, dim))
    frame[:, 0] = along / lever[:, None]
    nothing, still = np.zeros(n), np.full(n, int(np.flatnonzero(assembly.fixed)[0]))
    weight = float(assembly.weight[~assembly.fixed].sum())
    strength = np.array([min(tie.strength, UNBOUNDED * weight) for tie in ties])
    common = {
        "position": np.array([np.asarray(tie.start.point, float) for tie in ties]),
        "frame": frame,
        **dict.fromkeys(("area", "friction", "dilatancy", "cohesion"), nothing),
        "crushing": np.full(n, np.inf),
        "joint": np.full(n, -1),
    }
    first = ContactPoints(
        block_a=np.array([tie.start.row(assembly) for tie in ties]),
        block_b=np.array([tie.end.row(assembly) for tie in ties]),
        tension=strength,
        **common,
    )
    second = ContactPoints(block_a=still, block_b=still, tension=nothing, **common)
    return joined(points, first, second)


def rollers(assembly: Assembly) -> tuple[tuple[Tie, ...], Array]:
    """Bars to the ground that restrain what rollers restrain, as designed, and the lever of each.

    A rotation is restrained by a bar so far away that it acts as a couple: a nearer bar would
    restrain the block's motion along it as well.
    """
    dim = assembly.dimension
    found, levers = [], []
    for i, k in np.argwhere(assembly.restrained).tolist():
        axis, arm = np.eye(dim)[k % dim], np.zeros(dim)
        if k >= dim:
            axis, arm = couple_about(k - dim, dim)
            arm = FAR * arm
        at = assembly.centroid[i] + arm * np.sqrt(assembly.mass[i, dim] / assembly.mass[i, 0])
        block = assembly.ids[i]
        found.append(
            spring_between(
                start=TieEnd(block=block, point=at), end=TieEnd(point=at + axis), stiffness=1.0
            )
        )
        levers.append(1.0 if k < dim else FAR)
    return tuple(found), np.array(levers)


def rows_of(ties: Sequence[Tie], points: ContactPoints, force: float) -> tuple[csc_array, Array]:
    """Rows that hold the two points of every tie together, and their dead load, scaled."""
    n, dim = len(ties), points.dimension
    first = (points.n_contacts - 2 * n + np.arange(n)) * dim
    row = np.concatenate((np.arange(n), np.arange(n)))
    column = np.concatenate((first, first + n * dim))
    matrix = csc_array((np.ones(2 * n), (row, column)), shape=(n, points.n_contacts * dim))
    strength = points.tension[points.n_contacts - 2 * n : points.n_contacts - n]
    least = np.where([tie.compression for tie in ties], -strength, 0.0)
    return matrix, least / force
