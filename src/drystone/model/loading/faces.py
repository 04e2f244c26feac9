"""Free faces of blocks, and the forces of what lies or leans on them.

A face is free where no other block touches it: what acts on the whole face, less what would act on
its joints.  Loads are linear in the place, so that sums over corners are exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.model.assembly import Assembly
from drystone.model.loading.dead_forces import DeadForces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Places along a segment, and in a triangle, of which the mean of a square is exact.
_ON_SEGMENT = np.array([[0.5 + s / math.sqrt(12.0), 0.5 - s / math.sqrt(12.0)] for s in (-1, 1)])
_IN_TRIANGLE = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])


@dataclass(frozen=True, kw_only=True, eq=False)
class Traction:
    """Force over area: even, or of a fill."""

    even: Array | None = None  # (dim,) Pa
    unit_weight: float = 0.0  # N/m3
    level: float = 0.0  # m
    at_rest: float = 0.0  # sideways over upright stress

    def at(self, points: Array, normal: Array, up: Array) -> Array:
        """At points (..., dim) [m] of a face with an outward normal, (..., dim) [Pa]."""
        if self.even is not None:
            return np.broadcast_to(self.even, points.shape)
        rise = float(normal @ up) * up
        depth = self.level - points @ up
        return -self.unit_weight * depth[..., None] * (rise + self.at_rest * (normal - rise))

    def wetted(self, corners: Array, up: Array) -> Array:
        """The part of a polygon (m, dim) where it acts."""
        return corners if self.even is not None else _below(corners, up, self.level)


@dataclass(frozen=True, kw_only=True, eq=False)
class Patch:
    """A face of a block, or a joint on it, which counts less."""

    body: int
    corners: Array  # (m, dim) m, in the plane both ends
    normal: Array  # (dim,) outwards
    sign: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Faces:
    """Free faces: faces less joints."""

    patches: tuple[Patch, ...]

    def area(self, assembly: Assembly) -> float:
        """Of all [m2]; joints that rounding makes larger than their face leave nothing."""
        even = Traction(even=np.eye(assembly.dimension)[0])
        whole = sum(_sizes(p.corners).sum() for p in self.patches if p.sign > 0.0)
        area = float(self.forces(assembly, even).force[:, 0].sum())
        return area if area > 1e-9 * whole * assembly.thickness else 0.0

    def forces(self, assembly: Assembly, traction: Traction) -> DeadForces:
        """Of what acts on them."""
        n, dim = assembly.centroid.shape
        force, lever = np.zeros((n, dim)), np.zeros((n, dim, dim))
        for patch in self.patches:
            corners = traction.wetted(patch.corners, assembly.up)
            if len(corners) < dim:
                continue
            points, area = _places(corners)  # (k, q, dim), (k,)
            load = traction.at(points, patch.normal, assembly.up)
            share = patch.sign * assembly.thickness * area[:, None, None] / points.shape[1] * load
            arm = points - assembly.centroid[patch.body]
            force[patch.body] += share.sum(axis=(0, 1))
            lever[patch.body] += np.einsum("kqi,kqj->ij", arm, share)
        return DeadForces(force=force, lever=lever)


def has_faces(assembly: Assembly, i: int) -> bool:
    """Whether the faces of a block are known apart from those between its parts."""
    block = assembly.blocks[i]
    if len(block.parts) > 1:
        return False
    return assembly.dimension == 2 or bool(block.faces) or len(assembly.figures[i].parts) == 1


def faces_towards(assembly: Assembly, rows: IntArray, side: Array, within: float) -> Faces:
    """Free faces of blocks ``rows`` whose outward normals are ``within`` [degrees] of a side."""
    least = math.cos(math.radians(within)) - 1e-6
    patches = []
    for i in rows.tolist():
        for corners in _faces_of(assembly, i):
            normal = _normal(corners)
            if normal @ side >= least:
                patches.append(Patch(body=i, corners=corners, normal=normal, sign=1.0))
    joints = assembly.interfaces
    chosen = np.zeros(assembly.n_bodies, bool)
    chosen[rows] = True
    for bodies, sense in ((joints.block_a, 1.0), (joints.block_b, -1.0)):
        looks = sense * (joints.normal @ side) >= least
        for j in np.flatnonzero(chosen[bodies] & looks).tolist():
            corners = joints.corners[joints.offset[j] : joints.offset[j + 1]]
            body = int(bodies[j])
            normal = sense * joints.normal[j]
            patches.append(Patch(body=body, corners=corners, normal=normal, sign=-1.0))
    return Faces(patches=tuple(patches))


def _faces_of(assembly: Assembly, i: int) -> list[Array]:
    """Corners of every face of a block, (m, dim)."""
    block, parts = assembly.blocks[i], assembly.figures[i].parts
    if assembly.dimension == 2:
        outline = block.vertices
        return list(np.stack((outline, np.roll(outline, -1, axis=0)), axis=1))
    if block.faces:
        return [block.vertices[list(face)] for face in block.faces]
    return [parts[0].vertices[list(face)] for face in parts[0].faces]


def _normal(corners: Array) -> Array:
    """Outward: to the right of an edge; of a polygon that runs counter-clockwise from outside."""
    if corners.shape[1] == 2:
        x, y = corners[1] - corners[0]
        normal = np.array([y, -x])
    else:
        normal = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(0)
    return np.asarray(normal / np.linalg.norm(normal))


def _below(corners: Array, up: Array, level: float) -> Array:
    """What of a polygon, or a segment, lies below a level."""
    height = corners @ up - level
    if (height <= 0.0).all():
        return corners
    kept: list[Array] = []
    n = len(corners)
    edges = [(0, 1)] if corners.shape[1] == 2 else [(k, (k + 1) % n) for k in range(n)]
    for k, following in edges:
        if height[k] <= 0.0:
            kept.append(corners[k])
        if height[k] * height[following] < 0.0:
            share = height[k] / (height[k] - height[following])
            kept.append(corners[k] + share * (corners[following] - corners[k]))
    if corners.shape[1] == 2 and height[1] <= 0.0:
        kept.append(corners[1])
    return np.array(kept).reshape(-1, corners.shape[1])


def _places(corners: Array) -> tuple[Array, Array]:
    """Places (k, q, dim) whose mean stands for each part of a polygon, and the parts' sizes (k,);
    sizes of parts that a polygon does not have count less."""
    if corners.shape[1] == 2:
        return (_ON_SEGMENT @ corners)[None], _sizes(corners)
    fan = np.stack((np.broadcast_to(corners[0], corners[2:].shape), corners[1:-1], corners[2:]), 1)
    return np.einsum("qc,kcd->kqd", _IN_TRIANGLE, fan), _sizes(corners)


def _sizes(corners: Array) -> Array:
    """Length of a segment, (1,) [m]; areas of the fan of a polygon, (m - 2,) [m2]."""
    if corners.shape[1] == 2:
        return np.array([float(np.linalg.norm(corners[1] - corners[0]))])
    cross = 0.5 * np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0])
    return np.asarray(cross @ _normal(corners))
