"""A drawing as a model file: its blocks, mended, with what else is known."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drystone.common.names import in_any_case
from drystone.geometry.mended import Mended
from drystone.io.convert.like import NAMING, fitting, tables_of
from drystone.io.drawings import Imported, ImportSettings, imported
from drystone.io.modelfile.write import to_toml
from drystone.model.assembly import Block
from drystone.model.construction.control import SAME
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import in_a_cell, millimetres, quoted

WHAT = "# A drawing does not say this: fill in your numbers and remove the marks.\n"
#: Tables that a model needs and no drawing has, as lines to fill in.
TO_FILL = {
    "thickness": "thickness = 1.0  # m, out of plane",
    "material": "[material.{material}]\nunit_weight = 20e3  # N/m3",
    "joint": "[joint]\nfriction_coefficient = 0.6\nnormal_stiffness = 1e9  # Pa/m\n"
    "shear_stiffness = 1e9  # Pa/m",
    "load": '[load]\npattern = "mass"\ndirection = {direction}',
}


@dataclass(frozen=True, kw_only=True)
class FromDrawing:
    """A model file, and what there is to know about it."""

    text: str
    blocks: tuple[Block, ...]
    mended: tuple[Mended, ...]
    notes: tuple[str, ...]


def from_drawing(settings: ImportSettings, like: Path | None = None) -> FromDrawing:
    """The text of a model file with the blocks of a drawing.

    Parameters
    ----------
    like
        A model file from which everything but the blocks is taken; without one, materials, joints
        and load are left to fill in.

    Raises
    ------
    ModelError
        The drawing cannot be read, or the other model file is none.
    """
    known, notes = ({}, []) if like is None else tables_of(like)
    materials = known.get("material")
    names = list(materials) if isinstance(materials, dict) else []
    # Weights are for whoever reads the model file; here only names matter.
    made = imported(settings, lambda layer: (_material(layer, names, settings.material), 1.0))
    dimension = made.blocks[0].dimension
    if (of_like := known.pop("dimension", dimension)) != dimension:
        raise ModelError(
            [
                f"{like}: has {of_like} dimensions, and the drawing {dimension}: name a model file "
                "of as many dimensions"
            ]
        )
    if dimension == 3:
        known.pop("thickness", None)
    if like is not None:
        known, more = fitting(known, made.blocks, like)
        notes += more
    control = known.get("control", {})
    if made.control is not None and isinstance(control, dict):
        own = {key: value for key, value in control.items() if key not in NAMING}
        known["control"] = {**own, **_control(made)}
    data = {
        "title": settings.file.stem,
        "dimension": dimension,
        **known,
        "block": [_block(block) for block in made.blocks],
    }
    missing = [
        key for key in TO_FILL if key not in known and (key != "thickness" or dimension == 2)
    ]
    notes = [*made.notes, *notes]
    if missing:
        tables = ", ".join("thickness" if key == "thickness" else f"[{key}]" for key in missing)
        notes.append(f"a drawing does not say {tables}: fill in what is marked in the file")
    head, tail = _to_fill(missing, made.blocks, dimension)
    return FromDrawing(
        text=head + to_toml(data) + tail, blocks=made.blocks, mended=made.mended, notes=tuple(notes)
    )


def _material(layer: str, names: Sequence[str], given: str | None) -> str:
    """The name of a block's material: its layer where there is such a material."""
    if not names:
        return given or layer
    if (named := in_any_case(layer, names)) is not None:
        return named
    name = given or (names[0] if len(names) == 1 else None)
    if name is None:
        raise ModelError(
            [f'material: none is named after the layer "{layer}", say which with --material']
        )
    return name


def _block(block: Block) -> dict[str, Any]:
    """A block as a table of the file."""
    from drystone.model.construction.describe import shape_of_block

    return {
        "id": block.id,
        **({"material": block.material} if block.material else {}),
        **shape_of_block(block),
        **({"support": True} if block.support else {}),
        **({"held": list(block.held)} if block.held else {}),
        **({"groups": list(block.groups)} if block.groups else {}),
    }


def _control(made: Imported) -> dict[str, Any]:
    from drystone.io.modelfile.imports import nearest

    point = list(made.control or ())
    name = nearest(made.blocks, point)
    block = next(block for block in made.blocks if block.id == name)
    away = block.figure().distance(np.array(point))
    if away > SAME * float(np.ptp(block.vertices, axis=0).max()):
        raise ModelError(
            [
                f"the control point of the drawing is on no block that moves: {quoted(name)} is "
                f"nearest, {millimetres(away)} away: move it there"
            ]
        )
    return {"block": name, "point": point}


def _to_fill(missing: Sequence[str], blocks: Sequence[Block], dimension: int) -> tuple[str, str]:
    """Comments for the beginning and the end of the file: what is to be filled in."""
    if not missing:
        return "", ""
    materials = dict.fromkeys(block.material for block in blocks)
    direction = "[1.0, 0.0]" if dimension == 2 else "[1.0, 0.0, 0.0]"
    head, tail = "", ""
    for key in missing:
        for name in materials if key == "material" else [""]:
            quoted = name if name.isidentifier() else json.dumps(name) if name else "stone"
            text = TO_FILL[key].format(material=quoted, direction=direction)
            lines = "".join(f"# {line}\n" for line in text.split("\n"))
            if key == "thickness":
                head += lines
            else:
                tail += lines
    return WHAT + head, "\n" + WHAT + tail


def mended_csv(records: Sequence[Mended]) -> str:
    """What was done to which block, a line each."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["block", "what", "how_much_m", "count", "volume_m3"])
    for record in records:
        row = (f"{record.how_much:.6g}", record.count, f"{record.volume:.6g}")
        writer.writerow([in_a_cell(record.block), record.what, *row])
    return stream.getvalue()
