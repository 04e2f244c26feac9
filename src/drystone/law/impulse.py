"""The joint law of impulses, without shear stiffness, for one contact at a time."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import AT_CONE, FRICTION_ANGLE
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING

#: Number of intervals in which the angle of friction in space is looked for.
N_ANGLES = 32


@njit(cache=True, error_model="numpy")
def local_impulse(bn, bt, cnn, wnt, wtt, mu):
    """Impulses [N s] that solve the equations of one contact; see `dynamics.sweeps`.

    ``bn`` and ``bt`` [m/s] are the normal and tangential velocity without these impulses; ``bn``
    also contains the gap.  ``cnn``, ``wnt`` and ``wtt`` [1/kg] are the change of the velocities per
    impulse.
    """
    det = cnn * wtt - wnt * wnt
    stick_n = (wnt * bt - wtt * bn) / det
    stick_t = (wnt * bn - cnn * bt) / det
    if stick_n > 0.0 and abs(stick_t) <= mu * stick_n:
        return stick_n, stick_t
    pn, pt = 0.0, 0.0
    slope = mu if stick_t > 0.0 else -mu
    along = cnn + slope * wnt
    if bn < 0.0 and along > 0.0:
        pn = -bn / along
        pt = slope * pn
        if (wnt * pn + wtt * pt + bt) * slope > 0.0:  # friction must oppose sliding
            slope = -slope
            along = cnn + slope * wnt
            if along > 0.0:
                pn = -bn / along
                pt = slope * pn
    return pn, pt


@njit(cache=True, error_model="numpy")
def _sliding(angle, a1, a2, m11, m12, m21, m22):
    """The sliding velocity a + M t for friction along the direction t at an ``angle``: its part
    across t, the derivative of this part by the angle, and its part along t."""
    c, s = np.cos(angle), np.sin(angle)
    v1, v2 = a1 + m11 * c + m12 * s, a2 + m21 * c + m22 * s
    along = c * v1 + s * v2
    return c * v2 - s * v1, c * (m22 * c - m21 * s) - s * (m12 * c - m11 * s) - along, along


@njit(cache=True, error_model="numpy")
def _sliding_angle(start, a1, a2, m11, m12, m21, m22):
    """Angle of the friction that opposes sliding, and whether there is one; see `_sliding`.

    It is found by Newton's method from ``start``.  If that fails, it is found by bisection in
    intervals in which the part across changes its sign.
    """
    angle = start
    for _ in range(20):
        across, slope, along = _sliding(angle, a1, a2, m11, m12, m21, m22)
        step = across / slope if slope != 0.0 else 1.0
        if abs(step) < FRICTION_ANGLE and along <= 0.0:
            return angle - step, True
        angle -= min(max(step, -0.5), 0.5)
    high, after, _ = start, _sliding(start, a1, a2, m11, m12, m21, m22)[0], 0.0
    for k in range(1, N_ANGLES + 1):
        low, before = high, after
        high = start + 2.0 * np.pi * k / N_ANGLES
        after = _sliding(high, a1, a2, m11, m12, m21, m22)[0]
        if (before < 0.0) == (after < 0.0):
            continue
        x, y = low, high
        for _ in range(60):
            angle = 0.5 * (x + y)
            across, slope, along = _sliding(angle, a1, a2, m11, m12, m21, m22)
            if (across < 0.0) == (before < 0.0):
                x = angle
            else:
                y = angle
        if along <= 0.0:
            return angle, True
    return start, False


@njit(cache=True, error_model="numpy")
def local_impulse_in_space(bn, b1, b2, w, cnn, mu, p):
    """Fill ``p`` (3,) with the impulses [N s] that solve the equations of one contact; see
    `local_impulse`.

    A contact that slides has friction along (cos a, sin a), opposed to its velocity.  The velocity
    across this direction is a trigonometric polynomial of second degree in the angle a.

    Parameters
    ----------
    bn, b1, b2
        Velocity without the impulses [m/s]; ``bn`` also contains the gap.
    w
        Delassus block (3, 3) [1/kg]; its first entry is not used.
    cnn
        Its first entry with the compliance of the joint [1/kg].
    mu
        Friction coefficient.
    """
    w01, w02, w11, w12, w22 = w[0, 1], w[0, 2], w[1, 1], w[1, 2], w[2, 2]
    # Tangential impulses with which the contact sticks: -h - g p_n.
    det = w11 * w22 - w12 * w12
    g1, g2 = (w22 * w01 - w12 * w02) / det, (w11 * w02 - w12 * w01) / det
    h1, h2 = (w22 * b1 - w12 * b2) / det, (w11 * b2 - w12 * b1) / det
    pn = (w01 * h1 + w02 * h2 - bn) / (cnn - w01 * g1 - w02 * g2)
    p1, p2 = -h1 - g1 * pn, -h2 - g2 * pn
    p[0], p[1], p[2] = pn, p1, p2
    if pn > 0.0 and p1 * p1 + p2 * p2 <= mu * mu * pn * pn:
        return
    p[0], p[1], p[2] = 0.0, 0.0, 0.0
    if bn >= 0.0:
        return
    start = np.arctan2(p2, p1) if pn > 0.0 else np.arctan2(-h2, -h1)
    # The sliding velocity, times a positive factor that does not change its direction.
    a1, a2 = cnn * b1 - bn * w01, cnn * b2 - bn * w02
    m11, m12 = mu * (b1 * w01 - bn * w11), mu * (b1 * w02 - bn * w12)
    m21, m22 = mu * (b2 * w01 - bn * w12), mu * (b2 * w02 - bn * w22)
    angle, found = _sliding_angle(start, a1, a2, m11, m12, m21, m22)
    c, s = np.cos(angle), np.sin(angle)
    along = cnn + mu * (c * w01 + s * w02)
    if found and along > 0.0:
        p[0] = -bn / along
        p[1], p[2] = mu * p[0] * c, mu * p[0] * s


@njit(cache=True, error_model="numpy")
def projected_impulse(pn, pt, mu, sticks):
    """Trial impulses [N s] projected onto the cone, and their branch.  A contact that ``sticks`` is
    not projected."""
    if pn <= 0.0:
        return 0.0, 0.0, OPEN
    limit = mu * pn
    if abs(pt) > limit * (1.0 - AT_CONE) and pt != 0.0 and not sticks:
        return pn, limit if pt > 0.0 else -limit, FORWARD if pt > 0.0 else BACKWARD
    return pn, pt, STICKING


@njit(cache=True, error_model="numpy")
def impulse_in(branch, pn, pt, mu):
    """Impulses [N s] in a branch, for trial impulses."""
    if branch == OPEN:
        return 0.0, 0.0
    if branch != STICKING:
        return pn, mu * pn if branch == FORWARD else -mu * pn
    return pn, pt


@njit(cache=True, error_model="numpy")
def branch_of_impulse(pn, pt, mu):
    """The branch to which impulses belong."""
    limit = mu * pn
    if pn <= 0.0:
        return OPEN
    if abs(pt) < limit * (1.0 - AT_CONE) or limit == 0.0:
        return STICKING
    return FORWARD if pt > 0.0 else BACKWARD


@njit(cache=True, error_model="numpy")
def projected_impulse_in_space(pn, p1, p2, mu, sticks):
    """`projected_impulse` with two tangential impulses; the branch of sliding is FORWARD."""
    if pn <= 0.0:
        return 0.0, 0.0, 0.0, OPEN
    limit, size = mu * pn, np.sqrt(p1 * p1 + p2 * p2)
    if size > limit * (1.0 - AT_CONE) and size > 0.0 and not sticks:
        share = limit / size
        return pn, share * p1, share * p2, FORWARD
    return pn, p1, p2, STICKING
