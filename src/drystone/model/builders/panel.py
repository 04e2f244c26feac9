"""Coursed panels: one straight wall, in the plane or of one or several leaves in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from drystone.common.keys import Tables
from drystone.model.assembly import Block
from drystone.model.builders.base import AlongY, Builder, Count, Metres, WholeUnit
from drystone.model.builders.coursing import Bond, BondName, Line, bond_problems
from drystone.model.builders.openings import (
    OPENING_KEYS,
    Hole,
    Opening,
    clearance_problems,
    measure_problems,
    openings_of,
    voids_in,
)
from drystone.model.builders.stones import Mason, not_whole, positive, unit_problems, whole
from drystone.model.builders.strip import Strip
from drystone.model.construction.errors import ModelError


# Long by its keys, each with its words: they are those of model files.
def panel(
    *,
    length: Metres,
    height: Metres,
    unit: WholeUnit,
    unit_weight: float,
    thickness: AlongY = None,
    leaves: Count = 1,
    bond: BondName = "running",
    headers: Count = 0,
    openings: Annotated[Sequence[Opening | Mapping[str, Any]], Tables(OPENING_KEYS)] = (),
    material: str = "",
) -> list[Block]:
    """A wall in courses from the origin along x, up to its height; in space thick along y.

    Along the wall units are cut to fit: closers at its ends and beside openings, none shorter than
    a quarter of a unit, where the neighbour is longer instead.  Heights must fit the courses and
    are refused otherwise, with the nearest that fit; so are openings that meet an end of the wall
    or each other.

    Parameters
    ----------
    length, height
        Of the wall [m].
    unit
        Length and height of a whole unit [m].
    unit_weight
        N/m3.
    thickness
        Of the wall [m]; none in the plane.
    leaves
        Equal leaves side by side, tied by headers alone.
    bond
        ``running``, ``stack``, ``header``, ``english`` (courses of stretchers and of headers by
        turns) or ``flemish`` (both in every course).  Headers are half a unit long and go through
        all leaves.
    headers
        Every so many courses one of headers; 0: none but those of the bond.
    openings
        Doors and windows, each an `Opening` or its keys.

    Returns
    -------
    list of Block
        ``c{course}u{number}``, with ``l{leaf}`` in a stretcher of several leaves; over openings
        ``lintel{number}``.  Groups are "course 1", "leaf 1", "headers" and "lintels".

    Raises
    ------
    ModelError
        The measures make no wall.
    """
    problems = [
        *positive(length=length, height=height, thickness=thickness),
        *unit_problems(unit),
        *bond_problems(bond, headers, leaves),
    ]
    if thickness is None and leaves > 1:
        problems.append("leaves: must be 1 in the plane: set dimension = 3 and give a thickness")
    if problems:
        raise ModelError(problems)
    holes_given = openings_of(openings)
    problems = not_whole("height", height, unit[1])
    n_courses = whole(height, unit[1]) or round(height / unit[1])
    problems += measure_problems(holes_given, unit, n_courses)
    if problems:
        raise ModelError(problems)
    holes = [Hole(o, unit, f"openings[{i}]") for i, o in enumerate(holes_given, start=1)]
    strip = Strip(
        mason=Mason(unit_weight=unit_weight, material=material),
        bond=Bond(name=bond, unit=unit[0], headers=headers),
        thickness=thickness,
        leaves=leaves,
    )
    if problems := clearance_problems(holes, 0.0, length, (), strip.bond.least):
        raise ModelError(problems)
    blocks: list[Block] = []
    for course in range(n_courses):
        levels = course * unit[1], (course + 1) * unit[1]
        blocks += strip.course(course, levels, Line(0.0), Line(length), voids_in(holes, course))
        blocks += strip.lintels(course, unit[1], 0.0, holes)
    return blocks


PANEL = Builder(make=panel)
