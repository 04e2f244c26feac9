"""Models as drawings: their blocks alone, for modelling programs."""

from __future__ import annotations

import numpy as np

from drystone.io.convert.common import Written
from drystone.io.drawings import Shape
from drystone.io.drawings.format import LAYER, LOST, Format
from drystone.model.construction.extrude import extruded
from drystone.model.construction.words import listed
from drystone.model.model import Model

#: What every drawing leaves behind.
GEOMETRY_ONLY = "a drawing holds the blocks alone: joints, load and analysis stay in the model file"


def write(kind: Format, model: Model) -> Written:
    """The text of a model's blocks in a format that is written, and what that loses."""
    assert kind.write is not None
    notes = [GEOMETRY_ONLY]
    if model.assembly.dimension == 2 and not kind.in_plane:
        model = extruded(model)
        notes.append("the plane model was extruded to solids, from y = 0 to its thickness")
    shapes, more = _shapes(model)
    notes += more
    supports = [shape.name for shape in shapes if shape.support]
    if kind.supports == LOST and supports:
        notes.append(f"supports are not marked in this format: {listed(supports)}")
    if kind.supports == LAYER:
        shapes = [
            Shape(
                name=shape.name,
                vertices=shape.vertices,
                faces=shape.faces,
                layer="support" if shape.support else shape.layer,
            )
            for shape in shapes
        ]
    text = kind.write(shapes, model.title, model.control_point.point.tolist())
    return Written(text=text, notes=tuple(notes))


def _shapes(model: Model) -> tuple[list[Shape], list[str]]:
    """The blocks of a model as shapes, and what that loses."""
    assembly = model.assembly
    shapes, split = [], []
    for block, figure in zip(assembly.blocks, assembly.figures, strict=True):
        pieces = figure.parts if block.parts or not block.faces else ()
        if assembly.dimension == 2:
            pieces = figure.parts if block.parts else ()
        outlines = [(part.vertices, part.faces) for part in pieces] or [
            (block.vertices, block.faces)
        ]
        if len(outlines) > 1:
            split.append(block.id)
        for k, (vertices, faces) in enumerate(outlines, 1):
            shapes.append(
                Shape(
                    name=block.id if len(outlines) == 1 else f"{block.id}/{k}",
                    vertices=np.asarray(vertices),
                    faces=faces,
                    layer=block.material,
                    groups=block.groups,
                    support=bool(block.support),
                )
            )
    notes = []
    if split:
        notes.append(
            f"parts of blocks are drawn as blocks of their own: {listed(split)}; read again, they "
            "have joints between them, and the curve is another"
        )
    return shapes, notes
