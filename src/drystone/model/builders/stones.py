"""Stones that builders cut: prisms upright and flat, hulls, pieces joined; numbers that fit.

What a builder makes lies at the origin: along x, thick along y, up along z; in the plane along x,
up along y.  `placed` takes it elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from numbers import Integral

import numpy as np

from drystone.common.arrays import Array
from drystone.common.ranges import LARGEST
from drystone.geometry.plane.parts import convex_outlines
from drystone.geometry.plane.polygon import reflex_corners
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Part
from drystone.model.assembly import Block
from drystone.model.construction.errors import ModelError

Depth = tuple[float, float] | None

#: Share of a unit, or of a course, by which a length may miss a whole number of them.
FITS = 1e-6


@dataclass(frozen=True, kw_only=True)
class Mason:
    """Who cuts all stones of one builder: of one material."""

    unit_weight: float  # N/m3
    material: str = ""
    count: list[int] = field(default_factory=lambda: [0])  # of stones cut so far

    def upright(
        self, name: str, outline: Array, depth: Depth, *groups: str, support: bool = False
    ) -> Block:
        """The prism of an outline (n, 2), [x, z] [m], counter-clockwise, from y to y [m]; without a
        depth a block of the plane.  A concave one has convex parts."""
        if depth is None:
            return self._block(name, outline, (), groups, support)
        if reflex_corners(outline).any():
            pieces = [Part(*solid.extruded(piece, depth)) for piece in convex_outlines(outline)]
            return self._of_parts(name, pieces, groups, support)
        return self._block(name, *solid.extruded(outline, depth), groups, support)

    def flat(self, name: str, plan: Array, levels: tuple[float, float], *groups: str) -> Block:
        """The prism of a plan (n, 2), [x, y] [m], counter-clockwise, from z to z [m]."""
        vertices, faces = _lying(plan, levels)
        return self._block(name, vertices, faces, groups, False)

    def box(
        self, name: str, low: Sequence[float], high: Sequence[float], *groups: str,
        support: bool = False,
    ) -> Block:  # fmt: skip
        """A block from its lowest to its highest corner [m]."""
        if len(low) == 2:
            (x0, z0), (x1, z1) = low, high
            outline = np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
            return self._block(name, outline, (), groups, support)
        return self._block(name, *solid.box([low, high]), groups, support)

    def cut(self, name: str, vertices: Array, faces: solid.Faces, *groups: str) -> Block:
        """A solid of vertices (n, 3) [m] and faces, counter-clockwise from outside."""
        return self._block(name, vertices, faces, groups, False)

    def hull(self, name: str, vertices: Array, *groups: str, support: bool = False) -> Block:
        """The hull of vertices (n, 3) [m], some of which may be given twice."""
        return self._block(name, *solid.hull(apart(vertices)), groups, support)

    def joined(self, name: str, pieces: Sequence[Block], *groups: str) -> Block:
        """Convex pieces that move as one; a single one is what it was."""
        if len(pieces) == 1:
            own = pieces[0]
            return self._block(name, own.vertices, own.faces, groups, own.support)
        parts = [Part(piece.vertices, piece.faces) for piece in pieces]
        return self._of_parts(name, parts, groups, False)

    def _of_parts(
        self, name: str, parts: Sequence[Part], groups: tuple[str, ...], support: bool
    ) -> Block:
        return Block.of_parts(
            parts,
            id=name,
            groups=groups,
            unit_weight=self.unit_weight,
            material=self.material,
            support=support,
        )

    def _block(
        self, name: str, vertices: Array, faces: solid.Faces, groups: tuple[str, ...], support: bool
    ) -> Block:
        self.count[0] += 1
        check_count(self.count[0])
        return Block(
            id=name,
            vertices=vertices,
            faces=faces,
            unit_weight=self.unit_weight,
            material=self.material,
            support=support,
            groups=groups,
        )


def check_count(n: float) -> None:
    """Raise `ModelError` where a builder would make more blocks than anything takes."""
    most = LARGEST["blocks"]
    if n > most:
        raise ModelError(
            [f"gives more than {most} blocks: are all lengths in metres? Take larger units"]
        )


def apart(points: Array) -> Array:
    """Points (n, dim) [m] without those that are where an earlier one is, to a billionth."""
    size = float(np.ptp(points, axis=0).max())
    _, first = np.unique(np.round((points - points[0]) / size, 9), axis=0, return_index=True)
    return points[np.sort(first)]


def rectangle(x0: float, z0: float, x1: float, z1: float) -> Array:
    """Outline from the lower left to the upper right corner, (4, 2) [m]."""
    return np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])


def whole(length: float, unit: float) -> int | None:
    """How many units make the length; None where no whole number does."""
    n = round(length / unit)
    return n if n > 0 and abs(n * unit - length) <= FITS * unit else None


def nearest(length: float, unit: float) -> str:
    """Words on the multiples of a unit below and above a length [m]."""
    below = math.floor(length / unit)
    low, high = below * unit, (below + 1) * unit
    if below < 1:
        return f"the nearest that fits is {high:.6g} m"
    return f"the nearest that fit are {low:.6g} m and {high:.6g} m"


def not_whole(key: str, length: float, unit: float, what: str = "courses") -> list[str]:
    """A sentence where a length is no whole number of units, else none."""
    if whole(length, unit) is not None:
        return []
    return [
        f"{key}: {length:g} m is no whole number of {what} of {unit:g} m: {nearest(length, unit)}"
    ]


def positive(**values: float | None) -> list[str]:
    """Sentences on those of the lengths [m] that are none; None passes."""
    return [
        f"{key}: must be greater than 0 m, it is {value:g}"
        for key, value in values.items()
        if value is not None and not (math.isfinite(value) and value > 0.0)
    ]


def at_least(least: int, **values: int) -> list[str]:
    """Sentences on those of the counts that are no whole numbers, or too small."""
    return [
        f"{key}: must be a whole number, at least {least}, it is {value!r}"
        for key, value in values.items()
        if not isinstance(value, Integral) or value < least
    ]


def unit_problems(unit: Sequence[float]) -> list[str]:
    """Sentences on a unit that is not [length, height] in metres."""
    if np.shape(unit) != (2,) or not all(math.isfinite(x) and x > 0.0 for x in unit):
        return ["unit: must be [length, height] in metres, both greater than 0"]
    return []


def _lying(plan: Array, levels: tuple[float, float]) -> tuple[Array, solid.Faces]:
    """Vertices and faces of a prism that lies on its plan."""
    n = len(plan)
    vertices = np.empty((2 * n, 3))
    vertices[:n, :2] = vertices[n:, :2] = plan
    vertices[:n, 2], vertices[n:, 2] = levels
    around = tuple((i, (i + 1) % n, (i + 1) % n + n, i + n) for i in range(n))
    return vertices, (tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *around)
