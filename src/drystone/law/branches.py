"""Branches of the joint law: in each of them reactions go straight with the trial reactions.

A branch says two things: what becomes of the normal reaction (WITHIN its limits, TORN at the
tension, CRUSHED), and how the joint slips.  Contacts that are open, or that have an intact bond, do
not slip.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit

#: Open, sticking, sliding under positive and under negative shear, with an intact bond.  With two
#: tangential components what slides does so under positive shear: that is its size.
OPEN, STICKING, FORWARD, BACKWARD, BONDED = 0, 1, 2, 3, 4
TORN_STICKING, TORN_FORWARD, TORN_BACKWARD = 5, 6, 7
CRUSHED_STICKING, CRUSHED_FORWARD, CRUSHED_BACKWARD = 8, 9, 10
N_BRANCHES = 11

#: What becomes of the normal reaction.
WITHIN, TORN, CRUSHED = 0, 1, 2

_ALONG = np.array(
    [OPEN, STICKING, FORWARD, BACKWARD, BONDED, *2 * (STICKING, FORWARD, BACKWARD)], np.int64
)
#: WITHIN, TORN or CRUSHED, by branch.
ACROSS = np.array(5 * [WITHIN] + 3 * [TORN] + 3 * [CRUSHED], np.int64)
_BOTH = np.array(
    [
        [OPEN, STICKING, FORWARD, BACKWARD],
        [OPEN, TORN_STICKING, TORN_FORWARD, TORN_BACKWARD],
        [OPEN, CRUSHED_STICKING, CRUSHED_FORWARD, CRUSHED_BACKWARD],
    ],
    np.int64,
)
_SENSE = np.array([0.0, 0.0, 1.0, -1.0, 0.0, *2 * (0.0, 1.0, -1.0)])


@njit(cache=True, error_model="numpy")
def along_joint(branch):
    """The branch as far as it is about shear: that of a joint that is neither torn nor crushed."""
    return _ALONG[branch]


@njit(cache=True, error_model="numpy")
def across_joint(branch):
    """What becomes of the normal reaction: WITHIN, TORN or CRUSHED."""
    return ACROSS[branch]


@njit(cache=True, error_model="numpy")
def both(across, along):
    """The branch of a contact that is WITHIN its limits, TORN or CRUSHED, and OPEN, STICKING or
    sliding FORWARD or BACKWARD."""
    return _BOTH[across, along]


@njit(cache=True, error_model="numpy")
def sense(branch):
    """1 and -1 where a contact slides under positive and under negative shear, else 0."""
    return _SENSE[branch]
