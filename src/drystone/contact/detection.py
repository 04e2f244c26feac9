"""Contact detection: from an assembly and poses to the slots of its narrow phase.

The pair list is made from bounding boxes, which are enlarged by a margin and by half of the largest
dilation of a joint.  The list is complete until some block has moved by half the margin.  So blocks
that touch later are always found.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import Any, Protocol

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import MARGIN_SHARE
from drystone.contact.contacts import A, B, Contacts, Pairs, Slots
from drystone.contact.forces import ContactForces
from drystone.contact.plane.detection import PlaneNarrowPhase
from drystone.geometry.broad import candidate_pairs
from drystone.geometry.motion import bound
from drystone.geometry.rotation import farthest
from drystone.model.assembly import Assembly


class NarrowPhase(Protocol):
    """The contact points of pairs of convex parts, in the plane or in space.

    Shapes of arguments and results: see `contact.plane.detection`.
    """

    bodies: Any
    """Contact shapes as kernels take them.  Both dimensions have the fields ``centroid`` (n, dim)
    [m], as designed, and ``radius`` (n_parts,) [m]."""

    def place(self, pose: Array) -> Array:
        """Core vertices in the poses."""
        ...

    def n_slots(self, part_a: IntArray, part_b: IntArray) -> IntArray:
        """Largest number of contact points of each pair of parts."""
        ...

    def find(self, pairs: Pairs, pose: Array, reach: float, slots: Slots) -> None:
        """Find all contacts with gaps up to ``reach`` [m], into ``slots``."""
        ...

    def follow(self, pairs: Pairs, pose: Array, known: Slots, slots: Slots) -> None:
        """Evaluate the contacts ``known``, with the same features, in other poses."""
        ...

    def predecessors(self, pairs: Pairs, before: Slots, now: Slots) -> IntArray:
        """The slot from which each slot inherits, or -1."""
        ...

    def rotate_shear(
        self, before: Slots, now: Slots, source: IntArray, had: Array, shear: Array
    ) -> None:
        """Turn the tangential reactions ``had`` to the tangents of the slots that inherit them."""
        ...

    def pack(self, pairs: Pairs, pose: Array, slots: Slots, laws: Array, to: Contacts) -> int:
        """Fill contacts with gradients, for solvers; returns their number."""
        ...

    def positions(self, pairs: Pairs, pose: Array, slots: Slots, used: IntArray) -> Array:
        """Places of contacts."""
        ...


def narrow_phase(assembly: Assembly) -> NarrowPhase:
    """The narrow phase for the dimension of the assembly."""
    if assembly.dimension == 2:
        return PlaneNarrowPhase(assembly)
    from drystone.contact.space.detection import SpaceNarrowPhase  # not loaded for plane models

    return SpaceNarrowPhase(assembly)


class Detector:
    """Finds pairs and contacts of one assembly.  It has constant arrays and scratch memory, but no
    state."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        #: The part that differs between plane and space.
        self.narrow = narrow_phase(assembly)
        #: Distance [m] by which two blocks may approach each other before pairs are found anew.
        self.margin = MARGIN_SHARE * assembly.smallest_extent
        #: Largest gap [m] of a contact that is listed: a joint that has dilated presses across it.
        self.reach = self.margin + max(
            assembly.dilatancy_end(law) * math.tan(math.radians(law.dilatancy_angle))
            for law in assembly.laws
        )
        shapes = assembly.shapes
        #: First part of each body.
        self.first_part = np.searchsorted(shapes.body, np.arange(assembly.n_bodies))
        first = shapes.offset[self.first_part]
        #: Farthest core vertex from the centroid, (n,) [m].
        self.extent = np.maximum.reduceat(reduce(np.hypot, shapes.vertices.T), first)

    def extents(self, pose: Array, axes: Array) -> tuple[Array, Array]:
        """Lowest and highest coordinate [m] of each body along unit vectors ``axes`` (k, dim),
        (n, k) each."""
        lower, upper = self._part_extents(pose, axes)
        first = self.first_part
        return np.minimum.reduceat(lower, first, axis=0), np.maximum.reduceat(upper, first, axis=0)

    def _part_extents(self, pose: Array, axes: Array) -> tuple[Array, Array]:
        shapes, along = self.assembly.shapes, self.narrow.place(pose) @ axes.T
        first, radius = shapes.offset[:-1], shapes.radius[:, None]
        lower = np.minimum.reduceat(along, first, axis=0) - radius
        return lower, np.maximum.reduceat(along, first, axis=0) + radius

    def pairs(self, pose: Array, departed: BoolArray | None = None) -> Pairs:
        """Candidate pairs in the given poses (n, n_pose): parts of two different blocks that are
        near each other.

        Pairs of two supports, and pairs of blocks that are ``departed`` (n,), are left out.
        """
        fixed, of_part = self.assembly.fixed, self.assembly.shapes.body
        lower, upper = self._part_extents(pose, np.eye(self.assembly.dimension))
        apart = 0.5 * (self.reach + self.margin)  # for each of the two boxes
        part_a, part_b = candidate_pairs(lower - apart, upper + apart)
        a, b = of_part[part_a], of_part[part_b]
        near = (a != b) & ~(fixed[a] & fixed[b])
        if departed is not None and departed.any():
            near &= ~(departed[a] | departed[b])
        a, b = a[near], b[near]
        part_a, part_b = part_a[near], part_b[near]
        columns = a, b, part_a, part_b, self.assembly.law_index(a, b)
        return Pairs.of(columns, self.narrow.n_slots(part_a, part_b), pose)

    def outdated(self, found_at: Array, pose: Array) -> bool:
        """Whether some block has moved so far from the poses in which pairs were found that a pair
        may be missing."""
        return self.farthest(self.assembly.difference(pose, found_at)) > 0.5 * self.margin

    def travelled(self, pose: Array) -> Array:
        """Upper bound of the displacement of any point of each block from the design [m], (n,)."""
        return self.motion(self.assembly.difference(pose, self.assembly.design_pose()))

    def motion(self, increment: Array) -> Array:
        """Upper bound of the displacement of any point of each block [m], (n,), for increments
        (n, n_dof)."""
        return bound(increment, self.extent)

    def farthest(self, increment: Array) -> float:
        """The largest of the bounds of `motion` [m]; NaN if an increment is NaN."""
        return farthest(increment, self.extent)

    def find(self, pairs: Pairs, pose: Array, before: Slots | None = None) -> Slots:
        """All contacts of the pairs in the given poses.

        If two choices of features are equally good, the one that the slots had ``before`` is kept.
        """
        slots = Slots.empty(pairs.n_slots, self.assembly.dimension)
        if before is not None:
            slots.which[:] = before.which
        self.fill(pairs, pose, slots)
        return slots

    def fill(self, pairs: Pairs, pose: Array, slots: Slots) -> None:
        """Find all contacts of the pairs in the given poses, into ``slots``.

        The features that ``slots`` hold before are kept if others are only equally good.
        """
        self.narrow.find(pairs, pose, self.reach, slots)

    def follow(self, pairs: Pairs, pose: Array, known: Slots, slots: Slots) -> None:
        """Evaluate the contacts ``known``, with the same features, in the given poses, into
        ``slots``."""
        self.narrow.follow(pairs, pose, known, slots)

    def pack(self, pairs: Pairs, pose: Array, slots: Slots, laws: Array) -> Contacts:
        """The slots in use, found in ``pose``, as contacts with gradients and stiffness."""
        assembly = self.assembly
        contacts = Contacts.empty(len(slots.kind), assembly.dimension, assembly.n_dof)
        return contacts.of(slice(self.narrow.pack(pairs, pose, slots, laws, contacts)))

    def forces(
        self, pairs: Pairs, pose: Array, slots: Slots, reaction: Array, status: IntArray
    ) -> ContactForces:
        """The slots in use as results; ``reaction`` (n_slots, dim) [N] are normal and tangential
        reactions, ``status`` (n_slots,) see `contact.forces`.

        Forces and places are those with which the contacts act on the bodies, so that they balance
        the loads.
        """
        used = np.flatnonzero(slots.kind)
        which = pairs.which[pairs.of_slot[used]]
        return ContactForces(
            block_a=which[:, A],
            block_b=which[:, B],
            position=self.narrow.positions(pairs, pose, slots, used),
            normal=slots.normal[used],
            tangent=slots.tangents[used, 0],
            gap=slots.gap[used],
            area=slots.size[used] * self.assembly.thickness,
            normal_reaction=reaction[used, 0],
            tangential_reaction=slots.ratio[used, None] * reaction[used, 1:],
            status=status[used],
        )
