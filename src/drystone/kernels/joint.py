"""The joint law at every contact, and what it does to the blocks: forces and their tangent.

With the stiffnesses times the contact's tributary area k_n, k_s [N/m], gap g, accumulated
dilation d, slip increment s and shear t_0 at the start of the step, the trial reactions are

    r_n = k_n (d - g)          r_t = t_0 - k_s s

Without tension r_n <= 0 means open.  |r_t| <= mu r_n + c A sticks.  Otherwise the joint slides by

    gamma = (|r_t| - mu r_n) / (k_s + mu k_n tan psi)

against the trial shear, which raises the normal reaction by k_n tan(psi) gamma (return mapping;
non-associative unless tan psi = mu).  Cohesion and tensile strength are lost together, at once,
where either is exceeded.

The force on block b is r_n n + r_t t, on the blocks together r_n grad(g) + r_t grad(s); their
tangent includes the second derivatives of g and s (see `kernels.narrow`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

NONE, VERTEX_B, VERTEX_A, VERTICES = 0, 1, 2, 3
OPEN, STICKING, SLIDING = 0, 1, 2

#: A contact this near to its cone slides; one that slid in the last step starts on it to rounding.
TIE = 1e-9

#: Columns of the history of a contact: shear [N], dilation [m], slid distance [m], broken bond.
SHEAR, DILATION, SLID, BROKEN = 0, 1, 2, 3
N_HISTORY = 4

#: Columns of the table of joint laws: mu, k_n, k_s [Pa/m], tan psi, c, f_t [Pa], slide at which
#: dilatancy ends [m].
MU, KN, KS, TAN_PSI, COHESION, TENSION, DILATANCY_END = 0, 1, 2, 3, 4, 5, 6
N_LAW = 7

Array = NDArray[np.float64]


class Tangent(NamedTuple):
    """Block form of the stiffness matrix: diagonal blocks, and both of every pair."""

    diagonal: Array  # (n, 3, 3)
    upper: Array  # (n_pairs, 3, 3) rows of a, columns of b
    lower: Array  # (n_pairs, 3, 3) rows of b, columns of a


@njit(cache=True, inline="always")
def _slip(kind, normal, arm_a, arm_b, roll, ratio, k, a, b, increment):
    """Sliding distance of b over a along the tangent since the start of the step [m].

    Written in differences from the present place backwards, so that it is as precise as the
    increments themselves: shear stiffness times the rounding of coordinates would be felt.
    """
    tx = normal[k, 1]
    ty = -normal[k, 0]
    wa = increment[a, 2]
    wb = increment[b, 2]
    sa = np.sin(wa)
    ca = 2.0 * np.sin(0.5 * wa) ** 2
    sb = np.sin(wb)
    cb = 2.0 * np.sin(0.5 * wb) ** 2
    # (I - R(-w)) v = [(1 - cos) v_x - sin v_y, sin v_x + (1 - cos) v_y]
    ax = ca * arm_a[k, 0] - sa * arm_a[k, 1]
    ay = sa * arm_a[k, 0] + ca * arm_a[k, 1]
    bx = cb * arm_b[k, 0] - sb * arm_b[k, 1]
    by = sb * arm_b[k, 0] + cb * arm_b[k, 1]
    ux = increment[b, 0] - increment[a, 0]
    uy = increment[b, 1] - increment[a, 1]
    rolled = roll[k, 0] * wa + roll[k, 1] * wb
    if kind[k] == VERTEX_B:
        ux += bx
        uy += by
        turned_x = ca * tx - sa * ty
        turned_y = sa * tx + ca * ty
        before_x = arm_a[k, 0] - ux
        before_y = arm_a[k, 1] - uy
        return tx * ux + ty * uy + turned_x * before_x + turned_y * before_y + rolled
    if kind[k] == VERTEX_A:
        ux -= ax
        uy -= ay
        turned_x = cb * tx - sb * ty
        turned_y = sb * tx + cb * ty
        before_x = arm_b[k, 0] + ux
        before_y = arm_b[k, 1] + uy
        return tx * ux + ty * uy - turned_x * before_x - turned_y * before_y + rolled
    ux += bx - ax
    uy += by - ay
    radii = roll[k, 0] + roll[k, 1]
    dx = normal[k, 0] * radii / ratio[k]
    dy = normal[k, 1] * radii / ratio[k]
    swept = np.arctan2(dx * uy - dy * ux, (dx - ux) * dx + (dy - uy) * dy)
    return rolled - radii * swept


@njit(cache=True, inline="always")
def _second_derivatives(kind, normal, arm_a, arm_b, roll, ratio, k, rn, rt, hess):
    """Add -(r_n hess(g) + r_t hess(s)) to the 6 x 6 ``hess``, in the order (a, b)."""
    nx = normal[k, 0]
    ny = normal[k, 1]
    tx = ny
    ty = -nx
    # A force f = r_n n + r_t t that turns with the block that owns the edge, at a fixed line.
    fx = rn * nx + rt * tx
    fy = rn * ny + rt * ty
    if kind[k] == VERTEX_B:
        e, o = 0, 3
        along_e = fx * arm_a[k, 0] + fy * arm_a[k, 1]
        along_o = fx * arm_b[k, 0] + fy * arm_b[k, 1]
        sign = 1.0
    elif kind[k] == VERTEX_A:
        e, o = 3, 0
        along_e = -(fx * arm_b[k, 0] + fy * arm_b[k, 1])
        along_o = -(fx * arm_a[k, 0] + fy * arm_a[k, 1])
        sign = -1.0
    else:
        e, o, sign, along_e, along_o = 0, 3, 1.0, 0.0, 0.0
    if kind[k] != VERTICES:
        # hess(theta_e, x_o) = S f, hess(theta_e, x_e) = -S f, and three rotation terms.
        sx = -sign * fy
        sy = sign * fx
        hess[e + 2, o] -= sx
        hess[e + 2, o + 1] -= sy
        hess[o, e + 2] -= sx
        hess[o + 1, e + 2] -= sy
        hess[e + 2, e] += sx
        hess[e + 2, e + 1] += sy
        hess[e, e + 2] += sx
        hess[e + 1, e + 2] += sy
        hess[e + 2, e + 2] += along_e
        hess[e + 2, o + 2] -= along_o
        hess[o + 2, e + 2] -= along_o
        hess[o + 2, o + 2] += along_o
        return
    radii = roll[k, 0] + roll[k, 1]
    distance = radii / ratio[k]
    n_a = nx * arm_a[k, 0] + ny * arm_a[k, 1]
    n_b = nx * arm_b[k, 0] + ny * arm_b[k, 1]
    t_a = tx * arm_a[k, 0] + ty * arm_a[k, 1]
    t_b = tx * arm_b[k, 0] + ty * arm_b[k, 1]
    # n.J and t.J, with J the Jacobian of the vector from vertex to vertex; S n = -t, S t = n.
    nj = (-nx, -ny, -t_a, nx, ny, t_b)
    tj = (-tx, -ty, n_a, tx, ty, -n_b)
    for i in range(6):
        for j in range(6):
            hess[i, j] -= rn / distance * tj[i] * tj[j]
            hess[i, j] -= rt * radii / distance**2 * -(nj[i] * tj[j] + tj[i] * nj[j])
    hess[2, 2] -= rn * n_a + rt * ratio[k] * t_a
    hess[5, 5] += rn * n_b + rt * ratio[k] * t_b


@njit(cache=True)
def slip_gradients(kind, normal, arm_a, arm_b, roll, ratio, rows):
    """Gradients of the slip of all contacts in use, (n_slots, 6); see `kernels.narrow`."""
    for k in range(kind.shape[0]):
        if kind[k] == NONE:
            continue
        nx = normal[k, 0]
        ny = normal[k, 1]
        q = ratio[k]
        rows[k, 0] = -q * ny
        rows[k, 1] = q * nx
        rows[k, 2] = q * (ny * arm_a[k, 1] + nx * arm_a[k, 0]) + roll[k, 0]
        rows[k, 3] = q * ny
        rows[k, 4] = -q * nx
        rows[k, 5] = -q * (ny * arm_b[k, 1] + nx * arm_b[k, 0]) + roll[k, 1]


@njit(cache=True)
def joint_forces(
    slots, pair_a, pair_b, pair_law, laws, thickness, start_length, start_slip, history, source,
    increment, held, force, reaction, status, excess, state, tangent, with_tangent,
):  # fmt: skip
    """Reactions of all contacts, added to ``force``, and the tangent of minus that force.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    pair_a, pair_b, pair_law
        Bodies and joint law of each pair, (n_pairs,).
    laws
        (n_laws, N_LAW), see the columns above.
    thickness
        [m]
    start_length
        Tributary lengths at the start of the step, (n_slots,) [m]; zero where there was none.
    start_slip
        Gradients of the slip that hold for the step, (n_slots, 6), of contacts that were there
        when it began; others slip by the exact distance.
    history, source
        (n_slots, N_HISTORY) at the start of the step, and the slot each contact goes on with.
    increment
        Motion since the start of the step, (n, 3) [m, rad].
    force
        (n, 3) [N, N m], added to.
    held
        Contacts that stick whatever their cone says, (n_slots,).
    reaction, status, excess, state
        Filled: (n_slots, 2) [N], (n_slots,), by how much the trial shear exceeds the cone,
        (n_slots,) [N], and the history at the end, (n_slots, N_HISTORY).
    tangent
        `Tangent`, added to where ``with_tangent``.
    """
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio = slots.roll, slots.ratio
    hess = np.zeros((6, 6))
    gn = np.zeros(6)
    gt = np.zeros(6)
    gs = np.zeros(6)
    for k in range(kind.shape[0]):
        reaction[k, 0] = 0.0
        reaction[k, 1] = 0.0
        status[k] = OPEN
        excess[k] = 0.0
        for c in range(N_HISTORY):
            state[k, c] = history[source[k], c] if source[k] >= 0 else 0.0
        if kind[k] == NONE:
            continue
        if source[k] < 0:
            state[k, BROKEN] = 1.0  # blocks that come to touch later are not bonded
        shear = state[k, SHEAR]
        state[k, SHEAR] = 0.0
        p = k // 2
        a = pair_a[p]
        b = pair_b[p]
        law = pair_law[p]
        known = source[k] >= 0 and start_length[source[k]] > 0.0
        length = start_length[source[k]] if known else slots.length[k]
        area = length * thickness
        kn = laws[law, KN] * area
        ks = laws[law, KS] * area
        mu = laws[law, MU]
        tan_psi = laws[law, TAN_PSI] if state[k, SLID] < laws[law, DILATANCY_END] else 0.0
        bonded = state[k, BROKEN] == 0.0
        rn = kn * (state[k, DILATION] - slots.gap[k])
        if rn < 0.0 and not (bonded and laws[law, TENSION] > 0.0):
            if bonded and slots.gap[k] > 0.0:
                state[k, BROKEN] = 1.0
            continue
        if bonded and rn < -laws[law, TENSION] * area:
            state[k, BROKEN] = 1.0
            continue
        if known:
            slip = 0.0
            for i in range(3):
                gs[i] = start_slip[source[k], i]
                gs[3 + i] = start_slip[source[k], 3 + i]
                slip += gs[i] * increment[a, i] + gs[3 + i] * increment[b, i]
        else:
            slip = _slip(kind, normal, arm_a, arm_b, roll, ratio, k, a, b, increment)
        rt = shear - ks * slip
        limit = mu * rn
        if bonded:
            limit += laws[law, COHESION] * area
        # dr[i, j]: derivative of (r_n, r_t) by (g, s).
        nn, nt, tn, tt = -kn, 0.0, 0.0, -ks
        excess[k] = abs(rt) - limit
        status[k] = STICKING
        if abs(rt) > limit * (1.0 - TIE) and rt != 0.0 and not held[k]:
            status[k] = SLIDING
            state[k, BROKEN] = 1.0
            if rn <= 0.0:
                status[k] = OPEN
                continue
            sign = 1.0 if rt > 0.0 else -1.0
            along = ks + mu * kn * tan_psi
            gamma = (abs(rt) - mu * rn) / along
            rn += kn * tan_psi * gamma
            rt = sign * mu * rn
            nt = -kn * tan_psi * sign * ks / along
            nn = -kn + kn * tan_psi * mu * kn / along
            tn = sign * mu * nn
            tt = sign * mu * nt
            state[k, DILATION] += tan_psi * gamma
            state[k, SLID] += gamma
        reaction[k, 0] = rn
        reaction[k, 1] = rt
        state[k, SHEAR] = rt
        nx = normal[k, 0]
        ny = normal[k, 1]
        gn[0] = -nx
        gn[1] = -ny
        gn[2] = nx * arm_a[k, 1] - ny * arm_a[k, 0]
        gn[3] = nx
        gn[4] = ny
        gn[5] = -nx * arm_b[k, 1] + ny * arm_b[k, 0]
        q = ratio[k]
        gt[0] = -q * ny
        gt[1] = q * nx
        gt[2] = q * (ny * arm_a[k, 1] + nx * arm_a[k, 0]) + roll[k, 0]
        gt[3] = q * ny
        gt[4] = -q * nx
        gt[5] = -q * (ny * arm_b[k, 1] + nx * arm_b[k, 0]) + roll[k, 1]
        for i in range(3):
            force[a, i] += rn * gn[i] + rt * gt[i]
            force[b, i] += rn * gn[3 + i] + rt * gt[3 + i]
        if not with_tangent:
            continue
        if not known:
            gs[:] = gt
        for i in range(6):
            for j in range(6):
                hess[i, j] = -(
                    gn[i] * (nn * gn[j] + nt * gs[j]) + gt[i] * (tn * gn[j] + tt * gs[j])
                )
        _second_derivatives(kind, normal, arm_a, arm_b, roll, ratio, k, rn, rt, hess)
        for i in range(3):
            for j in range(3):
                tangent.diagonal[a, i, j] += hess[i, j]
                tangent.diagonal[b, i, j] += hess[3 + i, 3 + j]
                tangent.upper[p, i, j] += hess[i, 3 + j]
                tangent.lower[p, i, j] += hess[3 + i, j]
