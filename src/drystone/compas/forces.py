"""Forces of a boundary condition, resolved to points of blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.common.errors import ModelError
from drystone.compas.blocks import name_of
from drystone.compas.growing import group_name
from drystone.model.assembly import Block
from drystone.model.loading.targets import CENTRE

#: The one time series that a static analysis knows.
RAMP = "ramp"

#: Farthest that a point of application may be from its block, over the block's size: as far as the
#: import of meshes moves vertices by default.
NEAR = 0.02

#: Over the same size, when a point is on its block.  A hundredth of what the check of loads takes.
ON = 1e-8

#: Halvings of the way from a point to the middle of its block, which find where it enters.
HALVINGS = 40


@dataclass(frozen=True, kw_only=True)
class Force:
    """A force on a block."""

    node: int
    force: Array  # (3,) N
    point: Array | None = None  # (3,) m; None: the centre of mass
    place: str  # where it stands, for messages
    everywhere: bool = False  # of a body force


def check_loads(problem: Any, elements: Mapping[int, Any]) -> None:
    """Raise `ModelError` on all loads of a problem that no static analysis of drystone takes."""
    if wrong := [
        sentence
        for group in problem.boundary_conditions
        for sentence in _impossible(group_name(problem, group), group, elements)
    ]:
        raise ModelError(wrong)


def _impossible(place: str, group: Any, elements: Mapping[int, Any]) -> list[str]:
    """Loads in time, moments, and loads on a block that is not there, a sentence each."""
    found = []
    for kind in ("body_forces", "point_loads", "surface_loads"):
        word = kind[:-1].replace("_", " ")
        for k, one in enumerate(getattr(group, kind)):
            where = f"{place}, {word} {k + 1}"
            if one.loading_type != RAMP:
                found.append(
                    f'{where}: loading_type="{one.loading_type}" is a load in time: drystone\'s '
                    'curve is static: take "ramp"'
                )
            if getattr(one, "moment", None) is not None and np.any(one.moment):
                found.append(
                    f"{where}: has a moment: drystone has forces at points only: give a couple of "
                    "two point loads"
                )
            if (node := getattr(one, "block_index", None)) is not None and node not in elements:
                found.append(f"{where}: there is no block at node {node} of the graph")
    return found


def acting_forces(
    place: str, group: Any, elements: Mapping[int, Any], masses: Mapping[int, float]
) -> tuple[list[Force], list[str]]:
    """Forces on the blocks that move, and a sentence on each that a support takes.

    ``masses`` [kg] are those of the blocks, by node.  The loads are those that `check_loads`
    has taken.

    Raises `ModelError` where the face of a surface load is not there.
    """
    forces = [
        *_of_body_forces(place, group.body_forces, masses),
        *_of_point_loads(place, group.point_loads),
        *_of_surface_loads(place, group.surface_loads, elements),
    ]
    acting = [one for one in forces if not elements[one.node].is_support and one.force.any()]
    unused = [
        f"{one.place}: acts on the support {one.node}, and on nothing else"
        for one in forces
        if elements[one.node].is_support and not one.everywhere
    ]
    return acting, unused


def _of_body_forces(place: str, loads: Any, masses: Mapping[int, float]) -> list[Force]:
    return [
        Force(
            node=node,
            force=np.array(one.acceleration, float) * mass,
            place=f"{place}, body force {k + 1}",
            everywhere=True,
        )
        for k, one in enumerate(loads)
        for node, mass in masses.items()
    ]


def _of_point_loads(place: str, loads: Any) -> list[Force]:
    return [
        Force(
            node=one.block_index,
            force=np.array(one.force or (0.0, 0.0, 0.0), float),
            point=None if one.point is None else np.array(one.point, float),
            place=f"{place}, point load {k + 1}",
        )
        for k, one in enumerate(loads)
    ]


def _of_surface_loads(place: str, loads: Any, elements: Mapping[int, Any]) -> list[Force]:
    """Tractions as their resultants at the centres of the faces, as in compas_dem."""
    found = []
    for k, one in enumerate(loads):
        mesh = elements[one.block_index].modelgeometry
        where = f"{place}, surface load {k + 1}"
        if one.face_index not in set(mesh.faces()):
            raise ModelError([f"{where}: block {one.block_index} has no face {one.face_index}"])
        found.append(
            Force(
                node=one.block_index,
                force=np.array(one.load, float) * float(mesh.face_area(one.face_index)),
                point=np.array(mesh.face_center(one.face_index), float),
                place=where,
            )
        )
    return found


def place_on(one: Force, blocks: Mapping[str, Block]) -> str | Array:
    """Where a force acts: the name of the centre, or (3,) m on the block.

    A point that lies off the block by no more than the import may have moved its faces is brought
    onto it, towards its middle.  Raises `ModelError` where it lies farther off.
    """
    if one.point is None:
        return CENTRE
    figure = blocks[name_of(one.node)].figure()
    size = float(np.ptp(blocks[name_of(one.node)].vertices, axis=0).max())
    if figure.distance(one.point) <= ON * size:
        return one.point
    middle = figure.centroid
    outside, inside = 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (outside + inside)
        there = figure.distance(one.point + share * (middle - one.point)) <= ON * size
        outside, inside = (outside, share) if there else (share, inside)
    entered = one.point + inside * (middle - one.point)
    if float(np.linalg.norm(entered - one.point)) > NEAR * size:
        raise ModelError(
            [f"{one.place}: its point is not on block {one.node}: drystone's forces act on blocks"]
        )
    return np.asarray(entered)
