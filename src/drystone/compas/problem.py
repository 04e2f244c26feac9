"""A `Problem` of compas_dem as a model of drystone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from drystone.common.errors import ModelError
from drystone.compas.actions import Actions, actions_of
from drystone.compas.blocks import elements, imported_blocks, name_of
from drystone.compas.growing import gravity_of, growing_group
from drystone.compas.joints import joint_law
from drystone.io.drawings.settings import TOLERANCE
from drystone.model.assembly import Block, Corner
from drystone.model.construction.model import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model


# Many: whatever a model holds and a problem does not.
def model_of(
    problem: Any,
    *,
    load: Any = None,
    direction: Sequence[float] | None = None,
    control_block: int | None = None,
    control_point: str | Sequence[float] | None = None,
    control_direction: Sequence[float] | None = None,
    joint: JointLaw | None = None,
    density: float | None = None,
    points: int | None = None,
    corner: Corner | None = None,
    analysis: Analysis | None = None,
    tolerance: float = TOLERANCE,
) -> Model:
    """The model of drystone that a `Problem` describes.

    Ids of blocks are the graph nodes of the `BlockModel`, as text.

    Parameters
    ----------
    problem
        With its model loaded.
    load
        The boundary condition whose loads the multiplier scales, or whose supports move: its
        name, its index or itself.  May be left out where there is but one.  The loads of all
        others are dead loads, applied in their order before.
    direction
        In place of ``load``: horizontal (or other) forces in proportion to the blocks' mass along
        a direction (3,); the multiplier is over their weight, and all loads of the problem are dead
        ones.
    control_block, control_point, control_direction
        Graph node of the control block, and as of `make_model`.
    joint
        In place of the problem's contact properties.
    density
        Of blocks without a material [kg/m3].
    points, corner, analysis
        As of `make_model`.
    tolerance
        Of the import of meshes, see `imported_blocks`.

    Raises
    ------
    ModelError
        The problem holds what drystone cannot do, or lacks what it needs; a sentence each.
    """
    blocks_of_compas = elements(problem.model)
    gravity = gravity_of(problem)
    growing = growing_group(problem, load, direction)
    made = imported_blocks(problem.model, gravity, density=density, tolerance=tolerance)
    actions = actions_of(problem, growing, blocks_of_compas, made.blocks, gravity)
    model = make_model(
        _on_rollers(made.blocks, actions),
        joint=joint or joint_law(problem.contact_properties),
        load=actions.load,
        load_direction=direction,
        dead_loads=actions.dead_loads,
        settlement=actions.settlement,
        corner=corner,
        points=points,
        control_block=None if control_block is None else _known(control_block, made.blocks),
        control_point=control_point,
        control_direction=control_direction,
        analysis=analysis,
        title=str(problem.name or ""),
        notes=(*made.notes, *actions.notes),
        mended=made.mended,
    )
    return model


def _on_rollers(blocks: Sequence[Block], actions: Actions) -> list[Block]:
    """The blocks, those with rollers that keep parts of their motion at zero."""
    return [
        replace(block, held=actions.held[block.id]) if block.id in actions.held else block
        for block in blocks
    ]


def _known(node: int, blocks: Sequence[Block]) -> str:
    name = name_of(node)
    if all(block.id != name for block in blocks):
        raise ModelError([f"control_block: there is no block at node {node} of the graph"])
    return name
