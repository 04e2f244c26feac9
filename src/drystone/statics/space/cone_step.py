"""The equations of one step of static equilibrium in space, and their factors.

    R(x, l) = G + l F + sum over contacts E r - M x / h^2 = 0,    c(x) = Delta

with reactions, gaps and gradients where the step ends; see `statics.space.spatial_step` for
contacts, `statics.space.cones` for the joint law from its interior, and
`statics.space.cone_search` for the way there.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drystone.common.threads import team
from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    HELD,
    N_HELD,
    N_TABLE,
    NONE,
    PAIR,
    PULL,
    SHIFT,
    STIFF_N,
    TRIAL_N,
    TRIAL_T,
    Contacts,
    Pairs,
    Slots,
)
from drystone.geometry import motion
from drystone.geometry.rotation import all_axes, difference
from drystone.law import softening
from drystone.law import space as space_law
from drystone.law.branches import OPEN
from drystone.law.certificate import JudgedContacts
from drystone.law.columns import (
    BROKEN,
    DILATION,
    KN,
    N_HISTORY,
    YIELDS,
)
from drystone.law.strengths import Strengths
from drystone.statics import step
from drystone.statics.linear import numeric as lu_numeric
from drystone.statics.linear import symbolic as lu_symbolic
from drystone.statics.linear.shared_lu import SharedLU
from drystone.statics.linear_step import Pace
from drystone.statics.plane import path
from drystone.statics.plane.forces import Tangent
from drystone.statics.plane.static_step import Constants, Ended
from drystone.statics.space import cones, spatial_step
from drystone.statics.space.spatial_step import Places, Y
from drystone.statics.tie_forces import JoinedTies

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Number = TypeVar("Number", np.float64, np.int64)


#: Contacts from which on threads gain, whose waking takes some 0.1 ms, when they share the
#: stiffness; and what takes a few times ten nanoseconds each.
MANY, MANY_OF_LITTLE = 4000, 20000


class Border(NamedTuple):
    """What borders the matrix, (n, n_dof) each; see `statics.plane.path.border`."""

    load: Array  # F
    pace: Array  # g, gradient of the pacing displacement
    axis: Array  # direction of the spring e over all bodies
    columns: Array  # (3, n, n_dof) direction, K'^-1 F, k K'^-1 e
    border: Array  # (1,) by which the determinant of the bordered matrix exceeds that of K'
    sign: Array  # (1,) of the latter; where the product is positive, a motion is unstable


class Place(NamedTuple):
    """Where a step has come to."""

    motion: Array  # (n, 7) poses as seen from its start
    multiplier: float


class ConeStep:
    """Evaluates and linearises the equations of steps over one list of pairs; holds their arrays.

    `trial` (n_slots, 3) [N] are the reactions of contacts without friction and separation,
    `reaction` and `branch` those of the joint law, by contacts in use; `n` of them.
    """

    def __init__(self, constants: Constants, pairs: Pairs) -> None:
        loads = constants.loads
        n, n_dof = loads.mass.shape
        n_pairs, n_slots = pairs.n_pairs, pairs.n_slots
        assembly = constants.detector.assembly
        place = motion.places(assembly.centroid, pairs.pose)
        self.constants, self.loads, self.pairs = constants, loads, pairs
        self.known, self.slots, self.found = (Slots.empty(n_slots, 3) for _ in range(3))
        self.history_before = np.zeros((n_slots, N_HISTORY + 1))
        self.places = Places(
            which=np.zeros((n_slots, 4), np.int64),
            start=np.zeros((n_slots, spatial_step.N_PLACE)),
            table=np.zeros((n_slots, N_TABLE)),
            shear=np.zeros((n_slots, 2)),
            first=np.zeros(n_pairs + 1, np.int64),
        )
        self.n = 0
        self.now = np.zeros((n_slots, spatial_step.N_NOW))
        self.trial, self.reaction, self.by_motion = (np.zeros((n_slots, 3)) for _ in range(3))
        self.response = np.zeros((n_slots, 3, 3))
        self.branch = np.zeros(n_slots, np.int64)
        self.inner, self.change = (np.zeros((n_slots, cones.N_INNER)) for _ in range(2))
        self.scaling = np.zeros((n_slots, cones.N_SCALING))
        self.given = np.zeros((n, n_dof))  # increments of supports that move
        self.motion, self.none = assembly.rest_pose(), assembly.rest_pose()
        self.turn, self.axes_0, self.axes = (np.zeros((n, 3, 3)) for _ in range(3))
        self.x, self.twist, self.force = (np.zeros((n, n_dof)) for _ in range(3))
        self.contact_force = np.zeros((n, n_dof))
        self.damping = np.zeros(n)
        self.wrench = np.zeros((n_pairs, 2, 6))
        self.of_pairs = np.zeros((n_pairs, 2, 6, 6))
        self.joined = loads.ties.joined(pairs.a, pairs.b) if loads.ties else None
        joined: JoinedTies | Pairs = self.joined or pairs
        self.tangent = Tangent.zeros(n, len(joined.a), n_dof)
        self.begin_of, self.of_body = _pairs_of_bodies(pairs, n)
        self.team = team()
        self.cuts = self.little_cuts = [(0, n_pairs)]
        structure = lu_symbolic.analyse(joined.a, joined.b, loads.fixed, place, n_dof)
        self.lu = SharedLU(structure, self.team)
        self.structure, self.factors = self.lu.structure, self.lu.factors
        self.frame = Border(
            load=loads.pattern.copy() if loads.acting else loads.pattern,
            pace=np.zeros((n, n_dof)),
            axis=np.zeros((n, n_dof)),
            columns=np.zeros((3, n, n_dof)),
            border=np.ones(1),
            sign=np.ones(1),
        )
        self.spring = 0.0
        self.n_due = 1  # columns of the frame that the next solution is to fill
        self.pace: Pace | None = None
        self.holding, self.origin = np.zeros((0, N_HELD)), np.arange(n_slots)
        self.fresh = self.holding
        self.history: Array | None = None
        self.drawn = np.zeros((n_slots, 3))
        self.multiplier, self.residual = 0.0, np.inf

    # The step.

    def begin(
        self,
        pose: Array,
        slots: Slots,
        history: Array,
        branch: IntArray,
        h: float,
        pace: Pace | None,
        held: Array | None = None,
        fresh: Array | None = None,
    ) -> None:
        """Start a step of size ``h`` [s] from rest in ``pose``, with contacts and their past.

        ``held`` (n_slots, N_HELD) is what joints hold in it that are not dry, see `contacts`;
        ``fresh`` (n_slots, N_HELD) what contacts do that are made in it.
        """
        constants = self.constants
        assembly = constants.detector.assembly
        self.pose, self.inertia_factor, self.pace = pose, 1.0 / h**2, pace
        self.found_at: Array | None = None  # poses that `found` is of, for the known contacts
        self.frame.axis[:] = 0.0
        for mine, theirs in zip(self.known, slots, strict=True):
            mine[:] = theirs
        self.history_before[:] = history
        closed = branch != OPEN
        self.n = n = spatial_step.pack(
            self.known, self.pairs, constants.laws, history, closed, self.places
        )
        self.cuts, self.little_cuts = self._cut(MANY), self._cut(MANY_OF_LITTLE)
        self.branch[:n] = branch[self.places.which[:n, 0]]
        self.origin[:], self.history = np.arange(len(self.origin)), None
        self.holding = self.holding[:0] if held is None else held
        self.fresh = self.holding if fresh is None else fresh
        if held is not None:
            self._hold(held)
        all_axes(pose, assembly.axes, self.turn, self.axes_0)

    def _hold(self, held: Array) -> None:
        """Take on what joints hold that are not dry, (n_slots, N_HELD)."""
        used = self.places.which[: self.n, 0]
        yields = self.constants.laws[self.pairs.law_of_slot[used], YIELDS] != 0.0
        rows = np.flatnonzero(yields)
        slot = used[rows]
        now, area = held[slot], self.known.size[slot]
        table, crush = self.places.table, now[:, CRUSH] * area
        table[rows, STIFF_N] = now[:, STIFF_N] * area
        table[rows, FRICTION] = now[:, FRICTION]
        table[rows, SHIFT:CRUSH] = now[:, SHIFT:CRUSH] * area[:, None]
        table[rows, CRUSH] = np.where(np.isfinite(crush), crush, 0.0)

    def meet(self, slight: float) -> bool:
        """Take on the contacts of pairs that have come to press each other elsewhere than followed.

        Blocks that meet within a step do so with other features than those watched from afar: what
        they would be pressed into each other there is no part of the balance.  The step begins
        again, with the contacts that such pairs have where the blocks are now; whether there are
        any by more than a force ``slight`` [N].
        """
        detector, pairs, n = self.constants.detector, self.pairs, self.n
        self._find()
        stiffness = self.constants.laws[pairs.law_of_slot, KN] * self.found.size
        closed = -self.found.gap
        if len(self.holding):
            closed = closed - self._crushed()[pairs.of_slot]
        overlap = np.where(self.found.kind == NONE, 0.0, np.maximum(closed, 0.0))
        # Faces that lie on each other part and meet by rounding.
        pressed = np.bincount(pairs.of_slot, stiffness * overlap, pairs.n_pairs)
        pushes = np.maximum(self.reaction[:n, 0], 0.0)
        carried = np.bincount(self.places.which[:n, PAIR], pushes, minlength=pairs.n_pairs)
        # What bonds hold together has not come to meet.
        held = np.bincount(self.places.which[:n, PAIR], self.places.table[:n, HELD], pairs.n_pairs)
        anew = ((pressed > slight + 2.0 * carried) & (held == 0.0))[pairs.of_slot]
        if not anew.any():
            return False
        history, branch = self.history_before.copy(), self.by_slot(self.branch)
        self.known.which[anew], self.known.value[anew] = (
            self.found.which[anew],
            self.found.value[anew],
        )
        history[anew], branch[anew] = 0.0, OPEN
        history[anew, BROKEN] = 1.0
        detector.follow(pairs, self.pose, self.known, self.slots)
        inertia, origin = self.inertia_factor, np.where(anew, -1, self.origin)
        holding, fresh = (None, None) if not len(self.holding) else (self.holding, self.fresh)
        if holding is not None:
            holding = np.where(anew[:, None], self.fresh, holding)
        self.begin(self.pose, self.slots, history, branch, 1.0, self.pace, holding, fresh)
        self.inertia_factor = inertia
        self.origin[:] = origin
        return True

    def _crushed(self) -> Array:
        """Closure [m] that the contacts of each pair, (n_pairs,), have been crushed by at most."""
        crushed = np.zeros(self.pairs.n_pairs)
        closure = -self._aged()[:, DILATION]
        np.maximum.at(crushed, self.pairs.of_slot, closure)
        return crushed

    def set_out(self, x: Array, multiplier: float) -> None:
        """Go to increments (n, 6) from where the step starts."""
        self.motion[:] = self.none
        self.axes[:] = self.axes_0
        self.multiplier = multiplier
        self.move(x, 1.0)

    @property
    def place(self) -> Place:
        """Where the step is, to come back to."""
        return Place(self.motion.copy(), self.multiplier)

    def come_back(self, place: Place) -> None:
        """Go to a place where the step has been."""
        self.motion[:], self.multiplier = place
        self.move(np.zeros_like(self.x), 0.0)

    def move(self, step: Array, length: float) -> None:
        """Move on by ``length`` times increments (n, 6) from here; contacts are located anew."""
        spatial_step.turn_on(step, length, self.axes_0, self.motion, self.turn, self.axes)
        difference(self.motion, self.none, self.axes_0, self.x)
        self._by_pairs(self._locate)

    @property
    def missing(self) -> float:
        """What is missing of the pacing displacement [m]."""
        return self.pace.missing(self.x) if self.pace else 0.0

    # Equations.

    @property
    def table(self) -> Array:
        """What the contacts in use have of their joints, (n_slots, N_TABLE)."""
        return self.places.table

    @property
    def inside(self) -> Array:
        """Reactions (n_slots, 3 or more) of the variables of the interior [N]."""
        if not len(self.holding):
            return self.inner
        n = self.n
        self.drawn[:n] = self.inner[:n, :3]
        self.drawn[:n, 0] -= self.table[:n, PULL]
        return self.drawn

    def respond(self) -> None:
        """Reactions of the joint law, and their derivatives."""
        self._by_pairs(self._respond)

    def balance(self, reaction: Array) -> float:
        """Make the unbalanced forces those of reactions (n_slots, 3 or more); the largest [N]."""
        self._by_pairs(partial(self._wrenches, reaction))
        spatial_step.sum_wrenches(
            self.begin_of, self.of_body, self.wrench, self.axes, self.contact_force
        )
        c = self.loads
        dead = c.dead
        if c.ties:
            c.ties.act(self._pose_now())
            c.ties.add_to(self.contact_force)
        if c.acting:
            near, self.frame.load[:] = c.acting.near(self._pose_now(), self.multiplier)
            dead = dead - c.dead + near
        self.residual = step.unbalance(
            self.contact_force, dead, self.frame.load, self.multiplier, c.mass, self.x,
            self.inertia_factor, c.extent, c.fixed, self.force,
        )  # fmt: skip
        return self.residual

    def _pose_now(self) -> Array:
        return self.constants.detector.assembly.moved(self.pose, self.x)

    def factorise(self, reaction: Array, least_damping: float) -> bool:
        """Factorise the stiffness for the present `response` and reactions; False if singular."""
        self._by_pairs(partial(self._stiffness, reaction), self.cuts)
        spatial_step.sum_diagonals(
            self.begin_of, self.of_body, self.of_pairs, self.axes, self.tangent.diagonal
        )
        c, frame = self.loads, self.frame
        if c.ties and self.joined:
            c.ties.act(self._pose_now())
            self.joined.clear(self.tangent, self.pairs.n_pairs)
            self.joined.stiffen(self.tangent, c.ties.stiffness())
        if c.acting:
            turning = c.acting.stiffness(self._pose_now(), self.multiplier)
            self.tangent.diagonal[:, 3:, 3:] += turning
        body, frame.border[0] = -1, -1.0
        if self.pace is not None:
            body = self.pace.body
            frame.pace[:] = self.pace.gradient(self.x)
            frame.axis[body] = frame.pace[body]
        self.spring = step.stiffen(
            self.tangent.diagonal, c.mass, self.inertia_factor, self.damping, body, frame.axis
        )
        self.n_due = 1
        pivot = self.lu.factorise(self.tangent, c.mass, self.damping, least_damping)
        frame.sign[0] = np.sign(pivot)
        if pivot == 0.0 or self.pace is None:
            return bool(pivot != 0.0)
        frame.columns[1] = frame.load
        np.multiply(self.spring, frame.axis, out=frame.columns[2])
        self.n_due = 3
        return True

    def solve(self, missing: float) -> float:
        """Direction in the first column, from the forces there, and of the multiplier."""
        columns = self.frame.columns
        # What borders the matrix is solved for beside the first direction: factors are read once.
        lu_numeric.solve(self.structure, self.factors, columns[: self.n_due])
        self.n_due = 1
        return path.border(self.frame, columns[0], missing) if self.pace else 0.0

    @property
    def stable(self) -> bool:
        """Whether the number of unstable modes is even, once a direction has been solved for."""
        return bool(self.frame.sign[0] * self.frame.border[0] < 0.0)

    def contact_rates(self) -> Array:
        """How gaps and slips go along the direction, (n_slots, 3)."""
        spatial_step.twists(self.frame.columns[0], self.axes, self.twist)
        self._by_pairs(self._relative)
        return self.by_motion

    # What is done with each contact: of pairs from ``low`` to ``high``.

    def _cut(self, least: int) -> list[tuple[int, int]]:
        """Ranges of pairs with about as many contacts, one for each thread from ``least`` on."""
        first, parts = self.places.first, self.team.number if self.n >= least else 1
        wanted = np.linspace(0, self.n, parts + 1)
        at = [0, *np.searchsorted(first, wanted[1:-1]).tolist(), len(first) - 1]
        return list(pairwise(at))

    def _by_pairs(
        self, work: Callable[[int, int], None], cuts: list[tuple[int, int]] | None = None
    ) -> None:
        cuts = cuts or self.little_cuts
        if len(cuts) == 1:
            work(*cuts[0])
        else:
            self.team.run([partial(work, low, high) for low, high in cuts])

    def by_contacts(self, work: Callable[[slice], None]) -> None:
        """Do something with the contacts in use, by ranges of them; these may go side by side."""
        first = self.places.first
        self._by_pairs(lambda low, high: work(slice(first[low], first[high])))

    def _locate(self, low: int, high: int) -> None:
        which, start, table, shear, first = self.places
        spatial_step.locate(
            which, start, table, shear, first, low, high, self.motion, self.turn, self.now,
            self.trial,
        )  # fmt: skip

    def _respond(self, low: int, high: int) -> None:
        table, first = self.places.table, self.places.first
        space_law.respond(
            table, self.trial, first[low], first[high], self.branch, self.reaction,
            self.response,
        )  # fmt: skip

    def _wrenches(self, reaction: Array, low: int, high: int) -> None:
        which, start, _, _, first = self.places
        spatial_step.wrenches(which, start, self.now, first, low, high, reaction, self.wrench)

    def _relative(self, low: int, high: int) -> None:
        which, start, _, _, first = self.places
        spatial_step.relative(which, start, self.now, first, low, high, self.twist, self.by_motion)

    def _stiffness(self, reaction: Array, low: int, high: int) -> None:
        which, start, table, _, first = self.places
        spatial_step.stiffness(
            which, start, self.now, table, first, low, high, reaction, self.response, self.axes,
            self.of_pairs, self.tangent.upper, self.tangent.lower,
        )  # fmt: skip

    # Where it has led.

    def finish(self) -> Array:
        """Find the contacts where the blocks are now, into `found`, and follow the known ones
        there, into `slots`; the history of these, (n_slots, N_HISTORY + 1)."""
        self.constants.detector.follow(self.pairs, self._find(), self.known, self.slots)
        return self._aged() if self.history is None else self.history

    def _aged(self) -> Array:
        """History of contacts where the step is, (n_slots, N_HISTORY + 1)."""
        history, places = self.history_before.copy(), self.places
        space_law.age(
            places.which, places.table, self.trial, self.reaction, self.branch, self.n, history
        )
        return history

    def ended(self) -> Ended:
        """What the strengths of joints are to follow from; see `statics.yielding`."""
        n, before = self.n, self.history_before
        used = self.places.which[:n, 0]
        self.history = self._aged()
        gap = np.full(len(before), np.inf)
        gap[used] = self.places.start[:n, spatial_step.GAP_0] + self.now[:n, Y]
        gap[used] += before[used, DILATION]
        return Ended(
            origin=self.origin,
            before=before,
            after=self.history,
            gap=gap,
            held=self.holding,
            normal=self.by_slot(self.reaction)[:, 0],
            area=np.where(self.known.kind != NONE, self.known.size, 0.0),
        )

    def soften(self, strengths: Strengths, start: Array) -> tuple[IntArray, Array]:
        """Unbalanced forces, and response, where the step is, with the strengths that joints have
        there; see `StaticStep.soften`."""
        self.respond()
        n = self.n
        used = self.places.which[:n, 0]
        law = self.pairs.law_of_slot[used]
        rows = np.flatnonzero(strengths.yields[law])
        slot, law = used[rows], law[rows]
        area, shear = self.known.size[slot], self.trial[rows, 1:]
        size = np.hypot(*shear.T)
        gap = self.places.start[rows, spatial_step.GAP_0] + self.now[rows, Y]
        committed = self.history_before[slot]
        gap = gap + committed[:, DILATION]
        point = strengths.points(law, start[slot], committed, gap, size / area)
        p, kn = point.T, self.table[rows, STIFF_N] / area
        along = np.divide(shear, size[:, None], out=np.zeros_like(shear), where=size[:, None] > 0.0)
        across = np.eye(2) - along[:, :, None] * along[:, None, :]
        share = np.divide(area * p[softening.P_SHEAR], size, out=np.ones(len(rows)), where=size > 0)
        response, reaction = self.response, self.reaction
        reaction[rows, 0] = area * p[softening.P_NORMAL]
        reaction[rows, 1:] = share[:, None] * shear
        response[rows, 0, 0] = -p[softening.P_NY] / kn
        response[rows, 0, 1:] = p[softening.P_NT, :, None] * along
        response[rows, 1:, 0] = (-p[softening.P_TY] / kn)[:, None] * along
        turning = (along[:, :, None] * along[:, None, :]) * p[softening.P_TT, :, None, None]
        response[rows, 1:, 1:] = turning + share[:, None, None] * across
        self.balance(self.reaction)
        return slot, point

    def take(self, held: Array) -> None:
        """Take on what joints hold, (n_slots, N_HELD), from here on; unbalanced forces with it."""
        self.holding[:] = held
        self._hold(held)
        self.move(np.zeros_like(self.x), 0.0)
        self.respond()
        self.balance(self.reaction)

    def _find(self) -> Array:
        """Find the contacts where the blocks are now, into `found`, unless they have been; their
        poses."""
        detector = self.constants.detector
        pose = detector.assembly.moved(self.pose, self.x)
        if self.found_at is None or not np.array_equal(self.found_at, pose):
            self.found.which[:] = self.known.which
            detector.fill(self.pairs, pose, self.found)
            self.found_at = pose
        return pose

    def by_slot(self, values: NDArray[Number]) -> NDArray[Number]:
        """Values of the contacts in use, (n_slots, ...), by slot; zeros elsewhere."""
        spread = np.zeros_like(values)
        spread[self.places.which[: self.n, 0]] = values[: self.n]
        return spread

    def judged(self, history: Array) -> JudgedContacts:
        """The contacts as last evaluated; with their ``history``, see `finish`."""
        n = self.n
        which = self.places.which[:n]
        contacts = Contacts.empty(n, 3, 0)
        contacts.which[:] = which
        table = contacts.table
        table[:] = self.table[:n]
        table[:, TRIAL_N], table[:, TRIAL_T] = self.trial[:n, 0], self.trial[:n, 1]
        used = which[:, 0]
        gap = self.places.start[:n, spatial_step.GAP_0] + self.now[:n, Y]
        gap = gap + self.history_before[used, DILATION]
        return JudgedContacts.with_history(
            contacts, gap, history[used], self.reaction[:n], self.trial[:n, 1:]
        )


def _pairs_of_bodies(pairs: Pairs, n: int) -> tuple[IntArray, IntArray]:
    """Where the pairs of each body begin, (n + 1,), in a list of 2 pair + (1 where it is b)."""
    body = np.column_stack((pairs.a, pairs.b)).ravel()
    order = np.argsort(body, kind="stable")
    begin = np.searchsorted(body[order], np.arange(n + 1))
    return begin.astype(np.int64), order.astype(np.int64)
