"""A model from its parts, checked: the one way that files and builders put it together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from drystone.common.names import quoted, there_is_no
from drystone.common.ranges import LARGEST, problem, too_many
from drystone.common.tolerances import TINY
from drystone.common.vectors import unit_vector
from drystone.geometry import GeometryError
from drystone.geometry.dimension import dimension_of
from drystone.geometry.mended import Mended
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.construction.checks import (
    Place,
    block_problems,
    law_problems,
    layout_problems,
    pair_problems,
    roller_problems,
)
from drystone.model.construction.control import choose_control_point
from drystone.model.construction.describe import material_names
from drystone.model.construction.errors import ModelError
from drystone.model.construction.fit import DRAWING_TOLERANCE, fitted, straightened, turned_round
from drystone.model.history import History
from drystone.model.joint_law import JointLaw
from drystone.model.loading import DeadLoad, LoadPattern, MassPattern, NoPattern
from drystone.model.loading.base import Directed, rises
from drystone.model.model import Analysis, Model, Origin
from drystone.model.monitor import ControlPoint
from drystone.model.settlement import Settlement
from drystone.model.site import AssessmentInput, Site
from drystone.model.ties import Tie, problems_of

#: Cosine of the angle between load and control direction that counts as none.
AGAINST = 1e-9


# Long by its arguments, each with its words: they are the keys of a model file.
def make_model(
    blocks: Sequence[Block],
    *,
    joint: JointLaw,
    load_direction: Sequence[float] | None = None,
    load: LoadPattern | None = None,
    dead_loads: Sequence[DeadLoad] = (),
    ties: Sequence[Tie] = (),
    settlement: Settlement | None = None,
    thickness: float | None = None,
    corner: Corner | None = None,
    points: int | None = None,
    joint_between: Mapping[frozenset[str], JointLaw] | None = None,
    control_block: str | None = None,
    control_point: str | Sequence[float] | None = None,
    control_direction: Sequence[float] | None = None,
    history: History | None = None,
    analysis: Analysis | None = None,
    title: str = "",
    source: str | None = None,
    sha256: str | None = None,
    place: Place | None = None,
    drawing_tolerance: float = DRAWING_TOLERANCE,
    notes: Sequence[str] = (),
    mended: Sequence[Mended] = (),
    site: Site | None = None,
    assessment: AssessmentInput | None = None,
) -> Model:
    """Put a model together and check that it can be analysed.

    Parameters
    ----------
    blocks
        Movable blocks and supports, in the order of all arrays.
    joint, joint_between
        Law of every joint, and laws of the joints between two block ids or two materials.
    thickness
        Out of plane [m]; none in space.
    load_direction
        Direction of the load pattern, scaled to length one. It may be left out if ``load`` is
        given.
    load
        The pattern that the multiplier scales; by default forces in proportion to mass.
    dead_loads
        Loads in addition to the weight of the blocks.
    ties
        Ties and springs between blocks.
    settlement
        Motion of supports, instead of a load.
    corner
        How corners are treated for contact; sharp by default.
    points
        Number of contact points of a joint. In the plane 2 to 64, by default 2. In space, for a
        joint of four corners, 4, 9, 16 or the square of an odd number from 5 to 33, by default 4.
        Where joints are crushed, the default is 9 in the plane and 81 in space.
    control_block, control_point, control_direction
        See `choose_control_point`.
    history
        Control displacements that are reached one after another.
    source, sha256
        Path of the file that the model was read from, and digest of its bytes.
    place
        Function that names a block in messages, by its row.
    drawing_tolerance
        Largest gap or overlap of joints that is closed, over the smallest edge of all blocks.
    notes
        Sentences on the file that was read, in addition to those on its outlines.
    mended
        Changes of imported blocks.
    site, assessment
        Ground motion, and method of assessment. Curves do not depend on them.

    Raises
    ------
    ModelError
        The message lists everything that is wrong.
    """
    place = place or (lambda i: f'block "{blocks[i].id}"')
    _raise(_too_large(blocks))
    dimension = blocks[0].dimension if blocks else len(load_direction or (0.0, 0.0))
    if settlement is not None and load is None and load_direction is None:
        load = NoPattern(direction=dimension_of(dimension).idle_direction)
    pattern = _pattern(load, load_direction, dimension)
    assembly, amended = assembly_of(
        blocks,
        joint,
        dict(joint_between or {}),
        corner=corner or Corner(),
        thickness=thickness,
        points=points,
        drawing_tolerance=drawing_tolerance,
        place=place,
    )
    wanted = {"block": control_block, "point": control_point, "direction": control_direction}
    problems = layout_problems(assembly, place) + pattern.problems(assembly)
    for k, one in enumerate(dead_loads):
        named = f' "{one.name}"' if one.name else ""
        at = f"dead_load[{k + 1}]{named}"
        problems += one.problems(assembly, at) or rises(one, assembly, at)
    wrong = settlement.problems(assembly) if settlement is not None else []
    moving = settlement.rows(assembly) if settlement is not None and not wrong else None
    problems += problems_of(ties, assembly, moving) + wrong
    if settlement is not None and not isinstance(pattern, NoPattern):
        problems.append("settlement: stands in place of [load]: take one of the two out")
    problems += _unknown_parts(assembly, assessment)
    if history is not None:
        problems += history.problems(assembly)
        if settlement is not None:
            problems.append("control.history: supports that move go one way: take one out")
    control = _control(assembly, pattern, problems, **wanted)
    model = Model(
        title=title,
        assembly=assembly,
        load=pattern,
        dead_loads=tuple(dead_loads),
        ties=tuple(sorted(ties, key=lambda tie: tie.spring)),  # as files list them
        settlement=settlement,
        control_point=control,
        history=history,
        analysis=analysis or Analysis(),
        notes=(*notes, *amended),
        mended=tuple(mended),
        site=site,
        assessment=assessment,
    )
    if source is None or sha256 is None:
        return model
    return replace(model, origin=Origin(path=source, sha256=sha256, contents=model.contents))


def _too_large(blocks: Sequence[Block]) -> list[str]:
    """More blocks than anything takes, names that fill screens."""
    found = [f"block: the model {wrong}"] if (wrong := too_many("blocks", len(blocks))) else []
    return found + [
        f"{quoted(block.id)}: the id has {len(block.id):,} letters: give it at most "
        f"{LARGEST['name']}"
        for block in blocks
        if len(block.id) > LARGEST["name"]
    ]


def _unknown_parts(assembly: Assembly, assessment: AssessmentInput | None) -> list[str]:
    """Sentences on parts that may fall and are not there."""
    values = {} if assessment is None else assessment.values
    known = [*assembly.groups, *assembly.ids]
    return [
        "assessment.parts_that_may_fall: " + there_is_no("block or group", name, known)
        for name in values.get("parts_that_may_fall", ())
        if name not in known
    ]


def _pattern(
    load: LoadPattern | None, direction: Sequence[float] | None, dimension: int
) -> LoadPattern:
    """The pattern, along the direction where one is given; raises `ModelError`."""
    if load is not None and not hasattr(load, "along"):
        raise ModelError(
            [
                "load: must be a pattern: give one, as ds.MassPattern(direction=(1.0, 0.0)), or a "
                "load_direction alone"
            ]
        )
    if direction is None and load is not None:
        return load
    along = unit_vector(() if direction is None else direction, "load.direction", dimension)
    if load is None:
        return MassPattern(direction=along)
    try:
        return load.towards(along)
    except ValueError as error:
        raise ModelError([f"load.direction: {error}"]) from None


def assembly_of(
    blocks: Sequence[Block],
    joint: JointLaw,
    between: Mapping[frozenset[str], JointLaw],
    *,
    corner: Corner,
    thickness: float | None,
    points: int | None,
    drawing_tolerance: float,
    place: Place,
) -> tuple[Assembly, tuple[str, ...]]:
    """The blocks turned round, straightened, fitted, and sentences on that; raises `ModelError`."""
    blocks, turned = turned_round(blocks)
    problems = [f"joint.{wrong}" for wrong in law_problems(joint)]
    for names, law in between.items():
        where = " ".join(sorted(names))
        problems += [f'joint.between."{where}".{wrong}' for wrong in law_problems(law)]
    problems += pair_problems(blocks, between)
    problems += roller_problems(blocks, place)
    if wrong := problem("drawing_tolerance", drawing_tolerance):
        problems.append(wrong)
    if not blocks:
        problems.append("block: there is none: add [[block]], [[build]] or [wall]")
    problems += _depth_problems(blocks, thickness, points)
    if any(problem("unit_weight", weight) for weight in {block.unit_weight for block in blocks}):
        problems += block_problems(blocks, corner, place)
    _raise(problems)
    material_names(blocks)  # raises where a name has two unit weights

    def build(blocks: Sequence[Block]) -> Assembly:
        return Assembly.build(
            blocks,
            joint=joint,
            corner=corner,
            thickness=1.0 if thickness is None else thickness,
            joint_between=between,
            points=points,
        )

    try:
        assembly = build(blocks)
        blocks, amended = _fitted(blocks, drawing_tolerance)
        if amended:
            assembly = build(blocks)
    except GeometryError:  # says the first; look at each block to say them all
        raise ModelError(block_problems(blocks, corner, place)) from None
    if len(set(assembly.ids)) < len(blocks):
        raise ModelError(block_problems(blocks, corner, place))
    return assembly, turned + amended


def _fitted(blocks: Sequence[Block], tolerance: float) -> tuple[list[Block], tuple[str, ...]]:
    """Blocks with straight edges and closed joints, and sentences on both; an edge may come to be
    straight as the joint along it is closed."""
    blocks, straight = straightened(blocks)
    blocks, moved = fitted(blocks, tolerance)
    blocks, then = straightened(blocks) if moved else (blocks, ())
    return list(blocks), straight + moved + then


def _depth_problems(
    blocks: Sequence[Block], thickness: float | None, points: int | None
) -> list[str]:
    """Of a thickness that is missing or too much, and of numbers of contact points."""
    found = []
    of = dimension_of(blocks[0].dimension if blocks else 2)
    if points is not None and points not in of.points_known:
        found.append(f"contact.points: must be {of.points_text}, it is {points}")
    if of.thickness(1.0) is None:
        if thickness is not None:
            found.append("thickness: is for models in the plane only: take it out")
    elif thickness is None:
        found.append("thickness: is missing: give it in m, out of plane")
    elif wrong := problem("thickness", thickness):
        found.append(wrong)
    return found


def _control(
    assembly: Assembly, load: LoadPattern, problems: list[str], **wanted: Any
) -> ControlPoint:
    """The control point as wanted; raises `ModelError` with those of the layout before its own."""
    if assembly.n_blocks == 0 or load.problems(assembly):
        raise ModelError(problems)
    load_direction = load.along(assembly)
    try:
        control = choose_control_point(assembly, load_direction, **wanted)
    except ModelError as error:
        raise ModelError(problems + error.problems) from None
    sides = [load_direction]
    if not isinstance(load, Directed):  # its forces may push in opposite senses
        force = load.forces(assembly).without(assembly.fixed).force
        own, most = force[control.block], float(np.linalg.norm(force, axis=1).sum())
        couple = float(np.linalg.norm(force.sum(axis=0))) <= AGAINST * most
        sides += [control.direction] if couple else [own / max(most, TINY)]
    loaded = not isinstance(load, NoPattern)
    if loaded and not any(float(control.direction @ side) > AGAINST for side in sides):
        problems.append(
            "control.direction: leads against the load or across it, so that the control "
            "displacement would not grow as the load does: turn it to the load's side"
        )
    _raise(problems)
    return control


def _raise(problems: list[str]) -> None:
    if problems:
        raise ModelError(problems)
