"""``drystone convert``: a model as another program's input file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drystone.commands.options import AsJson, ModelFile, Quiet
from drystone.commands.outcome import DONE, emit, outcome


def convert(
    model_file: ModelFile,
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="File to write.", show_default=False)
    ],
    to: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="udec, 3dec, lmgc90 or vtk. [default: by FILE's ending: .dat, .3ddat, .py, .vtk]",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write a model in another program's input format, and say what that cannot express."""
    with outcome(as_json=as_json):
        from drystone.convert import convert as write
        from drystone.convert import target_of
        from drystone.engines import engine_names
        from drystone.export.folder import check_apart
        from drystone.modelfile import read_model

        target = target_of(file, to)
        check_apart(model_file, [file])
        model = read_model(model_file, need_stiffness=False, engines=engine_names())
        notes = write(model, file, target.name)
        if as_json:
            emit({"status": "done", "target": target.name, "file": str(file), "notes": notes})
        elif not quiet:
            typer.echo(f"{file} is written for {target.name}")
            for note in notes:
                typer.echo(f"  note: {note}")
    raise typer.Exit(DONE)
