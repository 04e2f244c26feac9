"""Doors and windows: their place in metres, the courses and the lintels that they take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from numbers import Real
from typing import Annotated, Any

from drystone.common.keys import NEEDED, Text, keys_of
from drystone.model.builders.base import Count, FromZero, Metres
from drystone.model.builders.coursing import Line, Void
from drystone.model.builders.stones import nearest, whole
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted, suggestion


@dataclass(frozen=True, kw_only=True)
class Opening:
    """A rectangle in a wall.  Its edges must lie on bed joints; along the wall units are cut."""

    at: Annotated[FromZero, "in m, from the beginning of the wall"]  # to the opening
    width: Metres
    height: Metres
    sill: FromZero = 0.0  # m, above the foot of the wall, in a storey above its floor
    lintel: Count = 1  # courses of the stone over it; 0: none
    bearing: FromZero | None = None  # m, of the lintel on either side; half a unit by default
    # Of a plan: the wall's name.
    wall: Annotated[str, Text(), 'the name of its wall, as in wall = "south"'] = ""
    storey: Count = 0  # of a plan: counted from 1; 0: all of them


#: Keys of an opening of a plan, which names its wall, and of a panel.
PLAN_OPENING_KEYS = tuple(
    replace(key, default=NEEDED) if key.name == "wall" else key for key in keys_of(Opening)
)
OPENING_KEYS = tuple(key for key in PLAN_OPENING_KEYS if key.name not in ("wall", "storey"))


#: Keys of an opening that are numbers whatever wall it is in.
NUMBERS = ("at", "width", "height", "sill", "lintel")


class Hole:
    """An opening by courses: what it takes of each."""

    def __init__(self, opening: Opening, unit: Sequence[float], place: str) -> None:
        self.opening, self.place = opening, place
        self.bearing = 0.5 * unit[0] if opening.bearing is None else opening.bearing
        self.sill = round(opening.sill / unit[1])
        self.head = self.sill + round(opening.height / unit[1])

    @property
    def over(self) -> int:
        """First course above the lintel, counted from 0."""
        return self.head + self.opening.lintel

    @property
    def reach(self) -> tuple[float, float]:
        """From where to where it needs the wall [m], its lintel included."""
        b = self.bearing if self.opening.lintel else 0.0
        return self.opening.at - b, self.opening.at + self.opening.width + b

    def cut(self, course: int) -> tuple[float, float] | None:
        """From where to where it interrupts a course [m], if it does."""
        if self.head <= course < self.over:
            return self.reach
        if self.sill <= course < self.head:
            return self.opening.at, self.opening.at + self.opening.width
        return None


def voids_in(holes: Sequence[Hole], course: int) -> list[Void]:
    """What openings take of a course, counted from the foot of the wall."""
    cuts = [cut for hole in holes if (cut := hole.cut(course))]
    return [Void(Line(a), Line(b)) for a, b in cuts]


def openings_of(given: Sequence[Opening | Mapping[str, Any]]) -> list[Opening]:
    """Openings, given as such or by their keys; raises `ModelError`."""
    known = [field.name for field in fields(Opening)]
    made, problems = [], []
    for i, opening in enumerate(given, start=1):
        if isinstance(opening, Opening):
            made.append(opening)
            continue
        unknown = [key for key in opening if key not in known]
        missing = [key for key in ("at", "width", "height") if key not in opening]
        problems += [
            f"openings[{i}]: unknown key {quoted(key)}: {suggestion(key, known)}" for key in unknown
        ]
        problems += [f"openings[{i}]: {key} is missing: add it in m" for key in missing]
        if not unknown and not missing:
            made.append(Opening(**opening))
    if problems:
        raise ModelError(problems)
    return made


def measure_problems(
    openings: Sequence[Opening], unit: Sequence[float], n_courses: int
) -> list[str]:
    """Sentences on openings whose edges lie inside courses, or that reach over the wall."""
    found = []
    for i, opening in enumerate(openings, start=1):
        place = f"openings[{i}]"
        odd = [key for key in NUMBERS if not isinstance(getattr(opening, key), Real)]
        if odd:
            found += [f"{place}.{key}: must be a number" for key in odd]
            continue
        if not (opening.width > 0.0 and opening.height > 0.0 and opening.sill >= 0.0):
            found.append(f"{place}: width and height must be greater than 0 m, sill at least 0 m")
            continue
        if opening.lintel < 0 or (opening.bearing is not None and opening.bearing < 0.0):
            found.append(f"{place}: lintel and bearing must be at least 0")
            continue
        for key, length in (("sill", opening.sill), ("height", opening.height)):
            if length and whole(length, unit[1]) is None:
                found.append(
                    f"{place}.{key}: {length:g} m ends inside a course of {unit[1]:g} m: "
                    f"{nearest(length, unit[1])}"
                )
                break
        else:
            hole = Hole(opening, unit, place)
            if hole.head > n_courses or (hole.head < n_courses < hole.over):
                top = n_courses * unit[1]
                found.append(
                    f"{place}: it would reach, its lintel included, {hole.over * unit[1]:g} m "
                    f"high, the wall is {top:g} m high: lower the sill or the height by "
                    f"{hole.over * unit[1] - top:g} m"
                )
    return found


def clearance_problems(
    holes: Sequence[Hole], low: float, high: float, taken: Sequence[tuple[float, float]],
    least: float,
) -> list[str]:  # fmt: skip
    """Sentences on openings of one wall that meet its ends, another wall or each other.

    Parameters
    ----------
    low, high
        Between which openings and lintels must stay [m].
    taken
        Where other walls come in [m].
    least
        Shortest stone that may be left beside them [m].
    """
    found = []
    for k, hole in enumerate(holes):
        others = [
            other.reach
            for other in holes[:k]
            if other.sill < hole.over and hole.sill < other.over and other is not hole
        ]
        first, last = hole.reach
        blocked = sorted([*taken, *others])
        ends = [low, *(edge for pair in blocked for edge in pair), high]
        gaps = [
            (a + least, b - least)
            for a, b in zip(ends[::2], ends[1::2], strict=True)
            if b - a - 2.0 * least >= last - first - 1e-9
        ]
        if any(a - 1e-9 <= first and last <= b + 1e-9 for a, b in gaps):
            continue
        shift = hole.opening.at - first
        fitting = [min(max(first, a), b - (last - first)) + shift for a, b in gaps]
        fitting.sort(key=lambda at: abs(at - hole.opening.at))
        mend = (
            f"the nearest that fits is at = {fitting[0]:.6g}"
            if fitting
            else "make it narrower, or its bearing shorter"
        )
        found.append(
            f"{hole.place}: from {first:g} m to {last:g} m, its lintel included, it would meet the "
            f"end of the wall, another wall or an opening: {mend}"
        )
    return found
