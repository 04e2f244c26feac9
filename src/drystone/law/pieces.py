"""Transitions between the branches of the joint law, for following one change after the other.

These kernels calculate the length along a direction at which a contact leaves its branch, the
branch that it takes, and the change of the stiffness matrix, a product u v^T.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    INTERCEPT,
    LIFT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.contact.rows import MEASURED, OF_GAP, OF_SLIP
from drystone.law.branches import (
    BACKWARD,
    BONDED,
    CRUSHED,
    FORWARD,
    OPEN,
    STICKING,
    TORN,
    WITHIN,
    across_joint,
    along_joint,
    both,
    sense,
)
from drystone.law.limits import crushing, friction_in, limited_normal


@njit(cache=True, error_model="numpy")
def distance(table, c, now, rate_n, rate_t, whole):
    """Length along the direction at which contact c leaves its branch ``now``, and the branch that
    it takes; infinite if it stays.

    ``rate_n`` and ``rate_t`` [N] are the changes of its trial reactions along the direction.  With
    ``whole``, sliding counts over the whole step, so that a contact may also slide back.
    """
    if across_joint(now) != WITHIN or (table[c, INTERCEPT] > 0.0 and now != BONDED):
        return distance_beyond(table, c, now, rate_n, rate_t, whole)
    nearest, following = distance_of_dry(table, c, now, rate_n, rate_t, whole)
    crush = crushing(table, c)
    if crush < np.inf and now != OPEN and now != BONDED and rate_n > 0.0:
        far = max(crush - table[c, TRIAL_N], 0.0) / rate_n
        if far < nearest:
            return far, both(CRUSHED, now)
    return nearest, following


@njit(cache=True, error_model="numpy")
def all_dry(table, count):
    """Whether all contacts are dry: without a cohesion intercept, and never crushed."""
    beyond = 0
    for c in range(count):
        beyond += table[c, INTERCEPT] > 0.0 or table[c, CRUSH] > 0.0
    return beyond == 0


@njit(cache=True, error_model="numpy")
def distance_of_dry(table, c, now, rate_n, rate_t, whole):
    rn, rt = table[c, TRIAL_N], table[c, TRIAL_T]
    kt, mu, lift = table[c, STIFF_T], table[c, FRICTION], table[c, LIFT]
    nearest = np.inf
    following = now
    if now == BONDED:
        return nearest, following
    if now == FORWARD or now == BACKWARD:
        sign = 1.0 if now == FORWARD else -1.0
        speed = mu * rate_n - sign * rate_t
        if speed > 0.0 and whole:
            nearest = max(sign * rt - mu * rn, 0.0) / speed
            following = STICKING
        speed = -(kt * rate_n + lift * sign * rate_t)
        if speed > 0.0:
            far = max(kt * rn + lift * sign * rt, 0.0) / speed
            if far < nearest:
                nearest = far
                following = OPEN
        return nearest, following
    for sliding in range(FORWARD, BACKWARD + 1):
        sign = 1.0 if sliding == FORWARD else -1.0
        if now == OPEN:
            speed = kt * rate_n + lift * sign * rate_t
            far = max(-kt * rn - lift * sign * rt, 0.0)
        else:
            speed = sign * rate_t - mu * rate_n
            far = max(mu * rn - sign * rt, 0.0)
        if not speed > 0.0:
            continue
        far /= speed
        if now == OPEN and sign * (rt + far * rate_t if whole else rate_t) < 0.0:
            continue
        if far < nearest:
            nearest = far
            following = sliding
    return nearest, following


@njit(cache=True, error_model="numpy")
def change(table, rows, c, before, after, u, v, k):
    """Fill ``u`` (2 n_dof,) and ``v[k, 0]`` (2 n_dof,): the matrix changes by u v^T if contact c
    changes from the branch ``before`` to ``after``."""
    if across_joint(before) != WITHIN or across_joint(after) != WITHIN:
        change_beyond(table, rows, c, before, after, u, v, k)
        return
    sliding = before if sense(before) != 0.0 else after
    sign = 1.0 if sliding == FORWARD else -1.0
    kn, kt, mu, lift = table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION], table[c, LIFT]
    along = kt + mu * lift
    if before == OPEN or after == OPEN:
        turn = -1.0 if before == OPEN else 1.0
        for i in range(u.shape[0]):
            u[i] = turn * (rows[c, OF_GAP, i] + sign * mu * rows[c, OF_SLIP, i])
            slid = mu * kn * rows[c, OF_GAP, i] - sign * kt * rows[c, MEASURED, i]
            v[k, 0, i] = lift * slid / along - kn * rows[c, OF_GAP, i]
        return
    turn = 1.0 if before == STICKING else -1.0
    for i in range(u.shape[0]):
        u[i] = turn * (sign * kt * rows[c, OF_SLIP, i] - lift * rows[c, OF_GAP, i])
        slid = mu * kn * rows[c, OF_GAP, i] - sign * kt * rows[c, MEASURED, i]
        v[k, 0, i] = slid / along


@njit(cache=True, error_model="numpy")
def distance_beyond(table, c, now, rate_n, rate_t, whole):
    """`distance` of a contact with a cohesion intercept, or in a torn or crushed branch."""
    rn, rt, crush = table[c, TRIAL_N], table[c, TRIAL_T], crushing(table, c)
    across, along = across_joint(now), along_joint(now) if now != OPEN else STICKING
    nearest, following = np.inf, now
    if now == OPEN or across == TORN:
        if rate_n > 0.0:
            nearest, following = max(-rn, 0.0) / rate_n, along
    elif across == CRUSHED:
        if rate_n < 0.0:
            nearest, following = max(rn - crush, 0.0) / -rate_n, along
    elif rate_n < 0.0:
        torn = both(TORN, along) if table[c, INTERCEPT] > 0.0 else OPEN
        nearest, following = max(rn, 0.0) / -rate_n, torn
    elif rate_n > 0.0 and crush < np.inf:
        nearest, following = max(crush - rn, 0.0) / rate_n, both(CRUSHED, along)
    if now == OPEN:
        return nearest, following
    slope, sign = friction_in(table, c, now), sense(now)
    most = table[c, FRICTION] * limited_normal(table, c, now) + table[c, INTERCEPT]
    if sign != 0.0:
        speed = slope * rate_n - sign * rate_t
        if whole and speed > 0.0:
            far = max(sign * rt - most, 0.0) / speed
            if far < nearest:
                nearest, following = far, both(across, STICKING)
        return nearest, following
    for sliding in range(FORWARD, BACKWARD + 1):
        sign = 1.0 if sliding == FORWARD else -1.0
        speed = sign * rate_t - slope * rate_n
        if speed > 0.0:
            far = max(most - sign * rt, 0.0) / speed
            if far < nearest:
                nearest, following = far, both(across, sliding)
    return nearest, following


@njit(cache=True, error_model="numpy")
def change_beyond(table, rows, c, before, after, u, v, k):
    """`change` for a contact that comes from, or goes to, a torn or crushed branch."""
    kn, kt, mu = table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION]
    if across_joint(before) != across_joint(after):
        turn = 1.0 if across_joint(after) == WITHIN else -1.0
        slope = sense(before) * mu
        for i in range(u.shape[0]):
            u[i] = turn * (rows[c, OF_GAP, i] + slope * rows[c, OF_SLIP, i])
            v[k, 0, i] = kn * rows[c, OF_GAP, i]
        return
    turn = 1.0 if along_joint(before) == STICKING else -1.0
    slope = (sense(before) + sense(after)) * friction_in(table, c, before)
    for i in range(u.shape[0]):
        u[i] = turn * rows[c, OF_SLIP, i]
        v[k, 0, i] = slope * kn * rows[c, OF_GAP, i] - kt * rows[c, MEASURED, i]
