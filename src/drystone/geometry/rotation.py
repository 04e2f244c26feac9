"""Rotations in space, by unit quaternions (w, x, y, z): the compiled part of `geometry.motion`."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import LAST_DIGIT, SMALL_ANGLE

#: Column of a pose where its quaternion begins.
QUATERNION = 3


@njit(cache=True, inline="always")
def fill_rotation(pose, i, rotation):
    """Fill row i of ``rotation`` (n, 3, 3), the rotation of its pose (n, 7) less identity, 2 w [v]
    + 2 [v]^2."""
    w, x = pose[i, QUATERNION], pose[i, QUATERNION + 1]
    y, z = pose[i, QUATERNION + 2], pose[i, QUATERNION + 3]
    rotation[i, 0, 0] = -2.0 * (y * y + z * z)
    rotation[i, 1, 1] = -2.0 * (x * x + z * z)
    rotation[i, 2, 2] = -2.0 * (x * x + y * y)
    rotation[i, 0, 1] = 2.0 * (x * y - w * z)
    rotation[i, 1, 0] = 2.0 * (x * y + w * z)
    rotation[i, 0, 2] = 2.0 * (x * z + w * y)
    rotation[i, 2, 0] = 2.0 * (x * z - w * y)
    rotation[i, 1, 2] = 2.0 * (y * z - w * x)
    rotation[i, 2, 1] = 2.0 * (y * z + w * x)


@njit(cache=True)
def place_axes(pose, i, designed, rotation, axes):
    """`fill_rotation`, and row i of ``axes``: where it takes the columns of ``designed``, (n, 3,
    3)."""
    fill_rotation(pose, i, rotation)
    for j in range(3):
        for k in range(3):
            total = designed[i, j, k]
            for m in range(3):
                total += rotation[i, j, m] * designed[i, m, k]
            axes[i, j, k] = total


@njit(cache=True)
def translation(pose, i):
    """That of body i in the poses (n, n_pose), of three numbers."""
    return pose[i, 0], pose[i, 1], 0.0 if pose.shape[1] == 3 else pose[i, 2]


@njit(cache=True)
def rotation_adds(pose, i, x, y, z):
    """What the rotation of body i in the poses (n, n_pose) adds to an arm."""
    if pose.shape[1] == 3:
        s, half = np.sin(pose[i, 2]), np.sin(0.5 * pose[i, 2])
        versine = 2.0 * half * half
        return -versine * x - s * y, s * x - versine * y, 0.0
    w, p, q, r = pose[i, 3], pose[i, 4], pose[i, 5], pose[i, 6]
    cx, cy, cz = q * z - r * y, r * x - p * z, p * y - q * x
    return (
        2.0 * (w * cx + q * cz - r * cy),
        2.0 * (w * cy + r * cx - p * cz),
        2.0 * (w * cz + p * cy - q * cx),
    )


@njit(cache=True)
def add_force_at(rx, ry, rz, fx, fy, fz, i, axes, force):
    """Add a force at an arm to those of body i, ``force`` (n, n_dof); moments in space are about
    the principal axes in the columns of ``axes`` (n, 3, 3) there."""
    force[i, 0] += fx
    force[i, 1] += fy
    if force.shape[1] == 3:
        force[i, 2] += rx * fy - ry * fx
        return
    force[i, 2] += fz
    mx, my, mz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
    for d in range(3):
        rotated = axes[i, 0, d] * mx + axes[i, 1, d] * my + axes[i, 2, d] * mz
        force[i, 3 + d] += rotated


@njit(cache=True, error_model="numpy")
def farthest(increment, extent):
    """Largest bound on the displacement of any point of a block [m] for increments (n, n_dof)."""
    most = 0.0
    for i in range(increment.shape[0]):
        x, y, rotation = increment[i, 0], increment[i, 1], abs(increment[i, 2])
        straight = x * x + y * y
        if increment.shape[1] == 6:
            straight += increment[i, 2] ** 2
            rotation = np.sqrt(increment[i, 3] ** 2 + increment[i, 4] ** 2 + increment[i, 5] ** 2)
        moved = np.sqrt(straight) + extent[i] * rotation
        if not moved <= most:  # also where it is not a number
            most = moved
            if np.isnan(moved):
                break
    return most


@njit(cache=True)
def rotate_by(w, x, y, z, vx, vy, vz):
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
    share = np.sin(half) / angle if angle > SMALL_ANGLE else 0.5 - angle * angle / 48.0
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
def rotated(vx, vy, vz, ax, ay, az):
    """A vector (ax, ay, az) turned by a rotation vector (vx, vy, vz) [rad]."""
    angle = np.sqrt(vx * vx + vy * vy + vz * vz)
    share = np.sin(0.5 * angle) / angle if angle > SMALL_ANGLE else 0.5 - angle * angle / 48.0
    w, x, y, z = np.cos(0.5 * angle), share * vx, share * vy, share * vz
    mx, my, mz = rotate_by(w, x, y, z, ax, ay, az)
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
        lx, ly, lz = rotated(
            -0.5 * increment[i, 3], -0.5 * increment[i, 4], -0.5 * increment[i, 5],
            ix * wx, iy * wy, iz * wz,
        )  # fmt: skip
        size = np.sqrt(wx * wx + wy * wy + wz * wz)
        for _ in range(50):
            # (I - [h l / 2]) dw = l - I w, with l the moment of momentum amid the step.
            px, py, pz = rotated(-half * wx, -half * wy, -half * wz, lx, ly, lz)
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
            if dx * dx + dy * dy + dz * dz <= (LAST_DIGIT * size) ** 2:
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
        lx, ly, lz = rotated(half * cx, half * cy, half * cz, ix * cx, iy * cy, iz * cz)
        lx, ly, lz = lx + ix * (wx - cx), ly + iy * (wy - cy), lz + iz * (wz - cz)
        lx, ly, lz = rotated(-half * wx, -half * wy, -half * wz, lx, ly, lz)
        velocity[i, 3], velocity[i, 4], velocity[i, 5] = lx / ix, ly / iy, lz / iz


@njit(cache=True)
def all_axes(pose, designed, rotation, axes):
    """`place_axes` of all bodies."""
    for i in range(pose.shape[0]):
        place_axes(pose, i, designed, rotation, axes)


@njit(cache=True)
def _of_vector(vx, vy, vz):
    """Quaternion of a rotation vector [rad]."""
    angle = np.sqrt(vx * vx + vy * vy + vz * vz)
    half = 0.5 * angle
    share = np.sin(half) / angle if angle > SMALL_ANGLE else 0.5 - angle * angle / 48.0
    return np.cos(half), share * vx, share * vy, share * vz


@njit(cache=True)
def _rotation_of_increment(motion, axes):
    """Quaternion of the rotation of an increment (6,), about axes of the world; ``axes`` (3, 3) are
    the principal axes before it."""
    r0, r1, r2 = motion[3], motion[4], motion[5]
    return _of_vector(
        axes[0, 0] * r0 + axes[0, 1] * r1 + axes[0, 2] * r2,
        axes[1, 0] * r0 + axes[1, 1] * r1 + axes[1, 2] * r2,
        axes[2, 0] * r0 + axes[2, 1] * r1 + axes[2, 2] * r2,
    )


@njit(cache=True)
def moved(pose, increment, axes, after):
    """Fill poses ``after`` (n, 7) with those after increments (n, 6) about the principal axes as
    designed, (n, 3, 3) in columns."""
    for i in range(pose.shape[0]):
        for d in range(3):
            after[i, d] = pose[i, d] + increment[i, d]
        w0, x0, y0, z0 = _rotation_of_increment(increment[i], axes[i])
        w1, x1 = pose[i, QUATERNION], pose[i, QUATERNION + 1]
        y1, z1 = pose[i, QUATERNION + 2], pose[i, QUATERNION + 3]
        # First the increment, about axes of the body, then what the body has turned before.
        w = w1 * w0 - (x1 * x0 + y1 * y0 + z1 * z0)
        x = w1 * x0 + w0 * x1 + (y1 * z0 - z1 * y0)
        y = w1 * y0 + w0 * y1 + (z1 * x0 - x1 * z0)
        z = w1 * z0 + w0 * z1 + (x1 * y0 - y1 * x0)
        size = np.sqrt(w * w + x * x + y * y + z * z)
        after[i, QUATERNION], after[i, QUATERNION + 1] = w / size, x / size
        after[i, QUATERNION + 2], after[i, QUATERNION + 3] = y / size, z / size


@njit(cache=True)
def difference(pose, before, axes, increment):
    """Fill ``increment`` (n, 6) with what leads from the poses ``before`` (n, 7) to ``pose``; see
    `moved`."""
    for i in range(pose.shape[0]):
        for d in range(3):
            increment[i, d] = pose[i, d] - before[i, d]
        w1, x1 = before[i, QUATERNION], -before[i, QUATERNION + 1]
        y1, z1 = -before[i, QUATERNION + 2], -before[i, QUATERNION + 3]
        w2, x2 = pose[i, QUATERNION], pose[i, QUATERNION + 1]
        y2, z2 = pose[i, QUATERNION + 2], pose[i, QUATERNION + 3]
        w = w1 * w2 - (x1 * x2 + y1 * y2 + z1 * z2)
        x = w1 * x2 + w2 * x1 + (y1 * z2 - z1 * y2)
        y = w1 * y2 + w2 * y1 + (z1 * x2 - x1 * z2)
        z = w1 * z2 + w2 * z1 + (x1 * y2 - y1 * x2)
        if w < 0.0:
            w, x, y, z = -w, -x, -y, -z
        size = np.sqrt(x * x + y * y + z * z)
        share = 2.0 * np.arctan2(size, w) / size if size > 0.0 else 2.0
        for d in range(3):
            increment[i, 3 + d] = share * (
                axes[i, 0, d] * x + axes[i, 1, d] * y + axes[i, 2, d] * z
            )


@njit(cache=True)
def advance(arm, motion, axis, axes):
    """Displacement along ``axis`` (3,) [m] of a point at ``arm`` (3,) from its body's centroid, by
    an increment (6,); ``axes`` (3, 3) are the principal axes before it."""
    w, x, y, z = _rotation_of_increment(motion, axes)
    tx, ty, tz = rotate_by(w, x, y, z, arm[0], arm[1], arm[2])
    along = axis[0] * (motion[0] + tx) + axis[1] * (motion[1] + ty)
    return along + axis[2] * (motion[2] + tz)


@njit(cache=True)
def gradient_of_advance(arm, motion, axis, axes, gradient):
    """Fill ``gradient`` (6,): how `advance` goes with a further increment."""
    w, x, y, z = _rotation_of_increment(motion, axes)
    tx, ty, tz = rotate_by(w, x, y, z, arm[0], arm[1], arm[2])
    ax, ay, az = arm[0] + tx, arm[1] + ty, arm[2] + tz
    mx, my, mz = (
        ay * axis[2] - az * axis[1],
        az * axis[0] - ax * axis[2],
        ax * axis[1] - ay * axis[0],
    )
    for d in range(3):
        ux, uy, uz = axes[0, d], axes[1, d], axes[2, d]
        tx, ty, tz = rotate_by(w, x, y, z, ux, uy, uz)
        gradient[d] = axis[d]
        gradient[3 + d] = (ux + tx) * mx + (uy + ty) * my + (uz + tz) * mz
