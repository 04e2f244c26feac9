"""The equations of one step of static equilibrium, on arrays that are made once per pair list.

Those of `statics.linear_step`, with gaps and gradients in the places at the end of the step; see
`law.return_map` for the reactions, `statics.plane.path` for how the linear equations are solved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.contact.contacts import (
    N_HELD,
    NONE,
    STIFF_N,
    TRIAL_T,
    Pairs,
    Slots,
)
from drystone.contact.detection import Detector
from drystone.contact.histories import Histories, handed_on
from drystone.contact.plane import rows
from drystone.geometry import motion
from drystone.law import plane as plane_law
from drystone.law import softening
from drystone.law.branches import OPEN
from drystone.law.certificate import JudgedContacts
from drystone.law.columns import (
    N_HISTORY,
    NN,
    NT,
    RN,
    RT,
    TN,
    TT,
)
from drystone.law.strengths import Strengths
from drystone.statics.linear_step import BENDS, LinearStep, Loads
from drystone.statics.plane import forces, path
from drystone.statics.plane.forces import Start

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: What joints hold where all of them are dry.
DRY = np.zeros((0, N_HELD))


@dataclass(frozen=True, kw_only=True)
class Constants:
    """What stays the same over an analysis."""

    detector: Detector
    laws: Array  # (n_laws, N_LAW)
    thickness: float  # m
    loads: Loads


class Ended(NamedTuple):
    """What a solution of a step has led to, of all slots; see `statics.yielding`."""

    origin: IntArray  # (n_slots,) slots where the step started; -1 has none
    before: Array  # (n_slots, N_HISTORY + dim - 2), of slots without one
    after: Array  # likewise, at the end
    gap: Array  # (n_slots,) m
    held: Array  # (n_slots, N_HELD) what they were solved with
    normal: Array  # (n_slots,) N
    area: Array  # (n_slots,) m2


class StaticStep(LinearStep):
    """Evaluates and linearises the equations of steps over one list of pairs."""

    def __init__(self, constants: Constants, pairs: Pairs) -> None:
        n_dof = constants.loads.mass.shape[1]
        n_slots = pairs.n_slots
        place = motion.places(constants.detector.assembly.centroid, pairs.pose)
        dim = place.shape[1]
        super().__init__(constants.loads, pairs, place, Slots.empty(n_slots, dim))
        self.constants = constants
        self.known = Slots.empty(n_slots, dim)  # contacts by the features that the step follows
        self.found = Slots.empty(n_slots, dim)  # contacts as they are found where the step ends
        self.history_before = np.zeros((n_slots, N_HISTORY))
        self.history = np.zeros((n_slots, N_HISTORY))
        self.start = Start(
            size=np.zeros(n_slots),
            rows=np.zeros((n_slots, dim, 2 * n_dof)),
            closed=np.zeros(n_slots, np.bool_),
            held=DRY,
        )
        self.fresh = DRY
        self.all_slots = np.arange(n_slots)
        self.origin = self.all_slots.copy()  # slots where the step started; -1 has none
        #: Steps in which a pair yet keeps the features that it has, (n_pairs,).
        self.kept = np.zeros(pairs.n_pairs, np.int64)

    def begin(
        self,
        pose: Array,
        slots: Slots,
        history: Array,
        branch: IntArray,
        h: float,
        guess: Array,
        held: Array | None = None,
        fresh: Array | None = None,
    ) -> None:
        """Start a step of size ``h`` [s] from rest in ``pose``, with its contacts and their past.

        Slips are linear in the increments, by their gradients half way to the ``guess`` of these:
        of second order in the step, without straining the stiff shear springs of blocks that
        are held at several points and turn together.  ``held`` (n_slots, N_HELD) is what joints
        hold in it that are not dry, see `contacts`; ``fresh`` (n_slots, N_HELD) what contacts
        do that are made in it.
        """
        self.pose = pose
        self.fresh = DRY if fresh is None else fresh
        self.origin[:] = self.all_slots
        self.start = Start(*self.start[:3], held=DRY if held is None else held)
        self.inertia_factor = 1.0 / h**2
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        self.history_before[:] = history
        self.start.closed[:] = branch != OPEN
        self.start.size[:] = np.where(slots.kind != NONE, slots.size, 0.0)
        half = self.slots
        detector = self.constants.detector
        detector.follow(self.pairs, detector.assembly.moved(pose, 0.5 * guess), self.known, half)
        rows.slot_rows(half, self.start.rows)

    def follow(self, slots: Slots) -> None:
        """Go on with the features of these contacts; each brings along what its forerunner had."""
        past = Histories.own(self.known, self.history_before, self.reaction, self.branch)
        heirs = handed_on(self.constants.detector.narrow, past, self.pairs, slots)
        self.history_before[:], self.branch[:] = heirs.history, heirs.branch
        size, lines, closed, _ = self.start
        size[:], lines[:], closed[:] = heirs.of(size), heirs.of(lines), heirs.of(closed)
        self.origin[:] = heirs.of(self.origin, -1)
        if len(self.start.held):
            self.start.held[:] = heirs.of(self.start.held, self.fresh)
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs

    def evaluate(self, x: Array, multiplier: float) -> None:
        """Reactions, unbalanced forces and ``residual`` [N] at the increments ``x`` (n, n_dof)."""
        c = self.constants
        pose = c.detector.assembly.moved(self.pose, x)
        c.detector.follow(self.pairs, pose, self.known, self.slots)
        self.bent = False
        self.count = forces.joint_forces(
            self.slots, self.pairs, c.laws, c.thickness, self.start, self.history_before, x,
            self.contacts, self.contact_force, self.branch, self.reaction, self.history,
        )  # fmt: skip
        self.load_near(pose, multiplier)
        self.pull(pose)
        self.residual = self._unbalance(x, multiplier, self.dead)

    def advance(
        self, x: Array, lag: float, way: path.Way, rules: path.Rules
    ) -> tuple[int, path.Way]:
        """Follow the path from ``x``, which moves on in place; see
        `statics.plane.path.follow_path`."""
        end, multiplier, left, changes = path.follow_path(
            self.structure, self.factors, self.frame, self.contacts, self.count, self.branch,
            self.force, lag, self.spring, x, way, rules,
        )  # fmt: skip
        return end, path.Way(multiplier, left, changes)

    def bends(self, changes: int) -> Array:
        """Share of the step and multiplier at the changes of the path followed last, (n, 2)."""
        return self.frame.bends[: min(changes, BENDS)]

    def ended(self) -> Ended:
        """What the strengths of joints are to follow from; its `after` is the step's history."""
        return Ended(
            origin=self.origin,
            before=self.history_before,
            after=self.history,
            gap=self.slots.gap,
            held=self.start.held,
            normal=self.reaction[:, 0],
            area=self.start.size * self.constants.thickness,
        )

    def soften(
        self, strengths: Strengths, start: Array, x: Array, multiplier: float
    ) -> tuple[IntArray, Array]:
        """Unbalanced forces and tangent at ``x`` with the strengths that joints have there.

        ``start`` (n_slots, N_HISTORY) is the history where the step begins, of the present slots.
        Returns slots (n,) of joints that yield, and what they come to (n, N_POINT).
        """
        self.evaluate(x, multiplier)
        self.respond()
        used, table = self.contacts.slot[: self.count], self.contacts.table
        law = self.pairs.law_of_slot[used]
        rows = np.flatnonzero(strengths.yields[law])
        slot, law = used[rows], law[rows]
        size = np.where(self.start.size[slot] > 0.0, self.start.size[slot], self.slots.size[slot])
        area, shear = size * self.constants.thickness, table[rows, TRIAL_T]
        point = strengths.points(
            law, start[slot], self.history_before[slot], self.slots.gap[slot], abs(shear) / area
        )
        sign, kn = np.sign(shear), table[rows, STIFF_N] / area
        response, p = self.response, point.T
        response[rows, RN] = area * p[softening.P_NORMAL]
        response[rows, RT] = area * sign * p[softening.P_SHEAR]
        response[rows, NN] = -p[softening.P_NY] / kn
        response[rows, NT] = sign * p[softening.P_NT]
        response[rows, TN] = -sign * p[softening.P_TY] / kn
        response[rows, TT] = p[softening.P_TT]
        self.reaction[slot] = response[rows, : RT + 1]
        self.assemble(x, multiplier, np.zeros_like(x))
        return slot, point

    def remember(self) -> None:
        """Make sliding that has ended on the path part of the step's history."""
        which, _, table = self.contacts
        plane_law.remember(which, table, self.count, self.history_before)

    def judged(self) -> JudgedContacts:
        """The contacts last evaluated: views, until something is evaluated again."""
        contacts = self.contacts.of(slice(self.count))
        used = contacts.slot
        return JudgedContacts.with_history(
            contacts,
            self.slots.gap[used],
            self.history[used],
            self.reaction[used],
            contacts.table[:, TRIAL_T : TRIAL_T + 1],
        )

    def find(self, x: Array) -> None:
        """Find the contacts anew where the blocks are now, into ``found``."""
        detector = self.constants.detector
        detector.fill(self.pairs, detector.assembly.moved(self.pose, x), self.found)
