"""Coursed walls of any size for the benchmarks: plain ones, and ones with openings."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import drystone as ds
from drystone.model.assembly import Block, Corner
from drystone.model.builders import coursed_wall, make_model
from drystone.model.builders.published import CORNER_RADIUS, JOINT, THICKNESS, UNIT, UNIT_WEIGHT

BAY = 6  # units of a bay, from the middle of one pier to that of the next
SILL = 4  # courses under an opening; the first is one of whole units
OPENING = 5  # courses of an opening, two units wide
STOREY = SILL + OPENING + 1  # courses, the last with the lintel

#: Courses of one bay by what is in them, then what goes between two bays: whole units, or units
#: half a unit further on.  The half units at either end of the latter are those of the wall.
PLAIN = (("111111", ""), ("11111", "1"))
OPEN = (("11..11", ""), ("1h..h1", "1"))
LINTEL = ("1...1", "1")


def running_bond(units: int, courses: int) -> ds.Model:
    """A wall without openings and with sharp corners, of an even number of courses."""
    blocks = coursed_wall(
        unit=UNIT,
        courses=("h" + "1" * (units - 1) + "h", "1" * units),
        repeat=courses // 2,
        base=True,
        unit_weight=UNIT_WEIGHT,
    )
    return make_model(blocks, joint=JOINT, thickness=THICKNESS, load_direction=(1.0, 0.0))


@dataclass(frozen=True, kw_only=True)
class Facade:
    """A wall with an opening in every bay of every storey, and plain courses on top."""

    bays: int
    storeys: int
    parapet: int  # courses

    @property
    def courses(self) -> list[str]:
        """Bottom to top, for `coursed_wall`; voids are left where the lintels lie."""
        storey = [PLAIN[i % 2] for i in range(SILL)]
        storey += [OPEN[i % 2] for i in range(SILL, STOREY - 1)]
        storey.append(LINTEL)
        parts = storey * self.storeys + [PLAIN[i % 2] for i in range(self.parapet)]
        texts = [between.join([bay] * self.bays) for bay, between in parts]
        return [f"h{text}h" if i % 2 else text for i, text in enumerate(texts)]

    def blocks(self) -> list[Block]:
        """Units and lintels, these half a unit longer than the opening at either end."""
        length, height = UNIT
        blocks = coursed_wall(
            unit=UNIT, courses=self.courses, base=True, unit_weight=UNIT_WEIGHT, material="stone"
        )
        for storey in range(self.storeys):
            bottom = ((storey + 1) * STOREY - 1) * height
            for bay in range(self.bays):
                left, right = (BAY * bay + 1.5) * length, (BAY * bay + 4.5) * length
                corners = [[left, bottom], [right, bottom]]
                corners += [[right, bottom + height], [left, bottom + height]]
                blocks.append(
                    Block(
                        id=f"lintel{storey + 1}.{bay + 1}",
                        vertices=np.array(corners),
                        unit_weight=UNIT_WEIGHT,
                        material="stone",
                    )
                )
        return blocks

    @property
    def n_blocks(self) -> int:
        """Movable blocks."""
        units = sum(len(course.replace(".", "")) for course in self.courses)
        return units + self.storeys * self.bays


def facade_of(n_blocks: int) -> Facade:
    """The facade nearest to a number of blocks, of about as many bays as storeys."""
    storeys = max(int((n_blocks / 50.0) ** 0.5), 1)
    choices = [
        Facade(bays=bays, storeys=s, parapet=parapet)
        for s in (storeys - 1, storeys)
        if s > 0
        for bays in range(s, s + 3)
        for parapet in range(STOREY)
    ]
    return min(choices, key=lambda facade: abs(facade.n_blocks - n_blocks))


def facade(n_blocks: int, stiffness: float = 1.0) -> ds.Model:
    """Model of `facade_of`, with the joints and corners of the published walls.

    ``stiffness`` multiplies that of the joints.  The published ones are soft: 132 courses sink
    by 0.17 m.
    """
    chosen = facade_of(n_blocks)
    joint = replace(
        JOINT,
        normal_stiffness=stiffness * (JOINT.normal_stiffness or 0.0),
        shear_stiffness=stiffness * (JOINT.shear_stiffness or 0.0),
    )
    return make_model(
        chosen.blocks(),
        joint=joint,
        corner=Corner(radius=CORNER_RADIUS),
        thickness=THICKNESS,
        load_direction=(1.0, 0.0),
        title=f"{chosen.bays} bays, {chosen.storeys} storeys",
    )
