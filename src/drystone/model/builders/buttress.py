"""Buttresses with a battered face."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from drystone.model.assembly import Block
from drystone.model.builders.base import AlongY, Builder, Length, Metres, WholeUnit
from drystone.model.builders.coursing import Bond, BondName, Line, bond_problems
from drystone.model.builders.stones import Mason, not_whole, positive, unit_problems, whole
from drystone.model.construction.errors import ModelError


# Long by its keys, each with its words: they are those of model files.
def buttress(
    *,
    foot: Annotated[Length, "its width at the ground, in m"],
    top: Annotated[Length, "its width at the top, in m"],
    height: Metres,
    unit: WholeUnit,
    unit_weight: float,
    depth: AlongY = None,
    bond: BondName = "running",
    material: str = "",
) -> list[Block]:
    """A coursed wall with an upright face at x = 0 and one that leans inwards on its right.

    Units are cut to fit along the courses, none shorter than a quarter of one; a height that is no
    whole number of courses is refused with the nearest that fit.

    Parameters
    ----------
    foot, top
        Widths along x at the ground and at the top [m].
    height
        Of the buttress [m].
    unit
        Length and height of a whole unit [m].
    unit_weight
        N/m3.
    depth
        Along y, from 0 [m]; none in the plane.
    bond
        As of a panel.

    Returns
    -------
    list of Block
        ``c{course}u{number}``.  Groups are "course 1", ...

    Raises
    ------
    ModelError
        The measures make no buttress.
    """
    problems = [
        *positive(foot=foot, top=top, height=height, depth=depth),
        *unit_problems(unit),
        *bond_problems(bond, 0, 1),
    ]
    problems = problems or not_whole("height", height, unit[1])
    if not problems and top > foot:
        problems.append(f"top: must be at most the foot's width of {foot:g} m, it is {top:g}")
    if problems:
        raise ModelError(problems)
    mason = Mason(unit_weight=unit_weight, material=material)
    laid = Bond(name=bond, unit=unit[0])
    across = None if depth is None else (0.0, depth)
    slope = (top - foot) / height
    made = []
    for course in range(whole(height, unit[1]) or 1):
        low, high = course * unit[1], (course + 1) * unit[1]
        face = Line(foot + slope * low, slope)  # over the height above the bed
        pieces = laid.pieces(course, Line(0.0), face, (0.0, unit[1]), 0.0)
        for k, piece in enumerate(pieces, start=1):
            (a, b), (c, d) = ((line(0.0), line(unit[1])) for line in (piece.begin, piece.end))
            outline = np.array([[a, low], [c, low], [d, high], [b, high]])
            name = f"c{course + 1}u{k}"
            made.append(mason.upright(name, outline, across, f"course {course + 1}"))
    return made


BUTTRESS = Builder(make=buttress)
