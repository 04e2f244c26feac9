"""Memory for the cycles of one step: contacts, motion, masses and loads; and calls of cycles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array
from drystone.dynamics import explicit
from drystone.dynamics.distinct.masses import masses, search_reach
from drystone.dynamics.distinct.state import DistinctSettings, DistinctState
from drystone.dynamics.explicit import Drive, FrozenContacts, Loads, Motion
from drystone.engines.base import StepReport
from drystone.engines.measures import LoadArrays
from drystone.engines.tie_forces import TieForces


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """Limits of the motion of blocks in the cycles of a step."""

    farthest: float = np.inf  # m from the start of the step; beyond it, a block runs away
    may_lose: bool = False  # whether blocks that have left the structure are taken out
    asked: float | None = None
    """Demanded motion [m].  If blocks move by more, states in motion are stored; None: they are
    not."""


#: No limits.
UNBOUNDED = Bounds()


class Workspace:
    """Contacts, motion and masses while the cycles of one step run."""

    def __init__(
        self,
        settings: DistinctSettings,
        state: DistinctState,
        *,
        real_masses: bool,
        bounds: Bounds = UNBOUNDED,
    ) -> None:
        self.settings, self.real_masses, self.bounds = settings, real_masses, bounds
        self.prepared, self.state = state.prepared, state
        self.search_reach = search_reach(settings, state.prepared)
        #: States in motion in which blocks have moved far by themselves, and their reports.
        self.dynamic_states: list[tuple[DistinctState, StepReport]] = []
        self.noted = state.pose  # poses of the last of these states
        self.on_the_way: list[float] = []  # multipliers at the searches since then
        self.pairs = state.pairs
        self.slots = state.slots.copied()
        self.history = state.history.copy()
        self.reaction = state.reaction.copy()
        self.status = state.status.copy()
        self.searched = state.searched.copy()
        self.form = state.prepared.form
        rotations = self.form.Rotations.of(self.prepared.assembly.axes)
        self.motion = Motion.of(state.pose, state.velocity, rotations)
        self.meter = np.zeros(explicit.N_METER)
        self.meter[explicit.MULTIPLIER] = state.multiplier
        self.acting = LoadArrays.of(self.prepared.problem, state.departed, state.stage)
        self.lost = state.departed
        self.ties = TieForces(self.prepared.bars, self.prepared.assembly, state.departed)
        self.ties.begin(state.ties)
        self.search_work = 0.0
        self.lost_shear = 0.0
        self.loads: Loads
        self.n_cycles = 0
        self.n_searches = 0
        self.pack(weigh=True)

    @property
    def multiplier(self) -> float:
        """Load multiplier of the last cycle."""
        return float(self.meter[explicit.MULTIPLIER])

    @property
    def now(self) -> LoadArrays:
        """The loads near the present poses and multiplier."""
        return self.acting.near(self.motion.pose, self.multiplier)

    def travel(self, since: Array | None = None) -> Array:
        """Upper bound of the motion of each block since the step began, or ``since`` poses
        (n, n_pose), (n,) [m]; infinite if its pose is NaN."""
        pose, begin = self.motion.pose, self.state.pose if since is None else since
        finite = np.asarray(np.isfinite(pose).all(axis=1))
        known = np.where(finite[:, None], pose, begin)
        moved = self.prepared.detector.motion(self.prepared.assembly.difference(known, begin))
        return np.where(self.lost, 0.0, np.where(finite, moved, np.inf))

    def drive(
        self,
        *,
        keep_bonds: bool = False,
        guided: bool = False,
        rate: float = 0.0,
        combined: bool = False,
        tolerance: float = -1.0,
        reach: float = np.inf,
    ) -> Drive:
        """How cycles are driven, see `dynamics.explicit`."""
        s = self.settings
        return Drive(
            dt=self.dt,
            multiplier=self.multiplier,
            keep_bonds=keep_bonds,
            guided=guided,
            rate=float(rate),
            combined=combined,
            local_damping=float(s.local_damping),
            viscous_damping=float(s.viscous_damping),
            tolerance=float(tolerance),
            reach=float(reach),
            gyroscopic=self.real_masses and (s.mass_scaling or 1.0) == 1.0,
        )

    def cycle(self, n_cycles: int, drive: Drive) -> int:
        """Run cycles with the present time step and multiplier; returns why they ended."""
        drive = drive._replace(dt=self.dt, multiplier=self.multiplier)
        why, used = explicit.cycle(
            self.prepared.dof, self.contacts, self.n_contacts, self.motion, self.loads,
            self.searched, drive, n_cycles, self.meter, self.ties.arrays,
        )  # fmt: skip
        self.n_cycles += used
        return int(why)

    def cycle_once(self) -> None:
        """One cycle at the present multiplier, without a search after it."""
        self.cycle(1, self.drive())

    def unpack(self) -> None:
        """Write the present geometry, histories and reactions of contacts to the slots."""
        self.prepared.detector.follow(self.pairs, self.motion.pose, self.slots, self.slots)
        explicit.unpack(self.contacts, self.n_contacts, self.history, self.reaction, self.status)

    def gaps_before(self) -> Array:
        """Gaps of all slots at the beginning of the last cycle [m], (n_slots,)."""
        motion, prepared = self.motion, self.prepared
        before = prepared.assembly.moved(motion.pose, -self.dt * motion.velocity)
        slots = self.slots.copied()
        prepared.detector.follow(self.pairs, before, self.slots, slots)
        return np.asarray(slots.gap)

    def pack(self, *, weigh: bool) -> None:
        """Pack the contacts for cycles; with ``weigh``, also calculate masses and time step."""
        assembly, acting = self.prepared.assembly, self.acting
        n_slots, dim = self.reaction.shape
        self.contacts = FrozenContacts.empty(n_slots, dim, self.form.N_SHAPE)
        self.n_contacts = explicit.pack(
            self.form, self.slots, self.prepared.detector.narrow.bodies, self.pairs,
            self.prepared.laws, assembly.thickness, self.history, self.contacts,
        )  # fmt: skip
        self.form.place(self.motion)
        if not weigh:
            return
        self.weighed = self.motion.pose.copy()
        self.mass, self.dt = masses(
            self.settings, self.prepared, self.pairs, self.slots, self.weighed, self.history,
            real=self.real_masses, ties=self.ties,
        )  # fmt: skip
        moves = np.broadcast_to(~acting.fixed[:, None], self.mass.shape)
        inverse = np.divide(1.0, self.mass, out=np.zeros_like(self.mass), where=moves)
        self.loads = Loads(
            centroid=assembly.centroid,
            dead=acting.dead,
            pattern=acting.pattern,
            inverse_mass=inverse,
            extent=self.prepared.extent,
            weight=self.prepared.assembly.weight,
        )
