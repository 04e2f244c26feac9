"""Convex parts of all blocks in space, packed: their faces, planes and boxes, which lie near."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import TOUCHING


@dataclass(frozen=True, kw_only=True)
class Polyhedra:
    """Designed parts, block after block; the vertices of a face go counter-clockwise, seen from
    outside.

    ``rows`` is what faces are made of, face after face: edge ``k`` of all runs from vertex
    ``rows[k]`` to the following one of its face.
    """

    vertices: Array  # (n_vertices, 3) m
    offset: IntArray  # (n_parts + 1,); part p owns vertices[offset[p]:offset[p + 1]]
    rows: IntArray  # (n_edges,) into `vertices`
    face_offset: IntArray  # (n_faces + 1,); face k is made of rows[face_offset[k]:...]
    part_faces: IntArray  # (n_parts + 1,); part p owns the faces part_faces[p] to part_faces[p + 1]
    body: IntArray  # (n_parts,) row of the block, in ascending order

    @classmethod
    def pack(cls, blocks: Iterable[Sequence[tuple[Array, Sequence[Sequence[int]]]]]) -> Polyhedra:
        """Pack blocks, each a sequence of parts (vertices (n, 3) [m], faces of vertex numbers)."""
        listed = [list(parts) for parts in blocks]
        parts = list(chain.from_iterable(listed))
        offset = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
        faces = [face for _, faces in parts for face in faces]
        per_face = np.array([len(face) for face in faces], np.int64)
        per_part = np.array([len(faces) for _, faces in parts], np.int64)
        rows = np.fromiter(chain.from_iterable(faces), np.int64, int(per_face.sum()))
        return cls(
            vertices=np.ascontiguousarray(np.vstack([v for v, _ in parts]), np.float64),
            offset=offset.astype(np.int64),
            rows=rows + np.repeat(np.repeat(offset[:-1], per_part), per_face),
            face_offset=np.append(0, np.cumsum(per_face)),
            part_faces=np.append(0, np.cumsum(per_part)),
            body=np.repeat(np.arange(len(listed)), [len(parts) for parts in listed]),
        )

    def faces_of_parts(self) -> list[tuple[tuple[int, ...], ...]]:
        """The faces of each part, by rows of its own vertices."""
        loops = [tuple(loop.tolist()) for loop in np.split(self.rows, self.face_offset[1:-1])]
        firsts = self.offset[:-1].tolist()
        spans = zip(self.part_faces[:-1], self.part_faces[1:], firsts, strict=True)
        return [
            tuple(tuple(row - first for row in loop) for loop in loops[begin:end])
            for begin, end, first in spans
        ]

    @cached_property
    def following(self) -> IntArray:
        """Row of the vertex at which each edge ends, (n_edges,) into `vertices`."""
        after = np.arange(1, len(self.rows) + 1)
        after[self.face_offset[1:] - 1] = self.face_offset[:-1]
        return self.rows[after]

    @cached_property
    def face_of_edge(self) -> IntArray:
        """Face that each edge belongs to, (n_edges,)."""
        return np.repeat(np.arange(len(self.face_offset) - 1), np.diff(self.face_offset))

    @cached_property
    def normals(self) -> Array:
        """Unit normals of the faces, outwards, (n_faces, 3): Newell's, of faces not quite flat."""
        start, end = self.vertices[self.rows], self.vertices[self.following]
        first = self.vertices[self.rows[self.face_offset[:-1]]][self.face_of_edge]
        area = np.add.reduceat(np.cross(start - first, end - first), self.face_offset[:-1])
        return np.asarray(area / np.linalg.norm(area, axis=1)[:, None])

    @cached_property
    def tangents(self) -> Array:
        """A unit vector in each face, along its first edge, (n_faces, 3)."""
        first = self.face_offset[:-1]
        edge = self.vertices[self.following[first]] - self.vertices[self.rows[first]]
        edge -= np.sum(edge * self.normals, axis=1)[:, None] * self.normals
        return np.asarray(edge / np.linalg.norm(edge, axis=1)[:, None])

    @cached_property
    def inwards(self) -> Array:
        """Unit vectors in the faces, across each edge to the inside, (n_edges, 3)."""
        edge = self.vertices[self.following] - self.vertices[self.rows]
        inward = np.cross(self.normals[self.face_of_edge], edge)
        return np.asarray(inward / np.linalg.norm(inward, axis=1)[:, None])

    @cached_property
    def discs(self) -> Array:
        """Mean of each face's vertices and how far the farthest of them is, (n_faces, 4) [m]."""
        first, counts = self.face_offset[:-1], np.diff(self.face_offset)
        places = self.vertices[self.rows]
        middle = np.add.reduceat(places, first) / counts[:, None]
        arm = np.linalg.norm(places - middle[self.face_of_edge], axis=1)
        return np.column_stack((middle, np.maximum.reduceat(arm, first)))

    @cached_property
    def lower(self) -> Array:
        """Lower corner of each part's bounding box, (n_parts, 3) [m]."""
        return np.asarray(np.minimum.reduceat(self.vertices, self.offset[:-1]))

    @cached_property
    def upper(self) -> Array:
        """Upper corner, (n_parts, 3) [m]."""
        return np.asarray(np.maximum.reduceat(self.vertices, self.offset[:-1]))

    @cached_property
    def sizes(self) -> Array:
        """Twice the distance of the farthest vertex from the mean of all, of each part,
        (n_parts,) [m]: the same however the part is turned."""
        counts = np.diff(self.offset)
        mean = np.add.reduceat(self.vertices, self.offset[:-1]) / counts[:, None]
        arm = np.linalg.norm(self.vertices - np.repeat(mean, counts, axis=0), axis=1)
        return np.asarray(2.0 * np.maximum.reduceat(arm, self.offset[:-1]))

    @property
    def face_arrays(self) -> dict[str, IntArray]:
        """Which vertices faces have, as files keep it."""
        names = ("rows", "face_offset", "part_faces")
        return {name: getattr(self, name) for name in names}

    @property
    def first_faces(self) -> IntArray:
        """First face of each part, (n_parts + 1,)."""
        return self.part_faces

    def faces_of_part(self, part: int) -> tuple[Array, Array, slice]:
        """A place on each face of a part, the normals outwards, and the faces' rows."""
        rows = slice(self.part_faces[part], self.part_faces[part + 1])
        first = self.rows[self.face_offset[:-1][rows]]
        return self.vertices[first], self.normals[rows], rows

    def pair_size(self, a: IntArray, b: IntArray) -> Array:
        """Size [m] of the smaller part of each pair, the measure of what counts as small."""
        return np.minimum(self.sizes[a], self.sizes[b])

    def near_pairs(self, distance: float | None = None) -> tuple[IntArray, IntArray]:
        """Pairs of parts ``(p, q)`` of two blocks whose boxes come as near as touching ones do.

        Or as near as ``distance`` [m].
        """
        from drystone.geometry.broad import candidate_pairs

        margin = TOUCHING * self.sizes[:, None] if distance is None else 0.5 * distance
        p, q = candidate_pairs(self.lower - margin, self.upper + margin)
        other = self.body[p] != self.body[q]
        return p[other], q[other]

    def overlap_depths(self, a: IntArray, b: IntArray) -> Array:
        """Depth [m] by which the parts of each pair overlap; minus their gap when apart."""
        from drystone.geometry.space.separation import overlap_depths

        known, pairs = self._depths, list(zip(a.tolist(), b.tolist(), strict=True))
        new = np.array([k for k, pair in enumerate(pairs) if pair not in known], dtype=np.int64)
        if len(new):
            found = overlap_depths(self, a[new], b[new]).tolist()
            known.update(zip([pairs[k] for k in new], found, strict=True))
        return np.array([known[pair] for pair in pairs])

    @cached_property
    def _depths(self) -> dict[tuple[int, int], float]:
        """Depths of pairs that were asked for: checks and inspections ask for the same ones."""
        return {}

    def touching(self, a: IntArray, b: IntArray) -> BoolArray:
        """Whether the parts of each pair touch, at a corner at least."""
        return self.overlap_depths(a, b) >= -TOUCHING * self.pair_size(a, b)

    def setbacks(self, back: Array) -> Array:
        """By how much faces recede from their edges where these are rounded, (n_edges,) [m].

        ``back`` (n_faces,) [m] is how far each face lies outside of the core: the radius, or 0
        where the block goes on behind it.  Where the surface turns by the angle a, the edge of a
        core's face lies r tan(a / 2) back along the face, and further by how much less the one
        next to it is moved, over sin(a), less.
        """
        n = len(self.vertices)
        forward = self.rows * n + self.following
        backward = self.following * n + self.rows
        order = np.argsort(forward)
        place = np.minimum(np.searchsorted(forward, backward, sorter=order), len(order) - 1)
        own, other = self.face_of_edge, self.face_of_edge[order[place]]
        sine = np.linalg.norm(np.cross(self.normals[own], self.normals[other]), axis=1)
        cosine = np.sum(self.normals[own] * self.normals[other], axis=1)
        away = np.zeros_like(sine)
        np.divide(back[other] - back[own], sine, out=away, where=back[other] != back[own])
        return np.asarray(np.maximum(back[own] * sine / (1.0 + cosine) + away, 0.0))
