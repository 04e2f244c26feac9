"""[[build]]: a section for each kind, with the keys of the builder of that name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, PlainValidator, ValidationInfo, model_validator

from drystone.io.modelfile.keys import (
    Coordinate,
    Name,
    Place,
    Section,
    dimension_of,
    in_space_only,
    ranged,
    rotation_of,
    sentence,
)
from drystone.model import builders
from drystone.model.assembly import Block

#: Keys that all kinds have, of which the builders themselves know nothing.
COMMON = ("kind", "name", "material", "group", "origin", "rotation", "base")

Length = Annotated[float, ranged("unit")]
Zero = Annotated[float, Field(ge=0.0, le=1e6)]
Count = Annotated[int, Field(ge=0, le=10_000)]
Unit = Annotated[list[Length], Field(min_length=2, max_length=2)]
Lengths = Annotated[list[Length], Field(min_length=1, max_length=10_000)]
Points = list[Annotated[list[Coordinate], Field(min_length=2, max_length=2)]]
#: The same with what an error says of a key that is missing.
Metres = Annotated[Length, Field(description="in m")]
Number = Annotated[Count, Field(description="a whole number")]
WholeUnit = Annotated[Unit, Field(description="[length, height] of a whole unit in metres")]
BondName = Literal["running", "stack", "header", "english", "flemish"]
Curve = Literal["circular", "pointed", "elliptic"]


class BuildSection(Section):
    """[[build]]: what all kinds have in common."""

    #: Key that makes it one of space, and is needed there; "" where nothing else is.
    deep: ClassVar[str] = "depth"

    kind: str
    name: Name | None = None
    material: str | None = None
    group: Name | None = None
    origin: Place | None = None  # m
    rotation: Annotated[Any, PlainValidator(rotation_of)] = 0.0  # degrees
    base: bool = False

    @model_validator(mode="after")
    def _in_its_dimension(self, info: ValidationInfo) -> BuildSection:
        dimension, key = dimension_of(info), self.deep
        if not key and dimension == 2:
            raise sentence(f'kind = "{self.kind}" is of three dimensions: set dimension = 3')
        if key and dimension == 3 and getattr(self, key) is None:
            raise sentence(f"{key} is missing: add it (in m, along y)")
        return self

    def blocks(self, unit_weight: float, material: str) -> list[Block]:
        """What the builder of its kind makes of its keys; raises `ModelError`."""
        given = {key: getattr(self, key) for key in self.model_fields_set if key not in COMMON}
        values = {key: _plain(value) for key, value in given.items()}
        if self.kind in ("column", "stack"):
            values["base"] = False  # every kind has the same one
        return BUILDERS[self.kind](**values, unit_weight=unit_weight, material=material)


def _plain(value: Any) -> Any:
    """Sections as the tables that they were."""
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    if isinstance(value, Section):
        return {key: getattr(value, key) for key in value.model_fields_set}
    return value


def _deep(value: float | None, info: ValidationInfo) -> float | None:
    return in_space_only(value, info)


Deep = Annotated[Length | None, AfterValidator(_deep)]


class _OfSpace(BuildSection):
    """What is of three dimensions alone."""

    deep: ClassVar[str] = ""


class OpeningSection(Section):
    """An opening of a panel."""

    at: Zero = Field(description="in m, from the beginning of the wall")
    width: Metres
    height: Metres
    sill: Zero = 0.0
    lintel: Count = 1  # courses
    bearing: Zero | None = None  # m


class WallOpeningSection(OpeningSection):
    """An opening of a plan."""

    wall: str = Field(description='the name of its wall, as in wall = "south"')
    storey: Count = 0


class PanelSection(BuildSection):
    """[[build]] kind = "panel" """

    deep: ClassVar[str] = "thickness"
    kind: Literal["panel"]
    length: Metres
    height: Metres
    unit: WholeUnit
    thickness: Deep = None
    leaves: Count = 1
    bond: BondName = "running"
    headers: Count = 0
    openings: list[OpeningSection] = []


class PlanSection(_OfSpace):
    """[[build]] kind = "plan" """

    kind: Literal["plan"]
    unit: WholeUnit
    thickness: Length = Field(description="of the walls, in m")
    height: Length = Field(description="of a storey, in m")
    rectangle: Unit | None = None
    lines: list[Points] = []
    storeys: Annotated[int, Field(ge=1, le=1000)] = 1
    floor: Zero = 0.0
    beam: Length | None = None
    leaves: Count = 1
    bond: BondName = "running"
    headers: Count = 0
    openings: list[WallOpeningSection] = []


class ColumnSection(BuildSection):
    """[[build]] kind = "column" """

    kind: Literal["column"]
    width: Metres
    height: Metres
    n_blocks: Number
    depth: Deep = None


class StackSection(BuildSection):
    """[[build]] kind = "stack" """

    deep: ClassVar[str] = "depths"
    kind: Literal["stack"]
    widths: Lengths = Field(description="of each block, in m")
    heights: Lengths = Field(description="of each block, in m")
    offsets: list[Coordinate] | None = None
    depths: Annotated[Lengths | None, AfterValidator(_deep)] = None


class DrumColumnSection(_OfSpace):
    """[[build]] kind = "drum_column" """

    kind: Literal["drum_column"]
    diameter: Metres
    height: Metres
    drums: Number
    top_diameter: Length | None = None
    sides: Count = 16
    plinth: Unit | None = None
    capital: Unit | None = None


class TowerSection(_OfSpace):
    """[[build]] kind = "tower" """

    kind: Literal["tower"]
    width: Metres
    thickness: Metres
    height: Metres
    unit: WholeUnit
    shape: Literal["round", "square"] = "round"
    openings: Count = 0
    opening: Unit | None = None
    first_sill: Zero | None = None
    climb: Zero | None = None


class PyramidSection(BuildSection):
    """[[build]] kind = "pyramid" """

    kind: Literal["pyramid"]
    side: Count = Field(description="units of the lowest course")
    unit: Unit = Field(description="[length, height] of a unit in metres")
    courses: Count | None = None
    depth: Annotated[Count | None, AfterValidator(_deep)] = None


class ButtressSection(BuildSection):
    """[[build]] kind = "buttress" """

    kind: Literal["buttress"]
    foot: Length = Field(description="its width at the ground, in m")
    top: Length = Field(description="its width at the top, in m")
    height: Metres
    unit: WholeUnit
    depth: Deep = None
    bond: BondName = "running"


class _Curved(BuildSection):
    """What arches of all kinds have in common."""

    thickness: Length = Field(description="of the arch, in m")
    rise: Length | None = None
    shape: Curve = "circular"
    voussoirs: Count | None = None
    size: Length | None = None


class ArchSection(_Curved):
    """[[build]] kind = "arch" """

    kind: Literal["arch"]
    span: Length | None = None
    intrados: Points | None = None
    depth: Deep = None
    abutments: bool = False


class PortalSection(_Curved):
    """[[build]] kind = "portal" """

    kind: Literal["portal"]
    span: Metres
    pier_width: Metres
    pier_height: Metres
    unit: WholeUnit
    shape: Literal["circular", "pointed", "elliptic", "lintel"] = "circular"  # type: ignore[assignment]
    depth: Deep = None


class BridgeSection(_Curved):
    """[[build]] kind = "bridge" """

    kind: Literal["bridge"]
    spans: Lengths = Field(description="of each arch, in m, as in spans = [4.0, 4.0]")
    pier_width: Metres
    pier_height: Metres
    abutment_width: Metres
    cover: Length = Field(description="of masonry over the highest crown, in m")
    unit: WholeUnit
    depth: Deep = None


class BarrelVaultSection(_Curved):
    """[[build]] kind = "barrel_vault" """

    deep: ClassVar[str] = ""
    kind: Literal["barrel_vault"]
    length: Length = Field(description="along y, in m")
    unit: Length = Field(description="length of a stone along y, in m")
    span: Length | None = None
    intrados: Points | None = None
    bond: BondName = "running"
    abutments: bool = False


class GroinVaultSection(_OfSpace):
    """[[build]] kind = "groin_vault" """

    kind: Literal["groin_vault"]
    span: Metres
    thickness: Metres
    voussoirs: Count = Field(description="of a barrel, an odd number")
    unit: Length = Field(description="length of a stone along a web, in m")
    edge: Length | None = None
    mitred: bool = False


class DomeSection(_OfSpace):
    """[[build]] kind = "dome" """

    kind: Literal["dome"]
    span: Length = Field(description="diameter of the intrados, in m")
    thickness: Metres
    rings: Number
    sectors: Count = Field(description="stones of a ring")
    rise: Length | None = None
    shape: Curve = "circular"
    oculus: Zero = 0.0
    bond: Literal["running", "stack"] = "running"


class SpiralSection(BuildSection):
    """[[build]] kind = "spiral" """

    kind: Literal["spiral"]
    core: Length = Field(description="radius where it begins, in m")
    pitch: Length = Field(description="by which it grows in a turn, in m")
    turns: Number
    stones: Count = Field(description="of a turn")
    sunk: Zero = 0.0
    depth: Deep = None


class RubbleSection(BuildSection):
    """[[build]] kind = "rubble" """

    kind: Literal["rubble"]
    length: Metres
    height: Metres
    stone: Unit = Field(description="[length, height] of a stone in metres")
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = Field(description="a whole number")
    relaxed: Annotated[int, Field(ge=0, le=100)] = 1
    depth: Deep = None


BuildTable = Annotated[
    PanelSection
    | PlanSection
    | ColumnSection
    | StackSection
    | DrumColumnSection
    | TowerSection
    | PyramidSection
    | ButtressSection
    | ArchSection
    | PortalSection
    | BridgeSection
    | BarrelVaultSection
    | GroinVaultSection
    | DomeSection
    | SpiralSection
    | RubbleSection,
    Field(discriminator="kind"),
]

#: The section of each kind, and its builder.
SECTIONS: dict[str, type[BuildSection]] = {
    section.model_fields["kind"].annotation.__args__[0]: section  # type: ignore[union-attr]
    for section in BuildTable.__origin__.__args__  # type: ignore[attr-defined]
}
BUILDERS: dict[str, Callable[..., list[Block]]] = {
    kind: getattr(builders, kind) for kind in SECTIONS
}
