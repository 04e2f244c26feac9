"""Which corners of outlines were meant to be one point, and which lie on a neighbour's edge.

The vertices of all outlines become *points*.  Vertices of several blocks that lie near each other
are one point, and a point that lies near an edge of another block is put on that edge: the edge
then runs through it.  Around two blocks that touch, both outlines go from the same point to the
same point, so that nothing gapes and nothing overlaps wherever the points come to lie.

Vertices join the nearest first.  A point is joined, or put on an edge, only as long as the place it
then has, the mean of all that belongs to it, is within reach of everything that belongs to it: no
vertex can be drawn along by a chain of others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import EDGE_END, SUMS
from drystone.geometry.plane.outlines import Outlines, along_and_off


@dataclass(frozen=True, kw_only=True, eq=False)
class Points:
    """Points that outlines share, and the outlines as rows of them."""

    place: Array  # (n_points, 2) m, the mean of what belongs to each
    weight: Array  # (n_points,) how many vertices belong to it
    fixed: BoolArray  # (n_points,) whether it is a vertex of an outline that stays
    loops: tuple[tuple[int, ...], ...]  # of each outline, its points in order
    inserted: tuple[tuple[bool, ...], ...]  # of these, which are no vertices but lie on an edge
    drawn: tuple[Array, ...]  # of each outline (n, 2) m, where its points were drawn


@dataclass(eq=False)
class _Point:
    """A point while it grows: where its vertices were drawn, and whose they are."""

    vertices: list[int]
    fixed: bool = False
    place: Array = field(default_factory=lambda: np.zeros(2))
    edges: dict[int, tuple[int, float]] = field(default_factory=dict)  # by outline: edge and place


def shared_points(outlines: Outlines, reach: Array, fixed: BoolArray, losing: BoolArray) -> Points:
    """The points of outlines, one part to a block.

    Parameters
    ----------
    reach
        By how much vertices of each outline may be moved [m], (n_outlines,).
    fixed
        Which outlines stay as they are, (n_outlines,).
    losing
        Which outlines may lose edges so short that both ends become one point, (n_outlines,).
    """
    reach = np.where(fixed, 0.0, reach)
    points, point_of = _joined(outlines, reach, fixed, losing & ~fixed)
    _put_on_edges(outlines, reach, fixed, points, point_of)
    loops, inserted, drawn = [], [], []
    on_edge: dict[int, list[tuple[float, int]]] = {}
    for k, point in enumerate(points):
        for edge, along in point.edges.values():
            on_edge.setdefault(edge, []).append((along, k))
    tangent, _ = outlines.edges
    for i in range(len(outlines.offset) - 1):
        loop: list[int] = []
        own: list[bool] = []
        where: list[Array] = []
        for v in range(outlines.offset[i], outlines.offset[i + 1]):
            start = outlines.vertices[v]
            between = [(k, start + along * tangent[v]) for along, k in sorted(on_edge.get(v, []))]
            for n, (k, at) in enumerate([(int(point_of[v]), start), *between]):
                loop.append(k)
                own.append(n > 0)
                where.append(at)
        # Vertices of one outline that became one point stand once.
        keep = [n for n in range(len(loop)) if loop[n] != loop[n - 1]]
        loops.append(tuple(loop[n] for n in keep))
        inserted.append(tuple(own[n] for n in keep))
        drawn.append(np.array([where[n] for n in keep]).reshape(-1, 2))
    return Points(
        place=np.array([point.place for point in points]).reshape(-1, 2),
        weight=np.array([len(point.vertices) + len(point.edges) for point in points], float),
        fixed=np.array([point.fixed for point in points], bool),
        loops=tuple(loops),
        inserted=tuple(inserted),
        drawn=tuple(drawn),
    )


def _joined(
    outlines: Outlines, reach: Array, fixed: BoolArray, losing: BoolArray
) -> tuple[list[_Point], IntArray]:
    """Vertices that lie near each other made points, the nearest first; and each one's point."""
    vertices, owner = outlines.vertices, outlines.owner
    points = [
        _Point([v], fixed=bool(fixed[owner[v]]), place=vertices[v]) for v in range(len(vertices))
    ]
    point_of = np.arange(len(vertices))
    pairs = cKDTree(vertices).query_pairs(2.0 * float(reach.max()), output_type="ndarray")
    a, b = owner[pairs[:, 0]], owner[pairs[:, 1]]
    way = vertices[pairs[:, 1]] - vertices[pairs[:, 0]]
    distance = np.hypot(way[:, 0], way[:, 1])
    near = (a != b) & (distance <= reach[a] + reach[b])
    pairs, distance = pairs[near], distance[near]
    for k in np.lexsort((pairs[:, 1], pairs[:, 0], distance)).tolist():
        p, q = sorted(point_of[pairs[k]].tolist())
        if p == q:
            continue
        one = _union(outlines, reach, losing, points[p], points[q])
        if one is not None:
            points[p] = one
            point_of[one.vertices] = p
    used, point_of = np.unique(point_of, return_inverse=True)
    return [points[k] for k in used.tolist()], point_of.reshape(-1)


def _union(
    outlines: Outlines, reach: Array, losing: BoolArray, p: _Point, q: _Point
) -> _Point | None:
    """Two points made one; None where a vertex would go too far, or a block lose an edge that it
    may not lose."""
    vertices, owner = outlines.vertices, outlines.owner
    rows = p.vertices + q.vertices
    blocks = owner[rows]
    if len(set(blocks.tolist())) < len(rows):
        for i in set(owner[p.vertices].tolist()) & set(owner[q.vertices].tolist()):
            own = [v for v in rows if owner[v] == i]
            count = outlines.offset[i + 1] - outlines.offset[i]
            ends = {v for v in own if int(outlines.following[v]) in own}
            if not losing[i] or len(own) != 2 or len(ends) != 1 or count < 4:
                return None
    if p.fixed and q.fixed:
        return None if np.any(p.place != q.place) else _Point(rows, fixed=True, place=p.place)
    place = p.place if p.fixed else q.place if q.fixed else vertices[rows].mean(axis=0)
    if np.any(np.hypot(*(vertices[rows] - place).T) > reach[blocks]):
        return None
    return _Point(rows, fixed=p.fixed or q.fixed, place=place)


def _put_on_edges(
    outlines: Outlines,
    reach: Array,
    fixed: BoolArray,
    points: list[_Point],
    point_of: IntArray,
) -> None:
    """Points put on edges of other blocks that they lie near."""
    vertices, owner = outlines.vertices, outlines.owner
    tangent, length = outlines.edges
    found = sorted(set(_near_edges(outlines, reach, point_of)))
    # Of each way from point to point, whose it is: no two outlines go the same way.
    ways = {(int(point_of[v]), int(point_of[outlines.following[v]])) for v in range(len(vertices))}
    followed = dict[int, list[int]]()
    candidates = []
    for k, edge in found:
        i = int(owner[edge])
        if any(owner[v] == i for v in points[k].vertices):
            continue
        arm = points[k].place - vertices[edge]
        off = abs(float(arm[0] * tangent[edge, 1] - arm[1] * tangent[edge, 0]))
        candidates.append((off, k, edge))
    for _, k, edge in sorted(candidates):
        point, i = points[k], int(owner[edge])
        along = float((point.place - vertices[edge]) @ tangent[edge])
        if i in point.edges or not EDGE_END < along / length[edge] < 1.0 - EDGE_END:
            continue
        if point.fixed and fixed[i]:
            continue
        # The points of the edge before and after this one.
        chain = followed.setdefault(
            edge, [int(point_of[edge]), int(point_of[outlines.following[edge]])]
        )
        places = [-np.inf, *(points[c].edges[i][1] for c in chain[1:-1]), np.inf]
        n = int(np.searchsorted(places, along))
        before, after = chain[n - 1], chain[n]
        if k in chain or (before, k) in ways or (k, after) in ways:
            continue
        place = _on_edge(outlines, reach, fixed, point, edge, along)
        if place is not None:
            point.place = place
            point.edges[i] = edge, along
            chain.insert(n, k)
            ways.discard((before, after))
            ways |= {(before, k), (k, after)}


def _on_edge(
    outlines: Outlines, reach: Array, fixed: BoolArray, point: _Point, edge: int, along: float
) -> Array | None:
    """Where a point comes to lie that is put on an edge; None where anything goes too far."""
    vertices, owner = outlines.vertices, outlines.owner
    tangent, _ = outlines.edges
    feet = [(e, vertices[e] + a * tangent[e]) for e, a in (*point.edges.values(), (edge, along))]
    held = [foot for e, foot in feet if fixed[owner[e]]]
    if point.fixed:
        place = point.place
    elif held:
        place = held[0]
    else:
        place = np.vstack((vertices[point.vertices], [foot for _, foot in feet])).mean(axis=0)
    own = vertices[point.vertices]
    if not point.fixed and np.any(np.hypot(*(own - place).T) > reach[owner[point.vertices]] + SUMS):
        return None
    for e, foot in feet:
        arm = place - foot
        off = abs(float(arm[0] * tangent[e, 1] - arm[1] * tangent[e, 0]))
        if off > reach[owner[e]] + SUMS * (1.0 + off):
            return None
    return place


def _near_edges(outlines: Outlines, reach: Array, point_of: IntArray) -> Iterator[tuple[int, int]]:
    """Points and edges of other blocks that vertices of theirs lie near."""
    a, b = outlines.near_pairs(4.0 * float(reach.max()))
    for first, second in ((a, b), (b, a)):
        for rows, p, q in outlines.alike(first, second):
            along, off, length = along_and_off(p, q)
            near = (reach[first[rows]] + reach[second[rows]])[:, None, None]
            on = (np.abs(off) <= near) & (along > 0.0) & (along < length[..., None])
            pair, i, j = np.nonzero(on)
            edges = outlines.offset[first[rows[pair]]] + i
            points = point_of[outlines.offset[second[rows[pair]]] + j]
            yield from zip(points.tolist(), edges.tolist(), strict=True)
