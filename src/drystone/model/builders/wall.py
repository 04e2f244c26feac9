"""Coursed panels of equal units."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from drystone.model.assembly import Block
from drystone.model.builders.stones import check_count
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted

#: What one letter of a course stands for: its length in half units, and whether a block is there.
SYMBOLS = {"1": (2, True), "h": (1, True), ".": (2, False)}


def course_problem(course: str) -> str | None:
    """What is wrong with the text of a course, if anything."""
    if not course:
        return 'is empty: write the units of the course, as in "h1111h"'
    for position, symbol in enumerate(course, start=1):
        if symbol not in SYMBOLS:
            return (
                f"has {quoted(symbol)} as letter {position}: "
                "1 is a whole unit, h half a unit and . a void of one unit"
            )
    return None


def unequal_courses(courses: Sequence[str]) -> str | None:
    """A sentence where courses are not of one length, which is seldom meant."""
    halves = [_halves(course) for course in courses]
    most = max(halves)
    short = [k for k, n in enumerate(halves) if n != most]
    if not short:
        return None
    k = short[0]
    others = f" (and {len(short) - 1} more)" if len(short) > 1 else ""
    return (
        f"courses[{k + 1}]{others}: {quoted(courses[k])} is {0.5 * halves[k]:g} units long, the "
        f"longest course {0.5 * most:g}: add units, h for half a one, or . for voids"
    )


def coursed_wall(
    *,
    unit: Sequence[float],
    courses: Sequence[str],
    unit_weight: float,
    repeat: int = 1,
    base: bool = False,
    material: str = "",
    origin: Sequence[float] = (0.0, 0.0),
) -> list[Block]:
    """Blocks of a panel in courses, bottom to top, each from left to right.

    Parameters
    ----------
    unit
        Length and height of a whole unit [m].
    courses
        Bottom to top, one letter a unit: ``1`` whole, ``h`` half, ``.`` a void of one unit.
    unit_weight
        N/m3.
    repeat
        How many times the courses are laid.
    base
        Whether to lay one fixed block under the wall: its top at the height of the origin, one
        unit longer than the wall at either end, one unit high.
    origin
        Lower left corner of the first course [m].

    Returns
    -------
    list of Block
        ``c{course}u{number}``, both counted from 1 and voids left out; before them ``base``.

    Raises
    ------
    ModelError
        A course holds an unknown letter, or nothing.
    """
    _check(courses)
    check_count(repeat * sum(sum(SYMBOLS[s][1] for s in course) for course in courses))
    length, height = map(float, unit)
    x0, y0 = map(float, origin)
    stone = partial(Block, unit_weight=unit_weight, material=material)

    def outline(row: int, start: int, end: int) -> np.ndarray:
        """In a row of the wall, from half unit to half unit."""
        bottom, top = y0 + row * height, y0 + (row + 1) * height
        left, right = x0 + 0.5 * start * length, x0 + 0.5 * end * length
        return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])

    laid = list(courses) * repeat
    blocks = [
        stone(id=f"c{row + 1}u{number}", vertices=outline(row, *span))
        for row, course in enumerate(laid)
        for number, span in enumerate(_units(course), start=1)
    ]
    if base:
        longest = max(map(_halves, laid), default=0)
        blocks.insert(0, stone(id="base", vertices=outline(-1, -2, longest + 2), support=True))
    return blocks


def _check(courses: Sequence[str]) -> None:
    """Raise `ModelError` for courses that are none."""
    problems = [
        f"courses[{i}]: {problem}"
        for i, course in enumerate(courses, start=1)
        if (problem := course_problem(course))
    ]
    if problems:
        raise ModelError(problems)


def _halves(course: str) -> int:
    """Length of a course in half units."""
    return sum(SYMBOLS[symbol][0] for symbol in course)


def _units(course: str) -> Iterator[tuple[int, int]]:
    """Start and end of each real unit, in half units: whole numbers, so that joints line up."""
    position = 0
    for symbol in course:
        halves, real = SYMBOLS[symbol]
        if real:
            yield position, position + halves
        position += halves
