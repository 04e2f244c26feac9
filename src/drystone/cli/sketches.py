"""Files that are no model yet, for commands that need no more than their blocks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drystone.io.drawings import ImportSettings
    from drystone.io.modelfile.sketch import Sketch
    from drystone.model.assembly import Assembly
    from drystone.model.model import Model


def drawing_of(path: Path) -> ImportSettings | None:
    """How to read a file that is a drawing; None of a model file."""
    from drystone.cli.convert import kind_of
    from drystone.io.drawings import ImportSettings

    kind = kind_of(path, None)
    if not kind.startswith("drawing ") or (path.suffix.lower() == ".json" and not path.is_file()):
        return None
    return ImportSettings(file=path, format=kind.split(" ")[1])


def model_or_sketch(path: Path) -> tuple[Model | Sketch, list[str]]:
    """The model of a file; of one that is no model its blocks, and what is wrong with it.

    Raises `ModelError` where it has no blocks that could be shown.
    """
    from drystone.io.modelfile import ModelError, read_model
    from drystone.io.modelfile.sketch import sketch_of_drawing, sketch_of_model

    settings = drawing_of(path)
    if settings is not None:
        return sketch_of_drawing(settings), []
    try:
        return read_model(path, need_stiffness=False), []
    except ModelError as error:
        try:
            return sketch_of_model(path), error.problems
        except ModelError:
            raise error from None


def refused(sketch: Sketch, wrong: Sequence[str]) -> list[str]:
    """What is wrong with blocks beside what is missing yet, and with a model that lacks nothing."""
    return list(sketch.problems) or ([] if sketch.missing else list(wrong))


def lacking(sketch: Sketch) -> str:
    """Sentence on what a model needs beside these blocks."""
    return f"a model needs {', '.join(sketch.missing)} as well"


def block_rows(assembly: Assembly) -> list[dict[str, Any]]:
    """Of each block what it is named, and where to find it in a picture."""
    return [
        {
            "id": block.id,
            "support": block.support,
            "material": block.material,
            "groups": list(block.groups),
            "centre": assembly.centroid[i].tolist(),
            "lower": block.vertices.min(axis=0).tolist(),
            "upper": block.vertices.max(axis=0).tolist(),
        }
        for i, block in enumerate(assembly.blocks)
    ]


def block_lines(assembly: Assembly) -> list[str]:
    """The same, a line each."""
    from drystone.model.construction.words import printable

    lines = []
    for row in block_rows(assembly):
        centre = ", ".join(f"{x:.4g}" for x in row["centre"])
        sides = zip(row["lower"], row["upper"], strict=True)
        size = " x ".join(f"{high - low:.4g}" for low, high in sides)
        more = ["support"] if row["support"] else []
        more += [row["material"]] if row["material"] else []
        more += [name for name in row["groups"] if name != row["material"]]
        line = f"  {row['id']:<14} at ({centre}) m, {size} m, {', '.join(more)}"
        lines.append(printable(line.rstrip(", ")))
    return lines
