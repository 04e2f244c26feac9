"""The pushover analysis: model x engine x control -> capacity curve."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import asdict, dataclass, field, fields, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from threadpoolctl import threadpool_limits

from drystone.analysis.plausible import Plausibility
from drystone.analysis.sitting import SITTING, Sitting
from drystone.common import tolerances
from drystone.common.arrays import Array
from drystone.common.codec import CodecError, packed, unpacked
from drystone.common.compilation import Compilation
from drystone.common.language import say
from drystone.common.progress.watched import points_shown
from drystone.common.ranges import found, problem
from drystone.common.records import changed
from drystone.common.threads import limited
from drystone.contact.forces import ContactForces
from drystone.control import (
    Control,
    ControlError,
    Decision,
    DisplacementControl,
    DisplacementSettings,
    ExcessControl,
    ExcessHistoryControl,
    ExcessHistorySettings,
    ExcessSettings,
    HistoryControl,
    HistorySettings,
    PublishedControl,
    PublishedSettings,
    SupportControl,
    SupportSettings,
    ends,
)
from drystone.control.stops import STOPS, stops_of
from drystone.engines import checked, make_engine
from drystone.engines.base import (
    Demand,
    Engine,
    EngineError,
    Problem,
    State,
    StepReport,
)
from drystone.engines.frame import Frame
from drystone.engines.framed import framed
from drystone.engines.refusal import others
from drystone.model.model import REMOVE, STOP, Analysis, Model
from drystone.model.ties import TieState, names_of
from drystone.results.checkpoint import Checkpoint, Past, Standing
from drystone.results.curve import (
    CYCLIC,
    DYNAMIC,
    FINISHED,
    SETTLEMENT,
    STATIC,
    BlockLeft,
    CapacityCurve,
    CurvePoint,
    KeptContacts,
    RecorderError,
    TieRecord,
)
from drystone.results.event_log import EventLog
from drystone.results.events import falls_with, named

#: Settings of some strategy.
Settings = TypeVar(
    "Settings",
    PublishedSettings,
    DisplacementSettings,
    ExcessSettings,
    HistorySettings,
    ExcessHistorySettings,
)

#: Default displacement per step over the smallest extent of a block.
STEP_SHARE = 0.005

#: Largest one: with longer steps engines fail, and a peak may be missed.
COARSEST_SHARE = 0.2

#: Steps in the longest leg of a history, at least: a loop has an area and a shape.
STEPS_IN_LEG = 20

#: Time step of supports that move in dynamic formulations, in own units [s]: inertia of a step of
#: a hundredth of a block is then 1e-4 of its weight.
STILL = 1.0

STRATEGIES = ("displacement", "published")

#: Names of the settings of an analysis that are no conditions under which it stops.
SETTINGS = {
    "mechanism_displacement",
    *SITTING,
    *(
        key.name
        for cls in (PublishedSettings, ExcessSettings, DisplacementSettings)
        for key in fields(cls)
        if key.name not in ("stops", "farthest")
    ),
}

#: Blocks up to which states are kept in the result by default: at 500, some 0.4 MB a point.
MOST_KEPT = 500


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


# Many: whatever may be said of an analysis beside its model.
def pushover(
    model: Model,
    *,
    engine: str | Engine[Any] | None = None,
    strategy: str | None = None,
    recorder: Recorder | None = None,
    progress: Callable[[CurvePoint], None] | bool | None = None,
    keep_poses: bool | None = None,
    keep_contacts: bool | None = None,
    threads: int | None = None,
    default_falling: str = REMOVE,
    **options: Any,
) -> CapacityCurve:
    """Trace the capacity curve of a model.

    Parameters
    ----------
    model
        The model; its ``analysis`` gives the settings that are left out here. If the model does not
        name a control point, and the default one takes no part in the first collapse, the control
        point is moved to the part that moves in the mechanism of limit analysis. The curve is then
        traced once more, and its `reason` and `control_point` say so. With a recorder, or with an
        engine of your own, the control point stays.
    engine
        Name of an engine, or one of your own (see `engines.base.Engine`).
    strategy
        "displacement" (no bias) or "published".
    recorder
        Gets every point as soon as it is found.
    progress
        Likewise; or whether a bar shows the progress. By default it does on a terminal and in a
        notebook.
    keep_poses, keep_contacts
        Keep poses and contact forces of every point in the result. By default they are kept for up
        to `MOST_KEPT` blocks, unless a recorder stores them.
    threads
        Largest number of threads that share the work of an engine, by default one for each
        processor. The curve does not depend on it.
    default_falling
        What happens when a part collapses, if the model does not say: see `Analysis.falling`.
    options
        Keys of [analysis] by name, which replace those of the model: see `control`.

    Raises
    ------
    EngineError
        The engine cannot do what is asked; `UnstableError` where the structure does not stand
        under its own weight.
    """
    named = engine is None or isinstance(engine, str)
    if isinstance(model, str | Path):
        raise TypeError(
            f"pushover takes a model, not its file: read_model({str(model)!r}) reads it"
        )
    asked = str(engine or model.analysis.engine)
    model = _with_options(model, options)

    def traced(model: Model) -> CapacityCurve:
        own = engine is not None and not isinstance(engine, str)
        solver = framed(checked(engine)) if own else make_engine(asked)
        small = recorder is None and model.assembly.n_bodies <= MOST_KEPT
        run = _Run(
            model=model,
            solver=solver,
            strategy=_strategy(model, strategy),
            later=named and solver.capabilities.keeps_states,
            stops=(model.analysis.falling or default_falling) == STOP,
            recorder=recorder,
            progress=None,
            keep_poses=small if keep_poses is None else keep_poses,
            keep_contacts=small if keep_contacts is None else keep_contacts,
        )
        return _traced(run, progress, threads)

    curve = traced(model)
    if recorder is not None or not named or _is_enough(curve, model):
        return curve
    # Asked only now: a curve whose control point is part of its first collapse needs no other, and
    # limit analysis takes a tenth of its time.
    from drystone.limit import on_what_moves

    watching = on_what_moves(model)
    if watching is model:
        return curve
    moved = say("end.control_moved", block=model.assembly.ids[watching.control_point.block])
    again = traced(watching)
    return replace(
        again,
        reason="; ".join((again.reason, moved)),
        wall_time=curve.wall_time + again.wall_time,
        compile_time=curve.compile_time + again.compile_time,
    )


def resumed(
    past: Past,
    *,
    engine: Engine[Any] | None = None,
    recorder: Recorder | None = None,
    progress: Callable[[CurvePoint], None] | bool | None = None,
    threads: int | None = None,
) -> CapacityCurve:
    """The curve of a run that stopped, as if it had not: from its last checkpoint on.

    Parameters
    ----------
    past
        The run as it was kept.  The ``analysis`` of its model may have another end.
    engine
        As `pushover` was given, where it was no name.
    recorder, progress, threads
        As of `pushover`; the recorder goes on after the points of the past.

    Raises
    ------
    EngineError
        The engine cannot go on from states that were kept.
    """
    kept = past.checkpoint
    solver = make_engine(kept.engine) if engine is None else framed(checked(engine))
    if not solver.capabilities.resumes:
        raise EngineError(cannot_resume(kept.engine))
    run = _Run(
        model=past.model,
        solver=solver,
        strategy=kept.strategy,
        later=False,
        stops=kept.stops,
        recorder=recorder,
        progress=None,
        keep_poses=False,
        keep_contacts=False,
        past=past,
    )
    return _traced(run, progress, threads)


def cannot_resume(engine: str) -> str:
    """That an engine keeps no states, as a sentence."""
    return str(say("end.engine_keeps_none", engine=engine))


def _is_enough(curve: CapacityCurve, model: Model) -> bool:
    """Whether a curve shows all that another control point could: it was interrupted, somebody has
    named its control point or where that goes, or this is part of the first collapse."""
    if model.history is not None:
        return True
    if curve.status == "interrupted" or not model.control_point.default:
        return True
    if curve.status != FINISHED:
        return False
    first, control = curve.first_collapse, model.assembly.ids[model.control_point.block]
    return first is None or control in falls_with(curve.events, first)


def _strategy(model: Model, asked: str | None) -> str:
    """That which a model is traced by; raises `EngineError` where it cannot be what is asked."""
    if model.settlement is not None:
        return SETTLEMENT
    strategy = asked or model.analysis.strategy
    if model.history is None:
        return strategy
    if strategy == "published":
        raise EngineError(
            '[control] history: the strategy "published" pushes one way: take "displacement"'
        )
    return CYCLIC


def _traced(
    run: _Run, progress: Callable[[CurvePoint], None] | bool | None, threads: int | None
) -> CapacityCurve:
    """The curve of a run that has not begun; its engine is closed."""
    begun = time.perf_counter()
    model = run.model
    control = make_control(run.strategy, run.solver, model)
    shows: AbstractContextManager[Callable[[CurvePoint], None] | None]
    if progress is not None and not isinstance(progress, bool):
        shows = nullcontext(progress)
    else:
        shows = points_shown(model.title or "pushover", model.analysis.stop_multiplier, progress)
    # Threads of LAPACK only slow each other on systems of this size.
    lapack = threadpool_limits(limits=1, user_api="blas")
    with closing(run.solver), lapack, limited(threads), Compilation() as compilation, shows as told:
        run.progress = told
        end = run.traced(control)
    seconds = 0.0 if run.past is None else run.past.checkpoint.seconds
    return run.finished(*end, seconds + time.perf_counter() - begun, compilation.seconds)


class _Stands(NamedTuple):
    """A run between two steps; one object, so that an interrupt finds it whole."""

    state: State
    decision: Decision[Any]
    n_points: int
    n_left: int


@dataclass(kw_only=True)
class _Run:
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
            return "interrupted", "interrupted by the user"
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
            raise EngineError(f"at rest under its own weight, {report.reason}")
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
            why = f"{named([ids[i] for i in fallen], 'block')} left the structure"
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


def _with_options(model: Model, options: Mapping[str, Any]) -> Model:
    """The model with options in place of its own; `EngineError` for those that a model file would
    not take."""
    wrong = [sentence for key, value in options.items() if (sentence := problem(key, value))]
    falling = options.get("falling", REMOVE)
    if falling not in (REMOVE, STOP):
        wrong.append(f'falling: must be "{REMOVE}" or "{STOP}", it is {found(falling)}')
    if wrong:
        raise EngineError(f"[analysis] {wrong[0]}")
    return model.with_analysis(**options) if options else model


def obeyed(report: StepReport, limit: float | None) -> StepReport:
    """The report; as that of a step that failed where its certificate does not hold.

    ``limit`` is what the engine keeps, over the heaviest weight; None where it does not say.
    Inertia is one of the forces, so that motion is judged like rest.
    """
    if limit is None or not report.converged or report.residual <= limit:
        return report
    reason = (
        f"the step leaves a residual of {report.residual:.1e} heaviest weights, where the engine "
        f"keeps {limit:.0e}: the joints may be too stiff, or the increments too large, for the "
        "blocks' weight"
    )
    return replace(report, converged=False, reason=reason)


def _options_of(strategy: str, analysis: Analysis) -> dict[str, float]:
    """The numerical settings of an analysis; raises `EngineError`."""
    options = {"stop_multiplier": analysis.stop_multiplier, **analysis.options}
    if strategy not in (*STRATEGIES, SETTLEMENT, CYCLIC):
        raise EngineError(f'there is no strategy "{strategy}": take {" or ".join(STRATEGIES)}')
    unknown = [key for key in options if key not in SETTINGS and key not in STOPS]
    if unknown:
        raise EngineError(f'there is no setting "{unknown[0]}" of the analysis')
    wrong = [sentence for key, value in options.items() if (sentence := problem(key, value))]
    stops = stops_of({key: x for key, x in options.items() if key not in SETTINGS})
    wrong += [sentence for stop, x in stops if (sentence := stop.problem(x))]
    if wrong:  # also of settings that this strategy does not use, as in a model file
        raise EngineError(f"[analysis] {wrong[0]}")
    return options


def make_control(strategy: str, engine: Engine[Any], model: Model) -> Control[Any]:
    """The control of a strategy for an engine; raises `EngineError` for settings that fail."""
    options = _options_of(strategy, model.analysis)
    frame = Frame.of(model.assembly)
    coarsest = COARSEST_SHARE * frame.size
    asked = options.get("displacement_step", 0.0)
    if asked > coarsest:
        raise EngineError(
            f"[analysis] displacement_step of {asked:g} m is too coarse to see the peak: take at "
            f"most {coarsest:.3g} m, a fifth of the smallest block"
        )
    farthest = max(model.assembly.largest_extent, options.get("max_displacement", 0.0))
    step = {"displacement_step": STEP_SHARE * frame.size, "farthest": farthest}
    if model.load.turns_gravity:
        step["upright"] = tolerances.UPRIGHT
    said = asdict(engine.preferred_steps(model.assembly))
    preferred = {key: value for key, value in said.items() if value is not None}
    suited = {**step, **preferred}
    if model.settlement is not None:
        return _support_control({**suited, **options}, engine, model, frame)
    try:
        if strategy == "published":
            suited = {**preferred, **step}
        chosen = {**suited, "suited_step": suited["displacement_step"], **options}
        if strategy == "published":
            return PublishedControl(_settings(PublishedSettings, frame.time, chosen))
        if model.history is not None:
            return _cyclic({**chosen, "targets": model.history.targets}, engine, frame)
        if engine.capabilities.prescribes_displacement:
            return DisplacementControl(_settings(DisplacementSettings, frame.time, chosen))
        return ExcessControl(_settings(ExcessSettings, frame.time, chosen))
    except ControlError as error:
        raise EngineError(f"[analysis] {error}") from None


def _cyclic(
    options: Mapping[str, Any], engine: Engine[Any], frame: Frame
) -> HistoryControl | ExcessHistoryControl:
    """The control of a history; its steps are short beside its legs."""
    legs = np.abs(np.diff((0.0, *options["targets"])))
    step = min(options["displacement_step"], float(legs.max()) / STEPS_IN_LEG)
    options = {**options, "displacement_step": step}
    if engine.capabilities.prescribes_displacement:
        return HistoryControl(_settings(HistorySettings, frame.time, options))
    return ExcessHistoryControl(_settings(ExcessHistorySettings, frame.time, options))


def _support_control(
    options: Mapping[str, float], engine: Engine[Any], model: Model, frame: Frame
) -> SupportControl:
    """The control of supports that move; raises `EngineError` for engines that cannot move them."""
    if not engine.capabilities.moves_supports:
        raise EngineError(
            f"the {engine.name} engine cannot move supports: {others(lambda c: c.moves_supports)}"
        )
    settlement, assembly = model.settlement, model.assembly
    assert settlement is not None
    weight = float(assembly.weight[~assembly.fixed].sum())
    lever = 1.0
    if settlement.rotates:
        lever = settlement.lever(assembly)
    step = options["displacement_step"]
    unused = SETTINGS | {"farthest", "max_displacement"}
    return SupportControl(
        SupportSettings(
            largest=settlement.largest,
            step=min(step, settlement.largest * lever) / lever,
            unit=weight * (lever if settlement.rotates else 1.0),
            scale=lever,
            time_step=0.0 if engine.capabilities.prescribes_displacement else STILL * frame.time,
            jump_time_step=tolerances.JUMP_TIME_STEP * frame.time
            if engine.capabilities.moves_supports_in_time
            else 0.0,
            fall=tolerances.SUPPORT_FALL * assembly.smallest_extent,
            grow_iterations=int(options.get("grow_iterations", SupportSettings.grow_iterations)),
            # How far supports go, [settlement] says.
            stops=stops_of({k: x for k, x in options.items() if k not in unused}),
        )
    )


def _settings(cls: type[Settings], second: float, options: Mapping[str, Any]) -> Settings:
    """A settings object from those options that it has; whole numbers where it wants them.

    Its default times are in the structure's own ``second`` [s]: what falls its own size in one,
    falls it in another, whatever the size.
    """
    chosen: dict[str, Any] = {}  # of whole numbers, others and switches
    own = {key.name for key in fields(cls)}
    for key in fields(cls):
        if key.name in options:
            value = options[key.name]
            chosen[key.name] = int(value) if key.type == "int" else value
        elif key.name == "stops":
            chosen[key.name] = stops_of({k: x for k, x in options.items() if k not in own})
        elif key.name == "time_step":
            default: Any = key.default
            chosen[key.name] = second * default
    return cls(**chosen)


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
