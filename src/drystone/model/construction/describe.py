"""A model as plain data, with the keys of the model file."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from drystone.model.assembly import Assembly, Block
from drystone.model.construction.control import choose_control_point
from drystone.model.construction.errors import ModelError
from drystone.model.construction.fit import DRAWING_TOLERANCE, fitted
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis, Model
from drystone.model.monitor import ControlPoint


def model_to_dict(model: Model) -> dict[str, Any]:
    """The model as nested dicts, lists, texts, numbers: what a model file would hold.

    Walls come out block by block.  Blocks without a material name get ``material1`` and so on,
    one for each unit weight.
    """
    data = _described(model)
    if fitted(model.assembly.blocks, DRAWING_TOLERANCE)[1]:
        data["drawing_tolerance"] = 0.0  # what was left open stays open
    return data


def _described(model: Model) -> dict[str, Any]:
    """The same, but for how a reader makes the outlines fit."""
    assembly = model.assembly
    names = material_names(assembly.blocks)
    data: dict[str, Any] = {
        "title": model.title,
        "dimension": assembly.dimension,
        **({} if assembly.depth is None else {"thickness": float(assembly.depth)}),
        "material": {name: {"unit_weight": weight} for (_, weight), name in names.items()},
        "joint": _joint(assembly),
    }
    corner = {key: float(v) for key, v in vars(assembly.corner).items() if v}
    if corner:
        data["corner"] = corner
    if assembly.depth is None or assembly.points != assembly.usual_points:
        data["contact"] = {"points": assembly.points}
    data["block"] = [
        {
            "id": block.id,
            "material": names[block.material, float(block.unit_weight)],
            **shape_of_block(block),
            "support": bool(block.support),
            **({"groups": list(block.groups)} if block.groups else {}),
            **({"held": list(block.held)} if block.held else {}),
        }
        for block in assembly.blocks
    ]
    data |= _acting(model)
    control = model.control_point
    # One that nobody has named may still move to a block that falls: see `analysis.driver`.
    usual = choose_control_point(assembly, model.load_along) if control.default else None
    unnamed = usual is not None and _is_at(usual, control, assembly)
    chosen = {"block": assembly.blocks[control.block].id, "point": control.point.tolist()}
    data["control"] = {
        **({} if unnamed else chosen),
        "direction": control.direction.tolist(),
        **({} if model.history is None else {"history": list(model.history.targets)}),
    }
    data["analysis"] = _asked(model.analysis)
    if model.analysis.outputs:
        data["output"] = [{"kind": kind, **keys} for kind, keys in model.analysis.outputs]
    if model.site is not None:
        data["site"] = model.site.as_dict()
    if model.assessment is not None:
        data["assessment"] = model.assessment.as_dict()
    return {key: _plain(value) for key, value in data.items()}


def _is_at(usual: ControlPoint, control: ControlPoint, assembly: Assembly) -> bool:
    """Whether a control point that nobody named is still the usual one.

    Where a mechanism moves another corner of its block, it is there, and a file has to name it.
    Off the corners it is only in a model that was extruded: halfway between two usual ones.
    """
    if control.block != usual.block:
        return False
    corners = assembly.blocks[control.block].vertices
    at_corner = bool(np.all(corners == control.point, axis=1).any())
    return not at_corner or np.array_equal(control.point, usual.point)


def _plain(value: Any) -> Any:
    """The same with numbers and arrays of Python in place of those of numpy."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value


def _asked(analysis: Analysis) -> dict[str, Any]:
    """[analysis], of what has a default only what differs from it."""
    given = {
        "ground": None,
        "falling": None,
        "event_share": Analysis.event_share,
        "max_penetration": Analysis.max_penetration,
    }
    return {
        "engine": analysis.engine,
        "strategy": analysis.strategy,
        "stop_multiplier": float(analysis.stop_multiplier),
        **{
            key: value if isinstance(value, str) else float(value)
            for key, default in given.items()
            if (value := getattr(analysis, key)) != default
        },
        **{key: float(value) for key, value in analysis.options.items()},
    }


def _acting(model: Model) -> dict[str, Any]:
    """What acts on the structure, and what ties it."""
    data: dict[str, Any] = {}
    if model.settlement is None:
        data["load"] = {"pattern": model.load.name, **model.load.keys()}
    else:
        data["settlement"] = model.settlement.keys()
    if model.dead_loads:
        data["dead_load"] = [load.keys() for load in model.dead_loads]
    for key, spring in (("tie", False), ("spring", True)):
        if listed := [tie.keys() for tie in model.ties if tie.spring == spring]:
            data[key] = listed
    return data


def digest(model: Model) -> str:
    """SHA-256 of the model's description in canonical JSON, as 64 hexadecimal digits.

    What a curve does not depend on is not part of it: site and assessment.
    """
    data = _described(replace(model, site=None, assessment=None))
    text = json.dumps(data, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def material_names(blocks: Sequence[Block]) -> dict[tuple[str, float], str]:
    """Name in the file of each material, by its name and unit weight in the model.

    Raises
    ------
    ModelError
        Two unit weights go by the same name.
    """
    names: dict[tuple[str, float], str] = {}
    unnamed = 0
    for material, weight in dict.fromkeys((b.material, float(b.unit_weight)) for b in blocks):
        name = material
        if not name:
            unnamed += 1
            name = f"material{unnamed}"
        if name in names.values():
            raise ModelError(
                [f"material.{name}: has two unit weights: give each its own material name"]
            )
        names[material, weight] = name
    return names


def shape_of_block(block: Block) -> dict[str, Any]:
    """Vertices and faces of a block, or those of its parts where these were given."""
    if block.parts:
        return {"parts": [_solid(part.vertices, part.faces) for part in block.parts]}
    return _solid(block.vertices, block.faces)


def _solid(vertices: Any, faces: Any) -> dict[str, Any]:
    listed = {"faces": [list(map(int, face)) for face in faces]} if faces else {}
    return {"vertices": vertices.tolist(), **listed}


def _joint(assembly: Assembly) -> dict[str, Any]:
    joint: dict[str, Any] = dict(_law(assembly.joint))
    if assembly.joint_between:
        pairs = {_pair_key(names): law for names, law in assembly.joint_between.items()}
        joint["between"] = {key: _law(pairs[key]) for key in sorted(pairs)}
    return joint


def _pair_key(names: frozenset[str]) -> str:
    first, *rest = sorted(names)
    return f"{first} {rest[0] if rest else first}"


def _law(law: JointLaw) -> dict[str, float]:
    """What the file says of a law: without stiffnesses that are missing, or a dilatancy's end."""
    values = {field.name: getattr(law, field.name) for field in fields(law)}
    return {k: float(v) for k, v in values.items() if v is not None and v != math.inf}
