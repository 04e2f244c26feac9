"""Spirals of dry stones."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.builders.base import AlongY, Builder, Count, FromZero, Length, WholeNumber
from drystone.model.builders.stones import Mason, at_least, positive
from drystone.model.construction.errors import ModelError

#: Share of a stone's area that the ground must leave of it.
LEAST = 0.05


# Long by its keys, each with its words: they are those of model files.
def spiral(
    *,
    core: Annotated[Length, "radius where it begins, in m"],
    pitch: Annotated[Length, "by which it grows in a turn, in m"],
    turns: WholeNumber,
    stones: Annotated[Count, "of a turn"],
    unit_weight: float,
    sunk: FromZero = 0.0,
    depth: AlongY = None,
    material: str = "",
) -> list[Block]:
    """Stones along a spiral of Archimedes around a core, in an upright plane, on level ground.

    A turn has half a stone more than the number asked for, so that the joints of neighbouring turns
    lie between each other.  What would reach into the ground is cut off, and stones of which a
    twentieth or less is left are left out.

    Parameters
    ----------
    core
        Radius where the spiral begins [m].
    pitch
        By which it grows in a turn: the height of the stones [m].
    turns, stones
        How many turns, and stones of each.
    unit_weight
        N/m3.
    sunk
        By how much the lowest point would lie under the ground, which is at z = 0 [m].
    depth
        Along y, from 0 [m]; none in the plane.

    Returns
    -------
    list of Block
        ``core``, then ``s1`` to ``sN`` from the core outwards.  Groups are "turn 1", ...

    Raises
    ------
    ModelError
        The measures make no spiral.
    """
    problems = [
        *positive(core=core, pitch=pitch, depth=depth),
        *at_least(1, turns=turns),
        *at_least(5, stones=stones),
    ]
    outer = core + turns * pitch
    if not 0.0 <= sunk < outer:
        problems.append(f"sunk: must be at least 0 m and less than {outer:g} m, it is {sunk:g}")
    if problems:
        raise ModelError(problems)
    per_turn = 2 * stones + 1  # half stones
    mason = Mason(unit_weight=unit_weight, material=material)
    across = None if depth is None else (0.0, depth)
    height = _bottom(core, pitch, turns, per_turn) - sunk

    def at(half: int, further: int) -> tuple[float, float]:
        """A point of the spiral, so many turns further out."""
        angle = 2.0 * math.pi * half / per_turn
        radius = core + pitch * (half / per_turn + further)
        return radius * math.sin(angle), height + radius * math.cos(angle)

    made: list[Block] = []
    middle = np.array([at(h, 0) for h in range(per_turn, -1, -1)])  # clockwise, turned round
    if (outline := _above_ground(middle)) is not None:
        made.append(mason.upright("core", outline, across, "core"))
    for k, begin in enumerate(range(0, per_turn * turns, 2), start=1):
        halves = range(begin, min(begin + 2, per_turn * turns) + 1)
        corners = [at(h, 1) for h in reversed(halves)] + [at(h, 0) for h in halves]
        if (outline := _above_ground(np.array(corners))) is not None:
            group = f"turn {begin // per_turn + 1}"
            made.append(mason.upright(f"s{k}", outline, across, group))
    return made


SPIRAL = Builder(make=spiral)


def _bottom(core: float, pitch: float, turns: int, per_turn: int) -> float:
    """How far the lowest point lies under the spiral's middle [m]."""
    half = np.arange(per_turn * (turns - 1), per_turn * turns + 1)
    angle = 2.0 * np.pi * half / per_turn
    radius = core + pitch * (half / per_turn + 1.0)
    return float(-(radius * np.cos(angle)).min())


def _above_ground(outline: Array) -> Array | None:
    """What of an outline lies above z = 0; None where hardly anything does.

    The outline must not return to the ground, which those of a spiral do not.
    """
    kept: list[Array] = []
    for p, q in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if p[1] >= 0.0:
            kept.append(p)
        if (p[1] < 0.0) != (q[1] < 0.0):
            share = p[1] / (p[1] - q[1])
            kept.append(np.array([p[0] + share * (q[0] - p[0]), 0.0]))
    if len(kept) < 3:
        return None
    left = np.array(kept)
    size = float(np.ptp(outline, axis=0).max())
    left = left[np.linalg.norm(np.roll(left, -1, axis=0) - left, axis=1) > 1e-6 * size]
    if len(left) < 3 or _area(left) <= LEAST * _area(outline):
        return None
    return left


def _area(outline: Array) -> float:
    x, y = outline.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
