"""The distinct element method of Cundall for rigid blocks: UDEC's formulation.

Explicit cycles (see `dynamics.explicit`): springs at the contacts give forces, these accelerations,
these velocities and poses.  Contacts are searched for only when a block has moved by more than a
tolerance since the last search; in between their features are frozen.

Under a given multiplier a step is a piece of real motion, as long as the demanded time.  A step of
a given displacement is quasi-static: the work-conjugate displacement F.x of the load pattern is
driven on, the multiplier being the force that this takes, then held until all blocks are balanced.
Motion and inertia on the way there mean nothing, so that masses are free: each degree of freedom
gets one in proportion to the stiffness that it feels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    EDGE_A,
    EDGE_B,
    NONE,
    SHIFT,
    SLOT,
    Pairs,
    Slots,
)
from drystone.contact.forces import ContactForces
from drystone.contact.histories import Histories, handed_on
from drystone.contact.rows import OF_GAP, dof_of
from drystone.dynamics import explicit
from drystone.dynamics.explicit import Drive, FrozenContacts, Loads, Motion
from drystone.engines.base import (
    CREST_PARTS,
    Capabilities,
    Demand,
    Engine,
    EngineError,
    Pacing,
    Problem,
    StepPath,
    StepReport,
    UnstableError,
)
from drystone.engines.bonds import SLIGHT, BondSteps
from drystone.engines.departure import departing
from drystone.engines.measures import (
    LoadArrays,
    StepOutcome,
    not_crushed,
    report,
    unstable_sentence,
)
from drystone.engines.prepared import Prepared
from drystone.law.bonds import apart, margins, weakest
from drystone.law.certificate import Forces, JudgedContacts, certify
from drystone.law.columns import (
    BROKEN,
    COHESION,
    COHESIVE,
    DILATION,
    KN,
    KS,
    N_HISTORY,
    PULLS,
    SHEAR,
    TENSION,
)
from drystone.law.residual import add_contact_forces
from drystone.model.assembly import Assembly
from drystone.model.joint_law import Yielding
from drystone.model.tie_kernels import PRETENSION
from drystone.model.ties import TieState
from drystone.statics.tie_forces import TieForces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Number = TypeVar("Number", np.float64, np.int64)

#: Time step [s] of blocks that nothing is near to.
FREE_TIME_STEP = 1e-3

#: Open joints count for the time step of quasi-static cycles up to three times this share of the
#: smallest block size, or of what blocks may move between two searches.
WATCHED = 1e-3

#: Parts in which the dead load comes: each shakes the structure by as little.
RAMP = 100

#: Most cycles of one call, which nothing interrupts; and where loads change with places.
ROUND, SHORT_ROUND = 1000, 100

#: Stages in which a driven increment ends, and the rate of each over that of the one before.
STAGES, SLOWER = 4, 0.25

#: Motion of any point of a block, over that of the control point which a step asks for, from which
#: on the increment does not measure it: the block moves by itself.
BY_ITSELF = 3.0

#: What a block moves by itself between two points, over its smallest extent.  Steps of the default
#: length are jumps from there on (`snap_motion` times `displacement_step`), and a block that
#: collapses, by half of its extent, is seen to within a fifth of that.
BETWEEN_POINTS = 0.1

#: How well a reaction is known at rest, over the unbalanced force: blocks in a row lean on each
#: other with what is left of several.
NOISE = 5.0

#: Margin of a bond at which a step ends for it: each try is a relaxation.
AT_STRENGTH = 1e-3

#: How many times nearer to its strength a step ends for a tie, whose force rest tells better.
TIES_NEARER = 20.0


@dataclass(frozen=True, kw_only=True)
class DistinctSettings:
    """Numerical settings."""

    safety: float = 0.9  # time step over the critical one, -
    local_damping: float = 0.5  # Cundall's, share of the unbalanced force, -
    viscous_damping: float = 0.0  # 1/s in real motion, 1/cycle in quasi-static steps
    mass_scaling: float | None = None
    """Square of the time step over the critical one of the real masses; degrees of freedom that
    would be unstable become heavier.  None: real masses under a given multiplier, and the limit of
    large scaling, all masses in proportion to stiffness, where a displacement is given."""
    search_tolerance: float = 2e-3
    """Motion between two searches over the smallest block size; 0 searches at every cycle."""
    tolerance: float = 1e-5  # unbalanced force at rest over the heaviest weight, -
    drive_cycles: int = 2400
    """In which an increment is driven; in fewer, joints come to stick that would slide."""
    stage_cycles: int = 600  # of each stage in which the driving ends
    hold_cycles: int = 100_000  # in which steps come to rest; what does not is a jump
    jump_cycles: int = 1_000_000  # most cycles from there on
    max_cycles: int = 200_000  # of a step under a given multiplier, for a given time
    max_motion: float = 2.0  # motion in a step over the size of the whole structure, -


@dataclass(frozen=True, kw_only=True, eq=False)
class DistinctPrepared(Prepared):
    """A problem with what cycles need of it."""

    @cached_property
    def dof(self) -> tuple[int, ...]:
        """See `contact.rows`."""
        dof: tuple[int, ...] = dof_of(self.assembly.mass)
        return dof

    @cached_property
    def span(self) -> float:
        """Size of what may move [m]."""
        moving = ~self.assembly.fixed
        centroid = self.assembly.centroid[moving]
        return float(np.ptp(centroid, axis=0).max() + self.extent[moving].max())


@dataclass(frozen=True, kw_only=True)
class DistinctState:
    """Poses, velocities, what the contacts remember, and the books of energy."""

    prepared: DistinctPrepared
    stage: int  # of the dead loads, see `Problem.stages`
    pose: Array  # (n, n_pose) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s, half a time step before the pose
    multiplier: float
    pairs: Pairs
    slots: Slots  # features of the last search, geometry in `pose`
    searched: Array  # (n, n_pose) poses at the last search
    history: Array  # (n_slots, N_HISTORY + dim - 2)
    reaction: Array  # (n_slots, dim) N
    status: IntArray  # (n_slots,)
    increment: Array  # (n, n_dof) of the last step
    margin: Array  # (n_slots + n_ties,) of bonds at rest, see `law.bonds`, and ties
    due: IntArray  # rows of those that break next
    gone: BoolArray  # (n,) blocks that have left
    ties: TieState
    settled: float = 0.0  # m or rad, by which supports have moved
    friction_work: float = 0.0  # J, turned to heat since the start
    damping_work: float = 0.0  # J, likewise
    load_work: float = 0.0  # J, done by dead load and pattern
    search_work: float = 0.0  # J, stored in joints that searches took away or changed


@dataclass(frozen=True, kw_only=True)
class Energy:
    """Where the work of the loads since the start has gone, in J."""

    kinetic: float
    elastic: float
    friction: float
    damping: float
    search: float
    load_work: float

    @property
    def defect(self) -> float:
        """What the books miss: an error of the time integration."""
        return self.load_work - (
            self.kinetic + self.elastic + self.friction + self.damping + self.search
        )


class RunAwayError(EngineError):
    """A block has moved farther than any step may move one."""

    def __init__(self, name: str, motion: Array) -> None:
        super().__init__(f'the block "{name}" runs away, and no rest is found for it')
        self.motion = motion  # m, of each block, (n,)


class Workspace:
    """Contacts, motion and masses while the cycles of one step run.

    Blocks may move by ``farthest`` [m] from where the step starts; beyond, `run` raises
    `RunAwayError`, unless they have left the structure and it ``may_lose`` them.  What they move by
    beyond what is ``asked`` of the step [m] is noted in `way`; None: in a step that is no step.
    """

    def __init__(
        self,
        engine: DistinctEngine,
        state: DistinctState,
        *,
        real_masses: bool,
        farthest: float = np.inf,
        may_lose: bool = False,
        asked: float | None = None,
    ) -> None:
        self.engine = engine
        self.real_masses = real_masses
        self.prepared = state.prepared
        self.state, self.begin = state, state.pose
        self.farthest, self.may_lose = farthest, may_lose
        self.search_reach = engine.search_reach(self.prepared)
        #: States in motion where blocks have gone far by themselves, and their reports.
        self.way: list[tuple[DistinctState, StepReport]] = []
        self.noted = state.pose  # of the last of them
        self.on_the_way: list[float] = []  # multipliers at the searches since
        self.between = BETWEEN_POINTS * self.prepared.assembly.extents
        self.beyond = np.inf if asked is None else BY_ITSELF * asked  # m, where the first may be
        self.pairs = state.pairs
        self.slots = state.slots.copied()
        self.history = state.history.copy()
        self.reaction = state.reaction.copy()
        self.status = state.status.copy()
        self.searched = state.searched.copy()
        self.motion = Motion.of(state.pose, state.velocity, self.prepared.assembly.axes)
        self.meter = np.zeros(explicit.N_METER)
        self.meter[explicit.MULTIPLIER] = state.multiplier
        self.acting = LoadArrays.of(self.prepared.problem, state.gone, self.state.stage)
        self.lost = state.gone
        self.ties = TieForces(self.prepared.bars, self.prepared.assembly, state.gone)
        self.ties.begin(state.ties)
        self.search_work = 0.0
        self.lost_shear = 0.0
        self.loads: Loads
        self.n_cycles = 0
        self.n_searches = 0
        self._pack(weigh=True)

    @property
    def multiplier(self) -> float:
        """Load multiplier of the last cycle."""
        return float(self.meter[explicit.MULTIPLIER])

    @property
    def now(self) -> LoadArrays:
        """The loads near the present poses and multiplier."""
        return self.acting.near(self.motion.pose, self.multiplier)

    def run(
        self,
        n_cycles: int,
        *,
        guided: bool = False,
        rate: float = 0.0,
        combined: bool = False,
        tolerance: float = -1.0,
    ) -> bool:
        """Cycles with searches between them; whether they ended because all is balanced.

        Raises `RunAwayError`.
        """
        last, steady = self.n_cycles + n_cycles, self.acting.acting.steady
        while self.n_cycles < last:
            if not steady:
                now = self.now
                self.loads = self.loads._replace(dead=now.dead, pattern=now.pattern)
            why, used = self._cycle(
                min(last - self.n_cycles, ROUND if steady else SHORT_ROUND),
                bonds_hold=not self.real_masses,
                guided=guided,
                rate=rate,
                combined=combined,
                tolerance=tolerance,
                reach=self.search_reach,
            )
            self.n_cycles += used
            if why == explicit.MOVED:
                self._note()
                self._stop_runaways()
                self.search()
            elif why == explicit.BALANCED:
                return True
        return False

    def load_gradually(self, before: LoadArrays | None) -> None:
        """Bring up the dead load from what it was ``before``, if anything, each part of it in
        cycles enough for a wave to pass.

        Ties are drawn with the weight: before it, they would draw blocks along.
        """
        whole, drawn = self.acting, self.ties.value[:, PRETENSION].copy()
        for part in range(1, RAMP):
            if before is None:
                self.ties.value[:, PRETENSION] = part / RAMP * drawn
            self.acting = whole.scaled(part / RAMP, before)
            self.loads = self.loads._replace(dead=self.acting.dead)
            self.run(max(self.engine.settings.drive_cycles // CREST_PARTS, 1))
        self.acting, self.ties.value[:, PRETENSION] = whole, drawn
        self.loads = self.loads._replace(dead=whole.dead)

    def drive(self, n_cycles: int, rate: float) -> float:
        """Guided cycles; the mean multiplier over them, from the work that it did."""
        pose, done = self.motion.pose.copy(), float(self.meter[explicit.LOAD_WORK])
        self.run(n_cycles, guided=True, rate=rate, combined=True)
        moved = self.prepared.assembly.difference(self.motion.pose, pose)
        done = float(self.meter[explicit.LOAD_WORK]) - done
        now = self.now
        pushed = float(np.sum(now.pattern * moved))
        return (done - float(np.sum(now.dead * moved))) / pushed if pushed else 0.0

    def relax(self, *, guided: bool) -> bool:
        """Cycles until all is balanced; whether they got there.  Raises `RunAwayError`.

        What does not come to rest soon moves on: it jumps to another shape, slowly at first, and
        what vibrates upon this would have local damping hold it back.  Where what presses there
        does so on faces that do not separate the blocks most any more, they come to rest again.
        """
        if not self._relaxed(guided=guided):
            return False
        if not self._others_separate():
            return True
        self.search()
        return self._relaxed(guided=guided)

    def _relaxed(self, *, guided: bool) -> bool:
        s = self.engine.settings
        tolerance = s.tolerance * self.prepared.assembly.heaviest_weight
        if self.run(s.hold_cycles, guided=guided, tolerance=tolerance):
            return True
        return self.run(s.jump_cycles, guided=guided, combined=True, tolerance=tolerance)

    def _others_separate(self) -> bool:
        """Whether blocks that press each other would do so on other faces in the present poses.

        Blocks that meet in an edge or a corner are separated alike by faces of several directions,
        and after a motion far below that between two searches by another one.
        """
        self.unpack()
        now = self.prepared.detector.find(self.pairs, self.motion.pose, self.slots)
        pair, n_pairs = self.pairs.of_slot, len(self.pairs.which)
        faces = [EDGE_A, EDGE_B]
        presses = np.flatnonzero((self.slots.kind != NONE) & (self.reaction[:, 0] > 0.0))
        used = np.flatnonzero(now.kind != NONE)
        first = np.full(n_pairs, -1, np.int64)
        first[pair[used]] = used
        then = first[pair[presses]]
        same = (self.slots.which[presses][:, faces] == now.which[then][:, faces]).all(axis=1)
        return not bool((same & (then >= 0)).all())

    def gone(self, since: Array | None = None) -> Array:
        """How far each block has moved since the step began, or since a pose [m], (n,)."""
        pose = self.motion.pose
        begin = self.begin if since is None else since
        finite = np.asarray(np.isfinite(pose).all(axis=1))
        known = np.where(finite[:, None], pose, begin)
        moved = self.prepared.detector.motion(self.prepared.assembly.difference(known, begin))
        return np.where(self.lost, 0.0, np.where(finite, moved, np.inf))

    def _note(self) -> None:
        """Keep the state, in motion, where a block has gone far by itself since the last one."""
        if np.isinf(self.beyond):
            return
        self.on_the_way.append(self.multiplier)
        far = np.maximum(self.between, 0.0 if self.way else self.beyond)
        gone = np.where(self.prepared.assembly.fixed, 0.0, self.gone(self.noted))
        if (gone > far).any() and not np.isinf(gone).any():
            self.way.append(self.engine.in_motion(self))
            self.noted = self.motion.pose.copy()
            self.on_the_way.clear()

    def _stop_runaways(self) -> None:
        gone = self.gone()
        if self.may_lose and 0.5 * self.prepared.assembly.smallest_extent < gone.max() < np.inf:
            self.let_go()
            gone = self.gone()
        if not gone.max() <= self.farthest or np.isinf(gone).any():
            name = self.prepared.assembly.ids[int(gone.argmax())]
            raise RunAwayError(name, gone)

    def cycle_once(self) -> None:
        """One cycle at the present multiplier, without a search after it."""
        self._cycle(1)
        self.n_cycles += 1

    def _cycle(
        self,
        n_cycles: int,
        *,
        bonds_hold: bool = False,
        guided: bool = False,
        rate: float = 0.0,
        combined: bool = False,
        tolerance: float = -1.0,
        reach: float = np.inf,
    ) -> tuple[int, int]:
        """Why the cycles ended, and how many there were; see `dynamics.explicit`."""
        settings = self.engine.settings
        drive = Drive(
            dt=self.dt,
            multiplier=self.multiplier,
            bonds_hold=bonds_hold,
            guided=guided,
            rate=float(rate),
            combined=combined,
            local_damping=float(settings.local_damping),
            viscous_damping=float(settings.viscous_damping),
            tolerance=float(tolerance),
            reach=float(reach),
            gyroscopic=self.real_masses and (settings.mass_scaling or 1.0) == 1.0,
        )
        why, used = explicit.cycle(
            self.prepared.dof, self.contacts, self.n_contacts, self.motion, self.loads,
            self.searched, drive, n_cycles, self.meter, self.ties.arrays,
        )  # fmt: skip
        return why, used

    def let_go(self) -> None:
        """Take out blocks that have left; the rest does not feel it."""
        pose = self.motion.pose
        self.unpack()
        left = departing(
            self.prepared.problem, self.prepared.detector, self.acting, pose, self.multiplier,
            self.pairs, self.slots, self.reaction, self.prepared.bars.whole(self.ties.ended()),
        )  # fmt: skip
        lost = self.lost | left
        if not left.any() or (lost | self.prepared.assembly.fixed).all():
            return  # where nothing would stay there is no rest to go on with
        self.lost = lost
        self.ties.lose(lost)
        self.acting = LoadArrays.of(self.prepared.problem, self.lost, self.state.stage)
        motion = self.motion
        for array in (motion.velocity, motion.force, motion.mean, motion.opposed):
            array[left] = 0.0
        self._new_pairs(self.prepared.detector.pairs(pose, self.lost))
        self._pack(weigh=True)

    def search(self) -> None:
        """Find all contacts anew; those that persist keep their history."""
        detector, pose = self.prepared.detector, self.motion.pose
        self.unpack()
        if self.real_masses:
            self.search_work += self.engine.elastic_energy(
                self.prepared, self.pairs, self.slots, self.history
            )
        if detector.outdated(self.pairs, pose):
            self._new_pairs(detector.pairs(pose, self.lost))
        slots = detector.find(self.pairs, pose, self.slots)
        old = self.slots
        past = self._past()
        heirs = handed_on(detector.narrow, past, self.pairs, slots)
        history = heirs.history
        self.lost_shear += heirs.lost(past)
        self.slots, self.history, self.searched = slots, history, pose.copy()
        if self.real_masses:
            self.search_work -= self.engine.elastic_energy(
                self.prepared, self.pairs, slots, history
            )
        self.n_searches += 1
        same = np.array_equal(old.feature, slots.feature) and np.array_equal(old.kind, slots.kind)
        since = self.prepared.assembly.difference(pose, self.weighed)
        moved = detector.farthest(since) > WATCHED * self.prepared.assembly.smallest_extent
        self._pack(weigh=moved or not same)

    def _new_pairs(self, pairs: Pairs) -> None:
        """Go over to another list of pairs, with the slots and histories of those that stay."""
        narrow = self.prepared.detector.narrow
        heirs = handed_on(narrow, self._past(), pairs, former=self.pairs)
        self.pairs, self.slots, self.history = pairs, heirs.slots, heirs.history
        self.reaction, self.status = heirs.reaction, heirs.branch

    def _past(self) -> Histories:
        return Histories.own(self.slots, self.history, self.reaction, self.status)

    def unpack(self) -> None:
        """Bring slots, histories and reactions up to date."""
        explicit.unpack(
            self.contacts, self.n_contacts, self.loads, self.motion, self.slots, self.pairs,
            self.history, self.reaction, self.status,
        )  # fmt: skip

    def gaps_before(self) -> Array:
        """Gaps of all slots where the last cycle began [m], (n_slots,)."""
        motion, assembly = self.motion, self.prepared.assembly
        pose = assembly.moved(motion.pose, -self.dt * motion.velocity)
        before, slots = Motion.of(pose, motion.velocity, assembly.axes), self.slots.copied()
        explicit.place(before)
        explicit.unpack(
            self.contacts, self.n_contacts, self.loads, before, slots, self.pairs,
            self.history.copy(), self.reaction.copy(), self.status.copy(),
        )  # fmt: skip
        return np.asarray(slots.gap)

    def _pack(self, *, weigh: bool) -> None:
        """Contacts of the slots as the cycles take them, and masses where they may have changed."""
        engine, assembly, acting = self.engine, self.prepared.assembly, self.acting
        self.contacts = FrozenContacts.empty(len(self.slots.kind), assembly.dimension)
        self.n_contacts = explicit.pack(
            self.slots, self.prepared.detector.narrow.bodies, self.pairs, self.prepared.laws,
            assembly.thickness, self.history, self.contacts,
        )  # fmt: skip
        explicit.place(self.motion)
        if not weigh:
            return
        self.weighed = self.motion.pose.copy()
        self.mass, self.dt = engine.masses(
            self.prepared,
            self.slots,
            self.pairs,
            self.motion.pose,
            self.history,
            real=self.real_masses,
            ties=self.ties,
        )
        moves = np.broadcast_to(~acting.fixed[:, None], self.mass.shape)
        inverse = np.divide(1.0, self.mass, out=np.zeros_like(self.mass), where=moves)
        self.loads = Loads(
            centroid=assembly.centroid,
            dead=acting.dead,
            pattern=acting.pattern,
            inverse_mass=inverse,
            extent=self.prepared.extent,
        )


class DistinctEngine(Engine[DistinctState]):
    """See the module's text."""

    name = "distinct"
    capabilities = Capabilities(
        ties=True,
        bonds=True,
        yielding=frozenset({Yielding.SOFTEN, Yielding.LOSE_FRICTION, Yielding.CRUSH}),
        prescribes_displacement=True,
        moves_supports=True,
        in_own_frame=True,
        keeps_states=True,
        # Rest is looked for with the forces of a cycle, its poses are those at the end of it.
        residual_limit=1e-4,
    )

    def __init__(self, settings: DistinctSettings | None = None) -> None:
        self.settings = settings or DistinctSettings()

    def pacing(self, assembly: Assembly) -> Pacing:
        """A step is easy or hard by its cycles."""
        return Pacing(
            displacement_step=0.01 * assembly.smallest_extent,
            easy_iterations=20_000,
            hard_iterations=100_000,
        )

    def start(self, problem: Problem) -> tuple[DistinctState, StepReport]:
        """Settle under the dead load; raises `UnstableError`."""
        state, before = self.release(problem), None
        for stage in problem.stages:
            state = replace(state, stage=stage)
            state, report = self._settle(state, gradually=True, before=before)
            before = LoadArrays.of(problem, state.gone, stage)
            while len(due := weakest(state.margin)):
                state, report = self._settle(self._broken(state, due))
        return state, report

    def _settle(
        self, state: DistinctState, *, gradually: bool = False, before: LoadArrays | None = None
    ) -> tuple[DistinctState, StepReport]:
        """Cycles under the dead load from rest to rest, all bonds holding.

        Where nothing rests yet the load comes gradually: put on at once, it would be overshot, and
        joints that slip in the overshoot would keep their friction.
        """
        work = Workspace(
            self, state, real_masses=False, farthest=state.prepared.assembly.smallest_extent
        )
        try:
            if gradually:
                work.load_gradually(before)
            if work.relax(guided=False):
                return self._rest(state, work)
            motion = work.gone()
        except RunAwayError as error:
            motion = error.motion
        motion = state.prepared.problem.length * motion
        raise UnstableError(unstable_sentence(state.prepared.problem, motion))

    def release(
        self, problem: Problem, pose: Array | None = None, velocity: Array | None = None
    ) -> DistinctState:
        """A state in given poses (n, n_pose) and velocities (n, n_dof), as they are."""
        prepared = DistinctPrepared.of(problem, self)
        assembly = prepared.assembly
        pose = assembly.rest_pose() if pose is None else np.array(pose, float)
        pairs = prepared.detector.pairs(pose)
        slots = prepared.detector.find(pairs, pose)
        n_slots = len(slots.kind)
        history = np.zeros((n_slots, N_HISTORY + assembly.dimension - 2))
        built_open = apart(slots, 1e-9 * assembly.smallest_extent)
        history[built_open, BROKEN] = 1.0
        return DistinctState(
            prepared=prepared,
            stage=problem.stages[-1],
            pose=pose,
            velocity=assembly.no_motion() if velocity is None else np.array(velocity, float),
            multiplier=0.0,
            pairs=pairs,
            slots=slots,
            searched=pose.copy(),
            history=history,
            reaction=np.zeros((n_slots, assembly.dimension)),
            status=np.zeros(n_slots, np.int64),
            increment=assembly.no_motion(),
            margin=np.full(n_slots + prepared.bars.n_ties, np.inf),
            due=np.zeros(0, np.int64),
            gone=np.zeros(assembly.n_bodies, np.bool_),
            ties=prepared.bars.first(),
        )

    def search_reach(self, prepared: Prepared) -> float:
        """Motion of a block between two searches [m]."""
        return self.settings.search_tolerance * prepared.assembly.smallest_extent

    def masses(
        self,
        prepared: Prepared,
        slots: Slots,
        pairs: Pairs,
        pose: Array,
        history: Array,
        *,
        real: bool,
        ties: TieForces | None = None,
    ) -> tuple[Array, float]:
        """Masses (n, n_dof) and the stable time step [s] that goes with them, of slots in a pose.

        A contact's stiffness k (h_a.x_a + h_b.x_b)^2 is at most 2 k (h_a.x_a)^2 + 2 k (h_b.x_b)^2.
        With B = 2 sum k h h^T over the contacts of one block, no frequency of the assembly is hence
        above omega^2 = max eig(M^-1/2 B M^-1/2), the highest of any block's own.  Undamped cycles
        are stable for dt < 2 / omega.  Where a velocity changes its sign at every cycle, local
        damping alpha makes every force (1 + alpha) times as large, and so

            dt < 2 / (omega sqrt(1 + alpha))

        A block that meets another and leaves it within one cycle takes energy from nowhere beyond
        sqrt(2) / omega: undamped motion with impacts wants a safety factor below 0.7.
        Contacts that are open count where they may close before the next search, and those whose
        bond is not lost wherever they are: what was torn pulls along its elastic line, k_n, and
        sticks with k_s, however far it has opened.
        """
        assembly, s = prepared.assembly, self.settings
        blocks = np.zeros((assembly.n_bodies, assembly.n_dof, assembly.n_dof))
        contacts = prepared.detector.pack(pairs, pose, slots, prepared.laws)
        between = max(self.search_reach(prepared), WATCHED * assembly.smallest_extent)
        watched = np.inf if real else 3.0 * between
        known = history[contacts.slot]
        away = slots.gap[contacts.slot] - known[:, DILATION]
        acts = (away <= watched) | self._bonded(prepared, pairs.law_of_slot[contacts.slot], known)
        explicit.stiffness_blocks(dof_of(assembly.mass), contacts, acts, blocks)
        if ties is not None and prepared.bars.n_ties:
            ties.act(pose)
            ties.add_twice(blocks)
        blocks *= 0.25 * (1.0 + s.local_damping) / s.safety**2
        scaling = s.mass_scaling or (1.0 if real else np.inf)
        needed = _needed(blocks, assembly.fixed)
        if needed is None:
            return assembly.mass, FREE_TIME_STEP
        if np.isinf(scaling):
            return needed, 1.0
        highest = _highest(blocks, assembly.mass)[~assembly.fixed].max()
        dt = float(np.sqrt(scaling / highest))
        if scaling == 1.0:
            return assembly.mass, dt
        return np.maximum(assembly.mass, needed * dt**2), dt

    def _bonded(self, prepared: Prepared, law: IntArray, history: Array) -> BoolArray:
        """Contacts (n,) whose bond is not lost, by the rows of their laws and their histories."""
        strengths = [COHESION, TENSION, COHESIVE, PULLS]
        has_bond = np.asarray((prepared.laws[:, strengths] > 0.0).any(axis=1))
        return np.asarray(has_bond[law] & (history[:, BROKEN] == 0.0))

    def elastic_energy(
        self, prepared: Prepared, pairs: Pairs, slots: Slots, history: Array
    ) -> float:
        """Energy that the joints store [J]."""
        law = prepared.laws[pairs.law_of_slot]
        area = slots.size * prepared.assembly.thickness
        overlap = history[:, DILATION] - slots.gap
        bonded = (history[:, BROKEN] == 0.0) & (law[:, TENSION] > 0.0)
        used = (slots.kind != NONE) & ((overlap > 0.0) | bonded)
        normal = law[used, KN] * area[used] * overlap[used] ** 2
        shear = np.sum(history[used, SHEAR:] ** 2, axis=1)
        shear /= law[used, KS] * area[used]
        return 0.5 * float(np.sum(normal + shear))

    def energy(self, state: DistinctState) -> Energy:
        """The books of energy at a state that came of real motion, with masses unscaled.

        Velocities are half a time step behind the pose: one cycle more, on a copy, gives those at
        half a step after it, and the shear of the joints in it.
        """
        work = Workspace(self, state, real_masses=True)
        before = work.motion.velocity.copy()
        work.cycle_once()
        k = slice(0, work.n_contacts)
        reaction, law = work.contacts.reaction[k], work.contacts.law[k]
        stiffness = law[:, [KN] + [KS] * (reaction.shape[1] - 1)]
        velocity = 0.5 * (before + work.motion.velocity)
        return Energy(
            kinetic=0.5 * float(np.sum(work.acting.mass * velocity**2)),
            elastic=0.5 * float(np.sum(reaction**2 / stiffness)),
            friction=state.friction_work + float(work.meter[explicit.FRICTION_WORK]),
            damping=state.damping_work + 0.5 * float(work.meter[explicit.DAMPING_WORK]),
            search=state.search_work,
            load_work=state.load_work,
        )

    def step(self, state: DistinctState, demand: Demand) -> tuple[DistinctState, StepReport]:
        """Cycles from `state`; see `Engine.step`."""
        if demand.settlement is not None:
            return self._follow_supports(state, demand.settlement)
        if demand.increment is not None and state.prepared.gives_way:
            return self._bond_steps(state.prepared, demand.increment).advance(state)
        if demand.increment is not None:
            return self._advance(state, demand.increment)
        if demand.multiplier is None:
            raise ValueError("a step needs an increment or a multiplier")
        state = self._broken(state, state.due)
        if demand.time_step > 0.0:
            return self._move(state, demand)
        work = self._at_rest(replace(state, multiplier=demand.multiplier))
        return self._balance(state, work, guided=False)

    def _follow_supports(
        self, state: DistinctState, amount: float
    ) -> tuple[DistinctState, StepReport]:
        """Move supports on by an amount, as far as bonds and ties allow."""
        if state.prepared.gives_way:
            return self._bond_steps(state.prepared, amount, self._settle_on).advance(state)
        return self._settle_on(state, amount)

    def _settle_on(self, state: DistinctState, amount: float) -> tuple[DistinctState, StepReport]:
        """Move supports on at a constant rate, then balance."""
        settlement = state.prepared.problem.settlement
        assert settlement is not None
        assembly, n = state.prepared.assembly, self.settings.drive_cycles
        given = settlement.increment(assembly, state.pose, state.settled + amount)
        work = self._at_rest(state, state.prepared.detector.farthest(given))
        if amount:
            rows = settlement.rows(assembly)
            work.motion.velocity[rows] = given[rows] / (n * work.dt)
            try:
                work.run(n)
            except RunAwayError as error:
                return state, _failed(str(error), work)
            work.motion.velocity[rows] = 0.0
        return self._balance(replace(state, settled=state.settled + amount), work, guided=False)

    def _bond_steps(
        self,
        prepared: Prepared,
        increment: float,
        advance: Callable[[DistinctState, float], tuple[DistinctState, StepReport]] | None = None,
    ) -> BondSteps[DistinctState]:
        go = advance or self._advance

        def solve(state: DistinctState, share: float) -> tuple[DistinctState, StepReport]:
            new, report = go(state, share * increment)
            if share == 0.0 and report.converged:  # what a break moves says nothing of what follows
                new = replace(new, increment=state.increment)
            return new, report

        return BondSteps(
            solve=solve,
            broken=self._broken,
            laws=prepared.laws,
            slight=SLIGHT * prepared.assembly.heaviest_weight,
            near=AT_STRENGTH,
            bars=prepared.bars if prepared.bars.n_ties else None,
        )

    def _broken(self, state: DistinctState, due: IntArray) -> DistinctState:
        """The state without the bonds of some slots, and past what ties were due for."""
        if not len(due):
            return state
        n_slots = len(state.reaction)
        slots = due[due < n_slots]
        if len(slots) < len(due):
            ties = state.prepared.bars.past(state.ties, due[due >= n_slots] - n_slots)
            margin = np.concatenate((state.margin[:n_slots], TIES_NEARER * ties.margin))
            state = replace(state, ties=ties, margin=margin)
        history, margin = state.history.copy(), state.margin.copy()
        history[slots, BROKEN], margin[slots] = 1.0, np.inf
        return replace(state, history=history, margin=margin, due=np.zeros(0, np.int64))

    def _at_rest(self, state: DistinctState, asked: float = 0.0) -> Workspace:
        """A workspace of quasi-static cycles, in which blocks are ``asked`` to move so far [m]."""
        at_rest = replace(state, velocity=np.zeros_like(state.velocity))
        farthest = self.settings.max_motion * state.prepared.span
        return Workspace(
            self, at_rest, real_masses=False, farthest=farthest, may_lose=True, asked=asked
        )

    def _advance(self, state: DistinctState, increment: float) -> tuple[DistinctState, StepReport]:
        """Drive the control displacement on by an increment, then hold and balance."""
        work = self._at_rest(state, abs(increment))
        crest = -np.inf
        try:
            if increment:
                crest = self._drive(state, work, increment)
        except RunAwayError as error:
            return state, _failed(str(error), work, runs_away=True)
        new, figures = self._balance(state, work, guided=True)
        excess = crest - max(state.multiplier, new.multiplier)
        crest_of_step = max(excess, 0.0) if increment else None
        return new, replace(figures, path=replace(figures.path, crest=crest_of_step))

    def _balance(
        self, state: DistinctState, work: Workspace, *, guided: bool
    ) -> tuple[DistinctState, StepReport]:
        """Cycles until all blocks rest, with F.x held where they are guided, else with the load."""
        try:
            if work.relax(guided=guided):
                return self._rest(state, work)
        except RunAwayError as error:
            return state, _failed(str(error), work, runs_away=True)
        left = work.meter[explicit.RESIDUAL] / state.prepared.assembly.heaviest_weight
        return state, _failed(
            f"an unbalanced force of {left:.1e} weights is left after {work.n_cycles} cycles", work
        )

    def _drive(self, state: DistinctState, work: Workspace, increment: float) -> float:
        """Move on at a constant rate of F.x until the control displacement is reached, then stop.

        Returns the highest multiplier on the way, of the means over its parts.

        The motion of the last step goes on at the pace of this one, so that nothing is shaken.  It
        ends in stages, each slower than the one before: joints that slide go on sliding while
        vibrations fade, and come to rest with their friction fully used.
        """
        prepared, s = state.prepared, self.settings
        control, assembly = prepared.problem.control_point, prepared.assembly
        acting, pose = work.now, work.motion.pose
        pattern = acting.pattern
        duration = s.drive_cycles * work.dt
        sense = 1.0 if acting.along @ control.direction >= 0.0 else -1.0
        begin = control.displacement(assembly, state.pose)
        last = state.increment
        came = begin - control.displacement(assembly, assembly.moved(state.pose, -last))
        pushed, rate = float(np.sum(pattern * last)), 0.0
        farthest = state.prepared.detector.farthest(last)
        onwards = came * increment > 1e-9 * farthest * abs(increment)  # else it is rounding
        if onwards and pushed * increment * sense > 0.0:
            share = min(increment / came, 2.0 * abs(increment) / farthest) / duration
            work.motion.velocity[:] = share * last
            rate = share * pushed
        else:
            rate = 0.5 * sense * acting.total * increment / duration
            for stage in range(STAGES, 0, -1):  # from rest, begin as it will end
                work.run(s.stage_cycles, guided=True, rate=rate * SLOWER**stage, combined=True)
                work.motion.velocity[:] /= SLOWER
        # For the first stage, of the increment.
        left = 1.0 - SLOWER / (1.0 - SLOWER) * s.stage_cycles / s.drive_cycles
        crest = -np.inf
        for _ in range(10 * CREST_PARTS):
            crest = max(crest, work.drive(max(s.drive_cycles // CREST_PARTS, 1), rate))
            gone = control.displacement(assembly, pose) - begin
            if gone / increment > left - 0.5 / CREST_PARTS:
                break
            moved = state.prepared.detector.farthest(assembly.difference(pose, state.pose))
            if moved > BY_ITSELF * abs(increment):
                break  # something else moves, which the increment does not measure
        for _ in range(STAGES):
            work.motion.velocity[:] *= SLOWER
            rate *= SLOWER
            work.run(s.stage_cycles, guided=True, rate=rate, combined=True)
        work.motion.velocity[:] = 0.0
        return crest

    def _move(self, state: DistinctState, demand: Demand) -> tuple[DistinctState, StepReport]:
        """Real motion for a given time under a given multiplier.

        What the supports carry, and what is unbalanced, is the mean over the second half of it:
        after the first waves, and no snapshot of a vibrating wall.
        """
        assert demand.multiplier is not None
        begin = replace(state, multiplier=demand.multiplier)
        if demand.stop_blocks:
            begin = replace(begin, velocity=np.zeros_like(state.velocity))
        work = Workspace(
            self,
            begin,
            real_masses=True,
            farthest=self.settings.max_motion * state.prepared.span,
            may_lose=True,
        )
        cycles, most = demand.time_step / work.dt, self.settings.max_cycles
        n = max(round(min(cycles, most)), 2)
        if cycles <= most:
            try:
                work.run(n // 2)
                work.motion.mean[:], work.motion.opposed[:] = 0.0, 0.0
                n -= n // 2
                work.run(n)
            except RunAwayError as error:
                return state, _failed(str(error), work)
        if not 1.5 <= cycles <= most:
            return state, _failed(
                f"a time step of {demand.time_step:.1e} s is {cycles:.1e} cycles of the distinct "
                f"engine, which takes from 2 to {most} at a time: choose another time_step",
                work,
            )
        if np.array_equal(work.searched, work.motion.pose):
            work.cycle_once()  # contacts just found anew have no reactions yet
            n += 1
        work.unpack()
        motion, loads = work.motion, work.now
        load = loads.dead + work.multiplier * loads.pattern
        contact, unbalanced = motion.mean / n - load, motion.mean / n
        forces = Forces(contact=contact, load=load, inertia=motion.opposed / n)
        contacts, _ = self._judged(work)
        return self._arrive(state, work, contacts, forces, unbalanced, motion.velocity)

    def _rest(self, state: DistinctState, work: Workspace) -> tuple[DistinctState, StepReport]:
        """The state where all is balanced and has been stopped."""
        work.unpack()
        still = np.zeros_like(state.velocity)
        contacts, contact_force = self._judged(work)
        loads = work.now
        forces = Forces(
            contact=contact_force,
            load=loads.dead + work.multiplier * loads.pattern,
            inertia=still,
        )
        new, figures = self._arrive(state, work, contacts, forces, work.motion.force, still)
        # What little is unbalanced accelerates nothing: the blocks are at rest.
        return new, replace(
            figures,
            static_multiplier=work.multiplier,
            inertia_ratio=0.0,
            path=StepPath(way=tuple(work.way)),
            dynamic=False,
        )

    def in_motion(self, work: Workspace) -> tuple[DistinctState, StepReport]:
        """A copy of the state after a cycle on the way to rest, and its figures.

        What is unbalanced in the cycle is inertia and damping.  Masses are scaled: velocities, and
        energies of motion, mean nothing.  The multiplier is a mean over the way since the last
        such state, for impacts shake that of one cycle.
        """
        work.unpack()
        motion, loads, still = work.motion, work.now, np.zeros_like(work.motion.velocity)
        contacts, _ = self._judged(work, work.gaps_before())
        load = loads.dead + work.multiplier * loads.pattern
        forces = Forces(contact=motion.force - load, load=load, inertia=motion.force)
        new, figures = self._arrive(work.state, work, contacts, forces, motion.force, still)
        since = work.prepared.assembly.difference(motion.pose, work.noted)
        moved = work.prepared.detector.farthest(np.where(work.lost[:, None], 0.0, since))
        new = replace(
            new,
            pose=new.pose.copy(),
            slots=new.slots.copied(),
            searched=new.searched.copy(),
            history=new.history.copy(),
            reaction=new.reaction.copy(),
            status=new.status.copy(),
        )
        multiplier = float(np.mean(work.on_the_way))
        return new, replace(figures, static_multiplier=multiplier, motion=moved, dynamic=True)

    def _judged(self, work: Workspace, gaps: Array | None = None) -> tuple[JudgedContacts, Array]:
        """Contacts with the reactions of the last cycle, and the forces of these on the bodies.

        The gaps are those of the poses that the cycle began with, where ``gaps`` (n_slots,) of all
        slots are not given to the first order in what it has moved; all slips have entered the
        shear.
        """
        slots, pairs, velocity = work.slots, work.pairs, work.motion.velocity
        contacts = work.prepared.detector.pack(pairs, work.motion.pose, slots, work.prepared.laws)
        k, a, b = (contacts.which[:, i] for i in (SLOT, BODY_A, BODY_B))
        force = np.zeros_like(velocity)
        history, reaction = work.history[k], work.reaction[k]
        add_contact_forces(contacts, reaction, force)
        work.ties.turn(work.motion.pose)
        work.ties.add_to(force)
        moved = work.dt * np.column_stack((velocity[a], velocity[b]))
        gap = slots.gap[k] - np.sum(contacts.rows[:, OF_GAP] * moved, axis=1)
        if gaps is not None:
            gap = gaps[k]
        if work.prepared.strengths.any:
            work.prepared.strengths.fill(
                pairs.law_of_slot[k], history, gap, slots.size[k], contacts.table
            )
            contacts.table[:, SHIFT:] *= work.prepared.assembly.thickness
        judged = JudgedContacts.with_history(contacts, gap, history, reaction, reaction[:, 1:])
        return judged, force

    def _margin(self, work: Workspace, contacts: JudgedContacts) -> Array:
        """Of the bonds, by slots, and of the ties."""
        margin = np.full(len(work.slots.kind), np.inf)
        if work.prepared.brittle:
            slack = NOISE * self.settings.tolerance * work.prepared.assembly.heaviest_weight
            margin[contacts.contacts.slot] = margins(contacts, slack)
        ties = work.ties.ended(yields=not work.real_masses)
        return np.concatenate((margin, TIES_NEARER * ties.margin))

    def _arrive(
        self,
        state: DistinctState,
        work: Workspace,
        contacts: JudgedContacts,
        forces: Forces,
        unbalanced: Array,
        velocity: Array,
    ) -> tuple[DistinctState, StepReport]:
        """The state at the end of the cycles, and its figures."""
        assembly, meter, pose = state.prepared.assembly, work.meter, work.motion.pose
        acting = work.now
        ties = work.ties.ended(yields=not work.real_masses, aged=work.real_masses)
        acceleration = np.where(acting.fixed[:, None], 0.0, unbalanced / assembly.mass)
        increment = assembly.difference(pose, state.pose)
        new = DistinctState(
            prepared=state.prepared,
            stage=state.stage,
            pose=pose,
            velocity=velocity,
            multiplier=work.multiplier,
            pairs=work.pairs,
            slots=work.slots,
            searched=work.searched,
            history=work.history,
            reaction=work.reaction,
            status=work.status,
            increment=np.where(work.lost[:, None], 0.0, increment),
            margin=self._margin(work, contacts),
            due=np.zeros(0, np.int64),
            gone=work.lost,
            ties=ties,
            settled=state.settled,
            friction_work=state.friction_work + float(meter[explicit.FRICTION_WORK]),
            damping_work=state.damping_work + float(meter[explicit.DAMPING_WORK]),
            load_work=state.load_work + float(meter[explicit.LOAD_WORK]),
            search_work=state.search_work + work.search_work,
        )
        outcome = StepOutcome(
            multiplier=work.multiplier,
            pose=pose,
            increment=increment,
            acceleration=acceleration,
            velocity=velocity,
            contact_force=forces.contact,
            slots=not_crushed(work.slots, work.history)
            if state.prepared.strengths.any
            else work.slots,
            status=work.status,
            certificate=work.ties.marked(
                certify(contacts, forces, state.prepared.extent, acting.fixed)
            ),
            motion=state.prepared.detector.farthest(increment),
            n_iterations=work.n_cycles,
            settled=state.settled,
        )
        figures = report(state.prepared.problem, acting, outcome)
        return new, replace(
            figures, lost_shear=work.lost_shear / state.prepared.assembly.heaviest_weight
        )

    def gone_of(self, state: DistinctState) -> BoolArray:
        """Blocks (n,) that have left."""
        return state.gone

    def ties_of(self, state: DistinctState) -> TieState:
        """What the ties of a state carry."""
        return state.ties

    def contacts(self, state: DistinctState) -> ContactForces:
        """Contact points and reactions of a state."""
        return state.prepared.detector.forces(
            state.pairs, state.pose, state.slots, state.reaction, state.status
        )


def _failed(reason: str, work: Workspace, *, runs_away: bool = False) -> StepReport:
    return StepReport(
        converged=False,
        reason=reason,
        n_iterations=work.n_cycles,
        path=StepPath(way=tuple(work.way)),
        dynamic=runs_away,
    )


def _needed(blocks: Array, fixed: NDArray[np.bool_]) -> Array | None:
    """Masses for which a time step of one is stable, (n, n_dof); None where no block is touched.

    A block that touches nothing gets the largest: it falls as slowly as the stiffest block moves,
    and is caught where it lands.
    """
    stiffness = np.einsum("nii->ni", blocks)
    touched = stiffness.any(axis=1) & ~fixed
    if not touched.any():
        return None
    needed = np.maximum(stiffness, 1e-3 * stiffness[~fixed].max(axis=0) + 1e-30)
    needed *= _highest(blocks, needed)[:, None]
    needed[~touched] = needed[touched].max(axis=0)
    return np.asarray(needed, dtype=np.float64)


def _highest(blocks: Array, mass: Array) -> Array:
    """Highest eigenvalue of each M^-1/2 B M^-1/2, (n,) [1/s2]."""
    root = 1.0 / np.sqrt(mass)
    values = np.linalg.eigvalsh(blocks * root[:, :, None] * root[:, None, :])
    return np.asarray(values[:, -1], dtype=np.float64)
