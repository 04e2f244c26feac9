"""Which blocks lie next to each other as designed: overlaps, gaps and shared edges.

Many pairs at once: a wall of ten thousand blocks has forty thousand candidate pairs.  Pairs of
blocks with the same numbers of vertices are treated together as one array.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Gap, relative to the smaller block, up to which two blocks count as touching.  In a dry wall it
#: is of the order of what the joints close by under the weight above them.
TOUCHING = 1e-4

#: Pairs treated as one array, to bound the memory it takes.
AT_ONCE = 1 << 16


@dataclass(frozen=True, kw_only=True)
class SharedEdges:
    """Parts of edges of two blocks that lie on each other; places are along the edge of ``a``."""

    pair: IntArray  # (k,) row of the pair
    edge_a: IntArray  # (k,) row of its first vertex in `Outlines.vertices`
    edge_b: IntArray  # (k,)
    extent: Array  # (k, 2) m, from where to where both edges lie
    extent_b: Array  # (k, 2) m, where the edge of b begins and ends


@dataclass(frozen=True, kw_only=True)
class Outlines:
    """The designed outlines of all blocks, packed, and their bounding boxes."""

    vertices: Array  # (n_vertices, 2) m
    offset: IntArray  # (n + 1,); block i owns vertices[offset[i]:offset[i + 1]]
    lower: Array  # (n, 2) m
    upper: Array  # (n, 2) m

    @classmethod
    def of(cls, assembly: Assembly) -> Outlines:
        """Pack the outlines of an assembly."""
        return cls.pack([block.vertices for block in assembly.blocks])

    @classmethod
    def pack(cls, outlines: Sequence[Array]) -> Outlines:
        """Pack outlines, each (n, 2) [m]."""
        vertices = np.vstack(outlines)
        offset = np.cumsum([0] + [len(outline) for outline in outlines]).astype(np.int64)
        return cls(
            vertices=vertices,
            offset=offset,
            lower=np.minimum.reduceat(vertices, offset[:-1]),
            upper=np.maximum.reduceat(vertices, offset[:-1]),
        )

    @property
    def size(self) -> Array:
        """Larger side of each block's bounding box, (n,) [m]."""
        return (self.upper - self.lower).max(axis=1)

    def near_pairs(self, distance: float | None = None) -> tuple[IntArray, IntArray]:
        """Pairs ``(a, b)`` whose boxes come as near as touching blocks do, or as ``distance``."""
        # Imported here because it brings compiled code along, which a schema check does not need.
        from drystone.contact.broad import candidate_pairs

        margin = TOUCHING * self.size[:, None] if distance is None else 0.5 * distance
        return candidate_pairs(self.lower - margin, self.upper + margin)

    def pair_size(self, a: IntArray, b: IntArray) -> Array:
        """Size [m] of the smaller block of each pair, the measure of what counts as small."""
        return np.minimum(self.size[a], self.size[b])

    def overlap_depths(self, a: IntArray, b: IntArray) -> Array:
        """Depth [m] by which the blocks of each pair overlap; minus their gap when apart.

        The same as `geometry.overlap_depth`, pair by pair.
        """
        depth = np.empty(len(a))
        for rows, p, q in self._alike(a, b):
            depth[rows] = -np.maximum(_separation(p, q), _separation(q, p))
        return depth

    def shared_lengths(self, a: IntArray, b: IntArray) -> Array:
        """Length [m] over which the edges of the blocks of each pair lie on each other."""
        length = np.empty(len(a))
        tolerance = TOUCHING * self.pair_size(a, b)
        for rows, p, q in self._alike(a, b):
            shared = _shared_parts(p, q, tolerance[rows])
            length[rows] = np.where(shared.touching, shared.high - shared.low, 0.0).sum(axis=(1, 2))
        return length

    def shared_edges(self, a: IntArray, b: IntArray, distance: float | None = None) -> SharedEdges:
        """Every part of an edge of a block of ``a`` that lies on one of its partner in ``b``.

        That is, as near as touching blocks are, or within ``distance`` [m].
        """
        tolerance = TOUCHING * self.pair_size(a, b)
        if distance is not None:
            tolerance = np.full(len(a), distance)
        found: list[tuple[NDArray[Any], ...]] = [(np.zeros(0),) * 7]
        for rows, p, q in self._alike(a, b):
            shared = _shared_parts(p, q, tolerance[rows])
            at = np.nonzero(shared.touching)
            pair, i, j = at
            start, end = shared.start[at], shared.end[at]
            found.append((rows[pair], i, j, shared.low[at], shared.high[at], end, start))
        pair, i, j, low, high, first, last = map(np.concatenate, zip(*found, strict=True))
        order = np.lexsort((j, i, pair))
        pair, i, j = (values[order].astype(np.int64) for values in (pair, i, j))
        return SharedEdges(
            pair=pair,
            edge_a=self.offset[a[pair]] + i,
            edge_b=self.offset[b[pair]] + j,
            extent=np.column_stack((low, high))[order],
            extent_b=np.column_stack((first, last))[order],
        )

    def _alike(self, a: IntArray, b: IntArray) -> Iterator[tuple[IntArray, Array, Array]]:
        """Rows with equal numbers of vertices, and their outlines (m, n_a, 2) and (m, n_b, 2)."""
        counts = np.diff(self.offset)
        kinds, kind_of = np.unique(
            np.column_stack((counts[a], counts[b])), axis=0, return_inverse=True
        )
        for kind, (n_a, n_b) in enumerate(kinds):
            alike = np.flatnonzero(kind_of.ravel() == kind)
            for start in range(0, len(alike), AT_ONCE):
                rows = alike[start : start + AT_ONCE]
                p = self.vertices[self.offset[a[rows], None] + np.arange(n_a)]
                q = self.vertices[self.offset[b[rows], None] + np.arange(n_b)]
                yield rows, p, q


def _tangents(p: Array) -> tuple[Array, Array]:
    """Unit tangents (m, n, 2) and lengths (m, n) of the edges of polygons (m, n, 2)."""
    edges = np.roll(p, -1, axis=1) - p
    length = np.hypot(edges[..., 0], edges[..., 1])
    return edges / length[..., None], length


def _along_and_off(p: Array, q: Array) -> tuple[Array, Array, Array]:
    """Place of every vertex of q along and outwards of every edge of p, (m, n_p, n_q) [m]."""
    tangent, length = _tangents(p)
    arm = q[:, None, :, :] - p[:, :, None, :]
    tx, ty = tangent[..., 0, None], tangent[..., 1, None]
    return arm[..., 0] * tx + arm[..., 1] * ty, arm[..., 0] * ty - arm[..., 1] * tx, length


def _separation(p: Array, q: Array) -> Array:
    """Largest distance (m,) [m] at which one edge of p keeps all of q outside of it."""
    _, off, _ = _along_and_off(p, q)
    return off.min(axis=2).max(axis=1)


class _Shared(NamedTuple):
    """Edge i of p against edge j of q, places along the edge of p; all (m, n_p, n_q)."""

    start: Array  # m, of the edge of q, which runs backwards
    end: Array  # m
    low: Array  # m, of the common part
    high: Array  # m
    touching: NDArray[np.bool_]  # whether there is one, within the tolerance


def _shared_parts(p: Array, q: Array, tolerance: Array) -> _Shared:
    """The parts of edges of p and q that lie on each other within ``tolerance`` (m,) [m]."""
    start, off_start, length = _along_and_off(p, q)
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
