"""Joints as designed: where faces of two blocks lie on each other, found once for all that ask.

A face of the plane is an edge and a joint a segment; of space they are polygons.  Whoever reads the
record by its points, normals and sizes need not know; `extent` and `between_corners` are of the
plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.geometry.outlines import TOUCHING, Outlines, along_and_off

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Interfaces:
    """One row for each face of one block that lies on a face of another, sorted by block and face.

    Blocks are convex, one part each.  Of a block with several parts the faces are its parts',
    and the rows still name the block.
    """

    block_a: IntArray  # (n,) row of the block, the lower of the two
    block_b: IntArray  # (n,)
    face_a: IntArray  # (n,) row of the face among all; in the plane that of its first vertex
    face_b: IntArray  # (n,)
    points: Array  # (n, n_points, dim) m, corners of the joint; in the plane its ends
    normal: Array  # (n, dim) from a to b; in the plane to the right of the way along the points
    size: Array  # (n,) m, length; in space m2, area
    extent: Array  # (n, 2) m, from where to where the joint lies along face a
    extent_b: Array  # (n, 2) m, where face b begins and ends along face a

    @classmethod
    def of(cls, outlines: Outlines, distance: float | None = None) -> Interfaces:
        """Find those of faces as near as touching blocks are, or within ``distance`` [m]."""
        a, b = outlines.near_pairs(distance)
        tolerance = TOUCHING * outlines.pair_size(a, b)
        if distance is not None:
            tolerance = np.full(len(a), distance)
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
        return cls(
            block_a=outlines.body[a],
            block_b=outlines.body[b],
            face_a=face,
            face_b=outlines.offset[b] + j,
            points=outlines.vertices[face, None] + extent[:, :, None] * tangent[:, None],
            normal=np.column_stack((tangent[:, 1], -tangent[:, 0])),
            size=high - low,
            extent=extent,
            extent_b=np.column_stack((first, last)),
        )

    def between_corners(self, outlines: Outlines, setback: Array) -> tuple[Array, Array]:
        """The joints' ends where corners are treated, (n, 2, 2) [m], and what is left, (n,) [m].

        ``setback`` (n_faces, 2) [m] is by how much each face is shorter at its two ends; a joint
        with nothing left has a length of zero or below.
        """
        back_a, back_b = setback[self.face_a], setback[self.face_b]
        tangent, length = (values[self.face_a] for values in outlines.edges)
        # Face b runs backwards: it ends, with its own second setback, where the joint begins.
        low = np.maximum(back_a[:, 0], self.extent_b[:, 0] + back_b[:, 1])
        high = np.minimum(length - back_a[:, 1], self.extent_b[:, 1] - back_b[:, 0])
        along = np.column_stack((low, high))[:, :, None]
        return outlines.vertices[self.face_a, None] + along * tangent[:, None], high - low


class _Shared(NamedTuple):
    """Edge i of p against edge j of q, places along the edge of p; all (m, n_p, n_q)."""

    start: Array  # m, of the edge of q, which runs backwards
    end: Array  # m
    low: Array  # m, of the common part
    high: Array  # m
    touching: NDArray[np.bool_]  # whether there is one, within the tolerance


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
