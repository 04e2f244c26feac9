"""Domes: rings of voussoirs around an axis."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import Choice
from drystone.geometry.space.solid import Faces
from drystone.model.assembly import Block
from drystone.model.builders.base import Builder, Count, FromZero, Length, Metres, WholeNumber
from drystone.model.builders.profile import CurveName, half_curve, shape_problems
from drystone.model.builders.stones import Mason, at_least, positive
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import suggestion

BONDS = ("running", "stack")
_HEXAHEDRON = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_WEDGE = ((2, 1, 0), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))


# Many, each a key of model files.
def dome(
    *,
    span: Annotated[Length, "diameter of the intrados, in m"],
    thickness: Metres,
    rings: WholeNumber,
    sectors: Annotated[Count, "stones of a ring"],
    unit_weight: float,
    rise: Length | None = None,
    shape: CurveName = "circular",
    oculus: FromZero = 0.0,
    bond: Annotated[str, Choice(BONDS)] = "running",
    material: str = "",
) -> list[Block]:
    """A shell of revolution about z over the origin, with its springing at z = 0.

    Joints are plane: between rings normal to the intrados, between the stones of a ring upright
    through the axis.  Faces are plane from joint to joint.

    Parameters
    ----------
    span, oculus
        Diameters of the intrados at the springing and around the crown [m]; 0 closes the crown.
    thickness
        Of the shell [m].
    rings, sectors
        Rings of stones, equal along the intrados, and stones of a ring.
    unit_weight
        N/m3.
    rise
        Of the intrados, as if it had no oculus [m]; half the span by default.
    shape
        Of the meridian: ``circular``, ``pointed`` or ``elliptic``, as of an arch.
    bond
        ``running``: every second ring is turned by half a stone, and each stone has two convex
        parts, so that its beds are those of its neighbours; ``stack``: joints from springing to
        crown.

    Returns
    -------
    list of Block
        ``r{ring}s{sector}`` from the springing, counter-clockwise from x.  Groups are "ring 1", ...

    Raises
    ------
    ModelError
        The measures make no dome.
    """
    problems = [
        *positive(thickness=thickness),
        *shape_problems(shape, span, rise),
        *at_least(1, rings=rings),
        *at_least(4, sectors=sectors),
    ]
    if bond not in BONDS:
        problems.append(f'bond: there is no bond "{bond}": {suggestion(bond, BONDS)}')
    if not 0.0 <= oculus < span:
        problems.append(f"oculus: must be at least 0 m and less than the span, it is {oculus:g}")
    if problems:
        raise ModelError(problems)
    inner, outer = _meridian(span, rise, shape, oculus, thickness, rings)
    mason = Mason(unit_weight=unit_weight, material=material)
    halves = 2 if bond == "running" else 1
    around = 2.0 * np.pi * np.arange(halves * sectors + 1) / (halves * sectors)
    ray = np.column_stack((np.cos(around), np.sin(around)))
    ray[-1] = ray[0]
    made = []
    for ring in range(rings):
        for sector in range(sectors):
            first = halves * sector + (ring % 2 if halves == 2 else 0)
            name, group = f"r{ring + 1}s{sector + 1}", f"ring {ring + 1}"
            cells = [
                _cell(mason, inner[ring : ring + 2], outer[ring : ring + 2], ray[[j, j + 1]])
                for j in ((first + k) % (halves * sectors) for k in range(halves))
            ]
            made.append(mason.joined(name, cells, group))
    return made


DOME = Builder(make=dome, dimensions=(3,))


def _meridian(
    span: float, rise: float | None, shape: str, oculus: float, thickness: float, rings: int
) -> tuple[Array, Array]:
    """Ends of the joints between rings: radius and height, (rings + 1, 2) each [m]."""
    curve = half_curve(shape, span, rise, oculus)
    found = [curve(k / rings) for k in range(rings + 1)]
    inner = np.array([point for point, _ in found])
    outer = np.array([point + thickness * normal for point, normal in found])
    if oculus == 0.0:  # wedges that meet in the axis
        outer[-1] = 0.0, inner[-1, 1] + thickness
        if shape == "pointed":  # where the extrados, an arc about the same centre, meets the axis
            (p, n), (q, m) = found[0], found[-1]
            radius = float(np.linalg.norm(q - p) / np.linalg.norm(m - n))
            centre = q - radius * m
            outer[-1, 1] = centre[1] + math.sqrt((radius + thickness) ** 2 - centre[0] ** 2)
        inner[-1, 0] = 0.0
    inner[:, 0], outer[:, 0] = -inner[:, 0], -outer[:, 0]
    inner[np.abs(inner) < 1e-15], outer[np.abs(outer) < 1e-15] = 0.0, 0.0
    return inner, outer


def _cell(mason: Mason, inner: Array, outer: Array, ray: Array) -> Block:
    """The piece between two joints (2, 2) and two upright planes through the axis (2, 2)."""

    def corner(joint: Array, along: Array) -> tuple[float, float, float]:
        return joint[0] * along[0], joint[0] * along[1], joint[1]

    vertices = [
        corner(side[k], ray[j])
        for side in (inner, outer)
        for k, j in ((1, 0), (0, 0), (0, 1), (1, 1))
    ]
    faces: Faces = _HEXAHEDRON
    if inner[1, 0] == 0.0:
        vertices, faces = [*vertices[:3], *vertices[4:7]], _WEDGE
    return mason.cut("cell", np.array(vertices), faces)
