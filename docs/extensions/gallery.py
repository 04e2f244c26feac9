"""Directive that shows the examples: picture, title, what it shows, and the command to type.

``{gallery} FOLDER`` writes a table with a row for each model file and each study file of a folder,
``{scripts} FOLDER`` one with a row for each script.
Pictures are of the models as designed: nothing is analysed while the pages are built.
"""

from __future__ import annotations

import ast
import os
import re
import tomllib
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from drystone import Model, plot_model, read_model
from drystone.report import canvas

ROOT = Path(__file__).resolve().parents[2]
SIZE = 4.0  # inches, of the longer side of a picture
WIDTH = "280px"  # of a picture on the page


def described(text: str) -> str:
    """First sentence of the comment at the head of a model file."""
    lines: list[str] = []
    for line in text.splitlines():
        if not line.startswith("# "):
            break
        lines.append(line[2:].strip())
    return re.split(r"(?<=[.?])\s", " ".join(lines), maxsplit=1)[0]


def draw(model: Model, path: Path) -> None:
    """Draw a model as designed, without axes, as large as its shape asks for."""
    figure = canvas.new_figure(SIZE, SIZE)
    axes = plot_model(model, figure.subplots())
    axes.set_axis_off()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    longest = max(right - left, top - bottom)
    figure.set_size_inches(SIZE * (right - left) / longest, SIZE * (top - bottom) / longest)
    canvas.save(figure, path)


def row(file: Path, pictures: Path, page: Path, command: str | None) -> str:
    """One row in Markdown; the picture is drawn on the way."""
    text = file.read_text(encoding="utf-8")
    data = tomllib.loads(text)
    study = isinstance(data.get("model"), str)
    own = "study" if study else "assess" if "assessment" in data else "run"
    picture = pictures / f"{file.parent.name}-{file.stem}.png"
    draw(read_model(file.parent / data["model"] if study else file), picture)
    image, link = (Path(os.path.relpath(path, page)).as_posix() for path in (picture, file))
    typed = f"drystone {command or own} {file.relative_to(ROOT).as_posix()}"
    title = data["title"]
    return (
        f"| ![{title}]({image}){{width={WIDTH}}} | **{title}** ([{file.name}]({link})). "
        f"{described(text)}<br>`{typed}` |"
    )


class Gallery(SphinxDirective):
    """``{gallery} FOLDER``, the folder counted from the root of the repository."""

    required_arguments = 1
    #: The command to show, in place of the one that the file asks for.
    option_spec: ClassVar[dict[str, Any]] = {"command": directives.unchanged}

    def run(self) -> list[nodes.Node]:
        pictures = Path(self.env.doctreedir) / "gallery"  # beside the pages, not among them
        pictures.mkdir(parents=True, exist_ok=True)
        page = Path(self.env.doc2path(self.env.docname)).parent
        lines = ["| | |", "|---|---|"]
        for file in sorted((ROOT / self.arguments[0]).glob("*.toml")):
            self.env.note_dependency(str(file))
            lines.append(row(file, pictures, page, self.options.get("command")))
        return self.parse_text_to_nodes("\n".join(lines))


class Scripts(SphinxDirective):
    """``{scripts} FOLDER``: the scripts of a folder with the first line of what they say."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        page = Path(self.env.doc2path(self.env.docname)).parent
        lines = ["| script | shows |", "|---|---|"]
        for file in sorted((ROOT / self.arguments[0]).glob("*.py")):
            self.env.note_dependency(str(file))
            link = Path(os.path.relpath(file, page)).as_posix()
            says = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
            lines.append(f"| [{file.name}]({link}) | {' '.join(says.splitlines()[:1])} |")
        return self.parse_text_to_nodes("\n".join(lines))


def setup(sphinx: Sphinx) -> dict[str, Any]:
    sphinx.add_directive("gallery", Gallery)
    sphinx.add_directive("scripts", Scripts)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
