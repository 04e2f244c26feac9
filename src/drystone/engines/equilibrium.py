"""Static equilibrium by Newton's method, with the multiplier as an unknown of the step.

The unknowns of a step are the increments x of the poses and the multiplier.  They solve

    G + lambda F + sum over contacts (r_n grad g + r_t grad s) - M x / h^2 = 0
    c(x) = Delta

with gaps, slips and their gradients in the present places, that is, at the end of the step: dead
load G, load pattern F, mass M, a time step h so long that the inertia term only keeps loose blocks
from making the matrix singular, and c the displacement that paces the step.  The linearised
equations are solved with a spring along c added to the matrix,

    (K + alpha c c^T) y_1 = R + alpha c (Delta - c(x)),    (K + alpha c c^T) y_2 = F

which leaves the solution as it is and keeps the matrix regular at the peak, where K is not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import GRAVITY
from drystone.contact.detection import Detector, Pairs, block_size, carry, empty_slots
from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.contact.law import law_table
from drystone.engines.base import Demand, Problem, StepReport, UnstableError
from drystone.engines.measures import (
    LoadArrays,
    StepOutcome,
    cone_excess,
    report,
    unstable_sentence,
)
from drystone.kernels import joint, narrow
from drystone.kernels.joint import N_HISTORY, Tangent
from drystone.kernels.narrow import Slots
from drystone.loading import dead_load
from drystone.solvers.linear import BlockSystem, SingularMatrixError

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
    max_iterations: int = 30  # Newton iterations of one step
    max_attempts: int = 6  # directions tried in one iteration
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
    last_length: float  # m, increment of the pacing displacement that went with them


class Workspace:
    """Scratch arrays and the linear system of one pair list."""

    def __init__(self, pairs: Pairs, fixed: NDArray[np.bool_], n_dof: int) -> None:
        n, n_pairs = len(fixed), len(pairs.a)
        self.pairs = pairs
        self.slots = empty_slots(n_pairs)
        self.known = empty_slots(n_pairs)  # contacts by the features that the step follows
        self.found = empty_slots(n_pairs)  # contacts as they are found where the step ends
        self.source = np.arange(2 * n_pairs)
        self.force = np.zeros((n, n_dof))  # unbalanced
        self.contact_force = np.zeros((n, n_dof))
        self.reaction = np.zeros((2 * n_pairs, 2))
        self.status = np.zeros(2 * n_pairs, np.int64)
        self.state = np.zeros((2 * n_pairs, N_HISTORY))
        self.held = np.zeros(2 * n_pairs, np.bool_)
        self.excess = np.zeros(2 * n_pairs)  # N
        self.start_slip = np.zeros((2 * n_pairs, 6))
        self.tangent = Tangent(
            diagonal=np.zeros((n, n_dof, n_dof)),
            upper=np.zeros((n_pairs, n_dof, n_dof)),
            lower=np.zeros((n_pairs, n_dof, n_dof)),
        )
        self.system = BlockSystem(pairs.a, pairs.b, fixed, n_dof)


@dataclass(frozen=True, kw_only=True)
class Pace:
    """The displacement that paces a step: c(x), and the increment asked of it."""

    body: int
    direction: Array  # (n_dof,) generalised direction where the step starts
    arm: Array | None  # (dim,) m from the centroid to the control point; None: c is linear
    axis: Array | None  # (dim,) direction of the control displacement
    increment: float  # m

    def value_and_gradient(self, x: Array) -> tuple[float, Array]:
        """c(x) [m] and its gradient (n_dof,) by the increments of the pacing body."""
        if self.arm is None or self.axis is None:
            return float(self.direction @ x[self.body]), self.direction
        ux, uy, w = x[self.body]
        arm, axis = self.arm, self.axis
        s, versine = np.sin(w), 2.0 * np.sin(0.5 * w) ** 2
        moved = np.array([ux - versine * arm[0] - s * arm[1], uy + s * arm[0] - versine * arm[1]])
        now = np.array([arm[0] * (1.0 - versine) - s * arm[1], arm[1] * (1.0 - versine) + s * arm[0]])
        return float(axis @ moved), np.array([axis[0], axis[1], -axis[0] * now[1] + axis[1] * now[0]])


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
        self.laws = law_table(assembly)
        self.dead = dead_load(assembly)
        self.pattern = problem.load.forces(assembly)
        self.mass = np.where(assembly.fixed[:, None], 0.0, assembly.mass)
        self.loads = LoadArrays(
            dead=self.dead,
            pattern=self.pattern,
            mass=self.mass,
            total=problem.load.total(assembly),
        )
        self.inverse_mass = np.where(assembly.fixed[:, None], 0.0, 1.0 / assembly.mass)
        self.scale = assembly.heaviest_weight
        #: Stiffness of a contact on a joint as large as the smallest block face [N/m].
        self.stiffest = float(self.laws[:, joint.KN].max()) * block_size(assembly)
        self.extent = np.maximum(self.detector.extent, 1e-12)
        pose = assembly.rest_pose()
        pairs = self.detector.pairs(pose)
        self.workspace = Workspace(pairs, assembly.fixed, assembly.n_dof)
        n_slots = 2 * len(pairs.a)
        slots = empty_slots(len(pairs.a))
        self.detector.fill(pairs, pose, slots)
        state = EquilibriumState(
            pose=pose,
            multiplier=0.0,
            pairs=pairs,
            slots=slots,
            history=np.zeros((n_slots, N_HISTORY)),
            reaction=np.zeros((n_slots, 2)),
            status=np.zeros(n_slots, np.int64),
            last_increment=np.zeros_like(pose),
            last_multiplier_change=0.0,
            last_length=0.0,
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
            travelled += outcome.motion
            if h >= limit and outcome.inertia_ratio < self.settings.inertia_limit:
                return replace(new, last_increment=np.zeros_like(new.pose)), outcome
            if travelled > block_size(self.problem.assembly):
                state = new
                break
            state = new
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

    # The step

    def step(self, state: EquilibriumState, demand: Demand) -> tuple[EquilibriumState, StepReport]:
        """One implicit step from rest; see `Engine.step`."""
        state = self._refresh(state)
        pace = self._pace(state, demand)
        h = demand.time_step or self.settings.static_time_step
        x, multiplier = self._predict(state, demand, pace)
        start_length = np.where(state.slots.kind != narrow.NONE, state.slots.length, 0.0)
        work = self.workspace
        weight = 1.0 / h**2
        largest = self.settings.max_motion * self.detector.reach
        reach = max(3.0 * abs(demand.increment or 0.0), 0.02 * self.detector.reach)
        damping = 0.0
        stuck = np.zeros(len(work.held), np.bool_)
        last_sense = np.where(
            state.status == SLIDING, np.sign(state.reaction[:, 1]), 0.0
        )
        reason = f"no equilibrium within {self.settings.max_iterations} iterations"
        converged, residual = False, np.inf
        before = state.slots
        joint.slip_gradients(
            before.kind, before.normal, before.arm_a, before.arm_b, before.roll, before.ratio,
            work.start_slip,
        )  # fmt: skip
        self._follow(state, before)
        rounds = 0
        # The extrapolated shear of a stiff joint tells nothing of its cone: what stuck in the last
        # step is taken to stick until the first correction has been made.
        work.held[:] = state.status == STICKING
        self._evaluate(state, x, multiplier, weight, start_length)
        iteration = 0
        for iteration in range(1, self.settings.max_iterations + 1):
            residual = self._residual(work.force)
            merit = self._merit()
            value, gradient = pace.value_and_gradient(x) if pace else (0.0, np.zeros(3))
            lag = pace.increment - value if pace else 0.0
            balanced = residual <= self.settings.tolerance and abs(lag) <= 1e-12
            if balanced and not work.held.any():
                self.detector.fill(state.pairs, state.pose + x, work.found)
                depth = 1e-3 * self.settings.tolerance * self.scale / self.stiffest
                converged = rounds == 3 or not narrow.changed_contacts(
                    work.slots, work.found, depth
                )
                if converged:
                    break
                rounds += 1
                self._follow(state, work.found)
                self._evaluate(state, x, multiplier, weight, start_length)
                merit = self._merit()
            base_x, base_m = x, multiplier
            sense = self._sense()
            if iteration == 1:
                merit = np.inf  # the increment itself unbalances the blocks
            held = np.zeros_like(work.held)
            # Contacts that have just left their cone, and by how much; and those that have turned
            # from sliding one way to the other, past the narrow band in which they stick.
            released = np.where(stuck & (work.status == SLIDING), work.excess, 0.0)
            turned = sense * last_sense < 0
            stuck, last_sense = work.status == STICKING, sense
            better = False
            stale = False
            for _ in range(self.settings.max_attempts):
                if stale:
                    work.held[:] = held
                    self._evaluate(state, base_x, base_m, weight, start_length)
                try:
                    direction, dm = self._direction(pace, gradient, lag, weight + damping)
                except SingularMatrixError:
                    damping = max(16.0 * damping, GRAVITY / reach)
                    stale = False
                    continue
                if self.detector.motion(direction).max() > reach:
                    stale = False
                    if turned.any():
                        held |= turned
                        turned = np.zeros_like(turned)
                        stale = True
                        continue
                    if np.count_nonzero(released) > 1:
                        # Letting go all at once sets a part free: keep but the worst.
                        keep = (released > 0.0) & (released < 0.5 * released.max())
                        if not keep.any():
                            keep = (released > 0.0) & (released < released.max())
                        held |= keep
                        released[keep] = 0.0
                        stale = keep.any()
                        if stale:
                            continue
                    damping = max(16.0 * damping, GRAVITY / reach)
                    continue
                work.held[:] = False
                stale = True
                x, multiplier = base_x + direction, base_m + dm
                self._evaluate(state, x, multiplier, weight, start_length)
                if self._merit() <= merit and np.isfinite(self._merit()):
                    better = True
                    damping = damping / 16.0 if damping > GRAVITY / reach else 0.0
                    break
                skipped = (sense * self._sense() < 0) & ~held
                if skipped.any():
                    held |= skipped
                    continue
                for length in (0.5, 0.25):
                    x, multiplier = base_x + length * direction, base_m + length * dm
                    self._evaluate(state, x, multiplier, weight, start_length)
                    if self._merit() <= merit:
                        better = True
                        break
                if better:
                    break
                damping = max(16.0 * damping, GRAVITY / reach)
            if not better:
                reason = "no direction leads nearer to equilibrium"
                break
            if self.detector.motion(x).max() > largest:
                reason = "a block moves too far in one step"
                break
        if not converged:
            return state, StepReport(converged=False, reason=reason, n_iterations=iteration)
        return self._accept(state, x, multiplier, h, residual, iteration, pace)

    def _follow(self, state: EquilibriumState, slots: Slots) -> None:
        """Take over the features of these contacts, and whose history each goes on with."""
        work, before = self.workspace, state.slots
        for mine, theirs in zip(work.known, slots, strict=True):
            mine[:] = theirs
        narrow.carry_history(before.kind, before.feature, before.edges, work.known, work.source)

    def _refresh(self, state: EquilibriumState) -> EquilibriumState:
        """New pairs where the blocks have moved far, and the workspace that fits the state."""
        if self.detector.outdated(state.pairs, state.pose):
            pairs = self.detector.pairs(state.pose)
            row = carry(state.pairs, pairs)
            slots = empty_slots(len(pairs.a))
            self.detector.fill(pairs, state.pose, slots)
            source = np.where(row[:, None] >= 0, 2 * row[:, None] + (0, 1), -1).ravel()
            known = source >= 0
            history = np.tile(NEW_CONTACT, (len(source), 1))
            reaction = np.zeros((len(source), 2))
            status = np.full(len(source), OPEN)
            history[known] = state.history[source[known]]
            reaction[known] = state.reaction[source[known]]
            status[known] = state.status[source[known]]
            state = replace(
                state, pairs=pairs, slots=slots, history=history, reaction=reaction, status=status
            )
        if self.workspace.pairs is not state.pairs:
            self.workspace = Workspace(
                state.pairs, self.problem.assembly.fixed, self.problem.assembly.n_dof
            )
        return state

    def _pace(self, state: EquilibriumState, demand: Demand) -> Pace | None:
        if demand.increment is None:
            return None
        control = self.problem.control_point
        if demand.along == "control":
            theta = state.pose[control.block, 2]
            c, s = np.cos(theta), np.sin(theta)
            designed = control.point - self.problem.assembly.centroid[control.block]
            arm = np.array([c * designed[0] - s * designed[1], s * designed[0] + c * designed[1]])
            return Pace(
                body=control.block,
                direction=np.zeros(3),
                arm=arm,
                axis=control.direction,
                increment=demand.increment,
            )
        motion = self.detector.motion(state.last_increment)
        body = int(np.argmax(motion))
        last = state.last_increment[body]
        scaled = last * np.array([1.0, 1.0, self.extent[body] ** 2])
        return Pace(
            body=body,
            direction=scaled / np.sqrt(last @ scaled),
            arm=None,
            axis=None,
            increment=demand.increment,
        )

    def _predict(
        self, state: EquilibriumState, demand: Demand, pace: Pace | None
    ) -> tuple[Array, float]:
        """Linear extrapolation of the last step, where there was one along the same path."""
        if pace is None:
            assert demand.multiplier is not None
            return np.zeros_like(state.pose), demand.multiplier
        if state.last_length == 0.0:
            return np.zeros_like(state.pose), state.multiplier
        value, _ = pace.value_and_gradient(state.last_increment)
        if value * pace.increment <= 0.0:
            return np.zeros_like(state.pose), state.multiplier
        share = pace.increment / value
        return share * state.last_increment, state.multiplier + share * state.last_multiplier_change

    def _evaluate(
        self, state: EquilibriumState, x: Array, multiplier: float, weight: float, start: Array
    ) -> None:
        """Unbalanced forces and tangent at the increments x, into the workspace."""
        work = self.workspace
        pairs = state.pairs
        self.detector.follow(pairs, state.pose + x, work.known, work.slots)
        force = work.contact_force
        force[:] = 0.0
        for block in work.tangent:
            block[:] = 0.0
        joint.joint_forces(
            work.slots, pairs.a, pairs.b, pairs.law, self.laws,
            self.problem.assembly.thickness, start, work.start_slip, state.history, work.source, x,
            work.held, force, work.reaction, work.status, work.excess, work.state, work.tangent,
            True,
        )  # fmt: skip
        np.multiply(self.pattern, multiplier, out=work.force)
        work.force += self.dead
        work.force += force
        work.force -= self.mass * x * weight
        work.force[self.problem.assembly.fixed] = 0.0

    def _merit(self) -> float:
        return float(np.sqrt(np.sum(self.workspace.force**2 * self.inverse_mass)))

    def _sense(self) -> Array:
        work = self.workspace
        return np.where(work.status == SLIDING, np.sign(work.reaction[:, 1]), 0.0)

    def _residual(self, force: Array) -> float:
        """Largest unbalanced force, or moment over block size, over the heaviest weight."""
        largest = np.maximum(np.hypot(force[:, 0], force[:, 1]), np.abs(force[:, 2]) / self.extent)
        return float(largest.max()) / self.scale

    def _direction(
        self, pace: Pace | None, gradient: Array, lag: float, weight: float
    ) -> tuple[Array, float]:
        """Newton direction of poses and multiplier."""
        work = self.workspace
        diagonal = work.tangent.diagonal.copy()
        tangent = work.tangent._replace(diagonal=diagonal)
        n_dof = diagonal.shape[1]
        diagonal[:, range(n_dof), range(n_dof)] += self.mass * weight
        direction = np.zeros_like(self.mass)
        system = work.system
        if pace is None:
            system.scatter(system.factor(tangent)(system.gather(work.force)), direction)
            return direction, 0.0
        spring = np.abs(diagonal[pace.body]).max() / (gradient @ gradient)
        diagonal[pace.body] += spring * np.outer(gradient, gradient)
        right = work.force.copy()
        right[pace.body] += spring * lag * gradient
        both = np.column_stack((system.gather(right), system.gather(self.pattern)))
        y = system.factor(tangent)(both)
        first, second = np.zeros_like(self.mass), np.zeros_like(self.mass)
        system.scatter(np.ascontiguousarray(y[:, 0]), first)
        system.scatter(np.ascontiguousarray(y[:, 1]), second)
        along = gradient @ second[pace.body]
        if along == 0.0:
            raise SingularMatrixError
        change = (lag - gradient @ first[pace.body]) / along
        return first + change * second, float(change)

    def _accept(
        self, state: EquilibriumState, x: Array, multiplier: float, h: float,
        residual: float, iterations: int, pace: Pace | None,
    ) -> tuple[EquilibriumState, StepReport]:  # fmt: skip
        work = self.workspace
        pose = state.pose + x
        slots = Slots(*(array.copy() for array in work.found))
        source = np.zeros(len(slots.kind), np.int64)
        known = work.known
        narrow.carry_history(known.kind, known.feature, known.edges, slots, source)
        lost = source < 0
        history, reaction, status = work.state[source], work.reaction[source], work.status[source]
        history[lost] = NEW_CONTACT
        reaction[lost] = 0.0
        status[lost] = OPEN
        new = EquilibriumState(
            pose=pose,
            multiplier=multiplier,
            pairs=state.pairs,
            slots=slots,
            history=history,
            reaction=reaction,
            status=status,
            last_increment=x,
            last_multiplier_change=multiplier - state.multiplier,
            last_length=pace.increment if pace else 0.0,
        )
        outcome = report(
            self.problem,
            self.loads,
            StepOutcome(
                multiplier=multiplier,
                pose=pose,
                increment=x,
                acceleration=x / h**2,
                velocity=x / h,
                contact_force=work.contact_force.copy(),
                slots=slots,
                reaction=new.reaction,
                status=new.status,
                residual=residual * self.scale,
                motion=float(self.detector.motion(x).max()),
                n_iterations=iterations,
            ),
        )
        friction = self.laws[state.pairs.law, joint.MU].repeat(2)
        static = multiplier if pace else outcome.static_multiplier
        return new, replace(
            outcome,
            static_multiplier=static,
            friction_violation=cone_excess(new.reaction, friction) / self.scale,
            dynamic=outcome.inertia_ratio > self.settings.inertia_limit,
        )
