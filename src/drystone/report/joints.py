"""Designed joints of an assembly and what became of them: closed, slid or opened.

Taken from the outlines and the poses alone, so that a joint that gapes far wider than any engine
watches its contacts is still drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.report.outlines import MovingOutlines, moved_points

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Two edges are a joint when they lie this near, as a share of the shortest edge of all blocks.
NEAR = 1e-2


@dataclass(frozen=True, kw_only=True)
class Joints:
    """Segments along which the edges of two blocks lie on each other as designed."""

    block_a: IntArray  # (k,)
    block_b: IntArray  # (k,)
    start: Array  # (k, 2) m
    end: Array  # (k, 2) m; block a lies to the left of start -> end
    centroid: Array  # (n, 2) m, of the blocks
    linear: bool = False  # see `moved_points`

    def faces(self, pose: Array) -> tuple[Array, Array]:
        """Ends of each joint on block a and on block b in the poses, two (k, 2, 2) [m]."""
        face_a, face_b = (
            np.stack(
                [
                    moved_points(p, owner, self.centroid, pose, linear=self.linear)
                    for p in (self.start, self.end)
                ],
                axis=1,
            )
            for owner in (self.block_a, self.block_b)
        )
        return face_a, face_b

    def opening_and_slip(self, pose: Array, since: Array | None = None) -> tuple[Array, Array]:
        """Largest opening and largest slip over the two ends, seen from block a, (k,) each [m].

        By which a joint was open or had slid in the poses ``since`` is taken off.
        """
        opening, slip = self._apart(pose)
        if since is not None:
            before = self._apart(since)
            opening, slip = opening - before[0], slip - before[1]
        return opening.max(axis=1), np.abs(slip).max(axis=1)

    def _apart(self, pose: Array) -> tuple[Array, Array]:
        """Opening and slip at both ends, (k, 2) each [m]."""
        face_a, face_b = self.faces(pose)
        tangent = face_a[:, 1] - face_a[:, 0]
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        outward = np.column_stack((tangent[:, 1], -tangent[:, 0]))
        jump = face_b - face_a
        opening = np.einsum("kij,kj->ki", jump, outward)
        return opening, np.einsum("kij,kj->ki", jump, tangent)


def designed_joints(assembly: Assembly, *, linear: bool = False) -> Joints:
    """All joints of a plane assembly."""
    outlines = MovingOutlines.of(assembly)
    edges = np.roll(outlines.vertices, -1, axis=0) - outlines.vertices
    last = outlines.offset[1:] - 1
    edges[last] = outlines.vertices[outlines.offset[:-1]] - outlines.vertices[last]
    length = np.linalg.norm(edges, axis=1)
    near = NEAR * float(length.min())
    e, f = _edge_pairs(outlines, *_near_blocks(outlines, near))

    tangent = edges / length[:, None]
    antiparallel = np.sum(tangent[e] * tangent[f], axis=1) < -1.0 + 1e-6
    e, f = e[antiparallel], f[antiparallel]
    between = outlines.vertices[f] - outlines.vertices[e]
    apart = np.abs(between[:, 0] * tangent[e, 1] - between[:, 1] * tangent[e, 0]) <= near
    e, f, between = e[apart], f[apart], between[apart]
    # Along edge e, edge f runs from `along` backwards by its own length.
    along = np.sum(between * tangent[e], axis=1)
    low = np.maximum(0.0, along - length[f])
    high = np.minimum(length[e], along)
    touching = high - low > near
    e, f, low, high = e[touching], f[touching], low[touching], high[touching]
    return Joints(
        block_a=outlines.owner[e],
        block_b=outlines.owner[f],
        start=outlines.vertices[e] + low[:, None] * tangent[e],
        end=outlines.vertices[e] + high[:, None] * tangent[e],
        centroid=assembly.centroid,
        linear=linear,
    )


def _near_blocks(outlines: MovingOutlines, near: float) -> tuple[IntArray, IntArray]:
    """Pairs of blocks whose boxes come within ``near`` [m]."""
    # Imported here because it brings compiled code along, which a curve's picture does not need.
    from drystone.contact.broad import candidate_pairs

    lower = np.minimum.reduceat(outlines.vertices, outlines.offset[:-1])
    upper = np.maximum.reduceat(outlines.vertices, outlines.offset[:-1])
    return candidate_pairs(lower - 0.5 * near, upper + 0.5 * near)


def _edge_pairs(outlines: MovingOutlines, i: IntArray, j: IntArray) -> tuple[IntArray, IntArray]:
    """Every edge of block ``i[k]`` with every edge of block ``j[k]``, as rows of the vertices."""
    count = np.diff(outlines.offset)
    combinations = count[i] * count[j]
    pair = np.repeat(np.arange(len(i)), combinations)
    run = np.arange(len(pair)) - np.repeat(np.cumsum(combinations) - combinations, combinations)
    return (
        outlines.offset[i][pair] + run // count[j][pair],
        outlines.offset[j][pair] + run % count[j][pair],
    )
