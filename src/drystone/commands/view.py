"""``drystone view``: a page to see a structure move along its curve."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drystone.commands.options import AsJson, Quiet
from drystone.commands.outcome import DONE, emit, outcome

Results = Annotated[
    Path, typer.Argument(metavar="DIR", help="Folder of results.", show_default=False)
]


def view(
    folder: Results,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Page to write. [default: DIR/view.html]"),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write the viewer: one page that shows blocks, joints and forces at every point of the curve.

    It holds everything that it needs, and opens by a double click.  Folders of runs that go on,
    or that were killed, are shown as far as they reach.
    """
    with outcome(as_json=as_json):
        from drystone.export.directory import RESULTS
        from drystone.export.folder import check_apart
        from drystone.viewer.folder import Folder
        from drystone.viewer.page import write_page

        path = folder / "view.html" if out is None else out
        found = Folder.read(folder)
        check_apart(folder / RESULTS, [path])
        if found.results.model is not None:
            check_apart(found.results.model.source, [path])
        write_page(found.contents(), path)
        if as_json:
            emit({"status": "done", "file": str(path), "bytes": path.stat().st_size})
        elif not quiet:
            typer.echo(f"{path} is written ({path.stat().st_size / 1e6:.1f} MB)")
    raise typer.Exit(DONE)
