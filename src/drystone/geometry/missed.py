"""Faces that lie near each other without a joint: missed by a tolerance, or apart on purpose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.tolerances import MISSED_GAP, MISSED_SHARE
from drystone.geometry.interfaces import Interfaces, polygon_areas

if TYPE_CHECKING:
    from drystone.model.assembly import Assembly


@dataclass(frozen=True, kw_only=True, eq=False)
class Missed:
    """Pairs of faces of two blocks between which there is no joint at all."""

    joints: Interfaces  # as they would be within the distance
    gap: Array  # (n,) m, largest distance of the two faces over what they share

    @property
    def size(self) -> Array:
        """What the faces share, (n,) m, in space m2."""
        return self.joints.size

    @classmethod
    def of(cls, assembly: Assembly) -> Missed:
        """Those of an assembly, but for pairs of supports."""
        found = Interfaces.of(assembly.packed, MISSED_GAP * assembly.smallest_extent)
        designed, n = assembly.interfaces, assembly.n_bodies
        known = np.unique(designed.block_a * n + designed.block_b)
        fixed = assembly.fixed
        missed = ~np.isin(found.block_a * n + found.block_b, known)
        missed &= ~(fixed[found.block_a] & fixed[found.block_b])
        sizes = _sizes(assembly)
        least = np.minimum(sizes[found.face_a], sizes[found.face_b])
        missed &= found.size > MISSED_SHARE * least
        rows = np.flatnonzero(missed)
        joints = _rows(found, rows)
        return cls(joints=joints, gap=_gaps(assembly, joints))


def _sizes(assembly: Assembly) -> Array:
    """Areas of all faces, of edges their lengths."""
    if assembly.dimension == 2:
        return assembly.outlines.edges[1]
    solids = assembly.polyhedra
    return polygon_areas(solids.vertices[solids.rows], solids.face_offset, solids.normals)


def _rows(joints: Interfaces, rows: IntArray) -> Interfaces:
    """Some of the joints."""
    counts = np.diff(joints.offset)[rows]
    at = np.concatenate(
        [np.arange(joints.offset[row], joints.offset[row + 1]) for row in rows]
        or [np.zeros(0, np.int64)]
    )
    in_plane = len(joints.extent) == len(joints.size)
    return Interfaces(
        block_a=joints.block_a[rows],
        block_b=joints.block_b[rows],
        face_a=joints.face_a[rows],
        face_b=joints.face_b[rows],
        corners=joints.corners[at],
        offset=np.append(0, np.cumsum(counts)),
        normal=joints.normal[rows],
        tangent=joints.tangent[rows],
        size=joints.size[rows],
        extent=joints.extent[rows] if in_plane else joints.extent,
        extent_b=joints.extent_b[rows] if in_plane else joints.extent_b,
    )


def _gaps(assembly: Assembly, joints: Interfaces) -> Array:
    """Largest distance [m] of face b from the corners of each joint, which lie on face a."""
    if not len(joints.size):
        return np.zeros(0)
    if assembly.dimension == 2:
        outlines = assembly.outlines
        tangent = outlines.edges[0][joints.face_b]
        point = outlines.vertices[joints.face_b]
        normal = np.column_stack((tangent[:, 1], -tangent[:, 0]))
    else:
        solids = assembly.polyhedra
        point = solids.vertices[solids.rows[solids.face_offset[joints.face_b]]]
        normal = solids.normals[joints.face_b]
    own = joints.joint
    off = np.abs(np.sum((joints.corners - point[own]) * normal[own], axis=1))
    return np.asarray(np.maximum.reduceat(off, joints.offset[:-1]))
