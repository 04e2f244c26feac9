"""Gradients of gap and slips in space, by the motions of both bodies.

Motions are (u_a, w_a, u_b, w_b): translations along the axes of the world, and rotations about the
principal axes of the bodies.  The present directions of the principal axes are the columns of
``axes`` (n, 3, 3).  See `contact.space.points`.
"""

from __future__ import annotations

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ARM_A_3,
    ARM_B_3,
    BODY_A,
    BODY_B,
    NORMAL_3,
    SLOT,
    TANGENT_3,
)


@njit(cache=True)
def _along(value, k, x, y, z, axes, a, b, rows, c, row):
    """Write the gradient of the motion of b relative to a along (x, y, z), at the point of slot k,
    into a row of contact c."""
    for side in range(2):
        arm, body = (ARM_A_3, a) if side == 0 else (ARM_B_3, b)
        sign, first = (-1.0, 0) if side == 0 else (1.0, 6)
        ax, ay, az = value[k, arm], value[k, arm + 1], value[k, arm + 2]
        mx, my, mz = ay * z - az * y, az * x - ax * z, ax * y - ay * x
        rows[c, row, first] = sign * x
        rows[c, row, first + 1] = sign * y
        rows[c, row, first + 2] = sign * z
        for i in range(3):
            about = axes[body, 0, i] * mx + axes[body, 1, i] * my + axes[body, 2, i] * mz
            rows[c, row, first + 3 + i] = sign * about


@njit(cache=True)
def gradients_in_space(value, k, axes, a, b, rows, c):
    """Write the gradients of gap and both slips of slot k into the first three rows of contact
    c."""
    nx, ny, nz = value[k, NORMAL_3], value[k, NORMAL_3 + 1], value[k, NORMAL_3 + 2]
    tx, ty, tz = value[k, TANGENT_3], value[k, TANGENT_3 + 1], value[k, TANGENT_3 + 2]
    _along(value, k, nx, ny, nz, axes, a, b, rows, c, 0)
    _along(value, k, tx, ty, tz, axes, a, b, rows, c, 1)
    sx, sy, sz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
    _along(value, k, sx, sy, sz, axes, a, b, rows, c, 2)


@njit(cache=True)
def packed_rows_in_space(value, which, count, axes, rows):
    """Fill ``rows`` (n, 5, 12) of packed contacts with the gradients of gap and slips, and those by
    which slips are measured."""
    for c in range(count):
        gradients_in_space(value, which[c, SLOT], axes, which[c, BODY_A], which[c, BODY_B], rows, c)
        for i in range(12):
            rows[c, 3, i] = rows[c, 1, i]
            rows[c, 4, i] = rows[c, 2, i]
