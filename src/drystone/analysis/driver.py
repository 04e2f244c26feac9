"""The pushover analysis: model x engine x control -> capacity curve."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from drystone.analysis.controls import make_control
from drystone.analysis.tracing import Recorder, Run
from drystone.common.compilation import Compilation
from drystone.common.language import say
from drystone.common.progress.watched import points_shown
from drystone.common.ranges import found, problem
from drystone.common.threads import limited
from drystone.engines import checked, make_engine
from drystone.engines.base import Engine, EngineError
from drystone.engines.framed import framed
from drystone.model.model import REMOVE, STOP, Model
from drystone.results.checkpoint import Past
from drystone.results.curve import CYCLIC, FINISHED, SETTLEMENT, CapacityCurve, CurvePoint
from drystone.results.events import falls_with

#: Blocks up to which states are kept in the result by default: at 500, some 0.4 MB a point.
MOST_KEPT = 500


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
        name a control point, and the default one takes no part in the first collapse, or the curve
        stops before its end, the control point is moved to the part that moves in the mechanism of
        limit analysis. The curve is then traced once more, and its `reason` and `control_point` say
        so. This does not depend on `Analysis.falling`. ``drystone run`` asks limit analysis before
        it traces the curve. So only a curve that is complete before a part collapses, as at a small
        ``max_displacement``, may have another control point there. To have that of ``run``, trace
        `drystone.limit.on_what_moves` (model). With a recorder, with an engine of your own, or with
        a history of displacements, the control point stays.
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
        run = Run(
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
    run = Run(
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
    run: Run, progress: Callable[[CurvePoint], None] | bool | None, threads: int | None
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
