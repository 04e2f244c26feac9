"""How rigid bodies move: poses, the increments between them, and what they do to points.

A pose is a body's motion since the design, about its centroid.  In the plane it is (u_x, u_y,
theta) [m, m, rad]; in space (u_x, u_y, u_z) and the unit quaternion (w, x, y, z) by which the body
has turned.  An increment leads from one pose to another: a translation along the axes of the world,
and a rotation, in space a vector about the body's own principal axes, which turn with it.  About
these the body's inertia is diagonal, and stays so.

What the numbers of either are, and how they add up, is said here and, compiled, in
`contact.plane.narrow`, `geometry.rotation` and `dynamics.explicit`.
"""

from __future__ import annotations

import math

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry import rotation


def n_dof(dimension: int) -> int:
    """Degrees of freedom of a body."""
    return 3 if dimension == 2 else 6


def design_pose(n: int, dimension: int) -> Array:
    """Poses of bodies as designed, (n, n_pose), with 3 numbers in the plane and 7 in space."""
    pose = np.zeros((n, 3 if dimension == 2 else 7))
    if dimension == 3:
        pose[:, 3] = 1.0
    return pose


def translations(field: Array) -> Array:
    """Those of a field of poses, motions or forces, a view (..., dim)."""
    return field[..., : 2 if field.shape[-1] == 3 else 3]


def rotations(field: Array) -> Array:
    """The rest of a field of motions or forces (..., n_dof): rotations or moments, a view."""
    return field[..., 2 if field.shape[-1] == 3 else 3 :]


def rotation_vectors(pose: Array) -> Array:
    """By how much bodies have turned: angles (n,) [rad] in the plane, rotation vectors (n, 3) [rad]
    about axes of the world in space, the shorter way round."""
    return pose[:, 2] if pose.shape[1] == 3 else _vector(pose[:, 3:])


def moved(pose: Array, increment: Array, axes: Array) -> Array:
    """Poses (n, n_pose) after increments (n, n_dof).

    ``axes`` (n, dim, dim) are the principal axes as designed, in columns; of space only.
    """
    if pose.shape[1] == 3:
        return pose + increment
    after = np.empty_like(pose)
    rotation.moved(pose, increment, axes, after)
    return after


def difference(pose: Array, before: Array, axes: Array) -> Array:
    """Increments (n, n_dof) that lead from the poses ``before`` to ``pose``; see `moved`."""
    if pose.shape[1] == 3:
        return pose - before
    increment = np.empty((len(pose), 6))
    rotation.difference(pose, before, axes, increment)
    return increment


def spun_on(velocity: Array, increment: Array, mass: Array, time_step: float) -> Array:
    """Velocities (n, n_dof) after velocities ``velocity`` in which no force acts.

    Translations go on; in space a body keeps its moment of momentum, and so changes its spin.  See
    `geometry.rotation.spin_on`, also for ``increment`` (n, n_dof), which led to the present place.
    """
    if velocity.shape[1] == 3 or not rotations(velocity).any():
        return velocity
    after = velocity.copy()
    rotation.spin_on(increment, mass, time_step, after)
    return after


def spun_by_impulses(velocity: Array, carried: Array, mass: Array, time_step: float) -> Array:
    """Velocities (n, n_dof) that a step ends with, in which impulses have changed those ``carried``
    into ``velocity``; in space so that no moment of momentum is lost, see
    `geometry.rotation.spin_by_impulses`."""
    if velocity.shape[1] == 3:
        return velocity
    after = velocity.copy()
    rotation.spin_by_impulses(carried, mass, time_step, after)
    return after


def places(centroid: Array, pose: Array) -> Array:
    """Where centroids are, (n, dim) [m]."""
    return centroid + translations(pose)


def rotated(vectors: Array, pose: Array) -> Array:
    """Vectors (n, dim) of bodies after the rotations of their poses (n, n_pose)."""
    if pose.shape[1] == 7:
        return vectors + _rotate(pose[:, 3:], vectors)
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x, y = vectors[:, 0], vectors[:, 1]
    after = np.empty_like(vectors)
    after[:, 0], after[:, 1] = c * x - s * y, s * x + c * y
    return after


def rotated_vector(vector: Array, pose: Array) -> Array:
    """A vector (dim,) of one body after the rotation of its pose (n_pose,)."""
    if len(pose) == 7:
        return np.asarray(rotated(vector[None], pose[None])[0])
    (x, y), theta = vector.tolist(), float(pose[2])
    c, s = math.cos(theta), math.sin(theta)
    return np.array([c * x - s * y, s * x + c * y])


def moved_points(
    points: Array, owner: IntArray, centroid: Array, pose: Array, *, linear: bool = False
) -> Array:
    """Material points (k, dim) [m] of blocks ``owner`` (k,), carried along in the poses.

    With ``linear`` poses are a velocity field (n, n_dof), in space with rotations about the axes of
    the world, and every point goes straight on along its velocity.  What a velocity field holds
    together then stays together however far it is drawn: joints that do not open or slide are
    closed and hinges meet.  Blocks keep their form and grow by sqrt(1 + theta^2).
    """
    arm = points - centroid[owner]
    # Rotation less identity, so that a block at rest stays to the last bit where it is.
    if points.shape[1] == 3:
        turn = np.cross(pose[owner, 3:], arm) if linear else _rotate(pose[owner, 3:], arm)
        return np.asarray(points + (pose[owner, :3] + turn), np.float64)
    theta = pose[owner, 2]
    cosine, sine = (0.0 * theta, theta) if linear else (np.cos(theta) - 1.0, np.sin(theta))
    x, y = arm[:, 0], arm[:, 1]
    turn = np.column_stack((cosine * x - sine * y, sine * x + cosine * y))
    return np.asarray(points + (translations(pose)[owner] + turn), np.float64)


def displacement(arm: Array, pose: Array) -> Array:
    """Displacement (dim,) [m] of a point at ``arm`` (dim,) from its body's centroid, in a pose of
    the body (n_pose,)."""
    if len(pose) == 7:
        return np.asarray(pose[:3] + _rotate(pose[None, 3:], arm[None])[0])
    ux, uy, theta = pose.tolist()  # Python's numbers: this is asked for at every step
    x, y = arm.tolist()
    c, s = math.cos(theta), math.sin(theta)
    return np.array([ux + (c - 1.0) * x - s * y, uy + s * x + (c - 1.0) * y])


def advance(arm: Array, motion: Array, axis: Array, axes: Array) -> float:
    """Displacement along ``axis`` (dim,) [m] of a point at ``arm`` from its body's centroid, by an
    increment of the body (n_dof,), whose principal axes are the columns of ``axes`` before."""
    if len(motion) == 6:
        return float(rotation.advance(arm, motion, axis, axes))
    # Python's numbers, here and below: this is asked for several times in every step.
    (ux, uy, theta), (x, y), (dx, dy) = motion.tolist(), arm.tolist(), axis.tolist()
    rotated_x, rotated_y = _rotated_arm(x, y, theta)
    return float(dx * (ux + rotated_x - x) + dy * (uy + rotated_y - y))


def gradient_of_advance(arm: Array, motion: Array, axis: Array, axes: Array) -> Array:
    """How `advance` goes with a further increment, (n_dof,)."""
    if len(motion) == 6:
        gradient = np.empty(6)
        rotation.gradient_of_advance(arm, motion, axis, axes, gradient)
        return gradient
    dx, dy = axis.tolist()
    x, y = arm.tolist()
    rotated_x, rotated_y = _rotated_arm(x, y, float(motion[2]))
    return np.array([dx, dy, dy * rotated_x - dx * rotated_y])


def _rotated_arm(x: float, y: float, theta: float) -> tuple[float, float]:
    s, versine = math.sin(theta), 2.0 * math.sin(0.5 * theta) ** 2
    return x * (1.0 - versine) - s * y, y * (1.0 - versine) + s * x


def bound(increment: Array, extent: Array) -> Array:
    """How far any point of a body may move at most, (n,) [m]; ``extent`` (n,) [m] is that of the
    farthest from the centroid."""
    if increment.shape[1] == 3:
        return np.hypot(increment[:, 0], increment[:, 1]) + extent * np.abs(increment[:, 2])
    straight, turn = translations(increment), rotations(increment)
    return np.asarray(np.linalg.norm(straight, axis=1) + extent * np.linalg.norm(turn, axis=1))


def moments(arm: Array, force: Array) -> Array:
    """Moments of forces (..., dim) at arms (..., dim): (..., 1) in the plane, (..., 3) in space."""
    if force.shape[-1] == 3:
        return np.cross(arm, force)
    return (arm[..., 0] * force[..., 1] - arm[..., 1] * force[..., 0])[..., None]


def across(spin: Array, arm: Array) -> Array:
    """Velocities (k, dim) by spins (k, 1 or 3) at arms (k, dim)."""
    if arm.shape[1] == 3:
        return np.cross(spin, arm)
    return spin * np.column_stack((-arm[:, 1], arm[:, 0]))


def axial(tensor: Array) -> Array:
    """Moments sum a x P of tensors sum a P^T, (n, 1) in the plane, (n, 3) in space."""
    if tensor.shape[1] == 2:
        return (tensor[:, 0, 1] - tensor[:, 1, 0])[:, None]
    t = tensor
    return np.column_stack(
        (t[:, 1, 2] - t[:, 2, 1], t[:, 2, 0] - t[:, 0, 2], t[:, 0, 1] - t[:, 1, 0])
    )


def rotation_matrices(pose: Array) -> Array:
    """By which blocks have turned in poses (n, n_pose), (n, dim, dim)."""
    if pose.shape[1] == 3:
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        return np.stack((np.column_stack((c, -s)), np.column_stack((s, c))), axis=1)
    w, v = pose[:, 3], pose[:, 4:]
    cross = np.zeros((len(pose), 3, 3))
    cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0] = v.T
    cross -= cross.transpose(0, 2, 1)
    return np.eye(3) + 2.0 * (w[:, None, None] * cross + cross @ cross)


def about_own_axes(turning: Array, axes: Array) -> Array:
    """Moments or spins (n, n_rot) about the axes of the world as those about the bodies' own, in
    the columns of ``axes`` (n, dim, dim); in the plane they are the same."""
    return turning if turning.shape[1] == 1 else np.einsum("nij,ni->nj", axes, turning)


def about_the_world(turning: Array, axes: Array) -> Array:
    """The reverse of `about_own_axes`."""
    return turning if turning.shape[1] == 1 else np.einsum("nij,nj->ni", axes, turning)


def moments_falling(tensor: Array, axes: Array) -> Array:
    """By how much the moments of tensors B (n, dim, dim) fall as bodies turn on, (n, n_rot, n_rot).

    From d(a x P) = (B - tr B) omega for a rotation omega, in space about the axes in the columns of
    ``axes``.
    """
    trace = np.einsum("nii->n", tensor)[:, None, None]
    if tensor.shape[1] == 2:
        return trace
    world = trace * np.eye(3) - tensor
    return np.asarray(np.einsum("nki,nkl,nlj->nij", axes, world, axes))


def inertia_about_the_world(moments_of_inertia: Array, axes: Array) -> Array:
    """Of bodies (n, n_rot) about their own axes, (n, n_rot, n_rot)."""
    if axes.shape[1] == 2:
        return moments_of_inertia[:, :, None]
    return np.asarray(axes @ (moments_of_inertia[:, :, None] * axes.transpose(0, 2, 1)))


def orbits(arm: Array) -> Array:
    """Moment of inertia of unit masses at arms (n, dim), (n, n_rot, n_rot) [m2]."""
    square = np.einsum("ni,ni->n", arm, arm)[:, None, None]
    if arm.shape[1] == 2:
        return square
    return square * np.eye(3) - arm[:, :, None] * arm[:, None, :]


def chord_spin(before: Array, after: Array) -> Array:
    """2 tan(theta / 2) along the axis of the rotations between poses, (n, 1 or 3)."""
    if after.shape[1] == 3:
        return np.asarray(2.0 * np.tan(0.5 * (after[:, 2] - before[:, 2]))[:, None])
    relative = _product(after[:, 3:], before[:, 3:] * np.array([1.0, -1.0, -1.0, -1.0]))
    return np.asarray(2.0 * relative[:, 1:] / relative[:, :1])


def rotated_by(pose: Array, angle: float, axis: Array | None) -> None:
    """Turn poses as designed (n, n_pose) by an angle [rad], in space about a unit vector."""
    if axis is None:
        pose[:, 2] = angle
        return
    pose[:, 3] = math.cos(0.5 * angle)
    pose[:, 4:] = math.sin(0.5 * angle) * axis


def rotated_back(pose: Array) -> Array:
    """Poses (n, n_pose) without translation, turned by as much the other way round."""
    back = np.zeros_like(pose)
    if pose.shape[1] == 3:
        back[:, 2] = -pose[:, 2]
    else:
        back[:, 3], back[:, 4:] = pose[:, 3], -pose[:, 4:]
    return back


def in_space(vectors: Array) -> Array:
    """Vectors of two components (..., 2) with a third, zero; those of three as they are."""
    if vectors.shape[-1] == 3:
        return vectors
    return np.concatenate((vectors, np.zeros((*vectors.shape[:-1], 1))), axis=-1)


def spin_in_space(spin: Array) -> Array:
    """A spin (1,) of the plane as a vector (3,); one of space as it is."""
    return np.array([0.0, 0.0, spin[0]]) if len(spin) == 1 else spin


def tangents(normal: Array, first: Array) -> Array:
    """Along which tangential reactions are counted, (n, dim - 1, dim): in the plane the normal
    (n, 2) turned clockwise, in space the first tangent (n, 3) and normal x first."""
    if normal.shape[1] == 2:
        return np.stack((normal[:, 1], -normal[:, 0]), axis=1)[:, None]
    return np.stack((first, np.cross(normal, first)), axis=1)


def tangents_kept(normal: Array, first: Array) -> Array:
    """First tangents (n, 3), where there are normals of space; (n, 0) of those of the plane, which
    tell them.  Raises `ValueError` where there are none."""
    n, width = len(normal), 3 if normal.shape[-1] == 3 else 0
    if not width or not n:
        return np.zeros((n, width))
    if first.shape != (n, width):
        raise ValueError("contacts in space have a tangent each: (n_contacts, 3)")
    return first


def beside(way: Array) -> list[Array]:
    """Tangential directions (n, dim - 1) a quarter turn on, as far as there are any."""
    return [] if way.shape[1] == 1 else [np.column_stack((-way[:, 1], way[:, 0]))]


def couple_about(k: int, dim: int) -> tuple[Array, Array]:
    """Direction of a force, and of its arm, whose moment is the k-th of a body."""
    force, arm = np.zeros(dim), np.zeros(dim)
    first = 0 if dim == 2 else 2
    force[(k + 1) % dim], arm[(k + first) % dim] = 1.0, 1.0
    return force, arm


def any_tangent(normal: Array) -> Array:
    """A unit vector normal to each (n, dim), in the plane the normal turned clockwise."""
    if normal.shape[1] == 2:
        return np.column_stack((normal[:, 1], -normal[:, 0]))
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    found = np.cross(normal, axis)
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def across_both(first: Array, second: Array) -> list[Array]:
    """Vectors across two others: in the plane none, in space one, first x second."""
    return [] if len(first) == 2 else [np.cross(first, second)]


def angles_of(rotated_by: Array) -> Array:
    """Sizes of rotations as `rotation_vectors` tells them, (n,) [rad]."""
    return np.abs(rotated_by) if rotated_by.ndim == 1 else np.linalg.norm(rotated_by, axis=1)


def _product(p: Array, q: Array) -> Array:
    """Quaternions (n, 4): first ``q``, then ``p``."""
    w = p[:, :1] * q[:, :1] - np.sum(p[:, 1:] * q[:, 1:], axis=1, keepdims=True)
    v = p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])
    return np.concatenate((w, v), axis=1)


def _rotate(quaternion: Array, vectors: Array) -> Array:
    """What rotations (n, 4) add to vectors (n, 3): as precise as the rotations are small."""
    w, v = quaternion[:, :1], quaternion[:, 1:]
    across = np.cross(v, vectors)
    return np.asarray(2.0 * (w * across + np.cross(v, across)))


def _vector(quaternion: Array) -> Array:
    """Rotation vectors (n, 3) [rad] of quaternions, the shorter way round."""
    q = np.where(quaternion[:, :1] < 0.0, -quaternion, quaternion)
    size = np.linalg.norm(q[:, 1:], axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(size, q[:, :1])
    share = np.divide(angle, size, out=np.full_like(size, 2.0), where=size > 0.0)
    return np.asarray(share * q[:, 1:])
