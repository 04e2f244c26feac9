"""Columns and stacks: blocks on top of each other, of any widths, heights and overhangs."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from drystone.model.assembly import Block
from drystone.model.builders.base import (
    AlongY,
    Builder,
    Coordinates,
    DepthsAlongY,
    Lengths,
    Metres,
    WholeNumber,
)
from drystone.model.builders.stones import Mason, at_least, positive
from drystone.model.construction.errors import ModelError


# Many, each a key of model files.
def stack(
    *,
    widths: Annotated[Lengths, "of each block, in m"],
    heights: Annotated[Lengths, "of each block, in m"],
    unit_weight: float,
    offsets: Coordinates | None = None,
    depths: DepthsAlongY = None,
    material: str = "",
    base: bool = True,
) -> list[Block]:
    """Blocks ``b1`` to ``bN``, bottom to top, about a middle line over the origin.

    Parameters
    ----------
    widths, heights
        Of each block [m].
    unit_weight
        N/m3.
    offsets
        Of each block's middle from that of the column along x [m]; 0 by default.
    depths
        Of each block along y [m]; none in the plane.
    base
        Whether to lay a fixed block, ``base``, under them, three times as wide as the lowest.

    Raises
    ------
    ModelError
        The lists differ in length, or a size is not greater than 0.
    """
    offsets = [0.0] * len(widths) if offsets is None else offsets
    lists = [widths, heights, offsets, *([] if depths is None else [depths])]
    names = "widths, heights and offsets" if depths is None else "widths, depths, heights, offsets"
    if len(set(map(len, lists))) > 1 or not len(widths):
        raise ModelError([f"{names}: give one of each for every block"])
    if not min(*widths, *heights, *([1.0] if depths is None else depths)) > 0.0:
        raise ModelError(["widths and heights: must be greater than 0 m"])
    mason = Mason(unit_weight=unit_weight, material=material)
    level = np.concatenate(([0.0], np.cumsum(heights))).tolist()

    def laid(name: str, i: int, times: float, low: float, high: float, support: bool) -> Block:
        w, x = times * widths[i], offsets[i]
        y = () if depths is None else (0.5 * times * depths[i],)
        corners = (x - 0.5 * w, *(-d for d in y), low), (x + 0.5 * w, *y, high)
        return mason.box(name, *corners, support=support)

    blocks = [laid(f"b{i + 1}", i, 1.0, level[i], level[i + 1], False) for i in range(len(widths))]
    return [laid("base", 0, 3.0, -heights[0], 0.0, True), *blocks] if base else blocks


STACK = Builder(make=stack)


def column(
    *,
    width: Metres,
    height: Metres,
    n_blocks: WholeNumber,
    unit_weight: float,
    depth: AlongY = None,
    material: str = "",
    base: bool = True,
) -> list[Block]:
    """A straight column of equal blocks; sizes of the whole column [m], its depth in space."""
    if problems := [
        *positive(width=width, height=height, depth=depth),
        *at_least(1, n_blocks=n_blocks),
    ]:
        raise ModelError(problems)
    return stack(
        widths=[width] * n_blocks,
        heights=[height / n_blocks] * n_blocks,
        depths=None if depth is None else [depth] * n_blocks,
        unit_weight=unit_weight,
        material=material,
        base=base,
    )


COLUMN = Builder(make=column)
