"""Convex parts in space as contact shapes: vertices, faces and edges, packed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.space.shapes import Shapes

Faces = tuple[tuple[int, ...], ...]


@lru_cache(maxsize=1024)  # blocks of a wall have their faces in common
def _topology(faces: Faces) -> tuple[IntArray, IntArray, IntArray]:
    """Topology of a part: number of corners of each face (n_faces,); vertex, next vertex and edge
    of each corner (k, 3); edges (n_edges, 4).

    An edge has two vertices, the face around which it leads from the first to the second, and the
    face around which it leads back.
    """
    count = np.array([len(face) for face in faces])
    edge_of: dict[tuple[int, int], int] = {}
    edges: list[list[int]] = []
    corners = []
    for f, face in enumerate(faces):
        for i, j in pairwise((*face, face[0])):
            if (j, i) in edge_of:
                edge = edge_of[j, i]
                edges[edge][3] = f
            else:
                edge = edge_of[i, j] = len(edges)
                edges.append([i, j, f, f])
            corners.append((i, j, edge))
    return count, np.array(corners), np.array(edges)


def _planes(local: Array, ring: IntArray, corner: IntArray) -> tuple[Array, Array, Array]:
    """Outward normal times area, first tangent, and area and width of each face.

    ``corner`` (k, 2) holds the vertex of each corner and the next one.
    """
    owner = np.repeat(np.arange(len(ring) - 1), np.diff(ring))
    start = local[corner[ring[:-1], 0]]
    here, after = local[corner[:, 0]], local[corner[:, 1]]
    swept = np.cross(here - start[owner], after - start[owner])
    swept = 0.5 * np.add.reduceat(swept, ring[:-1], axis=0)
    area = np.linalg.norm(swept, axis=1)
    perimeter = np.add.reduceat(np.linalg.norm(after - here, axis=1), ring[:-1])
    normal = swept / area[:, None]
    tangent = after[ring[:-1]] - start
    tangent -= np.einsum("ij,ij->i", tangent, normal)[:, None] * normal
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return swept, tangent, np.column_stack((area, 4.0 * area / perimeter))


def _all_topology(
    cores: Sequence[tuple[Array, Faces]],
) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Topology of all parts: first vertex, face and edge of each part (n_parts + 1, 3); first
    corner of each face (n_faces + 1,); corners and edges as in `_topology`."""
    topology = [_topology(faces) for _, faces in cores]
    numbers = [
        (len(core), len(count), len(edges))
        for (core, _), (count, _, edges) in zip(cores, topology, strict=True)
    ]
    first = np.zeros((len(cores) + 1, 3), np.int64)
    np.cumsum(numbers, axis=0, out=first[1:])
    count = np.concatenate([count for count, _, _ in topology])
    ring = np.concatenate(([0], np.cumsum(count))).astype(np.int64)
    corner = np.vstack(
        [corners + (v, v, e) for (v, _, e), (_, corners, _) in zip(first, topology, strict=False)]
    )
    edge = np.vstack(
        [edges + (v, v, f, f) for (v, f, _), (_, _, edges) in zip(first, topology, strict=False)]
    )
    return first, ring, corner, edge


def pack(
    cores: Sequence[tuple[Array, Faces]],
    of_part: IntArray,
    radius: Array,
    setback: Array,
    centroid: Array,
    axes: Array,
) -> Shapes:
    """Contact shapes of convex parts.

    Parameters
    ----------
    cores
        For each part: vertices relative to the body's centroid, (m, 3) [m], and faces as rows of
        these vertices, counter-clockwise seen from outside.  Faces in one plane must be one face.
    of_part
        Body of each part, (n_parts,).
    radius
        Distance of the surface from the core, (n_parts,) [m].
    setback
        Distance by which the sides of faces lie inside the designed sides, (n_corners,) [m].
    centroid
        Designed centroids of the bodies, (n, 3) [m].
    axes
        Designed principal axes of the bodies, in columns, (n, 3, 3).
    """
    local = np.ascontiguousarray(np.vstack([core for core, _ in cores]), dtype=np.float64)
    first, ring, corner, edge = _all_topology(cores)
    swept, tangent, extent = _planes(local, ring, corner[:, :2])
    area = extent[:, 0]
    start = local[corner[ring[:-1], 0]]
    volume = np.add.reduceat(np.einsum("ij,ij->i", swept, start), first[:-1, 1]) / 3.0
    return Shapes(
        centroid=np.ascontiguousarray(centroid, dtype=np.float64),
        axes=np.ascontiguousarray(axes, dtype=np.float64),
        of_part=np.ascontiguousarray(of_part, dtype=np.int64),
        radius=np.ascontiguousarray(radius, dtype=np.float64),
        size=6.0 * volume / np.add.reduceat(area, first[:-1, 1]),
        first=first,
        local=local,
        ring=ring,
        corner=np.ascontiguousarray(corner[:, (0, 2)]),
        setback=np.ascontiguousarray(setback, dtype=np.float64),
        plane=np.ascontiguousarray(np.hstack((swept / area[:, None], tangent))),
        extent=extent,
        edge=np.ascontiguousarray(edge),
    )
