"""Concave outlines cut into convex parts, and where the parts of a block lie on each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.ranges import too_many
from drystone.common.tolerances import DEGENERATE, NEEDLE, SEAM
from drystone.geometry import GeometryError
from drystone.geometry.plane.polygon import check_outline, reflex_corners, signed_area


def convex_outlines(vertices: Array) -> list[Array]:
    """Convex parts of an outline (n, 2) [m]; of a convex one itself.

    The outline is cut at its reflex corners: along one of the two edges there, or to another reflex
    corner, whichever leaves the fewest of them and is shortest; where all of these make needles, as
    at a corner that hardly turns, across.  Given vertices keep their coordinates; a cut may end on
    an edge.  Raises `GeometryError`.
    """
    if check_outline(vertices):
        return [vertices]
    if wrong := too_many("reentrant corners", int(np.sum(reflex_corners(vertices)))):
        raise GeometryError(f"the outline {wrong}")
    whole = signed_area(vertices)
    near = DEGENERATE * float(np.ptp(vertices, axis=0).max())
    todo, parts = [_Piece(vertices, np.zeros(len(vertices), bool))], []
    while todo:
        piece = todo.pop()
        reflex = np.flatnonzero(reflex_corners(piece.vertices))
        if not len(reflex):
            parts.append(piece.vertices)
            continue
        cuts = _cuts(piece, reflex, near)
        if all(cut.needle for cut in cuts):
            cuts += _cuts_across(piece, reflex, near)
        if not cuts:
            raise _uncut()
        todo += min(cuts, key=lambda cut: cut.rank).pieces[::-1]
    if abs(sum(map(signed_area, parts)) - whole) > DEGENERATE * whole:
        raise _uncut()
    return parts


def parts_of(vertices: Array) -> list[Array]:
    """Convex parts of an outline; of what has none, as whoever checks the model says, itself."""
    try:
        return convex_outlines(vertices)
    except GeometryError:
        return [vertices]


def _uncut() -> GeometryError:
    return GeometryError(
        "the outline cannot be cut into convex parts: give them as parts = [...], or move vertices "
        "that lie very near to an edge"
    )


@dataclass(frozen=True, eq=False)
class _Piece:
    """An outline that is being cut."""

    vertices: Array  # (n, 2) m
    seam: BoolArray  # (n,) whether the edge after each vertex was cut


@dataclass(frozen=True, eq=False)
class _Cut:
    """A way to cut a piece in two, and how good it is: the less the better."""

    pieces: list[_Piece]
    rank: tuple[int, float]
    needle: bool


def _cuts(piece: _Piece, reflex: IntArray, near: float) -> list[_Cut]:
    """All cuts of a piece that begin at a reflex corner."""
    p = piece.vertices
    found = []
    for i in reflex.tolist():
        before, after = p[i - 1], p[(i + 1) % len(p)]
        for direction in (p[i] - before, p[i] - after):
            found += _cut_along(piece, i, direction / np.hypot(*direction), near)
        for j in reflex.tolist():
            if j > i and _sees(p, i, j, near):
                found += _cut_to(piece, i, j, None)
    return found


def _cuts_across(piece: _Piece, reflex: IntArray, near: float) -> list[_Cut]:
    """Cuts from reflex corners, across the line between their neighbours."""
    p = piece.vertices
    found = []
    for i in reflex.tolist():
        edge = p[(i + 1) % len(p)] - p[i - 1]
        inwards = np.array([-edge[1], edge[0]]) / np.hypot(*edge)
        found += _cut_along(piece, i, inwards, near)
    return found


def _cut_along(piece: _Piece, i: int, direction: Array, near: float) -> list[_Cut]:
    """The cut from corner ``i`` straight on to whatever it meets first."""
    p = piece.vertices
    n = len(p)
    arm = p - p[i]
    along = arm @ direction
    off = direction[0] * arm[:, 1] - direction[1] * arm[:, 0]
    off[np.abs(off) <= near] = 0.0
    ahead, off_ahead = np.roll(along, -1), np.roll(off, -1)
    crossed = off * off_ahead < 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        place = np.where(crossed, along - off * (ahead - along) / (off_ahead - off), np.inf)
    place[place <= near] = np.inf
    at_vertex = np.where((off == 0.0) & (along > near), along, np.inf)
    k, j = int(np.argmin(place)), int(np.argmin(at_vertex))
    if at_vertex[j] <= place[k] + near:
        if not np.isfinite(at_vertex[j]) or j in ((i - 1) % n, (i + 1) % n):
            return []
        return _cut_to(piece, i, j, None)
    return _cut_to(piece, i, k, p[i] + place[k] * direction)


def _sees(p: Array, i: int, j: int, near: float) -> bool:
    """Whether the way from corner ``i`` to ``j`` lies inside, and no vertex on it."""
    way = p[j] - p[i]
    length = float(np.hypot(*way))
    direction = way / length
    for corner, to in ((i, direction), (j, -direction)):
        before, after = p[corner - 1] - p[corner], p[(corner + 1) % len(p)] - p[corner]
        # Inside of a reflex corner is what is not outside: right of the edge in and of that out.
        if _cross(after, to) <= 0.0 and _cross(before, to) >= 0.0:
            return False
    arm = p - p[i]
    along, off = arm @ direction, direction[0] * arm[:, 1] - direction[1] * arm[:, 0]
    off[np.abs(off) <= near] = 0.0
    off[[i, j]] = 0.0
    if np.any((off == 0.0) & (along > near) & (along < length - near)):
        return False
    ahead, off_ahead = np.roll(along, -1), np.roll(off, -1)
    crossed = off * off_ahead < 0.0
    place = along[crossed] - (off * (ahead - along))[crossed] / (off_ahead - off)[crossed]
    return not np.any((place > -near) & (place < length + near))


def _cross(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _cut_to(piece: _Piece, i: int, j: int, point: Array | None) -> list[_Cut]:
    """The cut from corner ``i`` to corner ``j``, or to ``point`` on the edge after it."""
    p, seam = piece.vertices, piece.seam
    n = len(p)
    last = np.zeros((0, 2)) if point is None else point[None]
    pieces = []
    first = (i + np.arange((j - i) % n + 1)) % n  # from i on to j, and the point
    start = j if point is None else (j + 1) % n
    second = (start + np.arange((i - start) % n + 1)) % n  # the point, and on to i
    for rows, vertices in (
        (first, np.vstack((p[first], last))),
        (second, np.vstack((last, p[second]))),
    ):
        edges = seam[rows].copy()
        if point is not None:
            edges = np.append(edges, True) if rows is first else np.insert(edges, 0, seam[j])
        edges[-1] = True
        if len(vertices) < 3:
            return []
        pieces.append(_without_ends(_Piece(vertices, edges)))
    if any(signed_area(piece.vertices) <= 0.0 for piece in pieces):
        return []
    left = sum(int(np.count_nonzero(reflex_corners(piece.vertices))) for piece in pieces)
    end = p[j] if point is None else point
    needle = any(_sharpest_at(piece.vertices, (p[i], end)) < NEEDLE for piece in pieces)
    return [_Cut(pieces, (left + n * needle, float(np.hypot(*(end - p[i])))), needle)]


def _without_ends(piece: _Piece) -> _Piece:
    """Vertices taken out where a seam goes straight on in an edge: the edge is no seam then."""
    p, seam = piece.vertices, piece.seam
    edge = np.roll(p, -1, axis=0) - p
    length = np.hypot(edge[:, 0], edge[:, 1])
    before, length_before = np.roll(edge, 1, axis=0), np.roll(length, 1)
    sine = before[:, 0] * edge[:, 1] - before[:, 1] * edge[:, 0]
    straight = np.abs(sine) <= DEGENERATE * length * length_before
    out = straight & (seam | np.roll(seam, 1))
    if not np.any(out):
        return piece
    # The edge that goes on through a vertex taken out is a seam only where both were.
    both = seam.copy()
    for i in np.flatnonzero(out).tolist():
        k = i - 1
        while out[k]:
            k -= 1
        both[k] &= bool(seam[i])
    return _Piece(p[~out], both[~out])


def _sharpest_at(vertices: Array, ends: Sequence[Array]) -> float:
    """Smallest angle [rad] of an outline at those of its vertices."""
    angles = []
    for end in ends:
        (rows,) = np.nonzero((vertices == end).all(axis=1))
        for i in rows.tolist():
            before = vertices[i - 1] - end
            after = vertices[(i + 1) % len(vertices)] - end
            angles.append(float(np.arctan2(abs(_cross(after, before)), float(after @ before))))
    return min(angles, default=np.pi)


def outline_seams(parts: Sequence[Array]) -> list[BoolArray]:
    """Of each edge of each part, outlines (n, 2) [m], whether all of it lies on other parts."""
    near = SEAM * _extent(parts)
    found = []
    for k, p in enumerate(parts):
        others = [q for m, q in enumerate(parts) if m != k]
        edge = np.roll(p, -1, axis=0) - p
        length = np.hypot(edge[:, 0], edge[:, 1])
        found.append(
            np.array(
                [
                    _covered(p[i], edge[i] / length[i], float(length[i]), others, near)
                    for i in range(len(p))
                ]
            )
        )
    return found


def _covered(
    start: Array, direction: Array, length: float, others: list[Array], near: float
) -> bool:
    """Whether edges of others that run the other way cover this one."""
    pieces = []
    for q in others:
        arm = q - start
        along = arm @ direction
        on = np.abs(direction[0] * arm[:, 1] - direction[1] * arm[:, 0]) <= near
        run = on & np.roll(on, -1) & (np.roll(along, -1) < along)
        pieces += [(float(np.roll(along, -1)[i]), float(along[i])) for i in np.flatnonzero(run)]
    reached = 0.0
    for low, high in sorted(pieces):
        if low > reached + near:
            break
        reached = max(reached, high)
    return reached >= length - near


def touched_corners(parts: Sequence[Array]) -> list[BoolArray]:
    """Of each vertex of each part, whether another part reaches to it: it is no corner then."""
    near = SEAM * _extent(parts)
    found = []
    for k, p in enumerate(parts):
        touched = np.zeros(len(p), bool)
        for m, q in enumerate(parts):
            if m != k:
                edge = np.roll(q, -1, axis=0) - q
                edge /= np.hypot(edge[:, 0], edge[:, 1])[:, None]
                arm = p[:, None] - q[None]
                outside = arm[..., 0] * edge[:, 1] - arm[..., 1] * edge[:, 0]
                touched |= outside.max(axis=1) <= near
        found.append(touched)
    return found


def _extent(parts: Sequence[Array]) -> float:
    return float(np.ptp(np.vstack(parts), axis=0).max())
