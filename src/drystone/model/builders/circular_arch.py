"""Circular arches of equal voussoirs."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from drystone.common.arrays import Array
from drystone.model.assembly import Block
from drystone.model.construction.errors import ModelError


def circular_arch(
    *,
    radius: float,
    thickness: float,
    embrace: float,
    n_voussoirs: int,
    unit_weight: float,
    material: str = "",
    centre: tuple[float, float] = (0.0, 0.0),
    abutments: bool = True,
) -> list[Block]:
    """Blocks of an arch with radial joints, from its right springing to its left.

    Parameters
    ----------
    radius
        Radius of the centre line [m].
    thickness
        Thickness in radial direction [m].
    embrace
        Angle that the arch covers [degrees], symmetric about the vertical, up to 180.
    n_voussoirs
        Blocks ``v1`` to ``vN``; their faces are plane, from joint to joint.
    unit_weight
        N/m3.
    centre
        Centre of the circle [m].
    abutments
        Whether to lay a fixed block, ``right`` and ``left``, under either springing.

    Raises
    ------
    ModelError
        No arch has these measures.
    """
    _check(radius, thickness, embrace, n_voussoirs)
    half = 0.5 * math.radians(embrace)
    angle = 0.5 * math.pi + np.linspace(-half, half, n_voussoirs + 1)
    ray = np.column_stack((np.cos(angle), np.sin(angle)))
    inner = np.asarray(centre) + (radius - 0.5 * thickness) * ray
    outer = np.asarray(centre) + (radius + 0.5 * thickness) * ray
    stone = partial(Block, unit_weight=unit_weight, material=material)
    voussoirs = [
        stone(id=f"v{i + 1}", vertices=np.array([inner[i], outer[i], outer[i + 1], inner[i + 1]]))
        for i in range(n_voussoirs)
    ]
    if not abutments:
        return voussoirs
    supports = []
    for name, end, sense in (("right", 0, -1.0), ("left", -1, 1.0)):
        outline = _abutment(inner[end], outer[end], ray[end], thickness, sense)
        supports.append(stone(id=name, vertices=outline, support=True))
    return supports + voussoirs


def _check(radius: float, thickness: float, embrace: float, n_voussoirs: int) -> None:
    """Raise `ModelError` with all that is wrong with the measures of an arch."""
    problems = []
    if not 0.0 < thickness < 2.0 * radius:
        problems.append("thickness: must be greater than 0 m and less than twice the radius")
    if not 0.0 < embrace <= 180.0:
        problems.append(f"embrace: must be more than 0 and at most 180 degrees, it is {embrace:g}")
    if n_voussoirs < 1 or (n_voussoirs == 1 and embrace > 179.0):
        problems.append(f"n_voussoirs: {n_voussoirs} are too few for an arch")
    if problems:
        raise ModelError(problems)


def _abutment(inner: Array, outer: Array, ray: Array, depth: float, sense: float) -> Array:
    """A rectangle behind a springing joint, on the side that ``sense`` turns to."""
    back = sense * depth * np.array([-ray[1], ray[0]])
    corners = [inner, inner + back, outer + back, outer]
    return np.array(corners if sense < 0.0 else corners[::-1])
