"""What joints carry: contact points gathered joint by joint, as resultants.

A joint is where two blocks were designed to meet on one plane, however many faces that takes; pairs
that meet elsewhere later get a joint of their own, without a size.  Each has a frame that its first
block carries along: the normal from block a to block b, then the tangents.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, IntArray
from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.motion import moved_points, places, rotated_back, tangents

#: State of a joint, in this order: nothing closed, all that is closed sticks, all of it slides,
#: part of it is open.
JOINT_OPEN, JOINT_STICKING, JOINT_SLIDING, JOINT_PARTLY_OPEN = range(4)
#: Normals that agree to this, and planes to this share of a joint's size, are one plane.
SAME_PLANE = 1e-6


@dataclass(kw_only=True)
class Joints:
    """Joints with their frames as designed; grows by `add` where blocks meet anew."""

    block_a: list[int] = field(default_factory=list)
    block_b: list[int] = field(default_factory=list)
    centre: list[Array] = field(default_factory=list)  # (dim,) m, as designed
    frame: list[Array] = field(default_factory=list)  # (dim, dim) rows: normal, tangents
    half: list[Array] = field(default_factory=list)  # (dim - 1,) m, half extents; 0: not designed
    polygons: list[list[Array]] = field(default_factory=list)  # of each joint, corners (m, dim) m

    def __len__(self) -> int:
        return len(self.block_a)

    @classmethod
    def designed(cls, faces: Interfaces) -> Joints:
        """Joints of the faces that lie on each other; those of a pair in one plane are one."""
        joints = cls()
        split = np.split(faces.corners, faces.offset[1:-1]) if len(faces.block_a) else []
        planes: dict[tuple[int, int], list[tuple[int, Array]]] = {}
        of_joint: list[list[int]] = []
        for k, corners in enumerate(split):
            own = planes.setdefault((int(faces.block_a[k]), int(faces.block_b[k])), [])
            for joint, normal in own:
                off = float(np.abs((corners - split[of_joint[joint][0]][0]) @ normal).max())
                near = SAME_PLANE * max(float(np.ptp(corners, axis=0).max()), 1e-300) * 10.0
                if np.abs(faces.normal[k] - normal).max() < SAME_PLANE and off < near:
                    of_joint[joint].append(k)
                    break
            else:
                own.append((len(of_joint), faces.normal[k]))
                of_joint.append([k])
        for rows in of_joint:
            k = rows[0]
            joints._add_designed(
                int(faces.block_a[k]),
                int(faces.block_b[k]),
                _frame(faces.normal[k], faces.tangent[k]),
                [split[row] for row in rows],
            )
        return joints

    def _add_designed(self, a: int, b: int, frame: Array, polygons: list[Array]) -> None:
        corners = np.vstack(polygons) @ frame.T
        low, high = corners.min(axis=0), corners.max(axis=0)
        self.block_a.append(a)
        self.block_b.append(b)
        self.centre.append(frame.T @ (0.5 * (low + high)))
        self.frame.append(frame)
        self.half.append(0.5 * (high - low)[1:])
        self.polygons.append(polygons)

    def add(self, a: int, b: int, centre: Array, normal: Array) -> None:
        """A joint where two blocks meet that were not designed to."""
        across = np.eye(len(normal))[int(np.argmin(np.abs(normal)))]
        tangent = across - (across @ normal) * normal
        self.block_a.append(a)
        self.block_b.append(b)
        self.centre.append(centre)
        self.frame.append(_frame(normal, tangent / np.linalg.norm(tangent)))
        self.half.append(np.zeros(len(normal) - 1))
        self.polygons.append([])


def _frame(normal: Array, tangent: Array) -> Array:
    """Rows: normal, tangent and, in space, their product."""
    return np.array([normal, *tangents(normal[None], tangent[None])[0]])


@dataclass(frozen=True, kw_only=True)
class Assigned:
    """Contact points of several points of the curve, in the frames of their joints."""

    n_points: int
    point: IntArray  # (m,) row of the point of the curve, from 0
    joint: IntArray  # (m,)
    arm: Array  # (m, dim - 1) m, from the joint's centre along its tangents
    force: Array  # (m, dim) N on block b: along normal and tangents
    status: IntArray  # (m,)


class Assigner:
    """Finds the joint of every contact point.

    Parameters
    ----------
    joints
        Those as designed; others are added to them as they come.
    centroid
        Of the blocks, (n, dim) [m].
    """

    def __init__(self, joints: Joints, centroid: Array) -> None:
        self.joints, self._centroid = joints, centroid
        self._known: dict[tuple[int, int], list[int]] = {}
        for j, pair in enumerate(zip(joints.block_a, joints.block_b, strict=True)):
            self._known.setdefault(pair, []).append(j)

    def assign(self, contacts: ContactForces, counts: IntArray, poses: Array) -> Assigned:
        """Contact points of points of the curve, one after the other.

        Parameters
        ----------
        counts
            How many each point has, (p,).
        poses
            Of the blocks at these points, (p, n, n_pose).
        """
        n, swapped = len(self._centroid), contacts.block_a > contacts.block_b
        a = np.minimum(contacts.block_a, contacts.block_b)
        b = np.maximum(contacts.block_a, contacts.block_b)
        sign = np.where(swapped, -1.0, 1.0)[:, None]
        point = np.repeat(np.arange(len(counts)), counts)
        # Blocks of all points in one list, so that all contacts are moved back at once.
        flat = poses.reshape(-1, poses.shape[2])
        row = point * n + a
        place, normal, force = contacts.position, contacts.normal * sign, contacts.vectors() * sign
        local = _rotated_back(flat[row], place - places(self._centroid[a], flat[row]))
        normal = _rotated_back(flat[row], normal)
        force = _rotated_back(flat[row], force)
        local = self._centroid[a] + local
        joint = self._joint_of(a, b, local, normal)
        frame, centre = np.array(self.joints.frame), np.array(self.joints.centre)
        if not len(joint):
            frame, centre = np.zeros((0, *(place.shape[1],) * 2)), np.zeros((0, place.shape[1]))
        return Assigned(
            n_points=len(counts),
            point=point,
            joint=joint,
            arm=np.einsum("mij,mj->mi", frame[joint], local - centre[joint])[:, 1:],
            force=np.einsum("mij,mj->mi", frame[joint], force),
            status=contacts.status,
        )

    def _joint_of(self, a: IntArray, b: IntArray, local: Array, normal: Array) -> IntArray:
        """The joint of the pair whose plane is nearest, (m,); new ones where a pair has none."""
        found = np.zeros(len(a), np.int64)
        key = a * len(self._centroid) + b
        order = np.argsort(key, kind="stable")
        starts = np.flatnonzero(np.diff(key[order], prepend=-1))
        for rows in np.split(order, starts[1:]) if len(order) else []:
            pair = (int(a[rows[0]]), int(b[rows[0]]))
            known = self._known.setdefault(pair, [])
            if not known:
                known.append(len(self.joints))
                across = normal[rows[0]]
                self.joints.add(*pair, local[rows].mean(axis=0), across / np.linalg.norm(across))
            if len(known) == 1:
                found[rows] = known[0]
                continue
            frame = np.array([self.joints.frame[j][0] for j in known])
            centre = np.array([self.joints.centre[j] for j in known])
            reach = np.array([self.joints.half[j].max(initial=0.0) for j in known])
            apart = local[rows, None] - centre
            distance = np.linalg.norm(apart, axis=2) / np.maximum(reach, 1e-12)
            best = np.argmin(distance - 4.0 * normal[rows] @ frame.T, axis=1)
            found[rows] = np.array(known)[best]
        return found


def _rotated_back(pose: Array, vectors: Array) -> Array:
    """Vectors (m, dim) of the world in the axes that blocks had as designed."""
    back = rotated_back(pose)
    rows = np.arange(len(vectors))
    return moved_points(vectors, rows, np.zeros_like(vectors), back)


@dataclass(frozen=True, kw_only=True)
class Resultants:
    """What every joint carries at every point of the curve; k joints, those that came late too."""

    force: Array  # (p, k, dim) N on block b, along normal and tangents
    arm: Array  # (p, k, dim - 1) m, of the centre of pressure from the joint's centre
    state: NDArray[np.uint8]  # (p, k)

    @classmethod
    def of(cls, parts: list[Assigned], n_points: int, n_joints: int, dimension: int) -> Resultants:
        """Sums over the contact points of each joint."""
        force = np.zeros((n_points, n_joints, dimension))
        arm = np.zeros((n_points, n_joints, dimension - 1))
        state = np.zeros((n_points, n_joints), np.uint8)
        first = 0
        for part in parts:
            rows = slice(first, first + part.n_points)
            force[rows], arm[rows], state[rows] = _sums(part, n_joints, dimension)
            first += part.n_points
        return cls(force=force, arm=arm, state=state)


def _sums(part: Assigned, n_joints: int, dimension: int) -> tuple[Array, Array, NDArray[np.uint8]]:
    """Force, centre of pressure and state of every joint at every point of one part."""
    size, shape = part.n_points * n_joints, (part.n_points, n_joints)
    cell = part.point * n_joints + part.joint

    def total(weights: Array) -> Array:
        return np.asarray(np.bincount(cell, weights, minlength=size), np.float64)

    force = np.stack([total(part.force[:, i]) for i in range(dimension)], axis=-1)
    pressed = np.maximum(part.force[:, 0], 0.0)
    sum_pressed = total(pressed)
    loaded = sum_pressed > 0.0
    arm = np.stack([total(pressed * part.arm[:, i]) for i in range(dimension - 1)], axis=-1)
    arm = np.divide(arm, sum_pressed[:, None], out=np.zeros_like(arm), where=loaded[:, None])
    n_open, n_stick, n_slide = (
        total((part.status == status).astype(np.float64)) for status in (OPEN, STICKING, SLIDING)
    )
    closed = n_stick + n_slide
    few = closed < dimension  # those that were left behind are watched no more
    state = np.where(
        closed == 0,
        JOINT_OPEN,
        np.where(
            n_stick == 0,
            JOINT_SLIDING,
            np.where((n_open > 0) | few, JOINT_PARTLY_OPEN, JOINT_STICKING),
        ),
    )
    states = state.astype(np.uint8).reshape(shape)
    return force.reshape(*shape, -1), arm.reshape(*shape, -1), states
