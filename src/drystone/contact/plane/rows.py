"""Gradients of gap and slip by the motions of both bodies, q = (x_a, theta_a, x_b, theta_b).

Each contact has a row for its gap and a row for its slip.  Their formulas are in
`contact.plane.narrow`.  Reactions along these rows balance in force and in moment.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ARM_A,
    ARM_B,
    KIND,
    NONE,
    NORMAL,
    RATIO,
    ROLL_A,
    ROLL_B,
    VERTEX_A,
    VERTEX_B,
    VERTICES,
)
from drystone.contact.rows import OF_GAP, OF_SLIP

#: Degrees of freedom of a body: a constant, so that loops over them are unrolled.
N_DOF = 3


@njit(cache=True, error_model="numpy")
def gradients(value, k, rows, c):
    """Write the gradients of gap and slip of slot k into the rows of contact c; see
    `contact.plane.narrow`."""
    nx = value[k, NORMAL]
    ny = value[k, NORMAL + 1]
    rows[c, OF_GAP, 0] = -nx
    rows[c, OF_GAP, 1] = -ny
    rows[c, OF_GAP, 2] = nx * value[k, ARM_A + 1] - ny * value[k, ARM_A]
    rows[c, OF_GAP, 3] = nx
    rows[c, OF_GAP, 4] = ny
    rows[c, OF_GAP, 5] = -nx * value[k, ARM_B + 1] + ny * value[k, ARM_B]
    q = value[k, RATIO]
    rows[c, OF_SLIP, 0] = -q * ny
    rows[c, OF_SLIP, 1] = q * nx
    rows[c, OF_SLIP, 2] = q * (ny * value[k, ARM_A + 1] + nx * value[k, ARM_A]) + value[k, ROLL_A]
    rows[c, OF_SLIP, 3] = q * ny
    rows[c, OF_SLIP, 4] = -q * nx
    rows[c, OF_SLIP, 5] = -q * (ny * value[k, ARM_B + 1] + nx * value[k, ARM_B]) + value[k, ROLL_B]


@njit(cache=True, error_model="numpy")
def slot_rows(slots, rows):
    """Fill ``rows`` (n_slots, 2, 2 n_dof) with the gradients of gap and slip of all slots in
    use."""
    which, value = slots
    for k in range(which.shape[0]):
        if which[k, KIND] != NONE:
            gradients(value, k, rows, k)


@njit(cache=True, error_model="numpy")
def slip(kind, value, k, a, b, increment):
    """Sliding distance of b over a along the tangent since the start of the step [m].

    It is calculated from the increments (n, n_dof), backwards from the present place, so that it is
    as precise as the increments.  Shear stiffness times the rounding of coordinates would be
    noticeable.
    """
    tx = value[k, NORMAL + 1]
    ty = -value[k, NORMAL]
    wa = increment[a, 2]
    wb = increment[b, 2]
    sa = np.sin(wa)
    ca = 2.0 * np.sin(0.5 * wa) ** 2
    sb = np.sin(wb)
    cb = 2.0 * np.sin(0.5 * wb) ** 2
    # (I - R(-w)) v = [(1 - cos) v_x - sin v_y, sin v_x + (1 - cos) v_y]
    ax = ca * value[k, ARM_A] - sa * value[k, ARM_A + 1]
    ay = sa * value[k, ARM_A] + ca * value[k, ARM_A + 1]
    bx = cb * value[k, ARM_B] - sb * value[k, ARM_B + 1]
    by = sb * value[k, ARM_B] + cb * value[k, ARM_B + 1]
    ux = increment[b, 0] - increment[a, 0]
    uy = increment[b, 1] - increment[a, 1]
    rolled = value[k, ROLL_A] * wa + value[k, ROLL_B] * wb
    if kind == VERTEX_B:
        ux += bx
        uy += by
        rotated_x = ca * tx - sa * ty
        rotated_y = sa * tx + ca * ty
        before_x = value[k, ARM_A] - ux
        before_y = value[k, ARM_A + 1] - uy
        return tx * ux + ty * uy + rotated_x * before_x + rotated_y * before_y + rolled
    if kind == VERTEX_A:
        ux -= ax
        uy -= ay
        rotated_x = cb * tx - sb * ty
        rotated_y = sb * tx + cb * ty
        before_x = value[k, ARM_B] + ux
        before_y = value[k, ARM_B + 1] + uy
        return tx * ux + ty * uy - rotated_x * before_x - rotated_y * before_y + rolled
    ux += bx - ax
    uy += by - ay
    radii = value[k, ROLL_A] + value[k, ROLL_B]
    dx = value[k, NORMAL] * radii / value[k, RATIO]
    dy = value[k, NORMAL + 1] * radii / value[k, RATIO]
    swept = np.arctan2(dx * uy - dy * ux, (dx - ux) * dx + (dy - uy) * dy)
    return rolled - radii * swept


@njit(cache=True, error_model="numpy")
def second_derivatives(kind, value, k, rn, rt, hess):
    """Add -(r_n hess(g) + r_t hess(s)) to the 6 x 6 ``hess``, in the order (a, b)."""
    nx = value[k, NORMAL]
    ny = value[k, NORMAL + 1]
    tx = ny
    ty = -nx
    # The force f = r_n n + r_t t turns with the block that owns the edge; its line stays.
    fx = rn * nx + rt * tx
    fy = rn * ny + rt * ty
    if kind == VERTEX_B:
        e, o = 0, 3
        along_e = fx * value[k, ARM_A] + fy * value[k, ARM_A + 1]
        along_o = fx * value[k, ARM_B] + fy * value[k, ARM_B + 1]
        sign = 1.0
    elif kind == VERTEX_A:
        e, o = 3, 0
        along_e = -(fx * value[k, ARM_B] + fy * value[k, ARM_B + 1])
        along_o = -(fx * value[k, ARM_A] + fy * value[k, ARM_A + 1])
        sign = -1.0
    else:
        e, o, sign, along_e, along_o = 0, 3, 1.0, 0.0, 0.0
    if kind != VERTICES:
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
    radii = value[k, ROLL_A] + value[k, ROLL_B]
    distance = radii / value[k, RATIO]
    n_a = nx * value[k, ARM_A] + ny * value[k, ARM_A + 1]
    n_b = nx * value[k, ARM_B] + ny * value[k, ARM_B + 1]
    t_a = tx * value[k, ARM_A] + ty * value[k, ARM_A + 1]
    t_b = tx * value[k, ARM_B] + ty * value[k, ARM_B + 1]
    # n.J and t.J, with J the Jacobian of the vector from vertex to vertex; S n = -t, S t = n.
    nj = (-nx, -ny, -t_a, nx, ny, t_b)
    tj = (-tx, -ty, n_a, tx, ty, -n_b)
    for i in range(6):
        for j in range(6):
            hess[i, j] -= rn / distance * tj[i] * tj[j]
            hess[i, j] -= rt * radii / distance**2 * -(nj[i] * tj[j] + tj[i] * nj[j])
    hess[2, 2] -= rn * n_a + rt * value[k, RATIO] * t_a
    hess[5, 5] += rn * n_b + rt * value[k, RATIO] * t_b
