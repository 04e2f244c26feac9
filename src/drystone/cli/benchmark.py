"""``drystone benchmark``: the published walls, ours beside the published values."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drystone.cli.options import AsJson, Language, Quiet, Strategy
from drystone.cli.outcome import DONE, INTERRUPTED, UNFINISHED, WRONG, emit, fail, outcome, tell
from drystone.common.language import speaking

if TYPE_CHECKING:
    from drystone.analysis.benchmark import BenchmarkRow

#: Two lines over each column.
HEADER = (
    ("", "wall"),
    ("Gilbert", "2006"),
    ("LMGC90", "peak"),
    ("UDEC", "peak"),
    ("error", "%"),
    ("", "engine"),
    ("limit", "assoc"),
    ("limit", "non-a"),
    ("our", "peak"),
    ("spread", "%"),
    ("LMGC90", "end m"),
    ("our", "end m"),
    ("time", "s"),
)
HEADS = ["\n".join(head) for head in HEADER]
SPREAD = HEADER.index(("spread", "%"))
NOTE = (
    "end: control displacement at the multiplier 0.01; error: LMGC90's peak less UDEC's over "
    "the former;\nlimit: our limit analysis, associative and not, same corners"
)
NOTE_OF_SPREAD = "; spread: between our engines' peaks"


Engines = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME",
        help="Engine; may be repeated. [default: equilibrium]",
        show_default=False,
    ),
]
Walls = Annotated[
    list[int] | None,
    typer.Option(
        metavar="N",
        min=1,
        max=3,
        help="Wall; may be repeated. [default: all]",
        show_default=False,
    ),
]
Folder = Annotated[Path, typer.Option(metavar="DIR", help="Folder of results.")]
Reference = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        exists=True,
        file_okay=False,
        help="Folder with recorded curves wallN_*.csv, which are drawn for comparison.",
        show_default=False,
    ),
]
Loading = Annotated[Strategy, typer.Option(help="How the load is applied.")]


class Which(StrEnum):
    """What is computed."""

    published = "published"
    laboratory = "laboratory"


Chosen = Annotated[
    Which,
    typer.Argument(
        metavar="[published|laboratory]",
        help="The walls of the paper, or walls tested in laboratories.",
    ),
]


# Long: what two kinds of walls are asked for, and told.
def benchmark(
    which: Chosen = Which.published,
    engine: Engines = None,
    wall: Walls = None,
    out: Folder = Path("benchmark-results"),
    reference: Reference = None,
    strategy: Loading = Strategy.displacement,
    language: Annotated[
        Language,
        typer.Option(help="Language of the tables and pictures of laboratory walls."),
    ] = Language.en,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Analyse the published walls, or walls tested in laboratories, and print a table."""
    begun = False
    if which is Which.laboratory:
        with outcome(as_json=as_json):
            from drystone.cli.laboratory import run_laboratory
            from drystone.model.construction.errors import ModelError

            given = {
                "engine": engine,
                "wall": wall,
                "reference": reference,
                "strategy": strategy is not Strategy.displacement,
            }
            if wrong := [f"--{key}" for key, value in given.items() if value]:
                raise ModelError([f"{', '.join(wrong)}: is for the published walls: take it out"])
            with speaking(language.value):
                run_laboratory(out, (), as_json=as_json, quiet=quiet)
        raise typer.Exit(DONE)
    with outcome(as_json=as_json, begun=lambda: begun):
        from drystone.analysis.benchmark import benchmark as analyse
        from drystone.cli.compiler import compiling
        from drystone.common.progress import progress_for
        from drystone.io.results.folder import check_writable
        from drystone.model.builders.published import PUBLISHED_WALLS
        from drystone.model.model import Analysis
        from drystone.report.folder.benchmark import recorded_curves, write_benchmark

        walls = list(dict.fromkeys(wall or PUBLISHED_WALLS))
        check_writable(out)
        if reference:
            for number in walls:  # a fault in them is better known before the work
                recorded_curves(reference, number)
        engines = list(dict.fromkeys(engine or ()))
        with compiling(engines[0] if engines else Analysis().engine, 2, quiet=quiet or as_json):
            result = analyse(
                walls=walls,
                engines=engines,
                strategy=strategy.value,
                progress=lambda title, model: progress_for(
                    title, model.analysis.stop_multiplier, quiet=quiet
                ),
            )
        rows = result.rows
        unfinished = [row for row in rows if row.status != "finished"]
        problems = [f"wall {row.wall}, {row.engine}: {row.reason}" for row in unfinished]
        if all(row.n_points == 0 for row in rows):
            fail(INTERRUPTED if result.interrupted else WRONG, problems, as_json=as_json)
        begun = True
        write_benchmark(result, out, reference=reference)
        tell(problems)
        tell([f"wall {row.wall}, {row.engine}: {row.warning}" for row in rows if row.warning])
        if as_json:
            emit(
                {"rows": [asdict(row) for row in rows], "problems": problems, "directory": str(out)}
            )
        else:
            print_table(rows)
            typer.echo(f"Curves and pictures are in {out}/")
    raise typer.Exit(INTERRUPTED if result.interrupted else UNFINISHED if unfinished else DONE)


def print_table(rows: Sequence[BenchmarkRow]) -> None:
    """Table 1 on standard output: ruled on a terminal, plain columns elsewhere."""
    lines = [HEADS, *(cells(row) for row in rows)]
    note = NOTE + NOTE_OF_SPREAD
    if all(row.spread is None for row in rows):  # one engine: the terminal has better uses
        note = NOTE
        lines = [line[:SPREAD] + line[SPREAD + 1 :] for line in lines]
    heads, *lines = lines
    if sys.stdout.isatty():
        print_ruled(heads, lines)
    else:
        typer.echo(plain_table(heads, lines))
    typer.echo(note)


def print_ruled(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> None:
    """Columns with a rule under their heads, narrow enough for a terminal of 80."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 0), pad_edge=False)
    for head in heads:
        table.add_column(head, justify="right", no_wrap=True)
    for line in lines:
        table.add_row(*line)
    Console().print(table)


def plain_table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Columns as wide as they need to be, two spaces apart."""
    lines = [*zip(*(head.split("\n") for head in heads), strict=True), *lines]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join(
        "  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True))
        for line in lines
    )


def cells(row: BenchmarkRow) -> list[str]:
    """One line of the table as text."""
    from drystone.limit import range_text

    return [
        str(row.wall),
        f"{row.peak_gilbert:.3f}",
        f"{row.peak_lmgc90:.3f}",
        f"{row.peak_udec:.3f}",
        f"{row.published_error:+.2f}",
        row.engine,
        _number(row.associative_multiplier, ".3f"),
        "-" if row.collapse_range is None else range_text(row.collapse_range, 3),
        _number(row.peak_multiplier, ".3f"),
        _number(row.spread, ".2f"),
        f"{row.ultimate_displacement_lmgc90:.3f}",
        _number(row.ultimate_displacement, ".3f"),
        _number(row.wall_time, ".1f"),
    ]


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
