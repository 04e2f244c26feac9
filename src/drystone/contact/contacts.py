"""Contacts as arrays that every kernel takes: candidate pairs, and the contacts between them.

A pair of convex parts owns a number of slots, one for each contact point that it may have at a
time.  Only the narrow phase decides this number.  Solvers work on the slots in use, packed.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry.motion import tangents

#: What meets in a slot: nothing, a vertex of b and an edge of a, the reverse, two vertices.
NONE, VERTEX_B, VERTEX_A, VERTICES = 0, 1, 2, 3


#: Columns of `Pairs.which`: blocks a and b, their parts, joint law, first slot.
A, B, PART_A, PART_B, LAW, FIRST = range(6)

#: Columns of `Contacts.which`.
SLOT, PAIR, BODY_A, BODY_B = range(4)


class Pairs(NamedTuple):
    """Candidate pairs, each with its joint law and its slots, and the poses they were found in.

    A pair consists of two convex parts; blocks with several parts may meet in several pairs.  The
    slots of a pair follow each other.  (Integers are in one array, because each further array costs
    a tenth of a microsecond at every call of a kernel.)
    """

    which: IntArray  # (n_pairs, 6) blocks, parts, law, first slot
    of_slot: IntArray  # (n_slots,) pair of each slot
    pose: Array  # (n, n_pose) poses in which the pairs were found

    @classmethod
    def of(cls, columns: Iterable[IntArray], n_slots: IntArray, pose: Array) -> Pairs:
        """Pairs from columns of `which` but the last, (n_pairs,) each, and from the number of slots
        of each pair, (n_pairs,)."""
        first = np.cumsum(n_slots) - n_slots
        return cls(
            which=np.column_stack((*columns, first)).astype(np.int64),
            of_slot=np.repeat(np.arange(len(n_slots)), n_slots),
            pose=pose.copy(),
        )

    @property
    def n_pairs(self) -> int:
        """Number of pairs."""
        return len(self.which)

    @property
    def n_slots(self) -> int:
        """Number of slots of all pairs."""
        return len(self.of_slot)

    @property
    def a(self) -> IntArray:
        """Blocks a, (n_pairs,)."""
        return np.ascontiguousarray(self.which[:, A])

    @property
    def b(self) -> IntArray:
        """Blocks b, (n_pairs,)."""
        return np.ascontiguousarray(self.which[:, B])

    @property
    def law_of_slot(self) -> IntArray:
        """Index into `Assembly.laws`, (n_slots,)."""
        return np.asarray(self.which[self.of_slot, LAW], np.int64)


#: Columns of `Slots.which`: what meets, vertex or edge (by its first vertex) of a and of b, and the
#: edges of a and of b that face each other.
KIND, FEATURE_A, FEATURE_B, EDGE_A, EDGE_B = range(5)

#: Columns of `Slots.value`: gap [m], positive open; tributary size of the joint [m], in space [m2].
#: The others are of the plane, see `contact.plane.narrow`.  For vectors, the first of their columns
#: is named.
GAP, SIZE, RATIO, ROLL_A, ROLL_B, NORMAL, ARM_A, ARM_B = 0, 1, 2, 3, 4, 5, 7, 9
#: For points between the ends of an interface: the distance from the first vertex of the edge of b,
#: over the length of this edge.
INSIDE = 11
N_VALUES = 12

#: The other columns in space: normal, first tangent, and arms from both centroids to the contact
#: point, in axes of the world.  The rest is constant while the features of the contact stay the
#: same: the point, in the designed axes of its body; then a place, the normal (away from the body)
#: and the first tangent of the plane, in the designed axes of the plane's body; the distance of the
#: surface beyond the point [m].
NORMAL_3, TANGENT_3, ARM_A_3, ARM_B_3 = 2, 5, 8, 11
POINT_3, PLACE_3, PLANE_NORMAL_3, PLANE_TANGENT_3, BALL_3 = 14, 17, 20, 23, 26
N_VALUES_3 = 27


class Layout(NamedTuple):
    """First columns of the vectors in `Slots.value`, in the plane or in space."""

    dim: int
    n_values: int
    normal: int
    tangent: int  # the first tangent; in the plane the normal, from which it follows
    arm_a: int
    arm_b: int
    ones: slice  # columns that are one in slots that are not in use


#: By the dimension.
LAYOUTS = {
    2: Layout(2, N_VALUES, NORMAL, NORMAL, ARM_A, ARM_B, slice(RATIO, RATIO + 1)),
    3: Layout(3, N_VALUES_3, NORMAL_3, TANGENT_3, ARM_A_3, ARM_B_3, slice(0, 0)),
}
_OF_WIDTH = {layout.n_values: layout for layout in LAYOUTS.values()}


class Slots(NamedTuple):
    """Contacts of all candidate pairs; see `contact.plane.narrow`."""

    which: IntArray  # (n_slots, 5)
    value: Array  # (n_slots, N_VALUES or N_VALUES_3)

    @classmethod
    def empty(cls, n: int, dim: int) -> Slots:
        """``n`` slots, none of them in use."""
        layout = LAYOUTS[dim]
        which, value = np.full((n, 5), -1), np.zeros((n, layout.n_values))
        which[:, KIND], value[:, GAP], value[:, layout.ones] = NONE, np.inf, 1.0
        return cls(which, value)

    def copied(self) -> Slots:
        """A copy, which later contact detection does not change."""
        return Slots(self.which.copy(), self.value.copy())

    def at(self, source: IntArray) -> Slots:
        """The slots ``source`` (n,); a slot not in use where the source is -1."""
        taken, known = Slots.empty(len(source), self.dim), source >= 0
        taken.which[known] = self.which[source[known]]
        taken.value[known] = self.value[source[known]]
        return taken

    # Views.

    @property
    def kind(self) -> IntArray:
        """(n_slots,)"""
        return self.which[:, KIND]

    @property
    def feature(self) -> IntArray:
        """(n_slots, 2) of a and of b"""
        return self.which[:, FEATURE_A : FEATURE_B + 1]

    @property
    def edges(self) -> IntArray:
        """(n_slots, 2) of a and of b; in space faces"""
        return self.which[:, EDGE_A : EDGE_B + 1]

    @property
    def gap(self) -> Array:
        """(n_slots,) m"""
        return self.value[:, GAP]

    @property
    def size(self) -> Array:
        """(n_slots,) m, in space m2"""
        return self.value[:, SIZE]

    @property
    def ratio(self) -> Array:
        """(n_slots,) tangential force over the reaction along the gradient of slip.  It is 1 except
        between two rounded corners in the plane; see `contact.plane.narrow`."""
        ones = self.value[:, self.layout.ones]
        return ones[:, 0] if ones.shape[1] else np.ones(len(ones))

    @property
    def dim(self) -> int:
        """2 or 3."""
        return self.layout.dim

    @property
    def layout(self) -> Layout:
        """First columns of vectors."""
        return _OF_WIDTH[self.value.shape[1]]

    @property
    def normal(self) -> Array:
        """(n_slots, dim) from a to b."""
        return self._vector(self.layout.normal)

    @property
    def tangents(self) -> Array:
        """(n_slots, dim - 1, dim) directions of the tangential reactions."""
        return tangents(self.normal, self._vector(self.layout.tangent))

    @property
    def frame(self) -> Array:
        """(n_slots, dim or 6) normal and, in space, first tangent."""
        return self.value[:, self.layout.normal : self.layout.arm_a]

    @property
    def arm_a(self) -> Array:
        """(n_slots, dim) m, from the centroid of a to the contact point"""
        return self._vector(self.layout.arm_a)

    @property
    def arm_b(self) -> Array:
        """(n_slots, dim) m, from the centroid of b to the contact point"""
        return self._vector(self.layout.arm_b)

    def _vector(self, first: int) -> Array:
        return self.value[:, first : first + self.layout.dim]


#: Columns of the table of packed contacts.  The first columns are parameters that change with the
#: state of joints that yield, see `law.limits` and `law.strengths`: k_n [N/m]; mu; a term added to
#: the trial normal reaction [N]; the tension from which normal reactions are counted [N]; the
#: cohesion intercept [N]; the crushing reaction, counted from the same tension, or zero if the
#: joint is not crushed [N].  The current parameters of contacts (n_slots, N_CURRENT) are the same
#: per area [Pa/m, -, Pa], but there CRUSH is infinite if the joint is not crushed.
STIFF_N, FRICTION, SHIFT, PULL, INTERCEPT, CRUSH = 0, 1, 2, 3, 4, 5
N_CURRENT = 6
#: k_s, k_n tan psi [N/m]; c A, f_t A [N]; the trial reactions [N]; what the slip that has ended
#: within the step adds to them [N]; and the length of this slip [m].
STIFF_T, LIFT, BOND, TENSILE = 6, 7, 8, 9
TRIAL_N, TRIAL_T, ADD_N, ADD_T, PLASTIC = 10, 11, 12, 13, 14
#: 1 if a bond is intact.
INTACT = 15
N_TABLE = 16


class Contacts(NamedTuple):
    """Contacts in use, packed: each row of the arrays is one contact; the first ``count`` of n rows
    are filled.

    Reactions act along the gradients of gap and slip.  Slip may be measured by other gradients.
    """

    which: IntArray  # (n, 4) slot, pair, bodies
    # (n, 2 dim - 1, 2 n_dof) gradients by the motions of both bodies: of the gap, of the slip, and
    # those by which slip is measured
    rows: Array
    table: Array  # (n, N_TABLE)

    @classmethod
    def empty(cls, n: int, dim: int, n_dof: int) -> Contacts:
        """Memory for ``n`` contacts."""
        return cls(
            which=np.zeros((n, 4), np.int64),
            rows=np.zeros((n, 2 * dim - 1, 2 * n_dof)),
            table=np.zeros((n, N_TABLE)),
        )

    def of(self, rows: IntArray | slice) -> Contacts:
        """Some of the contacts: views if ``rows`` is a slice, otherwise copies."""
        return Contacts(self.which[rows], self.rows[rows], self.table[rows])

    @property
    def slot(self) -> IntArray:
        """(n,) slot of each contact, a view."""
        return self.which[:, SLOT]
