"""Joints with tension and crushing: pieces of the law beyond those of dry joints.

Within a step all strengths of a contact are constants (see `law.strengths` for how they fall),
with the tension that it can take f, its cohesion c and its crushing strength C, all in newtons:

    -f <= r_n <= C,        |r_t| <= mu r_n + c.

Everything is counted from the tension on, r_n' = r_n + f, with the trial reaction k_n (d - g) + f:

    0 <= r_n' <= C + f,    |r_t| <= mu r_n' + k,        k = c - mu f >= 0.

With k = 0 and without C that is the dry joint.  Otherwise a contact may be torn, r_n' = 0, or
crushed, r_n' = C + f, and in either it sticks, or slides under positive or negative shear with a
friction that does not change.  Joints that dilate are not among them.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import BRANCH_TIE
from drystone.contact.contacts import CRUSH, FRICTION, INTERCEPT, TRIAL_N
from drystone.law.branches import CRUSHED, TORN, WITHIN, across_joint


@njit(cache=True, error_model="numpy")
def crushing(table, c):
    """The normal reaction, from the tension on, at which a contact is crushed; or infinity."""
    return table[c, CRUSH] if table[c, CRUSH] > 0.0 else np.inf


@njit(cache=True, error_model="numpy")
def limited_normal(table, c, branch):
    """The normal reaction, from the tension on, in a branch without dilatancy."""
    across = across_joint(branch)
    if across == CRUSHED:
        return crushing(table, c)
    return 0.0 if across == TORN else table[c, TRIAL_N]


@njit(cache=True, error_model="numpy")
def friction_in(table, c, branch):
    """How the largest shear goes with the normal trial reaction in a branch."""
    return table[c, FRICTION] if across_joint(branch) == WITHIN else 0.0


@njit(cache=True, error_model="numpy")
def yields(table, c):
    """Whether a contact pulls, or its trial reaction is for crushing it."""
    return table[c, INTERCEPT] > 0.0 or table[c, TRIAL_N] > crushing(table, c) * (1.0 - BRANCH_TIE)
