"""Rotations in space, by unit quaternions (w, x, y, z): the compiled part of `geometry.motion`."""

from __future__ import annotations

import numpy as np
from numba import njit

#: Column of a pose where its quaternion begins.
QUATERNION = 3


@njit(cache=True, inline="always")
def fill_turn(pose, i, turn):
    """Fill row i of ``turn`` (n, 3, 3), the rotation of its pose (n, 7) less identity, 2 w [v] +
    2 [v]^2."""
    w, x = pose[i, QUATERNION], pose[i, QUATERNION + 1]
    y, z = pose[i, QUATERNION + 2], pose[i, QUATERNION + 3]
    turn[i, 0, 0] = -2.0 * (y * y + z * z)
    turn[i, 1, 1] = -2.0 * (x * x + z * z)
    turn[i, 2, 2] = -2.0 * (x * x + y * y)
    turn[i, 0, 1] = 2.0 * (x * y - w * z)
    turn[i, 1, 0] = 2.0 * (x * y + w * z)
    turn[i, 0, 2] = 2.0 * (x * z + w * y)
    turn[i, 2, 0] = 2.0 * (x * z - w * y)
    turn[i, 1, 2] = 2.0 * (y * z - w * x)
    turn[i, 2, 1] = 2.0 * (y * z + w * x)


@njit(cache=True)
def place_axes(pose, i, designed, turn, axes):
    """`fill_turn`, and row i of ``axes``: where it takes the columns of ``designed``, (n, 3, 3)."""
    fill_turn(pose, i, turn)
    for j in range(3):
        for k in range(3):
            total = designed[i, j, k]
            for m in range(3):
                total += turn[i, j, m] * designed[i, m, k]
            axes[i, j, k] = total


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


@njit(cache=True)
def turned(vx, vy, vz, ax, ay, az):
    """A vector (ax, ay, az) turned by a rotation vector (vx, vy, vz) [rad]."""
    angle = np.sqrt(vx * vx + vy * vy + vz * vz)
    share = np.sin(0.5 * angle) / angle if angle > 1e-8 else 0.5 - angle * angle / 48.0
    w, x, y, z = np.cos(0.5 * angle), share * vx, share * vy, share * vz
    mx, my, mz = turn_by(w, x, y, z, ax, ay, az)
    return ax + mx, ay + my, az + mz


@njit(cache=True)
def spin_on(increment, mass, time_step, velocity):
    """Let the spins of bodies on which no moment acts go on for a step, in place.

    Velocities are those amid a step, rotations about the principal axes as they are then.  With Q
    the rotation at its end, a body keeps its moment of momentum,

        exp(h w' / 2) I w' = exp(-x / 2) I w,

    both sides seen along the axes Q, x the rotation of the step that led there; the same way back,
    so that energy does not drift: it is kept to second order in the step.

    Parameters
    ----------
    increment
        (n, 6) of the step that led to the present place [m, rad].
    mass
        (n, 6) [kg, kg m2].
    time_step
        h, of the step to come [s].
    velocity
        (n, 6), amid that step; replaced by that amid the step to come [m/s, rad/s].
    """
    half = 0.5 * time_step
    for i in range(velocity.shape[0]):
        wx, wy, wz = velocity[i, 3], velocity[i, 4], velocity[i, 5]
        if wx == 0.0 and wy == 0.0 and wz == 0.0:
            continue
        ix, iy, iz = mass[i, 3], mass[i, 4], mass[i, 5]
        lx, ly, lz = turned(
            -0.5 * increment[i, 3], -0.5 * increment[i, 4], -0.5 * increment[i, 5],
            ix * wx, iy * wy, iz * wz,
        )  # fmt: skip
        size = np.sqrt(wx * wx + wy * wy + wz * wz)
        for _ in range(50):
            # (I - [h l / 2]) dw = l - I w, with l the moment of momentum amid the step.
            px, py, pz = turned(-half * wx, -half * wy, -half * wz, lx, ly, lz)
            rx, ry, rz = px - ix * wx, py - iy * wy, pz - iz * wz
            ax, ay, az = half * px, half * py, half * pz
            # Cramer's rule for [[ix, az, -ay], [-az, iy, ax], [ay, -ax, iz]].
            xx, xy, xz = iy * iz + ax * ax, ax * ay - az * iz, ay * iy + az * ax
            yx, yy, yz = ax * ay + az * iz, ix * iz + ay * ay, ay * az - ax * ix
            zx, zy, zz = ax * az - ay * iy, ay * az + ax * ix, ix * iy + az * az
            det = ix * xx + az * yx - ay * zx
            dx = (xx * rx + xy * ry + xz * rz) / det
            dy = (yx * rx + yy * ry + yz * rz) / det
            dz = (zx * rx + zy * ry + zz * rz) / det
            wx, wy, wz = wx + dx, wy + dy, wz + dz
            if dx * dx + dy * dy + dz * dz <= (1e-15 * size) ** 2:
                break
        velocity[i, 3], velocity[i, 4], velocity[i, 5] = wx, wy, wz


@njit(cache=True)
def spin_by_impulses(carried, mass, time_step, velocity):
    """Make spins of those that a step was solved for, in place, so that no moment of momentum is
    lost.

    Impulses of moment I (w - c) have changed the spins ``carried`` (n, 6), see `spin_on`, into w;
    they are seen along the axes at the start of the step, the spins amid it:

        exp(h w / 2) I w' = exp(h c / 2) I c + I (w - c)

    The difference of w' and w is of first order in the step.
    """
    half = 0.5 * time_step
    for i in range(velocity.shape[0]):
        wx, wy, wz = velocity[i, 3], velocity[i, 4], velocity[i, 5]
        cx, cy, cz = carried[i, 3], carried[i, 4], carried[i, 5]
        ix, iy, iz = mass[i, 3], mass[i, 4], mass[i, 5]
        if ix == 0.0 or (wx == 0.0 and wy == 0.0 and wz == 0.0):
            continue
        lx, ly, lz = turned(half * cx, half * cy, half * cz, ix * cx, iy * cy, iz * cz)
        lx, ly, lz = lx + ix * (wx - cx), ly + iy * (wy - cy), lz + iz * (wz - cz)
        lx, ly, lz = turned(-half * wx, -half * wy, -half * wz, lx, ly, lz)
        velocity[i, 3], velocity[i, 4], velocity[i, 5] = lx / ix, ly / iy, lz / iz


@njit(cache=True)
def all_axes(pose, designed, turn, axes):
    """`place_axes` of all bodies."""
    for i in range(pose.shape[0]):
        place_axes(pose, i, designed, turn, axes)
