"""Faces that are nearly flat or nearly in one plane: cut into flat pieces, put together again."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.space.meshes import Mesh, edges_of, face_normals
from drystone.geometry.space.solid import plane_axes

Loop = tuple[int, ...]
Place = Array | Sequence[float]  # of two coordinates

#: Vertices of a face up to which every way of cutting it is looked at.
FEW = 8


def off_plane(points: Array) -> float:
    """How far points (n, 3) are off the plane that fits them best, at most [m]."""
    if len(points) < 4:
        return 0.0
    p = points - points.mean(axis=0)
    normal = np.linalg.svd(p)[2][2]
    return float(np.abs(p @ normal).max())


def flat_pieces(vertices: Array, face: Loop, near: float) -> list[Loop]:
    """Pieces of a face, cut along diagonals, whose vertices lie in a plane within ``near`` [m].

    As few as there may be, of those the flattest; of a flat face itself.
    """
    points = vertices[list(face)]
    if len(face) == 3 or off_plane(points) <= near:
        return [face]
    area = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    length = float(np.sqrt(area @ area))
    if length == 0.0:
        return [face]
    flat = ((points - points.mean(axis=0)) @ plane_axes(area / length)).tolist()
    every = len(face) <= FEW

    @cache
    def best(loop: Loop) -> tuple[int, float, tuple[Loop, ...]]:
        """How many pieces, how uneven the worst of them, and the pieces."""
        uneven = off_plane(points[list(loop)])
        if len(loop) == 3 or uneven <= near:
            return 1, uneven, (loop,)
        cuts = [
            (loop[i : j + 1], loop[j:] + loop[: i + 1])
            for i in range(len(loop))
            for j in range(i + 2, len(loop))
            if (i, j) != (0, len(loop) - 1) and _is_inside(flat, loop, i, j)
        ]
        if not cuts:
            return len(loop), uneven, (loop,)
        if not every:
            cuts = [min(cuts, key=lambda cut: max(off_plane(points[list(p)]) for p in cut))]
        ranked = []
        for cut in cuts:
            (n, a, p), (m, b, q) = best(cut[0]), best(cut[1])
            # Of two diagonals the shorter one, which a neighbour with the same corners finds, too.
            span = points[cut[0][0]] - points[cut[0][-1]]
            ranked.append((n + m, max(a, b, near), round(float(span @ span), 9), (*p, *q)))
        n, uneven, _, pieces = min(ranked)
        return n, uneven, pieces

    return [tuple(face[i] for i in loop) for loop in best(tuple(range(len(face))))[2]]


def _is_inside(flat: Sequence[Sequence[float]], loop: Loop, i: int, j: int) -> bool:
    """Whether the diagonal between two corners of an outline lies inside."""
    a, b = flat[loop[i]], flat[loop[j]]
    for piece in (loop[i : j + 1], loop[j:] + loop[: i + 1]):
        p = [flat[m] for m in piece]
        if sum(u[0] * v[1] - v[0] * u[1] for u, v in pairwise((*p, p[0]))) <= 0.0:
            return False
    for k in range(len(loop)):
        m = (k + 1) % len(loop)
        if k in (i, j) or m in (i, j):
            continue
        c, d = flat[loop[k]], flat[loop[m]]
        if _side(a, b, c) * _side(a, b, d) <= 0.0 and _side(c, d, a) * _side(c, d, b) <= 0.0:
            return False
    return True


def _side(a: Place, b: Place, c: Place) -> float:
    """Twice the area of a triangle, above zero where it runs counter-clockwise."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def plane_labels(mesh: Mesh, near: float) -> list[int]:
    """Number of the plane that each face lies in, where faces that meet share one.

    Faces join the largest one beside them as long as none of their vertices is farther than
    ``near`` [m] off its plane, and they do not look another way, as do the sides and the back of
    a solid that is no thicker.
    """
    normals = face_normals(mesh)
    area = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(area > 0.0, area, 1.0)[:, None]
    by_edge = {edge: k for k, face in enumerate(mesh.faces) for edge in edges_of(face)}
    label = [-1] * len(mesh.faces)
    for number, seed in enumerate(np.argsort(-area, kind="stable").tolist()):
        if label[seed] >= 0:
            continue
        label[seed], todo = number, [seed]
        middle = mesh.vertices[list(mesh.faces[seed])].mean(axis=0)
        while todo:
            for a, b in edges_of(mesh.faces[todo.pop()]):
                k = by_edge.get((b, a), seed)
                # A sliver's own normal says nothing: it goes where its vertices are.
                thin = area[k] < near * near
                if label[k] >= 0 or (normals[k] @ normals[seed] <= 0.0 and not thin):
                    continue
                off = (mesh.vertices[list(mesh.faces[k])] - middle) @ normals[seed]
                if float(np.abs(off).max()) <= near:
                    label[k] = number
                    todo.append(k)
    return label


def united(mesh: Mesh, label: Sequence[int], near: float) -> tuple[Mesh, list[int], int, int]:
    """Faces of one plane that meet put together; vertices amid edges and faces left out.

    Vertices amid an edge are within ``near`` [m] of it.  Returns the mesh, the plane of each face,
    how many faces and how many vertices went.  Faces that go around a hole stay in pieces.
    """
    groups: dict[int, list[Loop]] = {}
    for face, number in zip(mesh.faces, label, strict=True):
        groups.setdefault(number, []).append(face)
    faces: list[Loop] = []
    labels: list[int] = []
    for number, own in groups.items():
        for loops in _connected(own):
            outline = _outline(loops) if len(loops) > 1 else None
            faces += [outline] if outline else loops
            labels += [number] * (1 if outline else len(loops))
    merged = Mesh(mesh.vertices, tuple(faces))
    plain = _without_straight(merged, near)
    used = Mesh.of_used(plain.vertices, plain.faces)
    removed = len(mesh.faces) - len(faces), len(mesh.vertices) - len(used.vertices)
    return used, labels, *removed


def _connected(faces: Sequence[Loop]) -> list[list[Loop]]:
    """Faces that share edges, group by group."""
    by_edge = {edge: k for k, face in enumerate(faces) for edge in edges_of(face)}
    left, found = set(range(len(faces))), []
    while left:
        first = min(left)
        left.discard(first)
        todo, own = [first], [first]
        while todo:
            for a, b in edges_of(faces[todo.pop()]):
                k = by_edge.get((b, a))
                if k in left:
                    left.discard(k)
                    todo.append(k)
                    own.append(k)
        found.append([faces[k] for k in sorted(own)])
    return found


def _outline(faces: Sequence[Loop]) -> Loop | None:
    """The way around several faces; None where it is not one loop through each vertex once."""
    runs = {edge for face in faces for edge in edges_of(face)}
    following: dict[int, int] = {}
    for a, b in runs:
        if (b, a) not in runs:
            if a in following:
                return None
            following[a] = b
    if not following:
        return None
    start = min(following)
    loop = [start]
    while following[loop[-1]] != start:
        loop.append(following[loop[-1]])
        if len(loop) > len(following):
            return None
    return tuple(loop) if len(loop) == len(following) else None


def _without_straight(mesh: Mesh, near: float) -> Mesh:
    """The mesh without vertices of two faces only: they lie amid an edge of both."""
    owners: dict[int, list[int]] = {}
    for k, face in enumerate(mesh.faces):
        for i in face:
            owners.setdefault(i, []).append(k)
    faces = [list(face) for face in mesh.faces]
    for i, own in owners.items():
        if len(own) != 2:
            continue
        ways = []
        for k in own:
            at = faces[k].index(i)
            ways.append({faces[k][at - 1], faces[k][(at + 1) % len(faces[k])]})
        if ways[0] != ways[1] or any(len(faces[k]) < 4 for k in own):
            continue
        a, b = (mesh.vertices[j] for j in ways[0])
        if not _is_between(mesh.vertices[i], a, b, near):
            continue
        for k in own:
            faces[k].remove(i)
    return Mesh(mesh.vertices, tuple(map(tuple, faces)))


def _is_between(point: Array, a: Array, b: Array, near: float) -> bool:
    """Whether a point lies on the way from a to b, within ``near`` [m]."""
    way = b - a
    length = float(np.sqrt(way @ way))
    if length <= near:
        return False
    along = float((point - a) @ way) / length
    off = point - a - along / length * way
    return 0.0 < along < length and float(np.sqrt(off @ off)) <= near


def triangles(vertices: Array, face: Loop) -> list[Loop]:
    """A flat face, which may be concave, cut into triangles."""
    left = list(face)
    points = vertices[left]
    area = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    length = float(np.sqrt(area @ area))
    if len(left) == 3 or length == 0.0:
        return [(left[0], left[k], left[k + 1]) for k in range(1, len(left) - 1)]
    flat = dict(zip(left, (points - points[0]) @ plane_axes(area / length), strict=True))
    found = []
    while len(left) > 3:
        ears = [k for k in range(len(left)) if _is_ear(flat, left, k)]
        # The ear with the widest corner of those there are leaves no needles for later.
        k = max(ears, key=lambda k: _sharpness(flat, left, k)) if ears else 1
        found.append((left[k - 1], left[k], left[(k + 1) % len(left)]))
        del left[k]
    return [*found, tuple(left)]


def _is_ear(flat: dict[int, Array], loop: list[int], k: int) -> bool:
    """Whether the triangle at a corner is inside of the outline, and nothing else in it."""
    i, j, m = loop[k - 1], loop[k], loop[(k + 1) % len(loop)]
    a, b, c = flat[i], flat[j], flat[m]
    if _side(a, b, c) <= 0.0:
        return False
    return not any(
        _side(a, b, flat[o]) >= 0.0 and _side(b, c, flat[o]) >= 0.0 and _side(c, a, flat[o]) >= 0.0
        for o in loop
        if o not in (i, j, m)
    )


def _sharpness(flat: dict[int, Array], loop: list[int], k: int) -> float:
    """Smallest sine of the triangle at a corner, about."""
    a, b, c = (flat[loop[i % len(loop)]] for i in (k - 1, k, k + 1))
    longest = max(float((q - p) @ (q - p)) for p, q in ((a, b), (b, c), (c, a)))
    return _side(a, b, c) / longest if longest > 0.0 else 0.0
