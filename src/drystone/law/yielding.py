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

#: Branches: open, sticking, sliding under positive and under negative shear, held by a bond.
OPEN, STICKING, FORWARD, BACKWARD, BONDED = 0, 1, 2, 3, 4

#: What makes of the branches STICKING, FORWARD and BACKWARD those of torn and of crushed contacts.
TORN, CRUSHED = 4, 7
N_BRANCHES = CRUSHED + BACKWARD + 1

#: A contact stays in the branch it came from when another is nearer by this share of its reactions
#: only: one that slides starts the next step on its cone to rounding.
TIE = 1e-8


@njit(cache=True, error_model="numpy")
def crushing(table, c):
    """The normal reaction, from the tension on, at which a contact is crushed; or infinity."""
    return table[c, CRUSH] if table[c, CRUSH] > 0.0 else np.inf


@njit(cache=True, error_model="numpy")
def along_joint(branch):
    """The branch as far as it is about shear: that of a joint that is neither torn nor crushed."""
    if branch > CRUSHED:
        return branch - CRUSHED
    return branch - TORN if branch > BONDED else branch


@njit(cache=True, error_model="numpy")
def sense(branch):
    """1 and -1 where a contact slides under positive and under negative shear, else 0."""
    now = along_joint(branch)
    return 1.0 if now == FORWARD else (-1.0 if now == BACKWARD else 0.0)


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
    """Whether the trial reactions of a contact are for `branch_beyond`."""
    return table[c, ROOM] > 0.0 or table[c, TRIAL_N] > crushing(table, c) * (1.0 - TIE)


@njit(cache=True, error_model="numpy")
def branch_beyond(table, c, hint):
    """Branch for trial reactions of a contact that `yields`; ``hint`` is the one it came from."""
    rn, rt, crush = table[c, TRIAL_N], table[c, TRIAL_T], crushing(table, c)
    room, mu, was = table[c, ROOM], table[c, FRICTION], along_joint(hint)
    state, normal = 0, rn
    if rn <= 0.0 or (rn <= TIE * room and BONDED < hint <= CRUSHED):
        state, normal = TORN, 0.0
    elif rn > crush * (1.0 + TIE) or (rn >= crush * (1.0 - TIE) and hint > CRUSHED):
        state, normal = CRUSHED, crush
    most = mu * normal + room
    over, near = abs(rt) - most, TIE * (abs(rt) + most)
    sliding = FORWARD if rt > 0.0 else BACKWARD
    if abs(over) <= near and (was == STICKING or was == sliding):
        return state + was
    return state + (STICKING if over <= 0.0 else sliding)


@njit(cache=True, error_model="numpy")
def reactions_beyond(table, c, branch):
    """Reactions, the normal one from the tension on, and the sliding of torn and crushed ones."""
    normal, rt, sign = held_normal(table, c, branch), table[c, TRIAL_T], sense(branch)
    if sign == 0.0:
        return normal, rt, 0.0
    most = table[c, FRICTION] * normal + table[c, ROOM]
    return normal, sign * most, (sign * rt - most) / table[c, STIFF_T]


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
    there, was = branch_beyond(table, c, OPEN), along_joint(now)
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
