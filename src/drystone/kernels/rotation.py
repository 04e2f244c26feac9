"""Rotations in space, by unit quaternions (w, x, y, z): the compiled part of `geometry.motion`."""

from __future__ import annotations

import numpy as np
from numba import njit

#: Column of a pose where its quaternion begins.
QUATERNION = 3


@njit(cache=True)
def fill_matrix(pose, i, matrix):
    """Fill ``matrix`` (n, 3, 3) of body i with the rotation of its pose (n, 7)."""
    w, x = pose[i, QUATERNION], pose[i, QUATERNION + 1]
    y, z = pose[i, QUATERNION + 2], pose[i, QUATERNION + 3]
    matrix[i, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    matrix[i, 0, 1] = 2.0 * (x * y - w * z)
    matrix[i, 0, 2] = 2.0 * (x * z + w * y)
    matrix[i, 1, 0] = 2.0 * (x * y + w * z)
    matrix[i, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    matrix[i, 1, 2] = 2.0 * (y * z - w * x)
    matrix[i, 2, 0] = 2.0 * (x * z - w * y)
    matrix[i, 2, 1] = 2.0 * (y * z + w * x)
    matrix[i, 2, 2] = 1.0 - 2.0 * (x * x + y * y)


@njit(cache=True)
def turn_by(w, x, y, z, vx, vy, vz):
    """What a rotation adds to a vector, as precise as the rotation is small."""
    cx, cy, cz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    ax = 2.0 * (w * cx + y * cz - z * cy)
    ay = 2.0 * (w * cy + z * cx - x * cz)
    az = 2.0 * (w * cz + x * cy - y * cx)
    return ax, ay, az


@njit(cache=True)
def spin(pose, i, vx, vy, vz):
    """Turn body i of the poses (n, 7) on by a rotation vector [rad] along its axes as designed.

    The quaternion is brought back to length one: what rounding adds does not pile up.
    """
    angle = np.sqrt(vx * vx + vy * vy + vz * vz)
    half = 0.5 * angle
    # sin(a / 2) / a, which is smooth where there is no rotation.
    share = np.sin(half) / angle if angle > 1e-8 else 0.5 - angle * angle / 48.0
    c, x, y, z = np.cos(half), share * vx, share * vy, share * vz
    w0, x0 = pose[i, QUATERNION], pose[i, QUATERNION + 1]
    y0, z0 = pose[i, QUATERNION + 2], pose[i, QUATERNION + 3]
    w1 = w0 * c - x0 * x - y0 * y - z0 * z
    x1 = w0 * x + c * x0 + y0 * z - z0 * y
    y1 = w0 * y + c * y0 + z0 * x - x0 * z
    z1 = w0 * z + c * z0 + x0 * y - y0 * x
    norm = 1.0 / np.sqrt(w1 * w1 + x1 * x1 + y1 * y1 + z1 * z1)
    pose[i, QUATERNION] = w1 * norm
    pose[i, QUATERNION + 1] = x1 * norm
    pose[i, QUATERNION + 2] = y1 * norm
    pose[i, QUATERNION + 3] = z1 * norm
