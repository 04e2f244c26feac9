"""Walls in plan: a rectangle or polylines, interlocked where they meet, storey upon storey."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any

import numpy as np

from drystone.common.keys import Tables, Whole
from drystone.model.assembly import Block
from drystone.model.builders.base import (
    Builder,
    Count,
    FromZero,
    Length,
    Pair,
    Polylines,
    WholeUnit,
)
from drystone.model.builders.coursing import Bond, BondName, bond_problems
from drystone.model.builders.junctions import Joined, Wall, joined
from drystone.model.builders.openings import (
    PLAN_OPENING_KEYS,
    Hole,
    Opening,
    clearance_problems,
    measure_problems,
    openings_of,
    voids_in,
)
from drystone.model.builders.stones import (
    Mason,
    at_least,
    not_whole,
    positive,
    unit_problems,
    whole,
)
from drystone.model.builders.strip import Strip
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted, suggestion

SIDES = ("south", "east", "north", "west")


# Many, each a key of model files.
def plan(
    *,
    unit: WholeUnit,
    thickness: Annotated[Length, "of the walls, in m"],
    height: Annotated[Length, "of a storey, in m"],
    unit_weight: float,
    rectangle: Pair | None = None,
    lines: Polylines = (),
    storeys: Annotated[int, Whole(1, 1000)] = 1,
    floor: FromZero = 0.0,
    beam: Length | None = None,
    leaves: Count = 1,
    bond: BondName = "running",
    headers: Count = 0,
    openings: Annotated[Sequence[Opening | Mapping[str, Any]], Tables(PLAN_OPENING_KEYS)] = (),
    material: str = "",
) -> list[Block]:
    """Walls along centre lines, all of one thickness and height, with openings and floors.

    Where walls meet, one of them goes through in a course and the other one in the next, with a
    stone that reaches at least a quarter of a unit beyond.  Units are cut to fit along the walls;
    heights must fit the courses and are refused otherwise, with the
    nearest that fit, and so are openings that meet another wall.

    Parameters
    ----------
    unit
        Length and height of a whole unit [m].
    thickness, height
        Of the walls, and of a storey without its floor [m].
    unit_weight
        N/m3.
    rectangle
        Length along x and along y from outer face to outer face [m]: walls ``south``, ``east``,
        ``north`` and ``west``, the outer corner at the origin.
    lines
        Centre lines of walls ``w1``, ``w2``, ..., each a list of points [x, y] [m]; one that ends
        where it began is closed.  A wall may end at another one or cross it.
    storeys
        How many times the walls are laid.
    floor
        Height of the beams over each storey [m], which span the shorter side of the rectangle from
        outer face to outer face; 0: no floor.
    beam
        Width of a beam, to which the nearest whole number of equal ones is found [m]; a unit's
        length by default.
    leaves, bond, headers
        As of a panel.
    openings
        Doors and windows, each an `Opening` or its keys: ``wall`` names the wall, ``at`` counts
        along it from the beginning of its centre line, ``sill`` from the foot of the storey.

    Returns
    -------
    list of Block
        ``{wall}/c{course}u{number}``, courses counted through all storeys; ``{wall}/lintel{n}``,
        with ``s{storey}`` before the number where there are several; ``floor{storey}b{number}``.
        Groups are "wall south", "storey 1", "course 1", "floor 1", "lintels", "headers".

    Raises
    ------
    ModelError
        The measures make no walls.
    """
    problems = [
        *positive(height=height, thickness=thickness, beam=beam),
        *unit_problems(unit),
        *bond_problems(bond, headers, leaves),
        *at_least(1, storeys=storeys),
    ]
    if floor < 0.0:
        problems.append(f"floor: must be at least 0 m, it is {floor:g}")
    if floor > 0.0 and rectangle is None:
        problems.append("floor: beams need a rectangle to span: give one, or floor = 0")
    if problems:
        raise ModelError(problems)
    walls = _walls(rectangle, lines, thickness)
    if problems := not_whole("height", height, unit[1]):
        raise ModelError(problems)
    n_courses = whole(height, unit[1]) or 1
    bounds, problems = joined(walls, thickness)
    given = openings_of(openings)
    problems += measure_problems(given, unit, n_courses)
    problems += _unknown(given, walls, storeys)
    if problems:
        raise ModelError(problems)
    mason = Mason(unit_weight=unit_weight, material=material)
    house = _House(
        walls=walls,
        bounds=bounds,
        strips=[
            _strip(
                wall, own, mason, Bond(name=bond, unit=unit[0], headers=headers), thickness, leaves
            )
            for wall, own in zip(walls, bounds, strict=True)
        ],
        unit=unit,
        n_courses=n_courses,
        floor=floor,
        several=storeys > 1,
    )
    holes = [house.holes(given, storey) for storey in range(storeys)]
    if problems := [text for own in holes for text in house.clearance(own)]:
        raise ModelError(list(dict.fromkeys(problems)))
    blocks: list[Block] = []
    for storey in range(storeys):
        blocks += house.storey(storey, holes[storey])
        if floor and rectangle is not None:
            wide = unit[0] if beam is None else beam
            blocks += _floor(mason, rectangle, house.top(storey), floor, wide, storey)
    return blocks


PLAN = Builder(make=plan, dimensions=(3,))


@dataclass(frozen=True, kw_only=True)
class _House:
    """Walls that are laid storey upon storey."""

    walls: list[Wall]
    bounds: list[Joined]
    strips: list[Strip]
    unit: Sequence[float]
    n_courses: int  # of a storey
    floor: float  # m
    several: bool  # storeys

    def foot(self, storey: int) -> float:
        """Of a storey, counted from 0 [m]."""
        return storey * (self.n_courses * self.unit[1] + self.floor)

    def top(self, storey: int) -> float:
        """Of a storey's walls [m]."""
        return self.foot(storey) + self.n_courses * self.unit[1]

    def holes(self, given: Sequence[Opening], storey: int) -> dict[str, list[Hole]]:
        """Openings of a storey by wall."""
        found: dict[str, list[Hole]] = {wall.name: [] for wall in self.walls}
        for i, opening in enumerate(given, start=1):
            if opening.storey in (0, storey + 1):
                found[opening.wall].append(Hole(opening, self.unit, f"openings[{i}]"))
        return found

    def clearance(self, holes: Mapping[str, list[Hole]]) -> list[str]:
        """Sentences on openings that meet what they must not."""
        found = []
        for wall, own, strip in zip(self.walls, self.bounds, self.strips, strict=True):
            low, high = own.free(strip.breadth)
            least = strip.bond.least
            taken = own.taken(strip.breadth)
            found += clearance_problems(holes[wall.name], low, high, taken, least)
        return found

    def storey(self, storey: int, holes: Mapping[str, list[Hole]]) -> list[Block]:
        """Its walls, course by course."""
        made: list[Block] = []
        foot, height = self.foot(storey), self.unit[1]
        first = storey * (self.n_courses + bool(self.floor))  # a floor is a course of its own
        lintel = f"s{storey + 1}lintel" if self.several else "lintel"
        for k in range(self.n_courses):
            levels = foot + k * height, foot + (k + 1) * height
            course, number = first + k, storey * self.n_courses + k + 1
            for wall, own, strip in zip(self.walls, self.bounds, self.strips, strict=True):
                if self.several:
                    strip = replace(strip, groups=(*strip.groups, f"storey {storey + 1}"))
                parity, cut = course % 2, holes[wall.name]
                ends = own.begin[parity], own.end[parity]
                voids = [*own.voids[parity], *voids_in(cut, k)]
                through = own.through[0][parity], own.through[1][parity]
                made += strip.course(course, levels, *ends, voids, number=number, through=through)
                made += strip.lintels(k, height, foot, cut, lintel)
        return made


def _walls(
    rectangle: Sequence[float] | None, lines: Sequence[Sequence[Sequence[float]]], thickness: float
) -> list[Wall]:
    """Walls by their centre lines; raises `ModelError` where there are none."""
    made, problems = [], []
    if rectangle is not None:
        if len(rectangle) != 2 or not min(rectangle) > 2.0 * thickness:
            raise ModelError(
                ["rectangle: must be [length, width] in metres, each more than two thicknesses"]
            )
        (a, b), t = rectangle, 0.5 * thickness
        around = [(t, t), (a - t, t), (a - t, b - t), (t, b - t), (t, t)]
        made = [
            Wall(name, np.array(p), np.array(q))
            for name, (p, q) in zip(SIDES, pairwise(around), strict=True)
        ]
    count = 0
    for k, line in enumerate(lines, start=1):
        ends = [point for point in line if np.shape(point) == (2,)]
        points = np.array(ends, float)
        if len(ends) < max(len(line), 2):
            problems.append(f"lines[{k}]: must be a list of at least two points [x, y]")
            continue
        for p, q in pairwise(points):
            count += 1
            if not float(np.linalg.norm(q - p)) > thickness:
                problems.append(
                    f"lines[{k}]: wall w{count} must be longer than it is thick, {thickness:g} m"
                )
            made.append(Wall(f"w{count}", p, q))
    if not made and not problems:
        problems.append("lines: there is no wall: give a rectangle or lines")
    if problems:
        raise ModelError(problems)
    return made


def _unknown(openings: Sequence[Opening], walls: Sequence[Wall], storeys: int) -> list[str]:
    """Sentences on openings in walls and storeys that there are not."""
    names, found = [wall.name for wall in walls], []
    for i, opening in enumerate(openings, start=1):
        if opening.wall not in names:
            mend = suggestion(opening.wall, names)
            found.append(f"openings[{i}].wall: there is no wall {quoted(opening.wall)}: {mend}")
        if not 0 <= opening.storey <= storeys:
            found.append(
                f"openings[{i}].storey: must be from 1 to {storeys}, or 0 for all, "
                f"it is {opening.storey}"
            )
    return found


# Many, each a fact of the wall.
def _strip(
    wall: Wall, own: Joined, mason: Mason, bond: Bond, thickness: float, leaves: int
) -> Strip:
    """The wall as a strip, its bond counted from where it begins in the first course."""
    x, y = wall.corner(thickness).tolist()
    cx, cy = wall.along.tolist()
    return Strip(
        mason=mason,
        bond=bond,
        thickness=thickness,
        leaves=leaves,
        start=(x, y),
        along=(cx, cy),
        prefix=f"{wall.name}/",
        groups=(f"wall {wall.name}",),
        anchor=own.anchor(bond.unit, (0.0, thickness)),
    )


# Many, each a fact of the floor.
def _floor(
    mason: Mason, rectangle: Sequence[float], foot: float, height: float, beam: float, storey: int
) -> list[Block]:
    """Beams across a rectangle, all of one width."""
    long, short = max(rectangle), min(rectangle)
    along_x = rectangle[0] >= rectangle[1]
    edges = np.linspace(0.0, long, max(1, round(long / beam)) + 1).tolist()
    made = []
    for k, (a, b) in enumerate(pairwise(edges), start=1):
        low, high = ((a, 0.0), (b, short)) if along_x else ((0.0, a), (short, b))
        name = f"floor{storey + 1}b{k}"
        group = f"floor {storey + 1}"
        made.append(mason.box(name, (*low, foot), (*high, foot + height), group))
    return made
