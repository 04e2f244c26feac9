"""Contacts of one static step in the plane; see `statics.static_step` and
`statics.plane.contacts`."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.boxed import boxed
from drystone.common.tolerances import FOLD_KNOWN
from drystone.contact.contacts import EDGE_A, NONE, SIZE, SLOT, Pairs, Slots
from drystone.contact.histories import Histories, handed_on
from drystone.contact.plane import narrow
from drystone.contact.plane.detection import PlaneNarrowPhase
from drystone.law import plane as plane_law
from drystone.law.branches import OPEN
from drystone.linear.symbolic import Tangent
from drystone.statics.equations import Loaded
from drystone.statics.plane import contacts, path
from drystone.statics.static_step import StaticStep

#: Largest number of changes of contacts that are followed with one factorisation.
CHANGES_PER_MATRIX = 32

#: Largest number of changes of a step at which its multiplier is stored.
BENDS = 512

#: Times that the features of contacts are updated at the end of a step, and the step is solved
#: again; steps for which a pair keeps its features if two sets of features alternate.
ROUNDS, KEEP_STEPS = 3, 8


class PlaneStep(StaticStep):
    """A `StaticStep` in the plane.

    Slips are linear in the increments, by their gradients midway to the predicted end of the step.
    The error is of second order in the step.  Because of this, blocks that rotate together with
    several contacts between them do not strain their stiff shear springs.
    """

    def __init__(self, loaded: Loaded, pairs: Pairs) -> None:
        super().__init__(loaded, pairs)
        n, n_dof = self.loads.mass.shape
        self.lines = np.zeros((pairs.n_slots, 2, 2 * n_dof))
        #: Contacts that existed when the step began, and those that were closed then, (n_slots,).
        self.there, self.closed = np.zeros((2, pairs.n_slots), np.bool_)
        joined = self.joined or pairs
        self.pair_bodies = np.column_stack(
            (joined.a, joined.b)
        )  # bodies of all pairs of the matrix
        self.geometric = Tangent.zeros(n, len(self.pair_bodies), n_dof)
        #: Poses of the blocks; forces of ties; a motion of zero; forces that are not used.
        self.now, self.held, self.nowhere, self.unused = np.zeros((4, n, n_dof))
        self.pieces = path.Pieces(
            structure=self.structure,
            factors=self.factors,
            pair_bodies=self.pair_bodies,
            others=Tangent.zeros(n, len(self.pair_bodies), n_dof),
            geometric=self.geometric,
            tangent=self.tangent,
            damping=self.damping,
            away=np.zeros((n, n_dof)),
        )
        places = self.detector.narrow
        assert isinstance(places, PlaneNarrowPhase)
        self.begins = contacts.Beginning(
            bodies=places.bodies,
            world=places.world,
            pose=np.zeros((n, n_dof)),
            pairs=pairs,
            known=self.known,
            history=self.history_before,
            there=self.there,
            lines=self.lines,
        )
        self.answer = contacts.Answer(self.trial, self.branch, self.reaction, self.response)
        located = contacts.Located(
            begin=self.begins,
            x=self.x,
            now=self.now,
            slots=self.slots,
            contacts=self.contacts,
            answer=self.answer,
            held=self.held,
            forces=self.forces,
        )
        self.way = path.Way(
            changes=np.zeros((CHANGES_PER_MATRIX, n, n_dof)),
            change_of_multiplier=np.zeros(CHANGES_PER_MATRIX),
            row=np.zeros((CHANGES_PER_MATRIX, 1, 2 * n_dof)),
            bodies=np.zeros((CHANGES_PER_MATRIX, 2), np.int64),
            pivot=np.zeros(CHANGES_PER_MATRIX),
            rate=np.zeros((pairs.n_slots, 2)),
            fold=np.full(3, np.nan),
            sense=np.ones(1),
            bends=np.zeros((BENDS, 2)),
        )
        self.box = boxed((located, self.pieces, self.bordered, self.way))
        #: Number of further steps in which a pair keeps its features, (n_pairs,).
        self.kept = np.zeros(pairs.n_pairs, np.int64)

    def again(self) -> None:
        self.kept[:] = self.before
        super().again()

    def _take_up(self, slots: Slots, branch: IntArray, guess: Array) -> None:
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        self.begins.pose[:] = self.pose
        contacts.take_lines(self.box, guess)
        self.there[:] = slots.kind != NONE
        self.closed[:] = branch != OPEN
        self.before, self.rounds = self.kept.copy(), 0
        #: Times that the features of a pair have changed in the step, (n_pairs,).
        self.changes = np.where(self.kept > 0, 2, 0)
        self._pack(self.closed, branch)

    def _reset(self) -> None:
        self.x[:] = 0.0

    def _go(self, step: Array, length: float) -> None:
        self.x += length * step

    def _from_design(self) -> float:
        return self.detector.farthest(self.pose)

    def _locate_all(self) -> None:
        contacts.locate_all(self.box, self.n)

    def _respond(self, low: int, high: int) -> None:
        first, last = self.first[low], self.first[high]
        plane_law.choose(self.table, first, last, self.branch)
        plane_law.respond(self.table, first, last, self.branch, self.reaction, self.response)

    def _sum_forces(self, reaction: Array) -> None:
        contacts.sum_forces(self.contacts, self.n, reaction, self.contact_force)

    def _stiffen(self, reaction: Array) -> None:
        contacts.geometric_stiffness(self.slots, self.contacts, self.n, reaction, self.geometric)
        contacts.assemble(
            self.contacts, self.n, self.pair_bodies, reaction, self.response, self.geometric,
            self.nowhere, self.unused, self.tangent,
        )  # fmt: skip

    def rates(self, direction: Array) -> None:
        contacts.rates(self.contacts, self.n, direction, self.by_motion)

    def gaps(self) -> Array:
        return np.asarray(self.slots.gap[self.which[: self.n, SLOT]])

    def _age(self, history: Array) -> None:
        plane_law.age(self.which, self.table, self.branch, self.n, history)

    # Pieces of the step that are linear, see `statics.plane.piecewise`.

    def evaluate(self, x: Array, multiplier: float) -> None:
        """Evaluate reactions, unbalanced forces and `residual` [N] at increments ``x`` (n,
        n_dof)."""
        self.x[:], self.multiplier = x, multiplier
        self._act()
        if self.ties:
            self.held[:] = 0.0
            self.ties.add_to(self.held)
        self.residual = contacts.evaluate(self.box, self.n, self.multiplier, self.inertia_factor)

    def walk(
        self, x: Array, multiplier: float, *, whole: bool, patience: int, idle: int
    ) -> tuple[int, float, int]:
        """Follow the path of linear pieces, with the gradients where the step is, from increments
        ``x`` (n, n_dof), which are updated in place; see `statics.plane.path.walk`.

        Returns how the path has ended, the multiplier, and the number of changes.
        """
        ties, acting, others = self.ties, self.acting, self.pieces.others
        if acting or ties:
            for blocks in others:
                blocks[:] = 0.0
        if acting:
            others.diagonal[:, 2:, 2:] = acting.stiffness(self._pose_now(), self.multiplier)
        if ties and self.joined:
            self.joined.stiffen(others, ties.stiffness())
        rules = path.Rules(
            body=self._border(),
            lag=self.missing,
            inertia_factor=self.inertia_factor,
            patience=patience,
            idle=idle,
            waits=bool(self.lu.parts),
        )
        self.way.sense[0] = 1.0
        progress = np.full(path.N_PROGRESS, np.nan)
        progress[: path.SPRING] = multiplier, 1.0, 0.0, float(whole), 1.0, 0.0
        end = path.WAITS
        while end == path.WAITS:
            end = path.walk(self.box, self.n, x, progress, rules)
            if end == path.WAITS:
                progress[path.PIVOT] = self.lu.factorise(
                    self.tangent, self.loads.mass, self.damping, 0.0
                )
        if np.isfinite(progress[path.TURNED]):
            self.way.fold[:] = 1.0 - progress[path.TURNED], progress[path.TOP], np.nan
        elif end == path.EXHAUSTED and not whole and progress[path.SINCE] > idle:
            came = 1.0 - progress[path.LEFT]
            if came > FOLD_KNOWN:
                self.way.fold[:] = came, progress[path.MULTIPLIER], np.nan
        return end, float(progress[path.MULTIPLIER]), int(progress[path.CHANGES])

    def bends(self, changes: int) -> Array:
        """Share of the step and multiplier at the changes of the path followed last, (n, 2)."""
        bends: Array = self.way.bends[: min(changes, BENDS)]
        return bends

    def remember(self) -> None:
        """Add the slip that has ended on the path to the history at the start of the step."""
        plane_law.remember(self.which, self.table, self.n, self.history_before)

    # The features of contacts.

    def update_contacts(self) -> bool:
        """Update the features by which contacts press where the step is; whether any has changed.

        Two sets of features may alternate: with the first set the blocks come to where the second
        applies, and vice versa.  An example is two corners that hardly pass each other: they have
        one contact or two.  So the features of a pair may change once in a step, and change back
        once.  Then they stay for some steps.  Each further change would cost a solution, and blocks
        that would otherwise come to rest would move to and fro.
        """
        self._find()
        if not narrow.changed_contacts(self.slots, self.found, self.accuracy.depth):
            self.kept[:] = 0
            return False
        of_slot, was, now = self.pairs.of_slot, self.slots, self.found
        others = (was.which[:, :EDGE_A] != now.which[:, :EDGE_A]).any(axis=1)
        others &= np.minimum(was.gap, now.gap) <= -self.accuracy.depth
        change = np.zeros(len(self.kept), np.bool_)
        change[of_slot[others]] = True
        keep = change & (self.changes >= 2)
        steps = np.where(self.before > 0, self.before - 1, KEEP_STEPS)
        self.kept[:] = np.where(keep, steps, 0)
        slots = keep[of_slot]
        for mine, theirs in zip(now, was, strict=True):
            mine[slots] = theirs[slots]
        change &= ~keep
        self.changes[change] += 1
        self.rounds += 1
        if not change.any() or self.rounds > ROUNDS:
            return False
        self._follow(now)
        return True

    def _follow(self, slots: Slots) -> None:
        """Continue the step with the features of ``slots``; each contact inherits the history of
        its predecessor."""
        branch = self.by_slot(self.branch)
        past = Histories.own(
            self.known, self.history_before, self.by_slot(self.reaction)[:, :2], branch
        )
        heirs = handed_on(self.detector.narrow, past, self.pairs, slots)
        self.history_before[:] = heirs.history
        size = np.where(self.there, self.known.size, 0.0)
        self.lines[:], self.closed[:] = heirs.of(self.lines), heirs.of(self.closed)
        self.there[:] = heirs.of(self.there)
        self.origin[:] = heirs.of(self.origin, -1)
        if len(self.current):
            self.current[:] = heirs.of(self.current, self.fresh)
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        self.known.value[:, SIZE] = np.where(self.there, heirs.of(size), slots.size)
        self.found_at = None
        self._pack(self.closed, heirs.branch)
