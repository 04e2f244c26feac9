"""The narrow phase of space, on the arrays of one assembly: see `contact.space.manifold`."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.contact.contacts import ARM_A_3, A, Contacts, Pairs, Slots
from drystone.contact.space import manifold, points, solids, succession
from drystone.contact.space.rows import packed_rows_in_space
from drystone.contact.space.shapes import World, place, rotate_bodies
from drystone.law import packing
from drystone.model.assembly import Assembly


class SpaceNarrowPhase:
    """Contact shapes of solids, and scratch; no state.  See `contact.detection`."""

    def __init__(self, assembly: Assembly) -> None:
        self.points, self.centroid = assembly.points, assembly.centroid
        shapes = assembly.shapes
        assert shapes.faces is not None
        vertices = np.split(shapes.vertices, shapes.offset[1:-1])
        self.bodies = solids.pack(
            list(zip(vertices, shapes.faces.faces_of_parts(), strict=True)),
            shapes.body,
            shapes.radius,
            shapes.setback,
            assembly.centroid,
            assembly.axes,
        )
        self.world = World.of(self.bodies)

    def place(self, pose: Array) -> Array:
        """Core vertices in the poses (n, 7), (n_vertices, 3) [m]; scratch."""
        place(self.bodies, pose, self.world)
        return self.world.vertex

    def n_slots(self, part_a: IntArray, part_b: IntArray) -> IntArray:
        """Contact points that pairs of parts may have at a time, (n_pairs,)."""
        return manifold.slots_of(self.bodies, self.points, part_a, part_b)

    def find(self, pairs: Pairs, pose: Array, reach: float, slots: Slots) -> None:
        """Find all contacts with gaps up to ``reach`` [m], into ``slots``.

        The faces that ``slots`` hold before are kept if others are only equally good.
        """
        manifold.find(self.bodies, pose, self.world, pairs, reach, self.points, slots)

    def follow(self, pairs: Pairs, pose: Array, known: Slots, slots: Slots) -> None:
        """Evaluate the contacts ``known``, with the same features, in other poses, into
        ``slots``."""
        points.follow(self.bodies, pose, self.world, pairs, known, slots)

    def predecessors(self, pairs: Pairs, before: Slots, now: Slots) -> IntArray:
        """The slot of the same pair that each one inherits from, or -1, (n_slots,)."""
        source = np.zeros(len(now.kind), np.int64)
        succession.find_predecessors(pairs, before, now, source)
        return source

    def rotate_shear(
        self, before: Slots, now: Slots, source: IntArray, had: Array, shear: Array
    ) -> None:
        """Turn the tangential reactions ``had`` (n_slots, 2) [N] of the slots ``before`` to the
        tangents of the slots ``now`` that inherit them, into ``shear`` (n_slots, 2) [N]."""
        succession.carried(before, now, source, had, shear)

    def pack(self, pairs: Pairs, pose: Array, slots: Slots, laws: Array, to: Contacts) -> int:
        """Fill contacts from the slots in use, with their gradients; returns their number."""
        count = int(packing.pack_laws(slots, pairs, laws, 1.0, to))
        rotate_bodies(self.bodies, pose, self.world)
        packed_rows_in_space(slots.value, to.which, count, self.world.axes, to.rows)
        return count

    def positions(self, pairs: Pairs, pose: Array, slots: Slots, used: IntArray) -> Array:
        """Places where the slots ``used`` (m,) touch, (m, 3) [m]."""
        a = pairs.which[pairs.of_slot[used], A]
        arm = slots.value[used, ARM_A_3 : ARM_A_3 + 3]
        return np.asarray(self.centroid[a] + pose[a, :3] + arm)
