"""``drystone view``: a page, or an animation, to see a structure move along its curve."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drystone.cli.options import AsJson, Quiet
from drystone.cli.outcome import DONE, emit, outcome, tell

if TYPE_CHECKING:
    from drystone.report.viewer.folder import Folder

#: Endings of animations, and of pages.
ANIMATIONS, PAGES = (".gif", ".mp4"), (".html", ".htm", "")

Results = Annotated[
    Path, typer.Argument(metavar="DIR", help="Folder of results.", show_default=False)
]


def view(
    folder: Results,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Page, or animation .gif or .mp4. [default: DIR/view.html]"
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write the viewer: one page that shows blocks, joints and forces at every point of the curve.

    The page needs no other file, and opens by a double click.  For a run that still goes on, or
    that was killed, it shows the points so far.  If FILE ends in .gif or .mp4, an animation for
    slides is written instead.
    """
    with outcome(as_json=as_json):
        from drystone.io.results.folder import OutputError, check_apart, check_place, in_a_sentence
        from drystone.io.results.names import RESULTS
        from drystone.report.viewer.folder import Folder

        path = folder / "view.html" if out is None else out
        if path.suffix.lower() not in (*ANIMATIONS, *PAGES):
            raise OutputError(f"--out: {path}: must end in .html, .gif or .mp4")
        found = Folder.read(folder)
        tell(found.warnings)
        check_place(path)
        check_apart(folder / RESULTS, [path])
        if found.results.model is not None:
            check_apart(found.results.model.source, [path])
        if path.suffix.lower() in ANIMATIONS:
            _animate(found, path)
        else:
            from drystone.report.viewer.page import write_page

            in_a_sentence(lambda: write_page(found.contents(), path))
        if as_json:
            emit({"status": "done", "file": str(path), "bytes": path.stat().st_size})
        elif not quiet:
            typer.echo(f"{path} is written ({path.stat().st_size / 1e6:.1f} MB)")
    raise typer.Exit(DONE)


def _animate(found: Folder, path: Path) -> None:
    """Write the animation of a folder, whole or not at all."""
    import os

    from drystone.io.results.folder import OutputError, in_a_sentence
    from drystone.report.animation import animate

    curve, model = found.results.curve, found.results.model
    if model is None:
        raise OutputError(
            f"{found.results.path}: the model in it cannot be read by this version: trace it again"
        )
    if not curve.points:
        raise OutputError(f"{found.results.path}: its curve has no points yet: nothing moves")
    draft = path.with_name(f".{path.stem}.part{path.suffix}")  # its ending says what is written

    def write() -> None:
        animate(curve, model, draft)
        os.replace(draft, path)

    try:
        in_a_sentence(write)
    finally:
        draft.unlink(missing_ok=True)
