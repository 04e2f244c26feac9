"""How rigid bodies move: poses, the increments between them, and what they do to points.

A pose is a body's motion since the design, about its centroid; an increment leads from one pose to
another.  In the plane both are (u_x, u_y, theta) [m, m, rad].  What the numbers of either are, and
how they add up, is said here and, compiled, in `kernels.narrow` and `kernels.explicit`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: The axis that points up is the last one: y in the plane.
UP = -1


def n_dof(dimension: int) -> int:
    """Degrees of freedom of a body."""
    return 3 if dimension == 2 else 6


def translations(field: Array) -> Array:
    """Those of a field of motions or forces (..., n_dof), a view (..., dim)."""
    return field[..., : 2 if field.shape[-1] == 3 else 3]


def moved(pose: Array, increment: Array) -> Array:
    """Poses after an increment, (n, n_dof)."""
    return pose + increment


def difference(pose: Array, before: Array) -> Array:
    """Increments that lead from the poses ``before``, (n, n_dof)."""
    return pose - before


def places(centroid: Array, pose: Array) -> Array:
    """Where centroids are, (n, dim) [m]."""
    return centroid + translations(pose)


def turned(vectors: Array, motion: Array) -> Array:
    """Vectors (n, dim) of bodies, after the rotation of each one's motion (n, n_dof)."""
    c, s = np.cos(motion[:, 2]), np.sin(motion[:, 2])
    x, y = vectors[:, 0], vectors[:, 1]
    after = np.empty_like(vectors)
    after[:, 0], after[:, 1] = c * x - s * y, s * x + c * y
    return after


def moved_points(
    points: Array, owner: IntArray, centroid: Array, pose: Array, *, linear: bool = False
) -> Array:
    """Material points (k, dim) [m] of blocks ``owner`` (k,), carried along in the poses (n, n_dof).

    With ``linear`` every point goes straight on along its velocity.  What a velocity field holds
    together then stays together however far it is drawn: joints that do not open or slide are
    closed and hinges meet.  Blocks keep their form and grow by sqrt(1 + theta^2).
    """
    arm = points - centroid[owner]
    theta = pose[owner, 2]
    # Rotation less identity, so that a block at rest stays to the last bit where it is.
    cosine, sine = (0.0 * theta, theta) if linear else (np.cos(theta) - 1.0, np.sin(theta))
    x, y = arm[:, 0], arm[:, 1]
    turn = np.column_stack((cosine * x - sine * y, sine * x + cosine * y))
    return np.asarray(points + (translations(pose)[owner] + turn), np.float64)


def displacement(arm: Array, motion: Array) -> Array:
    """Displacement (dim,) [m] of a point at ``arm`` (dim,) from its body's centroid, by a motion of
    the body (n_dof,)."""
    ux, uy, theta = motion.tolist()  # Python's numbers: this is asked for at every step
    x, y = arm.tolist()
    c, s = math.cos(theta), math.sin(theta)
    return np.array([ux + (c - 1.0) * x - s * y, uy + s * x + (c - 1.0) * y])


def advance(arm: Array, motion: Array, axis: Array) -> float:
    """That displacement along ``axis`` (dim,) [m]."""
    (ux, uy), (x, y), (dx, dy) = motion[:2].tolist(), arm.tolist(), axis.tolist()
    turned_x, turned_y = _turned_arm(arm, motion)
    return float(dx * (ux + turned_x - x) + dy * (uy + turned_y - y))


def gradient_of_advance(arm: Array, motion: Array, axis: Array) -> Array:
    """How `advance` goes with the motion, (n_dof,)."""
    (dx, dy), (turned_x, turned_y) = axis.tolist(), _turned_arm(arm, motion)
    return np.array([dx, dy, dy * turned_x - dx * turned_y])


def _turned_arm(arm: Array, motion: Array) -> tuple[float, float]:
    (x, y), theta = arm.tolist(), float(motion[2])
    s, versine = math.sin(theta), 2.0 * math.sin(0.5 * theta) ** 2
    return x * (1.0 - versine) - s * y, y * (1.0 - versine) + s * x


def bound(increment: Array, extent: Array) -> Array:
    """How far any point of a body may move at most, (n,) [m]; ``extent`` (n,) [m] is that of the
    farthest from the centroid."""
    return np.hypot(increment[:, 0], increment[:, 1]) + extent * np.abs(increment[:, 2])


def moments(arm: Array, force: Array) -> Array:
    """Moments (n,) [N m] of forces (n, dim) that act at arms (n, dim)."""
    return arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
