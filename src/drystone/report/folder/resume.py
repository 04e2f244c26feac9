"""A run that stopped goes on in its folder, from the last state that was kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from drystone.analysis.driver import cannot_resume, pushover, resumed
from drystone.analysis.sitting import SITTING
from drystone.common.language import say
from drystone.common.ranges import problem
from drystone.control.ends import stop_after
from drystone.control.stops import STOPS
from drystone.engines import make_engine
from drystone.engines.base import Engine, EngineError
from drystone.limit.beside import limits_beside
from drystone.model.model import REMOVE, Model
from drystone.report.folder.directory import ResultsDirectory
from drystone.report.folder.kept import Kept
from drystone.report.folder.results import load_results
from drystone.results.curve import CapacityCurve, CurvePoint

#: Keys of [analysis] that a run may go on with other values of, beside the stop conditions.
EXTENDED = ("stop_multiplier", *SITTING)
#: How far supports go, where they move.
SETTLEMENT = "settlement"


def resume(
    path: Path | str,
    *,
    engine: Engine[Any] | None = None,
    progress: Callable[[CurvePoint], None] | bool | None = None,
    threads: int | None = None,
    **extended: float | None,
) -> CapacityCurve:
    """Go on with the run of a folder of results; the curve is that of a run that never stopped.

    Parameters
    ----------
    path
        Folder of a run that was interrupted, killed, ended by a full disk, or paused by
        ``max_points`` or ``max_time``.  The model is the one that is kept there.
    engine
        As `pushover` was given, where it was no name.
    progress, threads
        As of `pushover`.
    extended
        Other ends of the curve: ``stop_multiplier``, ``max_displacement``, ``max_steps``,
        ``max_points``, ``max_time``, or None for no such end; ``settlement`` is how far supports
        go that move [m, or degrees about a centre].  A curve that is complete goes on with them;
        what it has stays, but for its last step.

    Raises
    ------
    OutputError
        Nothing is kept there from which a run can go on, or another run writes there.
    EngineError
        The engine cannot resume, or an end is none.
    """
    with ResultsDirectory(path) as results:
        kept = results.take_up()
        if kept.complete and not extended:
            results.close()
            return load_results(path).curve
        check_farther(kept, extended)
        model = extended_to(kept.model, extended)
        results.beside = limits_beside(model)
        return go_on(kept, model, results, engine=engine, progress=progress, threads=threads)


def go_on(
    kept: Kept,
    model: Model,
    results: ResultsDirectory,
    *,
    engine: Engine[Any] | None = None,
    progress: Callable[[CurvePoint], None] | bool | None = None,
    threads: int | None = None,
    default_falling: str = REMOVE,
) -> CapacityCurve:
    """Trace on what a folder has kept, of its model with whatever end; or anew without a state."""
    check_resumes(kept, engine)
    if kept.past is not None:
        past = replace(kept.past, model=model)
        return resumed(past, engine=engine, recorder=results, progress=progress, threads=threads)
    return pushover(
        model,
        engine=kept.engine if engine is None else engine,
        strategy=kept.strategy,
        recorder=results,
        progress=progress,
        threads=threads,
        default_falling=default_falling,
    )


def check_resumes(kept: Kept, engine: Engine[Any] | None = None) -> None:
    """Raise `EngineError` where the engine of a run keeps no states."""
    solver = make_engine(kept.engine) if engine is None else engine
    if not solver.capabilities.resumes:
        raise EngineError(cannot_resume(kept.engine))


def check_farther(kept: Kept, ends: Mapping[str, float | None]) -> None:
    """Raise `EngineError` where a complete curve has passed an end that is asked for, or where no
    end leads farther."""
    if not kept.complete or kept.past is None or not kept.past.points:
        return
    if kept.history_is_over and ends:
        raise EngineError(str(say("end.history_is_over")))
    analysis = kept.model.analysis
    stop, farthest = ends.get("stop_multiplier"), ends.get("max_displacement")
    highest = max(point.load_multiplier for point in kept.past.points)
    went_to = stop_after(highest, analysis.stop_multiplier)
    if stop is not None and stop > went_to:
        raise EngineError(f"stop_multiplier: the run went to {went_to:g} already: take less")
    reached = max(point.control_displacement for point in kept.past.points)
    again = farthest == analysis.options.get("max_displacement")  # a command repeated after a kill
    if farthest is not None and farthest < reached and not again:
        raise EngineError(
            f"max_displacement: the run has passed {reached:.4g} m already: take more"
        )


def extended_to(model: Model, ends: Mapping[str, float | None]) -> Model:
    """The model with other ends of its curve; raises `EngineError` for what is no end."""
    if not ends:
        return model
    ends = dict(ends)
    if SETTLEMENT in ends:
        model = _farther(model, ends.pop(SETTLEMENT))
    for key, value in ends.items():
        if key not in EXTENDED and key not in STOPS:
            known = ", ".join(dict.fromkeys((*EXTENDED, *STOPS.names(), SETTLEMENT)))
            raise EngineError(f'"{key}" is no end of a curve that could be extended: take {known}')
        wrong = problem(key, value) if value is not None else None
        if value is None and key == "stop_multiplier":
            wrong = f"{key}: must be a number"
        if wrong:
            raise EngineError(wrong)
    analysis = model.analysis
    options = {k: v for k, v in {**analysis.options, **ends}.items() if v is not None}
    stop = options.pop("stop_multiplier", analysis.stop_multiplier)
    return replace(model, analysis=replace(analysis, stop_multiplier=stop, options=options))


def _farther(model: Model, amount: float | None) -> Model:
    """The model whose supports go farther; raises `EngineError` where they do not."""
    settlement = model.settlement
    if settlement is None:
        raise EngineError(f"{SETTLEMENT}: the supports of this model do not move")
    if amount is None or problem(SETTLEMENT, amount):
        raise EngineError(f"{SETTLEMENT}: {problem(SETTLEMENT, amount) or 'must be a number'}")
    if amount < settlement.max:  # as far may be asked for again, after a kill
        unit = "degrees" if settlement.rotates else "m"
        raise EngineError(
            f"{SETTLEMENT}: the run goes to {settlement.max:g} {unit} already: take more"
        )
    return replace(model, settlement=replace(settlement, max=amount))
