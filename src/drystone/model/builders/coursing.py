"""Courses: where a bond has its joints, how a run of wall is cut by them, what openings take.

Along a wall runs u, across it v, both in metres.  What bounds a stone is a line across the wall,
u = at + slope v, so that oblique ends of walls are cut as they come.  A joint that would leave a
stone shorter than a quarter of a unit is left out: its neighbour is that much longer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, NamedTuple

from drystone.common.keys import Choice
from drystone.model.builders.stones import at_least, check_count
from drystone.model.construction.words import suggestion

#: Shortest stone that is cut, as a share of the unit's length: a queen closer.
LEAST = 0.25
#: Share of a unit that is taken for rounding.
ROUNDING = 1e-9

BONDS = ("running", "stack", "header", "english", "flemish")
BondName = Annotated[str, Choice(BONDS)]


class Line(NamedTuple):
    """What bounds a stone: u = at + slope v [m]."""

    at: float
    slope: float = 0.0

    def __call__(self, v: float) -> float:
        return self.at + self.slope * v

    def ends(self, breadth: tuple[float, float]) -> tuple[float, float]:
        """Least and largest u [m] on a wall from v to v."""
        first, last = self(breadth[0]), self(breadth[1])
        return min(first, last), max(first, last)


class Piece(NamedTuple):
    """A stone of a course, between two lines; a header goes through all leaves."""

    begin: Line
    end: Line
    header: bool


class Void(NamedTuple):
    """What is left out of a course."""

    begin: Line
    end: Line


@dataclass(frozen=True, kw_only=True)
class Bond:
    """Which stones follow each other in a course, by its number from 0."""

    name: str
    unit: float  # m, length of a stretcher
    headers: int = 0  # every so many courses one of headers; 0: none but those of the bond

    @property
    def header(self) -> float:
        """Length of a header along the wall [m]."""
        return 0.5 * self.unit

    @property
    def least(self) -> float:
        """Length of the shortest stone [m]."""
        return LEAST * self.unit * (1.0 - ROUNDING)

    def pattern(self, course: int) -> tuple[tuple[tuple[float, bool], ...], float]:
        """Lengths [m] of the stones that repeat, each with whether it is a header, and where the
        first begins [m]."""
        stretcher, header = (self.unit, False), (self.header, True)
        odd = course % 2
        if self.name == "flemish":
            return (stretcher, header), -0.5 * odd * (self.unit + self.header)
        if self.name == "header":
            return (header,), -0.5 * odd * self.header
        if (self.name == "english" and odd) or (self.headers and (course + 1) % self.headers == 0):
            return (header,), -0.5 * self.header
        return (stretcher,), -0.5 * self.unit if odd and self.name == "running" else 0.0

    def pieces(
        self, course: int, begin: Line, end: Line, breadth: tuple[float, float], anchor: float,
        through: tuple[float, float] = (0.0, 0.0),
    ) -> list[Piece]:  # fmt: skip
        """The stones between two lines, the bond counted from u = ``anchor`` [m].

        No joint is nearer to an end than the length ``through`` [m] there and a closer.
        """
        first = begin.ends(breadth)[1] + through[0] + self.least
        last = end.ends(breadth)[0] - through[1] - self.least
        check_count((last - first) / self.header)
        cuts = [u for u, _ in self._joints(course, first, last, anchor)]
        lines = [begin, *map(Line, cuts), end]
        middle = 0.5 * (breadth[0] + breadth[1])
        return [
            Piece(a, b, self._is_header(course, 0.5 * (a(middle) + b(middle)), anchor))
            for a, b in pairwise(lines)
        ]

    def _joints(
        self, course: int, first: float, last: float, anchor: float
    ) -> Iterator[tuple[float, bool]]:
        """Joints from ``first`` to ``last`` [m], each with whether a header begins there."""
        stones, phase = self.pattern(course)
        period = sum(length for length, _ in stones)
        begin = anchor + phase
        k = math.floor((first - begin) / period)
        while True:
            u = begin + k * period
            for length, header in stones:
                if u > last:
                    return
                if u >= first:
                    yield u, header
                u += length
            k += 1

    def _is_header(self, course: int, u: float, anchor: float) -> bool:
        """Whether the bond has a header at u [m]."""
        stones, phase = self.pattern(course)
        period = sum(length for length, _ in stones)
        rest = math.fmod(math.fmod(u - anchor - phase, period) + period, period)
        for length, header in stones:
            if rest < length:
                return header
            rest -= length
        return stones[-1][1]


def bond_problems(bond: str, headers: int, leaves: int) -> list[str]:
    """Sentences on a bond that there is not."""
    found = []
    if bond not in BONDS:
        found.append(f'bond: there is no bond "{bond}": {suggestion(bond, BONDS)}')
    if headers < 0 or headers == 1:
        found.append(
            f'headers: must be 0 or at least 2, it is {headers}: bond = "header" has headers alone'
        )
    return found + at_least(1, leaves=leaves)


def between(begin: Line, end: Line, voids: Sequence[Void]) -> list[tuple[Line, Line]]:
    """What voids leave of a run, in order."""
    found, at = [], begin
    for void in sorted(voids, key=lambda void: void.begin.at):
        if void.begin.at > at.at:
            found.append((at, void.begin))
        at = void.end
    if end.at > at.at:
        found.append((at, end))
    return found
