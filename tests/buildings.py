"""Structures in space of any size: walls around corners, buildings, arches, domes, a house.

All take the joints' friction [-], normal and shear stiffness [Pa/m] and the direction of the load,
and hand on what else `solids.model_of` knows: the control point, by default the top, furthest along
the load, treated edges, contact points.  Walls are in running bond; their thickness is half a
unit's length, so that they interlock around corners.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from drystone.geometry.space import solid
from drystone.model import builders
from drystone.model.assembly import Block
from drystone.model.builders import Opening, circular_arch, plan
from drystone.model.builders.plan import SIDES
from drystone.model.model import Model
from solids import UNIT_WEIGHT, box, joint, model_of

UNIT = (0.4, 0.2, 0.2)  # m: length, thickness of the wall, height of a course
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def corner_wall(
    units: tuple[int, int] = (4, 3),
    courses: int = 8,
    *,
    unit: Sequence[float] = UNIT,
    friction: float = 0.65,
    stiffness: float = 1e9,
    shear: float | None = None,
    push: Sequence[float] = Y,
    **more,
) -> Model:
    """Two walls that meet in a corner: of so many units along x and along y."""
    length, thickness, height = unit
    half = 0.5 * thickness
    x, y = (n * length for n in units)
    line = [(half, y), (half, half), (x, half)]
    blocks = [
        _ground(max(units) * length, unit),
        *plan(
            lines=[line], unit=(length, height), thickness=thickness, height=courses * height,
            unit_weight=UNIT_WEIGHT, material="stone",
        ),
    ]  # fmt: skip
    return model_of(blocks, joint(friction, stiffness, shear), push=push, **more)


def box_building(
    units: int = 4,
    courses: int = 6,
    *,
    unit: Sequence[float] = UNIT,
    friction: float = 0.65,
    stiffness: float = 1e9,
    shear: float | None = None,
    push: Sequence[float] = X,
    **more,
) -> Model:
    """Four walls around a square, of ``4 units courses`` blocks."""
    shape = House(units=units, courses=courses, storeys=1, unit=unit)
    blocks = [_ground(shape.side, unit), *shape.walls()]
    return model_of(blocks, joint(friction, stiffness, shear), push=push, **more)


def arch(
    n_voussoirs: int = 15,
    *,
    radius: float = 1.5,
    thickness: float = 0.3,
    width: float = 0.5,
    embrace: float = 160.0,
    friction: float = 0.7,
    stiffness: float = 1e9,
    shear: float | None = None,
    push: Sequence[float] = Y,
    **more,
) -> Model:
    """An arch that spans along x, ``width`` [m] deep, pushed out of its plane."""
    blocks = []
    for stone in circular_arch(
        radius=radius,
        thickness=thickness,
        embrace=embrace,
        n_voussoirs=n_voussoirs,
        unit_weight=UNIT_WEIGHT,
    ):
        vertices, faces = solid.extruded(stone.vertices, (0.0, width))
        blocks.append(stone_of(stone.id, vertices, faces, support=stone.support))
    return model_of(blocks, joint(friction, stiffness, shear), push=push, **more)


def dome(
    rings: int = 6,
    sectors: int = 12,
    *,
    radius: float = 2.0,
    thickness: float = 0.4,
    opening: float = 15.0,
    friction: float = 0.7,
    stiffness: float = 1e9,
    shear: float | None = None,
    push: Sequence[float] = X,
    **more,
) -> Model:
    """A hemisphere of voussoirs between cones and meridians, open around the crown.

    ``radius`` [m] is the mean one; the opening's half angle is in degrees, 0 closes the crown.
    """
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    base = box("base", (-2 * outer, -2 * outer, -0.3), (2 * outer, 2 * outer, 0), support=True)
    shell = builders.dome(
        span=2.0 * inner, thickness=thickness, rings=rings, sectors=sectors, bond="stack",
        oculus=2.0 * inner * np.sin(np.radians(opening)), unit_weight=UNIT_WEIGHT, material="stone",
    )  # fmt: skip
    blocks = [base, *shell]
    return model_of(blocks, joint(friction, stiffness, shear), push=push, **more)


@dataclass(frozen=True, kw_only=True)
class House:
    """A house around a square: storeys with doors and windows, each under a floor of beams.

    1046 blocks as it is, 5022 of 27 units and 25 courses.
    """

    units: int = 12  # of a wall
    courses: int = 12  # of a storey
    storeys: int = 2
    unit: Sequence[float] = UNIT

    @property
    def side(self) -> float:
        """From outer face to outer face [m]."""
        return (self.units + 0.5) * self.unit[0]

    @property
    def bays(self) -> int:
        """Openings of a wall in a storey."""
        return max(1, self.units // 8)

    def openings(self) -> list[Opening]:
        """Doors in the first wall on the ground, windows else."""
        half, height = 0.5 * self.unit[0], self.unit[2]
        wide = max(self.units // self.bays // 2, 2)  # half units
        found = []
        for storey, wall, bay in product(range(self.storeys), range(4), range(self.bays)):
            sill = 0 if (wall, storey) == (0, 0) else self.courses // 3
            head = min(max(3 * self.courses // 4, sill + 1), self.courses - 1)
            begin = round((2 * bay + 1) * self.units / self.bays) - wide // 2
            if wall >= 2:  # which begin at their other end
                begin = 2 * self.units + 1 - begin - wide
            found.append(
                Opening(
                    wall=SIDES[wall], storey=storey + 1, at=begin * half - 0.5 * self.unit[1],
                    width=wide * half, sill=sill * height, height=(head - sill) * height,
                )
            )  # fmt: skip
        return found

    def walls(self, **more) -> list[Block]:
        """Storey upon storey."""
        length, thickness, height = self.unit
        return plan(
            rectangle=(self.side, self.side), unit=(length, height), thickness=thickness,
            height=self.courses * height, storeys=self.storeys, unit_weight=UNIT_WEIGHT,
            material="stone", **more,
        )  # fmt: skip

    def blocks(self) -> list[Block]:
        """The ground, then storey upon storey, each with the floor above it."""
        beam = self.side / self.units  # half a unit more is shared out among them
        walls = self.walls(floor=self.unit[2], beam=beam, openings=self.openings())
        return [_ground(self.side, self.unit), *walls]


def house(
    shape: House | None = None,
    *,
    friction: float = 0.65,
    stiffness: float = 1e9,
    shear: float | None = None,
    push: Sequence[float] = X,
    **more,
) -> Model:
    """A house of two storeys, 1046 blocks where no other shape is given."""
    blocks = (shape or House()).blocks()
    return model_of(blocks, joint(friction, stiffness, shear), push=push, **more)


def directions(n: int) -> list[tuple[float, float, float]]:
    """So many directions of load around the vertical, the first along x."""
    angle = 2.0 * np.pi * np.arange(n) / n
    return [(float(c), float(s), 0.0) for c, s in zip(np.cos(angle), np.sin(angle), strict=True)]


def stone_of(
    name: str, vertices: np.ndarray, faces: solid.Faces = (), *, support: bool = False
) -> Block:
    """A block of vertices (n, 3) [m] and faces, those of the hull where none are given."""
    return Block(
        id=name,
        vertices=np.asarray(vertices, float),
        faces=faces,
        unit_weight=UNIT_WEIGHT,
        material="stone",
        support=support,
    )


def _ground(side: float, unit: Sequence[float]) -> Block:
    """A support under all, a unit wider all around."""
    edge = unit[0]
    return box("base", (-edge, -edge, -0.3), (side + edge, side + edge, 0.0), support=True)
