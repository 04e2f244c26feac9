"""``drystone report``: everything that is known of a folder of results, on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drystone.cli.options import AsJson, Language, Quiet
from drystone.cli.outcome import DONE, emit, outcome, tell
from drystone.cli.view import Results


def report(
    folder: Results,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Page to write. [default: DIR/report.html]"),
    ] = None,
    language: Annotated[
        Language | None,
        typer.Option(
            "--language",
            help="Language of the report. [default: what the model says]",
            show_default=False,
        ),
    ] = None,
    files: Annotated[
        bool,
        typer.Option(
            "--files",
            help="Also write tables, summary, pictures and the series for ParaView, which a run "
            "that was killed does not have.",
        ),
    ] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write a report: model, curve, certificate, mechanism, assessment, viewer.

    The report is one page that needs no network and prints on A4.  Its assessment is that of the
    folder's assessment.json.  If there is none, it is made if the model asks for one.  For a run
    that still goes on, or that was killed, the report covers the points so far.
    """
    with outcome(as_json=as_json):
        from drystone.io.results.folder import check_apart, check_place, in_a_sentence
        from drystone.io.results.names import RESULTS
        from drystone.io.results.own_files import ASSESSMENT
        from drystone.report.document.report import write_report
        from drystone.report.viewer.folder import Folder

        path = folder / "report.html" if out is None else out
        if (folder / "study.json").is_file():
            from drystone.studies.page import write_page

            check_place(path)
            in_a_sentence(lambda: write_page(folder, path, language=language))
            _tell(path, as_json=as_json, quiet=quiet)
            raise typer.Exit(DONE)
        if files:
            from drystone.report.folder.completing import write_files

            in_a_sentence(lambda: write_files(folder))
        found = Folder.read(folder)
        tell(found.warnings)
        check_place(path)
        for kept in (folder / RESULTS, folder / ASSESSMENT):
            check_apart(kept, [path])
        if found.results.model is not None:
            check_apart(found.results.model.source, [path])
        in_a_sentence(lambda: write_report(path, found, language=language))
        _tell(path, as_json=as_json, quiet=quiet)
    raise typer.Exit(DONE)


def _tell(path: Path, *, as_json: bool, quiet: bool) -> None:
    if as_json:
        emit({"status": "done", "file": str(path), "bytes": path.stat().st_size})
    elif not quiet:
        typer.echo(f"{path} is written ({path.stat().st_size / 1e6:.1f} MB)")
