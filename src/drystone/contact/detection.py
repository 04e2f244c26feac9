"""Contact detection: from an assembly and poses to the slots of `kernels.narrow`.

The pair list is made for boxes grown by a margin and stays good until some block has moved by
half of that since; blocks that come to touch later are therefore always found.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.contact.forces import ContactForces
from drystone.geometry.broad import candidate_pairs
from drystone.geometry.motion import bound
from drystone.kernels import measures as kernels
from drystone.kernels import narrow
from drystone.kernels.contacts import (
    FIRST,
    GAP,
    PART_A,
    PART_B,
    SIZE,
    A,
    B,
    Pairs,
    Slots,
)
from drystone.kernels.narrow import POINTS, Bodies, World

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Margin of the broad phase over the smallest block size, a matter of speed only.
MARGIN_SHARE = 0.25


def bodies_of(assembly: Assembly) -> Bodies:
    """Contact shapes of an assembly as the kernels take them."""
    shapes = assembly.shapes
    following = np.arange(1, len(shapes.vertices) + 1, dtype=np.int64)
    following[shapes.offset[1:] - 1] = shapes.offset[:-1]
    edge = shapes.vertices[following] - shapes.vertices
    length = np.hypot(edge[:, 0], edge[:, 1])
    return Bodies(
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


class Detector:
    """Finds pairs and contacts of one assembly; holds constant arrays and scratch, no state."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.bodies = bodies_of(assembly)
        self.world = World(
            vertex=np.zeros_like(self.bodies.local),
            tangent=np.zeros_like(self.bodies.local),
            arm=np.zeros_like(self.bodies.local),
            turn=np.zeros((assembly.n_bodies, 2)),
        )
        #: Largest gap at which a contact is watched [m].
        self.reach = MARGIN_SHARE * assembly.smallest_extent
        shapes = assembly.shapes
        #: First part of each body.
        self.first_part = np.searchsorted(shapes.body, np.arange(assembly.n_bodies))
        first = shapes.offset[self.first_part]
        #: Farthest core vertex from the centroid, (n,) [m].
        self.extent = np.maximum.reduceat(np.hypot(*shapes.vertices.T), first)

    def extents(self, pose: Array, axes: Array) -> tuple[Array, Array]:
        """Lowest and highest coordinate of each body along unit vectors (k, dim), (n, k) each."""
        lower, upper = self._part_extents(pose, axes)
        first = self.first_part
        return np.minimum.reduceat(lower, first, axis=0), np.maximum.reduceat(upper, first, axis=0)

    def _part_extents(self, pose: Array, axes: Array) -> tuple[Array, Array]:
        narrow.place(self.bodies, pose, self.world)
        along = self.world.vertex @ axes.T
        first, radius = self.bodies.offset[:-1], self.bodies.radius[:, None]
        lower = np.minimum.reduceat(along, first, axis=0) - radius
        return lower, np.maximum.reduceat(along, first, axis=0) + radius

    def pairs(self, pose: Array, gone: BoolArray | None = None) -> Pairs:
        """Candidate pairs in the given poses, of parts of two blocks, not both of them supports.

        Blocks that are ``gone`` (n,) have none.
        """
        fixed, of_part = self.assembly.fixed, self.bodies.of_part
        lower, upper = self._part_extents(pose, np.eye(self.assembly.dimension))
        part_a, part_b = candidate_pairs(lower - self.reach, upper + self.reach)
        a, b = of_part[part_a], of_part[part_b]
        meet = (a != b) & ~(fixed[a] & fixed[b])
        if gone is not None and gone.any():
            meet &= ~(gone[a] | gone[b])
        a, b = a[meet], b[meet]
        columns = a, b, part_a[meet], part_b[meet], self.assembly.law_index(a, b)
        return Pairs.of(columns, np.full(len(a), POINTS), pose)

    def outdated(self, pairs: Pairs, pose: Array) -> bool:
        """Whether some block has moved so far that a pair may be missing."""
        return self.farthest(self.assembly.difference(pose, pairs.pose)) > 0.5 * self.reach

    def travelled(self, pose: Array) -> Array:
        """Bound on how far any point of each block is from its designed place [m], (n,)."""
        return self.motion(self.assembly.difference(pose, self.assembly.rest_pose()))

    def motion(self, increment: Array) -> Array:
        """Bound on the displacement of any point of each block [m], (n,), for pose increments."""
        return bound(increment, self.extent)

    def farthest(self, increment: Array) -> float:
        """The largest of these bounds [m]; not a number where an increment is none."""
        return kernels.farthest(increment, self.extent)

    def find(self, pairs: Pairs, pose: Array, before: Slots | None = None) -> Slots:
        """All contacts of the pairs in the given poses.

        Where two choices of features are as good, those are kept that slots had ``before``.
        """
        slots = Slots.empty(pairs.n_slots, self.assembly.dimension)
        self.fill(pairs, pose, slots)
        return slots

    def fill(self, pairs: Pairs, pose: Array, slots: Slots) -> None:
        """Find all contacts of the pairs in the given poses, into ``slots``."""
        narrow.find_contacts(self.bodies, pose, self.world, pairs, self.reach, slots)

    def follow(self, pairs: Pairs, pose: Array, known: Slots, slots: Slots) -> None:
        """The contacts in ``known``, by their features, in the given poses, into ``slots``."""
        narrow.follow_contacts(self.bodies, pose, self.world, pairs, known, slots)

    def forces(
        self, pairs: Pairs, pose: Array, slots: Slots, reaction: Array, status: IntArray
    ) -> ContactForces:
        """Used slots as results; ``reaction`` (n_slots, dim) holds normal and tangential [N]."""
        used, dim = np.flatnonzero(slots.kind), self.assembly.dimension
        which, value, bodies = pairs.which[pairs.of_slot[used]], slots.value[used], self.bodies
        position = np.empty((len(used), dim))
        kernels.contact_points(slots, pairs, bodies.centroid, bodies.radius, pose, used, position)
        return ContactForces(
            block_a=which[:, A],
            block_b=which[:, B],
            position=position,
            normal=slots.normal[used],
            gap=value[:, GAP],
            area=value[:, SIZE] * self.assembly.thickness,
            normal_reaction=reaction[used, 0],
            tangential_reaction=reaction[used, 1:],
            status=status[used],
            tangent=slots.tangents[used, 0] if dim == 3 else np.zeros((len(used), 0)),
        )


def predecessor_pairs(previous: Pairs, current: Pairs) -> IntArray:
    """Row of each current pair in the previous list, or -1, (n_pairs,)."""
    n = int(max(pairs.which[:, PART_B].max(initial=0) for pairs in (previous, current))) + 1
    old, new = (p.which[:, PART_A] * n + p.which[:, PART_B] for p in (previous, current))
    if len(old) == 0:
        return np.full(len(new), -1, np.int64)
    row = np.minimum(np.searchsorted(old, new), len(old) - 1)
    return np.where(old[row] == new, row, -1).astype(np.int64)


def predecessor_slots(previous: Pairs, current: Pairs) -> IntArray:
    """Slot of each current slot in the previous list, or -1, (n_slots,)."""
    if previous.n_pairs == 0:
        return np.full(current.n_slots, -1, np.int64)
    row = predecessor_pairs(previous, current)
    later = previous.which[row, FIRST] - current.which[:, FIRST]
    of_slot = current.of_slot
    return np.where(row[of_slot] >= 0, np.arange(len(of_slot)) + later[of_slot], -1)
