"""The equations of one static step, in the plane and in space, and their factors.

    R(x, l) = G + l F + sum over contacts E r - M x / h^2 = 0,    c(x) = Delta

The unknowns are the increments x of the poses and the multiplier l.  G is the dead load, F the load
pattern, r the reactions of a contact and E its axes, M the mass, h the time step; c is the
prescribed displacement.  Reactions, gaps and gradients are those where the step ends.
`statics.plane` and `statics.space` calculate the place and the stiffness of contacts; everything
else is here, once for both.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.threads import team
from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    INTACT,
    LIFT,
    N_CURRENT,
    PAIR,
    PULL,
    SHIFT,
    SLOT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
    Contacts,
    Pairs,
    Slots,
)
from drystone.engines.base import Fold
from drystone.engines.tie_forces import JoinedTies
from drystone.geometry import motion
from drystone.law import softening
from drystone.law.certificate import JudgedContacts
from drystone.law.columns import (
    BROKEN,
    COHESION,
    DILATANCY_END,
    N_HISTORY,
    SLID,
    TAN_PSI,
    TENSION,
    YIELDS,
)
from drystone.law.cones import N_INNER, N_SCALING
from drystone.law.packing import pack_laws
from drystone.linear import numeric as lu_numeric
from drystone.linear import symbolic as lu_symbolic
from drystone.linear.shared_lu import SharedLU
from drystone.linear.symbolic import Tangent
from drystone.statics import balance
from drystone.statics.equations import Loaded, PointDisplacement

Number = TypeVar("Number", np.float64, np.int64)

#: Least number of contacts for which threads pay off: for the stiffness; and for operations that
#: take some ten nanoseconds per contact.  Waking a thread takes some 0.1 ms.
MANY, MANY_OF_LITTLE = 4000, 20000


class Bordered(NamedTuple):
    """The columns and the row that border the matrix, (n, n_dof) unless said otherwise; see
    `statics.balance.solve_bordered`."""

    load: Array  # F
    gradient: Array  # g, gradient of the prescribed displacement
    columns: Array  # (2, n, n_dof) direction, K'^-1 F
    # (1,) g . K'^-1 F, the determinant of the bordered matrix over that of K'
    compliance: Array
    # (1,) sign of the determinant of K'; where its product with the compliance is negative, the
    # number of unstable modes is odd
    sign: Array


@dataclass(frozen=True, kw_only=True)
class StepSolution:
    """Where a step has led; with a `reason` if that is not an equilibrium."""

    increment: Array  # (n, n_dof)
    multiplier: float
    n_iterations: int
    fold: Fold | None = None  # of the path of equilibria, see `engines.base.StepPath`
    #: By how much the multiplier within the step exceeds the multipliers at both ends; and how far
    #: it departs from the chord between them.  Each comes with the share of the step where it is
    #: largest.
    excess: tuple[float, float] | None = None
    bend: tuple[float, float] | None = None
    #: Largest deviation of a block from the predictor, over the farthest motion of a block.  The
    #: predictor is the tangent at the start, or, if supports move, the increments of the last step.
    deviation: float | None = None
    slope: float = np.nan  # 1/m, of the curve at the end; NaN if not known
    tangent: Array | None = None  # (n, n_dof) per m of the prescribed displacement, if known
    unstable: bool = False  # whether the equilibrium is unstable, and no stable one is nearby
    in_vain: int = 0  # steps in a row that Newton's method along the curve has not completed
    softened: bool = False  # whether joints soften at the end, and the slope allows for that
    reason: str = ""


class StaticStep(ABC):
    """Evaluates and linearises the equations of steps over one list of pairs; owns their arrays.

    The `n` contacts in use are listed in the order of their pairs, in the first rows of arrays as
    long as all slots.  `trial` (n_slots, 3) [N] are the reactions that the springs alone would
    have.  The joint law makes of them `reaction` (n_slots, 3) [N] and `branch` (n_slots,).
    `response` (n_slots, 3, 3) are the derivatives of the reactions by the trial reactions.  In the
    plane the third component is zero.
    """

    def __init__(self, loaded: Loaded, pairs: Pairs) -> None:  # Long: all the memory of a step.
        loads, prepared, ties = loaded.loads, loaded.prepared, loaded.ties
        assembly = prepared.assembly
        n, n_dof = loads.mass.shape
        n_pairs, n_slots, dim = pairs.n_pairs, pairs.n_slots, assembly.dimension
        self.loaded, self.loads, self.pairs, self.dim = loaded, loads, pairs, dim
        self.accuracy, self.detector, self.ties = loaded.accuracy, prepared.detector, ties
        #: Loads that change with the pose or the multiplier; None if all loads are constant.
        self.acting = None if loads.acting.steady else loads.acting
        # Contacts by the features that the step follows, where it starts; the same where the step
        # is; and the contacts found anew where it is.
        self.known, self.slots, self.found = (Slots.empty(n_slots, dim) for _ in range(3))
        self.history_before = np.zeros((n_slots, N_HISTORY + dim - 2))
        self.contacts = Contacts.empty(n_slots, dim, n_dof if dim == 2 else 0)
        self.which, self.table = self.contacts.which, self.contacts.table
        self.n, self.first = 0, np.zeros(n_pairs + 1, np.int64)
        self.trial, self.reaction, self.by_motion = (np.zeros((n_slots, 3)) for _ in range(3))
        self.response = np.zeros((n_slots, 3, 3))
        self.branch = np.zeros(n_slots, np.int64)
        self.inner, self.change = (np.zeros((n_slots, N_INNER)) for _ in range(2))
        self.scaling, self.drawn = np.zeros((n_slots, N_SCALING)), np.zeros((n_slots, 3))
        # Per slot: whether it may yield; whether it has a brittle bond; the tangent of its
        # dilatancy angle; the slip [m] at which dilatancy ends.
        law = prepared.laws[pairs.law_of_slot]
        self.yields = law[:, YIELDS] != 0.0
        self.bonded = (law[:, COHESION] > 0.0) | (law[:, TENSION] > 0.0)
        self.dilate, self.until = law[:, TAN_PSI], law[:, DILATANCY_END]
        self.any_dilates, self.any_bonded = bool(self.dilate.any()), bool(self.bonded.any())
        self.given = np.zeros((n, n_dof))  # prescribed increments of supports
        self.x, self.force, self.contact_force = (np.zeros((n, n_dof)) for _ in range(3))
        self.damping = np.zeros(n)
        self.joined = JoinedTies.of(ties.body, pairs.a, pairs.b) if ties else None
        joined: JoinedTies | Pairs = self.joined or pairs
        self.tangent = Tangent.zeros(n, len(joined.a), n_dof)
        self.team = team()
        self.cuts = self.little_cuts = [(0, n_pairs)]
        place = motion.places(assembly.centroid, pairs.pose)
        structure = lu_symbolic.analyse(joined.a, joined.b, loads.fixed, place, n_dof)
        self.lu = SharedLU(structure, self.team)
        self.structure, self.factors = self.lu.structure, self.lu.factors
        self.bordered = Bordered(
            load=loads.pattern.copy() if self.acting else loads.pattern,
            gradient=np.zeros((n, n_dof)),
            columns=np.zeros((2, n, n_dof)),
            compliance=np.ones(1),
            sign=np.ones(1),
        )
        self.forces = balance.BodyForces(
            contact=self.contact_force,
            dead=loads.dead.copy() if self.acting else loads.dead,
            pattern=self.bordered.load,
            mass=loads.mass,
            extent=prepared.extent,
            fixed=loads.fixed,
            left=self.force,
        )
        self.n_due = 1  # number of columns that the next solution of the bordered system fills
        self.spring = 0.0  # N/m, at the control point, see `balance.stiffen`
        self.prescribed: PointDisplacement | None = None
        self.all_slots, self.all_pairs = np.arange(n_slots), np.arange(n_pairs + 1)
        self.current, self.origin = np.zeros((0, N_CURRENT)), self.all_slots.copy()
        self.fresh = self.current
        self.history: Array | None = None
        self.multiplier, self.residual, self.inertia_factor = 0.0, np.inf, 0.0

    # The step.

    def begin(
        self,
        pose: Array,
        slots: Slots,
        history: Array,
        branch: IntArray,
        h: float,
        prescribed: PointDisplacement | None,
        guess: Array,
        current: Array | None = None,
        fresh: Array | None = None,
    ) -> None:
        """Start a step of ``h`` [s] from rest in ``pose`` (n, n_pose), with contacts and their
        ``history`` (n_slots, N_HISTORY + dim - 2) and ``branch`` (n_slots,).

        ``guess`` (n, n_dof) is the predicted end.  ``current`` (n_slots, N_CURRENT) are the
        parameters of joints that yield, see `contact.contacts`; ``fresh`` (n_slots, N_CURRENT) are
        those of contacts that are made in the step.
        """
        self.begun = pose, slots, history, branch, h, prescribed, guess, current, fresh
        self.pose, self.inertia_factor, self.prescribed = pose, 1.0 / h**2, prescribed
        self.found_at: Array | None = None  # poses in which `found` was found
        self.origin[:], self.history = self.all_slots, None
        self.current = self.current[:0] if current is None else current.copy()
        self.fresh = self.current if fresh is None else fresh
        self.history_before[:] = history
        self._take_up(slots, branch, guess)

    def again(self) -> None:
        """Begin the step again with the arguments of the last `begin`."""
        self.begin(*self.begun)

    def _pack(self, closed: BoolArray, branch: IntArray) -> None:
        """List the known contacts in use, with the stiffness and strength of their joints.

        ``closed`` (n_slots,) are the contacts that may dilate in the step, ``branch`` (n_slots,)
        the branches of the joint law at its start.
        """
        prepared, table = self.loaded.prepared, self.table
        thickness = prepared.assembly.thickness
        self.n = n = pack_laws(self.known, self.pairs, prepared.laws, thickness, self.contacts)
        used, pair = self.which[:n, SLOT], self.which[:n, PAIR]
        if self.any_dilates:
            dilates = closed & (self.history_before[:, SLID] < self.until)
            table[:n, LIFT] = table[:n, STIFF_N] * np.where(dilates, self.dilate, 0.0)[used]
        if self.any_bonded:
            table[:n, INTACT] = (self.bonded & (self.history_before[:, BROKEN] == 0.0))[used]
        self.first[:] = pair.searchsorted(self.all_pairs)
        self.cuts, self.little_cuts = self._cut(MANY), self._cut(MANY_OF_LITTLE)
        self.branch[:n] = branch[used]
        self.area = self.known.size[used] * thickness
        if len(self.current):
            self._use_current()

    def _use_current(self) -> None:
        """Write the current parameters of joints that yield into the table."""
        used = self.which[: self.n, SLOT]
        rows = np.flatnonzero(self.yields[used])
        now, area, table = self.current[used[rows]], self.area[rows], self.table
        crush = now[:, CRUSH] * area
        table[rows, STIFF_N], table[rows, FRICTION] = now[:, STIFF_N] * area, now[:, FRICTION]
        table[rows, SHIFT:CRUSH] = now[:, SHIFT:CRUSH] * area[:, None]
        table[rows, CRUSH] = np.where(np.isfinite(crush), crush, 0.0)

    def restart(self, x: Array, multiplier: float) -> None:
        """Put the bodies at increments ``x`` (n, n_dof) from where the step starts."""
        self.multiplier = multiplier
        self._reset()
        self.move(x, 1.0)

    def move(self, step: Array, length: float) -> None:
        """Move the bodies on by ``length`` times increments (n, n_dof); locate contacts anew."""
        self._go(step, length)
        self._locate_all()

    def follow(self, motion: Array) -> None:
        """Continue the trial reactions along a ``motion`` (n, n_dof) to first order, without moving
        the bodies."""
        n, table = self.n, self.table
        self.rates(motion)
        self.trial[:n] -= table[:n, (STIFF_N, STIFF_T, STIFF_T)] * self.by_motion[:n]
        table[:n, TRIAL_N : TRIAL_T + 1] = self.trial[:n, :2]

    @property
    def missing(self) -> float:
        """The part of the prescribed displacement that is still missing [m]."""
        return self.prescribed.missing(self.x) if self.prescribed else 0.0

    # Equations.

    @property
    def inside(self) -> Array:
        """Reactions (n_slots, 3 or more) [N] of the interior-point method."""
        if not len(self.current):
            return self.inner
        n = self.n
        self.drawn[:n] = self.inner[:n, :3]
        self.drawn[:n, 0] -= self.table[:n, PULL]
        return self.drawn

    def respond(self) -> None:
        """Evaluate the reactions of the joint law and their derivatives."""
        self._by_pairs(self._respond)

    def balance(self, reaction: Array) -> float:
        """Evaluate the unbalanced forces for reactions (n_slots, 3 or more) [N]; returns the
        largest [N]."""
        self._sum_forces(reaction)
        self._act()
        if self.ties:
            self.ties.add_to(self.contact_force)
        self.residual = balance.unbalance(self.forces, self.multiplier, self.x, self.inertia_factor)
        return self.residual

    def _act(self) -> None:
        """Evaluate ties and loads where the step is."""
        if self.ties:
            self.ties.act(self._pose_now())
        if self.acting:
            now = self.acting.near(self._pose_now(), self.multiplier)
            self.forces.dead[:], self.forces.pattern[:] = now

    def enough(self, moved: float) -> float:
        """Unbalanced force [N] that may be left: the tolerance, or the effect of rounding if that
        is larger.  ``moved`` [m] is the farthest motion of a block in the step.

        In the plane, gaps are differences of coordinates, and their rounding grows with the
        displacement from the design.  All other rounding grows with the motion within the step.
        """
        accuracy = self.accuracy
        if self.residual <= accuracy.tolerance:
            return accuracy.tolerance
        far = moved + self._from_design()
        rounding = max(accuracy.rounding * far, accuracy.sliding_rounding * moved)
        return max(accuracy.tolerance, rounding)

    def balanced(self) -> bool:
        """Whether the forces last evaluated balance, and the prescribed displacement is reached."""
        accuracy = self.accuracy
        if abs(self.missing) > accuracy.lag or self.residual > accuracy.coarsest:
            return False
        if self.residual <= accuracy.tolerance:
            return True
        return self.residual <= self.enough(self.detector.farthest(self.x))

    def _pose_now(self) -> Array:
        return self.detector.assembly.moved(self.pose, self.x)

    def factorise(self, reaction: Array, least_damping: float) -> bool:
        """Factorise the stiffness for the present `response` and reactions; False if singular.

        The matrix, but not the forces, also has the mass times `damping` (n,) [1/s2].  If
        ``least_damping`` [1/s2] is positive, the damping of blocks without support is raised by at
        least as much.
        """
        self._stiffen(reaction)
        if self.ties and self.joined:
            self.ties.act(self._pose_now())
            self.joined.clear(self.tangent, self.pairs.n_pairs)
            self.joined.stiffen(self.tangent, self.ties.stiffness())
        if self.acting:
            turning = self.acting.stiffness(self._pose_now(), self.multiplier)
            self.tangent.diagonal[:, self.dim :, self.dim :] += turning
        bordered, mass = self.bordered, self.loads.mass
        self.spring = balance.stiffen(
            self.tangent.diagonal, mass, self.inertia_factor, self.damping, self._border(),
            bordered.gradient,
        )  # fmt: skip
        pivot = self.lu.factorise(self.tangent, mass, self.damping, least_damping)
        self.n_due, bordered.sign[0] = 1, np.sign(pivot)
        if pivot == 0.0 or self.prescribed is None:
            return pivot != 0.0
        bordered.columns[1] = bordered.load
        self.n_due = 2
        return True

    def _border(self) -> int:
        """Border the matrix with the gradient of the prescribed displacement where the step is.

        Returns the body of the prescribed displacement, -1 if there is none.
        """
        bordered = self.bordered
        bordered.compliance[0] = 1.0
        if self.prescribed is None:
            return -1
        bordered.gradient[:] = self.prescribed.gradient(self.x)
        return self.prescribed.body

    def solve(self, missing: float) -> float:
        """Solve for a direction, in place, from the forces in the first column.

        ``missing`` [m] is the prescribed displacement along the direction.  Returns the change of
        the multiplier.
        """
        columns = self.bordered.columns
        if self.prescribed:
            body = self.prescribed.body
            columns[0, body] += self.spring * missing * self.bordered.gradient[body]
        # The first solution after a factorisation also fills the columns of the border, so that
        # the factors are read once.
        lu_numeric.solve(self.structure, self.factors, columns[: self.n_due])
        self.n_due = 1
        return (
            float(balance.solve_bordered(self.bordered, columns[0], missing))
            if self.prescribed
            else 0.0
        )

    def aim(self) -> float:
        """Fill the first column with Newton's direction; returns the change of the multiplier, NaN
        if the stiffness is singular."""
        self.damping[:] = 0.0
        if not self.factorise(self.reaction, 0.0):
            return np.nan
        self.bordered.columns[0] = self.force
        return self.solve(self.missing)

    def slope(self) -> float | None:
        """Fill the first column with the tangent; returns the slope of the curve [1/m].

        The slope is zero without a prescribed displacement, and None if the stiffness is singular.
        """
        self.damping[:] = 0.0
        if not self.factorise(self.reaction, 0.0):
            return None
        self.bordered.columns[0] = 0.0
        return self.solve(1.0)

    @property
    def stable(self) -> bool:
        """Whether the number of unstable modes is even, once a direction has been solved for."""
        return bool(self.bordered.sign[0] * self.bordered.compliance[0] > 0.0)

    # Parts that differ between plane and space.

    @abstractmethod
    def _take_up(self, slots: Slots, branch: IntArray, guess: Array) -> None:
        """Take over the contacts with which the step starts."""

    def _from_design(self) -> float:
        """Displacement of blocks from the design [m] that adds to the rounding of gaps."""
        return 0.0

    @abstractmethod
    def _reset(self) -> None:
        """Put the bodies back where the step starts."""

    @abstractmethod
    def _go(self, step: Array, length: float) -> None:
        """Move bodies by ``length`` times increments (n, n_dof)."""

    @abstractmethod
    def _locate_all(self) -> None:
        """Evaluate the places of contacts and their trial reactions."""

    @abstractmethod
    def _respond(self, low: int, high: int) -> None:
        """Evaluate the joint law for the contacts of pairs from ``low`` to before ``high``."""

    @abstractmethod
    def _sum_forces(self, reaction: Array) -> None:
        """Fill `contact_force` with the forces that reactions (n_slots, 3 or more) [N] exert on the
        bodies."""

    @abstractmethod
    def _stiffen(self, reaction: Array) -> None:
        """Fill `tangent` with the stiffness of the contacts: the derivative of minus their forces,
        geometric part included."""

    @abstractmethod
    def rates(self, direction: Array) -> None:
        """Fill `by_motion` with the rates of gaps and slips along a direction (n, n_dof)."""

    @abstractmethod
    def _age(self, history: Array) -> None:
        """Change a history (n_slots, N_HISTORY + dim - 2) from that at the start to that where the
        step is, in place."""

    @abstractmethod
    def gaps(self) -> Array:
        """Gaps of the contacts in use where the step is, (n,) [m]."""

    @abstractmethod
    def update_contacts(self) -> bool:
        """Update the contacts to where the step is; whether any has changed."""

    # Work on the contacts of ranges of pairs, which threads share.

    def _cut(self, least: int) -> list[tuple[int, int]]:
        """Ranges of pairs with about equal numbers of contacts, one range for each thread; a single
        range if there are fewer than ``least`` contacts."""
        first, parts = self.first, self.team.number if self.n >= least else 1
        if parts == 1:
            return [(0, len(first) - 1)]
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
        """Apply ``work`` to ranges of the contacts in use; several threads may run at once."""
        first = self.first
        self._by_pairs(lambda low, high: work(slice(first[low], first[high])))

    # The end of the step.

    def finish(self) -> Array:
        """Find the contacts where the blocks are now, into `found`; the known contacts there are in
        `slots`.  Returns the history of the known contacts, (n_slots, N_HISTORY + dim - 2)."""
        self._find()
        return self._aged() if self.history is None else self.history

    def _aged(self) -> Array:
        """History of the known contacts where the step is, (n_slots, N_HISTORY + dim - 2)."""
        history = self.history_before.copy()
        self._age(history)
        return history

    def ended(self) -> tuple[Array, Array, Array, Array]:
        """What the strengths of joints at the end of the step depend on; see `statics.yielding`.

        Returns, for all slots: the history at the end (n_slots, N_HISTORY + dim - 2), gaps [m],
        normal reactions [N] and areas [m2], (n_slots,) each.
        """
        used = self.which[: self.n, SLOT]
        self.history = self._aged()
        gap, area = np.full(len(self.branch), np.inf), np.zeros(len(self.branch))
        gap[used], area[used] = self.gaps(), self.area
        return self.history, gap, self.by_slot(self.reaction)[:, 0], area

    def soften(self, start: Array) -> tuple[IntArray, Array]:
        """Evaluate the reactions, responses and unbalanced forces where the step is, with the
        strengths that joints have there.

        ``start`` (n_slots, N_HISTORY + dim - 2) is the history where the step begins, of the
        present slots.  Returns the slots (k,) of joints that yield, and their state (k, N_POINT).
        """
        self.respond()
        used, strengths = self.which[: self.n, SLOT], self.loaded.prepared.strengths
        law = self.pairs.law_of_slot[used]
        rows = np.flatnonzero(strengths.yields[law])
        slot, law = used[rows], law[rows]
        area, shear = self.area[rows], self.trial[rows, 1:]
        size = np.hypot(*shear.T)
        before = self.history_before[slot]
        point = strengths.points(law, start[slot], before, self.gaps()[rows], size / area)
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

    def take(self, current: Array) -> None:
        """Use the ``current`` parameters of joints (n_slots, N_CURRENT) from here on, and evaluate
        the unbalanced forces."""
        self.current[:] = current
        self._use_current()
        self.move(np.zeros_like(self.x), 0.0)
        self.respond()
        self.balance(self.reaction)

    def _find(self) -> None:
        """Find the contacts where the blocks are now, into `found`, unless they are known."""
        pose = self._pose_now()
        if self.found_at is None or not np.array_equal(self.found_at, pose):
            self.found.which[:] = self.known.which
            self.detector.fill(self.pairs, pose, self.found)
            self.found_at = pose

    def by_slot(self, values: NDArray[Number]) -> NDArray[Number]:
        """Values (n_slots, ...) of the contacts in use, listed by slot; zeros elsewhere."""
        spread = np.zeros_like(values)
        spread[self.which[: self.n, SLOT]] = values[: self.n]
        return spread

    def judged(self, history: Array) -> JudgedContacts:
        """The contacts as last evaluated, as views, with their ``history``; see `finish`."""
        n, dim, contacts = self.n, self.dim, self.contacts.of(slice(self.n))
        contacts.table[:, TRIAL_N : TRIAL_T + 1] = self.trial[:n, :2]
        return JudgedContacts.with_history(
            contacts,
            self.gaps(),
            history[contacts.slot],
            self.reaction[:n, :dim],
            self.trial[:n, 1:dim],
        )
