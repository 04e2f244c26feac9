"""Loads and displacements of a problem, as what acts on a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drystone.common.errors import ModelError
from drystone.compas.blocks import EVERY, name_of
from drystone.compas.forces import acting_forces, check_loads, place_on
from drystone.compas.growing import group_name
from drystone.compas.movements import moves_of
from drystone.model.assembly import Block
from drystone.model.loading import (
    Acceleration,
    AccelerationPattern,
    DeadLoad,
    ForceLoad,
    ForcesPattern,
    LoadPattern,
    PointForce,
)
from drystone.model.settlement import Settlement


@dataclass(frozen=True, kw_only=True)
class Actions:
    """What acts on a model beside weight."""

    load: LoadPattern | None = None  # None where masses are pushed or supports move
    dead_loads: tuple[DeadLoad, ...] = ()
    settlement: Settlement | None = None
    held: dict[str, tuple[str, ...]] = field(default_factory=dict)  # by block, what rollers hold
    notes: tuple[str, ...] = ()


def actions_of(
    problem: Any, growing: Any, elements: Sequence[Any], blocks: Sequence[Block], gravity: float
) -> Actions:
    """What the boundary conditions of a problem do.

    Parameters
    ----------
    growing
        The group that the multiplier scales, or None.
    elements, blocks
        Of the `BlockModel`, and those made of them.
    gravity
        Acceleration [m/s2].

    Raises
    ------
    ModelError
        Something that drystone cannot do, by name.  Loads that no static analysis takes are named
        all at once, and before any is translated.
    """
    by_node = {element.graphnode: element for element in elements}
    check_loads(problem, by_node)
    by_name = {block.id: block for block in blocks}
    masses = {
        int(block.id): block.unit_weight * block.figure().volume / gravity for block in blocks
    }
    moves = moves_of(problem, growing, by_node)
    load: LoadPattern | None = None
    dead: list[Any] = []  # dead loads
    notes: list[str] = []
    for number, group in enumerate(problem.boundary_conditions):
        grows = group is growing
        if grows and group.body_forces and not (group.point_loads or group.surface_loads):
            load = _field(group.body_forces, gravity)
            continue
        forces, unused = acting_forces(group_name(problem, group), group, by_node, masses)
        notes += unused
        made: list[dict[str, Any]] = [
            {"block": name_of(one.node), "force": one.force, "point": place_on(one, by_name)}
            for one in forces
        ]
        if grows and made:
            load = ForcesPattern(entries=tuple(PointForce(**values) for values in made))
        elif not grows:
            dead += [
                ForceLoad(**values, mass=False, stage=number + 1, name=one.place)
                for values, one in zip(made, forces, strict=True)
            ]
    if growing is not None:
        _check_growing(group_name(problem, growing), load, moves.settlement)
    return Actions(
        load=load,
        dead_loads=tuple(dead),
        settlement=moves.settlement,
        held=moves.held,
        notes=tuple(notes),
    )


def _field(body_forces: Sequence[Any], gravity: float) -> AccelerationPattern:
    """The pattern of body forces, which act on all blocks."""
    total = np.sum([one.acceleration for one in body_forces], axis=0) / gravity
    return AccelerationPattern(entries=(Acceleration(group=EVERY, acceleration=total),))


def _check_growing(name: str, load: LoadPattern | None, settlement: Settlement | None) -> None:
    """Raise `ModelError` unless either loads grow or supports move."""
    if load is None and settlement is None:
        raise ModelError([f"{name}: nothing in it can grow: give it a load on a block that moves"])
    if load is not None and settlement is not None:
        raise ModelError(
            [
                f"{name}: has loads and a prescribed displacement: drystone lets one of the two "
                "grow: move the loads to a boundary condition of their own"
            ]
        )
