"""Arrays of convex parts in space, for kernels: as designed, in present poses, and scratch
memory."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.contact.space.overlap import N_NAME
from drystone.geometry.rotation import place_axes


class Shapes(NamedTuple):
    """Contact shapes of all convex parts; vertices, faces and edges of a part follow each other.

    Faces run counter-clockwise seen from outside.  An edge leads from its first vertex to its
    second one around its first face, and against the sense of its second face.
    """

    centroid: Array  # (n, 3) m, as designed
    axes: Array  # (n, 3, 3) columns are the bodies' principal axes as designed
    of_part: IntArray  # (n_parts,) body of each part
    radius: Array  # (n_parts,) m, by which the surface lies outside the faces
    size: Array  # (n_parts,) m, six times volume over surface: the edge of a cube
    first: IntArray  # (n_parts + 1, 3) first vertex, face and edge of each part
    local: Array  # (n_vertices, 3) m, relative to the body's centroid
    ring: IntArray  # (n_faces + 1,) first corner of each face
    corner: IntArray  # (n_corners, 2) vertex, and the edge from there to the next corner
    setback: Array  # (n_corners,) m, by how much that edge lies inside of the designed face
    plane: Array  # (n_faces, 6) outward normal, and first tangent
    extent: Array  # (n_faces, 2) area [m2] and width [m]
    edge: IntArray  # (n_edges, 4) two vertices, two faces


class World(NamedTuple):
    """Bodies in their present poses; scratch memory, filled anew for all poses."""

    rotation: Array  # (n, 3, 3) rotation less identity
    axes: Array  # (n, 3, 3) columns are the principal axes
    vertex: Array  # (n_vertices, 3) m
    normal: Array  # (n_faces, 3)
    middle: Array  # (n_parts, 3) mean of the vertices [m]

    @classmethod
    def of(cls, shapes: Shapes) -> World:
        """Memory for the bodies of these shapes."""
        n = len(shapes.centroid)
        return cls(
            rotation=np.zeros((n, 3, 3)),
            axes=np.zeros((n, 3, 3)),
            vertex=np.zeros_like(shapes.local),
            normal=np.zeros((len(shapes.plane), 3)),
            middle=np.zeros((len(shapes.of_part), 3)),
        )


class Scene(NamedTuple):
    """The arrays of shapes and world that the search for contact points reads, as one record.

    The references of each array in a record are counted at every call.  So the record has no array
    that the kernels do not need.
    """

    first: IntArray
    ring: IntArray
    corner: IntArray
    setback: Array
    local: Array
    plane: Array
    extent: Array
    edge: IntArray
    of_part: IntArray
    radius: Array
    size: Array
    centroid: Array
    pose: Array  # (n, 7)
    rotation: Array
    vertex: Array
    normal: Array


class Scratch(NamedTuple):
    """Scratch memory for two faces and their overlap, allocated once and used for one pair at a
    time."""

    reference: Array  # (most, 2) m, corners of the reference face, seen along its normal
    incident: Array  # (most, 2) m, corners of the incident face
    polygon: Array  # (2, capacity, 2) m, corners of their overlap; see `overlap.clip`
    name: IntArray  # (2, capacity, N_NAME) names of these corners
    point: Array  # (largest, 2) m, contact points; see `overlap.spread`
    mark: IntArray  # (largest, 4) names of these points
    weight: Array  # (largest,) m2, tributary areas of these points
    work: Array  # (5, 3) tangents of the reference face, and scratch of rims
    crossing: Array  # (5, 3) of edges, see `separation.best_edges`; kept while faces are tried
    # (largest + 1, 2) features of the former points of the pair; -1 follows the last.
    known: IntArray


@njit(cache=True)
def scene_of(shapes, pose, world):
    """The record of shapes in the poses (n, 7), for which ``world`` has been filled."""
    return Scene(
        shapes.first,
        shapes.ring,
        shapes.corner,
        shapes.setback,
        shapes.local,
        shapes.plane,
        shapes.extent,
        shapes.edge,
        shapes.of_part,
        shapes.radius,
        shapes.size,
        shapes.centroid,
        pose,
        world.rotation,
        world.vertex,
        world.normal,
    )


@njit(cache=True)
def scratch_for(ring, points):
    """Scratch memory for the faces whose first corners are in ``ring``; an overlap has at most this
    number of ``points`` if it is a quadrilateral."""
    most = 0
    for f in range(ring.shape[0] - 1):
        most = max(most, ring[f + 1] - ring[f])
    capacity = 2 * most + 8
    largest = max(4 * capacity, points)
    return Scratch(
        np.empty((most, 2)),
        np.empty((most, 2)),
        np.empty((2, capacity, 2)),
        np.empty((2, capacity, N_NAME), np.int64),
        np.empty((largest, 2)),
        np.empty((largest, 4), np.int64),
        np.empty(largest),
        np.empty((5, 3)),
        np.empty((5, 3)),
        np.empty((largest + 1, 2), np.int64),
    )


@njit(cache=True)
def rotate_bodies(shapes, pose, world):
    """Fill ``world`` with rotations and principal axes of all bodies in poses (n, 7)."""
    designed, rotation, axes = shapes.axes, world.rotation, world.axes
    for body in range(pose.shape[0]):
        place_axes(pose, body, designed, rotation, axes)


@njit(cache=True)
def place(shapes, pose, world):
    """Fill ``world`` with vertices and face normals of all parts in poses (n, 7), and with the
    results of `rotate_bodies`."""
    rotate_bodies(shapes, pose, world)
    rotation, vertex, normal, middle = world.rotation, world.vertex, world.normal, world.middle
    first, of_part, centroid = shapes.first, shapes.of_part, shapes.centroid
    local, plane = shapes.local, shapes.plane
    for part in range(of_part.shape[0]):
        body = of_part[part]
        middle[part, :] = 0.0
        share = 1.0 / (first[part + 1, 0] - first[part, 0])
        for v in range(first[part, 0], first[part + 1, 0]):
            for i in range(3):
                arm = local[v, i]
                for k in range(3):
                    arm += rotation[body, i, k] * local[v, k]
                vertex[v, i] = centroid[body, i] + pose[body, i] + arm
                middle[part, i] += share * vertex[v, i]
        for f in range(first[part, 1], first[part + 1, 1]):
            for i in range(3):
                along = plane[f, i]
                for k in range(3):
                    along += rotation[body, i, k] * plane[f, k]
                normal[f, i] = along
