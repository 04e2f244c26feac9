"""The contract between the pushover loop, the controls and the engines.

An engine starts a state from a problem and steps it as demanded; a control reads what came of
the step and says what to demand next.  Neither knows which of the others it works with.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.codec import Derived
from drystone.contact.forces import ContactForces
from drystone.model.assembly import Assembly
from drystone.model.joint_law import Yielding
from drystone.model.loading import DeadLoad, LoadPattern, stages_of
from drystone.model.monitor import ControlPoint
from drystone.model.settlement import Settlement
from drystone.model.ties import Tie, TieState


class EngineError(Exception):
    """The engine cannot do what the model or the control asks; the message is for the user."""


class UnstableError(EngineError):
    """The structure does not stand under its own weight; the message names the blocks that move."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What an engine solves: blocks, load and the displacement that is watched."""

    assembly: Assembly
    load: LoadPattern
    control_point: ControlPoint
    dead_loads: tuple[DeadLoad, ...] = ()  # beside the blocks' weight
    ties: tuple[Tie, ...] = ()
    settlement: Settlement | None = None  # of supports that move, in place of the load
    length: float = 1.0  # m, of the unit that lengths are in; for messages
    ground: float | None = None  # m, see `level`; None: the supports' lowest point

    @property
    def stages(self) -> tuple[int, ...]:
        """See `stages_of`."""
        return stages_of(self.dead_loads)

    @property
    def level(self) -> float:
        """Height [m] below which blocks that touch nothing have left the structure."""
        if self.ground is not None:
            return self.ground
        supports = [b.vertices for b in self.assembly.blocks if b.support]
        return float(min((vertices @ self.assembly.up).min() for vertices in supports))


@dataclass(frozen=True, kw_only=True)
class Demand:
    """What a control asks of one step: a multiplier to apply, or an increment to reach.

    Exactly one of the three is given; a multiplier without a time step asks for the rest under it,
    of engines that find it so.  `increment` is for engines that say
    ``prescribes_displacement``: the multiplier is then an unknown of the step.
    """

    multiplier: float | None = None
    increment: float | None = None  # m, of the control displacement
    settlement: float | None = None  # m or rad, by which the supports of the problem move on
    over_fold: bool = False  # with `increment`: any equilibrium there, not only one on the path
    full_search: bool = True  # whether every method is tried: no shorter step follows a failure
    time_step: float = 0.0  # s; engines of dynamic formulations only need a positive one
    stop_blocks: bool = True  # start the step from rest


#: Why a step is refused: contacts that it has not looked for could have been made.
TOO_FAR = "a block moves too far in one step"

#: Parts into which an increment is divided while it is driven.  `StepPath.overshoot` is taken from
#: the mean multiplier of each part.
OVERSHOOT_PARTS = 10


class Fold(NamedTuple):
    """Where the path of equilibria turns back within a step."""

    share: float  # of the step
    multiplier: float
    #: What the multiplier loses until the path passes the same share of the step again, negative
    #: where it gains; not a number where it is not known to pass it.
    drop: float = math.nan


@dataclass(frozen=True, kw_only=True)
class StepPath:
    """What some engines know of the path within a step; None, or empty, where one does not.

    Engines that follow the equilibria within a step know `fold`, `excess` and `bend`.
    """

    #: The fold of the path that it has not passed again, or the place where it was given up; or
    #: else the fold after which the multiplier dropped most.  An unstable end is one, too, with
    #: share 1.  It is told whether or not the step converged.
    fold: Fold | None = None
    #: By how much the multiplier exceeds both ends of the step, and at which share of the step.
    excess: tuple[float, float] | None = None
    #: How far the multiplier bends from its chord, and at which share of the step it does so most.
    bend: tuple[float, float] | None = None
    #: Largest deviation of a block from the predictor, over the farthest motion of a block.
    deviation: float | None = None
    #: Of engines that move through a step: by how much the multiplier, inertia included, exceeded
    #: both ends, in the mean of one of `OVERSHOOT_PARTS` parts.  Where the curve has no peak, the
    #: overshoot goes to zero with the step.
    overshoot: float | None = None
    #: Of engines that move through a step: where blocks moved far by themselves, states in motion
    #: within the step and their reports, in order.
    dynamic_states: tuple[tuple[State, StepReport], ...] = field(
        default=(), compare=False, repr=False
    )


#: The path of a step of which nothing is known.
UNTOLD = StepPath()


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """What came of one step: what every engine tells.

    Of one that failed, only `converged`, `reason`, `n_iterations`, and of its `path` `fold` and
    `dynamic_states` count, and `dynamic`, which is then whether blocks run away.
    """

    converged: bool
    reason: str = ""
    applied_multiplier: float = np.nan
    carried_multiplier: float = np.nan
    static_multiplier: float = np.nan
    #: Static multiplier in the poses in which the step found its balance: those of its start for
    #: engines that do not know better.
    multiplier_at_start: float = np.nan
    control_displacement: float = np.nan  # m; of supports that move how far they went, m or rad
    reaction: float = 0.0  # N or N m, of supports that move, see `settlement`
    residual: float = np.nan
    penetration: float = np.nan  # m
    friction_violation: float = np.nan
    energy_ratio: float = np.nan
    inertia_ratio: float = np.nan
    acceleration: float = 0.0  # of the fastest block, over gravity: what it lacks of its balance
    n_open: int = 0
    n_sticking: int = 0
    n_sliding: int = 0
    #: Over the heaviest weight: shear of contacts that searches within the step took away.
    lost_shear: float = 0.0
    motion: float = np.nan  # m
    #: Share of the demanded increment that was reached: less than one where the step ends with a
    #: bond at its strength, zero where one breaks.
    reached: float = 1.0
    n_iterations: int = 0
    path: StepPath = UNTOLD  # what is known of how it came there
    dynamic: bool = False
    #: Whether the step ends at an unstable equilibrium, and no stable one was found nearby.
    unstable: bool = False


class State(Protocol):
    """Everything that evolves.  Never changed in place by a step: a saved state stays good."""

    @property
    def pose(self) -> Array:
        """Displacements of the blocks from their designed places, (n, n_dof) [m, rad].

        Of blocks that have left the structure: where they were last.
        """
        ...


#: The states of one engine, which only it looks into.
OwnState = TypeVar("OwnState", bound=State)


@dataclass(frozen=True, kw_only=True)
class Capabilities:
    """What an engine can do, and what it keeps; as a rule one record of a whole class."""

    #: Whether it can solve for the multiplier of a given increment.
    prescribes_displacement: bool = False
    #: Whether it can move supports, see `Problem.settlement`.
    moves_supports: bool = False
    #: Whether a `Demand` for them may have a time step, in which what moves is followed in time.
    moves_supports_in_time: bool = False
    #: Whether it has supports that are restrained in some directions only, and ties.
    rollers: bool = False
    ties: bool = False
    #: Whether joints may have dilatancy, cohesion and tensile strength; and how joints may yield.
    bonds: bool = False
    yielding: frozenset[Yielding] = frozenset()
    #: Whether it is given problems in the structure's own coordinates and units (see
    #: `drystone.engines.frame`), so that its tolerances may be numbers.
    in_own_frame: bool = False
    #: Whether contacts can be asked for of every state at any time, also once it is closed.
    keeps_states: bool = False
    #: Whether a run goes on from a state that was kept in a file, by another engine of the same
    #: settings, as if it had never stopped; see `Engine.derived`.
    resumes: bool = False
    #: Residual, over the heaviest weight, that its steps keep: what exceeds it is no point of the
    #: curve.  None: it is not judged.
    residual_limit: float | None = None


@dataclass(frozen=True, kw_only=True)
class PreferredSteps:
    """Steps that suit an engine; None where the common ones do.  A strategy uses what it needs."""

    displacement_step: float | None = None  # m, longest
    time_step: float | None = None  # s
    grow_iterations: int | None = None  # of a step, up to which the next one may grow


class Engine(ABC, Generic[OwnState]):
    """A formulation of rigid blocks in contact: `start`, `step` and `contacts`, and a name.

    What it can do beside stepping under a given multiplier its `capabilities` say.  All other
    methods have defaults, which suit an engine that knows nothing of their subject.
    """

    name: str = ""  # in results
    capabilities: Capabilities = Capabilities()
    notes: tuple[str, ...] = ()  # sentences on what of the model it leaves out

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        for key in fields(Capabilities):
            if key.name in vars(cls):
                raise TypeError(
                    f"{cls.__name__}.{key.name}: say it in the class's capabilities, "
                    f"capabilities = Capabilities({key.name}=...)"
                )

    @abstractmethod
    def start(self, problem: Problem) -> tuple[OwnState, StepReport]:
        """Bring the assembly to rest under its own weight, then stage after stage of its other dead
        loads; raises `UnstableError`."""

    @abstractmethod
    def step(self, state: OwnState, demand: Demand) -> tuple[OwnState, StepReport]:
        """One step from `state`; returns a new state, or `state` itself when not converged."""

    @abstractmethod
    def contacts(self, state: OwnState) -> ContactForces:
        """Contact points and reactions of a state."""

    def preferred_steps(self, assembly: Assembly) -> PreferredSteps:
        """Steps that suit this engine."""
        return PreferredSteps()

    def derived(self, problem: Problem) -> tuple[Derived, ...]:
        """What the states of a problem refer to and files leave out, because it follows from the
        problem; of engines that say ``resumes``.

        The next step must depend on the state alone, not on what the engine keeps beside it.
        """
        return ()

    def departed(self, state: OwnState) -> BoolArray | None:
        """Blocks (n,) that have left the structure, see `engines.departure`; None where the engine
        takes none out."""
        return None

    def ties_of(self, state: OwnState) -> TieState | None:
        """What the ties of a state carry; None of engines that have none."""
        return None

    # Most engines open nothing, and need not say so.
    def close(self) -> None:
        """Close what the engine has opened (processes, files)."""
