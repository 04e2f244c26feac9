"""Arches of any intrados."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from drystone.model.assembly import Block
from drystone.model.builders.base import AlongY, Builder, Count, Length, Points, YesOrNo
from drystone.model.builders.profile import CurveName, Joints, ring
from drystone.model.builders.stones import Depth, Mason, positive
from drystone.model.construction.errors import ModelError


# Long by its keys, each with its words: they are those of model files.
def arch(
    *,
    thickness: Annotated[Length, "of the arch, in m"],
    unit_weight: float,
    span: Length | None = None,
    rise: Length | None = None,
    shape: CurveName = "circular",
    intrados: Points | None = None,
    voussoirs: Count | None = None,
    size: Length | None = None,
    depth: AlongY = None,
    abutments: YesOrNo = False,
    material: str = "",
) -> list[Block]:
    """A ring of voussoirs with joints normal to the intrados and springings at the level of the
    origin.

    Voussoirs have equal lengths along the intrados, and plane faces from joint to joint. If a size
    is given, it is changed so that the number of voussoirs is odd, or even for a pointed arch.

    Parameters
    ----------
    thickness
        Of the ring [m].
    unit_weight
        N/m3.
    span
        Distance between the springings of the intrados [m]; the origin is in the middle.
    rise
        Rise of the intrados [m]; by default half the span.
    shape
        ``circular``, ``pointed`` (two arcs with centres on the springing line) or ``elliptic``.
    intrados
        Instead of span, rise and shape: points [x, z] [m] from left to right of a smooth curve.
    voussoirs, size
        Number of voussoirs, or their length at the intrados [m].
    depth
        Along y, from 0 [m]; none in the plane.
    abutments
        Whether to lay a fixed block, ``left`` and ``right``, behind either springing.

    Returns
    -------
    list of Block
        ``v1`` to ``vN`` from left to right; the middle one of an odd number is in the group
        "keystone".

    Raises
    ------
    ModelError
        No arch has these measures.
    """
    if problems := positive(depth=depth):
        raise ModelError(problems)
    joints = ring(
        thickness=thickness, span=span, rise=rise, shape=shape, intrados=intrados,
        voussoirs=voussoirs, size=size,
    )  # fmt: skip
    mason = Mason(unit_weight=unit_weight, material=material)
    across = None if depth is None else (0.0, depth)
    made = voussoirs_of(mason, joints, across)
    return [*abutments_of(mason, joints, across), *made] if abutments else made


ARCH = Builder(make=arch)


def voussoirs_of(
    mason: Mason, joints: Joints, depth: Depth, prefix: str = "", *groups: str
) -> list[Block]:
    """The stones of a ring, from left to right."""
    n = joints.n_voussoirs
    return [
        mason.upright(
            f"{prefix}v{i + 1}",
            joints.outline(i),
            depth,
            *groups,
            *(("keystone",) if 2 * i + 1 == n else ()),
        )
        for i in range(n)
    ]


def abutments_of(mason: Mason, joints: Joints, depth: Depth) -> list[Block]:
    """A fixed block behind either springing, as thick as the ring."""
    made = []
    for name, k, sense in (("left", 0, -1.0), ("right", -1, 1.0)):
        low, high = joints.inner[k], joints.outer[k]
        back = sense * np.array([(high - low)[1], -(high - low)[0]])
        corners = [low, low + back, high + back, high]
        outline = np.array(corners if sense > 0.0 else corners[::-1])
        made.append(mason.upright(name, outline, depth, support=True))
    return made
