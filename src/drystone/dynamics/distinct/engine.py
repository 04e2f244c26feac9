"""The distinct element method of Cundall for rigid blocks: UDEC's formulation.

In explicit cycles (see `dynamics.explicit`), springs at the contacts give forces, forces give
accelerations, and accelerations give velocities and poses.  Contacts are searched for only if a
block has moved by more than a tolerance since the last search; in between, their features stay the
same.

Under a given multiplier with a time step, a step is a piece of real motion.  A step with a
prescribed displacement is quasi-static.  The displacement F.x, which is work-conjugate to the load
pattern F, is driven at a constant rate; the multiplier is the force that this takes.  Then F.x is
fixed until all blocks are balanced.  The motion until then has no meaning, so that masses can be
chosen freely: the mass of each degree of freedom is proportional to its stiffness.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.language import say
from drystone.common.tolerances import (
    AT_STRENGTH,
    DISTINCT_RESIDUAL,
    DISTINCT_STEP,
    FEWEST_CYCLES,
)
from drystone.contact.forces import ContactForces
from drystone.dynamics import explicit
from drystone.dynamics.distinct.arrival import at_rest, failed, in_real_motion
from drystone.dynamics.distinct.cycles import load_gradually, relax, run
from drystone.dynamics.distinct.driving import Parts, drive_on
from drystone.dynamics.distinct.state import (
    DistinctPrepared,
    DistinctSettings,
    DistinctState,
    RunAwayError,
    broken,
    released,
)
from drystone.dynamics.distinct.workspace import Bounds, Workspace
from drystone.engines.base import (
    Capabilities,
    Demand,
    Engine,
    PreferredSteps,
    Problem,
    StepReport,
    UnstableError,
)
from drystone.engines.bonds import BondSteps
from drystone.engines.measures import LoadArrays, unstable_sentence
from drystone.law.bonds import weakest
from drystone.model.assembly import Assembly
from drystone.model.joint_law import Yielding
from drystone.model.ties import TieState

#: Parts of the motion of supports, each with a speed of its own.
SUPPORT_PARTS = 120

#: The speeds over their mean: supports start from rest and come back to rest.  A sudden speed would
#: lift the joints for a moment, or press them, and what slips in that moment stays slipped.
SUPPORT_SPEEDS = 1.0 - np.cos(2.0 * np.pi * (np.arange(SUPPORT_PARTS) + 0.5) / SUPPORT_PARTS)

#: A state and the report of the step to it.
Step = tuple[DistinctState, StepReport]


class DistinctEngine(Engine[DistinctState]):
    """The engine of the module's text."""

    name = "distinct"
    capabilities = Capabilities(
        ties=True,
        bonds=True,
        yielding=frozenset({Yielding.SOFTEN, Yielding.LOSE_FRICTION, Yielding.CRUSH}),
        prescribes_displacement=True,
        moves_supports=True,
        in_own_frame=True,
        keeps_states=True,
        resumes=True,
        # The forces at rest are those of a cycle; the poses are those at its end.
        residual_limit=DISTINCT_RESIDUAL,
    )

    def __init__(self, settings: DistinctSettings | None = None) -> None:
        self.settings = settings or DistinctSettings()

    def preferred_steps(self, assembly: Assembly) -> PreferredSteps:
        """Steps that suit this engine; iterations are the cycles of a step."""
        return PreferredSteps(
            displacement_step=DISTINCT_STEP * assembly.smallest_extent, grow_iterations=20_000
        )

    def derived(self, problem: Problem) -> tuple[DistinctPrepared]:
        """See `Engine.derived`."""
        return (DistinctPrepared.of(problem, self),)

    def start(self, problem: Problem) -> Step:
        """Find the equilibrium under the dead load; raises `UnstableError`."""
        state, before = self.release(problem), None
        for stage in problem.stages:
            state = replace(state, stage=stage)
            state, report = self._apply_dead_load(state, gradually=True, before=before)
            before = LoadArrays.of(problem, state.departed, stage)
            while len(due := weakest(state.margin)):
                state, report = self._apply_dead_load(broken(state, due))
        return state, report

    def release(
        self, problem: Problem, pose: Array | None = None, velocity: Array | None = None
    ) -> DistinctState:
        """A state in given poses (n, n_pose) and velocities (n, n_dof), without looking for
        equilibrium."""
        assembly = problem.assembly
        (prepared,) = self.derived(problem)
        return released(
            prepared,
            assembly.design_pose() if pose is None else np.array(pose, float),
            assembly.no_motion() if velocity is None else np.array(velocity, float),
        )

    def _apply_dead_load(
        self, state: DistinctState, *, gradually: bool = False, before: LoadArrays | None = None
    ) -> Step:
        """Cycles under the dead load from rest to rest, with all bonds intact.

        With ``gradually``, the load grows from that ``before``.  Applied at once, it would
        overshoot, and joints that slip in the overshoot would keep their friction.
        """
        problem = state.prepared.problem
        bounds = Bounds(farthest=problem.assembly.smallest_extent)
        work = Workspace(self.settings, state, real_masses=False, bounds=bounds)
        try:
            if gradually:
                load_gradually(work, before)
            if relax(work, guided=False):
                return at_rest(state, work)
            motion = work.travel()
        except RunAwayError as error:
            motion = error.motion
        raise UnstableError(unstable_sentence(problem, problem.length * motion, state.stage))

    def step(self, state: DistinctState, demand: Demand) -> Step:
        """Cycles from `state`; see `Engine.step`."""
        if demand.settlement is not None:
            return self._by_bonds(state, demand.settlement, self._follow_supports)
        if demand.increment is not None:
            return self._by_bonds(state, demand.increment, self._advance)
        if demand.multiplier is None:
            raise ValueError("a step needs an increment or a multiplier")
        state = broken(state, state.due)
        if demand.time_step > 0.0:
            return self._move(state, demand)
        work = self._quasi_static(replace(state, multiplier=demand.multiplier))
        return self._balance(state, work, guided=False)

    def _by_bonds(
        self, state: DistinctState, amount: float, go: Callable[[DistinctState, float], Step]
    ) -> Step:
        """Move by an ``amount`` [m or rad] with the method ``go``, as far as bonds and ties
        allow."""
        prepared = state.prepared
        if not prepared.gives_way:
            return go(state, amount)

        def solve(state: DistinctState, share: float) -> Step:
            new, report = go(state, share * amount)
            if share == 0.0 and report.converged:  # motion by a break does not predict what follows
                new = replace(new, increment=state.increment)
            return new, report

        return BondSteps(
            solve=solve,
            broken=broken,
            laws=prepared.laws,
            weight=prepared.movable_weight,
            near=AT_STRENGTH,
            bars=prepared.bars if prepared.bars.n_ties else None,
        ).advance(state)

    def _quasi_static(self, state: DistinctState, asked: float = 0.0) -> Workspace:
        """A workspace for quasi-static cycles; ``asked`` [m] is the demanded motion of blocks."""
        state = replace(state, velocity=np.zeros_like(state.velocity))
        farthest = self.settings.max_motion * state.prepared.span
        bounds = Bounds(farthest=farthest, may_lose=True, asked=asked)
        return Workspace(self.settings, state, real_masses=False, bounds=bounds)

    def _follow_supports(self, state: DistinctState, amount: float) -> Step:
        """Move supports on by an ``amount`` [m or rad], from rest and back to rest, then balance.

        Damping is combined, as in the drive of the control displacement: local damping would act
        as a force on blocks that ride along.
        """
        settlement = state.prepared.problem.settlement
        assert settlement is not None
        assembly = state.prepared.assembly
        n = max(self.settings.drive_cycles // SUPPORT_PARTS, 1)
        given = settlement.increment(assembly, state.pose, state.support_motion + amount)
        work = self._quasi_static(state, state.prepared.detector.farthest(given))
        if amount:
            rows = settlement.rows(assembly)
            try:
                for speed in SUPPORT_SPEEDS:
                    work.motion.velocity[rows] = speed * given[rows] / (SUPPORT_PARTS * n * work.dt)
                    run(work, n, combined=True)
            except RunAwayError as error:
                return state, failed(str(error), work)
            work.motion.velocity[rows] = 0.0
        return self._balance(
            replace(state, support_motion=state.support_motion + amount), work, guided=False
        )

    def _advance(self, state: DistinctState, increment: float) -> Step:
        """Drive the control displacement by an ``increment`` [m], then fix it and balance."""
        work = self._quasi_static(state, abs(increment))
        parts = Parts((), ())
        try:
            if increment:
                parts = drive_on(state, work, increment)
        except RunAwayError as error:
            return state, failed(str(error), work, runs_away=True)
        new, figures = self._balance(state, work, guided=True)
        sense = 1.0 if increment >= 0.0 else -1.0
        if not increment:
            return new, figures
        ends = sense * state.multiplier, sense * new.multiplier
        overshoot, rise = max(parts.highest - max(ends), 0.0), parts.rise(*ends)
        return new, replace(figures, path=replace(figures.path, overshoot=overshoot, rise=rise))

    def _balance(self, state: DistinctState, work: Workspace, *, guided: bool) -> Step:
        """Cycles until all blocks rest: with fixed F.x if ``guided``, else under a given load."""
        try:
            if relax(work, guided=guided):
                return at_rest(state, work)
        except RunAwayError as error:
            return state, failed(str(error), work, runs_away=True)
        left = work.meter[explicit.RESIDUAL]
        return state, failed(
            say("end.unbalanced", residual=float(left), n=work.n_cycles),
            work,
        )

    def _move(self, state: DistinctState, demand: Demand) -> Step:
        """Real motion for a given time under a given multiplier.

        The figures are means over the second half of the cycles, after the first waves.
        """
        assert demand.multiplier is not None
        begin = replace(state, multiplier=demand.multiplier)
        if demand.stop_blocks:
            begin = replace(begin, velocity=np.zeros_like(state.velocity))
        bounds = Bounds(farthest=self.settings.max_motion * state.prepared.span, may_lose=True)
        work = Workspace(self.settings, begin, real_masses=True, bounds=bounds)
        cycles, most = demand.time_step / work.dt, self.settings.max_cycles
        if not FEWEST_CYCLES <= cycles <= most:
            return state, failed(
                say("end.cycles", seconds=demand.time_step, cycles=cycles, most=most),
                work,
            )
        n = round(cycles)
        try:
            run(work, n // 2)
            work.motion.mean[:], work.motion.opposed[:] = 0.0, 0.0
            n -= n // 2
            run(work, n)
        except RunAwayError as error:
            return state, failed(str(error), work)
        if np.array_equal(work.searched, work.motion.pose):
            work.cycle_once()  # contacts that were just found anew have no reactions yet
            n += 1
        return in_real_motion(state, work, n)

    def departed(self, state: DistinctState) -> BoolArray:
        """Blocks (n,) that have left."""
        return state.departed

    def ties_of(self, state: DistinctState) -> TieState:
        """The ties of a state, with their forces."""
        return state.ties

    def contacts(self, state: DistinctState) -> ContactForces:
        """Contact points and reactions of a state."""
        return state.prepared.detector.forces(
            state.pairs, state.pose, state.slots, state.reaction, state.status
        )
