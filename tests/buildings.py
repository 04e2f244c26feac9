"""Structures in space of any size: walls around corners, buildings, arches, domes, a house.

All take the joints' friction [-], normal and shear stiffness [Pa/m] and the direction of the load,
and hand on what else `solids.model_of` knows: the control point, by default the top, furthest along
the load, treated edges, contact points.  Walls are in running bond; their thickness is half a
unit's length, so that they interlock around corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from drystone.assembly import Block
from drystone.builders import circular_arch
from drystone.geometry import solid
from drystone.limit import ASSOCIATIVE, collapse_load
from drystone.model import Model
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
    blocks = [_ground(max(units) * unit[0], unit)]
    for course in range(courses):
        for wall, n in enumerate(units):
            begin = (wall + course) % 2  # the other wall has the corner
            for k, (a, b) in enumerate(_in_units(begin, 2 * n, begin)):
                u, v = (a, b), (0, 1)
                if wall:
                    u, v = v, u
                blocks.append(_cell(f"c{course}w{wall}u{k}", u, v, course, unit))
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
    blocks = [_ground((units + 0.5) * unit[0], unit)]
    for course in range(courses):
        for wall in range(4):
            begin = _begin(wall, course)
            cuts = list(_in_units(begin, begin + 2 * units, begin))
            blocks += _course(wall, course, cuts, units, unit)
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
    polar = np.linspace(np.radians(opening), 0.5 * np.pi, rings + 1)
    around = 2.0 * np.pi * np.arange(sectors + 1) / sectors
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    blocks = [box("base", (-2 * outer, -2 * outer, -0.3), (2 * outer, 2 * outer, 0), support=True)]
    for i, (above, below) in enumerate(pairwise(polar)):
        for j in range(sectors):
            ring = np.array(
                [
                    (np.sin(p) * np.cos(t), np.sin(p) * np.sin(t), np.cos(p))
                    for p, t in (
                        (above, around[j]),
                        (below, around[j]),
                        (below, around[j + 1]),
                        (above, around[j + 1]),
                    )
                ]
            )
            ring[np.abs(ring) < 1e-15] = 0.0  # the lowest stand on the ground
            faces = _HEXAHEDRON
            if above == 0.0:  # wedges that meet at the crown
                ring, faces = ring[:3], _WEDGE
            vertices = np.vstack((inner * ring, outer * ring))
            blocks.append(stone_of(f"r{i}s{j}", vertices, faces))
    return model_of(blocks, joint(friction, stiffness, shear), push=push, **more)


_HEXAHEDRON = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_WEDGE = ((2, 1, 0), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))


@dataclass(frozen=True, kw_only=True)
class Opening:
    """A door or a window in a wall, in half units along it and in courses above the ground."""

    begin: int
    end: int
    sill: int  # first course of the opening
    head: int  # course of its lintel

    def cut(self, course: int) -> tuple[int, int] | None:
        """What of a course it takes, its lintel half a unit longer at either end."""
        if course == self.head:
            return self.begin - 1, self.end + 1
        return (self.begin, self.end) if self.sill <= course < self.head else None


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
    def bays(self) -> int:
        """Openings of a wall in a storey."""
        return max(1, self.units // 8)

    def openings(self, wall: int, storey: int) -> list[Opening]:
        """Those of a wall: doors in the first one on the ground, windows else."""
        first = storey * (self.courses + 1)
        wide = max(self.units // self.bays // 2, 2)  # half units
        sill = 0 if (wall, storey) == (0, 0) else self.courses // 3
        head = min(max(3 * self.courses // 4, sill + 1), self.courses - 1)
        found = []
        for bay in range(self.bays):
            begin = round((2 * bay + 1) * self.units / self.bays) - wide // 2
            found.append(
                Opening(begin=begin, end=begin + wide, sill=first + sill, head=first + head)
            )
        return found

    def blocks(self) -> list[Block]:
        """The ground, then storey upon storey, each with the floor above it."""
        made = [_ground((self.units + 0.5) * self.unit[0], self.unit)]
        for storey in range(self.storeys):
            first = storey * (self.courses + 1)
            for course in range(first, first + self.courses):
                for wall in range(4):
                    cuts = self._cuts(wall, course, self.openings(wall, storey))
                    made += _course(wall, course, cuts, self.units, self.unit)
            made += self._floor(storey, first + self.courses)
        return made

    def _cuts(self, wall: int, course: int, openings: list[Opening]) -> list[tuple[int, int]]:
        """Units, halves beside openings, and lintels of a course, in half units."""
        begin = _begin(wall, course)
        end, found, at = begin + 2 * self.units, [], begin
        for opening in openings:
            if (cut := opening.cut(course)) is None:
                continue
            found += _in_units(at, cut[0], begin)
            if course == opening.head:
                found.append(cut)
            at = cut[1]
        return found + list(_in_units(at, end, begin))

    def _floor(self, storey: int, course: int) -> list[Block]:
        """Beams across, over the walls along x, from outer face to outer face."""
        side = 2 * self.units + 1
        cuts = [0, *range(3, side + 1, 2)]  # the first one is half a unit wider
        return [
            _cell(f"f{storey}b{k}", (a, b), (0, side), course, self.unit)
            for k, (a, b) in enumerate(pairwise(cuts))
        ]


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


def watched(model: Model) -> Model:
    """The model read where its mechanism by limit analysis moves fastest along the load.

    Where one part falls beside another, a control point on the latter would see no more of it than
    that the load goes on.
    """
    found = collapse_load(model, flow=ASSOCIATIVE)
    assembly, along = model.assembly, model.load.direction
    fastest, control = 0.0, model.control_point
    for row, block in enumerate(assembly.blocks):
        arm = block.vertices - assembly.centroid[row]
        speed = (found.velocities[row, :3] + np.cross(found.velocities[row, 3:], arm)) @ along
        k = int(np.argmax(speed))
        if speed[k] > fastest + 1e-6:  # of equal ones the first, whatever the rounding
            fastest = float(speed[k])
            control = replace(control, block=row, point=block.vertices[k])
    return replace(model, control_point=control)


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


def _begin(wall: int, course: int) -> int:
    """Half unit in which a wall of four begins: like a pinwheel, every second course reversed."""
    return int((wall >= 2) != (course % 2 == 1))


def _in_units(begin: int, end: int, origin: int) -> Iterator[tuple[int, int]]:
    """Units between two half units, those of a course that begins at ``origin``; halves at ends."""
    while begin < end:
        until = min(begin + 2 - (begin - origin) % 2, end)
        yield begin, until
        begin = until


def _course(
    wall: int, course: int, cuts: Sequence[tuple[int, int]], units: int, unit: Sequence[float]
) -> list[Block]:
    """Blocks of one of four walls: south, east, north, west."""
    across = (2 * units, 2 * units + 1) if wall in (1, 2) else (0, 1)
    return [
        _cell(
            f"c{course}w{wall}u{k}",
            *((across, cut) if wall % 2 else (cut, across)),
            course,
            unit,
        )
        for k, cut in enumerate(cuts)
    ]


def _cell(
    name: str, u: Sequence[int], v: Sequence[int], course: int, unit: Sequence[float]
) -> Block:
    """A box between half units along x and y, on its course."""
    half, height = 0.5 * unit[0], unit[2]
    low = (u[0] * half, v[0] * half, course * height)
    return box(name, low, (u[1] * half, v[1] * half, (course + 1) * height))
