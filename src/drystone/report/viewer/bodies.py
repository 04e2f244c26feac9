"""Blocks as triangles and edges: what a graphics card takes, made once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry import GeometryError
from drystone.geometry.plane.parts import convex_outlines
from drystone.geometry.space.polyhedra import Polyhedra

#: Normals and corners that agree to this share of a block's size are the same.
SAME = 1e-6


@dataclass(frozen=True, kw_only=True)
class Bodies:
    """Vertices with the block that each belongs to, the triangles and edges between them."""

    vertices: Array  # (n_vertices, dim) m, as designed
    owner: IntArray  # (n_vertices,) row of the block
    triangles: (
        IntArray  # (n_triangles, 3) rows of vertices; in space counter-clockwise, from outside
    )
    edges: IntArray  # (n_edges, 2) rows of vertices, those that are drawn

    @classmethod
    def of_outlines(cls, vertices: Array, offset: IntArray, body: IntArray) -> Bodies:
        """Of outlines in the plane; shape s has the vertices from offset[s] to offset[s + 1]."""
        made = _Made(dimension=2)
        for s, (first, last) in enumerate(pairwise(offset.tolist())):
            outline = vertices[first:last]
            base = made.add(outline, int(body[s]))
            n = last - first
            made.edges += [(base + i, base + (i + 1) % n) for i in range(n)]
            if _is_convex(outline):
                made.fan(range(base, base + n))
                continue
            for part in _convex_parts(outline):
                start = made.add(part, int(body[s]))
                made.fan(range(start, start + len(part)))
        return made.bodies()

    @classmethod
    def of_solids(cls, solids: Polyhedra) -> Bodies:
        """Of convex parts in space; edges where parts of a block merely meet are not drawn."""
        made = _Made(dimension=3)
        parts = solids.faces_of_parts()
        together: dict[int, list[tuple[int, Any]]] = defaultdict(list)
        for p, faces in enumerate(parts):
            first, last = solids.offset[p : p + 2]
            base = made.add(solids.vertices[first:last], int(solids.body[p]))
            for face in faces:
                made.fan([base + i for i in face])
            together[int(solids.body[p])].append((base, faces))
        vertices = np.vstack(made.vertices)
        for own in together.values():
            made.edges += _edges_of_part(own[0]) if len(own) == 1 else _creases(own, vertices)
        return made.bodies()


class _Made:
    """Bodies under construction."""

    def __init__(self, dimension: int) -> None:
        self.vertices: list[Array] = [np.zeros((0, dimension))]
        self.owner: list[int] = []
        self.triangles: list[tuple[int, int, int]] = []
        self.edges: list[tuple[int, int]] = []

    def add(self, vertices: Array, body: int) -> int:
        """Take vertices; the row of the first."""
        base = len(self.owner)
        self.vertices.append(vertices)
        self.owner += [body] * len(vertices)
        return base

    def fan(self, rows: Any) -> None:
        """Triangles of a convex polygon."""
        first, *others = rows
        self.triangles += [(first, i, j) for i, j in pairwise(others)]

    def bodies(self) -> Bodies:
        return Bodies(
            vertices=np.vstack(self.vertices),
            owner=np.array(self.owner, np.int64),
            triangles=np.array(self.triangles, np.int64).reshape(-1, 3),
            edges=np.array(self.edges, np.int64).reshape(-1, 2),
        )


def _is_convex(outline: Array) -> bool:
    side = np.roll(outline, -1, axis=0) - outline
    after = np.roll(side, -1, axis=0)
    turn = side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0]
    return bool((turn >= -SAME * np.ptp(outline, axis=0).max() ** 2).all())


def _convex_parts(outline: Array) -> list[Array]:
    try:
        return convex_outlines(outline)
    except GeometryError:  # it was analysed, so that it has parts; a fan is better than nothing
        return [outline]


def _sides(rows: Any) -> Iterator[tuple[int, int]]:
    yield from pairwise([*rows, rows[0]])


def _edges_of_part(part: tuple[int, Any]) -> list[tuple[int, int]]:
    base, faces = part
    found = {(min(i, j), max(i, j)) for face in faces for i, j in _sides(face)}
    return [(base + i, base + j) for i, j in sorted(found)]


def _creases(parts: list[tuple[int, Any]], vertices: Array) -> list[tuple[int, int]]:
    """Edges of a block in parts where its surface bends: faces on which parts meet cancel out."""
    size = max(float(np.ptp(vertices[base : base + 4], axis=0).max()) for base, _ in parts)
    normals: dict[Any, list[Array]] = defaultdict(list)
    rows: dict[Any, tuple[int, int]] = {}
    for base, faces in parts:
        for face in faces:
            corners = vertices[[base + i for i in face]]
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            normal = normal / max(float(np.linalg.norm(normal)), 1e-300)
            for i, j in _sides(face):
                ends = [
                    tuple(np.rint(vertices[base + k] / (SAME * size)).astype(int)) for k in (i, j)
                ]
                key = tuple(sorted(ends))
                normals[key].append(normal)
                rows[key] = (base + i, base + j)
    return [rows[key] for key, own in normals.items() if _bends(own)]


def _bends(normals: list[Array]) -> bool:
    """Whether faces with these normals make an edge, once opposite ones are taken out."""
    left = list(normals)
    for normal in normals:
        opposite = [k for k, other in enumerate(left) if np.abs(other + normal).max() < 1e-6]
        same = [k for k, other in enumerate(left) if other is normal]
        if opposite and same:
            for k in sorted((opposite[0], same[0]), reverse=True):
                del left[k]
    return len(left) > 1 and max(np.abs(left[0] - other).max() for other in left[1:]) > 1e-6
