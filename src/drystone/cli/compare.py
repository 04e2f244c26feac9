"""``drystone compare``: curves of several folders in one picture and a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drystone.cli.options import AsJson, Quiet
from drystone.cli.outcome import DONE, emit, outcome

if TYPE_CHECKING:
    from drystone.report.folder.results import Results
    from drystone.results.curve import CapacityCurve

#: Displacements [m] below this are written with a power of ten.
LEAST_SHOWN = 1e-4

Folders = Annotated[
    list[Path], typer.Argument(metavar="DIR ...", help="Folders of results.", show_default=False)
]
Picture = Annotated[
    Path,
    typer.Option(metavar="FILE", help="Picture to write, .png, .svg or .pdf."),
]


def compare(
    folders: Folders,
    out: Picture = Path("compare.png"),
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Draw the curves of several folders into one picture, and print peaks and ends, or reactions
    of supports that move."""
    with outcome(as_json=as_json):
        from drystone.io.modelfile import ModelError
        from drystone.io.results.folder import check_place, in_a_sentence, whole_file
        from drystone.report.curve_figure import draw_curve
        from drystone.report.folder.results import load_results
        from drystone.report.model_figure import ENDINGS

        if out.suffix.lower() not in ENDINGS:
            raise ModelError([f"--out: {out}: must end in {', '.join(ENDINGS)}"])
        folders = with_extremes(folders)
        results = [load_results(folder) for folder in folders]
        check_place(out)
        empty = [str(found.path) for found in results if not found.curve.points]
        if empty:
            raise ModelError([f"{path}: its curve has no points yet" for path in empty])
        if len({(found.curve.moves_supports, found.curve.motion_unit) for found in results}) > 1:
            raise ModelError(
                ["loads, supports that go along and supports that turn have curves of other kinds: "
                 "compare folders of one kind"]
            )  # fmt: skip
        rows = [_row(name, found) for name, found in zip(_names(folders), results, strict=True)]
        curves = [(row["name"], found.curve) for row, found in zip(rows, results, strict=True)]

        def draw() -> None:
            with whole_file(out) as draft:
                draw_curve(curves, draft, format=out.suffix[1:].lower())

        in_a_sentence(draw)
        if as_json:
            emit({"status": "done", "file": str(out), "curves": rows})
        else:
            moves_supports = results[0].curve.moves_supports
            typer.echo(_reactions(curves) if moves_supports else _table(rows))
            if not quiet:
                typer.echo(f"{out} is written")
    raise typer.Exit(DONE)


def with_extremes(folders: Sequence[Path]) -> list[Path]:
    """The folders; in place of a study those of its samples of least and greatest peak, which are
    run again where they are not there."""
    found: list[Path] = []
    for folder in folders:
        if not (folder / "study.json").is_file():
            found.append(folder)
            continue
        from drystone.studies.conduct import extremes_of

        found += extremes_of(folder)
    return found


def _names(folders: Sequence[Path]) -> list[str]:
    """Names of the folders, as much of their paths as tells them apart."""
    whole = [folder.resolve() for folder in folders]
    for depth in range(1, max(len(path.parts) for path in whole) + 1):
        names = ["/".join(path.parts[-depth:]) for path in whole]
        if len(set(names)) == len(set(whole)):
            return names
    return [str(folder) for folder in folders]


def _row(name: str, found: Results) -> dict[str, Any]:
    from drystone.io.results.summary import reaction_figures

    curve: CapacityCurve = found.curve
    return {
        "name": name,
        "directory": str(found.path),
        "title": found.model.title if found.model else None,
        "engine": curve.engine,
        "status": curve.status,
        "peak_multiplier": curve.peak.load_multiplier,
        "peak_displacement": curve.peak.control_displacement,
        "peak_passed": curve.peak_passed,
        "capacity_multiplier": curve.capacity.load_multiplier,
        "capacity_displacement": curve.capacity.control_displacement,
        "ultimate_displacement": curve.ultimate_displacement,
        "last_displacement": curve.points[-1].control_displacement,
        "last_multiplier": curve.points[-1].load_multiplier,
        "n_points": len(curve.points),
        **(reaction_figures(curve) if curve.moves_supports else {}),
    }


def _table(rows: Sequence[dict[str, Any]]) -> str:
    from drystone.io.results.summary import rises_after_collapse
    from drystone.model.construction.words import printable

    width = max(8, *(len(row["name"]) for row in rows))
    lines = [
        f"{'':<{width}}  {'engine':<12} {'peak':>8} {'at [m]':>9} {'end [m]':>9}  status",
    ]
    for row in rows:
        lines.append(
            f"{printable(row['name']):<{width}}  {row['engine']:<12} "
            f"{row['peak_multiplier']:>8.4f} {_metres(row['peak_displacement']):>9} "
            f"{_metres(row['ultimate_displacement']):>9}  {row['status']}"
        )
        if rises_after_collapse(row):
            lines.append(
                f"{'':<{width}}  {'':<12} {row['capacity_multiplier']:>8.4f} "
                f"{_metres(row['capacity_displacement']):>9} {'':>9}  before a part collapses; the "
                "peak is that of what is left"
            )
    return "\n".join(lines)


def _reactions(curves: Sequence[tuple[str, CapacityCurve]]) -> str:
    """The table of supports that move, in the units of their pictures."""
    from drystone.cli.run import reaction_texts
    from drystone.model.construction.words import printable
    from drystone.report.quantities import Quantities

    shown = Quantities.of(curves[0][1])
    width = max(8, *(len(name) for name, _ in curves))
    force, at = shown.force_unit, f"at [{shown.motion_unit}]"
    head = [f"{name} [{force}]" for name in ("first", "least", "greatest", "last")]
    lines = [
        f"{'':<{width}}  {'engine':<12} {head[0]:>14} {head[1]:>14} {at:>9} {head[2]:>14} {at:>9} "
        f"{head[3]:>14} {at:>9}  status"
    ]
    for name, curve in curves:
        size, marked = reaction_texts(curve), curve.marked_reactions
        where = {k: f"{shown.per_unit * p.control_displacement:.5g}" for k, p in marked.items()}
        lines.append(
            f"{printable(name):<{width}}  {curve.engine:<12} {size['first']:>14} "
            f"{size['least']:>14} {where['least']:>9} {size['greatest']:>14} "
            f"{where['greatest']:>9} {size['last']:>14} {where['last']:>9}  {curve.status}"
        )
    return "\n".join(lines)


def _metres(value: float | None) -> str:
    """With as many digits as tell it from nothing."""
    if value is None:
        return "-"
    return f"{value:.5f}" if not 0.0 < abs(value) < LEAST_SHOWN else f"{value:.1e}"
