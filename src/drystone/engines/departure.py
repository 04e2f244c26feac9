"""Which blocks have left the structure for good.

The structure at rest does not depend on these blocks: nothing carries them, and they touch no other
block as they leave.  An engine takes them out of the balance, and continues with the other blocks.
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
    """Blocks that leave the structure now, (n,).

    No support carries them, directly or through other blocks.  In addition, either they are below
    the ground already, or no other block lies on the straight line along which the loads move them,
    above the ground.

    Parameters
    ----------
    loads
        Loads on the blocks; blocks that have left before are fixed in them.
    pose
        (n, n_pose) m, rad.
    pairs, slots, reaction
        Contacts in these poses, with normal reactions [N] in column 0 of ``reaction``.
    tied
        (n_ties, 2) bodies that intact ties join.
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
    while blocked:  # a block that stays may block others that seemed to leave
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
    """Whether the bodies ``members`` (n,), moving along a ``force`` (dim,), meet none of the bodies
    ``rest`` (n,); judged by bounding boxes along the force."""
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
