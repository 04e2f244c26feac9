"""A plane model as solids: x stays, y becomes z, and its thickness runs along y."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry import GeometryError
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Part
from drystone.model.assembly import Assembly, Block
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model


def extruded(model: Model, *, points: int | None = None) -> Model:
    """The same structure in space, from y = 0 to its thickness.

    Load and control point lie in the middle plane. Edges are treated as the corners were, on all
    sides of a block.

    Parameters
    ----------
    points
        Contact points on a quadrilateral interface, see `make_model`.

    Raises
    ------
    ValueError
        The model is one of space already.
    ModelError
        A block is no solid: solids are held to be flat sooner than outlines.
    """
    plane = model.assembly
    depth = plane.depth
    if depth is None:
        raise ValueError("the model is already in space: only models in the plane can be extruded")
    control = model.control_point

    def into(vector: Array, *, point: bool = False) -> Array:
        return _in_space(vector, 0.5 * depth if point else 0.0)

    try:
        assembly = Assembly.build(
            [_extruded(block, depth) for block in plane.blocks],
            joint=plane.joint,
            corner=plane.corner,
            joint_between=plane.joint_between,
            points=points,
            up=_in_space(plane.up),
        )
    except GeometryError as error:
        raise ModelError([f"as a solid, {error}"]) from None
    return replace(
        model,
        assembly=assembly,
        load=model.load.in_space(into),
        dead_loads=tuple(load.in_space(into) for load in model.dead_loads),
        ties=tuple(tie.in_space(into) for tie in model.ties),
        settlement=model.settlement and model.settlement.in_space(into),
        control_point=replace(
            control,
            point=_in_space(control.point, 0.5 * depth),
            direction=_in_space(control.direction),
        ),
    )


#: Axes of the plane in space.
AXES = {"y": "z"}


def _extruded(block: Block, depth: float) -> Block:
    block = replace(block, held=tuple(AXES.get(name, name) for name in block.held))
    outlines = [part.vertices for part in block.parts] or [block.vertices]
    parts = [Part(*solid.extruded(outline, (0.0, depth))) for outline in outlines]
    if block.parts:
        vertices = np.vstack([part.vertices for part in parts])
        return replace(block, vertices=vertices, parts=tuple(parts))
    return replace(block, vertices=parts[0].vertices, faces=parts[0].faces)


def _in_space(vector: Array, y: float = 0.0) -> Array:
    return np.array([vector[0], y, vector[1]])
