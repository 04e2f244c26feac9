"""A wrapper around an engine that works in the structure's own coordinates and units.

Problems are converted to the frame of the structure.  Results are converted back to the
coordinates, units and order of blocks of the drawing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.codec import Derived
from drystone.common.records import changed
from drystone.contact.forces import ContactForces
from drystone.engines.base import Demand, Engine, PreferredSteps, Problem, State, StepReport
from drystone.engines.frame import Frame, plain
from drystone.model.assembly import Assembly
from drystone.model.ties import TieState


def framed(engine: Engine[Any]) -> Engine[Any]:
    """The engine, wrapped if its capabilities say that it works in the structure's own frame."""
    return FramedEngine(engine) if engine.capabilities.in_own_frame else engine


@dataclass(frozen=True, kw_only=True, eq=False)
class Placed(Derived):
    """The frame of a problem and the order of its blocks there, made once from the problem."""

    frame: Frame
    #: For each row within, the row outside; and the reverse.  None if the order is the same.
    order: IntArray | None
    rank: IntArray | None
    rotates: bool  # whether supports rotate in place of the load

    @property
    def motion_unit(self) -> float:
        """Unit of the supports' motion [m]; 1 if they rotate."""
        return 1.0 if self.rotates else self.frame.length


@dataclass(frozen=True, kw_only=True)
class FramedState:
    """A state of the engine within, and its poses outside."""

    placed: Placed
    own: Any  # state of the engine within
    pose: Array  # (n, n_pose) m, rad
    departed: BoolArray | None = None  # (n,) blocks that have left; None if the engine tells none


class FramedEngine(Engine[FramedState]):
    """The wrapper of the module's text.  Its contract is that of `engines.base.Engine`."""

    def __init__(self, engine: Engine[Any]) -> None:
        self.engine = engine
        self.name = engine.name
        self.capabilities = replace(engine.capabilities, in_own_frame=False)
        #: The last assembly converted: the assembly, its frame, and the assembly within.
        self.seen: tuple[Assembly, Frame, Assembly] | None = None

    def preferred_steps(self, assembly: Assembly) -> PreferredSteps:
        """See `Engine.preferred_steps`; the assembly is the one outside."""
        frame, own = self._own(assembly)
        suits = self.engine.preferred_steps(own)
        if suits.displacement_step is None:
            return suits
        return replace(suits, displacement_step=plain(frame.length * suits.displacement_step))

    def start(self, problem: Problem) -> tuple[FramedState, StepReport]:
        """See `Engine.start`."""
        placed, within = self._placed(problem)
        own, report = self.engine.start(within)
        self.notes = self.engine.notes  # `start` may have changed them
        return self._state(placed, own), self._report(placed, report)

    def derived(self, problem: Problem) -> tuple[Derived, ...]:
        """See `Engine.derived`."""
        placed, within = self._placed(problem)
        return (placed, *self.engine.derived(within))

    def _placed(self, problem: Problem) -> tuple[Placed, Problem]:
        """The frame and order for a problem, and the problem within."""
        frame, assembly = self._own(problem.assembly)
        control = frame.control_point(problem.control_point)
        order, rank = frame.order(assembly, control), None
        if (np.diff(order) != 1).any():
            rank = np.argsort(order)
            assembly = replace(assembly, blocks=tuple(assembly.blocks[i] for i in order))
            control = replace(control, block=int(rank[control.block]))
        settlement, ground = problem.settlement, problem.ground
        placed = Placed(
            frame=frame,
            order=None if rank is None else order,
            rank=rank,
            rotates=settlement is not None and settlement.rotates,
        )
        return placed, replace(
            problem,
            assembly=assembly,
            control_point=control,
            load=problem.load.in_frame(frame),
            dead_loads=tuple(load.in_frame(frame) for load in problem.dead_loads),
            ties=tuple(tie.in_frame(frame) for tie in problem.ties),
            settlement=problem.settlement and problem.settlement.in_frame(frame),
            length=frame.length,
            ground=None if ground is None else frame.height(ground),
        )

    def step(self, state: FramedState, demand: Demand) -> tuple[FramedState, StepReport]:
        """See `Engine.step`."""
        placed, increment = state.placed, demand.increment
        frame = placed.frame
        own, report = self.engine.step(
            state.own,
            changed(
                demand,
                increment=None if increment is None else plain(increment / frame.length),
                settlement=demand.settlement and plain(demand.settlement / placed.motion_unit),
                time_step=plain(demand.time_step / frame.time) if demand.time_step else 0.0,
            ),
        )
        new = state if own is state.own else self._state(placed, own)
        return new, self._report(placed, report)

    def contacts(self, state: FramedState) -> ContactForces:
        """See `Engine.contacts`."""
        placed = state.placed
        found = placed.frame.contacts_of(self.engine.contacts(state.own))
        if (order := placed.order) is None:
            return found
        return changed(found, block_a=order[found.block_a], block_b=order[found.block_b])

    def ties_of(self, state: FramedState) -> TieState | None:
        """See `Engine.ties_of`."""
        own = self.engine.ties_of(state.own)
        return None if own is None else state.placed.frame.ties_of(own)

    def departed(self, state: FramedState) -> BoolArray | None:
        """See `Engine.departed`."""
        return state.departed

    def close(self) -> None:
        """See `Engine.close`."""
        self.engine.close()

    def _own(self, assembly: Assembly) -> tuple[Frame, Assembly]:
        """The frame of an assembly, and the assembly in it; kept for the next call."""
        if self.seen is None or self.seen[0] is not assembly:
            frame = Frame.of(assembly)
            own = frame.assembly(assembly)
            self.seen = assembly, frame, own
        return self.seen[1:]

    def _state(self, placed: Placed, own: State) -> FramedState:
        pose, departed = placed.frame.pose_of(own.pose), self.engine.departed(own)
        if (rank := placed.rank) is not None:
            pose, departed = pose[rank], None if departed is None else departed[rank]
        return FramedState(placed=placed, own=own, pose=pose, departed=departed)

    def _report(self, placed: Placed, own: StepReport) -> StepReport:
        length = placed.frame.length
        lever = length if placed.rotates else 1.0  # if supports rotate, the reaction is a moment
        way = tuple(
            (self._state(placed, state), self._report(placed, report))
            for state, report in own.path.dynamic_states
        )
        return changed(
            own,
            control_displacement=placed.motion_unit * own.control_displacement,
            reaction=placed.frame.force * lever * own.reaction,
            penetration=length * own.penetration,
            motion=length * own.motion,
            path=changed(own.path, dynamic_states=way),
        )
