"""Settings of the distinct element engine, what it makes of a problem, and its states."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from types import ModuleType

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
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
    """Square of the time step over the critical one of the real masses; degrees of freedom that
    would be unstable become heavier.  None: real masses under a given multiplier, and the limit of
    large scaling, all masses in proportion to stiffness, where a displacement is given."""
    search_tolerance: float = SEARCH_TOLERANCE
    """Motion between two searches over the smallest block size; 0 searches at every cycle."""
    tolerance: float = DISTINCT_TOLERANCE  # unbalanced force of a block at rest over its weight, -
    drive_cycles: int = 2400
    """Cycles in which an increment is driven; with fewer, joints stick that would slide."""
    stage_cycles: int = 600  # of each stage in which the driving ends
    rest_cycles: int = 100_000  # cycles in which a step comes to rest; else it is a jump
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
    def form(self) -> ModuleType:
        """What the dimension makes of cycles, see `dynamics.explicit`."""
        return form_of(self.dof)

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
    departed: BoolArray  # (n,) blocks that have left
    ties: TieState
    support_motion: float = 0.0  # m or rad, by which supports have moved
    friction_work: float = 0.0  # J, turned to heat since the start
    damping_work: float = 0.0  # J, likewise
    load_work: float = 0.0  # J, done by dead load and pattern
    search_work: float = 0.0  # J, stored in joints that searches took away or changed


class RunAwayError(EngineError):
    """A block has moved farther than any step may move one."""

    def __init__(self, name: str, motion: Array) -> None:
        super().__init__(f'the block "{name}" runs away, and no rest is found for it')
        self.motion = motion  # m, of each block, (n,)


def released(prepared: DistinctPrepared, pose: Array, velocity: Array) -> DistinctState:
    """A state in given poses (n, n_pose) and velocities (n, n_dof), as they are."""
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
