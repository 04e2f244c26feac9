"""Where walls of a plan meet: corners, T junctions and crossings, interlocked course by course.

In a course one of two walls goes through and the other one ends at its face, in the next course it
is the other way round.  A wall is cut by the faces of those it meets, so that corners of any angle
close.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.model.builders.coursing import Line, Void

#: Points as near as this share of the plan's size are one.
SAME = 1e-6
#: Sine of the smallest angle at which walls may meet.
SHARPEST = 0.25


class Wall(NamedTuple):
    """A straight wall by its centre line."""

    name: str
    begin: Array  # (2,) m
    end: Array  # (2,) m

    @property
    def length(self) -> float:
        """Of the centre line [m]."""
        return float(np.linalg.norm(self.end - self.begin))

    @property
    def along(self) -> Array:
        """Unit vector from its beginning to its end."""
        return np.asarray((self.end - self.begin) / self.length)

    @property
    def across(self) -> Array:
        """Unit vector to its left."""
        x, y = self.along
        return np.array([-y, x])

    def corner(self, thickness: float) -> Array:
        """Where u = v = 0: at its beginning, on its right face."""
        return np.asarray(self.begin - 0.5 * thickness * self.across)

    def face(self, other: Wall, side: float, thickness: float) -> Line:
        """The other wall's face, its left one for ``side`` = 1, as a line across this wall."""
        normal = other.across
        point = other.begin + 0.5 * side * thickness * normal
        along, across = self.along @ normal, self.across @ normal
        at = (point - self.corner(thickness)) @ normal
        return Line(float(at / along), float(-across / along) + 0.0)


@dataclass
class Joined:
    """How a wall is bounded in even and in odd courses: two of everything."""

    begin: list[Line]
    end: list[Line]
    voids: tuple[list[Void], list[Void]] = field(default_factory=lambda: ([], []))
    # Length along it of the wall that it goes through at either end [m]; 0 where it does not.
    through: tuple[list[float], list[float]] = field(
        default_factory=lambda: ([0.0, 0.0], [0.0, 0.0])
    )

    def free(self, breadth: tuple[float, float]) -> tuple[float, float]:
        """Between which u [m] both courses have the wall."""
        low = max(line.ends(breadth)[1] for line in self.begin)
        return low, min(line.ends(breadth)[0] for line in self.end)

    def anchor(self, unit: float, breadth: tuple[float, float]) -> float:
        """From where the bond counts u [m]: from the end that goes through another wall, so that a
        whole unit lies there; of two, or none, from the beginning."""
        middle = 0.5 * (breadth[0] + breadth[1])
        if any(self.through[1]) and not any(self.through[0]):
            parity = int(self.through[1][1] > 0.0)
            return self.end[parity](middle) + 0.5 * unit * parity
        parity = int(self.through[0][1] > 0.0)
        return self.begin[parity](middle) + 0.5 * unit * parity

    def taken(self, breadth: tuple[float, float]) -> list[tuple[float, float]]:
        """Where other walls go through [m]."""
        return [
            (void.begin.ends(breadth)[0], void.end.ends(breadth)[1])
            for voids in self.voids
            for void in voids
        ]


def joined(walls: Sequence[Wall], thickness: float) -> tuple[list[Joined], list[str]]:
    """The bounds of every wall, and sentences on what cannot be built."""
    found = [Joined([Line(0.0)] * 2, [Line(wall.length)] * 2) for wall in walls]
    size = max(float(np.ptp([p for w in walls for p in (w.begin, w.end)], axis=0).max()), thickness)
    problems = []
    for i, wall in enumerate(walls):
        for j in range(i + 1, len(walls)):
            sine = abs(float(wall.across @ walls[j].along))
            place = _meeting(wall, walls[j], SAME * size)
            if place is None:
                continue
            if sine < SHARPEST:
                x, y = wall.begin + place[0] * wall.along
                problems.append(
                    f"walls {wall.name} and {walls[j].name} meet at ({x:g}, {y:g}) at less than 15 "
                    "degrees, or go on straight: make one wall of them, or turn one"
                )
                continue
            _join(walls, found, (i, j), place, thickness, SAME * size)
    return found, problems + _crowded(walls, SAME * size)


def _meeting(a: Wall, b: Wall, near: float) -> tuple[float, float] | None:
    """Where on each of two centre lines they meet [m]; None where they do not."""
    sine = float(a.across @ b.along)
    if abs(sine) < SHARPEST:  # nearly parallel: they can only share an end
        for u, p in ((0.0, a.begin), (a.length, a.end)):
            for v, q in ((0.0, b.begin), (b.length, b.end)):
                if np.linalg.norm(p - q) <= near:
                    return u, v
        return None
    v = float(a.across @ (a.begin - b.begin)) / sine
    u = float(a.along @ (b.begin + v * b.along - a.begin))
    if -near <= u <= a.length + near and -near <= v <= b.length + near:
        return u, v
    return None


# Many, each a fact of the two walls.
def _join(
    walls: Sequence[Wall], found: list[Joined], pair: tuple[int, int],
    place: tuple[float, float], thickness: float, near: float,
) -> None:  # fmt: skip
    """Bound two walls that meet by each other."""
    ends = [_end_of(walls[k], u, near) for k, u in zip(pair, place, strict=True)]
    for own, k, other in ((0, pair[0], pair[1]), (1, pair[1], pair[0])):
        parity = _goes_through(ends[own], ends[1 - own], own)
        wall, across = walls[k], walls[other]
        if ends[own] is None:  # it goes on behind: where it does not go through, it has a void
            faces = [wall.face(across, side, thickness) for side in (-1.0, 1.0)]
            low, high = sorted(faces, key=lambda line: line.at + 0.5 * thickness * line.slope)
            found[k].voids[1 - parity].append(Void(low, high))
            continue
        bounds = found[k].begin if ends[own] == "begin" else found[k].end
        inward = wall.along if ends[own] == "begin" else -wall.along
        near_side = float(np.sign(inward @ across.across))
        bounds[parity] = wall.face(across, -near_side, thickness)
        bounds[1 - parity] = wall.face(across, near_side, thickness)
        sine = abs(float(wall.along @ across.across))
        found[k].through[ends[own] == "end"][parity] = thickness / sine


def _end_of(wall: Wall, u: float, near: float) -> str | None:
    """Which end of a wall is at u; None where neither is."""
    if u <= near:
        return "begin"
    return "end" if u >= wall.length - near else None


def _goes_through(end: str | None, other: str | None, own: int) -> int:
    """Parity of the courses in which a wall goes through: 0 for the first course."""
    if (end is None) != (other is None):
        return 0 if end is None else 1  # a T: the long wall in the first course
    if end == other:
        return own
    return 0 if end == "begin" else 1


def _crowded(walls: Sequence[Wall], near: float) -> list[str]:
    """Sentences on points in which more than two walls end."""
    points = [point for wall in walls for point in (wall.begin, wall.end)]
    found = set()
    for point in points:
        ends = [k for k, other in enumerate(points) if np.linalg.norm(point - other) <= near]
        if len(ends) > 2:
            names = ", ".join(walls[k // 2].name for k in ends)
            x, y = points[ends[0]]
            found.add(
                f"walls {names} all end at ({x:g}, {y:g}): let one of them run on, so that the "
                "others meet it"
            )
    return sorted(found)
