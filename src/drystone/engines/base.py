"""The contract between the pushover loop, the controls and the engines.

An engine makes a state from a problem, and steps it as demanded.  A control reads the report of the
step, and decides what to demand next.  Engines do not know which control they work with, nor
controls which engine.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.codec import Derived
from drystone.common.language import say
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
    """What an engine solves: blocks, loads and the control point."""

    assembly: Assembly
    load: LoadPattern
    control_point: ControlPoint
    dead_loads: tuple[DeadLoad, ...] = ()  # beside the blocks' weight
    ties: tuple[Tie, ...] = ()
    settlement: Settlement | None = None  # support displacement, in place of the load
    length: float = 1.0  # m, the unit of all lengths; for messages
    ground: float | None = None  # m, see `level`; None: the lowest point of the supports

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
    """What a control demands of one step: a multiplier, an increment, or a support displacement.

    Exactly one of the first three fields is given.  A multiplier without a time step asks for the
    state of rest under this multiplier, from engines that can find it directly.  An `increment` is
    for engines whose capabilities say ``prescribes_displacement``; the multiplier is then an
    unknown of the step.
    """

    multiplier: float | None = None
    increment: float | None = None  # m, of the control displacement
    settlement: float | None = None  # m or rad, increment of the support displacement
    over_fold: bool = False  # with `increment`: any equilibrium there, not only one on the path
    full_search: bool = True  # whether every method is tried; if not, a shorter step may follow
    time_step: float = 0.0  # s; engines of dynamic formulations need a positive one
    stop_blocks: bool = True  # whether the step starts from rest


#: Reason of a step that fails because blocks could have met that the step has not looked at.
TOO_FAR = say("end.too_far")

#: Parts into which an increment is divided while it is driven.  `StepPath.overshoot` is taken from
#: the mean multiplier of each part.
OVERSHOOT_PARTS = 10


class Fold(NamedTuple):
    """Where the path of equilibria turns back within a step."""

    share: float  # of the step
    multiplier: float
    #: Loss of the multiplier until the path passes the same share of the step again, negative for a
    #: gain; NaN if it is not known that the path passes it again.
    drop: float = math.nan


@dataclass(frozen=True, kw_only=True)
class StepPath:
    """What an engine knows of the path within a step; None, or empty, if it does not know it.

    Engines that follow the equilibria within a step know `fold`, `excess` and `bend`.
    """

    #: The fold whose share of the step the path has not passed again, or the place where the path
    #: was given up; otherwise the fold after which the multiplier dropped most.  An unstable end
    #: counts as a fold with share 1.  It is given whether or not the step converged.
    fold: Fold | None = None
    #: By how much the multiplier exceeds those at both ends, and at which share of the step.
    excess: tuple[float, float] | None = None
    #: Largest distance of the multiplier from the chord, and at which share of the step.
    bend: tuple[float, float] | None = None
    #: Largest deviation of a block from the predictor, over the farthest motion of a block.
    deviation: float | None = None
    #: For engines that move through a step: by how much the multiplier, inertia included, exceeded
    #: those at both ends, as a mean over one of `OVERSHOOT_PARTS` parts.  If the curve has no peak,
    #: the overshoot goes to zero with the length of the step.
    overshoot: float | None = None
    #: For engines that move through a step: the share of it before a part in which the multiplier
    #: rises by more than half of its rise in the step, as where a joint closes; None if none does.
    rise: float | None = None
    #: For engines that move through a step: if blocks moved far by themselves, states in motion
    #: within the step and their reports, in order.
    dynamic_states: tuple[tuple[State, StepReport], ...] = field(
        default=(), compare=False, repr=False
    )


#: The path of a step of which nothing is known.
UNTOLD = StepPath()


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """The result of one step, as every engine reports it.

    If the step failed, only `converged`, `reason`, `n_iterations`, `path.fold`,
    `path.dynamic_states` and `dynamic` count; `dynamic` then says whether blocks run away.
    """

    converged: bool
    reason: str = ""
    applied_multiplier: float = np.nan
    carried_multiplier: float = np.nan
    static_multiplier: float = np.nan
    #: Static multiplier in the poses in which the step balanced the forces: those at its start,
    #: unless the engine knows better.
    multiplier_at_start: float = np.nan
    control_displacement: float = np.nan  # m; if supports move, their displacement, m or rad
    reaction: float = 0.0  # N or N m, of supports that move, see `Problem.settlement`
    residual: float = np.nan
    penetration: float = np.nan  # m
    friction_violation: float = np.nan
    energy_ratio: float = np.nan
    inertia_ratio: float = np.nan
    acceleration: float = 0.0  # of the fastest block, over gravity
    n_open: int = 0
    n_sticking: int = 0
    n_sliding: int = 0
    #: Shear of contacts that contact detection in the step dropped, over the heaviest weight.
    lost_shear: float = 0.0
    motion: float = np.nan  # m, of the block that moved farthest
    #: Share of the demanded increment that was reached: less than one if the step ends with a bond
    #: at its strength, zero if a bond breaks.
    reached: float = 1.0
    #: Elongation of a tie that breaks, beyond that at which it does, over the latter.
    late: float = 0.0
    n_iterations: int = 0
    path: StepPath = UNTOLD  # what is known of the path to the end
    dynamic: bool = False  # whether the step ends in motion
    #: Whether the step ends at an unstable equilibrium, and no stable one was found nearby.
    unstable: bool = False


class State(Protocol):
    """Everything that evolves.  A step never changes a state in place, so that a saved state stays
    valid."""

    @property
    def pose(self) -> Array:
        """Poses of the blocks, counted from the design, (n, n_pose) [m, rad].

        Blocks that have left the structure stay in their last pose.
        """
        ...


#: The states of one engine.  Only this engine reads them.
OwnState = TypeVar("OwnState", bound=State)


@dataclass(frozen=True, kw_only=True)
class Capabilities:
    """What an engine can do; as a rule the same for all engines of a class."""

    #: Whether it can solve for the multiplier of a given increment.
    prescribes_displacement: bool = False
    #: Whether it can move supports, see `Problem.settlement`.
    moves_supports: bool = False
    #: Whether a `Demand` with a support displacement may have a time step, in which motion is
    #: followed in time.
    moves_supports_in_time: bool = False
    #: Whether it can treat rollers, and ties.
    rollers: bool = False
    ties: bool = False
    #: Whether joints may have dilatancy, cohesion and tensile strength; and how joints may yield.
    bonds: bool = False
    yielding: frozenset[Yielding] = frozenset()
    #: Whether it wants problems in the structure's own coordinates and units (see
    #: `drystone.engines.frame`), so that its tolerances may be plain numbers.
    in_own_frame: bool = False
    #: Whether `Engine.contacts` works for every state at any time, also after `Engine.close`.
    keeps_states: bool = False
    #: Whether a run can be continued from a state that was saved in a file, by another engine with
    #: the same settings, as if it had never stopped; see `Engine.derived`.
    resumes: bool = False
    #: Largest residual of its steps, over the heaviest weight.  A step that exceeds it is no point
    #: of the curve.  None: the residual is not judged.
    residual_limit: float | None = None


@dataclass(frozen=True, kw_only=True)
class PreferredSteps:
    """Steps that suit an engine; None means the default of the strategy.  A strategy uses the
    values that it needs."""

    displacement_step: float | None = None  # m, largest
    time_step: float | None = None  # s
    grow_iterations: int | None = None  # iterations of a step up to which the next one may grow


class Engine(ABC, Generic[OwnState]):
    """A formulation of rigid blocks in contact.

    An engine defines `start`, `step` and `contacts`, and has a name.  Its `capabilities` say what
    it can do beside stepping under a given multiplier.  All other methods have defaults, which suit
    an engine without the capability in question.
    """

    name: str = ""  # in results
    capabilities: Capabilities = Capabilities()
    notes: tuple[str, ...] = ()  # sentences on parts of the model that it leaves out

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
        """Bring the assembly to rest under its own weight, then under its other dead loads, stage
        by stage.

        Raises `UnstableError` if it finds no rest, and `EngineError` if the engine cannot treat the
        problem.
        """

    @abstractmethod
    def step(self, state: OwnState, demand: Demand) -> tuple[OwnState, StepReport]:
        """Take one step from ``state``; returns a new state, or ``state`` itself if the step did
        not converge."""

    @abstractmethod
    def contacts(self, state: OwnState) -> ContactForces:
        """Contact points and reactions of a state."""

    def preferred_steps(self, assembly: Assembly) -> PreferredSteps:
        """Steps that suit this engine."""
        return PreferredSteps()

    def derived(self, problem: Problem) -> tuple[Derived, ...]:
        """Objects to which the states of a problem refer, and which follow from the problem, so
        that files of states leave them out; for engines whose capabilities say ``resumes``.

        The next step must depend on the state alone, not on anything else in the engine.
        """
        return ()

    def departed(self, state: OwnState) -> BoolArray | None:
        """Blocks (n,) that have left the structure, see `engines.departure`; None if the engine
        never takes blocks out."""
        return None

    def ties_of(self, state: OwnState) -> TieState | None:
        """State of the ties, with their forces; None if the engine has no ties."""
        return None

    # Most engines open nothing, so this is no abstract method.
    def close(self) -> None:
        """Close processes and files that the engine has opened."""
