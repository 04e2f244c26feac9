"""All commands, one per verb of the library.

A new command is a function in `drystone.cli` and one line here.
"""

from __future__ import annotations

from typing import Annotated

import typer

from drystone.cli.assess import assess
from drystone.cli.benchmark import benchmark
from drystone.cli.check import check
from drystone.cli.compare import compare
from drystone.cli.convert import convert
from drystone.cli.limit import limit
from drystone.cli.report import report
from drystone.cli.run import run
from drystone.cli.show import show
from drystone.cli.study import study
from drystone.cli.verify import verify
from drystone.cli.view import view

app = typer.Typer(
    name="drystone",
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,  # plain help comes up several times faster
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        from drystone.common.version import package_version

        typer.echo(f"drystone {package_version()}")
        raise typer.Exit


@app.callback()
def drystone(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Pushover curves of masonry made of rigid blocks, past the peak and down to nothing."""


app.command()(run)
app.command()(study)
app.command()(limit)
app.command()(check)
app.command()(show)
app.command()(assess)
app.command()(compare)
app.command()(report)
app.command()(view)
app.command()(convert)
app.command()(benchmark)
app.command()(verify)
