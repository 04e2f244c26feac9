"""``drystone show``: a picture of a model before it is run, or a page to turn it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drystone.commands.options import AsJson, ModelFile, Quiet
from drystone.commands.outcome import DONE, emit, outcome

#: Ending of the page that shows a model in a browser.
PAGE = ".html"


def show(
    model_file: ModelFile,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Picture to write, .png, .svg or .pdf, or .html to turn it in a browser. "
            "[default: MODEL's name with .png, here]",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Draw a model: blocks, supports, load, control point, and the joints found with their areas.

    Faces that lie near each other without a joint are red.
    """
    with outcome(as_json=as_json):
        from drystone.engines import engine_names
        from drystone.export.folder import check_apart
        from drystone.modelfile import ModelError, read_model
        from drystone.report.model_figure import ENDINGS, draw_model

        path = Path(f"{model_file.stem}.png") if out is None else out
        if path.suffix.lower() not in (*ENDINGS, PAGE):
            raise ModelError([f"--out: {path}: must end in {', '.join((*ENDINGS, PAGE))}"])
        check_apart(model_file, [path])
        model = read_model(model_file, need_stiffness=False, engines=engine_names())
        if path.suffix.lower() == PAGE:
            from drystone.viewer import contents_of_model, write_page

            write_page(contents_of_model(model), path)
        else:
            draw_model(model, path, title=model.title)
        if as_json:
            emit({"status": "done", "file": str(path)})
        elif not quiet:
            typer.echo(f"{path} is written")
    raise typer.Exit(DONE)
