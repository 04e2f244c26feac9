"""Joints that pull, and that give way in compression: pieces of the law beyond those of dry joints.

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
from drystone.contact.contacts import CRUSH, FRICTION, ROOM, STIFF_N, STIFF_T, TRIAL_N, TRIAL_T
from drystone.contact.rows import MEASURED, OF_GAP, OF_SLIP
from drystone.law.return_map import (
    BACKWARD,
    BONDED,
    CRUSHED,
    FORWARD,
    OPEN,
    STICKING,
    TIE,
    TORN,
    along_joint,
    branch_for,
    sense,
)


@njit(cache=True, error_model="numpy")
def crushing(table, c):
    """The normal reaction, from the tension on, at which a contact is crushed; or infinity."""
    return table[c, CRUSH] if table[c, CRUSH] > 0.0 else np.inf


@njit(cache=True, error_model="numpy")
def held_normal(table, c, branch):
    """The normal reaction, from the tension on, in a branch without dilatancy."""
    if branch > CRUSHED:
        return crushing(table, c)
    return 0.0 if branch > BONDED else table[c, TRIAL_N]


@njit(cache=True, error_model="numpy")
def friction_in(table, c, branch):
    """How the largest shear goes with the normal trial reaction in a branch."""
    return 0.0 if branch > BONDED else table[c, FRICTION]


@njit(cache=True, error_model="numpy")
def yields(table, c):
    """Whether a contact pulls, or its trial reaction is for crushing it."""
    return table[c, ROOM] > 0.0 or table[c, TRIAL_N] > crushing(table, c) * (1.0 - TIE)


@njit(cache=True, error_model="numpy")
def distance_beyond(table, c, now, rate_n, rate_t, whole):
    """How far along the direction a contact leaves its branch, and for which one; see
    `law.distance`."""
    rn, rt, crush = table[c, TRIAL_N], table[c, TRIAL_T], crushing(table, c)
    t = along_joint(now) if now != OPEN else STICKING
    nearest, following = np.inf, now
    if now == OPEN or BONDED < now <= CRUSHED:
        if rate_n > 0.0:
            nearest, following = max(-rn, 0.0) / rate_n, t
    elif now > CRUSHED:
        if rate_n < 0.0:
            nearest, following = max(rn - crush, 0.0) / -rate_n, t
    elif rate_n < 0.0:
        nearest, following = max(rn, 0.0) / -rate_n, t + TORN
        if table[c, ROOM] == 0.0:
            following = OPEN
    elif rate_n > 0.0 and crush < np.inf:
        nearest, following = max(crush - rn, 0.0) / rate_n, t + CRUSHED
    state, slope, sign = now - t, friction_in(table, c, now), sense(now)
    most = table[c, FRICTION] * held_normal(table, c, now) + table[c, ROOM]
    if sign != 0.0:
        speed = slope * rate_n - sign * rate_t
        if whole and speed > 0.0:
            far = max(sign * rt - most, 0.0) / speed
            if far < nearest:
                nearest, following = far, state + STICKING
        return nearest, following
    for sliding in range(FORWARD, BACKWARD + 1):
        sign = 1.0 if sliding == FORWARD else -1.0
        speed = sign * rate_t - slope * rate_n
        if speed > 0.0:
            far = max(most - sign * rt, 0.0) / speed
            if far < nearest:
                nearest, following = far, state + sliding
    return nearest, following


@njit(cache=True, error_model="numpy")
def landing_beyond(table, c, now):
    """`law.landing` of a contact that `yields`."""
    rt = table[c, TRIAL_T]
    there, was = (
        branch_for(
            table[c, TRIAL_N], abs(rt), table[c, STIFF_T], table[c, FRICTION], 0.0, table[c, ROOM],
            crushing(table, c), OPEN, FORWARD if rt > 0.0 else BACKWARD,
        ),
        along_joint(now),
    )  # fmt: skip
    t = along_joint(there)
    if was + t == FORWARD + BACKWARD and was != t and was != OPEN and t != STICKING:
        return there - t + STICKING
    return there


@njit(cache=True, error_model="numpy")
def change_beyond(table, rows, c, before, after, u, v, k):
    """`law.change` of a contact that comes from or goes to a torn or crushed branch."""
    kn, kt, mu = table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION]
    was, now = along_joint(before), along_joint(after)
    if before - was != after - now:  # another state of the normal reaction
        turn = 1.0 if after <= BONDED else -1.0
        slope = sense(before) * mu
        for i in range(u.shape[0]):
            u[i] = turn * (rows[c, OF_GAP, i] + slope * rows[c, OF_SLIP, i])
            v[k, 0, i] = kn * rows[c, OF_GAP, i]
        return
    turn = 1.0 if was == STICKING else -1.0
    slope = (sense(before) + sense(after)) * friction_in(table, c, before)
    for i in range(u.shape[0]):
        u[i] = turn * rows[c, OF_SLIP, i]
        v[k, 0, i] = slope * kn * rows[c, OF_GAP, i] - kt * rows[c, MEASURED, i]


@njit(cache=True, error_model="numpy")
def central_normal(trial, crush, product):
    """The normal reaction r in (0, C) with r - product (1 / r - 1 / (C - r)) = trial."""
    low, high = 0.0, crush
    r = min(max(trial, 0.25 * crush), 0.75 * crush)
    for _ in range(80):
        missing = trial - r + product / r - product / (crush - r)
        if missing > 0.0:
            low = r
        else:
            high = r
        nearer = r + missing / (1.0 + product / r**2 + product / (crush - r) ** 2)
        if not low < nearer < high:
            nearer = 0.5 * (low + high)
        done = abs(nearer - r) <= 1e-14 * r
        r = nearer
        if done:
            break
    return r
