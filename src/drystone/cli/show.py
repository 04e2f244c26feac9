"""``drystone show``: a picture of a model before it is run, or a page to turn it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drystone.cli.options import AsJson, ModelFile, Quiet
from drystone.cli.outcome import DONE, emit, outcome

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
    names: Annotated[
        bool, typer.Option("--names", help="Write the names of the blocks into the picture.")
    ] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Draw a model: blocks, supports, load, control point, and the joints found with their areas.

    Faces that lie near each other without a joint are red. For a drawing, or a file that is not a
    complete model, the blocks are drawn, in red where they overlap.
    """
    with outcome(as_json=as_json):
        from drystone.cli.sketches import lacking, model_or_sketch, refused
        from drystone.io.modelfile import ModelError
        from drystone.io.modelfile.sketch import Sketch
        from drystone.io.results.folder import check_apart
        from drystone.report.model_figure import ENDINGS, draw_model

        path = Path(f"{model_file.stem}.png") if out is None else out
        if path.suffix.lower() not in (*ENDINGS, PAGE):
            raise ModelError([f"--out: {path}: must end in {', '.join((*ENDINGS, PAGE))}"])
        check_apart(model_file, [path])
        page = path.suffix.lower() == PAGE
        if names and page:
            raise ModelError(["--names: is for pictures; the page shows names by itself"])
        model, wrong = model_or_sketch(model_file)
        missing: list[str] = []
        if isinstance(model, Sketch):
            from drystone.report.sketch_figure import draw_sketch

            against = refused(model, wrong)
            if page:
                raise ModelError(against or [f"--out: {path}: {lacking(model)}: take a picture"])
            draw_sketch(model, path, names=names)
            if against:
                raise ModelError([*against, f"{path} shows the blocks"])
            missing = [lacking(model)]
        elif page:
            from drystone.report.viewer import contents_of_model, write_page

            write_page(contents_of_model(model), path)
        else:
            draw_model(model, path, title=model.title, names=names)
        if as_json:
            more = {"problems": missing} if missing else {}
            emit({"status": "done", "file": str(path), **more})
        elif not quiet:
            typer.echo("\n".join([f"{path} is written", *(f"  note: {one}" for one in missing)]))
    raise typer.Exit(DONE)
