"""LMGC90: one Python script that builds the model with ``pylmgc90.pre`` and runs it with ``chipy``.

The script needs numpy and pylmgc90, not this package.  Its numbers stand at its top as literals,
polygons in the plane and convex polyhedra in space; the strategy at its end is one for both.
"""

from __future__ import annotations

import ast
import pprint
from importlib.resources import files
from typing import Any

import numpy as np

from drystone.io.convert.common import (
    STRATEGY,
    Written,
    chamfered,
    file_name,
    left_sharp,
    leg_of,
    mass_direction,
    need_convex,
    need_stiffness,
    only_ours,
    strategy,
    strategy_notes,
    wrapped,
)
from drystone.io.convert.itasca import pair_laws
from drystone.model.assembly import GRAVITY, Assembly, Block, Corner
from drystone.model.construction.errors import ModelError
from drystone.model.construction.model import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model

PROGRAM = "LMGC90"
TEMPLATES = {2: "lmgc90_script.txt", 3: "lmgc90_solids.txt"}
STRATEGY_TEMPLATE = "lmgc90_strategy.txt"
MARK = "# The model\n"


def write(model: Model, name: str = "") -> Written:
    """The model as a script for pylmgc90."""
    assembly = model.assembly
    need_stiffness(assembly, PROGRAM)
    need_convex(assembly, PROGRAM)
    _check(assembly.laws)
    notes = ["LMGC90's joints are rigid in shear: the shear stiffness is left out"]
    if assembly.dimension == 3:
        notes += left_sharp(assembly, PROGRAM)
    else:
        chamfered(assembly)  # what the script will do
        if assembly.corner.radius:
            notes.append(
                "LMGC90 has no rounded corners: they are chamfered with legs of "
                f"{assembly.corner.radius:g} m"
            )
    notes += strategy_notes(model, PROGRAM)
    if assembly.joint_between:
        notes.append(
            "joints with stiffnesses of their own keep them as designed: contacts that form later "
            "get the first"
        )
    values: dict[str, Any] = {
        "TITLE": model.title,
        **_shapes(assembly),
        "FRICTION": float(assembly.joint.friction_coefficient),
        "STIFFNESS": float(assembly.joint.normal_stiffness or 0.0),
        "STIFFNESS_BETWEEN": {
            (i, j): float(assembly.laws[k - 1].normal_stiffness or 0.0)
            for k, i, j in pair_laws(assembly)
        },
        "LOAD_DIRECTION": tuple(map(float, mass_direction(model, PROGRAM))),
        "CONTROL_BLOCK": assembly.blocks[model.control_point.block].id,
        "CONTROL_POINT": tuple(map(float, model.control_point.point)),
        "CONTROL_DIRECTION": tuple(map(float, model.control_point.direction)),
        "STRATEGY": strategy(model),
        "STOP_MULTIPLIER": float(model.analysis.stop_multiplier),
        "GRAVITY": GRAVITY,
    }
    literals = "\n".join(f"{key} = {_literal(key, value)}" for key, value in values.items())
    head = "\n".join(
        [
            '"""LMGC90 input of drystone, from ' + _plain(file_name(model.source)) + ".",
            "",
            *wrapped(notes, ""),
            '"""',
            "",
            MARK,
        ]
    )
    body = "\n\n".join(
        files("drystone.io.convert").joinpath(name).read_text(encoding="utf-8")
        for name in (TEMPLATES[assembly.dimension], STRATEGY_TEMPLATE)
    )
    return Written(text=head + literals + "\n\n" + body, notes=tuple(notes))


def _shapes(assembly: Assembly) -> dict[str, Any]:
    """What the script is told of the blocks' shapes."""
    blocks: list[dict[str, Any]] = []
    for block, (part,) in zip(assembly.blocks, (f.parts for f in assembly.figures), strict=True):
        solid = assembly.dimension == 3
        blocks.append(
            {
                "id": block.id,
                "material": block.material,
                "unit_weight": float(block.unit_weight),
                "support": bool(block.support),
                "vertices": [
                    tuple(map(float, v)) for v in (part.vertices if solid else block.vertices)
                ],
            }
        )
        if solid:
            blocks[-1]["faces"] = [tuple(map(int, face)) for face in part.faces]
    if assembly.dimension == 2:
        return {
            "THICKNESS": float(assembly.thickness),
            "BLOCKS": blocks,
            "LEG": leg_of(assembly),
        }
    areas: dict[tuple[int, int], float] = {}
    joints = assembly.interfaces
    for i, j, area in zip(joints.block_a, joints.block_b, joints.size, strict=True):
        pair = (int(i), int(j))
        areas[pair] = areas.get(pair, 0.0) + float(area)
    return {"BLOCKS": blocks, "AREAS": areas}


def _literal(key: str, value: Any) -> str:
    return pprint.pformat(value, width=99 - len(key), sort_dicts=False)


def _plain(text: str) -> str:
    """Text that may stand in a docstring."""
    return text.replace("\\", "/").replace('"', "'")


def _check(laws: tuple[JointLaw, ...]) -> None:
    for law in laws:
        if law.yields:
            raise ModelError(["joint: LMGC90's law neither softens nor crushes: take that out"])
        if law.dilatancy_angle or law.cohesion or law.tensile_strength:
            raise ModelError(
                ["joint: LMGC90's law has no dilatancy, cohesion or tension: set them to zero"]
            )
    if len({law.friction_coefficient for law in laws}) > 1:
        raise ModelError(["joint: the script for LMGC90 has one friction coefficient for all"])


def read(text: str) -> Model:
    """The model of a script that `write` wrote; nothing of it is run.

    The shear stiffness is that of the normal direction, of which the script says nothing.
    """
    with only_ours(PROGRAM):
        return _model(_literals(ast.parse(text)))


def _literals(tree: ast.Module) -> dict[str, Any]:
    """What names stand for, as far as that is written out; raises `ModelError` where one lacks."""
    v: dict[str, Any] = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            try:
                v[node.targets[0].id] = ast.literal_eval(node.value)
            except ValueError:
                break  # the end of the numbers
    needed = ("BLOCKS", "AREAS" if "AREAS" in v else "LEG", "STRATEGY", "GRAVITY")
    missing = [key for key in needed if key not in v]
    if missing:
        raise ModelError([f"drystone did not write this script: it lacks {missing[0]}"])
    return v


def _model(v: dict[str, Any]) -> Model:
    solid = "AREAS" in v
    blocks = [
        Block(
            id=block["id"],
            vertices=np.array(block["vertices"]),
            unit_weight=block["unit_weight"],
            material=block["material"],
            support=block["support"],
            faces=tuple(block.get("faces", ())),
        )
        for block in v["BLOCKS"]
    ]

    def law(stiffness: float) -> JointLaw:
        return JointLaw(
            friction_coefficient=v["FRICTION"],
            normal_stiffness=stiffness,
            shear_stiffness=stiffness,
        )

    return make_model(
        blocks,
        joint=law(v["STIFFNESS"]),
        joint_between={
            frozenset((blocks[i].id, blocks[j].id)): law(stiffness)
            for (i, j), stiffness in v["STIFFNESS_BETWEEN"].items()
        },
        corner=Corner(chamfer=None if solid else v["LEG"] or None),
        thickness=None if solid else v["THICKNESS"],
        load_direction=v["LOAD_DIRECTION"],
        control_block=v["CONTROL_BLOCK"],
        control_point=v["CONTROL_POINT"],
        control_direction=v["CONTROL_DIRECTION"],
        analysis=Analysis(
            strategy="published",
            stop_multiplier=v["STOP_MULTIPLIER"],
            options={key: v["STRATEGY"][key] for key in STRATEGY},
        ),
        title=v["TITLE"],
    )
