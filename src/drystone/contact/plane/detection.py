"""The narrow phase of the plane, on the arrays of one assembly: see `contact.plane.narrow`."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.boxed import boxed
from drystone.contact import measures
from drystone.contact.contacts import Contacts, Pairs, Slots
from drystone.contact.plane import narrow
from drystone.contact.plane.narrow import Bodies, World
from drystone.law import packing
from drystone.model.assembly import Assembly


class PlaneNarrowPhase:
    """Contact shapes of plane blocks, and scratch; no state.  See `contact.detection`."""

    def __init__(self, assembly: Assembly) -> None:
        shapes, self.thickness = assembly.shapes, assembly.thickness
        self.points = assembly.points
        following = np.arange(1, len(shapes.vertices) + 1, dtype=np.int64)
        following[shapes.offset[1:] - 1] = shapes.offset[:-1]
        edge = shapes.vertices[following] - shapes.vertices
        length = np.hypot(edge[:, 0], edge[:, 1])
        self.bodies = Bodies(
            centroid=assembly.centroid,
            of_part=shapes.body,
            offset=shapes.offset,
            following=following,
            local=shapes.vertices,
            local_tangent=edge / length[:, None],
            length=length,
            setback=shapes.setback,
            radius=shapes.radius,
        )
        self.world = World(
            vertex=np.zeros_like(shapes.vertices),
            tangent=np.zeros_like(shapes.vertices),
            arm=np.zeros_like(shapes.vertices),
            rotation=np.zeros((assembly.n_bodies, 2)),
        )
        self.box = boxed((self.bodies, self.world))

    def place(self, pose: Array) -> Array:
        """Core vertices in the poses (n, n_pose), (n_vertices, dim) [m]; scratch."""
        narrow.place(self.bodies, pose, self.world)
        return self.world.vertex

    def n_slots(self, part_a: IntArray, part_b: IntArray) -> IntArray:
        """Contact points that pairs of parts may have at a time, (n_pairs,)."""
        return np.full(len(part_a), self.points)

    def find(self, pairs: Pairs, pose: Array, reach: float, slots: Slots) -> None:
        """Find all contacts with gaps up to ``reach`` [m], into ``slots``."""
        narrow.find_contacts(self.box, pose, pairs, reach, slots)

    def follow(self, pairs: Pairs, pose: Array, known: Slots, slots: Slots) -> None:
        """Evaluate the contacts ``known``, with the same features, in other poses, into
        ``slots``."""
        narrow.follow_contacts(self.bodies, pose, self.world, pairs, known, slots)

    def predecessors(self, pairs: Pairs, before: Slots, now: Slots) -> IntArray:
        """The slot of the same pair that each one inherits from, or -1, (n_slots,)."""
        source = np.zeros(len(now.kind), np.int64)
        narrow.find_predecessors(pairs, before, now, source)
        return source

    def rotate_shear(
        self, before: Slots, now: Slots, source: IntArray, had: Array, shear: Array
    ) -> None:
        """Do nothing: in the plane, reactions turn with the tangents of their contacts."""

    def pack(self, pairs: Pairs, pose: Array, slots: Slots, laws: Array, to: Contacts) -> int:
        """Fill contacts from the slots in use, with their gradients; returns their number."""
        return int(packing.pack(slots, pairs, laws, self.thickness, to))

    def positions(self, pairs: Pairs, pose: Array, slots: Slots, used: IntArray) -> Array:
        """Places where the slots ``used`` (m,) touch, (m, 2) [m]."""
        position, bodies = np.empty((len(used), 2)), self.bodies
        measures.contact_points(slots, pairs, bodies.centroid, bodies.radius, pose, used, position)
        return position
