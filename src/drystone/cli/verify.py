"""``drystone verify``: closed forms, published walls and laboratory tests in one table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drystone.cli.options import AsJson, Quiet
from drystone.cli.outcome import DONE, emit, outcome, tell

All = Annotated[
    bool, typer.Option("--all", help="Compute all cases, not only those of the quick set.")
]
Page = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        dir_okay=False,
        help="Also write the table as a page in Markdown.",
        show_default=False,
    ),
]

#: Exit status where a case is beyond its bound.
BEYOND = 1


def verify(
    everything: All = False, out: Page = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Compute cases with a known answer, and print expected and computed values.

    Each case has a bound of its error. The exit status is 1 if a case exceeds its bound and the
    cause of this is not known.
    """
    with outcome(as_json=as_json):
        from drystone.common.version import package_version
        from drystone.verification import page
        from drystone.verification.case import FAILS, KNOWN, checked
        from drystone.verification.cases import cases, introductions

        rows = []
        if not as_json:
            typer.echo(page.head())
        for row in checked(cases(everything=everything)):
            rows.append(row)
            if not as_json:
                typer.echo(page.line(row))
        if out is not None:
            text = page.markdown(rows, introductions(), package_version())
            out.write_text(text, encoding="utf-8")
        failed = [row for row in rows if row.outcome == FAILS]
        if as_json:
            emit({"rows": [row.as_dict() for row in rows], "failed": len(failed)})
        else:
            typer.echo(page.summary(rows))
            for row in rows:
                if row.outcome == KNOWN:
                    typer.echo(f"{row.case.name}: {row.case.known}")
        if failed and not quiet:
            tell([f"beyond its bound: {row.case.name} ({row.case.reason})" for row in failed])
    raise typer.Exit(BEYOND if failed else DONE)
