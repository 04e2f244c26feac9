"""Free faces of blocks, and the forces of what lies or leans on them.

A face is free where no other block touches it: what acts on the whole face, less what would act on
its joints.  Loads are linear in the place, so that sums over corners are exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry.patches import (
    below,
    faces_known,
    faces_of,
    normal_of,
    places_on,
    sizes_of,
)
from drystone.model.assembly import Assembly
from drystone.model.loading.dead_forces import DeadForces


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
        return corners if self.even is not None else below(corners, up, self.level)


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
        whole = sum(sizes_of(p.corners).sum() for p in self.patches if p.sign > 0.0)
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
            points, area = places_on(corners)  # (k, q, dim), (k,)
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
    return faces_known(block.vertices, block.faces, assembly.figures[i].parts)


def faces_towards(assembly: Assembly, rows: IntArray, side: Array, within: float) -> Faces:
    """Free faces of blocks ``rows`` whose outward normals are ``within`` [degrees] of a side."""
    least = math.cos(math.radians(within)) - 1e-6
    patches = []
    for i in rows.tolist():
        block = assembly.blocks[i]
        for corners in faces_of(block.vertices, block.faces, assembly.figures[i].parts):
            normal = normal_of(corners)
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
