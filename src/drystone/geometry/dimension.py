"""What is said of all models of the plane, and of all models of space: one record of each.

Who needs a word, a unit or a number that goes with the dimension takes it from here, by the
`Assembly` or by the number of coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.figure import Figure
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.space.polyhedra import Polyhedra


@dataclass(frozen=True, kw_only=True)
class Dimension:
    """What goes with a number of coordinates."""

    number: int
    motions: tuple[str, ...]  # of a block that can be held by themselves: along axes, and turning
    # Contact points on an interface where nothing is said, in space of four corners; and where it
    # may be crushed, which a contact at each corner alone would be at once or not at all.
    points: int
    points_if_crushed: int
    points_known: tuple[int, ...]  # that there may be
    points_text: str  # the same in words
    joint_unit: str  # of the size of a joint
    pose_units: str  # of the numbers of a pose
    where: str  # after a word on joints: "", or where they are
    entries: str  # how many a vector has, in a word
    example: str  # of a vector
    place: str  # names of coordinates
    angles: tuple[float, ...] | None  # degrees, of directions that a load may be turned into

    @property
    def idle_direction(self) -> Array:
        """Of a load that is none: level, and across the walls' usual plane where there is one."""
        return np.eye(self.number)[self.number - 2]

    def thickness(self, given: float) -> float | None:
        """As far as a model has one."""
        return None

    def run_round(self, n: int) -> tuple[str, str]:
        """What runs round n blocks, and what it was."""
        raise NotImplementedError

    def packed(self, figures: Sequence[Figure]) -> Outlines | Polyhedra:
        """Parts of all blocks as designed."""
        raise NotImplementedError

    def drawn(
        self, outlines: Sequence[Sequence[Array]], packed: Outlines | Polyhedra
    ) -> Outlines | Polyhedra:
        """Shapes that pictures have: in the plane the blocks' ``outlines``, in space all parts."""
        return packed


class _Plane(Dimension):
    def thickness(self, given: float) -> float | None:
        return given

    def run_round(self, n: int) -> tuple[str, str]:
        return ("an outline", "was") if n == 1 else (f"{n} outlines", "were")

    def packed(self, figures: Sequence[Figure]) -> Outlines:
        return Outlines.pack([[p.vertices for p in figure.parts] for figure in figures])

    def drawn(self, outlines: Sequence[Sequence[Array]], packed: Outlines | Polyhedra) -> Outlines:
        return Outlines.pack(outlines)


class _Space(Dimension):
    def run_round(self, n: int) -> tuple[str, str]:
        return f"the faces of {'one' if n == 1 else n}", "were"

    def packed(self, figures: Sequence[Figure]) -> Polyhedra:
        parts = [[(p.vertices, p.faces) for p in figure.parts] for figure in figures]
        return Polyhedra.pack(parts)


PLANE = _Plane(
    number=2,
    motions=("x", "y", "turn"),
    points=2,
    points_if_crushed=9,
    points_known=tuple(range(2, 65)),
    points_text="from 2 to 64 in the plane",
    joint_unit="m",
    pose_units="m, m, rad",
    where="",
    entries="two",
    example="[1.0, 0.0]",
    place="[x, y]",
    angles=(0.0, 180.0),
)
SPACE = _Space(
    number=3,
    motions=("x", "y", "z", "turn"),
    points=4,
    points_if_crushed=81,
    points_known=(4, 9, 16, *(n * n for n in range(5, 34, 2))),
    points_text="4, 9, 16 or the square of an odd number from 5 to 33",
    joint_unit="m2",
    pose_units="m, m, m, 1, 1, 1, 1",
    where=" in space",
    entries="three",
    example="[1.0, 0.0, 0.0]",
    place="[x, y, z]",
    angles=None,
)


def dimension_of(number: int) -> Dimension:
    """The record of so many coordinates."""
    return PLANE if number == 2 else SPACE
