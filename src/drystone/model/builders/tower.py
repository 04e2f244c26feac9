"""Towers, round or square, with openings that climb around them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from drystone.common.keys import Choice
from drystone.model.assembly import Block
from drystone.model.builders.base import Builder, Count, FromZero, Metres, Pair, WholeUnit
from drystone.model.builders.openings import Opening
from drystone.model.builders.plan import SIDES, plan
from drystone.model.builders.stones import (
    Mason,
    at_least,
    nearest,
    not_whole,
    positive,
    unit_problems,
    whole,
)
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import suggestion

SHAPES = ("round", "square")


# Many, each a key of model files.
def tower(
    *,
    width: Metres,
    thickness: Metres,
    height: Metres,
    unit: WholeUnit,
    unit_weight: float,
    shape: Annotated[str, Choice(SHAPES)] = "round",
    openings: Count = 0,
    opening: Pair | None = None,
    first_sill: FromZero | None = None,
    climb: FromZero | None = None,
    material: str = "",
) -> list[Block]:
    """A tower in running bond, its middle over the origin, with openings like those of a stair.

    A round one has in every course the whole number of equal stones nearest to the unit's length
    at its outer face, and its openings are as wide as the whole number of stones nearest to what is
    asked for.  Heights must fit the courses and are refused otherwise, with the nearest that fit.

    Parameters
    ----------
    width
        Outer diameter, or side [m].
    thickness, height
        Of the wall, and of the tower [m].
    unit
        Length and height of a whole unit [m].
    unit_weight
        N/m3.
    shape
        ``round`` or ``square``.
    openings
        How many, one over the other: each a quarter of the way further around, counter-clockwise
        from the south.
    opening
        Width and height of each [m].
    first_sill, climb
        Height of the lowest sill above the ground, and of each one above the one before [m].

    Returns
    -------
    list of Block
        Of a round tower ``c{course}s{number}`` and ``lintel{number}``; of a square one as of a
        `plan`.  Groups are "course 1", ..., "lintels".

    Raises
    ------
    ModelError
        The measures make no tower, or openings do not fit.
    """
    problems = [*positive(width=width, thickness=thickness, height=height), *unit_problems(unit)]
    problems += at_least(0, openings=openings)
    if shape not in SHAPES:
        problems.append(f'shape: there is no shape "{shape}": {suggestion(shape, SHAPES)}')
    if not problems and not thickness < 0.5 * width:
        problems.append(f"thickness: must be less than half the width, {0.5 * width:g} m")
    if openings > 0 and (opening is None or first_sill is None or climb is None):
        problems.append("openings: give opening = [width, height], first_sill and climb with them")
    problems = problems or not_whole("height", height, unit[1])
    if problems:
        raise ModelError(problems)
    wide, high = (0.0, 0.0) if opening is None else opening
    sills = [(first_sill or 0.0) + k * (climb or 0.0) for k in range(openings)]
    if shape == "square":
        return _square(width, thickness, height, unit, unit_weight, sills, (wide, high), material)
    mason = Mason(unit_weight=unit_weight, material=material)
    return _Round(mason, width, thickness, unit).blocks(height, sills, wide, high)


# Many, each a measure of the tower.
def _square(
    width: float, thickness: float, height: float, unit: Sequence[float], unit_weight: float,
    sills: Sequence[float], opening: tuple[float, float], material: str,
) -> list[Block]:  # fmt: skip
    """A plan of four walls, openings in the middle of one after the other."""
    length = width - thickness  # of a wall's centre line
    holes = [
        Opening(
            wall=SIDES[k % 4], at=0.5 * (length - opening[0]), width=opening[0], height=opening[1],
            sill=sill,
        )
        for k, sill in enumerate(sills)
    ]  # fmt: skip
    made = plan(
        rectangle=(width, width), thickness=thickness, height=height, unit=unit,
        unit_weight=unit_weight, openings=holes, material=material,
    )  # fmt: skip
    shift = np.array([-0.5 * width, -0.5 * width, 0.0])
    return [block.with_vertices(block.vertices + shift) for block in made]


TOWER = Builder(make=tower, dimensions=(3,))


class _Round:
    """A ring of stones, counted in half stones around."""

    def __init__(self, mason: Mason, width: float, thickness: float, unit: Sequence[float]) -> None:
        self.mason, self.unit = mason, unit
        self.outer, self.inner = 0.5 * width, 0.5 * width - thickness
        self.halves = 2 * max(6, round(np.pi * width / unit[0]))

    def blocks(
        self, height: float, sills: Sequence[float], wide: float, high: float
    ) -> list[Block]:
        """All courses; raises `ModelError` where openings do not fit."""
        n_courses = whole(height, self.unit[1]) or 1
        holes = self._holes(n_courses, sills, wide, high)
        made: list[Block] = []
        for course in range(n_courses):
            cuts = sorted(
                (begin, end) if course < head else (begin - 1, end + 1)
                for begin, end, sill, head in holes
                if sill <= course <= head
            )
            made += self._course(course, cuts)
            for k, (begin, end, _, head) in enumerate(holes, start=1):
                if course == head:
                    stone = self._stone(f"lintel{k}", begin - 1, end + 1, course, "lintels")
                    made.append(stone)
        return made

    def _holes(
        self, n_courses: int, sills: Sequence[float], wide: float, high: float
    ) -> list[tuple[int, int, int, int]]:
        """Openings: from which half stone to which, first course and that of the lintel."""
        problems, holes = [], []
        step = self.unit[1]
        stones = max(1, round(wide * self.halves / (4.0 * np.pi * self.outer)))
        if 2 * stones + 2 > self.halves // 2:
            raise ModelError(["opening: is as wide as half the tower: make it narrower"])
        for k, sill in enumerate(sills):
            for key, length in (("first_sill" if k == 0 else "climb", sill), ("opening", high)):
                if length and whole(length, step) is None:
                    problems.append(
                        f"{key}: {length:g} m ends inside a course of {step:g} m: "
                        f"{nearest(length, step)}"
                    )
            first = round(sill / step)
            head = first + round(high / step)
            if head >= n_courses:
                problems.append(
                    f"openings: the lintel of number {k + 1} would lie over the tower: the nearest "
                    f"that fits are {k}"
                )
            begin = round((k + 3) * self.halves / 4.0) - stones
            holes.append((begin, begin + 2 * stones, first, head))
        around = [(set(range(b - 1, e + 1)), first, head) for b, e, first, head in holes]
        for i, (own, first, head) in enumerate(around):
            for other, low, top in around[:i]:
                met = {h % self.halves for h in own} & {h % self.halves for h in other}
                if met and first <= top and low <= head:
                    problems.append("climb: openings meet: make it larger, or the openings smaller")
        if problems:
            raise ModelError(dict.fromkeys(problems))
        return holes

    def _course(self, course: int, cuts: Sequence[tuple[int, int]]) -> list[Block]:
        """Stones of two halves, single ones beside openings."""
        free = sorted(
            {h for h in range(self.halves)}
            - {h % self.halves for begin, end in cuts for h in range(begin, end)}
        )
        made: list[Block] = []
        taken: set[int] = set()
        for h in free:
            if h in taken:
                continue
            first = h - (h - course) % 2  # a stone of this course begins there
            both = [x % self.halves for x in (first, first + 1)]
            own = [x for x in both if x in free]
            taken.update(own)
            begin = first if len(own) == 2 or own[0] == both[0] else first + 1
            name = f"c{course + 1}s{len(made) + 1}"
            made.append(self._stone(name, begin, begin + len(own), course, f"course {course + 1}"))
        return made

    def _stone(self, name: str, begin: int, end: int, course: int, *groups: str) -> Block:
        """From one half stone to another, straight from joint to joint."""
        angle = 2.0 * np.pi * np.array([begin, end]) / self.halves
        ray = np.column_stack((np.cos(angle), np.sin(angle)))
        corners = [
            self.inner * ray[0],
            self.outer * ray[0],
            self.outer * ray[1],
            self.inner * ray[1],
        ]
        low = course * self.unit[1]
        levels = low, (course + 1) * self.unit[1]
        return self.mason.flat(name, np.array(corners), levels, *groups)
