"""A model with something changed, checked like the first: behind `Model.with_joint` and others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from drystone.model.assembly import Assembly
from drystone.model.construction.control import choose_control_point
from drystone.model.construction.errors import ModelError
from drystone.model.construction.model import make_model
from drystone.model.construction.words import quoted, suggestion
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model

_VALUES = tuple(field.name for field in fields(JointLaw))


def remade(model: Model, **changes: Any) -> Model:
    """The model put together again; ``changes`` are arguments of `make_model` by name."""
    assembly, control = model.assembly, model.control_point
    parts: dict[str, Any] = {
        "blocks": assembly.blocks,
        "joint": assembly.joint,
        "joint_between": assembly.joint_between,
        "corner": assembly.corner,
        "thickness": assembly.depth,
        "points": None if assembly.points == assembly.usual_points else assembly.points,
        "load": model.load,
        "dead_loads": model.dead_loads,
        "ties": model.ties,
        "settlement": model.settlement,
        "control_block": assembly.ids[control.block],
        "control_point": control.point,
        "control_direction": control.direction,
        "history": model.history,
        "analysis": model.analysis,
        "title": model.title,
        "notes": model.notes,
        "mended": model.mended,
        "drawing_tolerance": 0.0,  # the outlines fit already
    }
    made = make_model(**{**parts, **changes})
    made = replace(made, site=model.site, assessment=model.assessment)
    if not {"control_block", "control_point"} & changes.keys():
        made = replace(made, control_point=replace(made.control_point, default=control.default))
    if np.array_equal(made.assembly.up, assembly.up):
        return made
    # Gravity of a model that was turned as a whole is no key of files.
    return replace(made, assembly=replace(made.assembly, up=assembly.up))


def joints_with(
    assembly: Assembly, between: tuple[str, str] | None, values: Mapping[str, float | None]
) -> dict[str, Any]:
    """Joint laws with some values changed, see `Model.with_joint`; raises `ModelError`."""
    unknown = [name for name in values if name not in _VALUES]
    if unknown:
        raise ModelError(
            f"joint: there is no value {quoted(name)}: {suggestion(name, _VALUES)}"
            for name in unknown
        )
    changed: dict[str, Any] = dict(values)
    laws = dict(assembly.joint_between)
    if between is not None:
        law = _law_between(assembly, *between)
        return {"joint_between": {**laws, frozenset(between): replace(law, **changed)}}
    return {
        "joint": replace(assembly.joint, **changed),
        "joint_between": {
            pair: replace(law, **_shared(law, assembly.joint, changed))
            for pair, law in laws.items()
        },
    }


def _law_between(assembly: Assembly, first: str, second: str) -> JointLaw:
    """The law in force between two blocks, which may be one of their groups or materials; else the
    exception for two groups or materials, or the law of all joints."""
    if {first, second} <= set(assembly.ids):
        a, b = (np.array([assembly.index(name)]) for name in (first, second))
        return assembly.laws[int(assembly.law_index(a, b)[0])]
    return assembly.joint_between.get(frozenset((first, second)), assembly.joint)


def control_beside_default(model: Model) -> dict[str, Any]:
    """Arguments of `make_model` for the control point; None for what is as it would be chosen."""
    assembly, control = model.assembly, model.control_point
    name = assembly.ids[control.block]
    default = choose_control_point(assembly, model.load_along)
    on_block = choose_control_point(assembly, model.load_along, block=name)
    follows = control.block == default.block and np.array_equal(control.point, on_block.point)
    return {
        "control_block": None if follows else name,
        "control_point": None if np.array_equal(control.point, on_block.point) else control.point,
        "control_direction": None
        if np.array_equal(control.direction, default.direction)
        else control.direction,
    }


def _shared(law: JointLaw, common: JointLaw, changed: Mapping[str, Any]) -> dict[str, Any]:
    """Those changes of values that an exception has in common with all other joints."""
    return {
        name: value
        for name, value in changed.items()
        if getattr(law, name) == getattr(common, name)
    }
