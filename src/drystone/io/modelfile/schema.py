"""The keys of a model file, their types and ranges.  What they mean together is for `read`.

How many coordinates a place or a direction has is the file's `dimension`, which the check is told.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainValidator,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

from drystone.common.keys import NEEDED, Key
from drystone.common.ranges import POSITIVE
from drystone.common.registry import Registry
from drystone.control.stops import STOPS
from drystone.io.drawings.registry import FORMATS
from drystone.io.drawings.settings import TOLERANCE
from drystone.io.modelfile.assessing import AssessmentSection, SiteSection
from drystone.io.modelfile.builds import BuildSection
from drystone.io.modelfile.declared import Chosen, Extended, named, section_of
from drystone.io.modelfile.keys import (
    Course,
    Direction,
    Name,
    Pair,
    Place,
    Section,
    Spatial,
    dimension_of,
    in_plane_only,
    of_dimension,
    point_of,
    point_or_name,
    ranged,
    rotation_of,
    sentence,
)
from drystone.io.modelfile.tying import SettlementSection, SpringSection, TieSection
from drystone.io.results.outputs import OUTPUTS
from drystone.model.construction.fit import DRAWING_TOLERANCE
from drystone.model.joint_law import LAW_KEYS
from drystone.model.loading.patterns import PATTERNS
from drystone.model.model import Analysis
from drystone.model.mortar import Mortar

#: Keys of [analysis] that strategies and engines take as numerical settings.
OPTION_NAMES = (
    "increment",
    "overshoot",
    "balance_tolerance",
    "patience",
    "displacement_step",
    "time_step",
    "mechanism_displacement",
    "max_points",
    "max_time",
)


def _thickness(value: float | None, info: ValidationInfo) -> float | None:
    if value is None and dimension_of(info) != 3:
        raise PydanticCustomError("missing", "missing")
    return in_plane_only(value, info)


class MaterialSection(Section):
    """[material.NAME]"""

    unit_weight: Annotated[float, ranged("unit_weight")] | None = None  # N/m3
    density: Annotated[float, ranged("density")] | None = None  # kg/m3

    @model_validator(mode="after")
    def _one_of_them(self) -> MaterialSection:
        if (self.unit_weight is None) == (self.density is None):
            has = "neither {} nor {}" if self.unit_weight is None else "both {} and {}"
            keys = has.format("unit_weight [N/m3]", "density [kg/m3]")
            raise sentence(f"has {keys}: give one of them")
        return self


class MortarSection(Section):
    """[joint.mortar]: stiffnesses by the thickness and the moduli of a bed of mortar."""

    thickness: Annotated[float, ranged("mortar_thickness")] = Field(
        description="of the joint in m, as in thickness = 0.01"
    )
    young_modulus: Annotated[float, ranged("young_modulus")] = Field(
        description="of the mortar in Pa, as in young_modulus = 2e9"
    )
    shear_modulus: Annotated[float, ranged("shear_modulus")] | None = None  # Pa
    poisson_ratio: Annotated[float, ranged("poisson_ratio")] | None = None  # -

    @model_validator(mode="after")
    def _one_of_them(self) -> MortarSection:
        try:
            self.stiffnesses()
        except ValueError as error:
            raise sentence(str(error)) from None
        return self

    def stiffnesses(self) -> dict[str, float]:
        """Values of the joint law, see `Mortar`."""
        return Mortar(**self.model_dump()).stiffnesses


class ExceptionSection(Extended):
    """[joint.between."a b"]: what it leaves out is taken from [joint]."""

    mortar: MortarSection | None = None

    @classmethod
    def of(cls, table: Any) -> type[Self]:
        """See `Extended`."""
        return section_of(cls, LAW_KEYS)

    @model_validator(mode="after")
    def _stiffness_once(self) -> Self:
        keys = ("normal_stiffness", "shear_stiffness")
        given = [key for key in keys if getattr(self, key, None) is not None]
        if self.mortar is not None and given:
            raise sentence(f"has both mortar and {given[0]}: leave one of them out")
        return self


class JointSection(ExceptionSection):
    """[joint]; the stiffnesses may be left out where only limit analysis is asked for."""

    between: dict[Name, ExceptionSection] = {}

    @classmethod
    def of(cls, table: Any) -> type[Self]:
        """See `Extended`."""
        needed = {"friction_coefficient": NEEDED}
        keys = (replace(key, default=needed.get(key.name, key.default)) for key in LAW_KEYS)
        return section_of(cls, tuple(keys))


class CornerSection(Section):
    """[corner]; with neither key corners are sharp."""

    radius: Annotated[float, ranged("radius")] | None = None  # m
    chamfer: Annotated[float, ranged("chamfer")] | None = None  # m

    @model_validator(mode="after")
    def _not_both(self) -> CornerSection:
        if self.radius is not None and self.chamfer is not None:
            raise sentence("has both radius and chamfer: leave one of them out")
        size = self.radius or self.chamfer or 0.0
        if 0.0 < size < POSITIVE.least:
            raise sentence(f"is of {size:g} m, which no corner has: give 0 for sharp ones")
        return self


Face = list[Annotated[int, Field(ge=0)]]


class ShapeSection(Section):
    """What shape a block has; which keys go together is for `shapes`."""

    vertices: list[Place] | None = None  # m
    faces: Annotated[list[Face] | None, Spatial] = None  # rows of vertices, counted from 0
    box: Annotated[list[Place] | None, Spatial] = None  # m, its lowest and its highest corner
    outline: Annotated[list[Pair] | None, Spatial] = None  # m, [x, z]
    depth: Annotated[Pair | None, Spatial] = None  # m, from which y to which


class BlockSection(ShapeSection):
    """[[block]]"""

    id: Name = Field(description='a name of its own, as in id = "b1"')
    parts: Annotated[list[ShapeSection] | None, Field(min_length=1)] = None
    material: str | None = None
    support: bool = False
    held: list[Literal["x", "y", "z", "turn"]] = []
    groups: list[Name] = []


class GroupSection(Section):
    """[group.NAME]"""

    blocks: Annotated[list[str], Field(min_length=1)] = Field(
        description='ids of its blocks, * for any letters and ? for one, as in blocks = ["c1*"]'
    )
    support: bool = False


class ImportSection(Section):
    """[[import]]"""

    file: str = Field(description='its path from the model file, as in file = "arch.dxf"')
    format: Annotated[str, named(FORMATS)] | None = None
    unit: Literal["m", "cm", "mm", "in", "ft"] | None = None
    up: Annotated[Literal["z", "y"] | None, Spatial] = None
    material: str | None = None
    support: list[str] = []
    support_below: Annotated[float, ranged("coordinate")] | None = None  # m
    tolerance: Annotated[float, ranged("tolerance")] = TOLERANCE
    bent_faces: Annotated[Literal["fans", "bends"], Spatial] = "fans"
    overlap: Annotated[float, ranged("overlap")] = 0.0  # m
    name: Name | None = None
    group: Name | None = None
    origin: Place | None = None  # m
    rotation: Annotated[Any, PlainValidator(rotation_of)] = None  # degrees


class WallSection(Section):
    """[wall]"""

    unit: Annotated[list[Annotated[float, ranged("unit")]], Field(min_length=2, max_length=2)] = (
        Field(description="[length, height] of a whole unit in metres")
    )
    courses: Annotated[list[Course], Field(min_length=1)] = Field(
        description='bottom to top, as in courses = ["h1111h", "11111"]'
    )
    repeat: Annotated[int, Field(ge=1, le=10_000)] = 1
    base: bool = False
    origin: Pair = [0.0, 0.0]
    material: str | None = None


BlockPoint = Annotated[Any, PlainValidator(point_or_name)]
Force = Annotated[list[Annotated[float, ranged("force")]], AfterValidator(of_dimension)]
Pressure = Annotated[list[Annotated[float, ranged("pressure")]], AfterValidator(of_dimension)]


class LoadSection(Chosen):
    """[load]: beside its name the keys that the pattern declares."""

    chooser: ClassVar[str] = "pattern"
    registry: ClassVar[Registry[Any]] = PATTERNS

    pattern: Annotated[str, named(PATTERNS)] = Field(
        description='pattern = "mass" loads each block in proportion to its weight'
    )


class DeadLoadSection(Section):
    """[[dead_load]]: which keys go with which kind is checked at once."""

    kind: Literal["force", "surcharge", "face", "fill"] = Field(
        description='as in kind = "force", "surcharge", "face" or "fill"'
    )
    name: Name | None = None
    mass: bool = Field(
        description="whether it is the weight of a mass that counts in [load], true or false"
    )
    stage: Annotated[int, Field(ge=0, le=100)] = 1
    block: str | None = None
    group: str | None = None
    point: BlockPoint | None = None
    force: Force | None = None  # N
    weight: Annotated[float, ranged("force")] | None = None  # N
    side: Direction | None = None
    within: Annotated[float, ranged("within")] | None = None  # degrees
    pressure: Pressure | None = None  # Pa
    total: Force | None = None  # N
    unit_weight: Annotated[float, ranged("unit_weight")] | None = None  # N/m3
    level: Annotated[float, ranged("coordinate")] | None = None  # m
    at_rest: Annotated[float, ranged("at_rest")] | None = None

    @model_validator(mode="after")
    def _of_its_kind(self) -> DeadLoadSection:
        wanted, more = DEAD_KEYS[self.kind]
        given = self.model_fields_set - {"kind", "name", "mass", "stage", "block", "group"}
        for key in wanted:
            if key not in given:
                raise sentence(f'{key} is missing: kind = "{self.kind}" needs it')
        for key in sorted(given - {*wanted, *more}):
            raise sentence(f'has {key}, which does not belong to kind = "{self.kind}": take it out')
        return self


#: Keys that kinds of dead loads need, and those that they may have.
DEAD_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "force": (("force",), ("point",)),
    "surcharge": (("weight",), ("point",)),
    "face": (("side",), ("within", "pressure", "total")),
    "fill": (("side", "unit_weight", "level", "at_rest"), ("within",)),
}


class ControlSection(Section):
    """[control]; every key has a default, see `model.construction.control.choose_control_point`."""

    block: str | None = None
    point: Annotated[Any, PlainValidator(point_of)] = None
    direction: Direction | None = None
    history: Any = None  # m, or the name of a file; see `histories`, which checks these three
    amplitudes: Any = None  # m
    cycles: Any = None


class ContactSection(Section):
    """[contact]"""

    points: int | None = None  # the default and what may be are those of the dimension


class OutputSection(Chosen):
    """[[output]]: a file beside the usual ones, and the keys that it declares."""

    chooser: ClassVar[str] = "kind"
    registry: ClassVar[Registry[Any]] = OUTPUTS

    kind: Annotated[str, named(OUTPUTS)] = Field(description="the name of an output")

    @staticmethod
    def declared(thing: Any) -> tuple[Key, ...]:
        """See `Chosen`."""
        return tuple(thing.keys)


class AnalysisSection(Extended):
    """[analysis]: beside these the keys of stop conditions."""

    engine: str = Analysis.engine
    strategy: Literal["displacement", "published"] = "displacement"
    stop_multiplier: Annotated[float, ranged("stop_multiplier")] = Analysis.stop_multiplier
    ground: Annotated[float, ranged("ground")] | None = None  # m
    falling: Literal["remove", "stop"] | None = None
    event_share: Annotated[float, ranged("event_share")] = Analysis.event_share
    max_penetration: Annotated[float, ranged("max_penetration")] = Analysis.max_penetration
    increment: Annotated[float, ranged("increment")] | None = None
    overshoot: Annotated[float, ranged("overshoot")] | None = None
    balance_tolerance: Annotated[float, ranged("balance_tolerance")] | None = None
    patience: Annotated[float, ranged("patience")] | None = None
    displacement_step: Annotated[float, ranged("displacement_step")] | None = None  # m
    time_step: Annotated[float, ranged("time_step")] | None = None  # s
    mechanism_displacement: Annotated[float, ranged("mechanism_displacement")] | None = None  # m
    max_points: Annotated[float, ranged("max_points")] | None = None
    max_time: Annotated[float, ranged("max_time")] | None = None  # s

    @classmethod
    def of(cls, table: Any) -> type[Self]:
        """See `Extended`: conditions of other packages are looked for where a key is not ours."""
        stops = [stop for _, stop in STOPS.own()]
        known = {*cls.keys(), *STOPS.ours}
        if isinstance(table, dict) and not known.issuperset(table):
            stops = [stop for _, stop in STOPS.loaded()]
        return section_of(cls, tuple(replace(stop.key, default=None) for stop in stops))

    @property
    def options(self) -> dict[str, float]:
        """The numerical settings that the file gives."""
        declared = set(type(self).model_fields) - set(AnalysisSection.model_fields)
        given = {name: getattr(self, name) for name in (*OPTION_NAMES, *sorted(declared))}
        return {name: float(value) for name, value in given.items() if value is not None}


def _load_or_settlement(value: LoadSection | None, info: ValidationInfo) -> LoadSection | None:
    """A file has the one or the other."""
    moves_supports = info.data.get("settlement") is not None
    if value is None and not moves_supports:
        raise PydanticCustomError("missing", "missing")
    if value is not None and moves_supports:
        raise sentence("stands beside [settlement]: take one of the two out")
    return value


class ModelSection(Section):
    """The whole file."""

    title: str | None = None
    dimension: Literal[2, 3] = Field(description="dimension = 2, or 3")
    thickness: Annotated[
        Annotated[float, ranged("thickness")] | None, AfterValidator(_thickness)
    ] = Field(
        default=None,
        validate_default=True,
        description="out of plane, in metres, as in thickness = 1.0",
    )
    drawing_tolerance: Annotated[float, ranged("drawing_tolerance")] = DRAWING_TOLERANCE
    material: Annotated[dict[Name, MaterialSection], Field(min_length=1)] = Field(
        description="a table as [material.stone] with its unit_weight in N/m3"
    )
    joint: JointSection = Field(description="a table [joint] with friction and stiffnesses")
    corner: CornerSection = CornerSection()
    contact: ContactSection | None = None
    block: list[BlockSection] = []
    build: list[BuildSection] = []
    wall: Annotated[WallSection | None, BeforeValidator(in_plane_only)] = None
    imports: list[ImportSection] = Field(default=[], alias="import")
    group: dict[Name, GroupSection] = {}
    settlement: SettlementSection | None = None
    load: Annotated[LoadSection | None, AfterValidator(_load_or_settlement)] = Field(
        default=None,
        validate_default=True,
        description="a table [load] with pattern and direction",
    )
    dead_load: list[DeadLoadSection] = []
    tie: list[TieSection] = []
    spring: list[SpringSection] = []
    control: ControlSection = ControlSection()
    analysis: AnalysisSection = Field(default_factory=lambda: AnalysisSection.model_validate({}))
    output: list[OutputSection] = []
    site: SiteSection | None = None
    assessment: AssessmentSection | None = None
