"""Which blocks have left the structure for good.

A structure at rest does not depend on them: nothing touches them, and they touch nothing as they
leave.  An engine takes them out of the balance and continues with the other blocks.
"""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.contact import measures as kernels
from drystone.contact.contacts import Pairs, Slots
from drystone.contact.detection import Detector
from drystone.engines.base import Problem
from drystone.engines.measures import LoadArrays
from drystone.geometry.motion import translations


def departing(
    problem: Problem,
    detector: Detector,
    loads: LoadArrays,
    pose: Array,
    multiplier: float,
    pairs: Pairs,
    slots: Slots,
    reaction: Array,
    tied: IntArray | None = None,
) -> BoolArray:
    """Blocks that leave, (n,), of those that are there.

    No support carries them, directly or through other blocks, and no other block lies on the
    straight line along which the loads move them, above the ground; or they are below it already.

    Parameters
    ----------
    loads
        Of the blocks that are there; zero, and fixed, for others.
    pose
        (n, n_dof) m, rad.
    pairs, slots, reaction
        Contacts in these poses, with normal reactions [N] in column 0 of ``reaction``.
    tied
        (n_ties, 2) bodies that whole ties join.
    """
    part = np.empty(len(pose), np.int64)
    fixed = problem.assembly.fixed | problem.assembly.restrained.any(axis=1)
    if not kernels.mark_loose(pairs, slots, reaction, fixed | loads.fixed, part):
        return np.zeros(len(pose), np.bool_)
    for one, other in [] if tied is None else tied.tolist():
        part[part == part[other]] = part[one]
    loose = ~np.isin(part, part[fixed]) & ~loads.fixed
    top = detector.extents(pose, problem.assembly.up[None])[1][:, 0]
    there = ~loads.fixed | fixed
    obstacle = there & (top > problem.level)
    force = translations(loads.dead + multiplier * loads.pattern)
    leaving = loose.copy()
    blocked = True
    while blocked:  # by blocks that seemed to leave themselves
        blocked = False
        for number in np.unique(part[leaving]):
            members = part == number
            rest = obstacle & ~leaving
            if (obstacle & members).any() and not _way_is_clear(
                detector, pose, members, rest, force[members].sum(axis=0)
            ):
                leaving &= ~members
                blocked = True
    return leaving


def _way_is_clear(
    detector: Detector, pose: Array, members: BoolArray, rest: BoolArray, force: Array
) -> bool:
    """Whether bodies that move along a force touch no other body, judged by boxes along it."""
    length = float(np.linalg.norm(force))
    if length == 0.0:
        return False
    axes = np.linalg.qr(np.column_stack((force / length, np.eye(len(force)))))[0].T
    axes[0] = force / length
    lower, upper = detector.extents(pose, axes)
    first, last = lower[members].min(axis=0), upper[members].max(axis=0)
    beside = (upper[:, 1:] <= first[1:]) | (lower[:, 1:] >= last[1:])
    behind = upper[:, 0] <= first[0]
    return not bool((rest & ~behind & ~beside.any(axis=1)).any())
