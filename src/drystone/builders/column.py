"""Columns and stacks: blocks on top of each other, of any widths, heights and overhangs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.assembly import Block
from drystone.builders.errors import ModelError


def stack(
    *,
    widths: Sequence[float],
    heights: Sequence[float],
    unit_weight: float,
    offsets: Sequence[float] | None = None,
    material: str = "",
    base: bool = True,
) -> list[Block]:
    """Rectangular blocks ``b1`` to ``bN``, bottom to top.

    Parameters
    ----------
    widths, heights
        Of each block [m].
    unit_weight
        N/m3.
    offsets
        Of each block's middle from that of the column [m]; 0 by default.
    base
        Whether to lay a fixed block, ``base``, under them, three times as wide as the lowest.

    Raises
    ------
    ModelError
        The lists differ in length, or a size is not greater than 0.
    """
    offsets = [0.0] * len(widths) if offsets is None else offsets
    if not len(widths) == len(heights) == len(offsets) or not len(widths):
        raise ModelError(["widths, heights and offsets: give one of each for every block"])
    if not min(*widths, *heights) > 0.0:
        raise ModelError(["widths and heights: must be greater than 0 m"])
    level = np.concatenate(([0.0], np.cumsum(heights)))
    blocks = [
        Block(
            id=f"b{i + 1}",
            vertices=_rectangle(x - 0.5 * w, level[i], x + 0.5 * w, level[i + 1]),
            unit_weight=unit_weight,
            material=material,
        )
        for i, (w, x) in enumerate(zip(widths, offsets, strict=True))
    ]
    if base:
        w, x, h = 3.0 * widths[0], offsets[0], heights[0]
        lowest = Block(
            id="base",
            vertices=_rectangle(x - 0.5 * w, -h, x + 0.5 * w, 0.0),
            unit_weight=unit_weight,
            material=material,
            support=True,
        )
        blocks.insert(0, lowest)
    return blocks


def column(
    *, width: float, height: float, n_blocks: int, unit_weight: float, material: str = ""
) -> list[Block]:
    """A straight column of equal blocks on a base; sizes of the whole column [m]."""
    if n_blocks < 1:
        raise ModelError([f"n_blocks: must be at least 1, it is {n_blocks}"])
    return stack(
        widths=[width] * n_blocks,
        heights=[height / n_blocks] * n_blocks,
        unit_weight=unit_weight,
        material=material,
    )


def _rectangle(left: float, bottom: float, right: float, top: float) -> np.ndarray:
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
