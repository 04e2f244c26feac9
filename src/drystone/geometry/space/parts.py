"""Concave solids cut into convex parts, and where the parts of a block lie on each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.tolerances import DEGENERATE, FLAT, PART_DEGENERATE, SEAM, SNAP
from drystone.geometry import GeometryError
from drystone.geometry.plane.parts import convex_outlines
from drystone.geometry.space.cells import Cell, Point, below, cell_of, heights, packed
from drystone.geometry.space.solid import (
    Faces,
    Part,
    face_areas,
    face_planes,
    hull,
    hull_of,
    is_convex,
    is_plain,
    mass_properties,
    plane_axes,
    size_of,
    unevenness,
)


def convex_parts(vertices: Array, faces: Faces, tolerance: float = FLAT) -> list[Part]:
    """Convex parts of a solid that passes `solid.check`; of a convex one itself.

    Its hull is cut by the planes of the faces that lie inside, until every cell is all solid or all
    empty; cells of which two make a convex one are put together again.  Given vertices keep their
    coordinates, but those in the midst of an edge or a face are left out.

    Raises `GeometryError` where the volumes of the parts do not add up to that of the solid, which
    happens where faces cross or lie within the tolerance of each other.
    """
    if is_plain(vertices, faces, tolerance):
        return [Part(vertices, faces)]
    if is_convex(vertices, faces, tolerance):
        return [Part(*hull(vertices, tolerance))]
    size = size_of(vertices)
    whole = mass_properties(vertices, faces).volume
    surface = _surface(vertices, faces)
    near = SNAP * tolerance * size
    _, hull_faces = hull_of(vertices, tolerance)
    points, cell = cell_of(vertices, hull_faces)
    cells = [
        cell
        for cell in _cells(points, cell, _inside(points, cell, surface, near), near)
        if _winding(_middle(points, cell), surface) > 0.5
    ]
    solids = [plain(*packed(points, cell), tolerance) for cell in cells]
    parts = _united(solids, whole, tolerance)
    missing = abs(sum(mass_properties(p.vertices, p.faces).volume for p in parts) - whole)
    # Where a vertex counts as on a plane that it is near to, volume is lost or found.
    loose = max(near, unevenness(vertices, faces)) * float(face_areas(vertices, faces).sum())
    if missing > DEGENERATE * whole + loose:
        raise GeometryError(
            f"the convex parts of the solid miss its volume by {missing / whole:.2g} of it: its "
            "faces cross, or two of them are nearly in one plane; mend them, or give parts = [...]"
        )
    return parts


# --- the surface ------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Surface:
    """Faces cut into convex pieces."""

    pieces: list[Array]  # (n, 3) each, m
    normal: Array  # (n_pieces, 3), outward
    offset: Array  # (n_pieces,) m
    triangles: Array  # (k, 3, 3) m, of all pieces


def _surface(vertices: Array, faces: Faces) -> _Surface:
    normal, offset = face_planes(vertices, faces)
    pieces, owner = [], []
    for i, face in enumerate(faces):
        for piece in convex_pieces(vertices[list(face)], normal[i], i):
            pieces.append(piece)
            owner.append(i)
    triangles = [
        (piece[0], piece[k], piece[k + 1]) for piece in pieces for k in range(1, len(piece) - 1)
    ]
    return _Surface(pieces, normal[owner], offset[owner], np.array(triangles))


def convex_pieces(face: Array, normal: Array, i: int) -> list[Array]:
    """Convex pieces of a face (n, 3), in its plane."""
    if len(face) == 3:
        return [face]
    axes = plane_axes(normal)
    middle = face.mean(axis=0)
    flat = (face - middle) @ axes
    try:
        outlines = convex_outlines(flat)
    except GeometryError as error:
        raise GeometryError(f"face {i + 1}: {error}") from None
    if len(outlines) == 1:
        return [face]
    return [middle + outline @ axes.T for outline in outlines]


def _winding(point: Array, surface: _Surface) -> float:
    """How often the surface goes around a point: 1 inside, 0 outside.

    The solid angles of all triangles (van Oosterom and Strackee, 1983).
    """
    a, b, c = np.moveaxis(surface.triangles - point, 1, 0)
    la, lb, lc = (np.sqrt(np.sum(v * v, axis=1)) for v in (a, b, c))
    det = np.sum(a * np.cross(b, c), axis=1)
    rest = (
        la * lb * lc
        + np.sum(a * b, axis=1) * lc
        + np.sum(b * c, axis=1) * la
        + np.sum(c * a, axis=1) * lb
    )
    return float(np.sum(np.arctan2(det, rest))) / (2.0 * np.pi)


def _middle(points: list[Point], cell: Cell) -> Array:
    vertices, faces = packed(points, cell)
    return mass_properties(vertices, faces).centroid


# --- cells ------------------------------------------------------------------------------------


def _inside(points: list[Point], cell: Cell, surface: _Surface, near: float) -> _Surface:
    """Pieces of the surface that do not lie in a face of the cell."""
    vertices, faces = packed(points, cell)
    normal, offset = face_planes(vertices, faces)
    keep = [
        not np.any(np.all(piece @ normal.T - offset >= -2.0 * near, axis=0))
        for piece in surface.pieces
    ]
    return _only(surface, [p for p, k in zip(surface.pieces, keep, strict=True) if k], keep)


def _only(surface: _Surface, pieces: list[Array], keep: list[bool]) -> _Surface:
    return _Surface(pieces, surface.normal[keep], surface.offset[keep], surface.triangles)


def _cells(points: list[Point], cell: Cell, surface: _Surface, near: float) -> list[Cell]:
    """Cells that no piece of the surface passes through."""
    todo, done = [(cell, surface)], []
    while todo:
        cell, surface = todo.pop()
        if not surface.pieces:
            done.append(cell)
            continue
        i = _best_plane(surface, near)
        n, d = surface.normal[i], float(surface.offset[i])
        height = heights(points, cell, (*n.tolist(), *(d * n).tolist()))
        made: dict[tuple[int, int], int] = {}
        back = {k: -h for k, h in height.items()}
        sides = (
            below(points, cell, height, near, -1, made),
            below(points, cell, back, near, -1, made),
        )
        for sign, side in zip((1.0, -1.0), sides, strict=True):
            if side is None:
                continue
            if side is cell:  # the plane only grazes the cell: the piece lies in one of its faces
                height = {k: 0.0 for k in height}
            todo.append((side, _beyond(surface, sign * n, sign * d, near, i)))
    return done


def _best_plane(surface: _Surface, near: float) -> int:
    """The piece whose plane cuts fewest of the others, and next holds most of them."""
    every = np.vstack(surface.pieces)
    start = np.cumsum([0] + [len(piece) for piece in surface.pieces])[:-1]
    height = surface.normal @ every.T - surface.offset[:, None]
    high = np.maximum.reduceat(height, start, axis=1) > near
    low = np.minimum.reduceat(height, start, axis=1) < -near
    cut = np.count_nonzero(high & low, axis=1)
    held = np.count_nonzero(~high & ~low, axis=1)
    return int(np.lexsort((-held, cut))[0])


def _beyond(surface: _Surface, normal: Array, offset: float, near: float, i: int) -> _Surface:
    """What of the pieces lies below a plane, without those in it and without ``i``."""
    pieces, keep = [], []
    for k, piece in enumerate(surface.pieces):
        height = piece @ normal - offset
        keep.append(k != i and bool(height.min() < -near))
        if keep[-1]:
            pieces.append(_clipped(piece, height, near) if height.max() > near else piece)
    return _only(surface, pieces, keep)


def _clipped(piece: Array, height: Array, near: float) -> Array:
    """The part of a convex piece at heights below zero."""
    kept = []
    for k in range(len(piece)):
        low, high = sorted((height[k - 1], height[k]))
        if low < -near and high > near:
            share = height[k] / (height[k] - height[k - 1])
            kept.append(piece[k] + share * (piece[k - 1] - piece[k]))
        if height[k] <= near:
            kept.append(piece[k])
    return np.array(kept)


# --- put together again -----------------------------------------------------------------------


def plain(vertices: Array, faces: Faces, tolerance: float = FLAT) -> Part:
    """A convex solid without vertices amid edges and faces; as it is where it is too thin to
    tell."""
    if is_plain(vertices, faces, tolerance):
        return Part(vertices, faces)
    try:
        return Part(*hull(vertices, tolerance))
    except GeometryError:
        return Part(vertices, faces)


def _united(parts: Sequence[Part], whole: float, tolerance: float) -> list[Part]:
    """The parts, those united of which two fill their hull."""
    parts = list(parts)
    volumes = [mass_properties(part.vertices, part.faces).volume for part in parts]
    k = 0
    while k < len(parts):
        for m in range(k + 1, len(parts)):
            sum_of_two = volumes[k] + volumes[m]
            union = _union(parts[k], parts[m], sum_of_two, PART_DEGENERATE * whole, tolerance)
            if union is not None:
                parts[k], volumes[k] = union, sum_of_two
                del parts[m], volumes[m]
                k = -1
                break
        k += 1
    return parts


def _union(a: Part, b: Part, volume: float, more: float, tolerance: float) -> Part | None:
    """Two parts as one where their hull has ``volume`` [m3] and not ``more``."""
    from scipy.spatial import ConvexHull

    p, q = a.vertices, b.vertices
    near = SEAM * size_of(np.vstack((p, q)))
    if np.any(p.min(axis=0) > q.max(axis=0) + near) or np.any(q.min(axis=0) > p.max(axis=0) + near):
        return None
    vertices = np.unique(np.vstack((p, q)), axis=0)
    if abs(ConvexHull(vertices - vertices[0]).volume - volume) > more:
        return None
    try:
        return Part(*hull(vertices, tolerance))
    except GeometryError:  # too thin to tell what its faces are
        return None


# --- seams ------------------------------------------------------------------------------------


def solid_seams(parts: Sequence[Part]) -> list[BoolArray]:
    """Of each face of each part, whether all of it lies on other parts of the block."""
    size = size_of(np.vstack([part.vertices for part in parts]))
    planes = [face_planes(part.vertices, part.faces) for part in parts]
    areas = [face_areas(part.vertices, part.faces) for part in parts]
    found = [np.zeros(len(part.faces), bool) for part in parts]
    for k, part in enumerate(parts):
        for i, face in enumerate(part.faces):
            normal, offset = planes[k][0][i], planes[k][1][i]
            covered = 0.0
            for m, other in enumerate(parts):
                if m == k:
                    continue
                near = np.abs(planes[m][1] + offset) <= SEAM * size
                near &= planes[m][0] @ normal <= -1.0 + SEAM
                for j in np.flatnonzero(near).tolist():
                    p, q = part.vertices[list(face)], other.vertices[list(other.faces[j])]
                    covered += _common_area(p, q, normal)
            found[k][i] = covered >= (1.0 - SEAM) * areas[k][i]
    return found


def _common_area(p: Array, q: Array, normal: Array) -> float:
    """Area [m2] that two convex faces in one plane share."""
    piece = q
    for k in range(len(p)):
        outward = np.cross(p[k] - p[k - 1], normal)
        height = (piece - p[k]) @ (outward / np.sqrt(outward @ outward))
        if height.min() >= 0.0:
            return 0.0
        if height.max() > 0.0:
            piece = _clipped(piece, height, 0.0)
    arm = piece - piece[0]
    return 0.5 * abs(float(np.cross(arm[1:-1], arm[2:]).sum(axis=0) @ normal))


def touched_edges(parts: Sequence[Part]) -> list[set[tuple[int, int]]]:
    """Edges of each part, lower vertex first, that another part reaches to: no edges of the block.

    What the middle of an edge touches is asked for.
    """
    size = size_of(np.vstack([part.vertices for part in parts]))
    planes = [face_planes(part.vertices, part.faces) for part in parts]
    found = []
    for k, part in enumerate(parts):
        edges = sorted(
            {
                (min(i, j), max(i, j))
                for face in part.faces
                for i, j in zip(face, face[1:] + face[:1], strict=True)
            }
        )
        rows = np.array(edges)
        middle = 0.5 * (part.vertices[rows[:, 0]] + part.vertices[rows[:, 1]])
        touched = np.zeros(len(edges), bool)
        for m in range(len(parts)):
            if m != k:
                normal, offset = planes[m]
                touched |= (middle @ normal.T - offset).max(axis=1) <= SEAM * size
        found.append({edge for edge, t in zip(edges, touched.tolist(), strict=True) if t})
    return found
