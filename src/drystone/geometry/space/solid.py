"""Solids: polyhedra from vertices and faces, hulls, boxes, extruded outlines; checks and mass.

Vertices are an (n, 3) float64 array [m]; a face is a tuple of rows of that array, counter-clockwise
as seen from outside.  Rows are counted from 0 and faces, in messages, from 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.tolerances import ALIGNED, DEGENERATE, FLAT, NOBODYS_EDGE, ROUNDING, TINY
from drystone.geometry import GeometryError
from drystone.geometry.plane.polygon import check_outline

Faces = tuple[tuple[int, ...], ...]

#: Vertices of solids whose planes are kept for who asks again.
SMALL = 64


@dataclass(frozen=True, eq=False)
class Part:
    """A convex piece of a block."""

    vertices: Array  # (n, dim) m; in the plane counter-clockwise
    faces: Faces = ()  # of space; none in the plane


def size_of(vertices: Array) -> float:
    """Longest side of the box around vertices [m], the measure of what counts as small."""
    return float((vertices.max(axis=0) - vertices.min(axis=0)).max())


# --- solids made -----------------------------------------------------------------------------


def box(corners: Sequence[Sequence[float]] | Array) -> tuple[Array, Faces]:
    """The box from its lowest to its highest corner, (2, 3) [m]; raises `GeometryError`.

    Bottom first, counter-clockwise as seen from above, then the top in the same order.
    """
    corners = np.asarray(corners, dtype=np.float64)
    if corners.shape != (2, 3):
        raise GeometryError("a box needs two corners, [[x0, y0, z0], [x1, y1, z1]]")
    for axis, low, high in zip("xyz", *corners.tolist(), strict=True):
        if not low < high:
            raise GeometryError(
                f"the box runs from {axis} = {low:g} to {high:g}: give the lower corner first, "
                "then one that is higher in x, y and z"
            )
    (x0, y0, z0), (x1, y1, z1) = corners.tolist()
    around = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    vertices = np.array([(x, y, z) for z in (z0, z1) for x, y in around])
    return vertices, (
        (0, 3, 2, 1),
        (4, 5, 6, 7),
        (0, 1, 5, 4),
        (1, 2, 6, 5),
        (2, 3, 7, 6),
        (3, 0, 4, 7),
    )


def extruded(outline: Array, depth: Sequence[float]) -> tuple[Array, Faces]:
    """The prism of an outline (n, 2), [x, z] [m], from y = ``depth[0]`` to ``depth[1]`` [m].

    The outline is counter-clockwise where x points right and z up, and may be concave.  Its
    vertices come first at ``depth[0]``, then at ``depth[1]``; the faces are the front, the back,
    and one for each edge.  Raises `GeometryError`.
    """
    outline = np.asarray(outline, dtype=np.float64)
    check_outline(outline)
    y0, y1 = depth
    if not (np.isfinite(y0) and np.isfinite(y1) and y0 < y1):
        raise GeometryError(f"the depth runs from y = {y0:g} to {y1:g}: give the lower y first")
    n = len(outline)
    vertices = np.empty((2 * n, 3))
    vertices[:n, (0, 2)] = vertices[n:, (0, 2)] = outline
    vertices[:n, 1], vertices[n:, 1] = y0, y1
    front = tuple(range(n))
    around = tuple((j, i, i + n, j + n) for i, j in pairwise((*front, 0)))
    return vertices, (front, tuple(range(2 * n - 1, n - 1, -1)), *around)


def hull(vertices: Array, tolerance: float = FLAT) -> tuple[Array, Faces]:
    """The convex hull of vertices (n, 3) [m], of which none may lie inside.

    Those that lie on an edge or in a face of the hull, within ``tolerance`` times its size, are
    left out; the others keep their order and their coordinates.  Triangles in one plane make one
    face.  Raises `GeometryError`.
    """
    check_vertices(vertices)
    found = hull_of(vertices, tolerance)
    kept, faces = found
    normal, offset = _planes(vertices, faces)
    left_out = np.setdiff1d(np.arange(len(vertices)), kept)
    if len(left_out):
        depth = (offset[:, None] - normal @ vertices[left_out].T).min(axis=0)
        if depth.max() > tolerance * size_of(vertices):
            i = int(left_out[np.argmax(depth)])
            raise GeometryError(
                f"{_vertex(vertices, i)} lies {depth.max():.3g} m inside the hull of the others: "
                "take it out, or list the faces"
            )
    row = np.zeros(len(vertices), np.int64)
    row[kept] = np.arange(len(kept))
    return vertices[kept], tuple(tuple(int(row[i]) for i in face) for face in faces)


def hull_of(vertices: Array, tolerance: float) -> tuple[IntArray, Faces]:
    """Rows of the vertices that are corners of the hull, and its faces by rows of ``vertices``."""
    from scipy.spatial import ConvexHull, QhullError  # takes long to import; boxes do without

    middle = vertices.mean(axis=0)
    size = size_of(vertices)
    try:
        simplices = ConvexHull((vertices - middle) / size).simplices
    except (QhullError, ValueError):
        raise GeometryError("the vertices lie in one plane: a solid needs some beside it") from None
    p = vertices - middle
    first = p[simplices[:, 0]]
    normal = _cross(p[simplices[:, 1]] - first, p[simplices[:, 2]] - first)
    area = np.sqrt(_dot(normal, normal))
    normal /= np.where(area > 0.0, area, 1.0)[:, None]
    normal *= np.where(_dot(normal, first) < 0.0, -1.0, 1.0)[:, None]
    done = area <= DEGENERATE * size**2
    faces: list[tuple[int, ...]] = []
    corner = np.zeros(len(p), bool)
    corner[simplices] = True
    # The largest triangle says where its face lies; slivers have normals of rounding errors.
    for i in np.argsort(-area, kind="stable"):
        if done[i]:
            continue
        member = np.abs((p - first[i]) @ normal[i]) <= tolerance * size
        member &= corner
        done |= member[simplices].all(axis=1)
        members = np.flatnonzero(member)
        faces.append(_around(p, members, normal[i], tolerance * size))
    kept = np.unique(np.concatenate([np.array(face) for face in faces]))
    if not _closed(faces):
        raise GeometryError(
            "the hull of the vertices has faces that are nearly, but not quite, in one plane: "
            "list the faces, or round the coordinates less"
        )
    return kept, tuple(faces)


def _around(p: Array, members: IntArray, normal: Array, tolerance: float) -> tuple[int, ...]:
    """Corners of the convex face that holds vertices ``members``, in order around ``normal``."""
    near = p[members]
    flat = (near - near.mean(axis=0)) @ plane_axes(normal)
    order = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]), kind="stable")
    members, flat = members[order], flat[order]
    while (
        len(members) > 3
    ):  # those on an edge go one at a time: neighbours are each other's measure
        before = np.concatenate((flat[-1:], flat[:-1]))
        chord = np.concatenate((flat[1:], flat[:1])) - before
        length = np.hypot(chord[:, 0], chord[:, 1])
        arm = flat - before
        off = (arm[:, 0] * chord[:, 1] - arm[:, 1] * chord[:, 0]) / np.maximum(length, TINY)
        least = int(np.argmin(off))
        if off[least] > tolerance:
            break
        members, flat = np.delete(members, least), np.delete(flat, least, axis=0)
    start = int(np.argmin(members))
    return tuple(np.concatenate((members[start:], members[:start])).tolist())


def plane_axes(normal: Array) -> Array:
    """Two unit vectors across ``normal`` (3,), in columns (3, 2), right-handed with it."""
    x, y, z = normal.tolist()
    if abs(x) <= min(abs(y), abs(z)):
        first = np.array([0.0, z, -y])
    elif abs(y) <= abs(z):
        first = np.array([-z, 0.0, x])
    else:
        first = np.array([y, -x, 0.0])
    first /= math.sqrt(first @ first)
    u, v, w = first.tolist()
    return np.column_stack((first, (y * w - z * v, z * u - x * w, x * v - y * u)))


def _closed(faces: Sequence[Sequence[int]]) -> bool:
    """Whether every edge runs once there and once back."""
    edges = [edge for face in faces for edge in pairwise((*face, face[0]))]
    once = set(edges)
    return len(once) == len(edges) and all((b, a) in once for a, b in edges)


# --- checks ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)  # known by itself: each is made once
class _Loops:
    """Faces packed: a row for each corner of each face."""

    start: IntArray  # (n_faces,) first row of each face
    lengths: IntArray  # (n_faces,) how many corners each has
    corner: IntArray  # (k,) row of the vertex
    following: IntArray  # (k,) row of the next vertex around the face
    owner: IntArray  # (k,) the face


@lru_cache(maxsize=1024)  # blocks of a wall have their faces in common
def _loops(faces: Faces) -> _Loops:
    count = np.array([len(face) for face in faces])
    end = np.cumsum(count)
    corner = np.array([i for face in faces for i in face], dtype=np.int64)
    after = np.arange(1, len(corner) + 1)
    after[end - 1] = end - count
    owner = np.repeat(np.arange(len(faces)), count)
    return _Loops(end - count, count, corner, corner[after], owner)


def _vertex(vertices: Array, i: int) -> str:
    """A vertex in a message."""
    x, y, z = vertices[i]
    return f"vertex {i} ({x:g}, {y:g}, {z:g})"


def _face(faces: Faces, i: int) -> str:
    """A face in a message."""
    return f"face {i + 1} [{', '.join(map(str, faces[i]))}]"


def check_vertices(vertices: Array) -> None:
    """Raise `GeometryError` unless these are finite points of space, none of them twice."""
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise GeometryError("vertices must be a list of [x, y, z]")
    n = len(vertices)
    if n < 4:
        raise GeometryError(f"a solid needs at least 4 vertices, it has {n}")
    if not np.isfinite(vertices).all():
        raise GeometryError("every coordinate must be a finite number")
    i, j = _same_point(vertices)
    if i != j:
        raise GeometryError(f"{_vertex(vertices, i)} and vertex {j} are the same point: remove one")


def _same_point(vertices: Array) -> tuple[int, int]:
    """Rows of the nearest two vertices where they are one point, else one row twice."""
    near = DEGENERATE * size_of(vertices)
    # Sorted by a direction that is nobody's edge, points that are one follow each other closely.
    along = vertices @ np.array(NOBODYS_EDGE)
    order = np.argsort(along, kind="stable")
    close = np.diff(along[order]) <= 2.0 * near
    if not close.any():
        return 0, 0
    for k in np.flatnonzero(close):
        for last in range(k + 1, len(order)):
            i, j = sorted((int(order[k]), int(order[last])))
            if along[order[last]] - along[order[k]] > 2.0 * near:
                break
            if np.abs(vertices[i] - vertices[j]).max() <= near:
                return i, j
    return 0, 0


def check(vertices: Array, faces: Faces, tolerance: float = FLAT) -> None:
    """Raise `GeometryError` unless these make a solid, its faces counter-clockwise from outside.

    Finite vertices, all of them used, none twice; flat faces, of which no vertex is farther off
    than ``tolerance`` times the solid's size; a closed surface, each edge shared by two faces that
    run along it in opposite directions; a volume.  It may be concave.
    """
    check_vertices(vertices)
    _check_rows(len(vertices), faces)
    _check_flat(vertices, faces, tolerance)
    volume = volume_of(vertices, faces)
    if abs(volume) < DEGENERATE * size_of(vertices) ** 3:
        raise GeometryError("the faces enclose no volume: give the solid a thickness")
    if volume < 0.0:
        raise GeometryError(
            "the faces run clockwise as seen from outside: list the vertices of each face the "
            "other way round"
        )


@lru_cache(maxsize=1024)
def _check_rows(n: int, faces: Faces) -> None:
    """Faces of at least three of ``n`` vertices, and every vertex in one; a closed surface."""
    if len(faces) < 4:
        raise GeometryError(f"a solid needs at least 4 faces, it has {len(faces)}")
    for i, face in enumerate(faces):
        if len(face) < 3:
            raise GeometryError(f"{_face(faces, i)} needs at least 3 vertices")
        if len(set(face)) < len(face):
            raise GeometryError(
                f"{_face(faces, i)} comes to a vertex twice: take one out, or make two faces of it"
            )
        if min(face) < 0 or max(face) >= n:
            raise GeometryError(
                f"{_face(faces, i)} names a vertex that is not there: they are counted from 0 "
                f"to {n - 1}"
            )
    unused = set(range(n)).difference(*faces)
    if unused:
        raise GeometryError(f"vertex {min(unused)} is in no face: take it out")
    _check_closed(faces)


def _check_closed(faces: Faces) -> None:
    """Each edge once there and once back."""
    if _closed(faces):
        return
    runs: dict[tuple[int, int], list[int]] = {}
    for i, face in enumerate(faces):
        for edge in pairwise((*face, face[0])):
            runs.setdefault(edge, []).append(i)
    for (a, b), there_by in runs.items():
        back_by = runs.get((b, a), [])
        if len(there_by) + len(back_by) > 2:
            numbers = ", ".join(str(i + 1) for i in sorted(there_by + back_by))
            raise GeometryError(
                f"faces {numbers} share the edge from vertex {a} to {b}: an edge has two faces; "
                "take a face out, or make two parts of the solid"
            )
        if len(there_by) == 2:
            i, j = there_by
            raise GeometryError(
                f"faces {i + 1} and {j + 1} run the same way along the edge from vertex {a} to "
                f"{b}: list one of them the other way round"
            )
    (a, b), (i,) = next((edge, by) for edge, by in runs.items() if edge[::-1] not in runs)
    raise GeometryError(
        f"the surface is open: no other face meets {_face(faces, i)} along the edge from vertex "
        f"{a} to {b}: add the face that is missing"
    )


def _check_flat(vertices: Array, faces: Faces, tolerance: float) -> None:
    """Faces with an area, in a plane, that go around once."""
    loops = _loops(faces)
    size = size_of(vertices)
    area, normal, _, off = _planes_and_deviation(vertices, loops)
    if np.any(area < DEGENERATE * size**2):
        i = int(np.argmin(area))
        raise GeometryError(
            f"{_face(faces, i)} encloses no area: its vertices lie on one line, or it crosses "
            "itself; list them in order around the face"
        )
    if np.any(np.abs(off) > tolerance * size):
        k = int(np.argmax(np.abs(off)))
        i = int(loops.owner[k])
        raise GeometryError(
            f"{_face(faces, i)} is not flat: vertex {loops.corner[k]} lies {abs(off[k]):.3g} m "
            "off its plane; cut it into triangles, or mend the coordinates"
        )
    turns = _turns(vertices, loops, normal)
    if np.any(turns != 1):
        i = int(np.argmax(turns != 1))
        raise GeometryError(
            f"{_face(faces, i)} crosses itself: list its vertices in order around it"
        )


def _turns(vertices: Array, loops: _Loops, normal: Array) -> IntArray:
    """How often the way around each face turns about its normal, (n_faces,)."""
    edge = vertices[loops.following] - vertices[loops.corner]
    after = np.arange(1, len(edge) + 1)
    after[loops.start + loops.lengths - 1] = loops.start
    following = edge[after]
    sine = _dot(_cross(edge, following), normal[loops.owner])
    angle = np.arctan2(sine, _dot(edge, following))
    turns: IntArray = np.rint(np.add.reduceat(angle, loops.start) / (2.0 * np.pi)).astype(np.int64)
    return turns


def is_inside_out(vertices: Array, faces: Faces) -> bool:
    """Whether all faces of a solid run clockwise from outside; what is no solid is not."""
    try:
        check_vertices(vertices)
        _check_rows(len(vertices), faces)
    except GeometryError:
        return False
    return volume_of(vertices, faces) < 0.0


def turned_out(vertices: Array, faces: Faces) -> Faces:
    """Faces of a closed surface, all of them turned round where they run clockwise from outside."""
    if volume_of(vertices, faces) < 0.0:
        return tuple(face[::-1] for face in faces)
    return faces


# --- planes and mass -------------------------------------------------------------------------


def _cross(a: Array, b: Array) -> Array:
    """Cross products of rows, (n, 3): `np.cross` in a quarter of its time."""
    out = np.empty_like(a)
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out


def _dot(a: Array, b: Array) -> Array:
    """Dot products of rows, (n,)."""
    return np.asarray(np.einsum("ij,ij->i", a, b))


def _planes_and_deviation(vertices: Array, loops: _Loops) -> tuple[Array, Array, Array, Array]:
    """Areas, unit normals and offsets of the faces, and how far each corner is off its plane."""
    if len(vertices) <= SMALL and vertices.dtype == np.float64:
        return _known_planes(vertices.tobytes(), loops)
    return _planes_anew(vertices, loops)


@lru_cache(maxsize=4096)  # checks, parts and measures of a block ask for the same
def _known_planes(contents: bytes, loops: _Loops) -> tuple[Array, Array, Array, Array]:
    found = _planes_anew(np.frombuffer(contents).reshape(-1, 3), loops)
    for one in found:
        one.flags.writeable = False
    return found


def _planes_anew(vertices: Array, loops: _Loops) -> tuple[Array, Array, Array, Array]:
    p, q = vertices[loops.corner], vertices[loops.following]
    middle = np.add.reduceat(p, loops.start) / loops.lengths[:, None]
    near = middle[loops.owner]  # a near origin keeps the sums from cancelling
    twice = np.add.reduceat(_cross(p - near, q - near), loops.start)
    area = np.sqrt(_dot(twice, twice))
    normal = twice / np.where(area > 0.0, area, 1.0)[:, None]
    off = _dot(p - near, normal[loops.owner])
    return 0.5 * area, normal, _dot(normal, middle), off


def _planes(vertices: Array, faces: Faces) -> tuple[Array, Array]:
    _, normal, offset, _ = _planes_and_deviation(vertices, _loops(faces))
    return normal, offset


def face_planes(vertices: Array, faces: Faces) -> tuple[Array, Array]:
    """Outward unit normals (n_faces, 3) and offsets (n_faces,) [m]: ``normal @ x = offset``."""
    return _planes(vertices, faces)


def face_areas(vertices: Array, faces: Faces) -> Array:
    """Areas of the faces, (n_faces,) [m2]."""
    return _planes_and_deviation(vertices, _loops(faces))[0]


def unevenness(vertices: Array, faces: Faces) -> float:
    """How far a vertex is off the plane of one of its faces, at most [m]."""
    return float(np.abs(_planes_and_deviation(vertices, _loops(faces))[3]).max())


def volume_of(vertices: Array, faces: Faces) -> float:
    """Volume [m3] inside of a closed surface; below zero where its faces run clockwise."""
    loops = _loops(faces)
    p = vertices - vertices.mean(axis=0)
    b, c = p[loops.corner], p[loops.following]
    return float(_dot(b[loops.start[loops.owner]], _cross(b, c)).sum()) / 6.0


@dataclass(frozen=True, kw_only=True)
class SolidMass:
    """Of a unit density: volume, centroid and inertia about it."""

    volume: float  # m3
    centroid: Array  # (3,) m
    inertia: Array  # (3, 3) m5, about the centroid, in world axes


def mass_properties(vertices: Array, faces: Faces) -> SolidMass:
    """Volume, centroid and inertia of a closed surface, concave ones too.

    Sums over the tetrahedra between a point amid the vertices and the triangles that fan out from
    the first corner of each face: over one with corners 0, a, b, c the integral of ``x x^T`` is
    ``det(a, b, c) / 120 (s s^T + a a^T + b b^T + c c^T)`` with ``s = a + b + c``.
    """
    loops = _loops(faces)
    origin = vertices.mean(axis=0)  # a near origin keeps the sums from cancelling
    p = vertices - origin
    b, c = p[loops.corner], p[loops.following]
    a = b[loops.start[loops.owner]]
    det = _dot(a, _cross(b, c))
    volume = float(det.sum()) / 6.0
    s = a + b + c
    with np.errstate(divide="ignore", invalid="ignore"):  # a surface without volume is found out
        first = det @ s / (24.0 * volume)
    corners = np.concatenate((s, a, b, c))
    moment = (np.concatenate((det, det, det, det))[:, None] * corners).T @ corners / 120.0
    moment -= volume * np.outer(first, first)
    inertia = np.trace(moment) * np.eye(3) - moment
    return SolidMass(volume=volume, centroid=origin + first, inertia=0.5 * (inertia + inertia.T))


def sum_of(parts: Sequence[SolidMass]) -> SolidMass:
    """Mass properties of several solids that move as one."""
    volume = sum(part.volume for part in parts)
    near = parts[0].centroid
    centroid = near + sum(part.volume * (part.centroid - near) for part in parts) / volume
    inertia = np.zeros((3, 3))
    for part in parts:
        d = part.centroid - centroid
        inertia += part.inertia + part.volume * (d @ d * np.eye(3) - np.outer(d, d))
    return SolidMass(volume=volume, centroid=centroid, inertia=inertia)


def principal(inertia: Array) -> tuple[Array, Array]:
    """Principal axes (3, 3), in columns, right-handed, and moments (3,) of an inertia (3, 3).

    Of all orders and signs the one whose axes lie nearest to x, y and z; of equal moments, which
    leave axes free, likewise.  An inertia that is diagonal has x, y and z for its axes, exactly.
    """
    diagonal = np.diag(inertia).copy()
    largest = float(diagonal.max())
    if np.abs(inertia - np.diag(diagonal)).max() <= ALIGNED * largest:
        return np.eye(3), diagonal
    moments, axes = np.linalg.eigh(inertia)
    low, high = (np.diff(moments) <= ROUNDING * largest).tolist()
    if low and high:
        return np.eye(3), diagonal
    if low or high:
        axes = _rotated_onto(axes[:, 2 if low else 0])
    else:
        # Of rotations the one with the largest trace turns least.
        every = [_right_handed(axes[:, order]) for order in _ORDERS]
        axes = max(every, key=lambda axes: round(float(np.trace(axes)), 9))
    return axes, np.sum(axes * (inertia @ axes), axis=0)


_ORDERS = ([0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2])


def _rotated_onto(axis: Array) -> Array:
    """World axes after the smallest rotation that takes one of them, forth or back, to ``axis``."""
    k = int(np.argmax(np.round(np.abs(axis), 9)))
    axis = axis * np.sign(axis[k])
    turn = np.cross(np.eye(3)[k], axis)
    skew = np.array([[0.0, -turn[2], turn[1]], [turn[2], 0.0, -turn[0]], [-turn[1], turn[0], 0.0]])
    return np.eye(3) + skew + skew @ skew / (1.0 + axis[k])


def _right_handed(axes: Array) -> Array:
    """Columns turned to the side of x, y and z, the one that is least certain as it must be."""
    certain = np.abs(np.diag(axes))
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, int(np.argmin(np.round(certain, 9)))] *= -1.0
    return axes


def is_convex(vertices: Array, faces: Faces, tolerance: float = FLAT) -> bool:
    """Whether no vertex lies outside the plane of a face, by ``tolerance`` times the size."""
    normal, offset = _planes(vertices, faces)
    off = vertices @ normal.T - offset
    return bool(off.max() <= tolerance * size_of(vertices))


def is_plain(vertices: Array, faces: Faces, tolerance: float = FLAT) -> bool:
    """Whether it is convex, no face goes on in another one in its plane, and no vertex lies amid
    an edge."""
    if np.bincount(_loops(faces).corner, minlength=len(vertices)).min() < 3:
        return False  # of two faces alone are vertices amid an edge
    normal, offset = _planes(vertices, faces)
    off = vertices @ normal.T - offset
    near = tolerance * size_of(vertices)
    # In a face's plane are its own corners alone.
    return bool(off.max() <= near and np.count_nonzero(off >= -near) == sum(map(len, faces)))
