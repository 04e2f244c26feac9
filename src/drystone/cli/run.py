"""``drystone run``: the pushover curve of a model file."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.directions import TABLE, Asked, number_of, run_directions
from drystone.cli.limits import Limits
from drystone.cli.options import AsJson, OptionalModelFile, Quiet, StrategyName
from drystone.cli.outcome import emit, exit_code, fail, outcome, tell
from drystone.common.importing import importing

if TYPE_CHECKING:
    from drystone.limit import Beside
    from drystone.model.model import Model
    from drystone.report.folder.directory import ResultsDirectory
    from drystone.results.curve import CapacityCurve


#: Events that are told on the terminal.
MOST_EVENTS = 6

EngineName = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Engine. [default: what the model says]", show_default=False),
]
Folder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Folder of results. [default: MODEL-results]", show_default=False
    ),
]
MechanismAt = Annotated[
    float | None,
    typer.Option(
        metavar="METRES",
        min=0.0,
        help="Control displacement of mechanism.png. [default: what the model says, or 0.2]",
        show_default=False,
    ),
]


Threads = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=1,
        help="Threads that share the work; the results do not depend on it. [default: one for "
        "each processor]",
        show_default=False,
    ),
]


class FigureFormat(StrEnum):
    """Formats of pictures beside PNG."""

    svg = "svg"
    pdf = "pdf"


Figures = Annotated[
    list[FigureFormat] | None,
    typer.Option(
        "--figures",
        help="Pictures in this format as well as in PNG; may be repeated.",
        show_default=False,
    ),
]
Directions = Annotated[
    str | None,
    typer.Option(
        metavar="both|N",
        help="Push in both senses, or in N directions all around, with a folder for each. "
        "--threads is the number of directions that run at a time.",
        show_default=False,
    ),
]


Resumed = Annotated[
    Path | None,
    typer.Option(
        "--resume",
        metavar="DIR",
        help="Continue the run of this folder of results from the last state that was stored. "
        "The curve is that of a run that never stopped. MODEL may be left out.",
        show_default=False,
    ),
]
Extended = Annotated[
    list[str] | None,
    typer.Option(
        "--extend",
        metavar="KEY=VALUE",
        help="With --resume: continue to another end, such as stop_multiplier=0.005, "
        "max_displacement=0.3, or settlement=0.05 for supports that move. The VALUE none "
        "removes an end. May be repeated.",
        show_default=False,
    ),
]


# Long: what is asked for is checked, traced and told, in this order.
def run(
    context: typer.Context,
    model_file: OptionalModelFile = None,
    engine: EngineName = None,
    out: Folder = None,
    strategy: StrategyName = None,
    mechanism_at: MechanismAt = None,
    threads: Threads = None,
    figures: Figures = None,
    directions: Directions = None,
    resume: Resumed = None,
    extend: Extended = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Trace the pushover curve of a model file."""
    if mechanism_at is not None and math.isnan(mechanism_at):
        raise typer.BadParameter("it must be a number", param_hint="--mechanism-at")
    formats = tuple(format.value for format in figures or ())
    if resume is not None:
        from drystone.cli.resuming import ends_of, resume_run

        _end_begun(context)
        _refuse_beside_resume(engine=engine, out=out, strategy=strategy, directions=directions)
        asked = Asked(None, None, mechanism_at, formats)
        ends = ends_of(extend or ())
        raise typer.Exit(
            resume_run(
                resume, model_file, ends, asked, threads=threads, as_json=as_json, quiet=quiet
            )
        )
    if model_file is None:
        raise typer.BadParameter("name a model file, or --resume a folder", param_hint="MODEL")
    if extend:
        raise typer.BadParameter("it goes with --resume", param_hint="--extend")
    folder = out or Path(f"{model_file.stem}-results")
    number = None if directions is None else number_of(directions)
    begun, before = False, None if number is None else written_at(folder / TABLE)

    def kept() -> bool:
        """Whether this run has written something: of directions, what they have in common."""
        return begun or (number is not None and written_at(folder / TABLE) != before)

    with outcome(as_json=as_json, begun=kept), _beginning(context, directions) as limits:
        with importing():
            from drystone.io.modelfile import read_model
        model = read_model(model_file)
        limits.begin(model)  # what else is needed can wait
        with importing():
            from drystone.analysis.driver import pushover
            from drystone.cli.compiler import compiling
            from drystone.common.progress import progress_for
            from drystone.io.results.folder import check_apart, check_writable
            from drystone.model.inspection import inspect
            from drystone.report.folder.directory import ResultsDirectory, files_of
        check_writable(folder)  # better known before the work
        check_apart(model_file, files_of(folder))
        tell([f"warning: {problem}" for problem in inspect(model).problems])
        asked = Asked(engine, strategy and strategy.value, mechanism_at, formats)
        if number is not None:
            options: dict[str, Any] = {"processes": threads, "as_json": as_json}
            options["quiet"] = quiet or as_json
            raise typer.Exit(run_directions(model, number, folder, asked, **options))
        wanted = engine or model.analysis.engine
        with compiling(wanted, model.assembly.dimension, quiet=quiet or as_json):
            model = limits.to_trace()
            with ResultsDirectory(
                folder,
                mechanism_displacement=mechanism_at,
                beside=limits.found,
                aside=limits.aside,
                formats=formats,
            ) as results:
                try:
                    stop = model.analysis.stop_multiplier
                    with progress_for(model_file.stem, stop, quiet=quiet) as progress:
                        curve = pushover(
                            model,
                            engine=engine,
                            strategy=strategy.value if strategy else None,
                            recorder=results,
                            progress=progress,
                            threads=threads,
                        )
                finally:
                    begun = results.begun
        code = told(curve, model, limits.found(), results, as_json=as_json)
    raise typer.Exit(code)


def written_at(file: Path) -> int | None:
    """When a file was written [ns]; None where there is none."""
    with suppress(OSError):
        return file.stat().st_mtime_ns
    return None


def _beginning(context: typer.Context, directions: str | None) -> Limits:
    """Limit analysis by the process that `main` has started, or by one that is started now."""
    if directions is None:
        begun: Limits | None = context.obj
        return begun or Limits.where_it_helps()
    _end_begun(context)  # directions take all processors
    return Limits(None)


def _end_begun(context: typer.Context) -> None:
    """End the process that `main` has started, where it is of no use."""
    begun: Limits | None = context.obj
    if begun is not None:
        begun.end()


def _refuse_beside_resume(**given: object) -> None:
    """Raise `typer.BadParameter` for what a run that goes on has said when it began."""
    for name, value in given.items():
        if value is not None:
            raise typer.BadParameter(
                "a run that goes on keeps what it began with: leave this out",
                param_hint=f"--{name}",
            )


def told(
    curve: CapacityCurve,
    model: Model,
    beside: Beside,
    results: ResultsDirectory,
    *,
    as_json: bool,
) -> int:
    """Tell what came of a run; the exit status."""
    from drystone.io.results.checkpoint import CHECKPOINT
    from drystone.model.construction.words import printable

    folder = results.path
    if not curve.points:
        reason = f"{curve.status} before the first point, nothing was written: {curve.reason}"
        fail(exit_code(curve.status), [reason], as_json=as_json, status=curve.status)
    if curve.status != "finished":
        tell([f"{curve.status}: {curve.reason}"])
    if curve.status == "interrupted" and (folder / CHECKPOINT).is_file():
        tell([f"`drystone run --resume {folder}` goes on from here"])
    looked_at = _with_stored(curve, folder) if beside.is_exceeded(curve) else curve
    tell(remarks(looked_at, model, beside))
    if as_json:
        emit({**(results.summary or {}), "directory": str(folder)})
    else:
        typer.echo(report(printable(model.title), curve, folder, beside))
    return exit_code(curve.status)


def _with_stored(curve: CapacityCurve, folder: Path) -> CapacityCurve:
    """The curve with the poses and contacts that its recorder has written."""
    from drystone.io.results.folder import OutputError
    from drystone.report.folder.results import load_results

    try:
        stored = load_results(folder).curve
    except OutputError:  # a full disk, of which the curve's status tells
        return curve
    if len(stored.points) != len(curve.points):
        return curve
    return replace(curve, poses=stored.poses, contacts=stored.contacts)


def remarks(curve: CapacityCurve, model: Model, beside: Beside) -> list[str]:
    """Sentences on what a reader of the peak alone would miss."""
    from drystone.common.language import say
    from drystone.results.events import falls_with

    found = []
    first, capacity = curve.first_collapse, curve.capacity
    if first is not None and curve.rises_after_collapse:
        found.append(
            f"the highest multiplier, {curve.peak.load_multiplier:.4f}, is that of what is left "
            f"after {first.what} ({first.place}): the capacity of the whole structure is "
            f"{capacity.load_multiplier:.4f}"
        )
    control = model.assembly.ids[model.control_point.block]
    # Where supports move, displacements are theirs, whatever falls.
    shown = curve.moves_supports or first is None or control in falls_with(curve.events, first)
    if first is not None and not shown and curve.points[-1].step > first.step:
        found.append(
            f'the control point, on the block "{control}", does not take part where '
            f"{first.what} ({first.place}): its displacement does not show that collapse"
        )
    if model.control_point is beside.fastest:
        found.append(say("end.control_moved", block=control))
    elif beside.control_still:
        found.append(
            f'the control point, on the block "{control}", hardly moves, or goes backwards, in the '
            "mechanism of limit analysis: put [control] on the part that moves"
        )
    if (branch := curve.unstable_branch) is not None:
        found.append(say("mechanism.unstable", first=branch[0], last=branch[1]))
    warning = beside.warning(curve, model)
    return [*found, warning] if warning else found


def report(title: str, curve: CapacityCurve, folder: Path, beside: Beside) -> str:
    """The few lines that a person wants to read first."""
    from drystone.model.construction.words import printable

    if curve.moves_supports:
        return _support_text(title, curve, folder)
    peak, ultimate = curve.peak, curve.ultimate_displacement
    if ultimate is None:
        end = f"not reached; the curve ends at {curve.points[-1].control_displacement:.4f} m"
    elif curve.ends_in_motion:
        end = f"{ultimate:.4f} m, where the structure collapses in motion"
    else:
        end = f"{ultimate:.4f} m, where the multiplier falls to {curve.stop_multiplier:.3g}"
    highest = curve.name_of_peak.replace("peak", "peak multiplier")
    whole = curve.capacity
    capacity = (
        "capacity",
        f"{whole.load_multiplier:.4f} at {whole.control_displacement:.5f} m, before a part "
        "collapses",
    )
    rows = (
        *[capacity] * curve.rises_after_collapse,
        (highest, f"{peak.load_multiplier:.4f} at {peak.control_displacement:.5f} m"),
        ("limit analysis", _limits(beside)),
        ("ultimate displacement", end),
        *event_rows(curve),
        ("points", f"{len(curve.points)}, largest residual {curve.residual.max():.1e}"),
        ("time", f"{curve.wall_time:.1f} s ({curve.engine}, {curve.strategy})"),
        ("results", f"{folder}/"),
    )
    return "\n".join([title, *(f"  {name:<22} {printable(value)}" for name, value in rows)])


def event_rows(curve: CapacityCurve) -> list[tuple[str, str]]:
    """The first few events, a row each."""
    rows = [("event", str(event)) for event in curve.events[:MOST_EVENTS]]
    more = len(curve.events) - len(rows)
    return rows + [("", f"and {more} more, see summary.json")] * (more > 0)


def _support_text(title: str, curve: CapacityCurve, folder: Path) -> str:
    """The same of supports that move."""
    from drystone.model.construction.words import printable
    from drystone.report.quantities import Quantities

    shown = Quantities.of(curve)
    force, unit = shown.force_unit, shown.motion_unit
    marked, size_of = curve.marked_reactions, reaction_texts(curve)

    def shown_at(name: str) -> str:
        at = shown.per_unit * marked[name].control_displacement
        return f"{size_of[name]} {force}" + f" at {at:.5g} {unit}" * (name != "first")

    rows = (
        ("reaction at first", shown_at("first")),
        ("least reaction", shown_at("least")),
        ("reaction at last", shown_at("last")),
        *event_rows(curve),
        ("end", curve.reason),
        ("points", f"{len(curve.points)}, largest residual {curve.residual.max():.1e}"),
        ("time", f"{curve.wall_time:.1f} s ({curve.engine})"),
        ("results", f"{folder}/"),
    )
    return "\n".join([title, *(f"  {name:<22} {printable(value)}" for name, value in rows)])


def reaction_texts(curve: CapacityCurve) -> dict[str, str]:
    """First, least, greatest and last reaction, in its unit; what is rounding is zero."""
    from drystone.common.tolerances import LAST_DIGITS

    sizes = {name: point.reaction for name, point in curve.marked_reactions.items()}
    rounding = LAST_DIGITS * max(map(abs, sizes.values()))
    return {name: f"{0.0 if abs(s) <= rounding else s:.6g}" for name, s in sizes.items()}


def _limits(beside: Beside) -> str:
    """Both collapse multipliers, or why there are none."""
    from drystone.limit import multiplier_text, range_text

    found = []
    if beside.associative is not None:
        lowest, bound = multiplier_text(beside.associative, 4), beside.upper_bound
        wide = bound is not None and f"{bound:.4f}" != lowest
        more = f" (across corners up to {bound:.4f})" if wide else ""
        found.append(f"{lowest} associative{more}")
    if beside.collapse_range is not None:
        found.append(f"{range_text(beside.collapse_range, 4)} non-associative")
    return ", ".join(found + [beside.note] * bool(beside.note))
