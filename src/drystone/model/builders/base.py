"""What a builder is: a function whose parameters are keys of [[build]], and the types they have."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from inspect import signature
from typing import Annotated, Any

from drystone.common.keys import OF_SPACE, Flag, Key, Number, Several, Whole, keys_of
from drystone.common.ranges import RANGES, Range
from drystone.model.assembly import Block

_LENGTH = Number(RANGES["unit"])
_LENGTHS = Several(_LENGTH, 1, 10_000)
_COORDINATE = Number(RANGES["coordinate"])
_POINTS = Several(Several(_COORDINATE, 2, 2))

#: A length that is more than nothing [m].
Length = Annotated[float, _LENGTH]
Metres = Annotated[Length, "in m"]
#: A length that may be nothing [m].
FromZero = Annotated[float, Number(Range(least=0.0, most=1e6, unit="m"))]
#: Two lengths [m].
Pair = Annotated[Sequence[float], Several(_LENGTH, 2, 2)]
WholeUnit = Annotated[Pair, "[length, height] of a whole unit in metres"]
Lengths = Annotated[Sequence[float], _LENGTHS]
Coordinates = Annotated[Sequence[float], Several(_COORDINATE)]
#: [x, z], or [x, y] of a plan [m].
Points = Annotated[Sequence[Sequence[float]], Several(Several(_COORDINATE, 2, 2))]
Polylines = Annotated[
    Sequence[Sequence[Sequence[float]]], Several(Several(Several(_COORDINATE, 2, 2)))
]
Count = Annotated[int, Whole()]
WholeNumber = Annotated[Count, "a whole number"]
YesOrNo = Annotated[bool, Flag()]

#: What is thick along y: in space a model needs it, in the plane none has it.
AlongY = Annotated[float | None, _LENGTH, OF_SPACE, "in m, along y"]
DepthsAlongY = Annotated[Sequence[float] | None, _LENGTHS, OF_SPACE, "in m, along y"]
UnitsAlongY = Annotated[int | None, Whole(), OF_SPACE, "a whole number of units along y"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Builder:
    """A kind of [[build]].

    Its function takes keywords alone.  Those whose annotations have a type of keys are the keys of
    the table; beside them it takes ``unit_weight`` [N/m3] and ``material``, the name that blocks
    have of it.  It lays a base of its own by ``base``, if at all: [[build]] has one for all kinds.
    """

    make: Callable[..., list[Block]]
    dimensions: tuple[int, ...] = (2, 3)  # of which it makes blocks

    @cached_property
    def keys(self) -> tuple[Key, ...]:
        """Of [[build]]."""
        return keys_of(self.make)

    def blocks(self, given: Mapping[str, Any], unit_weight: float, material: str) -> list[Block]:
        """Blocks by the keys that a table gives; raises `ModelError`."""
        own = {"base": False} if "base" in signature(self.make).parameters else {}
        return self.make(**given, **own, unit_weight=unit_weight, material=material)
