"""Faces of different solids that nearly lie on each other, vertices that nearly lie in faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drystone.geometry.interfaces import Interfaces
from drystone.geometry.meshes import Mesh, face_normals
from drystone.geometry.polyhedra import Polyhedra
from drystone.geometry.solid import plane_axes
from drystone.geometry.solid_parts import convex_pieces

Array = NDArray[np.float64]

#: Width of what two faces share, over the distance by which they may be apart, from which on they
#: were meant to lie on each other: less is where two planes of one neighbour meet.
WIDE = 4.0


def meeting_faces(meshes: Sequence[Mesh], near: Array) -> list[tuple[int, int, int, int]]:
    """Solids a and b and their faces that lie on each other: (a, face, b, face) each.

    Within ``near`` (n,) [m] of the solid that allows less, at every corner of what they share.
    """
    packed, owner = _packed(meshes)
    # Planes of faces that are not flat lie askew; what is found is measured below.
    joints = Interfaces.of(packed, 2.0 * float(near.max()))
    start, end = joints.offset[:-1], joints.offset[1:]
    found = set()
    for k in range(len(joints.size)):
        a, b = int(joints.block_a[k]), int(joints.block_b[k])
        corners = joints.corners[start[k] : end[k]]
        allowed = float(min(near[a], near[b]))
        p, q = int(joints.face_a[k]), int(joints.face_b[k])
        around = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).sum()
        if 4.0 * joints.size[k] < WIDE * allowed * around:
            continue
        on_q = packed.vertices[packed.rows[packed.face_offset[q]]]
        gap = (corners - on_q) @ packed.normals[q]
        if float(np.abs(gap).max()) <= allowed:
            found.add((a, owner[p], b, owner[q]))
    return sorted(found)


def _packed(meshes: Sequence[Mesh]) -> tuple[Polyhedra, list[int]]:
    """Convex pieces of all faces, and which face of its solid each is of."""
    blocks, owner = [], []
    for mesh in meshes:
        vertices = mesh.vertices.tolist()
        faces: list[tuple[int, ...]] = []
        normals = face_normals(mesh)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        for k, face in enumerate(mesh.faces):
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


def vertices_in_faces(meshes: Sequence[Mesh], near: Array) -> list[tuple[int, int, int, int]]:
    """Vertices of solids a that lie in faces of solids b: (a, vertex, b, face) each.

    Within ``near`` (n,) [m] of the solid that allows less, off the plane and beside the face.
    """
    from drystone.geometry.broad import candidate_pairs

    low = np.array([mesh.vertices.min(axis=0) for mesh in meshes]) - near[:, None]
    high = np.array([mesh.vertices.max(axis=0) for mesh in meshes]) + near[:, None]
    normals, offsets = [], []
    for mesh in meshes:
        normal = face_normals(mesh)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        middle = np.array([mesh.vertices[list(face)].mean(axis=0) for face in mesh.faces])
        normals.append(normal)
        offsets.append(np.sum(normal * middle, axis=1))
    found = []
    for p, q in zip(*(rows.tolist() for rows in candidate_pairs(low, high)), strict=True):
        allowed = float(min(near[p], near[q]))
        for a, b in ((p, q), (q, p)):
            points = meshes[a].vertices
            inside = np.all((points >= low[b]) & (points <= high[b]), axis=1)
            rows = np.flatnonzero(inside)
            height = points[rows] @ normals[b].T - offsets[b]
            for i, face in np.argwhere(np.abs(height) <= allowed).tolist():
                loop = meshes[b].vertices[list(meshes[b].faces[face])]
                if _beside(points[rows[i]], loop, normals[b][face]) <= allowed:
                    found.append((a, int(rows[i]), b, face))
    return found


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
    share = np.clip(-np.sum(p * way, axis=1) / np.sum(way * way, axis=1), 0.0, 1.0)
    return float(np.linalg.norm(p + share[:, None] * way, axis=1).min())
