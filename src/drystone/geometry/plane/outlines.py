"""Outlines of all blocks, packed: their edges and boxes, which lie near, which overlap.

Many pairs at once: a wall of ten thousand blocks has forty thousand candidate pairs.  Pairs of
blocks with the same numbers of vertices are treated together as one array.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import TOUCHING

#: Pairs treated as one array, to bound the memory it takes.
AT_ONCE = 1 << 16


@dataclass(frozen=True, kw_only=True)
class Outlines:
    """Designed outlines, block after block; edge ``k`` runs from vertex ``k`` to its following.

    A block is one convex part, or several that follow each other.
    """

    vertices: Array  # (n_vertices, 2) m
    offset: IntArray  # (n_parts + 1,); part p owns vertices[offset[p]:offset[p + 1]]
    body: IntArray  # (n_parts,) row of the block

    @classmethod
    def pack(cls, blocks: Iterable[Sequence[Array]]) -> Outlines:
        """Pack blocks, each a sequence of parts, outlines (n, 2) [m]."""
        listed = [list(parts) for parts in blocks]
        outlines = list(chain.from_iterable(listed))
        counts = [len(outline) for outline in outlines]
        return cls(
            vertices=np.vstack(outlines),
            offset=np.cumsum([0, *counts]).astype(np.int64),
            body=np.repeat(np.arange(len(listed)), [len(parts) for parts in listed]),
        )

    @cached_property
    def owner(self) -> IntArray:
        """Row of the block that each vertex belongs to, (n_vertices,)."""
        return np.repeat(self.body, np.diff(self.offset))

    @cached_property
    def following(self) -> IntArray:
        """Row of the vertex after each vertex of the same outline, (n_vertices,)."""
        following = np.arange(1, len(self.vertices) + 1)
        following[self.offset[1:] - 1] = self.offset[:-1]
        return following

    @cached_property
    def edges(self) -> tuple[Array, Array]:
        """Unit tangents (n_vertices, 2) and lengths (n_vertices,) [m]."""
        edges = self.vertices[self.following] - self.vertices
        length = np.linalg.norm(edges, axis=1)
        return edges / length[:, None], length

    @cached_property
    def lower(self) -> Array:
        """Lower left corner of each part's bounding box, (n_parts, 2) [m]."""
        return np.asarray(np.minimum.reduceat(self.vertices, self.offset[:-1]))

    @cached_property
    def upper(self) -> Array:
        """Upper right corner, (n_parts, 2) [m]."""
        return np.asarray(np.maximum.reduceat(self.vertices, self.offset[:-1]))

    @property
    def sizes(self) -> Array:
        """Larger side of each part's bounding box, (n_parts,) [m]."""
        return (self.upper - self.lower).max(axis=1)

    @property
    def face_arrays(self) -> dict[str, IntArray]:
        """Which vertices faces have, as files keep it: an outline tells it by itself."""
        return {}

    @property
    def first_faces(self) -> IntArray:
        """First face of each part, (n_parts + 1,); faces of the plane are edges."""
        return self.offset

    def faces_of_part(self, part: int) -> tuple[Array, Array, slice]:
        """A place on each face of a part, the normals outwards, and the faces' rows."""
        rows = slice(self.offset[part], self.offset[part + 1])
        tangent = self.edges[0][rows]
        return self.vertices[rows], np.column_stack((tangent[:, 1], -tangent[:, 0])), rows

    def pair_size(self, a: IntArray, b: IntArray) -> Array:
        """Size [m] of the smaller part of each pair, the measure of what counts as small."""
        return np.minimum(self.sizes[a], self.sizes[b])

    def near_pairs(self, distance: float | None = None) -> tuple[IntArray, IntArray]:
        """Pairs of parts of two blocks whose boxes come as near as touching ones do, or as near as
        ``distance`` [m]."""
        # Imported here because it brings compiled code along, which a schema check does not need.
        from drystone.geometry.broad import candidate_pairs

        margin = TOUCHING * self.sizes[:, None] if distance is None else 0.5 * distance
        p, q = candidate_pairs(self.lower - margin, self.upper + margin)
        other = self.body[p] != self.body[q]
        return p[other], q[other]

    def overlap_depths(self, a: IntArray, b: IntArray) -> Array:
        """Depth [m] by which the parts of each pair overlap; minus their gap when apart.

        By separating axes: of polygons that lie corner to corner, the gap is that along a normal.
        """
        depth = np.empty(len(a))
        for rows, p, q in self.alike(a, b):
            depth[rows] = -np.maximum(_separation(p, q), _separation(q, p))
        return depth

    def touching(self, a: IntArray, b: IntArray) -> BoolArray:
        """Whether the parts of each pair touch, at a corner at least."""
        return self.overlap_depths(a, b) >= -TOUCHING * self.pair_size(a, b)

    def alike(self, a: IntArray, b: IntArray) -> Iterator[tuple[IntArray, Array, Array]]:
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


def along_and_off(p: Array, q: Array) -> tuple[Array, Array, Array]:
    """Place of every vertex of q along and outwards of every edge of p, (m, n_p, n_q) [m].

    For polygons p (m, n_p, 2) and q (m, n_q, 2) [m]; and the lengths of p's edges, (m, n_p) [m].
    """
    edges = np.roll(p, -1, axis=1) - p
    length = np.hypot(edges[..., 0], edges[..., 1])
    tangent = edges / length[..., None]
    arm = q[:, None, :, :] - p[:, :, None, :]
    tx, ty = tangent[..., 0, None], tangent[..., 1, None]
    return arm[..., 0] * tx + arm[..., 1] * ty, arm[..., 0] * ty - arm[..., 1] * tx, length


def _separation(p: Array, q: Array) -> Array:
    """Largest distance (m,) [m] at which one edge of p keeps all of q outside of it."""
    _, off, _ = along_and_off(p, q)
    return off.min(axis=2).max(axis=1)
