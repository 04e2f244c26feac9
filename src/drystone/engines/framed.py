"""An engine that works in the structure's own coordinates and units, seen from outside.

Problems are taken to the frame, results back to the coordinates, units and order of the drawing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drystone.common.records import changed
from drystone.contact.forces import ContactForces
from drystone.engines.base import Demand, Engine, Pacing, Problem, StepReport
from drystone.engines.frame import Frame, plain
from drystone.model.assembly import Assembly
from drystone.model.ties import TieState

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def framed(engine: Engine[Any]) -> Engine[Any]:
    """The engine within the structure's own frame, where it asks for that."""
    return FramedEngine(engine) if engine.capabilities.in_own_frame else engine


@dataclass(frozen=True, kw_only=True)
class FramedState:
    """A state of the engine within, and its poses as they are outside."""

    own: Any
    pose: Array  # (n, n_dof) m, rad
    gone: BoolArray | None = None  # (n,) blocks that have left, of engines that tell


class FramedEngine(Engine[FramedState]):
    """See the module's text; the contract is that of `engines.base.Engine`."""

    def __init__(self, engine: Engine[Any]) -> None:
        self.engine = engine
        self.name = engine.name
        self.capabilities = replace(engine.capabilities, in_own_frame=False)
        self.seen: tuple[Assembly, Frame, Assembly] | None = None
        #: Rows outside of the rows within, and the other way round; None where they are the same.
        self.order: IntArray | None = None
        self.rank: IntArray | None = None

    def pacing(self, assembly: Assembly) -> Pacing:
        """See `Engine.pacing`; the assembly is the one outside."""
        frame, own = self._own(assembly)
        suits = self.engine.pacing(own)
        if suits.displacement_step is None:
            return suits
        return replace(suits, displacement_step=plain(frame.length * suits.displacement_step))

    def start(self, problem: Problem) -> tuple[FramedState, StepReport]:
        """See `Engine.start`."""
        self.frame, assembly = self._own(problem.assembly)
        control = self.frame.control_point(problem.control_point)
        order, self.order, self.rank = self.frame.order(assembly, control), None, None
        if (np.diff(order) != 1).any():
            self.order, self.rank = order, np.argsort(order)
            assembly = replace(assembly, blocks=tuple(assembly.blocks[i] for i in order))
            control = replace(control, block=int(self.rank[control.block]))
        settlement = problem.settlement
        self.turns = settlement is not None and settlement.rotates
        #: Unit of what paces the analysis.
        self.pace = 1.0 if self.turns else self.frame.length
        frame, ground = self.frame, problem.ground
        own, report = self.engine.start(
            replace(
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
        )
        self.notes = self.engine.notes  # which it may have found only now
        return self._state(own), self._report(report)

    def step(self, state: FramedState, demand: Demand) -> tuple[FramedState, StepReport]:
        """See `Engine.step`."""
        frame, increment = self.frame, demand.increment
        own, report = self.engine.step(
            state.own,
            changed(
                demand,
                increment=None if increment is None else plain(increment / frame.length),
                settlement=demand.settlement and plain(demand.settlement / self.pace),
                time_step=plain(demand.time_step / frame.time) if demand.time_step else 0.0,
            ),
        )
        return (state if own is state.own else self._state(own)), self._report(report)

    def contacts(self, state: FramedState) -> ContactForces:
        """See `Engine.contacts`."""
        found = self.frame.contacts_of(self.engine.contacts(state.own))
        if self.order is None:
            return found
        return changed(found, block_a=self.order[found.block_a], block_b=self.order[found.block_b])

    def ties_of(self, state: FramedState) -> TieState | None:
        """See `Engine.ties_of`."""
        own = self.engine.ties_of(state.own)
        return None if own is None else self.frame.ties_of(own)

    def gone_of(self, state: FramedState) -> BoolArray | None:
        """See `Engine.gone_of`."""
        return state.gone

    def close(self) -> None:
        """See `Engine.close`."""
        self.engine.close()

    def _own(self, assembly: Assembly) -> tuple[Frame, Assembly]:
        """The frame of an assembly and the assembly in it, made once for one and the same."""
        if self.seen is None or self.seen[0] is not assembly:
            frame = Frame.of(assembly)
            own = frame.assembly(assembly)
            self.seen = assembly, frame, own
        return self.seen[1:]

    def _state(self, own: Any) -> FramedState:
        pose, gone = self.frame.pose_of(own.pose), self.engine.gone_of(own)
        if self.rank is not None:
            pose, gone = pose[self.rank], None if gone is None else gone[self.rank]
        return FramedState(own=own, pose=pose, gone=gone)

    def _report(self, own: StepReport) -> StepReport:
        length = self.frame.length
        lever = length if self.turns else 1.0  # of a rotation the reaction is a moment
        return changed(
            own,
            control_displacement=self.pace * own.control_displacement,
            reaction=self.frame.force * lever * own.reaction,
            penetration=length * own.penetration,
            motion=length * own.motion,
            way=tuple((self._state(state), self._report(report)) for state, report in own.way),
        )
