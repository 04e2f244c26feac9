"""A state of one engine taken over by another: whether what the one rests on is rest for the other.

States of engines of ours hold the same: poses, pairs, contacts by their features, shears.  All are
in the structure's own frame, see `drystone.engines.frame`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.state import DistinctState
from drystone.dynamics.nscd import NscdEngine, NscdState
from drystone.engines.base import Demand
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING
from drystone.law.columns import BROKEN, MU, N_HISTORY, SHEAR
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

    def nearest(self, place: float):
        """The state whose control displacement is nearest to a place [m]."""
        length = self.kept[0].prepared.problem.length
        return min(self.kept, key=lambda s: abs(length * self.displacement(s) - place))


class KeptDistinct(KeptStates, DistinctEngine):
    """See `KeptStates`."""


class KeptEquilibrium(KeptStates, EquilibriumEngine):
    """See `KeptStates`."""


class KeptNscd(KeptStates, NscdEngine):
    """See `KeptStates`."""


#: By the engine's name.
KEPT: dict[str, type[KeptStates]] = {"distinct": KeptDistinct, "nscd": KeptNscd}


def to_equilibrium(
    begun: EquilibriumState,
    state: DistinctState | NscdState,
    multiplier: float | None = None,
) -> EquilibriumState:
    """On from another state, of the same problem, in the plane or in space.

    Parameters
    ----------
    multiplier
        Under which the state rests; that of the state where it has one.
    """
    normal, shear = state.reaction[:, 0], state.reaction[:, 1:]
    friction = begun.prepared.laws[state.pairs.law_of_slot, MU]
    # In space what slides does so under positive shear: that is its size.
    backward = (shear[:, 0] <= 0.0) & (shear.shape[1] == 1)
    # On the cone to the millionth that the other engine's rest is known to.
    sticks = np.linalg.norm(shear, axis=1) < friction * normal * (1.0 - 1e-6)
    branch = np.where(sticks, STICKING, np.where(backward, BACKWARD, FORWARD))
    if isinstance(state, NscdState):
        history = dry_history(state)
        margin = np.full(len(normal) + begun.prepared.bars.n_ties, np.inf)
        due = np.zeros(0, np.int64)
    else:
        history, margin, due = state.history, state.margin, state.due
    return EquilibriumState(
        prepared=begun.prepared,
        stage=begun.stage,
        pose=state.pose,
        multiplier=state.multiplier if multiplier is None else multiplier,
        pairs=state.pairs,
        paired_at=state.pairs.pose,
        slots=state.slots,
        history=history,
        reaction=state.reaction,
        branch=np.where(normal <= 0.0, OPEN, branch),
        last_increment=begun.prepared.assembly.no_motion(),
        margin=margin,
        due=due,
        departed=state.departed,
        ties=state.ties,
    )


def dry_history(state: NscdState) -> np.ndarray:
    """History of the contacts of an engine that has none: dry joints with the shear they carry."""
    history = np.zeros((len(state.reaction), N_HISTORY + state.reaction.shape[1] - 2))
    history[:, SHEAR:] = state.reaction[:, 1:]
    history[:, BROKEN] = 1.0
    return history


@dataclass(frozen=True, kw_only=True)
class Rest:
    """Where `equilibrium` rests near a state of another engine."""

    multiplier: float
    motion: float  # m, of the block that moves farthest to get there


def rest_near(
    kept: KeptStates,
    state: DistinctState | NscdState,
    multiplier: float,
    step: float,
    most: float,
) -> Rest | None:
    """The equilibrium that `equilibrium` finds near a state of another engine: the first whose
    multiplier differs by no more than ``most``, else the one that differs least; None where it
    finds none at rest.

    Stiff joints carry another load after the smallest displacement, so small increments come
    first.  What slides on a plateau may go on in many ways: where no increment is found, the load
    is taken back a little, and what slid then sticks.

    Parameters
    ----------
    kept
        The engine that has kept the state.
    multiplier
        Under which the state rests.
    step
        Largest increment of the control displacement [of the own frame's unit].
    """
    problem = kept.kept[0].prepared.problem
    engine = EquilibriumEngine()
    begun, _ = engine.start(problem)
    taken = to_equilibrium(begun, state, multiplier)
    demands = [
        *(Demand(increment=sense * s * step) for s in (0.01, 0.1, 1.0) for sense in (1.0, -1.0)),
        *(Demand(multiplier=multiplier - s * most) for s in (0.05, 0.25, 0.5)),
    ]
    found: list[Rest] = []
    for demand in demands:
        _, report = engine.step(taken, demand)
        if report.converged and not report.dynamic:
            motion = problem.length * report.motion
            found.append(Rest(multiplier=report.static_multiplier, motion=motion))
            if abs(found[-1].multiplier - multiplier) <= most:
                return found[-1]
    return min(found, key=lambda rest: abs(rest.multiplier - multiplier), default=None)


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
    return replace(
        engine.release(problem, state.pose),
        multiplier=multiplier,
        pairs=state.pairs,
        slots=state.slots,
        history=dry_history(state),
        reaction=state.reaction,
        status=np.zeros(len(state.status), np.int64),
        margin=np.full(len(state.reaction), np.inf),
        departed=state.departed,
    )
