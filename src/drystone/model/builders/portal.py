"""Portals: an arch, or a lintel, on two piers."""

from __future__ import annotations

from typing import Annotated

from drystone.common.keys import Choice
from drystone.model.assembly import Block
from drystone.model.builders.arch import voussoirs_of
from drystone.model.builders.base import AlongY, Builder, Count, Length, Metres, WholeUnit
from drystone.model.builders.piers import pier, skewback, springing
from drystone.model.builders.profile import SHAPES, ring
from drystone.model.builders.stones import Mason, positive, rectangle, unit_problems
from drystone.model.construction.errors import ModelError

LINTEL = "lintel"


# Many, each a key of model files.
def portal(
    *,
    span: Metres,
    thickness: Annotated[Length, "of the arch, in m"],
    pier_width: Metres,
    pier_height: Metres,
    unit: WholeUnit,
    unit_weight: float,
    rise: Length | None = None,
    shape: Annotated[str, Choice((*SHAPES, LINTEL))] = "circular",
    voussoirs: Count | None = None,
    size: Length | None = None,
    depth: AlongY = None,
    material: str = "",
) -> list[Block]:
    """An arch on piers, the origin at the ground in the middle of the opening.

    Piers are in running bond; their courses are cut to fit, the nearest whole number of equal ones.
    A pier too narrow for its springing is refused with the nearest width that fits.

    Parameters
    ----------
    span, pier_width, pier_height
        Clear, and of the piers up to the springing [m].
    thickness
        Of the arch or the lintel [m].
    unit
        Length and height of a whole unit of the piers [m].
    unit_weight
        N/m3.
    shape
        As of an `arch`, or ``lintel``: one beam from outer face to outer face.
    rise, voussoirs, size
        As of an `arch`; none for a lintel.
    depth
        Along y, from 0 [m]; none in the plane.

    Returns
    -------
    list of Block
        ``left/c{course}u{number}`` and ``right/...``, ``left/skewback`` where the springing joint
        slopes, ``v1`` to ``vN`` or ``lintel``.  Groups are "left pier", "right pier", "arch".

    Raises
    ------
    ModelError
        The measures make no portal.
    """
    problems = [
        *positive(span=span, pier_width=pier_width, pier_height=pier_height, depth=depth),
        *unit_problems(unit),
    ]
    if shape == LINTEL and (rise is not None or voussoirs is not None or size is not None):
        problems.append("shape: a lintel has no rise, voussoirs or size: take them out")
    if problems := problems or (positive(thickness=thickness) if shape == LINTEL else []):
        raise ModelError(problems)
    mason = Mason(unit_weight=unit_weight, material=material)
    across = None if depth is None else (0.0, depth)
    half = 0.5 * span
    sides = {"left": (-half - pier_width, -half), "right": (half, half + pier_width)}
    made: list[Block] = []
    for name, own in sides.items():
        made += pier(mason, unit, own, pier_height, depth, f"{name}/", f"{name} pier")
    if shape == LINTEL:
        reach = half + pier_width
        beam = rectangle(-reach, pier_height, reach, pier_height + thickness)
        return [*made, mason.upright("lintel", beam, across, "arch")]
    joints = ring(
        span=span, rise=rise, shape=shape, thickness=thickness, voussoirs=voussoirs, size=size
    ).moved(0.0, pier_height)
    needed = springing(joints.outer[0], joints.inner[0])
    if pier_width < needed * (1.0 - 1e-9):
        raise ModelError(
            [
                f"pier_width: {pier_width:g} m is less than the springing needs: the nearest that "
                f"fits is {needed:.6g} m"
            ]
        )
    for name, own in sides.items():
        left, right = (None, joints.outer[0]) if name == "left" else (joints.outer[-1], None)
        made += skewback(
            mason, own, pier_height, left, right, depth, f"{name}/skewback", f"{name} pier"
        )
    return made + voussoirs_of(mason, joints, across, "", "arch")


PORTAL = Builder(make=portal)
