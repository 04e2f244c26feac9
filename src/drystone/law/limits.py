"""Joints with tensile and crushing strength: the branches of the law beyond those of dry joints.

Within a step, all strengths of a contact are constant (see `law.strengths` for their softening).
With its tensile strength f, cohesion c and crushing strength C, all in newtons,

    -f <= r_n <= C,        |r_t| <= mu r_n + c.

Normal reactions are counted from the tension on, r_n' = r_n + f; the trial reaction is
k_n (d - g) + f.  Then

    0 <= r_n' <= C + f,    |r_t| <= mu r_n' + k,        k = c - mu f >= 0.

With k = 0 and without C, this is a dry joint.  Otherwise a contact may also be torn, r_n' = 0, or
crushed, r_n' = C + f.  In both cases it sticks, or it slides under positive or negative shear with
constant friction.  Joints that dilate are neither torn nor crushed.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import CRUSH, FRICTION, TRIAL_N
from drystone.law.branches import CRUSHED, TORN, WITHIN, across_joint


@njit(cache=True, error_model="numpy")
def crushing(table, c):
    """Normal reaction [N], counted from the tension on, at which a contact is crushed; infinity if
    it is not crushed."""
    return table[c, CRUSH] if table[c, CRUSH] > 0.0 else np.inf


@njit(cache=True, error_model="numpy")
def limited_normal(table, c, branch):
    """Normal reaction [N], counted from the tension on, in a branch without dilatancy."""
    across = across_joint(branch)
    if across == CRUSHED:
        return crushing(table, c)
    return 0.0 if across == TORN else table[c, TRIAL_N]


@njit(cache=True, error_model="numpy")
def friction_in(table, c, branch):
    """Derivative of the largest shear by the normal trial reaction in a branch."""
    return table[c, FRICTION] if across_joint(branch) == WITHIN else 0.0
