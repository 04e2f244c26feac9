"""A state of one engine taken over by another: whether what the one rests on is rest for the other.

States of engines of ours hold the same: poses, pairs, contacts by their features, shears.  All are
in the structure's own frame, see `drystone.engines.frame`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.state import DistinctState
from drystone.dynamics.nscd import NscdEngine, NscdState
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING
from drystone.law.columns import BROKEN, MU, SHEAR
from drystone.statics.equilibrium import EquilibriumEngine, EquilibriumState


class KeptStates:
    """Mixed into an engine: keeps the states that steps start from, which are those accepted."""

    def __init__(self) -> None:
        super().__init__()
        self.kept: list = []

    def step(self, state, demand):
        if not self.kept or self.kept[-1] is not state:
            self.kept.append(state)
        return super().step(state, demand)

    def displacement(self, state) -> float:
        """Control displacement since the load began [of the own frame's unit]."""
        prepared = self.kept[0].prepared
        control, assembly = prepared.problem.control_point, prepared.assembly
        begin = control.displacement(assembly, self.kept[0].pose)
        return control.displacement(assembly, state.pose) - begin


class KeptDistinct(KeptStates, DistinctEngine):
    """See `KeptStates`."""


class KeptEquilibrium(KeptStates, EquilibriumEngine):
    """See `KeptStates`."""


class KeptNscd(KeptStates, NscdEngine):
    """See `KeptStates`."""


def to_equilibrium(begun: EquilibriumState, state: DistinctState) -> EquilibriumState:
    """On from another state, of the same problem."""
    normal, tangential = state.reaction.T
    friction = begun.prepared.laws[state.pairs.law_of_slot, MU]
    sliding = np.where(tangential > 0.0, FORWARD, BACKWARD)
    # On the cone to the millionth that the other engine's rest is known to.
    sticks = np.abs(tangential) < friction * normal * (1.0 - 1e-6)
    branch = np.where(sticks, STICKING, sliding)
    return EquilibriumState(
        prepared=begun.prepared,
        stage=begun.stage,
        pose=state.pose,
        multiplier=state.multiplier,
        pairs=state.pairs,
        paired_at=state.pairs.pose,
        slots=state.slots,
        history=state.history,
        reaction=state.reaction,
        branch=np.where(normal <= 0.0, OPEN, branch),
        last_increment=np.zeros_like(state.pose),
        margin=state.margin,
        due=state.due,
        departed=state.departed,
        ties=state.ties,
    )


def to_distinct(engine: DistinctEngine, problem, state: EquilibriumState) -> DistinctState:
    """For an engine that has not been started."""
    return replace(
        engine.release(problem, state.pose),
        multiplier=state.multiplier,
        pairs=state.pairs,
        slots=state.slots,
        history=state.history,
        reaction=state.reaction,
        status=np.zeros(len(state.branch), np.int64),
        increment=state.last_increment,
        margin=state.margin,
        due=state.due,
        departed=state.departed,
        ties=state.ties,
    )


def from_nscd(
    engine: DistinctEngine, problem, state: NscdState, multiplier: float
) -> DistinctState:
    """For an engine that has not been started; joints have the shear that they carry."""
    begun = engine.release(problem, state.pose)
    history = np.zeros((len(state.reaction), begun.history.shape[1]))
    history[:, SHEAR:] = state.reaction[:, 1:]
    history[:, BROKEN] = 1.0
    return replace(
        begun,
        multiplier=multiplier,
        pairs=state.pairs,
        slots=state.slots,
        history=history,
        reaction=state.reaction,
        status=np.zeros(len(state.status), np.int64),
        margin=np.full(len(state.reaction), np.inf),
        departed=state.departed,
    )
