"""``drystone verify``: closed forms, published walls and laboratory tests in one table."""

from __future__ import annotations

from typing import Annotated

import typer

from drystone.cli.options import AsJson, Quiet
from drystone.cli.outcome import DONE, emit, outcome

All = Annotated[bool, typer.Option("--all", help="All cases; else those of the quick set.")]
HEADS = ("case", "source", "expected", "got", "error %", "s")


def verify(everything: All = False, as_json: AsJson = False, quiet: Quiet = False) -> None:
    """Compute cases that are known otherwise, and print expected and computed values."""
    with outcome(as_json=as_json):
        from drystone.laboratory.verification import cases, checked

        rows = []
        widths = (58, 48, 10, 10, 9, 6)
        if not as_json:
            typer.echo(_line(HEADS, widths))
        for row in checked(cases(everything=everything)):
            rows.append(row)
            if not as_json:
                cells = (
                    row.case.name,
                    f"{row.case.kind}: {row.case.source}",
                    f"{row.case.expected:.5g}",
                    f"{row.got:.5g}",
                    f"{100.0 * row.error:+.2g}" if abs(row.error) > 1e-12 else "0",
                    f"{row.seconds:.1f}",
                )
                typer.echo(_line(cells, widths))
        if as_json:
            emit({"rows": [row.as_dict() for row in rows]})
    raise typer.Exit(DONE)


def _line(cells: tuple[str, ...], widths: tuple[int, ...]) -> str:
    left = [cell.ljust(width) for cell, width in zip(cells[:2], widths[:2], strict=True)]
    right = [cell.rjust(width) for cell, width in zip(cells[2:], widths[2:], strict=True)]
    return " ".join([*left, *right])
