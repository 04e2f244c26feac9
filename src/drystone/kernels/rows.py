"""Gradients of gap and slip: how a contact's gap and sliding distance go with the blocks' motion.

A contact has a row for its gap, GAP, and one for its slip, SLIP: gradients by the motions of both
bodies, q = (x_a, theta_a, x_b, theta_b), whose formulas stand in `kernels.narrow`.  Reactions along
them balance in force and in moment.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from drystone.kernels.contacts import NONE, VERTEX_A, VERTEX_B, VERTICES

#: Degrees of freedom of a body: a constant, so that loops over them are unrolled.
N_DOF = 3

#: Rows of a contact: gradients of gap and slip, and those by which slip is measured.
GAP, SLIP, MEASURED = 0, 1, 2


@njit(cache=True)
def gradients(normal, arm_a, arm_b, roll, ratio, k, rows, c):
    """Gradients of gap and slip of slot k into the rows of contact c; see `kernels.narrow`."""
    nx = normal[k, 0]
    ny = normal[k, 1]
    rows[c, GAP, 0] = -nx
    rows[c, GAP, 1] = -ny
    rows[c, GAP, 2] = nx * arm_a[k, 1] - ny * arm_a[k, 0]
    rows[c, GAP, 3] = nx
    rows[c, GAP, 4] = ny
    rows[c, GAP, 5] = -nx * arm_b[k, 1] + ny * arm_b[k, 0]
    q = ratio[k]
    rows[c, SLIP, 0] = -q * ny
    rows[c, SLIP, 1] = q * nx
    rows[c, SLIP, 2] = q * (ny * arm_a[k, 1] + nx * arm_a[k, 0]) + roll[k, 0]
    rows[c, SLIP, 3] = q * ny
    rows[c, SLIP, 4] = -q * nx
    rows[c, SLIP, 5] = -q * (ny * arm_b[k, 1] + nx * arm_b[k, 0]) + roll[k, 1]


@njit(cache=True)
def slot_rows(slots, rows):
    """Gradients of gap and slip of all slots in use, (n_slots, dim, 2 n_dof)."""
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio = slots.roll, slots.ratio
    for k in range(kind.shape[0]):
        if kind[k] != NONE:
            gradients(normal, arm_a, arm_b, roll, ratio, k, rows, k)


@njit(cache=True)
def slip(kind, normal, arm_a, arm_b, roll, ratio, k, a, b, increment):
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


@njit(cache=True)
def second_derivatives(kind, normal, arm_a, arm_b, roll, ratio, k, rn, rt, hess):
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
def along(rows, c, row, field, a, b):
    """A row of contact c, times the motion of its bodies a and b."""
    total = 0.0
    for i in range(N_DOF):
        total += rows[c, row, i] * field[a, i] + rows[c, row, N_DOF + i] * field[b, i]
    return total


@njit(cache=True)
def add_force(rows, c, rn, rt, a, b, force):
    """Add what the reactions of contact c do to its bodies a and b to ``force`` (n, n_dof)."""
    for i in range(N_DOF):
        force[a, i] += rn * rows[c, GAP, i] + rt * rows[c, SLIP, i]
        force[b, i] += rn * rows[c, GAP, N_DOF + i] + rt * rows[c, SLIP, N_DOF + i]
