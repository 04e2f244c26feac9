"""Static equilibrium with the multiplier as an unknown.

The unknowns of a step are the increments x of the poses and the multiplier.  They solve

    R(x, lambda) = 0,    c(x) = Delta

with the unbalanced forces R of `statics.static_step`, evaluated where the step ends, and c the
prescribed displacement.  In the plane, the changes of contacts are followed first
(`statics.plane.piecewise`).  In space, or if that fails, an interior-point method finds them
(`statics.interior`).  The time step in R is so long that inertia only regularises the matrix if
blocks are loose.  If there is no equilibrium nearby, a step with a short time step shows where
inertia takes the blocks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import say
from drystone.common.records import changed
from drystone.contact.contacts import Pairs
from drystone.contact.forces import ActedContacts, ContactForces
from drystone.contact.histories import Histories, handed_on, predecessor_pairs
from drystone.engines.base import (
    Capabilities,
    Demand,
    Engine,
    EngineError,
    PreferredSteps,
    Problem,
    StepPath,
    StepReport,
    UnstableError,
)
from drystone.engines.bonds import BondSteps
from drystone.engines.departure import departing
from drystone.engines.measures import (
    StepOutcome,
    not_crushed,
    report,
    unstable_sentence,
)
from drystone.engines.prepared import Prepared
from drystone.law.bonds import dilating_margins, yielded
from drystone.law.certificate import Forces, JudgedContacts, certify
from drystone.law.columns import BROKEN, SLID
from drystone.law.status import STATUS_OF
from drystone.model.assembly import Assembly
from drystone.model.joint_law import Yielding
from drystone.model.ties import TieState
from drystone.statics import prediction, solution, yielding
from drystone.statics.equations import (
    TOO_STIFF,
    Loaded,
    PointDisplacement,
    first_branches,
    first_history,
    sinking,
)
from drystone.statics.interior import FEW_ITERATIONS
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.solution import SolutionSettings
from drystone.statics.space.space_step import SpaceStep
from drystone.statics.state import EquilibriumState
from drystone.statics.static_step import StaticStep, StepSolution


@dataclass(frozen=True, kw_only=True)
class EquilibriumSettings:
    """Numerical settings.  None of them changes the solution by more than its tolerance.

    Times and lengths in them are those of the structure's own frame, where the smallest block
    measures 0.175 m, so that they mean the same for every structure; see `engines.frame`.
    """

    #: Largest unbalanced force over the heaviest weight, -.  It is a thousand times the rounding of
    #: the sums from which it is calculated.
    tolerance: float = tolerances.BALANCE
    #: Time step of a static step [s]: the inertia of a step of 1 mm is then 1e-7 of a weight.
    static_time_step: float = tolerances.STATIC_TIME_STEP
    #: Farthest motion of a block in one step over the smallest extent, -.  If a block moved
    #: farther, it could meet blocks that the step has not looked at.
    max_motion: float = tolerances.MOST_MOTION
    #: Inertia, -, above which a point is dynamic: the inertia of all blocks over the applied force,
    #: or that of any block over its weight.
    inertia_limit: float = tolerances.STATIC_INERTIA
    solution: SolutionSettings = field(default_factory=SolutionSettings)


class EquilibriumEngine(Engine[EquilibriumState]):
    """See the module's text."""

    name = "equilibrium"
    capabilities = Capabilities(
        rollers=True,
        ties=True,
        bonds=True,
        yielding=frozenset(Yielding),
        prescribes_displacement=True,
        moves_supports=True,
        moves_supports_in_time=True,
        in_own_frame=True,
        keeps_states=True,
        resumes=True,
        residual_limit=tolerances.COARSEST,
    )

    def __init__(self, settings: EquilibriumSettings | None = None) -> None:
        self.settings = settings or EquilibriumSettings()
        #: Equations of the last step, which the next step uses again if they fit its state.
        self.last: StaticStep | None = None

    def preferred_steps(self, assembly: Assembly) -> PreferredSteps:
        """A step should turn a mechanism by about 1 in 500, whatever its height.

        Steps grow after a step that took at most `interior.FEW_ITERATIONS`.  A step that takes more
        would fail without a full search, and a longer one more so.
        """
        size = assembly.smallest_extent
        height = float(np.ptp(assembly.centroid[~assembly.fixed] @ assembly.up)) + size
        step = min(
            max(height * tolerances.STEP_OF_HEIGHT, tolerances.LEAST_STEP * size),
            tolerances.MOST_STEP * size,
        )
        return PreferredSteps(displacement_step=step, grow_iterations=FEW_ITERATIONS)

    def derived(self, problem: Problem) -> tuple[Prepared]:
        return (Prepared.of(problem, self),)

    def start(self, problem: Problem) -> tuple[EquilibriumState, StepReport]:
        """Find the equilibrium under the dead load, stage by stage; raises `UnstableError` if there
        is none."""
        (prepared,) = self.derived(problem)
        assembly, detector, bars = prepared.assembly, prepared.detector, prepared.bars
        pose = assembly.design_pose()
        pairs = detector.pairs(pose)
        slots = detector.find(pairs, pose)
        state = EquilibriumState(
            prepared=prepared,
            stage=problem.stages[0],
            pose=pose,
            multiplier=0.0,
            pairs=pairs,
            paired_at=pose,
            slots=slots,
            history=first_history(prepared, slots),
            reaction=np.zeros_like(slots.normal),
            branch=first_branches(prepared, pairs, slots),
            last_increment=assembly.no_motion(),
            margin=np.full(len(slots.kind) + bars.n_ties, np.inf),
            due=np.zeros(0, np.int64),
            departed=np.zeros(assembly.n_bodies, np.bool_),
            ties=bars.first(),
        )
        state, outcome = self._apply_dead_load(state)
        for stage in problem.stages[1:]:
            state, outcome = self._apply_dead_load(replace(state, stage=stage))
        return state, outcome

    def _apply_dead_load(self, state: EquilibriumState) -> tuple[EquilibriumState, StepReport]:
        """Find the equilibrium under the dead load by pseudo-transient steps.

        The first time step is short.  Time steps grow, and become shorter again if a step fails.
        """
        h, limit = tolerances.DEAD_LOAD_STEP, self.settings.static_time_step
        farthest = state.prepared.assembly.smallest_extent + 4.0 * sinking(
            state.prepared, self.equations_of(state).loads
        )
        outcome = StepReport(converged=False)
        travelled = 0.0
        for _ in range(100):
            demand = Demand(multiplier=0.0, time_step=h)
            new, outcome = self._bond_steps(state.prepared, demand, farthest).remainder(state, 1.0)
            if not outcome.converged:
                h *= 0.25
                if h < tolerances.LEAST_DEAD_LOAD_STEP:
                    break
                continue
            state = new
            travelled += outcome.motion
            if h >= limit and self._at_rest(outcome):
                return replace(new, last_increment=state.prepared.assembly.no_motion()), outcome
            if travelled > farthest:
                break
            h = min(tolerances.LONGER_DEAD_LOAD_STEP * h, limit)
        moved_by = state.prepared.problem.length * state.prepared.detector.travelled(state.pose)
        raise UnstableError(unstable_sentence(state.prepared.problem, moved_by, state.stage))

    def _at_rest(self, outcome: StepReport) -> bool:
        """Whether a step ended at rest: the structure as a whole, and each block for itself."""
        return max(outcome.inertia_ratio, outcome.acceleration) <= self.settings.inertia_limit

    @staticmethod
    def _missed(before: EquilibriumState, after: EquilibriumState) -> bool:
        """Whether blocks overlap that were no pair before the pairs were found anew."""
        if after.pairs is before.pairs:
            return False
        new = predecessor_pairs(before.pairs, after.pairs) < 0
        return bool((after.slots.gap[new[after.pairs.of_slot]] < 0.0).any())

    def contacts(self, state: EquilibriumState) -> ContactForces:
        """Contact points and reactions of a state: those which balance the loads."""
        these = state.acted or self._acted(state)
        return state.prepared.detector.forces(
            these.pairs, state.pose, these.slots, these.reaction, these.status
        )

    def departed(self, state: EquilibriumState) -> BoolArray:
        """Blocks (n,) that have left."""
        return state.departed

    def ties_of(self, state: EquilibriumState) -> TieState:
        """What the ties of a state carry."""
        return state.ties

    @staticmethod
    def _past(state: EquilibriumState) -> Histories:
        return Histories.own(state.slots, state.history, state.reaction, state.branch)

    @staticmethod
    def _acted(state: EquilibriumState) -> ActedContacts:
        return ActedContacts(
            pairs=state.pairs,
            slots=state.slots,
            reaction=state.reaction,
            status=STATUS_OF[state.branch],
        )

    def step(self, state: EquilibriumState, demand: Demand) -> tuple[EquilibriumState, StepReport]:
        """One implicit step from rest; see `Engine.step`."""
        farthest = self.settings.max_motion * state.prepared.assembly.smallest_extent
        prescribes = demand.increment is not None or demand.settlement is not None
        if not state.prepared.gives_way:
            new, outcome = self._step(state, demand, farthest)
        elif prescribes and not demand.time_step > 0.0:
            new, outcome = self._bond_steps(state.prepared, demand, farthest).advance(state)
        else:

            def solve(state: EquilibriumState, share: float) -> tuple[EquilibriumState, StepReport]:
                # Bonds that break in the step are taken out where it begins, so the step keeps the
                # pairs that it begins with.
                return self._step_of_pairs(state, demand, farthest)

            new, outcome = self._bonds(state.prepared, solve).again(state)
            new, outcome = self._with_new_pairs(state, new, outcome)
        if outcome.converged and outcome.dynamic:
            new = self._drop_departed(new)
        return new, outcome

    def _bond_steps(
        self, prepared: Prepared, demand: Demand, farthest: float
    ) -> BondSteps[EquilibriumState]:
        def solve(state: EquilibriumState, share: float) -> tuple[EquilibriumState, StepReport]:
            if demand.settlement is not None:
                part = replace(demand, settlement=share * demand.settlement)
            elif demand.increment is not None:
                part = replace(demand, increment=share * demand.increment)
            else:
                return self._step(state, demand, farthest)
            new, report = self._step(state, part, farthest)
            if share == 0.0 and report.converged:  # motion by a break does not predict what follows
                new = replace(new, last_increment=state.last_increment)
            return new, report

        return self._bonds(prepared, solve)

    def _bonds(
        self,
        prepared: Prepared,
        solve: Callable[[EquilibriumState, float], tuple[EquilibriumState, StepReport]],
    ) -> BondSteps[EquilibriumState]:
        return BondSteps(
            solve=solve,
            broken=self._broken,
            laws=prepared.laws,
            weight=prepared.movable_weight,
            near=tolerances.ENDS_FOR_BOND,
            bars=prepared.bars if prepared.bars.n_ties else None,
        )

    def _broken(self, state: EquilibriumState, due: IntArray) -> EquilibriumState:
        """The state without the bonds that are ``due``, rows of `EquilibriumState.margin`, and with
        the ties that are due past their events."""
        n_slots = len(state.reaction)
        slots = due[due < n_slots]
        if len(slots) < len(due):
            ties = state.prepared.bars.past(state.ties, due[due >= n_slots] - n_slots)
            margin = np.concatenate((state.margin[:n_slots], ties.margin))
            state = replace(state, ties=ties, margin=margin)
        history, branch, margin = state.history.copy(), state.branch.copy(), state.margin.copy()
        margin[slots] = np.inf
        law = state.pairs.law_of_slot[slots]
        slid, until = history[slots, SLID], state.prepared.dilates_until[law]
        ended = dilating_margins(slid, until) <= 2.0 * tolerances.ENDS_FOR_BOND
        history[slots[ended], SLID] = np.maximum(slid, until)[ended]
        slots, law = slots[~ended], law[~ended]
        history[slots, BROKEN] = 1.0
        branch[slots] = yielded(state.prepared.laws, law, state.reaction[slots])
        nothing = np.zeros(0, np.int64)
        return replace(state, history=history, branch=branch, margin=margin, due=nothing)

    def _drop_departed(self, state: EquilibriumState) -> EquilibriumState:
        """Take out blocks that have left the structure; forces on the others do not change."""
        prepared, loads = state.prepared, self.equations_of(state).loads
        left = departing(
            prepared.problem, prepared.detector, loads, state.pose, state.multiplier,
            state.pairs, state.slots, state.reaction, prepared.bars.whole(state.ties),
        )  # fmt: skip
        if not left.any():
            return state
        departed = state.departed | left
        return self._paired(state, departed, prepared.detector.pairs(state.pose, departed))

    def _step(
        self, state: EquilibriumState, demand: Demand, farthest: float
    ) -> tuple[EquilibriumState, StepReport]:
        """A step that fails where a block moves by more than ``farthest`` [m]; pairs of blocks are
        found anew where it ends."""
        new, outcome = self._step_of_pairs(state, demand, farthest)
        return self._with_new_pairs(state, new, outcome)

    def _step_of_pairs(
        self, state: EquilibriumState, demand: Demand, farthest: float
    ) -> tuple[EquilibriumState, StepReport]:
        """The same, but the state at the end keeps the pairs of the state at the start."""
        own = self.equations_of(state)
        own.accuracy = changed(own.loaded.accuracy, farthest=farthest)
        prescribed = prediction.prescribed_by(state, demand)
        h = demand.time_step or self.settings.static_time_step
        guess, multiplier = prediction.predicted(state, demand, prescribed)
        guess = self._move_supports(own, state, demand, guess)
        solved = self._solve(own, state, demand, prescribed, guess, multiplier, h)
        if solved.reason == TOO_STIFF:
            raise EngineError(solved.reason)  # no smaller step would do
        if solved.reason:
            return state, StepReport(
                converged=False,
                reason=solved.reason,
                n_iterations=solved.n_iterations,
                path=StepPath(fold=solved.fold),
            )
        if demand.settlement and state.last_support_motion:
            solved = changed(solved, deviation=solution.deviation(own, solved.increment, guess))
        return self._accept(own, state, solved, h, demand)

    def _with_new_pairs(
        self, state: EquilibriumState, ended: EquilibriumState, outcome: StepReport
    ) -> tuple[EquilibriumState, StepReport]:
        """The end of a step with new pairs, if the blocks have moved far.

        The step has failed if blocks overlap that were no pair.
        """
        if not outcome.converged:
            return ended, outcome
        new = self._refresh(ended)
        if self._missed(ended, new):
            return state, StepReport(
                converged=False,
                reason=say("end.met"),
                n_iterations=outcome.n_iterations,
                path=StepPath(fold=outcome.path.fold),
            )
        return new, outcome

    def _solve(
        self,
        own: StaticStep,
        state: EquilibriumState,
        demand: Demand,
        prescribed: PointDisplacement | None,
        guess: Array,
        start: float,
        h: float,
    ) -> StepSolution:
        """Solve a step from a ``guess`` (n, n_dof) and the multiplier at its ``start``."""
        increment, along = demand.increment, prediction.along_curve(state, demand, guess)
        begins = prediction.begins(state, start, increment, guess, along)
        last: StepSolution | None = None

        def begin(branch: IntArray, near: Array, *joints: Array | None) -> None:
            if own.ties:
                own.ties.begin(state.ties)
            if isinstance(own, PlaneStep):
                own.kept[:] = 0 if state.kept is None else state.kept
            own.begin(state.pose, state.slots, state.history, branch, h, prescribed, near, *joints)

        def solve_once(
            current: Array | None, fresh: Array | None, branch: IntArray, near: Array | None
        ) -> StepSolution:
            nonlocal last
            begin(branch, guess, current, fresh)
            again = begins
            if last is not None:
                again = replace(
                    begins, guesses=[last.increment if near is None else near], along=None,
                    multiplier=start if prescribed is None else last.multiplier,
                    repeats=True, in_vain=last.in_vain,
                )  # fmt: skip
            last = solution.solve(
                own, again, self.settings.solution, dynamic=demand.time_step > 0.0,
                full_search=demand.full_search, beyond=demand.over_fold,
            )  # fmt: skip
            return last

        def put_at_prediction(current: Array, fresh: Array) -> None:
            ahead = guess if along is None else along
            begin(state.branch, ahead, current, fresh)
            own.restart(ahead, start)

        if not state.prepared.strengths.any:
            return solve_once(None, None, state.branch, None)
        rise = state.slope * increment if increment and state.softened else np.nan
        gap = state.slots.gap
        return yielding.solve(
            own,
            yielding.YieldingStart(state.history, gap, state.branch, state.multiplier, rise),
            solve_once,
            put_at_prediction,
            increment,
            may_snap=increment is None or demand.over_fold or demand.time_step > 0.0,
        )

    def _refresh(self, state: EquilibriumState) -> EquilibriumState:
        """The state with pairs found anew, if the blocks have moved far."""
        detector = state.prepared.detector
        if not detector.outdated(state.paired_at, state.pose):
            return state
        pairs = detector.pairs(state.pose, state.departed)
        if np.array_equal(pairs.which, state.pairs.which):
            return changed(state, paired_at=state.pose)  # so that the same equations still fit
        return self._paired(state, state.departed, pairs)

    def equations_of(self, state: EquilibriumState) -> StaticStep:
        """The equations that fit a state: those of the last step if possible, else new ones."""
        last, prepared = self.last, state.prepared
        old = last.loaded if last is not None and last.loaded.prepared is prepared else None
        same = old is not None and old.stage == state.stage
        if last is not None and same and last.pairs is state.pairs:
            return last
        if old is None or not same or old.departed is not state.departed:
            old = Loaded.of(prepared, state.stage, state.departed, self.settings.tolerance)
        kind = SpaceStep if prepared.assembly.dimension == 3 else PlaneStep
        self.last = kind(old, state.pairs)
        return self.last

    def _paired(
        self, state: EquilibriumState, departed: BoolArray, pairs: Pairs
    ) -> EquilibriumState:
        """The state with new pairs, without the blocks that are ``departed``."""
        detector = state.prepared.detector
        heirs = handed_on(detector.narrow, self._past(state), pairs, former=state.pairs)
        in_space = state.slots.dim == 3  # in the plane, the same pose gives the same contacts
        slots = detector.find(pairs, state.pose, heirs.slots if in_space else None)
        if in_space:
            heirs = handed_on(detector.narrow, heirs, pairs, slots)
        margin = np.concatenate((heirs.of(state.margin, np.inf), state.ties.margin))
        n_before, n_after = len(state.reaction), len(heirs.source)
        of_ties = state.due[state.due >= n_before] + (n_after - n_before)
        return replace(
            state,
            pairs=pairs,
            paired_at=state.pose,
            slots=slots,
            history=heirs.history,
            reaction=heirs.reaction,
            branch=heirs.branch,
            margin=margin,
            due=np.concatenate((np.flatnonzero(np.isin(heirs.source, state.due)), of_ties)),
            last_increment=np.where(departed[:, None], 0.0, state.last_increment),
            tangent=None if departed.any() else state.tangent,
            curvature=None if departed.any() else state.curvature,
            departed=departed,
            kept=None,
        )

    def _move_supports(
        self, own: StaticStep, state: EquilibriumState, demand: Demand, guess: Array
    ) -> Array:
        """Give the equations the prescribed increments of supports; returns the ``guess``
        (n, n_dof) with them."""
        problem, given = state.prepared.problem, own.given
        if problem.settlement is None:
            return guess  # no support moves, so `given` is zero from the start
        given[:] = 0.0
        if not demand.settlement:
            return guess
        amount = state.support_motion + demand.settlement
        given[:] = problem.settlement.increment(problem.assembly, state.pose, amount)
        return np.where(np.any(given, axis=1, keepdims=True), given, guess)

    def _accept(
        self,
        own: StaticStep,
        state: EquilibriumState,
        solved: StepSolution,
        h: float,
        demand: Demand,
    ) -> tuple[EquilibriumState, StepReport]:
        """The state that a step has led to, and its report; ``h`` is the time step [s]."""
        judged, then = self._ended(own, state)
        slots, prepared = own.found.copied(), state.prepared
        past, bears = self._past(then), prepared.strengths.bears
        heirs = handed_on(
            prepared.detector.narrow, past, state.pairs, slots, known=own.known, bears=bears
        )
        margin = np.full(len(heirs.source), np.inf)
        if prepared.gives_way:
            used = judged.contacts.slot
            law = state.pairs.law_of_slot[used]
            margin[used] = prepared.bond_margins(judged, law)
            if demand.increment is not None and not demand.time_step > 0.0:
                until = prepared.dilates_until[law]
                dilated = own.history_before[used, SLID] < until
                left = dilating_margins(then.history[used, SLID], until)
                margin[used] = np.minimum(margin[used], np.where(dilated, left, np.inf))
            margin = heirs.of(margin, np.inf)
        pose, ties = prepared.assembly.moved(state.pose, solved.increment), state.ties
        if own.ties:
            own.ties.act(pose)
            ties = own.ties.ended()
            margin = np.concatenate((margin, ties.margin))
        new = changed(
            state,
            pose=pose,
            multiplier=solved.multiplier,
            slots=slots,
            history=heirs.history,
            reaction=heirs.reaction,
            branch=heirs.branch,
            last_increment=solved.increment,
            margin=margin,
            due=np.zeros(0, np.int64),
            ties=ties,
            support_motion=state.support_motion + (demand.settlement or 0.0),
            last_support_motion=demand.settlement or 0.0,
            slope=solved.slope,
            softened=solved.softened,
            tangent=solved.tangent,
            curvature=prediction.curvature_of(state.tangent, solved.tangent, demand.increment),
            kept=own.kept.copy() if isinstance(own, PlaneStep) else None,
            unstable=state.unstable + 1 if solved.unstable else 0,
            in_vain=solved.in_vain,
            acted=then.acted,
        )
        lost = heirs.lost(past) if slots.dim == 3 else 0.0
        lost /= prepared.assembly.heaviest_weight
        return new, self._report(own, new, judged, solved, h, demand, lost)

    def _ended(
        self, own: StaticStep, state: EquilibriumState
    ) -> tuple[JudgedContacts, EquilibriumState]:
        """The contacts that a step was solved with, at its end: as the certificate judges them, and
        as part of the state at the start."""
        history = own.finish()
        ended = changed(
            state,
            slots=own.slots.copied(),
            history=history,
            reaction=own.by_slot(own.reaction)[:, : own.dim],
            branch=own.by_slot(own.branch),
        )
        return own.judged(history), changed(ended, acted=self._acted(ended))

    def _report(
        self,
        own: StaticStep,
        new: EquilibriumState,
        judged: JudgedContacts,
        solved: StepSolution,
        h: float,
        demand: Demand,
        lost_shear: float,
    ) -> StepReport:
        """Figures and certificate of the step that has led to the state ``new`` from rest within
        ``h`` [s]."""
        x, contact_force = new.last_increment, own.contact_force
        loads = own.loads.near(new.pose, new.multiplier)
        acceleration = x / h**2
        forces = Forces(
            contact=contact_force,
            load=loads.dead + new.multiplier * loads.pattern,
            inertia=loads.mass * acceleration,
        )
        certificate = certify(judged, forces, new.prepared.extent, loads.fixed)
        outcome = report(
            new.prepared.problem,
            loads,
            StepOutcome(
                multiplier=new.multiplier,
                pose=new.pose,
                increment=x,
                acceleration=acceleration,
                velocity=x / h,
                contact_force=contact_force,
                slots=not_crushed(new.slots, new.history)
                if new.prepared.strengths.any
                else new.slots,
                status=STATUS_OF[new.branch],
                certificate=own.ties.marked(certificate) if own.ties else certificate,
                support_motion=new.support_motion,
                motion=new.prepared.detector.farthest(x),
                n_iterations=solved.n_iterations,
            ),
        )
        given = demand.increment is None
        return changed(
            outcome,
            static_multiplier=outcome.static_multiplier if given else solved.multiplier,
            path=StepPath(
                fold=solved.fold, excess=solved.excess, bend=solved.bend, deviation=solved.deviation
            ),
            dynamic=not self._at_rest(outcome),
            unstable=solved.unstable,
            lost_shear=lost_shear,
        )
