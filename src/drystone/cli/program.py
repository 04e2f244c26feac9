"""All commands, one per verb of the library.

A new command is a module of `drystone.cli` and its name here.
"""

from __future__ import annotations

from importlib import import_module
from typing import Annotated

import typer

#: By the order of the help: each is a function of that name in a module of that name.
COMMANDS = (
    "run",
    "study",
    "limit",
    "check",
    "show",
    "assess",
    "compare",
    "report",
    "view",
    "convert",
    "benchmark",
    "verify",
)


def program(wanted: str = "") -> typer.Typer:
    """The program with the command that is ``wanted``; with all where that is none of them.

    All of them take ten times as long to make as one.
    """
    app = typer.Typer(
        name="drystone",
        add_completion=False,
        no_args_is_help=True,
        rich_markup_mode=None,  # plain help comes up several times faster
        pretty_exceptions_enable=False,
    )
    app.callback()(drystone)
    for name in (wanted,) if wanted in COMMANDS else COMMANDS:
        app.command()(getattr(import_module(f"drystone.cli.{name}"), name))
    return app


def _version(wanted: bool) -> None:
    if wanted:
        from drystone.common.version import package_version

        typer.echo(f"drystone {package_version()}")
        raise typer.Exit


def drystone(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Pushover curves of masonry made of rigid blocks, past the peak and down to nothing."""
