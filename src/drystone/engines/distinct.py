"""The distinct element method of Cundall for rigid blocks: UDEC's formulation.

Explicit cycles (see `kernels.explicit`): forces of springs at the contacts give accelerations,
these give velocities and poses.  Contacts are searched for only when a block has moved by more than
a tolerance since the last search; in between their features are frozen.

Under a given multiplier a step is a piece of real motion, as long as the demanded time, ended by
stopping the blocks where the demand says so.  A step of a given displacement is quasi-static: the
pattern's own displacement F.x is driven on, the multiplier being the force that this takes, then
held until all blocks are balanced.  The path there does not matter, so that masses are free: they
are taken in proportion to the stiffness that each degree of freedom feels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drystone.contact.detection import Detector, Pairs, block_size, carry, empty_slots
from drystone.contact.forces import ContactForces
from drystone.contact.law import law_table
from drystone.engines.base import Demand, EngineError, Problem, StepReport, UnstableError
from drystone.engines.measures import LoadArrays, StepOutcome, report, unstable_sentence
from drystone.kernels import explicit, narrow
from drystone.kernels.explicit import Contacts, Loads, Motion
from drystone.kernels.joint import BROKEN, N_HISTORY
from drystone.kernels.narrow import Slots
from drystone.loading import dead_load

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class DistinctSettings:
    """Numerical settings."""

    safety: float = 0.9  # time step over the critical one, -
    local_damping: float = 0.5  # Cundall's, share of the unbalanced force, -
    viscous_damping: float = 0.0  # 1/s, in proportion to mass
    mass_scaling: float | None = None
    """Square of the time step over the critical one of the real masses; degrees of freedom that
    would be unstable become heavier.  None: real masses under a given multiplier, all masses in
    proportion to stiffness (the limit of large scaling) where a displacement is given."""
    search_tolerance: float = 2e-3  # motion between two searches over the smallest block size, -
    tolerance: float = 1e-4  # unbalanced force at rest over the heaviest weight, -
    drive_cycles: int = 600  # in which an increment is driven
    max_cycles: int = 200_000  # of one step
    max_motion: float = 0.1  # motion in one quasi-static step over the smallest block size, -


@dataclass(frozen=True, kw_only=True)
class DistinctState:
    """Poses, velocities and what the contacts remember."""

    pose: Array  # (n, n_dof) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s
    multiplier: float
    pairs: Pairs
    slots: Slots  # features of the last search, geometry in `pose`
    searched: Array  # (n, n_dof) poses at the last search
    history: Array  # (n_slots, N_HISTORY)
    reaction: Array  # (n_slots, dim) N
    status: IntArray  # (n_slots,)
    increment: Array  # (n, n_dof) of the last step
    friction_work: float = 0.0  # J, since the start
    damping_work: float = 0.0  # J
    load_work: float = 0.0  # J
    search_work: float = 0.0  # J, energy of joints that searches took away


class Workspace:
    """Contacts, motion and masses while the cycles of one step run."""

    def __init__(self, engine: DistinctEngine, state: DistinctState, real_masses: bool) -> None:
        self.engine = engine
        self.real_masses = real_masses
        self.pairs = state.pairs
        self.slots = Slots(*(array.copy() for array in state.slots))
        self.history = state.history.copy()
        self.reaction = state.reaction.copy()
        self.status = state.status.copy()
        self.searched = state.searched.copy()
        self.motion = Motion(
            pose=state.pose.copy(),
            velocity=state.velocity.copy(),
            turn=np.zeros((len(state.pose), 2)),
            force=np.zeros_like(state.pose),
            mean=np.zeros_like(state.pose),
        )
        self.meter = np.zeros(explicit.N_METER)
        self.meter[explicit.MULTIPLIER] = state.multiplier
        self.search_work = 0.0
        self.n_cycles = 0
        self.n_searches = 0
        self._pack()

    def run(
        self, n_cycles: int, *, guided: bool = False, rate: float = 0.0, tolerance: float = -1.0
    ) -> int:
        """Cycles with searches between them, until `DONE` or `BALANCED`."""
        engine, s = self.engine, self.engine.settings
        left = n_cycles
        while True:
            code, used = explicit.cycle(
                self.contacts, self.n_contacts, self.motion, self.loads, self.searched, self.dt,
                left, self.meter[explicit.MULTIPLIER], guided, rate, s.local_damping,
                s.viscous_damping, tolerance, engine.search_reach, self.meter,
            )  # fmt: skip
            left -= used
            self.n_cycles += used
            if code == explicit.MOVED:
                self.search()
            if code == explicit.BALANCED or left <= 0:
                return int(code)

    def search(self) -> None:
        """Find all contacts anew; those that persist keep their history."""
        engine = self.engine
        pose = self.motion.pose
        if not np.isfinite(pose).all():
            raise EngineError("the cycles became unstable: lower the safety factor")
        before = explicit.elastic_energy(self.contacts, self.n_contacts)
        self.unpack()
        if engine.detector.outdated(self.pairs, pose):
            pairs = engine.detector.pairs(pose)
            row = carry(self.pairs, pairs)
            source = np.where(row[:, None] >= 0, 2 * row[:, None] + (0, 1), -1).ravel()
            known = source >= 0
            found = empty_slots(len(pairs.a))
            for new, old in zip(found, self.slots, strict=True):
                new[known] = old[source[known]]
            self.slots = found
            history = np.zeros((len(source), N_HISTORY))
            history[known] = self.history[source[known]]
            self.pairs, self.history = pairs, history
            self.reaction = np.zeros((len(source), 2))
            self.status = np.zeros(len(source), np.int64)
        old = self.slots
        slots = empty_slots(len(self.pairs.a))
        engine.detector.fill(self.pairs, pose, slots)
        source = np.zeros(len(slots.kind), np.int64)
        narrow.carry_history(old.kind, old.feature, old.edges, slots, source)
        history = np.where(source[:, None] >= 0, self.history[source], 0.0)
        history[source < 0, BROKEN] = 1.0
        self.slots, self.history = slots, history
        self.searched = pose.copy()
        self.n_searches += 1
        self._pack()
        self.search_work += before

    def unpack(self) -> None:
        """Bring slots, history and reactions up to date."""
        explicit.unpack(
            self.contacts, self.n_contacts, self.loads, self.motion, self.slots, self.pairs.a,
            self.history, self.reaction, self.status,
        )  # fmt: skip

    def _pack(self) -> None:
        engine = self.engine
        n_slots = len(self.slots.kind)
        self.contacts = Contacts(
            slot=np.zeros(n_slots, np.int64),
            edge=np.zeros(n_slots, np.int64),
            other=np.zeros(n_slots, np.int64),
            shape=np.zeros((n_slots, explicit.N_SHAPE)),
            law=np.zeros((n_slots, explicit.N_CONTACT_LAW)),
            history=np.zeros((n_slots, N_HISTORY)),
            reaction=np.zeros((n_slots, 2)),
            status=np.zeros(n_slots, np.int64),
        )
        self.n_contacts = explicit.pack(
            self.slots, engine.detector.bodies, self.pairs.a, self.pairs.b, self.pairs.law,
            engine.laws, engine.problem.assembly.thickness, self.history, self.contacts,
        )  # fmt: skip
        rotation = self.motion.pose[:, 2]
        self.motion.turn[:, 0] = np.cos(rotation)
        self.motion.turn[:, 1] = np.sin(rotation)
        self.mass, self.dt = engine.masses(self.slots, self.pairs, self.real_masses)
        movable = ~engine.problem.assembly.fixed
        inverse = np.zeros_like(self.mass)
        inverse[movable] = 1.0 / self.mass[movable]
        self.loads = Loads(
            centroid=engine.problem.assembly.centroid,
            dead=engine.loads.dead,
            pattern=engine.loads.pattern,
            inverse_mass=inverse,
            extent=engine.extent,
        )


class DistinctEngine:
    """See the module's text."""

    name = "distinct"
    prescribes_displacement = True

    def __init__(self, settings: DistinctSettings | None = None) -> None:
        self.settings = settings or DistinctSettings()

    def start(self, problem: Problem) -> tuple[DistinctState, StepReport]:
        """Settle under the dead load; raises `UnstableError`."""
        state = self.release(problem)
        work = Workspace(self, replace(state, multiplier=0.0), real_masses=False)
        limit = block_size(problem.assembly)
        for _ in range(self.settings.max_cycles // 1000):
            code = work.run(1000, tolerance=self.settings.tolerance * self.scale)
            if code == explicit.BALANCED:
                return self._arrive(state, work, static=True)
            motion = self.detector.motion(work.motion.pose)
            if motion.max() > limit:
                break
        motion = self.detector.motion(work.motion.pose)
        raise UnstableError(unstable_sentence(problem.assembly.ids, motion))

    def release(
        self, problem: Problem, pose: Array | None = None, velocity: Array | None = None
    ) -> DistinctState:
        """A state in given poses and velocities (n, n_dof), as they are: nothing settles."""
        assembly = problem.assembly
        self.problem = problem
        self.detector = Detector(assembly)
        self.laws = law_table(assembly)
        self.loads = LoadArrays(
            dead=dead_load(assembly),
            pattern=problem.load.forces(assembly),
            mass=np.where(assembly.fixed[:, None], 0.0, assembly.mass),
            total=problem.load.total(assembly),
        )
        self.extent = np.maximum(self.detector.extent, 1e-12)
        self.scale = assembly.heaviest_weight
        self.size = block_size(assembly)
        self.search_reach = self.settings.search_tolerance * self.size
        pose = assembly.rest_pose() if pose is None else np.array(pose, float)
        pairs = self.detector.pairs(pose)
        slots = empty_slots(len(pairs.a))
        self.detector.fill(pairs, pose, slots)
        n_slots = len(slots.kind)
        return DistinctState(
            pose=pose,
            velocity=np.zeros_like(pose) if velocity is None else np.array(velocity, float),
            multiplier=0.0,
            pairs=pairs,
            slots=slots,
            searched=pose.copy(),
            history=np.zeros((n_slots, N_HISTORY)),
            reaction=np.zeros((n_slots, 2)),
            status=np.zeros(n_slots, np.int64),
            increment=np.zeros_like(pose),
        )

    def masses(self, slots: Slots, pairs: Pairs, real: bool) -> tuple[Array, float]:
        """Masses (n, n_dof) and the stable time step [s] that goes with them.

        A block feels at most the stiffness B = 2 sum k h h^T of its own contacts, whatever its
        neighbours do (see `explicit.stiffness_blocks`), so that no frequency of the assembly is
        above the highest of the blocks' own, omega^2 = max eig(M^-1/2 B M^-1/2).  Undamped cycles
        are stable for dt < 2 / omega.  Where a velocity changes its sign at every cycle, local
        damping alpha makes every force (1 + alpha) times as large, hence the limit

            dt < 2 / (omega sqrt(1 + alpha))
        """
        assembly, s = self.problem.assembly, self.settings
        blocks = np.zeros((assembly.n_bodies, 3, 3))
        explicit.stiffness_blocks(
            slots, pairs.a, pairs.b, pairs.law, self.laws, assembly.thickness,
            3.0 * self.search_reach, blocks,
        )  # fmt: skip
        blocks *= (1.0 + s.local_damping) / s.safety**2
        movable = ~assembly.fixed
        mass = assembly.mass.copy()
        scaling = s.mass_scaling or (1.0 if real else np.inf)
        # A block without contacts has no frequency; a soft spring stands for those it may meet.
        least = 1e-3 * np.einsum("nii->ni", blocks)[movable].max(axis=0)
        needed = np.maximum(np.einsum("nii->ni", blocks), least)
        needed *= self._eigenvalue(blocks, needed)[:, None]
        if np.isinf(scaling):
            # The masses for which a time step of one is stable.
            return 0.25 * needed, 1.0
        omega2 = self._eigenvalue(blocks, mass)[movable].max()
        dt = 2.0 * np.sqrt(scaling / omega2) if omega2 > 0.0 else 1e-3
        if scaling > 1.0:
            mass = np.maximum(mass, 0.25 * needed * dt**2)
        return mass, dt

    def _eigenvalue(self, blocks: Array, mass: Array) -> Array:
        """Highest eigenvalue of each M^-1/2 B M^-1/2, (n,)."""
        root = 1.0 / np.sqrt(mass)
        return np.linalg.eigvalsh(blocks * root[:, :, None] * root[:, None, :])[:, -1]

    def step(self, state: DistinctState, demand: Demand) -> tuple[DistinctState, StepReport]:
        """Cycles from `state`; see `Engine.step`."""
        if demand.stop_blocks or demand.increment is not None:
            state = replace(state, velocity=np.zeros_like(state.velocity))
        if demand.increment is not None:
            return self._relax(state, demand.increment)
        if demand.multiplier is None or not demand.time_step > 0.0:
            raise ValueError("a step needs an increment, or a multiplier and a time step")
        return self._move(state, demand.multiplier, demand.time_step, demand.stop_blocks)

    def _relax(
        self, state: DistinctState, increment: float
    ) -> tuple[DistinctState, StepReport]:
        """Drive the control displacement on by an increment, then hold and balance."""
        s, problem = self.settings, self.problem
        control, assembly = problem.control_point, problem.assembly
        work = Workspace(self, state, real_masses=False)
        motion = work.motion
        begin = control.displacement(assembly, state.pose)
        pattern = self.loads.pattern
        # The course of the last step goes on: its motion, at the pace of this increment.
        ahead = state.increment
        reached = control.displacement(assembly, state.pose) - control.displacement(
            assembly, state.pose - ahead
        )
        pushed = float(np.sum(pattern * ahead))
        if reached * increment > 0.0 and pushed * increment > 0.0:
            share = increment / reached / s.drive_cycles / work.dt
            share = min(
                share, 2.0 * abs(increment) / self.detector.motion(ahead).max() / s.drive_cycles / work.dt
            )
            motion.velocity[:] = share * ahead
            rate = share * pushed
        else:
            rate = 0.5 * self.loads.total * increment / s.drive_cycles / work.dt
        farthest = 3.0 * abs(increment)
        for _ in range(100):
            work.run(max(s.drive_cycles // 10, 1), guided=True, rate=rate)
            gone = control.displacement(assembly, motion.pose) - begin
            if gone / increment > 0.95:
                break
            if self.detector.motion(motion.pose - state.pose).max() > farthest:
                break
        motion.velocity[:] = 0.0
        for _ in range(s.max_cycles // 1000):
            code = work.run(1000, guided=True, tolerance=s.tolerance * self.scale)
            if code == explicit.BALANCED:
                return self._arrive(state, work, static=True)
            if self.detector.motion(motion.pose - state.pose).max() > s.max_motion * self.size:
                pass
        left = work.meter[explicit.RESIDUAL] / self.scale
        return state, StepReport(
            converged=False,
            reason=f"an unbalanced force of {left:.1e} weights is left after {work.n_cycles} cycles",
            n_iterations=work.n_cycles,
        )

    def _move(
        self, state: DistinctState, multiplier: float, time: float, stop: bool
    ) -> tuple[DistinctState, StepReport]:
        """Real motion for a given time under a given multiplier."""
        work = Workspace(self, replace(state, multiplier=multiplier), real_masses=True)
        n = max(round(time / work.dt), 2)
        work.run(n // 2)
        work.motion.mean[:] = 0.0
        work.run(n - n // 2)
        work.motion.mean[:] /= n - n // 2
        if stop:
            pass
        return self._arrive(state, work, static=False)

    def _arrive(
        self, state: DistinctState, work: Workspace, *, static: bool
    ) -> tuple[DistinctState, StepReport]:
        """The state at the end of the cycles, and its figures."""
        assembly, motion, meter = self.problem.assembly, work.motion, work.meter
        work.unpack()
        multiplier = float(meter[explicit.MULTIPLIER])
        unbalanced = motion.force if static else motion.mean
        load = self.loads.dead + multiplier * self.loads.pattern
        acceleration = np.zeros_like(unbalanced)
        velocity = np.zeros_like(unbalanced) if static else motion.velocity
        movable = ~assembly.fixed
        if not static:
            acceleration[movable] = unbalanced[movable] / assembly.mass[movable]
        increment = motion.pose - state.pose
        farthest = float(self.detector.motion(increment).max())
        new = DistinctState(
            pose=motion.pose,
            velocity=velocity,
            multiplier=multiplier,
            pairs=work.pairs,
            slots=work.slots,
            searched=work.searched,
            history=work.history,
            reaction=work.reaction,
            status=work.status,
            increment=increment,
            friction_work=state.friction_work + float(meter[explicit.FRICTION_WORK]),
            damping_work=state.damping_work + float(meter[explicit.DAMPING_WORK]),
            load_work=state.load_work + float(meter[explicit.LOAD_WORK]),
        )
        outcome = StepOutcome(
            multiplier=multiplier,
            pose=motion.pose,
            increment=increment,
            acceleration=acceleration,
            velocity=velocity,
            contact_force=unbalanced - load,
            slots=work.slots,
            reaction=work.reaction,
            status=work.status,
            residual=float(meter[explicit.RESIDUAL]),
            motion=farthest,
            n_iterations=work.n_cycles,
        )
        return new, report(self.problem, self.loads, outcome)

    def contacts(self, state: DistinctState) -> ContactForces:
        """Contact points and reactions of a state."""
        return self.detector.forces(
            state.pairs, state.pose, state.slots, state.reaction, state.status
        )

    def close(self) -> None:
        """Nothing is held."""
