"""Contacts of one static step in space; see `statics.static_step` and `statics.space.contacts`."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.contact.contacts import (
    EDGE_A,
    EDGE_B,
    INTACT,
    KIND,
    NONE,
    PAIR,
    SLOT,
    Pairs,
    Slots,
)
from drystone.contact.histories import Histories, handed_on
from drystone.geometry.rotation import all_axes, difference
from drystone.law import space as space_law
from drystone.law.branches import OPEN
from drystone.law.columns import DILATION, KN
from drystone.statics.equations import Loaded
from drystone.statics.space import contacts
from drystone.statics.static_step import StaticStep


class SpaceStep(StaticStep):
    """A `StaticStep` in space."""

    def __init__(self, loaded: Loaded, pairs: Pairs) -> None:
        super().__init__(loaded, pairs)
        n, n_pairs, n_slots = len(self.loads.mass), pairs.n_pairs, pairs.n_slots
        self.start, self.shear = np.zeros((n_slots, contacts.N_PLACE)), np.zeros((n_slots, 2))
        self.now = np.zeros((n_slots, contacts.N_NOW))
        assembly = self.detector.assembly
        self.motion, self.none = assembly.design_pose(), assembly.design_pose()
        self.rotation, self.axes_0, self.axes = (np.zeros((n, 3, 3)) for _ in range(3))
        self.twist = np.zeros((n, 6))
        self.wrench = np.zeros((n_pairs, 2, 6))
        self.of_pairs = np.zeros((n_pairs, 2, 6, 6))
        self.begin_of, self.of_body = _pairs_of_bodies(pairs, n)

    def _take_up(self, slots: Slots, branch: IntArray, guess: Array) -> None:
        all_axes(self.pose, self.detector.assembly.axes, self.rotation, self.axes_0)
        self._begin_again(slots, branch)

    def _begin_again(self, slots: Slots, branch: IntArray) -> None:
        """Take over the contacts ``slots`` where the step starts."""
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        self.found_at = None
        self._pack(branch != OPEN, branch)
        contacts.pack_places(
            self.known, self.history_before, self.n, self.which, self.start, self.shear
        )

    def update_contacts(self) -> bool:
        """Update the contacts of pairs that press each other at features that were not followed.

        Blocks that come together within a step may touch with other features than those followed
        from afar, and overlap there without a force.  Also, a point where two edges cross may have
        moved along the edges.  The step then begins again with the contacts that such pairs have
        where the blocks are now.  These contacts inherit the history of those followed.

        Returns whether there are such pairs.  Their overlap must be worth a force of more than
        `Accuracy.pressed`, and pairs with an intact bond do not count.
        """
        pairs, n = self.pairs, self.n
        self._find()
        stiffness = self.loaded.prepared.laws[pairs.law_of_slot, KN] * self.found.size
        closed = -self.found.gap
        if len(self.current):
            closed = closed - self._crushed()[pairs.of_slot]
        overlap = np.where(self.found.kind == NONE, 0.0, np.maximum(closed, 0.0))
        # Faces that lie on each other open and close by rounding.
        pressed = np.bincount(pairs.of_slot, stiffness * overlap, pairs.n_pairs)
        pushes = np.maximum(self.reaction[:n, 0], 0.0)
        carried = np.bincount(self.which[:n, PAIR], pushes, minlength=pairs.n_pairs)
        # A pair with intact bonds was in contact before.
        intact = np.bincount(self.which[:n, PAIR], self.table[:n, INTACT], pairs.n_pairs)
        anew = pressed > self.accuracy.pressed + 2.0 * carried
        anew |= (carried > self.accuracy.pressed) & self._held_falsely()
        anew = (anew & (intact == 0.0))[pairs.of_slot]
        if not anew.any():
            return False
        branch = self.by_slot(self.branch)
        past = Histories.own(
            self.known.copied(), self.history_before, self.by_slot(self.reaction), branch
        )
        self.known.which[anew], self.known.value[anew] = (
            self.found.which[anew],
            self.found.value[anew],
        )
        self.detector.follow(pairs, self.pose, self.known, self.slots)
        heirs = handed_on(self.detector.narrow, past, pairs, self.slots)
        source = heirs.source[anew]
        self.origin[anew] = np.where(source >= 0, self.origin[source], -1)
        if len(self.current):
            taken = np.where(source[:, None] >= 0, self.current[source], self.fresh[anew])
            self.current[anew] = taken
        self.history_before[anew], branch[anew] = heirs.history[anew], heirs.branch[anew]
        self._begin_again(self.slots, branch)
        return True

    def _held_falsely(self) -> BoolArray:
        """Pairs (n_pairs,) whose followed contacts press deeper than the blocks overlap.

        Such contacts lie on faces that are no longer those in contact.  For example, two blocks may
        stand side by side, edge on edge, where the step begins, and on each other where it ends.
        """
        pairs, n, faces = self.pairs, self.n, slice(EDGE_A, EDGE_B + 1)
        known, found = self.known.which, self.found.which
        others = (known[:, faces] != found[:, faces]).any(axis=1) & (found[:, KIND] != NONE)
        of_slot = pairs.of_slot
        turned = np.bincount(of_slot, others, pairs.n_pairs) > 0.0
        depth, overlap = np.zeros((2, pairs.n_pairs))
        pushes = self.reaction[:n, 0] > 0.0
        np.maximum.at(depth, self.which[:n, PAIR][pushes], -self.gaps()[pushes])
        np.maximum.at(overlap, of_slot, np.where(found[:, KIND] != NONE, -self.found.gap, 0.0))
        return turned & (depth > overlap + self.accuracy.depth)

    def _crushed(self) -> Array:
        """Largest closure by crushing of the contacts of each pair, (n_pairs,) [m]."""
        crushed = np.zeros(self.pairs.n_pairs)
        closure = -self._aged()[:, DILATION]
        np.maximum.at(crushed, self.pairs.of_slot, closure)
        return crushed

    def _reset(self) -> None:
        self.motion[:] = self.none
        self.axes[:] = self.axes_0

    def _go(self, step: Array, length: float) -> None:
        contacts.rotate_on(step, length, self.axes_0, self.motion, self.rotation, self.axes)
        difference(self.motion, self.none, self.axes_0, self.x)

    def _locate_all(self) -> None:
        self._by_pairs(
            lambda low, high: contacts.locate(
                self.which, self.start, self.table, self.shear, self.first, low, high,
                self.motion, self.rotation, self.now, self.trial,
            )
        )  # fmt: skip

    def _sum_forces(self, reaction: Array) -> None:
        at = self.start, self.now, self.first
        self._by_pairs(lambda low, high: contacts.wrenches(*at, low, high, reaction, self.wrench))
        contacts.sum_wrenches(
            self.begin_of, self.of_body, self.wrench, self.axes, self.contact_force
        )

    def _stiffen(self, reaction: Array) -> None:
        self._by_pairs(
            lambda low, high: contacts.stiffness(
                self.which, self.start, self.now, self.table, self.first, low, high, reaction,
                self.response, self.axes, self.of_pairs, self.tangent.upper, self.tangent.lower,
            ),
            self.cuts,
        )  # fmt: skip
        contacts.sum_diagonals(
            self.begin_of, self.of_body, self.of_pairs, self.axes, self.tangent.diagonal
        )

    def rates(self, direction: Array) -> None:
        contacts.twists(direction, self.axes, self.twist)
        at = self.which, self.start, self.now, self.first
        self._by_pairs(
            lambda low, high: contacts.relative(*at, low, high, self.twist, self.by_motion)
        )

    def finish(self) -> Array:
        history = super().finish()
        self.detector.follow(self.pairs, self._pose_now(), self.known, self.slots)
        return history

    def gaps(self) -> Array:
        n = self.n
        gap: Array = self.start[:n, contacts.GAP_0] + self.now[:n, contacts.Y]
        dilation: Array = self.history_before[self.which[:n, SLOT], DILATION]
        return gap + dilation

    def _age(self, history: Array) -> None:
        space_law.age(
            self.which, self.table, self.trial, self.reaction, self.branch, self.n, history
        )

    def _respond(self, low: int, high: int) -> None:
        first, last = self.first[low], self.first[high]
        space_law.respond(
            self.table, self.trial, first, last, self.branch, self.reaction, self.response
        )


def _pairs_of_bodies(pairs: Pairs, n: int) -> tuple[IntArray, IntArray]:
    """A list (2 n_pairs,) of the pairs of each of ``n`` bodies: twice the pair, plus one if the
    body is b; and where each body begins in this list, (n + 1,).  The latter is returned first."""
    body = np.column_stack((pairs.a, pairs.b)).ravel()
    order = np.argsort(body, kind="stable")
    begin = np.searchsorted(body[order], np.arange(n + 1))
    return begin.astype(np.int64), order.astype(np.int64)
