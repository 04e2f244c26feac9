"""Static equilibrium by Newton's method, with the multiplier as an unknown of the step.

The unknowns of a step are the increments x of the poses and the multiplier.  They solve

    R(x, lambda) = 0,    c(x) = Delta

with the unbalanced forces R of `solvers.static_step`, evaluated where the step ends, and c the
displacement that paces the step.  The time step in R is so long that inertia only keeps loose
blocks from making the matrix singular; with a short one, a step says where inertia takes blocks
that have no equilibrium nearby.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drystone.contact.detection import (
    Detector,
    Pairs,
    block_size,
    carry,
    copied,
    empty_slots,
)
from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.contact.law import law_table
from drystone.engines.base import Demand, EngineError, Problem, StepReport, UnstableError
from drystone.engines.measures import (
    LoadArrays,
    StepOutcome,
    cone_excess,
    report,
    unstable_sentence,
)
from drystone.kernels import joint, narrow
from drystone.kernels.joint import N_HISTORY
from drystone.kernels.narrow import Slots
from drystone.loading import dead_load
from drystone.solvers import newton
from drystone.solvers.newton import NewtonSettings
from drystone.solvers.static_step import Constants, Pace, StaticStep

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: History of blocks that come to touch later: no shear yet, and no bond.
NEW_CONTACT = np.zeros(N_HISTORY)
NEW_CONTACT[joint.BROKEN] = 1.0


@dataclass(frozen=True, kw_only=True)
class EquilibriumSettings:
    """Numerical settings; none changes what the solution is, but to within its tolerance."""

    tolerance: float = 1e-9  # largest unbalanced force over the heaviest weight, -
    static_time_step: float = 30.0  # s; the inertia of a step of 1 mm is then 1e-7 of a weight
    max_motion: float = 0.3  # share of the detection reach a block may move in one step
    inertia_limit: float = 1e-3  # inertia over applied force above which a point is dynamic


@dataclass(frozen=True, kw_only=True)
class EquilibriumState:
    """Poses, joint history and what the next step is predicted from."""

    pose: Array  # (n, n_dof) m, rad
    multiplier: float
    pairs: Pairs
    slots: Slots  # contacts in `pose`
    history: Array  # (n_slots, N_HISTORY)
    reaction: Array  # (n_slots, dim) N
    status: IntArray  # (n_slots,)
    last_increment: Array  # (n, n_dof) m, rad; zeros where there is nothing to predict from
    last_multiplier_change: float


class EquilibriumEngine:
    """See the module's text."""

    name = "equilibrium"
    prescribes_displacement = True

    def __init__(self, settings: EquilibriumSettings | None = None) -> None:
        self.settings = settings or EquilibriumSettings()

    def start(self, problem: Problem) -> tuple[EquilibriumState, StepReport]:
        """Settle under the dead load; raises `UnstableError`."""
        self.problem = problem
        assembly = problem.assembly
        self.detector = Detector(assembly)
        try:
            laws = law_table(assembly)
        except ValueError as error:
            raise EngineError(f"{error}: the equilibrium engine cannot do without") from None
        free = ~assembly.fixed[:, None]
        self.loads = LoadArrays(
            dead=dead_load(assembly),
            pattern=problem.load.forces(assembly),
            mass=np.where(free, assembly.mass, 0.0),
            total=problem.load.total(assembly),
        )
        self.constants = Constants(
            detector=self.detector,
            laws=laws,
            thickness=assembly.thickness,
            dead=self.loads.dead,
            pattern=self.loads.pattern,
            mass=self.loads.mass,
            inverse_mass=np.where(free, 1.0 / assembly.mass, 0.0),
            extent=np.maximum(self.detector.extent, 1e-12),
            fixed=assembly.fixed,
        )
        pose = assembly.rest_pose()
        pairs = self.detector.pairs(pose)
        self.equations = StaticStep(self.constants, pairs)
        slots = empty_slots(len(pairs.a))
        self.detector.fill(pairs, pose, slots)
        state = EquilibriumState(
            pose=pose,
            multiplier=0.0,
            pairs=pairs,
            slots=slots,
            history=np.zeros((len(slots.kind), N_HISTORY)),
            reaction=np.zeros((len(slots.kind), 2)),
            status=np.zeros(len(slots.kind), np.int64),
            last_increment=np.zeros_like(pose),
            last_multiplier_change=0.0,
        )
        return self._settle(state)

    def _settle(self, state: EquilibriumState) -> tuple[EquilibriumState, StepReport]:
        """Longer and longer steps under the dead load, until one is static."""
        h, limit = 0.02, self.settings.static_time_step
        outcome = StepReport(converged=False)
        travelled = 0.0
        for _ in range(200):
            new, outcome = self.step(state, Demand(multiplier=0.0, time_step=h))
            if not outcome.converged:
                h *= 0.5
                if h < 1e-5:
                    break
                continue
            state = new
            travelled += outcome.motion
            if h >= limit and outcome.inertia_ratio < self.settings.inertia_limit:
                return replace(new, last_increment=np.zeros_like(new.pose)), outcome
            if travelled > block_size(self.problem.assembly):
                break
            h = min(4.0 * h, limit)
        motion = self.detector.motion(state.pose)
        raise UnstableError(unstable_sentence(self.problem.assembly.ids, motion))

    def contacts(self, state: EquilibriumState) -> ContactForces:
        """Contact points and reactions of a state."""
        return self.detector.forces(
            state.pairs, state.pose, state.slots, state.reaction, state.status
        )

    def close(self) -> None:
        """Nothing is held."""

    def step(self, state: EquilibriumState, demand: Demand) -> tuple[EquilibriumState, StepReport]:
        """One implicit step from rest; see `Engine.step`."""
        settings, scale = self.settings, self.problem.assembly.heaviest_weight
        state = self._refresh(state)
        pace = self._pace(state, demand)
        h = demand.time_step or settings.static_time_step
        x, multiplier = self._predict(state, demand, pace)
        equations = self.equations
        equations.begin(state.pose, state.slots, state.history, h, x)
        stiffest = self._stiffest()
        # Joints so stiff that the rounding of a gap is felt cannot be balanced any better.
        rounding = 4.0 * np.finfo(float).eps * float(self.detector.extent.max())
        tolerance = max(settings.tolerance * scale, rounding * stiffest)
        solved = newton.solve(
            equations,
            pace,
            x,
            multiplier,
            state.status == STICKING,
            np.where(state.status == SLIDING, np.sign(state.reaction[:, 1]), 0.0),
            NewtonSettings(
                tolerance=tolerance,
                depth=1e-3 * tolerance / stiffest,
                farthest=settings.max_motion * self.detector.reach,
                reach=max(3.0 * abs(demand.increment or 0.0), 0.02 * self.detector.reach),
            ),
        )
        if solved.reason:
            return state, StepReport(
                converged=False, reason=solved.reason, n_iterations=solved.n_iterations
            )
        return self._accept(state, solved, h, paced=pace is not None)

    def _stiffest(self) -> float:
        """Normal stiffness [N/m] of a joint as long as the smallest block, of the stiffest law."""
        assembly = self.problem.assembly
        stiffness = float(self.constants.laws[:, joint.KN].max())
        return stiffness * block_size(assembly) * assembly.thickness

    def _refresh(self, state: EquilibriumState) -> EquilibriumState:
        """New pairs where the blocks have moved far, and the equations that fit the state."""
        if self.detector.outdated(state.pairs, state.pose):
            pairs = self.detector.pairs(state.pose)
            row = carry(state.pairs, pairs)
            slots = empty_slots(len(pairs.a))
            self.detector.fill(pairs, state.pose, slots)
            source = np.where(row[:, None] >= 0, 2 * row[:, None] + (0, 1), -1).ravel()
            history, reaction, status = _carried(
                source, state.history, state.reaction, state.status
            )
            state = replace(
                state, pairs=pairs, slots=slots, history=history, reaction=reaction, status=status
            )
        if self.equations.pairs is not state.pairs:
            self.equations = StaticStep(self.constants, state.pairs)
        return state

    def _pace(self, state: EquilibriumState, demand: Demand) -> Pace | None:
        if demand.increment is None:
            return None
        control = self.problem.control_point
        theta = state.pose[control.block, 2]
        c, s = np.cos(theta), np.sin(theta)
        x, y = control.point - self.problem.assembly.centroid[control.block]
        return Pace(
            body=control.block,
            arm=np.array([c * x - s * y, s * x + c * y]),
            axis=control.direction,
            increment=demand.increment,
        )

    def _predict(
        self, state: EquilibriumState, demand: Demand, pace: Pace | None
    ) -> tuple[Array, float]:
        """Linear extrapolation of the last step, where that moved the same way."""
        nothing = np.zeros_like(state.pose)
        if pace is None:
            assert demand.multiplier is not None
            return nothing, demand.multiplier
        missing, _ = pace.measure(state.last_increment)
        moved = pace.increment - missing
        if moved * pace.increment <= 0.0:
            return nothing, state.multiplier
        share = pace.increment / moved
        return share * state.last_increment, state.multiplier + share * state.last_multiplier_change

    def _accept(
        self, state: EquilibriumState, solved: newton.NewtonResult, h: float, *, paced: bool
    ) -> tuple[EquilibriumState, StepReport]:
        equations, x = self.equations, solved.increment
        slots = copied(equations.found)
        known, source = equations.known, np.zeros(len(slots.kind), np.int64)
        narrow.carry_history(known.kind, known.feature, known.edges, slots, source)
        history, reaction, status = _carried(
            source, equations.state, equations.reaction, equations.status
        )
        new = EquilibriumState(
            pose=state.pose + x,
            multiplier=solved.multiplier,
            pairs=state.pairs,
            slots=slots,
            history=history,
            reaction=reaction,
            status=status,
            last_increment=x,
            last_multiplier_change=solved.multiplier - state.multiplier,
        )
        outcome = report(
            self.problem,
            self.loads,
            StepOutcome(
                multiplier=solved.multiplier,
                pose=new.pose,
                increment=x,
                acceleration=x / h**2,
                velocity=x / h,
                contact_force=equations.contact_force,
                slots=slots,
                reaction=reaction,
                status=status,
                residual=equations.residual,
                motion=float(self.detector.motion(x).max()),
                n_iterations=solved.n_iterations,
            ),
        )
        friction = self.constants.laws[state.pairs.law, joint.MU].repeat(2)
        excess = cone_excess(reaction, friction) / self.problem.assembly.heaviest_weight
        return new, replace(
            outcome,
            static_multiplier=solved.multiplier if paced else outcome.static_multiplier,
            friction_violation=excess,
            dynamic=outcome.inertia_ratio > self.settings.inertia_limit,
        )


def _carried(
    source: IntArray, history: Array, reaction: Array, status: IntArray
) -> tuple[Array, Array, IntArray]:
    """History, reactions and status of the slots they go on in; -1 marks contacts that are new."""
    history, reaction, status = history[source], reaction[source], status[source]
    lost = source < 0
    history[lost] = NEW_CONTACT
    reaction[lost] = 0.0
    status[lost] = OPEN
    return history, reaction, status
