"""Faces as other programs write them, made closed surfaces: one shell after the other.

A mesh is vertices, (n, 3) [m], and faces, tuples of their rows.  Programs write points once for
every face, faces twice or inside out, several solids in one list, and edges that other vertices lie
on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from drystone.common.arrays import Array, IntArray
from drystone.common.tolerances import ON_ITSELF
from drystone.geometry import GeometryError
from drystone.geometry.links import components
from drystone.geometry.space.solid import Faces, size_of, volume_of

Edge = tuple[int, int]

#: Open edges that a message names.
MOST_NAMED = 4


@dataclass(frozen=True, eq=False)
class Mesh:
    """Faces of vertices, closed or not."""

    vertices: Array  # (n, 3) m
    faces: Faces

    @classmethod
    def of_used(cls, vertices: Array, faces: Sequence[Sequence[int]]) -> Mesh:
        """The mesh without vertices that are in no face; the others keep their order."""
        used = sorted({i for face in faces for i in face})
        row = {i: k for k, i in enumerate(used)}
        return cls(vertices[used], tuple(tuple(row[i] for i in face) for face in faces))


def edges_of(face: Sequence[int]) -> list[Edge]:
    """The way around a face, edge by edge."""
    return list(pairwise((*face, face[0])))


def faces_at_edges(faces: Iterable[Sequence[int]]) -> Counter[Edge]:
    """How many faces run along each edge, in either sense."""
    return Counter((min(edge), max(edge)) for face in faces for edge in edges_of(face))


def at_one_place(vertices: Array, near: float) -> IntArray:
    """For every vertex the first of those that are nearer than ``near`` [m], (n,)."""
    from scipy.spatial import cKDTree

    n = len(vertices)
    pairs = cKDTree(vertices).query_pairs(near, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    count, label = connected_components(links, directed=False)
    first = np.full(count, n)
    np.minimum.at(first, label, np.arange(n))
    found: IntArray = first[label]
    return found


def welded(mesh: Mesh, near: float) -> tuple[Mesh, int]:
    """The mesh with vertices that are nearer than ``near`` [m] made one, and how many went.

    The first of several stays where it is.  Faces that are left with less than three vertices go.
    """
    row = at_one_place(mesh.vertices, near).tolist()
    faces = [_without_spikes([row[i] for i in face]) for face in mesh.faces]
    merged = len(row) - len(set(row))
    return Mesh.of_used(mesh.vertices, [face for face in faces if len(face) > 2]), merged


def _without_spikes(face: list[int]) -> tuple[int, ...]:
    """A face without vertices that follow themselves, or from which the way goes straight back."""
    k = 0
    while len(face) > 2 and k < len(face):
        if face[k] == face[k - 1]:
            del face[k]
            k = max(k - 1, 0)
        elif face[k - 2] == face[k]:
            out = sorted((k - 1, k), key=lambda i: -(i % len(face)))
            for i in out:
                del face[i % len(face)]
            k = 0
        else:
            k += 1
    return tuple(face)


def once(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh with every face once, and how many were there again.

    A face and its reverse are two where solids lie on each other.  One of the two goes where all
    faces have their reverse, and where the surface closes without it: of faces that hang together,
    where every edge then has an even number of faces.
    """
    kept: dict[tuple[int, ...], tuple[int, ...]] = {}
    for face in mesh.faces:
        kept.setdefault(_turned(face), face)
    again = {}
    for key, face in kept.items():
        reverse = _turned(face[::-1])
        if reverse in kept and reverse not in again:
            again[key] = reverse
    if 2 * len(again) < len(kept):
        again = _needless(kept, again)
    for reverse in again.values():
        del kept[reverse]
    faces = tuple(kept.values())
    return Mesh(mesh.vertices, faces), len(mesh.faces) - len(faces)


def _needless(
    kept: dict[tuple[int, ...], tuple[int, ...]], again: dict[tuple[int, ...], tuple[int, ...]]
) -> dict[tuple[int, ...], tuple[int, ...]]:
    """Of faces with their reverses, those whose surface is closed without the reverse."""
    if not again:
        return {}
    keys, count = list(again), faces_at_edges(kept)
    sides = [list(faces_at_edges([face])) for face in keys]
    last: dict[Edge, int] = {}
    links = [(last.setdefault(edge, k), k) for k, own in enumerate(sides) for edge in own]
    part = components(len(keys), *np.array(links).T).tolist()
    removed = Counter((part[k], edge) for k, own in enumerate(sides) for edge in own)
    needed = {k for (k, edge), n in removed.items() if (count[edge] - n) % 2}
    return {key: again[key] for key, k in zip(keys, part, strict=True) if k not in needed}


def _turned(face: tuple[int, ...]) -> tuple[int, ...]:
    """A face that begins at its lowest vertex."""
    k = face.index(min(face))
    return face[k:] + face[:k]


def stitched(mesh: Mesh, near: float) -> tuple[Mesh, int]:
    """Edges without a mate cut at vertices of such edges that lie on them, within ``near`` [m].

    And how many vertices were put in.
    """
    added = 0
    for _ in range(2):
        runs = {edge for face in mesh.faces for edge in edges_of(face)}
        single = [edge for edge in sorted(runs) if edge[::-1] not in runs]
        if not single:
            break
        ends = np.unique(np.array(single))
        inserted = {edge: _on_edge(mesh.vertices, edge, ends, near) for edge in single}
        found = sum(map(len, inserted.values()))
        if not found:
            break
        faces = []
        for face in mesh.faces:
            loop: list[int] = []
            for edge in edges_of(face):
                loop += [edge[0], *(i for i in inserted.get(edge, ()) if i not in face)]
            faces.append(tuple(loop))
        mesh, added = Mesh(mesh.vertices, tuple(faces)), added + found
    return mesh, added


def _on_edge(vertices: Array, edge: Edge, ends: IntArray, near: float) -> list[int]:
    """Those vertices that lie on an edge, in order along it."""
    a, b = vertices[edge[0]], vertices[edge[1]]
    way = b - a
    length = float(np.sqrt(way @ way))
    arm = vertices[ends] - a
    along = arm @ (way / length)
    off = np.linalg.norm(arm - along[:, None] * (way / length), axis=1)
    on = (off <= near) & (along > near) & (along < length - near)
    return ends[on][np.argsort(along[on])].tolist()


def shells(mesh: Mesh) -> list[Mesh]:
    """The mesh's connected surfaces, in the order of their first faces.

    Faces that share an edge belong together; where more than two do, each goes on in the one that
    bounds the same solid.  A face that is there again, see `once`, stays with the first.
    """
    single = once(mesh)[0].faces
    at: dict[Edge, list[tuple[int, bool]]] = {}
    for k, face in enumerate(single):
        for a, b in edges_of(face):
            at.setdefault((min(a, b), max(a, b)), []).append((k, a < b))
    normals = face_normals(Mesh(mesh.vertices, single))
    links: list[Edge] = []
    for edge, meeting in at.items():
        if len(meeting) == 2:
            links.append((meeting[0][0], meeting[1][0]))
        elif len(meeting) > 2:
            links += _pairs_around(mesh.vertices, edge, meeting, normals)
    n = len(single)
    rows = np.array(links, np.int64).reshape(-1, 2)
    graph = coo_array((np.ones(len(rows)), (rows[:, 0], rows[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    label_of = dict(zip(map(_turned, single), label.tolist(), strict=True))
    groups: dict[int, list[tuple[int, ...]]] = {}
    for face in mesh.faces:
        key = _turned(face)
        k = label_of[key if key in label_of else _turned(face[::-1])]
        groups.setdefault(k, []).append(face)
    return [Mesh.of_used(mesh.vertices, own) for own in groups.values()]


def face_normals(mesh: Mesh) -> Array:
    """Newell's normals of the faces, as long as twice their areas, (n_faces, 3) [m2]."""
    first, rows, following = _packed(mesh.faces)
    count = np.diff(np.append(first, len(rows)))
    arm = mesh.vertices[rows] - np.repeat(mesh.vertices[rows[first]], count, axis=0)
    ahead = mesh.vertices[following] - np.repeat(mesh.vertices[rows[first]], count, axis=0)
    return np.asarray(np.add.reduceat(np.cross(arm, ahead), first))


def unevenness(mesh: Mesh) -> Array:
    """How far a vertex of each face is off its plane by Newell's normal, at most, (n_faces,) [m]:
    a bound of what it is off the plane that fits best."""
    first, rows, _ = _packed(mesh.faces)
    count = np.diff(np.append(first, len(rows)))
    normal = face_normals(mesh)
    length = np.linalg.norm(normal, axis=1)
    normal /= np.where(length > 0.0, length, 1.0)[:, None]
    points = mesh.vertices[rows]
    middle = np.add.reduceat(points, first) / count[:, None]
    off = np.sum((points - np.repeat(middle, count, axis=0)) * np.repeat(normal, count, axis=0), 1)
    return np.maximum.reduceat(np.where(np.repeat(length, count) > 0.0, np.abs(off), np.inf), first)


def _packed(faces: Faces) -> tuple[IntArray, IntArray, IntArray]:
    """Where each face begins; rows of all its vertices, and of those that follow them."""
    count = np.array([len(face) for face in faces])
    end = np.cumsum(count)
    rows = np.array([i for face in faces for i in face], np.int64)
    after = np.arange(1, len(rows) + 1)
    after[end - 1] = end - count
    return end - count, rows, rows[after]


def _pairs_around(
    vertices: Array, edge: Edge, meeting: Sequence[tuple[int, bool]], normals: Array
) -> list[Edge]:
    """Pairs of faces at an edge between which there is solid; none where they do not come out.

    Around an edge from a to b a face that runs along it has the solid on the side that is turned
    to clockwise; what comes next there and runs the other way bounds the same solid.
    """
    forward = [k for k, ahead in meeting if ahead]
    backward = [k for k, ahead in meeting if not ahead]
    if len(forward) != len(backward):
        return []
    axis = vertices[edge[1]] - vertices[edge[0]]
    axis = axis / np.sqrt(axis @ axis)
    into = {k: np.cross(normals[k], axis if ahead else -axis) for k, ahead in meeting}
    first = into[forward[0]]
    second = np.cross(axis, first)
    angle = {k: float(np.arctan2(way @ second, way @ first)) for k, way in into.items()}
    pairs, free = [], set(backward)
    for k in forward:
        # What lies on the face itself is the last to be turned to: no solid is as thin.
        turn = {m: (angle[k] - angle[m] - ON_ITSELF) % (2.0 * np.pi) for m in free}
        nearest = min(turn, key=lambda m: turn[m])
        free.discard(nearest)
        pairs.append((k, nearest))
    return pairs


def oriented(mesh: Mesh) -> tuple[Mesh, int]:
    """Faces of a closed shell made counter-clockwise from outside, and how many were turned.

    Raises `GeometryError` where the shell is open, naming the edges, where an edge has more than
    two faces, or where no orientation fits.
    """
    at: dict[Edge, list[int]] = {}
    for k, face in enumerate(mesh.faces):
        for a, b in edges_of(face):
            at.setdefault((min(a, b), max(a, b)), []).append(k)
    _check_edges(mesh, at)
    faces = list(mesh.faces)
    done, turned = {0}, 0
    todo = [0]
    while todo:
        k = todo.pop()
        own = edges_of(faces[k])
        for a, b in own:
            first, last = at[(min(a, b), max(a, b))]
            other = last if first == k else first
            along = (a, b) in edges_of(faces[other])
            if other not in done:
                if along:
                    faces[other] = faces[other][::-1]
                    turned += 1
                done.add(other)
                todo.append(other)
            elif along and other != k:
                raise GeometryError(
                    "the surface has only one side: two of its faces cannot both look outwards; "
                    "draw it anew"
                )
    if volume_of(mesh.vertices, tuple(faces)) < 0.0:
        faces = [face[::-1] for face in faces]
        turned = len(faces) - turned
    return Mesh(mesh.vertices, tuple(faces)), turned


def _check_edges(mesh: Mesh, at: dict[Edge, list[int]]) -> None:
    """Raise `GeometryError` unless each edge has two faces."""
    single = [edge for edge, by in at.items() if len(by) == 1]
    if single:
        more = f" and {len(single) - MOST_NAMED} more" if len(single) > MOST_NAMED else ""
        named = ", ".join(_edge(mesh.vertices, edge) for edge in single[:MOST_NAMED])
        raise GeometryError(
            f"the surface is open along {named}{more}: close it, or make the tolerance larger "
            "where faces nearly meet"
        )
    many = [edge for edge, by in at.items() if len(by) > 2]
    if many:
        raise GeometryError(
            f"{len(at[many[0]])} faces share the edge {_edge(mesh.vertices, many[0])}: an edge has "
            "two; take out those inside, or draw two solids apart"
        )


def _edge(vertices: Array, edge: Edge) -> str:
    """An edge in a message, by its ends."""
    a, b = (", ".join(f"{x:.6g}" for x in vertices[i]) for i in edge)
    return f"({a}) to ({b})"


def shortest_edge(mesh: Mesh) -> float:
    """Length of the shortest edge of all faces [m]."""
    rows = np.array([edge for face in mesh.faces for edge in edges_of(face)])
    return float(
        np.linalg.norm(mesh.vertices[rows[:, 1]] - mesh.vertices[rows[:, 0]], axis=1).min()
    )


def is_flat(mesh: Mesh, near: float) -> bool:
    """Whether all vertices lie in one plane, within ``near`` times the mesh's size."""
    p = mesh.vertices - mesh.vertices.mean(axis=0)
    return bool(np.linalg.svd(p, compute_uv=False)[2] <= near * size_of(mesh.vertices) * len(p))
