"""An analysis under way: step after step, what is told and kept of each point."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple, Protocol

import numpy as np

from drystone.analysis.plausible import Plausibility
from drystone.analysis.sitting import Sitting
from drystone.common.arrays import Array
from drystone.common.codec import CodecError, packed, unpacked
from drystone.common.language import say
from drystone.common.records import changed
from drystone.contact.forces import ContactForces
from drystone.control import Control, Decision, ends
from drystone.engines.base import Demand, Engine, EngineError, Problem, State, StepReport
from drystone.model.model import STOP, Model
from drystone.model.ties import TieState, names_of
from drystone.results.checkpoint import Checkpoint, Past, Standing
from drystone.results.curve import (
    DYNAMIC,
    STATIC,
    BlockLeft,
    CapacityCurve,
    CurvePoint,
    RecorderError,
)
from drystone.results.event_log import EventLog
from drystone.results.events import named
from drystone.results.forces import KeptContacts, TieRecord


class Recorder(Protocol):
    """Something that keeps points as they come.

    What it cannot keep it says by a `RecorderError`, which ends the analysis with what was reached.
    One that has a method ``ties`` is told what ties carry (`ties.TieState`) before each point.  One
    that has a method ``keep`` is offered a checkpoint before each step, as a function that makes it
    (`Checkpoint`), and the last one at the end: it takes one as often as it wants.
    """

    def begin(self, model: Model, engine: str, strategy: str) -> None:
        """Called before the first point."""

    def point(self, point: CurvePoint, pose: Array, contacts: ContactForces) -> None:
        """Called for every point."""

    def end(self, curve: CapacityCurve) -> None:
        """Called with the whole curve, also when the analysis was stopped or interrupted."""


class _Stands(NamedTuple):
    """A run between two steps; one object, so that an interrupt finds it whole."""

    state: State
    decision: Decision[Any]
    n_points: int
    n_left: int


@dataclass(kw_only=True)
class Run:
    """An analysis under way: what is told and kept of every point."""

    model: Model
    solver: Engine[Any]
    strategy: str
    later: bool  # contacts follow from the state alone: states are kept in their place
    stops: bool  # where a part that may not fall collapses
    recorder: Recorder | None
    progress: Callable[[CurvePoint], None] | None
    keep_poses: bool
    keep_contacts: bool
    points: list[CurvePoint] = field(default_factory=list)
    poses: list[Array] = field(default_factory=list)
    contacts: list[Any] = field(default_factory=list)
    ties: list[TieState] = field(default_factory=list)
    left: list[BlockLeft] = field(default_factory=list)
    log: EventLog = field(init=False)
    settlement: float = 0.0  # m, of the control point before the load
    past: Past | None = None  # of a run that goes on
    notes: tuple[str, ...] = ()  # what the engine leaves out of the model
    stands: _Stands | None = None  # between the last two steps

    def __post_init__(self) -> None:
        self.log = EventLog(self.model)
        self.begun = time.perf_counter()
        self.sitting = Sitting(self.model.analysis.options)

    def traced(self, control: Control[Any]) -> tuple[str, str]:
        """Trace the curve; status and reason of its end.  Without a point, errors are raised."""
        try:
            return self._trace(control)
        except KeyboardInterrupt:
            if not self.points:
                raise
            return "interrupted", str(say("end.interrupted"))
        except (EngineError, RecorderError) as error:
            if not self.points:
                raise
            return "stopped", str(error)

    def _trace(self, control: Control[Any]) -> tuple[str, str]:
        solver, plausibility = self.solver, Plausibility(self.model)
        limit = solver.capabilities.residual_limit
        if self.past is None:
            state, decision = self._at_rest(control, plausibility)
        else:
            state, decision = self._taken_up(self.past, control)
        while decision.demand is not None:
            self.stands = _Stands(state, decision, len(self.points), len(self.left))
            self._keep()
            if paused := self.sitting.over(len(self.points)):
                return "stopped", paused
            demand = decision.demand
            new, report = solver.step(state, demand)
            report = self._since_rest(obeyed(report, limit))
            decision = control.decide(decision.state, demand, report)
            if decision.accept:
                multiplier, contacts = decision.load_multiplier, partial(solver.contacts, new)
                if how := plausibility.falls_through(report, contacts):
                    end = ends.collapsed(how, self._highest, self.model.analysis.stop_multiplier)
                    return ("finished" if end.finished else "stopped"), end.reason
                plausibility.check(report, multiplier, contacts)
            state, over = self._pass(state, demand, report, decision)
            if over is not None:
                decision = over
            elif decision.accept:
                decision = self._accept(state, new, demand, report, decision)
                state = new
        return ("finished" if decision.finished else "stopped"), decision.reason

    @property
    def _highest(self) -> float:
        """The highest multiplier of the points at rest so far."""
        return max((p.load_multiplier for p in self.points if p.status == STATIC), default=0.0)

    @property
    def _problem(self) -> Problem:
        model = self.model
        return Problem(
            assembly=model.assembly,
            load=model.load,
            dead_loads=model.dead_loads,
            ties=model.ties,
            settlement=model.settlement,
            control_point=model.control_point,
            ground=model.analysis.ground,
        )

    def _at_rest(
        self, control: Control[Any], plausibility: Plausibility
    ) -> tuple[State, Decision[Any]]:
        """The structure at rest under its own weight, the first point; and what comes next."""
        solver = self.solver
        state, report = solver.start(self._problem)
        report = obeyed(report, solver.capabilities.residual_limit)
        if not report.converged:
            raise EngineError(say("end.not_at_rest", why=report.reason))
        plausibility.check(report, 0.0, partial(solver.contacts, state))
        self.notes = solver.notes
        self.settlement = report.control_displacement
        report = replace(report, control_displacement=0.0)
        if self.recorder is not None:
            self.recorder.begin(self.model, solver.name, self.strategy)
        decision = control.first(report)
        self._add(report, state, 0.0, decision)
        return state, decision

    def _taken_up(self, past: Past, control: Control[Any]) -> tuple[State, Decision[Any]]:
        """Where a run that stopped stands; its points are seen again."""
        kept, solver = past.checkpoint, self.solver
        derived, package = solver.derived(self._problem), type(solver).__module__.partition(".")[0]
        try:
            standing = unpacked(kept.standing, derived=derived, packages={package})
        except CodecError as error:
            raise EngineError(say("end.state_of_another", why=str(error))) from None
        self.settlement, self.notes = kept.settlement, kept.notes
        self.begun -= kept.seconds
        for k, point in enumerate(past.points):
            left = [block for block in kept.left if block.step == point.step]
            carried = None if past.ties is None else past.ties.at(k)
            self.log.add(
                point,
                past.poses[k],
                partial(past.contacts.__getitem__, k),
                ties=carried,
                left=[self.model.assembly.index(block.block) for block in left],
            )
            self.points.append(point)
            self.left += left
            self.ties += [] if carried is None else [carried]
        if self.recorder is not None:
            self.recorder.begin(self.model, solver.name, self.strategy)
        self.sitting.begin(len(self.points))
        return standing.state, control.again(standing.memory)

    def _keep(self, *, last: bool = False) -> None:
        """Offer the recorder a checkpoint."""
        keep = getattr(self.recorder, "keep", None)
        if keep is not None and self.stands is not None and self.solver.capabilities.resumes:
            keep(self._checkpoint, last=last)

    def _checkpoint(self) -> Checkpoint:
        assert self.stands is not None
        state, decision, n_points, n_left = self.stands
        standing = Standing(state=state, memory=decision.state, demand=decision.demand)
        return Checkpoint(
            standing=packed(standing),
            n_points=n_points,
            engine=self.solver.name,
            strategy=self.strategy,
            stops=self.stops,
            settlement=self.settlement,
            left=tuple(self.left[:n_left]),
            notes=self.notes,
            seconds=time.perf_counter() - self.begun,
        )

    def _since_rest(self, report: StepReport) -> StepReport:
        """The report, with control displacements since the equilibrium under the dead load."""
        moved = report.control_displacement - self.settlement
        way = tuple((state, self._since_rest(told)) for state, told in report.path.dynamic_states)
        return changed(
            report, control_displacement=moved, path=changed(report.path, dynamic_states=way)
        )

    def _pass(
        self, state: State, demand: Demand, report: StepReport, decision: Decision[Any]
    ) -> tuple[State, Decision[Any] | None]:
        """Add the dynamic points within a step; the state of the last of them, and the decision
        that ends the analysis there, if any."""
        for (passed, told), multiplier in zip(
            report.path.dynamic_states, decision.dynamic_multipliers, strict=False
        ):
            point = Decision(
                accept=True,
                demand=demand,
                state=decision.state,
                load_multiplier=multiplier,
                dynamic=True,
                jumped=True,
            )
            after = self._accept(state, passed, demand, told, point)
            state = passed
            if after.demand is None:
                return state, after
        return state, None

    def _accept(
        self,
        before: State,
        state: State,
        demand: Demand,
        report: StepReport,
        decision: Decision[Any],
    ) -> Decision[Any]:
        """Add a point; what is decided after what has been lost since the state ``before``."""
        fallen = self._fallen(before, state)
        collapsed = self._add(report, state, demand.time_step, decision, fallen)
        ids = self.model.assembly.ids
        self.left += [BlockLeft.at(self.points[-1], ids[i]) for i in fallen]
        return self._after_loss(fallen, collapsed, decision)

    def _fallen(self, before: State, after: State) -> list[int]:
        """Rows of the blocks that have left in between, where the engine tells."""
        departed, then = self.solver.departed(after), self.solver.departed(before)
        if departed is None or then is None or departed is then:
            return []
        return [int(i) for i in np.flatnonzero(departed & ~then)]

    def _add(
        self,
        report: StepReport,
        state: State,
        time_step: float,
        decision: Decision[Any],
        left: Sequence[int] = (),
    ) -> list[int]:
        """Keep a point, and tell it; rows of the blocks that have collapsed since the last one."""
        point = _point(len(self.points), report, time_step, decision)
        needed = self.recorder is not None or (self.keep_contacts and not self.later)
        touching = self.solver.contacts(state) if needed else None
        carried = self._add_ties(state)
        if self.recorder is not None and touching is not None:  # first: no more than is kept
            self.recorder.point(point, state.pose, touching)
        self.points.append(point)
        if self.keep_poses:
            self.poses.append(state.pose.copy())
        if self.keep_contacts:
            self.contacts.append(state if self.later else touching)
        if self.progress is not None:
            self.progress(point)

        def contacts() -> ContactForces:
            return self.solver.contacts(state) if touching is None else touching

        return self.log.add(point, state.pose, contacts, ties=carried, left=left)

    def _after_loss(
        self, fallen: list[int], collapsed: list[int], decision: Decision[Any]
    ) -> Decision[Any]:
        """Whether the analysis goes on after blocks have left, or have collapsed."""
        model = self.model
        ids = model.assembly.ids
        lost = [ids[i] for i in collapsed if ids[i] not in model.parts_that_may_fall]
        if lost and self.stops and not decision.finished:
            key = "end.has_collapsed" if len(lost) == 1 else "end.have_collapsed"
            reason = say(key, blocks=named(lost, "block"), stop=STOP)
            # As asked: the curve is complete.
            return replace(decision, demand=None, reason=reason, finished=True)
        if fallen and model.settlement is not None and not decision.finished:
            why = say("end.blocks_left", blocks=named([ids[i] for i in fallen], "block"))
            reason = say("end.supports_fall", why=why)
            return replace(decision, demand=None, reason=reason, finished=True)
        if model.control_point.block in fallen:
            reason = say("end.control_left")
            # A curve that is complete stays so.
            return decision if decision.finished else replace(decision, demand=None, reason=reason)
        return decision

    def _add_ties(self, state: State) -> TieState | None:
        now = self.solver.ties_of(state) if self.model.ties else None
        if now is None:
            return None
        self.ties.append(now)
        tell = getattr(self.recorder, "ties", None)
        if tell is not None:
            tell(now)
        return now

    def finished(self, status: str, reason: str, seconds: float, compiling: float) -> CapacityCurve:
        """What was traced, told to the recorder; its seconds include those of compiling."""
        self._keep(last=True)
        curve = CapacityCurve(
            engine=self.solver.name,
            strategy=self.strategy,
            points=tuple(self.points),
            status=status,
            # What was left out of the model belongs to how far the curve can be trusted.
            reason="; ".join(filter(None, (reason, *map(str, self.left), *self.notes))),
            stop_multiplier=ends.stop_after(self._highest, self.model.analysis.stop_multiplier),
            settlement=self.settlement,
            motion_unit=self.model.settlement.unit if self.model.settlement else "m",
            load_force=self.model.load_force,
            load_turns=self.model.load.turns_gravity,
            targets=self.model.history.targets if self.model.history else (),
            model=self.model,
            blocks_left=tuple(self.left),
            events=self.log.end(),
            wall_time=seconds - compiling,
            compile_time=compiling,
            poses=np.array(self.poses) if self.keep_poses else None,
            contacts=self._kept_contacts() if self.keep_contacts else None,
            ties=TieRecord.of(names_of(self.model.ties), self.ties[: len(self.points)])
            if self.ties
            else None,
        )
        if self.recorder is not None:
            self.recorder.end(curve)
        return curve

    def _kept_contacts(self) -> Sequence[ContactForces]:
        if self.later:
            return KeptContacts(self.contacts, self.solver.contacts)
        return tuple(self.contacts)


def obeyed(report: StepReport, limit: float | None) -> StepReport:
    """The report; as that of a step that failed where its certificate does not hold.

    ``limit`` is what the engine keeps, over the heaviest weight; None where it does not say.
    Inertia is one of the forces, so that motion is judged like rest.
    """
    if limit is None or not report.converged or report.residual <= limit:
        return report
    reason = say("end.inexact", residual=float(report.residual), limit=limit)
    return replace(report, converged=False, reason=reason)


def _point(step: int, report: StepReport, time_step: float, decision: Decision[Any]) -> CurvePoint:
    return CurvePoint(
        step=step,
        control_displacement=report.control_displacement,
        load_multiplier=decision.load_multiplier,
        applied_multiplier=report.applied_multiplier,
        carried_multiplier=report.carried_multiplier,
        reaction=report.reaction,
        residual=report.residual,
        penetration=report.penetration,
        friction_violation=report.friction_violation,
        energy_ratio=report.energy_ratio,
        inertia_ratio=report.inertia_ratio,
        n_open=report.n_open,
        n_sticking=report.n_sticking,
        n_sliding=report.n_sliding,
        motion=report.motion,
        time_step=time_step,
        n_iterations=report.n_iterations,
        status=DYNAMIC if decision.dynamic else STATIC,
        jumped=decision.jumped,
        lost_shear=report.lost_shear,
        unstable=report.unstable,
    )
