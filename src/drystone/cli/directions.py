"""``drystone run --directions``: a model pushed in both senses, or all around, in parallel."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from drystone.cli.outcome import DONE, INTERRUPTED, UNFINISHED, WRONG, emit, fail, tell
from drystone.io.results.names import RESULTS, SUMMARY
from drystone.io.results.senses import DIRECTION

if TYPE_CHECKING:
    from drystone.model.model import Model
    from drystone.report.folder.directory import ResultsDirectory
    from drystone.report.folder.taking_over import TakingOver
    from drystone.results.curve import CapacityCurve

#: What the file of all directions says of each, from the summary of its own folder.
COLUMNS = (
    "angle", "direction", "folder", "status", "reason", "peak_multiplier", "peak_displacement",
    "peak_passed", "capacity_multiplier", "capacity_displacement", "ultimate_displacement",
    "associative_multiplier", "non_associative_multiplier", "n_points", "max_residual", "wall_time",
)  # fmt: skip
TABLE, PICTURE = "directions.csv", "directions.png"
BOTH = "both"


class Asked(NamedTuple):
    """What every curve is traced and drawn with."""

    engine: str | None
    strategy: str | None
    mechanism_at: float | None  # m
    formats: tuple[str, ...] = ()  # of pictures, beside PNG


def number_of(text: str) -> int:
    """How many directions are asked for; raises `typer.BadParameter`."""
    if text == BOTH:
        return 2
    if not text.isdecimal() or not 2 <= int(text) <= 360:
        raise typer.BadParameter(
            f'it must be "{BOTH}", or a whole number from 2 to 360', param_hint="--directions"
        )
    return int(text)


def run_directions(
    model: Model,
    number: int,
    folder: Path,
    asked: Asked,
    *,
    processes: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Trace all curves, each into a folder of its own, and write what they have in common.

    Returns the exit status: that of the worst of them.
    """
    from drystone.analysis.directions import evenly
    from drystone.io.results.folder import locked
    from drystone.report.folder.taking_over import TakingOver, clear_claim

    with locked(folder):
        angles = evenly(model, number)
        takes_over = TakingOver.of(
            folder,
            model,
            {"number": number, "asked": list(asked)},
            [folder_name(angle) for angle in angles],
        )
        try:
            summary, code = _in_folders(
                model,
                number,
                folder,
                asked,
                takes_over=takes_over,
                processes=processes,
                as_json=as_json,
                quiet=quiet,
            )
        finally:
            clear_claim(folder)
    return _shown(summary, folder, code, as_json=as_json)


def resume_directions(
    folder: Path,
    ends: Mapping[str, float | None],
    *,
    processes: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Go on with all curves of a folder that are not complete; returns the exit status."""
    from drystone.io.results.checkpoint import CheckpointError, read_plan
    from drystone.io.results.folder import OutputError, locked
    from drystone.report.folder.taking_over import clear_claim

    with locked(folder):
        clear_claim(folder)
        try:
            found = read_plan(folder)
        except CheckpointError as error:
            raise OutputError(f"{folder}: {error}: run the model again") from None
        if found is None:
            raise OutputError(f"{folder} tells no directions: run the model again")
        model, plan = found
        engine, strategy, mechanism_at, formats = plan["asked"]
        summary, code = _in_folders(
            model,
            plan["number"],
            folder,
            Asked(engine, strategy, mechanism_at, tuple(formats)),
            going_on=dict(ends),
            processes=processes,
            as_json=as_json,
            quiet=quiet,
        )
    return _shown(summary, folder, code, as_json=as_json)


def _shown(summary: dict[str, Any], folder: Path, code: int, *, as_json: bool) -> int:
    if as_json:
        emit({**summary, "directory": str(folder)})
    else:
        typer.echo(report(summary, folder))
    return code


def _in_folders(
    model: Model,
    number: int,
    folder: Path,
    asked: Asked,
    *,
    processes: int | None,
    as_json: bool,
    quiet: bool,
    takes_over: TakingOver | None = None,
    going_on: dict[str, float | None] | None = None,
) -> tuple[dict[str, Any], int]:
    """Trace all curves, or go on with them to whatever ends, in a folder that this process holds;
    what they have in common, and the exit status."""
    from drystone.analysis.directions import around, evenly
    from drystone.common.threads import available
    from drystone.common.workers import in_processes

    angles = evenly(model, number)
    models = around(model, angles)
    folders = [folder / folder_name(angle) for angle in angles]
    came = 0

    def told(k: int, found: dict[str, Any]) -> None:
        nonlocal came
        came += 1
        if not quiet:
            what = found["status"]
            if found.get("peak_multiplier") is not None:
                what += f", {_strength(found)}"
            tell([f"{came} of {number}: {angles[k]:g} degrees, {what}"])

    calls = [
        (f"{__name__}:trace", (each, str(own), asked, takes_over, going_on))
        for each, own in zip(models, folders, strict=True)
    ]
    results = in_processes(calls, processes or available(), told)
    rows = []
    for angle, each, own, result in zip(angles, models, folders, results, strict=True):
        found = result or {"status": "interrupted", "reason": "interrupted before it began"}
        about = {"angle": angle, "direction": each.load_along.tolist(), "folder": own.name}
        rows.append({**found, **about})
    if not any(row.get("curve") for row in rows):
        code = INTERRUPTED if None in results else WRONG
        reasons = list(dict.fromkeys(row["reason"] for row in rows))
        fail(code, [*reasons, "nothing was written"], as_json=as_json, status=rows[0]["status"])
    statuses = {row["status"] for row in rows}
    code = DONE if statuses == {"finished"} else UNFINISHED
    return write(model, rows, folder), INTERRUPTED if "interrupted" in statuses else code


def folder_name(angle: float) -> str:
    """Of the results of one direction [degrees]: three digits, and decimals where it has any."""
    whole, decimals = f"{angle:.3f}".rstrip("0").rstrip(".").partition(".")[::2]
    return f"{DIRECTION}{int(whole):03d}" + (f".{decimals}" if decimals else "")


def trace(
    model: Model,
    folder: str,
    asked: Asked,
    takes_over: TakingOver | None = None,
    going_on: dict[str, float | None] | None = None,
) -> dict[str, Any]:
    """The curve of one direction, written into its folder by a worker; its figures.

    The first direction with a point ``takes_over`` the folder of all.  A run that is ``going_on``,
    with whatever ends, leaves a direction where it is complete.
    """
    from drystone.analysis.driver import pushover
    from drystone.engines.base import EngineError
    from drystone.limit import limits_beside, on_what_moves
    from drystone.report.folder.directory import ResultsDirectory
    from drystone.report.folder.resume import extended_to

    try:
        with ResultsDirectory(
            Path(folder),
            mechanism_displacement=asked.mechanism_at,
            formats=asked.formats,
            takes_over=takes_over,
        ) as results:
            if going_on is not None and (results.path / RESULTS).is_file():
                return _taken_up(results, going_on)
            model = extended_to(model, going_on or {})
            results.beside = limits_beside(model)
            curve = pushover(
                on_what_moves(model, results.beside),
                engine=asked.engine,
                strategy=asked.strategy,
                recorder=results,
                threads=1,
                progress=False,
            )
    except EngineError as error:
        return {"status": "failed", "reason": str(error)}
    except KeyboardInterrupt:
        return {"status": "interrupted", "reason": "interrupted before the first point"}
    return _figures(results.summary or {}, curve)


def _taken_up(results: ResultsDirectory, ends: dict[str, float | None]) -> dict[str, Any]:
    """The figures of a direction that was begun, traced to its end."""
    from drystone.limit import limits_beside
    from drystone.report.folder.results import load_results
    from drystone.report.folder.resume import extended_to, go_on

    kept = results.take_up()
    if kept.complete and not ends:
        stored = load_results(results.path)
        return _figures(stored.summary, stored.curve)
    model = extended_to(kept.model, ends)
    results.beside = limits_beside(model)
    curve = go_on(kept, model, results, threads=1, progress=False)
    return _figures(results.summary or {}, curve)


def _figures(summary: dict[str, Any], curve: CapacityCurve) -> dict[str, Any]:
    from drystone.report.directions_figure import at_rest

    return {**summary, "curve": at_rest(curve)}


def write(model: Model, rows: Sequence[dict[str, Any]], folder: Path) -> dict[str, Any]:
    """``summary.json``, ``directions.csv`` and ``directions.png`` of all directions."""
    import csv

    from drystone.common.version import package_version
    from drystone.io.results.folder import in_a_sentence, whole_file
    from drystone.io.results.interrupts import uninterrupted
    from drystone.io.results.summary import plain, rises_after_collapse, write_summary
    from drystone.report.directions_figure import Traced, draw_directions

    known = [row for row in rows if row.get("peak_multiplier") is not None]
    least = _least(rows, "peak_multiplier")
    weakest = _least(rows, "capacity_multiplier")
    summary = plain(
        {
            "title": model.title,
            "model": model.source,
            "model_sha256": model.sha256,
            "version": package_version(),
            "n_directions": len(rows),
            "least_peak_multiplier": least.get("peak_multiplier"),
            "least_at": least.get("angle"),
            "least_capacity_multiplier": weakest.get("capacity_multiplier"),
            "least_capacity_at": weakest.get("angle"),
            "directions": [{key: row.get(key) for key in COLUMNS} for row in rows],
        }
    )
    with uninterrupted():

        def files() -> None:
            write_summary(summary, folder / SUMMARY)
            with whole_file(folder / TABLE) as draft, draft.open("w", newline="") as file:
                table = csv.writer(file)
                table.writerow(COLUMNS)
                for row in summary["directions"]:
                    table.writerow(_cell(row[key]) for key in COLUMNS)
            with whole_file(folder / PICTURE) as draft:
                draw_directions(
                    [
                        Traced(
                            angle=row["angle"],
                            curve=row["curve"],
                            capacity=(row["capacity_displacement"], row["capacity_multiplier"]),
                            rises_after_collapse=rises_after_collapse(row),
                        )
                        for row in known
                    ],
                    draft,
                    title=model.title,
                )

        in_a_sentence(files)
    return summary  # type: ignore[no-any-return]


def _least(rows: Sequence[Mapping[str, Any]], multiplier: str) -> Mapping[str, Any]:
    """The direction with the least of these multipliers; empty where it is not known.

    Where a curve has not passed its peak, the multiplier so far is a lower bound.
    """
    from drystone.io.results.summary import rises_after_collapse

    def is_known(row: Mapping[str, Any]) -> bool:
        if not row.get("curve"):
            return False
        of_whole = multiplier == "capacity_multiplier" and rises_after_collapse(row)
        return of_whole or bool(row["peak_passed"])

    passed = [row for row in rows if is_known(row)]
    if not passed:
        return {}
    least = min(passed, key=lambda row: row[multiplier])
    known = all((row.get(multiplier) or 0.0) >= least[multiplier] for row in rows)
    return least if known else {}


def _cell(value: Any) -> Any:
    return " ".join(f"{x:.12g}" for x in value) if isinstance(value, list) else value


def report(summary: dict[str, Any], folder: Path) -> str:
    """A line for each direction, and the weakest of them."""
    from drystone.model.construction.words import printable

    lines = [printable(summary["title"])]
    for row in summary["directions"]:
        peak, end = (row[key] for key in ("peak_multiplier", "ultimate_displacement"))
        what = row["reason"] if peak is None else _strength(row)
        if peak is not None:
            what += (
                f", ultimate displacement {end:.4f} m" if end is not None else ", no end reached"
            )
        if row["status"] != "finished":
            what += f" ({row['status']})"
        lines.append(f"  {_degrees(row['angle']):<22} {printable(what)}")
    rows = summary["directions"]
    if (least := summary["least_capacity_multiplier"]) is None:
        n_open = sum(not row["peak_passed"] for row in rows)
        what = f"not known: {n_open} of {len(rows)} directions have not passed their peak"
    else:
        what = f"{least:.4f} at {_degrees(summary['least_capacity_at'])}"
    return "\n".join([*lines, f"  {'least capacity':<22} {what}", f"  {'results':<22} {folder}/"])


def _strength(row: Mapping[str, Any]) -> str:
    """What the whole structure bears, and what is left of it where that bears more."""
    from drystone.io.results.summary import rises_after_collapse

    capacity, peak = row["capacity_multiplier"], row["peak_multiplier"]
    if rises_after_collapse(row):
        return f"capacity {capacity:.4f} before a part collapses, peak {peak:.4f} of what is left"
    return f"{'peak' if row['peak_passed'] else 'highest so far'} {peak:.4f}"


def _degrees(angle: float) -> str:
    return "0 degrees" if math.isclose(angle, 0.0) else f"{angle:g} degrees"
