"""What a builder made, taken to its place: turned, moved, named, on a base of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from numbers import Real

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.builders.stones import Mason
from drystone.model.construction.errors import ModelError

#: A base is this share of the structure's longest side wider all around, and thick.
BASE = 0.1


def placed(
    blocks: Sequence[Block],
    *,
    name: str = "",
    group: str = "",
    prefix: bool = False,
    origin: Sequence[float] | None = None,
    rotation: float | Sequence[float] = 0.0,
    base: bool = False,
) -> list[Block]:
    """Blocks turned about their origin, then moved to ``origin``.

    Parameters
    ----------
    name
        Put before every id with a stroke, as in "south/c1u1", and a group of all blocks.
    group
        One more group of all blocks.
    prefix
        Whether names of groups get it too, as in "south/course 1".
    origin
        Where the builder's own origin comes to lie, (dim,) [m]; by default it stays.
    rotation
        Degrees, counter-clockwise: in the plane one number; in space one about z, or three, about
        the fixed axes x, y and z in that order.
    base
        Whether to lay one fixed block, ``base``, under them, a tenth of their longest side wider
        all around and as thick; it is turned and moved with them.

    Raises
    ------
    ModelError
        The origin or the rotation is none of the blocks' dimension.
    """
    made = list(blocks)
    if not made:
        return made
    dimension = made[0].dimension
    shift = np.zeros(dimension) if origin is None else np.asarray(origin, float)
    if shift.shape != (dimension,):
        raise ModelError([f"origin: must have {dimension} numbers, it has {shift.size}"])
    if base:
        made.insert(0, base_under(made))
    turn = turn_of(rotation, dimension)
    still = np.array_equal(turn, np.eye(dimension)) and not shift.any()
    own = tuple(dict.fromkeys(text for text in (name, group) if text))
    return [
        replace(
            block if still else block.with_vertices(block.vertices @ turn.T + shift),
            id=f"{name}/{block.id}" if name else block.id,
            groups=tuple(
                dict.fromkeys(
                    (*own, *(f"{name}/{g}" if prefix and name else g for g in block.groups))
                )
            ),
        )
        for block in made
    ]


def turn_of(rotation: float | Sequence[float], dimension: int) -> Array:
    """The matrix (dim, dim) of a rotation in degrees, see `placed`; raises `ModelError`.

    Quarter turns are exact.
    """
    given = np.ravel(np.array(rotation, object))
    angles = [float(angle) if isinstance(angle, Real) else math.nan for angle in given]
    if len(angles) not in ((1,) if dimension == 2 else (1, 3)) or not all(
        map(math.isfinite, angles)
    ):
        wanted = "one number" if dimension == 2 else "one number, or three about x, y and z,"
        raise ModelError([f"rotation: must be {wanted} in degrees"])
    if dimension == 2:
        return _about(2, angles[0])[:2, :2]
    if len(angles) == 1:
        return _about(2, angles[0])
    return _about(2, angles[2]) @ _about(1, angles[1]) @ _about(0, angles[0])


def _about(axis: int, degrees: float) -> Array:
    quarter, rest = divmod(degrees, 90.0)
    c, s = math.cos(math.radians(rest)), math.sin(math.radians(rest))
    for _ in range(int(quarter) % 4):
        c, s = -s, c
    turn = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[i, i] = turn[j, j] = c
    turn[i, j], turn[j, i] = -s, s
    return turn


def base_under(blocks: Sequence[Block]) -> Block:
    """A fixed block under all, of the first one's material."""
    low = np.min([block.vertices.min(axis=0) for block in blocks], axis=0)
    high = np.max([block.vertices.max(axis=0) for block in blocks], axis=0)
    around = BASE * float((high - low).max())
    top = low[-1]
    low, high = low - around, high + around
    low[-1], high[-1] = top - around, top
    first = blocks[0]
    mason = Mason(unit_weight=first.unit_weight, material=first.material)
    return mason.box("base", low.tolist(), high.tolist(), support=True)
