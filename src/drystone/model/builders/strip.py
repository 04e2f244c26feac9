"""Stones of one straight wall: its courses and lintels as blocks, wherever the wall stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drystone.model.assembly import Block
from drystone.model.builders.coursing import Bond, Line, Void, between
from drystone.model.builders.openings import Hole
from drystone.model.builders.stones import Mason, rectangle


@dataclass(frozen=True, kw_only=True)
class Strip:
    """A wall along a line, of which v counts from its right face to its left, seen along it."""

    mason: Mason
    bond: Bond
    thickness: float | None  # m; None in the plane
    leaves: int = 1
    start: tuple[float, float] = (0.0, 0.0)  # m, where u = v = 0
    along: tuple[float, float] = (1.0, 0.0)  # unit vector of u
    prefix: str = ""  # of names
    groups: tuple[str, ...] = ()  # of all its stones
    anchor: float = 0.0  # m, u at which the bond begins

    @property
    def breadth(self) -> tuple[float, float]:
        """From where to where the wall reaches across [m]."""
        return 0.0, self.thickness or 0.0

    # Many, each a fact of the course.
    def course(
        self, course: int, levels: tuple[float, float], begin: Line, end: Line,
        voids: Sequence[Void] = (), *, number: int | None = None,
        through: tuple[float, float] = (0.0, 0.0),
    ) -> list[Block]:  # fmt: skip
        """The stones of a course, which the bond counts from 0, between two lines, but for voids.

        ``number`` goes into names and groups, counted from 1, where it is not that of the bond.
        Stones at the two ends reach ``through`` [m] and a closer further.
        """
        row = course + 1 if number is None else number
        made, count = [], 0
        for low, high in between(begin, end, voids):
            ends = through[0] if low == begin else 0.0, through[1] if high == end else 0.0
            for piece in self.bond.pieces(course, low, high, self.breadth, self.anchor, ends):
                count += 1
                groups = (f"course {row}", *self.groups)
                name = f"{self.prefix}c{row}u{count}"
                if piece.header or self.leaves == 1:
                    more: tuple[str, ...] = ("headers",) if piece.header else ()
                    made.append(
                        self.stone(
                            name, piece.begin, piece.end, self.breadth, levels, *groups, *more
                        )
                    )
                    continue
                for leaf in range(self.leaves):
                    share = self.breadth[1] / self.leaves
                    own = leaf * share, (leaf + 1) * share
                    more = (*groups, f"leaf {leaf + 1}")
                    made.append(
                        self.stone(f"{name}l{leaf + 1}", piece.begin, piece.end, own, levels, *more)
                    )
        return made

    def lintels(
        self, course: int, height: float, foot: float, holes: Sequence[Hole], name: str = "lintel"
    ) -> list[Block]:
        """Lintels that begin in a course, counted from 0 above ``foot`` [m], all of one height."""
        made = []
        for k, hole in enumerate(holes, start=1):
            if hole.opening.lintel and hole.head == course:
                levels = foot + hole.head * height, foot + hole.over * height
                a, b = hole.reach
                made.append(
                    self.stone(
                        f"{self.prefix}{name}{k}",
                        Line(a),
                        Line(b),
                        self.breadth,
                        levels,
                        "lintels",
                        *self.groups,
                    )
                )
        return made

    # Many, each a fact of the stone.
    def stone(
        self, name: str, begin: Line, end: Line, across: tuple[float, float],
        levels: tuple[float, float], *groups: str,
    ) -> Block:  # fmt: skip
        """The block between two lines, from v to v and from z to z [m]."""
        if self.thickness is None:
            outline = rectangle(begin.at, levels[0], end.at, levels[1])
            return self.mason.upright(name, outline, None, *groups)
        low, high = across
        u = np.array([begin(low), end(low), end(high), begin(high)])
        v = np.array([low, low, high, high])
        (x, y), (cx, cy) = self.start, self.along
        plan = np.column_stack((x + u * cx - v * cy, y + u * cy + v * cx))
        return self.mason.flat(name, plan, levels, *groups)
