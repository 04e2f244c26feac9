"""Faces of different solids that nearly lie on each other, vertices that nearly lie in faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import ALONG_PLANE
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.space.meshes import Mesh, face_normals
from drystone.geometry.space.parts import convex_pieces
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.geometry.space.solid import plane_axes


def meeting_faces(meshes: Sequence[Mesh], near: Array) -> list[tuple[int, int, int, int]]:
    """Solids a and b and their faces that lie on each other: (a, face, b, face) each.

    Within ``near`` (n,) [m] of the solid that allows less, at every corner of what they share.
    """
    packed, owner = _packed(meshes)
    # Planes of faces that are not flat lie askew; what is found is measured below.
    joints = Interfaces.of(packed, 2.0 * near)
    start, end = joints.offset[:-1], joints.offset[1:]
    found = set()
    for k in range(len(joints.size)):
        a, b = int(joints.block_a[k]), int(joints.block_b[k])
        corners = joints.corners[start[k] : end[k]]
        allowed = float(min(near[a], near[b]))
        p, q = int(joints.face_a[k]), int(joints.face_b[k])
        around = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).sum()
        # What is narrower is where two planes of one neighbour meet.
        if joints.size[k] < allowed * around:
            continue
        gap = (corners - packed.discs[q, :3]) @ packed.normals[q]
        if float(np.abs(gap).max()) <= allowed:
            found.add((a, owner[p], b, owner[q]))
    return sorted(found)


def _packed(meshes: Sequence[Mesh]) -> tuple[Polyhedra, list[int]]:
    """Convex pieces of all faces, and which face of its solid each is of."""
    blocks, owner = [], []
    for mesh in meshes:
        vertices = mesh.vertices.tolist()
        faces: list[tuple[int, ...]] = []
        normals = _unit_normals(mesh)
        for k, face in enumerate(mesh.faces):
            if not normals[k].any():
                continue  # a face without area lies on nothing
            pieces = convex_pieces(mesh.vertices[list(face)], normals[k], k)
            if len(pieces) == 1:
                faces.append(tuple(face))
            else:  # cut anew: their corners are no vertices of the solid
                for piece in pieces:
                    faces.append(tuple(range(len(vertices), len(vertices) + len(piece))))
                    vertices += piece.tolist()
            owner += [k] * len(pieces)
        blocks.append([(np.array(vertices), faces)])
    return Polyhedra.pack(blocks), owner


def _unit_normals(mesh: Mesh) -> Array:
    """Unit normals of the faces, (n_faces, 3); zero where a face has no area."""
    normals = face_normals(mesh)
    length = np.linalg.norm(normals, axis=1)
    return normals / np.where(length > 0.0, length, 1.0)[:, None]


def vertices_in_faces(
    meshes: Sequence[Mesh], near: Array, meeting: Sequence[tuple[int, int, int, int]] = ()
) -> list[tuple[int, int, int, int]]:
    """Vertices of solids a that lie in faces of solids b: (a, vertex, b, face) each.

    Within ``near`` (n,) [m] of the solid that allows less, off the plane and beside the face.
    Those of faces that are known to be ``meeting``, as `meeting_faces` has them, are left out.
    """
    from drystone.geometry.broad import candidate_pairs

    low = np.array([mesh.vertices.min(axis=0) for mesh in meshes]) - near[:, None]
    high = np.array([mesh.vertices.max(axis=0) for mesh in meshes]) + near[:, None]
    known: dict[tuple[int, int], set[tuple[int, int]]] = {}
    for a, p, b, q in meeting:
        known.setdefault((a, b), set()).update((i, q) for i in meshes[a].faces[p])
        known.setdefault((b, a), set()).update((i, p) for i in meshes[b].faces[q])
    sides = [_Sides(mesh) for mesh in meshes]
    found = []
    for p, q in zip(*(rows.tolist() for rows in candidate_pairs(low, high)), strict=True):
        allowed = float(min(near[p], near[q]))
        for a, b in ((p, q), (q, p)):
            points = meshes[a].vertices
            rows = np.flatnonzero(np.all((points >= low[b]) & (points <= high[b]), axis=1))
            if not len(rows):
                continue
            done = known.get((a, b), set())
            for i, face in sides[b].near(points[rows], allowed):
                row = int(rows[i])
                if (row, face) in done or sides[a].faces_along(row, sides[b].normal[face]):
                    continue
                loop = meshes[b].vertices[list(meshes[b].faces[face])]
                if _beside(points[row], loop, sides[b].normal[face]) <= allowed:
                    found.append((a, row, b, face))
    return found


class _Sides:
    """Planes and boxes of a solid's faces."""

    def __init__(self, mesh: Mesh) -> None:
        self.normal = _unit_normals(mesh)
        self.has_plane = self.normal.any(axis=1)
        loops = [mesh.vertices[list(face)] for face in mesh.faces]
        self.low = np.array([loop.min(axis=0) for loop in loops])
        self.high = np.array([loop.max(axis=0) for loop in loops])
        middle = np.array([loop.mean(axis=0) for loop in loops])
        self.offset = np.sum(self.normal * middle, axis=1)
        self._around: dict[int, list[int]] = {}
        for k, face in enumerate(mesh.faces):
            for i in face:
                self._around.setdefault(i, []).append(k)

    def faces_along(self, vertex: int, normal: Array) -> bool:
        """Whether a face at a vertex has that normal or its opposite, about: it goes on beside
        the other one, or does not lie on it widely enough to be a joint."""
        return bool(np.abs(self.normal[self._around[vertex]] @ normal).max() > ALONG_PLANE)

    def near(self, points: Array, allowed: float) -> list[list[int]]:
        """Pairs of points and faces that lie within a distance [m] of planes and boxes."""
        hit = self.has_plane & (np.abs(points @ self.normal.T - self.offset) <= allowed)
        hit &= np.all(points[:, None] >= self.low - allowed, axis=2)
        hit &= np.all(points[:, None] <= self.high + allowed, axis=2)
        return np.argwhere(hit).tolist()


def _beside(point: Array, loop: Array, normal: Array) -> float:
    """How far a point lies beside a face, seen along its normal [m]; 0 inside."""
    axes = plane_axes(normal)
    p = (loop - point) @ axes
    q = np.roll(p, -1, axis=0)
    across = (p[:, 1] > 0.0) != (q[:, 1] > 0.0)
    rise = np.where(across, q[:, 1] - p[:, 1], 1.0)
    if np.count_nonzero(across & (p[:, 0] - p[:, 1] / rise * (q[:, 0] - p[:, 0]) > 0.0)) % 2:
        return 0.0
    way = q - p
    square = np.sum(way * way, axis=1)
    share = np.clip(-np.sum(p * way, axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return float(np.linalg.norm(p + share[:, None] * way, axis=1).min())
