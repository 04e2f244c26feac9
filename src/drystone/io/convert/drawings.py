"""Models as drawings: their blocks alone, for modelling programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drystone.io.convert.common import Written
from drystone.io.drawings import Shape, compas, dxf, obj, ply, stl
from drystone.model.construction.extrude import extruded
from drystone.model.construction.words import listed
from drystone.model.model import Model

#: What every drawing leaves behind.
GEOMETRY_ONLY = "a drawing holds the blocks alone: joints, load and analysis stay in the model file"


def write_obj(model: Model, name: str = "") -> Written:
    """Wavefront OBJ; supports are of the material "support", as OBJ has no other mark."""
    return _written(model, obj.write, supports_as_layer=True)


def write_ply(model: Model, name: str = "") -> Written:
    """PLY, in text."""
    return _written(model, ply.write, note_supports=True)


def write_stl(model: Model, name: str = "") -> Written:
    """STL, in text, a solid for each block."""
    return _written(model, stl.write, note_supports=True)


def write_compas(model: Model, name: str = "") -> Written:
    """COMPAS JSON as compas_assembly has it."""
    return _written(model, compas.write)


def write_dxf(model: Model, name: str = "") -> Written:
    """DXF: closed polylines of a plane model, meshes of one in space; with the control point."""
    point = model.control_point.point
    shapes, notes = _shapes(model)
    text = dxf.write(shapes, model.title, point.tolist())
    return Written(text=text, notes=(GEOMETRY_ONLY, *notes))


def _written(
    model: Model,
    write: Callable[[Sequence[Shape], str], str],
    *,
    supports_as_layer: bool = False,
    note_supports: bool = False,
) -> Written:
    notes = [GEOMETRY_ONLY]
    if model.assembly.dimension == 2:
        model = extruded(model)
        notes.append("the plane model was made one of space, from y = 0 to its thickness")
    shapes, more = _shapes(model)
    notes += more
    supports = [shape.name for shape in shapes if shape.support]
    if note_supports and supports:
        notes.append(f"supports are not marked in this format: {listed(supports)}")
    if supports_as_layer:
        shapes = [
            Shape(
                name=shape.name,
                vertices=shape.vertices,
                faces=shape.faces,
                layer="support" if shape.support else shape.layer,
            )
            for shape in shapes
        ]
    return Written(text=write(shapes, model.title), notes=tuple(notes))


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
        notes.append(f"parts of blocks are drawn as blocks of their own: {listed(split)}")
    return shapes, notes
