"""[[tie]], [[spring]] and [settlement]: their keys, and what they say."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from drystone.common.vectors import unit_vector
from drystone.io.modelfile.keys import (
    Direction,
    Name,
    Place,
    Section,
    Spatial,
    in_plane_only,
    ranged,
    sentence,
)
from drystone.model.settlement import Settlement
from drystone.model.ties import Tie, TieEnd


class EndSection(Section):
    """Either end of a tie."""

    block: str | None = None  # or "ground"; by default the block that holds the point
    point: Place = Field(description="where, in metres, on the block as designed")


class SpringSection(Section):
    """[[spring]]"""

    name: Name | None = None
    from_: EndSection = Field(
        alias="from", description='as in from = { block = "b1", point = [0.0, 1.0] }'
    )
    to: EndSection = Field(description='as in to = { block = "ground", point = [-1.0, 1.0] }')
    stiffness: Annotated[float, ranged("stiffness")] | None = None  # N/m
    area: Annotated[float, ranged("area")] | None = None  # m2
    young_modulus: Annotated[float, ranged("young_modulus")] | None = None  # Pa
    pretension: Annotated[float, ranged("pretension")] = 0.0  # N

    @model_validator(mode="after")
    def _one_stiffness(self) -> SpringSection:
        both = self.area is not None and self.young_modulus is not None
        some = self.area is not None or self.young_modulus is not None
        if (self.stiffness is None) != both or some != both:
            raise sentence("give stiffness [N/m], or area [m2] and young_modulus [Pa]")
        return self


class TieSection(SpringSection):
    """[[tie]]"""

    yield_force: Annotated[float, ranged("yield_force")] = Field(
        description="its strength in N, as in yield_force = 50e3"
    )
    anchorage_force: Annotated[float, ranged("yield_force")] | None = None  # N
    breaking_elongation: Annotated[float, ranged("breaking_elongation")] | None = None  # m
    compression: bool = Field(
        description="whether it carries compression as well, true or false: a rod or a cable does "
        "not"
    )


class SettlementSection(Section):
    """[settlement]"""

    blocks: list[Name] = []
    group: Name | None = None
    direction: Direction | None = None
    centre: Place | None = None  # m
    axis: Annotated[Direction | None, Spatial] = None
    clockwise: Annotated[bool, BeforeValidator(in_plane_only)] = False
    max: Annotated[float, ranged("settlement")] = Field(
        description="how far the supports go, in m, or in degrees about a centre"
    )


def settlement_of(section: SettlementSection | None, dimension: int) -> Settlement | None:
    """The settlement of a file; raises `ModelError`."""
    if section is None:
        return None

    def unit(value: list[float] | None, key: str) -> Any:
        return None if value is None else unit_vector(value, f"settlement.{key}", dimension)

    return Settlement(
        blocks=tuple(section.blocks),
        group=section.group,
        direction=unit(section.direction, "direction"),
        centre=None if section.centre is None else np.array(section.centre),
        axis=unit(section.axis, "axis"),
        clockwise=section.clockwise,
        max=section.max,
    )


def ties_of(ties: Sequence[TieSection], springs: Sequence[SpringSection]) -> tuple[Tie, ...]:
    """The ties and springs of a file."""
    return (*(_tie(one) for one in ties), *(_spring(one) for one in springs))


def _common(section: SpringSection) -> dict[str, Any]:
    return {
        "name": section.name or "",
        "start": _end(section.from_),
        "end": _end(section.to),
        "stiffness": section.stiffness,
        "area": section.area,
        "young_modulus": section.young_modulus,
        "pretension": section.pretension,
    }


def _end(section: EndSection) -> TieEnd:
    return TieEnd(block=section.block, point=np.array(section.point))


def _tie(section: TieSection) -> Tie:
    def bound(value: float | None) -> float:
        return math.inf if value is None else value

    return Tie(
        **_common(section),
        yield_force=section.yield_force,
        anchorage_force=bound(section.anchorage_force),
        breaking_elongation=bound(section.breaking_elongation),
        compression=section.compression,
    )


def _spring(section: SpringSection) -> Tie:
    return Tie(**_common(section), yield_force=math.inf, compression=True, spring=True)
