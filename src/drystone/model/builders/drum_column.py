"""Columns of drums, with plinth and capital."""

from __future__ import annotations

import numpy as np

from drystone.model.assembly import Block
from drystone.model.builders.base import Builder, Count, Length, Metres, Pair, WholeNumber
from drystone.model.builders.stones import Mason, at_least, positive
from drystone.model.construction.errors import ModelError


# Many, each a key of model files.
def drum_column(
    *,
    diameter: Metres,
    height: Metres,
    drums: WholeNumber,
    unit_weight: float,
    top_diameter: Length | None = None,
    sides: Count = 16,
    plinth: Pair | None = None,
    capital: Pair | None = None,
    material: str = "",
) -> list[Block]:
    """Drums of one height over the origin, each a frustum of a regular polygon, in space.

    Parameters
    ----------
    diameter, top_diameter
        Of the circle around the shaft at its foot and at its top [m]; the same by default.
    height
        Of the shaft [m].
    drums, sides
        How many drums, and the sides of their polygon.
    unit_weight
        N/m3.
    plinth, capital
        Width and height of a square block under the shaft and on it [m].

    Returns
    -------
    list of Block
        ``plinth``, ``d1`` to ``dN`` from the bottom, ``capital``; drums are in the group "shaft".

    Raises
    ------
    ModelError
        The measures make no column, or plinth or capital are narrower than the shaft.
    """
    top = diameter if top_diameter is None else top_diameter
    problems = [
        *positive(diameter=diameter, top_diameter=top, height=height),
        *at_least(1, drums=drums),
        *at_least(3, sides=sides),
    ]
    for key, block, least in (("plinth", plinth, diameter), ("capital", capital, top)):
        if block is not None and (len(block) != 2 or not min(block) > 0.0):
            problems.append(f"{key}: must be [width, height] in metres, both greater than 0")
        elif block is not None and block[0] < least * (1.0 - 1e-9):
            problems.append(
                f"{key}: {block[0]:g} m is narrower than the shaft: the nearest that fits is "
                f"{least:g} m"
            )
    if problems:
        raise ModelError(problems)
    mason = Mason(unit_weight=unit_weight, material=material)
    made = []
    foot = 0.0
    if plinth is not None:
        half, foot = 0.5 * plinth[0], float(plinth[1])
        made.append(mason.box("plinth", (-half, -half, 0.0), (half, half, foot)))
    angle = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    ray = np.column_stack((np.cos(angle), np.sin(angle)))
    share = np.arange(drums + 1) / drums
    radii = 0.5 * (diameter + share * (top - diameter))
    levels = foot + height * share
    around = tuple((i, (i + 1) % sides, (i + 1) % sides + sides, i + sides) for i in range(sides))
    faces = (tuple(range(sides - 1, -1, -1)), tuple(range(sides, 2 * sides)), *around)
    for k in range(drums):
        rings = [np.column_stack((radii[j] * ray, np.full(sides, levels[j]))) for j in (k, k + 1)]
        made.append(mason.cut(f"d{k + 1}", np.vstack(rings), faces, "shaft"))
    if capital is not None:
        half, low = 0.5 * capital[0], float(levels[-1])
        made.append(mason.box("capital", (-half, -half, low), (half, half, low + capital[1])))
    return made


DRUM_COLUMN = Builder(make=drum_column, dimensions=(3,))
