"""Branches of the joint law.  In each branch, reactions are linear in the trial reactions.

A branch states two things: the state of the normal reaction (WITHIN its limits, TORN at the
tension, or CRUSHED), and how the joint slips.  Contacts that are open, or that have an intact bond,
do not slip.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit

#: Open; sticking; sliding under positive and under negative shear; with an intact bond.  In space,
#: shear is taken by its size, so that all sliding contacts are FORWARD.
OPEN, STICKING, FORWARD, BACKWARD, BONDED = 0, 1, 2, 3, 4
TORN_STICKING, TORN_FORWARD, TORN_BACKWARD = 5, 6, 7
CRUSHED_STICKING, CRUSHED_FORWARD, CRUSHED_BACKWARD = 8, 9, 10
N_BRANCHES = 11

#: State of the normal reaction.
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
    """The branch with the same state of shear that is neither torn nor crushed."""
    return _ALONG[branch]


@njit(cache=True, error_model="numpy")
def across_joint(branch):
    """State of the normal reaction: WITHIN, TORN or CRUSHED."""
    return ACROSS[branch]


@njit(cache=True, error_model="numpy")
def both(across, along):
    """The branch with the state ``across`` of the normal reaction (WITHIN, TORN, CRUSHED) and the
    state ``along`` of shear (OPEN, STICKING, FORWARD, BACKWARD)."""
    return _BOTH[across, along]


@njit(cache=True, error_model="numpy")
def sense(branch):
    """1 if a contact slides under positive shear, -1 if under negative shear, else 0."""
    return _SENSE[branch]
