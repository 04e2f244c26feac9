"""Joints as designed: where faces of two blocks lie on each other, found once for all that ask.

A face of the plane is an edge and a joint a segment; of space they are polygons.  Their corners are
packed, as many to a joint as it has.  Whoever reads the record by its corners, normals and sizes
need not know; `extent`, `extent_b` and `ends` are of the plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import TOUCHING
from drystone.geometry.plane.outlines import Outlines, along_and_off
from drystone.geometry.space.polyhedra import Polyhedra


@dataclass(frozen=True, kw_only=True)
class Interfaces:
    """One row for each face of one block that lies on a face of another, sorted by block and face.

    The faces of a block with several parts are its parts', and the rows name the block.  Parts of
    one block have no joints between them.
    """

    block_a: IntArray  # (n,) row of the block, the lower of the two
    block_b: IntArray  # (n,)
    face_a: IntArray  # (n,) row of the face among all; in the plane that of its first vertex
    face_b: IntArray  # (n,)
    corners: (
        Array  # (n_corners, dim) m, joint after joint, around the normal; of a segment its ends
    )
    offset: IntArray  # (n + 1,); joint j owns corners[offset[j]:offset[j + 1]]
    normal: Array  # (n, dim) from a to b; in the plane to the right of the way along the corners
    tangent: Array  # (n, dim) in face a and carried along with it; in the plane clockwise of normal
    size: Array  # (n,) m, length; in space m2, area
    extent: Array  # (n, 2) m, from where to where the joint lies along face a; (0, 2) in space
    extent_b: Array  # (n, 2) m, where face b begins and ends along face a; (0, 2) in space

    @classmethod
    def of(cls, shapes: Outlines | Polyhedra, distance: float | Array | None = None) -> Interfaces:
        """Find those of faces as near as touching blocks are, or within ``distance`` [m].

        Of each block, (n,), the less of two blocks' counts.
        """
        if isinstance(shapes, Polyhedra):
            return _of_polyhedra(shapes, distance)
        return _of_outlines(shapes, distance)

    @property
    def ends(self) -> Array:
        """Corners of the joints of the plane, (n, 2, 2) [m]."""
        return self.corners.reshape(-1, 2, 2)

    @property
    def joint(self) -> IntArray:
        """Row of the joint that each corner belongs to, (n_corners,)."""
        return np.repeat(np.arange(len(self.offset) - 1), np.diff(self.offset))

    def between_edges(self, shapes: Outlines | Polyhedra, setback: Array) -> tuple[Array, IntArray]:
        """What is left of the joints where edges are treated: corners [m] and offset, as above.

        Parameters
        ----------
        setback
            By how much faces recede from what bounds them [m]: in the plane, (n_faces, 2), from
            their two ends; in space, (n_edges,), from each of their edges.
        """
        if isinstance(shapes, Polyhedra):
            return _set_back(self, shapes, setback)
        back_a, back_b = setback[self.face_a], setback[self.face_b]
        tangent, length = (values[self.face_a] for values in shapes.edges)
        # Face b runs backwards: it ends, with its own second setback, where the joint begins.
        low = np.maximum(back_a[:, 0], self.extent_b[:, 0] + back_b[:, 1])
        high = np.minimum(length - back_a[:, 1], self.extent_b[:, 1] - back_b[:, 0])
        along = np.column_stack((low, high))[:, :, None]
        ends = shapes.vertices[self.face_a, None] + along * tangent[:, None]
        left = high > low
        return ends[left].reshape(-1, 2), np.append(0, np.cumsum(2 * left))


def _of_outlines(outlines: Outlines, distance: float | Array | None) -> Interfaces:
    a, b = outlines.near_pairs(None if distance is None else float(np.max(distance)))
    tolerance = TOUCHING * outlines.pair_size(a, b)
    if distance is not None:
        tolerance = _least(distance, outlines.body[a], outlines.body[b])
    found: list[tuple[NDArray[Any], ...]] = [(np.zeros(0),) * 7]
    for rows, p, q in outlines.alike(a, b):
        shared = _shared_parts(p, q, tolerance[rows])
        pair, i, j = at = np.nonzero(shared.touching)
        places = (shared.low, shared.high, shared.end, shared.start)
        found.append((rows[pair], i, j, *(place[at] for place in places)))
    pair, i, j, *ends = map(np.concatenate, zip(*found, strict=True))
    order = np.lexsort((j, i, pair))
    pair, i, j = (values[order].astype(np.int64) for values in (pair, i, j))
    low, high, first, last = (values[order] for values in ends)
    a, b, extent = a[pair], b[pair], np.column_stack((low, high))
    face = outlines.offset[a] + i
    tangent = outlines.edges[0][face]
    points = outlines.vertices[face, None] + extent[:, :, None] * tangent[:, None]
    return Interfaces(
        block_a=outlines.body[a],
        block_b=outlines.body[b],
        face_a=face,
        face_b=outlines.offset[b] + j,
        corners=points.reshape(-1, 2),
        offset=2 * np.arange(len(a) + 1),
        normal=np.column_stack((tangent[:, 1], -tangent[:, 0])),
        tangent=-tangent,
        size=high - low,
        extent=extent,
        extent_b=np.column_stack((first, last)),
    )


def _least(distance: float | Array, a: IntArray, b: IntArray) -> Array:
    """What blocks a and b both allow [m]."""
    if np.ndim(distance) == 0:
        return np.full(len(a), distance)
    each = np.asarray(distance)
    return np.minimum(each[a], each[b])


def _of_polyhedra(solids: Polyhedra, distance: float | Array | None) -> Interfaces:
    # Imported here because it brings compiled code along, which a schema check does not need.
    from drystone.geometry.space import faces as kernels

    p, q = solids.near_pairs(None if distance is None else float(np.max(distance)))
    tolerance = TOUCHING * solids.pair_size(p, q)
    if distance is not None:
        tolerance = _least(distance, solids.body[p], solids.body[q])
    arrays = (solids.vertices, solids.rows, solids.face_offset)
    more = (solids.part_faces, solids.normals, solids.inwards, solids.discs)
    capacity = (
        4 * len(solids.body) + 16,
        16 * len(solids.body) + 64,
    )  # a wall has three joints a block
    while True:
        found, corners = np.zeros((capacity[0], 5), np.int64), np.zeros((capacity[1], 3))
        needed = kernels.find_joints(
            np.column_stack((p, q)), tolerance, *arrays, *more, found, corners
        )
        if needed[0] <= capacity[0] and needed[1] <= capacity[1]:
            break
        capacity = needed
    found = found[: needed[0]]
    a, b = solids.body[p[found[:, 0]]], solids.body[q[found[:, 0]]]
    order = np.lexsort((found[:, 2], found[:, 1], b, a))
    a, b, found = a[order], b[order], found[order]
    counts = found[:, 4] - found[:, 3]
    offset = np.append(0, np.cumsum(counts))
    at = np.arange(offset[-1]) + np.repeat(found[:, 3] - offset[:-1], counts)
    corners, normal = corners[at], solids.normals[found[:, 1]]
    none = np.zeros((0, 2))
    return Interfaces(
        block_a=a,
        block_b=b,
        face_a=found[:, 1],
        face_b=found[:, 2],
        corners=corners,
        offset=offset,
        normal=normal,
        tangent=solids.tangents[found[:, 1]],
        size=polygon_areas(corners, offset, normal),
        extent=none,
        extent_b=none,
    )


def _set_back(joints: Interfaces, solids: Polyhedra, setback: Array) -> tuple[Array, IntArray]:
    from drystone.geometry.space import faces as kernels

    faces = np.column_stack((joints.face_a, joints.face_b))
    edges = np.diff(solids.face_offset)[faces].sum()
    out = np.zeros((len(joints.corners) + int(edges), 3))
    left = np.zeros(len(faces), np.int64)
    near = TOUCHING * np.sqrt(joints.size)
    kernels.set_back(
        joints.corners,
        joints.offset,
        faces,
        solids.vertices,
        solids.rows,
        solids.face_offset,
        solids.inwards,
        setback,
        near,
        out,
        left,
    )
    offset = np.append(0, np.cumsum(left))
    return out[: offset[-1]], offset


def polygon_areas(corners: Array, offset: IntArray, normal: Array) -> Array:
    """Areas (n,) [m2] of polygons with unit normals."""
    if not len(normal):
        return np.zeros(0)
    arm = corners - np.repeat(corners[offset[:-1]], np.diff(offset), axis=0)
    twice = np.add.reduceat(np.cross(arm, arm[_following(offset)]), offset[:-1])
    return np.asarray(0.5 * np.sum(twice * normal, axis=1))


def _following(offset: IntArray) -> IntArray:
    """Row of the corner after each corner of the same joint; joints without corners are passed."""
    after = np.arange(1, offset[-1] + 1)
    some = np.diff(offset) > 0
    after[offset[1:][some] - 1] = offset[:-1][some]
    return after


def corner_shares(corners: Array, offset: IntArray) -> Array:
    """What share of its joint each corner stands for, (n_corners,): the halves of the triangles
    between the joint's middle and its two sides; a quarter in a rectangle, a half of a segment."""
    counts = np.diff(offset)
    counts = counts[counts > 0]
    if corners.shape[1] == 2 or not len(corners):
        return np.full(len(corners), 0.5)
    first = np.append(0, np.cumsum(counts)[:-1])
    middle = np.add.reduceat(corners, first) / counts[:, None]
    arm = corners - np.repeat(middle, counts, axis=0)
    after = _following(offset)
    triangle = np.linalg.norm(np.cross(arm, arm[after]), axis=1)
    share = triangle.copy()
    share[after] += triangle
    return np.asarray(share / np.repeat(np.add.reduceat(share, first), counts))


class _Shared(NamedTuple):
    """Edge i of p against edge j of q, places along the edge of p; all (m, n_p, n_q)."""

    start: Array  # m, of the edge of q, which runs backwards
    end: Array  # m
    low: Array  # m, of the common part
    high: Array  # m
    touching: BoolArray  # whether there is one, within the tolerance


def _shared_parts(p: Array, q: Array, tolerance: Array) -> _Shared:
    """The parts of edges of p and q that lie on each other within ``tolerance`` (m,) [m]."""
    start, off_start, length = along_and_off(p, q)
    end, off_end = np.roll(start, -1, axis=2), np.roll(off_start, -1, axis=2)
    # Touching edges run against each other: along an edge of p, that of q goes from high to low.
    low = np.maximum(end, 0.0)
    high = np.minimum(start, length[..., None])
    run = end - start
    opposed = (run < 0.0) & (high > low)
    slope = (off_end - off_start) / np.where(opposed, run, 1.0)
    tolerance = tolerance[:, None, None]
    touching = (
        opposed
        & (np.abs(off_start + slope * (low - start)) <= tolerance)
        & (np.abs(off_start + slope * (high - start)) <= tolerance)
        & (high - low > tolerance)
    )
    return _Shared(start, end, low, high, touching)
