"""Prescribed displacements: supports that move, and rollers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drystone.common.errors import ModelError
from drystone.compas.blocks import name_of
from drystone.compas.growing import group_name
from drystone.model.settlement import Settlement

#: Names of the motions that rollers hold, by component.
AXES = ("x", "y", "z")
TURN = "turn"


@dataclass(frozen=True, kw_only=True)
class Moves:
    """What prescribed displacements come to."""

    settlement: Settlement | None = None
    held: dict[str, tuple[str, ...]] = field(default_factory=dict)  # by block


def moves_of(problem: Any, growing: Any, elements: Mapping[int, Any]) -> Moves:
    """What the displacements of all boundary conditions come to.

    On a support, those of the growing group are a settlement; on a block that moves, components
    of zero are rollers.

    Raises
    ------
    ModelError
        A displacement that is none of these, by name.
    """
    wrong: list[str] = []
    moving: list[Any] = []
    held: dict[str, set[str]] = {}
    for group in problem.boundary_conditions:
        for k, one in enumerate(group.displacements):
            place = f"{group_name(problem, group)}, displacement {k + 1}"
            element = elements.get(one.block_index)
            if element is None:
                wrong.append(f"{place}: there is no block at node {one.block_index} of the graph")
            elif not element.is_support:
                own = held.setdefault(name_of(one.block_index), set())
                wrong += _rollers(place, one, own)
            elif any(_components(one)) and group is growing:
                moving.append(one)
            elif any(_components(one)):
                wrong.append(
                    f"{place}: moves a support beside other loads: drystone's supports move in "
                    f"place of a load that grows: solve with load={group.name!r}"
                )
    if wrong:
        raise ModelError(wrong)
    return Moves(
        settlement=_settlement(group_name(problem, growing), moving, elements) if moving else None,
        held={name: _in_order(own) for name, own in held.items() if own},
    )


def _components(one: Any) -> list[float]:
    """Three components of a translation [m] or a rotation [rad]; what is left open is zero."""
    given = getattr(one, "translation", None) or getattr(one, "rotation", None) or (0.0,) * 3
    return [float(value or 0.0) for value in given]


def _rollers(place: str, one: Any, held: set[str]) -> list[str]:
    """Put what a displacement of zero holds into ``held``; sentences on what cannot be held."""
    if any(_components(one)):
        return [
            f"{place}: moves block {one.block_index}, which is no support: make it one "
            "(model.add_support), or give components of 0 for rollers"
        ]
    translation = getattr(one, "translation", None)
    if translation is None:
        held.add(TURN)
        return []
    held.update(axis for axis, value in zip(AXES, translation, strict=True) if value is not None)
    return []


def _in_order(held: set[str]) -> tuple[str, ...]:
    return tuple(name for name in (*AXES, TURN) if name in held)


def _settlement(place: str, moving: list[Any], elements: Mapping[int, Any]) -> Settlement:
    """The one motion of all supports that move; raises `ModelError` where there are several."""
    blocks = tuple(dict.fromkeys(name_of(one.block_index) for one in moving))
    rotations = [one for one in moving if getattr(one, "rotation", None) is not None]
    vectors = np.array([_components(one) for one in moving])
    several = len(blocks) < len(moving) or bool(np.ptp(vectors, axis=0).any())
    if several or (rotations and len(moving) > 1):
        raise ModelError(
            [
                f"{place}: its supports move in different ways: drystone moves them as one rigid "
                "body: give all the same translation, or one of them a rotation"
            ]
        )
    size = float(np.linalg.norm(vectors[0]))
    if not rotations:
        return Settlement(blocks=blocks, direction=vectors[0] / size, max=size)
    centre = np.array(list(elements[moving[0].block_index].point), float)
    return Settlement(blocks=blocks, centre=centre, axis=vectors[0] / size, max=math.degrees(size))
