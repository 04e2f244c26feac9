"""How far convex solids are apart, or overlap: by separating axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.tolerances import PARALLEL_EDGES, ROUNDING, TOUCHING

if TYPE_CHECKING:
    from drystone.geometry.space.polyhedra import Polyhedra


def overlap_depths(solids: Polyhedra, a: IntArray, b: IntArray) -> Array:
    """Depth [m] by which the parts of each pair overlap; minus their gap when apart.

    Axes are the normals of faces, and what is normal to an edge of either.  Of parts that lie
    corner to corner, and of those farther apart than touching ones, the gap is that along an axis.
    """
    names, which = np.unique(np.concatenate((a, b)), return_inverse=True)
    all_of_them = _Edges(solids)
    shapes = [_Shape(solids, int(part), all_of_them) for part in names]
    margin = TOUCHING * solids.pair_size(a, b)
    depth = np.empty(len(a))
    known: dict[tuple[bytes, bytes], Array] = {}  # blocks of a wall have their axes in common
    for k, (i, j) in enumerate(which.reshape(2, -1).T.tolist()):
        p, q = shapes[i], shapes[j]
        apart = _between_faces(p, q)
        if apart <= margin[k]:
            if (p.turn, q.turn) not in known:
                known[p.turn, q.turn] = _axes(p, q)
            apart = max(apart, _along(p, q, known[p.turn, q.turn]))
        depth[k] = -apart
    return depth


def separating_axis(a: Polyhedra, b: Polyhedra) -> tuple[Array, float]:
    """Of two parts, packed by themselves, the unit vector (3,) from the first to the second along
    which they are farthest apart, or overlap least, and by how much [m]; below zero they overlap.
    """
    p, q = _Shape(a, 0, _Edges(a)), _Shape(b, 0, _Edges(b))
    axes = np.vstack((p.normals, -q.normals, _axes(p, q)))
    axes = np.vstack((axes, -axes[len(p.normals) + len(q.normals) :]))
    gap = (q.vertices @ axes.T).min(axis=0) - (p.vertices @ axes.T).max(axis=0)
    # Of axes that do as well a face's normal goes first.
    best = int(np.argmax(np.round(gap / TOUCHING, 6)))
    return axes[best], float(gap[best])


class _Edges:
    """Offsets of all faces and directions of all edges of many parts, at once."""

    def __init__(self, solids: Polyhedra) -> None:
        corner = solids.vertices[solids.rows[solids.face_offset[:-1]]]
        self.offsets = np.sum(solids.normals * corner, axis=1)
        along = solids.vertices[solids.following] - solids.vertices[solids.rows]
        along = along / np.linalg.norm(along, axis=1)[:, None]
        # One of the two directions of each edge.
        lead = np.argmax(np.abs(along) > PARALLEL_EDGES, axis=1)
        along *= np.sign(along[np.arange(len(along)), lead])[:, None]
        self.along, self.rounded = along, np.round(along, 9)
        self.normals = np.round(solids.normals, 9)


class _Shape:
    """A part: its vertices, its faces' planes, and the directions of its edges, once each."""

    def __init__(self, solids: Polyhedra, part: int, all_of_them: _Edges) -> None:
        first, last = solids.part_faces[part], solids.part_faces[part + 1]
        edges = slice(solids.face_offset[first], solids.face_offset[last])
        self.vertices = solids.vertices[solids.offset[part] : solids.offset[part + 1]]
        self.normals = solids.normals[first:last]
        self.offsets = all_of_them.offsets[first:last]
        # One of all edges that are parallel.
        rounded = all_of_them.rounded[edges]
        seen: dict[tuple[float, ...], int] = {}
        for k, row in enumerate(rounded.tolist()):
            seen.setdefault(tuple(row), k)
        once = list(seen.values())
        self.directions = all_of_them.along[edges][once]
        self.turn = all_of_them.normals[first:last].tobytes() + rounded[once].tobytes()


def _between_faces(p: _Shape, q: _Shape) -> float:
    """Largest distance [m] at which a face keeps the other shape off; minus the least overlap."""
    return max(
        float((q.vertices @ p.normals.T - p.offsets).min(axis=0).max()),
        float((p.vertices @ q.normals.T - q.offsets).min(axis=0).max()),
    )


def _axes(p: _Shape, q: _Shape) -> Array:
    """Unit vectors (n, 3) across an edge of either, but for those that faces stand for.

    A face of p keeps q off to its own side alone: an axis is left out where faces of p or q stand
    for both of its senses.
    """
    axes = np.cross(p.directions[:, None], q.directions[None]).reshape(-1, 3)
    length = np.linalg.norm(axes, axis=1)
    axes = axes[length > PARALLEL_EDGES] / length[length > PARALLEL_EDGES, None]
    towards_q = np.vstack((p.normals, -q.normals))
    # The sine, not the cosine: that of a small angle differs from one by its square.
    parallel = np.linalg.norm(np.cross(axes[:, None], towards_q[None]), axis=2) <= ROUNDING
    same = axes @ towards_q.T > 0.0
    both = np.any(parallel & same, axis=1) & np.any(parallel & ~same, axis=1)
    return np.asarray(axes[~both])


def _along(p: _Shape, q: _Shape, axes: Array) -> float:
    """Largest distance [m] at which one of the axes keeps the shapes apart."""
    if not len(axes):
        return -np.inf
    one, other = p.vertices @ axes.T, q.vertices @ axes.T
    gap = np.maximum(
        other.min(axis=0) - one.max(axis=0),
        one.min(axis=0) - other.max(axis=0),
    )
    return float(gap.max())
