"""Spandrels: masonry between the backs of two arches, or of one and the end of a bridge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.builders.coursing import Bond, Line
from drystone.model.builders.stones import Depth, Mason, rectangle

#: Width, over that of a unit, under which level ground between two arches is none.
NOTHING = 1e-6


@dataclass(frozen=True, kw_only=True)
class Spandrel:
    """What lies between two chains of joints, each from its springing up to the crown."""

    mason: Mason
    unit: Sequence[float]  # m, length and height
    depth: Depth
    left: Array | None  # (n, 2) m, of the arch on the left; None: an upright face
    right: Array | None
    ends: tuple[float, float]  # m, where upright faces are
    prefix: str
    group: str

    @property
    def bond(self) -> Bond:
        """Of its courses."""
        return Bond(name="running", unit=self.unit[0])

    def blocks(self, base: float, steep: float, top: float) -> list[Block]:
        """Courses from ``base`` to ``steep``, stones on single voussoirs from there to ``top``
        [m]."""
        made: list[Block] = []
        n = round((steep - base) / self.unit[1])
        levels = np.linspace(base, steep, n + 1).tolist() if n else [base]
        for course, (low, high) in enumerate(pairwise(levels)):
            made += self._course(course, low, high)
        outlines = self._under_deck(levels[-1], top, n)
        for k, outline in enumerate(outlines, start=1):
            name = f"{self.prefix}d{k}"
            made.append(self.mason.upright(name, outline, self.depth, self.group))
        return made

    def _course(self, course: int, low: float, high: float) -> list[Block]:
        """Stones between two levels [m]; those beside arches follow their backs."""
        sides = [self._side(chain, low, high, k) for k, chain in enumerate((self.left, self.right))]
        begin, end = (_line(side) for side in sides)
        made = []
        pieces = self.bond.pieces(course, begin, end, (0.0, high - low), self.ends[0])
        for k, piece in enumerate(pieces):
            left = sides[0] if k == 0 else _upright(piece.begin.at, low, high)
            right = sides[1] if k == len(pieces) - 1 else _upright(piece.end.at, low, high)
            outline = _simple(np.vstack((right, left[::-1])))
            name = f"{self.prefix}c{course + 1}u{k + 1}"
            made.append(self.mason.upright(name, outline, self.depth, self.group))
        return made

    def _side(self, chain: Array | None, low: float, high: float, k: int) -> Array:
        """What bounds a course, from its lower level to its upper one, (n, 2) [m]."""
        if chain is None:
            return _upright(self.ends[k], low, high)
        within = chain[(chain[:, 1] > low + 1e-12) & (chain[:, 1] < high - 1e-12)]
        first, last = ((_x(chain, z), z) for z in (low, high))
        return np.vstack((first, within, last))

    def _under_deck(self, level: float, top: float, course: int) -> list[Array]:
        """Outlines from left to right: on voussoirs, in courses on the level between the arches,
        again on voussoirs."""
        left, right = (
            [np.array([self.ends[k], level])] if chain is None else self._above(chain, level)
            for k, chain in enumerate((self.left, self.right))
        )
        outlines = [_under(p, q, top) for q, p in pairwise(left)][::-1]
        low, high = float(left[0][0]), float(right[0][0])
        rising = [_under(p, q, top) for p, q in pairwise(right)]
        if high - low <= NOTHING * self.unit[0]:
            return outlines + rising
        if high - low < self.bond.least and rising:  # a sliver goes with its neighbour
            first = np.vstack(([low, level], rising[0][:2], [rising[0][1][0], top], [low, top]))
            return [*outlines, first, *rising[1:]]
        rows = max(1, round((top - level) / self.unit[1]))
        heights = np.linspace(level, top, rows + 1).tolist()
        flat = [
            rectangle(piece.begin.at, bottom, piece.end.at, above)
            for k, (bottom, above) in enumerate(pairwise(heights), start=course)
            for piece in self.bond.pieces(k, Line(low), Line(high), (0.0, 0.0), self.ends[0])
        ]
        return outlines + flat + rising

    def _above(self, chain: Array, level: float) -> list[Array]:
        """Points of a chain from a level up to the crown."""
        return [np.array([_x(chain, level), level]), *chain[chain[:, 1] > level + 1e-9]]


def _x(chain: Array, z: float) -> float:
    return float(np.interp(z, chain[:, 1], chain[:, 0]))


def _upright(x: float, low: float, high: float) -> Array:
    return np.array([[x, low], [x, high]])


def _line(side: Array) -> Line:
    """The line from a side's lower end to its upper one, over the height above the former [m]."""
    (x0, z0), (x1, z1) = side[0], side[-1]
    slope = float((x1 - x0) / (z1 - z0))
    return Line(float(x0), slope)


def _under(p: Array, q: Array, top: float) -> Array:
    """Outline over the way from p to q, to its right, up to a level [m]."""
    return np.array([p, q, [q[0], top], [p[0], top]])


def _simple(outline: Array) -> Array:
    """Without vertices given twice in a row."""
    following = np.roll(outline, -1, axis=0)
    size = float(np.ptp(outline, axis=0).max())
    return outline[np.linalg.norm(following - outline, axis=1) > 1e-9 * size]
