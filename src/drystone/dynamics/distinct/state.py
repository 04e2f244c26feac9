"""Settings of the distinct element engine, its prepared problems, and its states."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from types import ModuleType

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.language import say
from drystone.common.tolerances import (
    DISTINCT_TOLERANCE,
    LOCAL_DAMPING,
    SAFETY,
    SEARCH_TOLERANCE,
    TIES_NEARER,
)
from drystone.contact.contacts import Pairs, Slots
from drystone.contact.rows import dof_of
from drystone.dynamics.explicit import form_of
from drystone.engines.base import EngineError
from drystone.engines.prepared import Prepared
from drystone.law.bonds import built_open
from drystone.law.columns import BROKEN, N_HISTORY
from drystone.model.ties import TieState


@dataclass(frozen=True, kw_only=True)
class DistinctSettings:
    """Numerical settings."""

    safety: float = SAFETY  # time step over the critical one, -
    local_damping: float = LOCAL_DAMPING  # Cundall's, share of the unbalanced force, -
    viscous_damping: float = 0.0  # 1/s in real motion, 1/cycle in quasi-static steps
    mass_scaling: float | None = None
    """Square of the time step over the critical time step of the real masses.  Degrees of freedom
    that would be unstable get larger masses.  None: real masses if a step has a given time; else
    the limit of large scaling, in which all masses are proportional to stiffness."""
    search_tolerance: float = SEARCH_TOLERANCE
    """Motion between two searches over the smallest block size; 0 searches at every cycle."""
    tolerance: float = DISTINCT_TOLERANCE  # unbalanced force of a block at rest over its weight, -
    drive_cycles: int = 2400
    """Cycles in which an increment is driven.  With fewer, joints would stick instead of slide."""
    stage_cycles: int = 600  # of each stage at the end of the drive
    rest_cycles: int = 100_000  # after which a step that has not come to rest counts as a jump
    jump_cycles: int = 1_000_000  # largest number of cycles of the jump
    max_cycles: int = 200_000  # of a step under a given multiplier, for a given time
    max_motion: float = 2.0  # motion in a step over the size of the whole structure, -


@dataclass(frozen=True, kw_only=True, eq=False)
class DistinctPrepared(Prepared):
    """A problem with the data that cycles need."""

    @cached_property
    def dof(self) -> tuple[int, ...]:
        """See `contact.rows`."""
        dof: tuple[int, ...] = dof_of(self.assembly.mass)
        return dof

    @cached_property
    def form(self) -> ModuleType:
        """The module of the dimension, see `dynamics.explicit.form_of`."""
        return form_of(self.dof)

    @cached_property
    def span(self) -> float:
        """Size of the part of the structure that may move [m]."""
        moving = ~self.assembly.fixed
        centroid = self.assembly.centroid[moving]
        return float(np.ptp(centroid, axis=0).max() + self.extent[moving].max())


@dataclass(frozen=True, kw_only=True)
class DistinctState:
    """Poses, velocities, histories of contacts, and the energy balance."""

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
    due: IntArray  # rows of `margin` of the bonds and ties that break next
    departed: BoolArray  # (n,) blocks that have left
    ties: TieState
    support_motion: float = 0.0  # m or rad, by which supports have moved
    friction_work: float = 0.0  # J, dissipated since the start
    damping_work: float = 0.0  # J, dissipated since the start
    load_work: float = 0.0  # J, work of dead load and load pattern
    search_work: float = 0.0  # J, elastic energy of joints that searches dropped or changed


class RunAwayError(EngineError):
    """A block has moved farther than a block may move in a step."""

    def __init__(self, name: str, motion: Array) -> None:
        super().__init__(say("end.one_runs_away", block=name))
        self.motion = motion  # m, of each block, (n,)


def released(prepared: DistinctPrepared, pose: Array, velocity: Array) -> DistinctState:
    """A state in given poses (n, n_pose) and velocities (n, n_dof), without looking for
    equilibrium."""
    assembly = prepared.assembly
    pairs = prepared.detector.pairs(pose)
    slots = prepared.detector.find(pairs, pose)
    reaction = np.zeros_like(slots.normal)
    n_slots, dim = reaction.shape
    history = np.zeros((n_slots, N_HISTORY + dim - 2))
    history[built_open(slots, assembly.smallest_extent), BROKEN] = 1.0
    return DistinctState(
        prepared=prepared,
        stage=prepared.problem.stages[-1],
        pose=pose,
        velocity=velocity,
        multiplier=0.0,
        pairs=pairs,
        slots=slots,
        searched=pose.copy(),
        history=history,
        reaction=reaction,
        status=np.zeros(n_slots, np.int64),
        increment=assembly.no_motion(),
        margin=np.full(n_slots + prepared.bars.n_ties, np.inf),
        due=np.zeros(0, np.int64),
        departed=np.zeros(assembly.n_bodies, np.bool_),
        ties=prepared.bars.first(),
    )


def broken(state: DistinctState, due: IntArray) -> DistinctState:
    """The state without the bonds that are ``due``, rows of `DistinctState.margin`, and with the
    ties that are due past their events."""
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
