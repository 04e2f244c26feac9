"""Contact shapes of convex parts whose edges are treated: never of their mass.

A core is a convex part, smaller than its own where edges are rounded, that is swept with a ball or
a disc; of chamfered parts the core is what is left.  Where a part goes on in another one of the
same block, at a seam, nothing is taken off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import DEGENERATE
from drystone.geometry import GeometryError
from drystone.geometry.plane import polygon
from drystone.geometry.space.cells import Cell, Point, below, cell_of, heights, packed
from drystone.geometry.space.solid import Faces, face_planes, size_of


@dataclass(frozen=True, kw_only=True)
class SolidCore:
    """What is left of a convex solid when its edges are treated: a core polyhedron plus a ball."""

    vertices: Array  # (n, 3) m
    faces: Faces
    origin: IntArray  # (n_faces,) the solid's face that each lies on or behind; -1: a cut edge
    setback: Array  # (n_corners,) m, by how much each side of each face lies inside of that face's
    radius: float  # m


def sharp_solid(vertices: Array, faces: Faces) -> SolidCore:
    """The solid itself."""
    return SolidCore(
        vertices=vertices.copy(),
        faces=faces,
        origin=np.arange(len(faces)),
        setback=np.zeros(sum(map(len, faces))),
        radius=0.0,
    )


def rounded_solid(
    vertices: Array, faces: Faces, radius: float, seam: BoolArray | None = None
) -> SolidCore:
    """Solid with its faces moved inwards by ``radius`` [m], to be swept with a ball of that radius.

    Faces that are seams (n_faces,) stay.  Raises `GeometryError` where nothing is left of a face.
    """
    normal, _ = face_planes(vertices, faces)
    back = np.full(len(faces), radius) if seam is None else np.where(seam, 0.0, radius)
    core = _same_faces(vertices, faces, normal, back)
    if core is not None:
        return _cored(vertices, faces, core, faces, np.arange(len(faces)), radius)
    points, cell = cell_of(vertices, faces)
    on = vertices[[face[0] for face in faces]] - back[:, None] * normal
    planes = np.hstack((normal, on)).tolist()
    cuts = [(planes[i], i) for i in np.flatnonzero(back > 0.0).tolist()]
    left = _cut(points, cell, cuts, DEGENERATE * size_of(vertices))
    _check_faces(left, faces, f"the corner radius {radius:g} m", "take a smaller radius")
    return _cored(vertices, faces, *_taken(points, left), radius)


def chamfered_solid(
    vertices: Array,
    faces: Faces,
    leg: float,
    uncut: frozenset[tuple[int, int]] | set[tuple[int, int]] = frozenset(),
) -> SolidCore:
    """Solid with every edge cut off at ``leg`` [m] from it on both of its faces.

    Edges named in ``uncut``, the lower vertex first, stay: those at which the part goes on in
    another one.  Raises `GeometryError` where nothing is left of a face.
    """
    normal, _ = face_planes(vertices, faces)
    side = {edge: k for k, face in enumerate(faces) for edge in pairwise((*face, face[0]))}
    edges = [(i, j) for i, j in side if i < j and (i, j) not in uncut]
    points, cell = cell_of(vertices, faces)
    cuts = []
    if edges:
        start, end = vertices[[i for i, _ in edges]], vertices[[j for _, j in edges]]
        f = normal[[side[edge] for edge in edges]]
        g = normal[[side[edge[::-1]] for edge in edges]]
        along = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
        cut = f + g
        cut /= np.linalg.norm(cut, axis=1)[:, None]
        # On f the inside lies to the left of the edge, in the direction f x along.
        depth = leg * np.abs(np.sum(np.cross(f, along) * cut, axis=1))
        deep = depth > DEGENERATE * size_of(vertices)
        planes = np.hstack((cut, start - depth[:, None] * cut))[deep]
        cuts = [(plane, -1) for plane in planes.tolist()]
    left = _cut(points, cell, cuts, DEGENERATE * size_of(vertices))
    _check_faces(left, faces, f"the chamfer of {leg:g} m", "take a smaller chamfer")
    return _cored(vertices, faces, *_taken(points, left), 0.0)


def _same_faces(vertices: Array, faces: Faces, normal: Array, back: Array) -> Array | None:
    """Corners of a solid with its faces moved ``back`` (n_faces,) [m], if it keeps all of its edges
    and three faces meet at every corner; else None."""
    corner = np.array([i for face in faces for i in face])
    if len(corner) != 3 * len(vertices):
        return None
    owner = np.repeat(np.arange(len(faces)), [len(face) for face in faces])
    order = np.argsort(corner, kind="stable")
    if not np.array_equal(corner[order[::3]], corner[order[2::3]]):
        return None
    three = owner[order].reshape(-1, 3)
    try:
        moved = np.linalg.solve(normal[three], -back[three][..., None])
    except np.linalg.LinAlgError:
        return None
    core = vertices + moved[..., 0]
    after = np.array([i for face in faces for i in face[1:] + face[:1]])
    edge = vertices[after] - vertices[corner]
    kept = np.sum((core[after] - core[corner]) * edge, axis=1)
    if not np.all(kept > DEGENERATE * np.sum(edge * edge, axis=1)):
        return None
    return core


def _cut(
    points: list[Point],
    cell: Cell,
    cuts: Sequence[tuple[Sequence[float], int]],
    tolerance: float,
) -> Cell | None:
    """What lies below all planes."""
    at: Cell | None = cell
    for plane, tag in cuts:
        if at is None:
            break
        at = below(points, at, heights(points, at, plane), tolerance, tag, {})
    return at


def _check_faces(cell: Cell | None, faces: Faces, what: str, mend: str) -> None:
    left = set() if cell is None else set(cell.tags)
    removed = [i for i in range(len(faces)) if i not in left]
    if removed:
        names = ", ".join(map(str, faces[removed[0]]))
        raise GeometryError(f"{what} leaves nothing of face {removed[0] + 1} [{names}]: {mend}")


def _taken(points: list[Point], cell: Cell | None) -> tuple[Array, Faces, IntArray]:
    """Vertices, faces and origins of what is left."""
    assert cell is not None  # a cell with nothing left has lost its faces
    vertices, faces = packed(points, cell)
    return vertices, faces, np.array(cell.tags)


def _cored(
    vertices: Array, faces: Faces, core: Array, left: Faces, origin: IntArray, radius: float
) -> SolidCore:
    """The core, with faces ``left``, of a solid; and how far their sides lie inside the solid's."""
    setback, k = np.zeros(sum(map(len, left))), 0
    normals, _ = face_planes(core, left)
    for face, normal, whole in zip(left, normals, origin.tolist(), strict=True):
        if whole >= 0:
            start, outline = core[list(face)], vertices[list(faces[whole])]
            outward = _across(np.concatenate((start[1:], start[:1])) - start, normal)
            outward /= np.sqrt((outward * outward).sum(axis=1))[:, None]
            reach = (outline @ outward.T).max(axis=0) - (start * outward).sum(axis=1)
            setback[k : k + len(face)] = np.maximum(reach, 0.0)
        k += len(face)
    return SolidCore(vertices=core, faces=left, origin=origin, setback=setback, radius=radius)


def _across(rows: Array, normal: Array) -> Array:
    """Vectors (n, 3) x one: `np.cross` in a tenth of its time."""
    x, y, z = normal.tolist()
    return rows @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


# --- parts of concave blocks in the plane -----------------------------------------------------


def rounded_outline(vertices: Array, radius: float, seam: BoolArray) -> polygon.Core:
    """`polygon.rounded_core` of a part whose edges that are seams (n,) stay.

    Raises `GeometryError` where nothing is left of an edge.
    """
    if not np.any(seam):
        return polygon.rounded_core(vertices, radius)
    edges = np.roll(vertices, -1, axis=0) - vertices
    length = np.hypot(edges[:, 0], edges[:, 1])
    tangent = edges / length[:, None]
    inward = np.column_stack((-tangent[:, 1], tangent[:, 0]))
    back = np.where(seam, 0.0, radius)
    # Each corner moves to where the two lines meet, `ahead` along the edge that follows.
    before, back_before = np.roll(tangent, 1, axis=0), np.roll(back, 1)
    cosine = np.sum(before * tangent, axis=1)
    sine = before[:, 0] * tangent[:, 1] - before[:, 1] * tangent[:, 0]
    differ = back != back_before
    ahead = back * sine / (1.0 + cosine)
    ahead[differ] += (back_before - back)[differ] / sine[differ]
    core = vertices + ahead[:, None] * tangent + back[:, None] * inward
    start = ahead
    end = -np.sum(np.roll(core - vertices, -1, axis=0) * tangent, axis=1)
    _check_edges(length - start - end, length, f"the corner radius {radius:g} m", "radius")
    return polygon.Core(vertices=core, setback=np.column_stack((start, end)), radius=radius)


def chamfered_outline(vertices: Array, leg: float, uncut: BoolArray) -> polygon.Core:
    """`polygon.chamfered_core` of a part whose corners ``uncut`` (n,) stay.

    Raises `GeometryError` where nothing is left of an edge.
    """
    if not np.any(uncut):
        return polygon.chamfered_core(vertices, leg)
    edges = np.roll(vertices, -1, axis=0) - vertices
    length = np.hypot(edges[:, 0], edges[:, 1])
    tangent = edges / length[:, None]
    start = np.where(uncut, 0.0, leg)
    end = np.roll(start, -1)
    _check_edges(length - start - end, length, f"the chamfer of {leg:g} m", "chamfer")
    core, setback = [], []
    for i in range(len(vertices)):
        core.append(vertices[i] + start[i] * tangent[i])
        setback.append((start[i], end[i]))
        if end[i] > 0.0:
            core.append(vertices[i] + (length[i] - end[i]) * tangent[i])
            setback.append((0.0, 0.0))  # the cut between this edge and the next
    return polygon.Core(vertices=np.array(core), setback=np.array(setback), radius=0.0)


def _check_edges(remaining: Array, length: Array, what: str, mend: str) -> None:
    if not np.all(remaining > DEGENERATE * length):
        i = int(np.argmin(remaining))
        raise GeometryError(
            f"{what} leaves nothing of the edge of {length[i]:g} m after vertex {i + 1} of a part: "
            f"take a smaller {mend}"
        )
