"""[site] and [assessment] of a model file: keys, types and ranges, and the records made of them.

What values mean together, and which of them a method needs, is for `drystone.assessment`: a file
may hold a site without being assessed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, PlainValidator, ValidationError, model_validator

from drystone.common.keys import Key
from drystone.common.registry import Registry
from drystone.io.modelfile.declared import Chosen, State, section_of
from drystone.io.modelfile.keys import Section, sentence
from drystone.model.construction.contents import within
from drystone.model.construction.errors import ModelError
from drystone.model.site import LIMIT_STATES, METHODS, AssessmentInput, Site

Positive = Annotated[float, Field(gt=0.0, le=1e9)]
Ground = Annotated[float, Field(gt=0.0, le=10.0)]  # g; ten of them are an acceleration in m/s2
Percent = Annotated[float, Field(ge=0.0, lt=100.0)]

#: Keys of [site] by code; those of a limit state's own table are the same.
KEYS = {
    "ntc2018": (
        "ag",
        "F0",
        "TC_star",
        "soil",
        "topography",
        "return_period",
        "nominal_life",
        "use",
    ),
    "ec8": ("ag", "type", "ground", "importance", "return_period"),
    "csv": (
        "file",
        "unit",
        "damping",
        "soil_factor",
        "corner_period",
        "site_specific",
        "return_period",
    ),
}


def _importance(value: Any) -> str | float:
    if value in ("I", "II", "III", "IV"):
        return str(value)
    if isinstance(value, int | float) and not isinstance(value, bool) and 0.0 < value <= 10.0:
        return float(value)
    raise sentence('must be a class "I" to "IV", or the factor gamma_I')


class MotionSection(Section):
    """[site.SLD], ...: the ground motion of one limit state."""

    ag: Ground | None = None  # g, on rock; of ec8 the reference one, a_gR
    F0: Positive | None = None  # -
    TC_star: Positive | None = None  # s
    soil: Literal["A", "B", "C", "D", "E"] | None = None
    topography: Literal["T1", "T2", "T3", "T4"] | None = None
    nominal_life: Positive | None = None  # years, V_N
    use: Literal["I", "II", "III", "IV"] | None = None  # class, for C_U
    type: Literal[1, 2] | None = None
    ground: Literal["A", "B", "C", "D", "E"] | None = None
    importance: Annotated[Any, PlainValidator(_importance)] = None  # class, or gamma_I
    file: str | None = None  # from the model file
    unit: Literal["g", "m/s2"] | None = None
    damping: Percent | None = None  # percent, of the table
    soil_factor: Positive | None = None  # S that the table holds
    corner_period: Positive | None = None  # s, T_C
    site_specific: bool | None = None
    return_period: Positive | None = None  # years

    def given(self) -> dict[str, Any]:
        """The keys that the file gives."""
        return {
            key: value
            for key in MotionSection.model_fields
            if (value := getattr(self, key)) is not None
        }


class FloorSection(Section):
    """[site.floor]: the mechanism is at a height of a building."""

    height: Annotated[float, Field(ge=0.0, le=1e4)] = Field(
        description="z of the mechanism in metres, as in height = 6.0"
    )
    building_height: Positive = Field(description="H in metres, as in building_height = 9.0")
    damping: Percent = Field(description="of the building in percent, as in damping = 5.0")
    storeys: Annotated[int, Field(ge=1, le=200)] | None = None
    participation: Positive | None = None  # gamma_1
    shape: Positive | None = None  # psi_1(z)
    period: Positive | None = None  # s, T_1
    period_factor: Positive | None = None  # -, of damaged buildings


class SiteSection(MotionSection):
    """[site]"""

    code: Literal["ntc2018", "ec8", "csv"] = Field(
        description='code = "ntc2018", "ec8", or "csv" for a spectrum of your own'
    )
    SLO: MotionSection | None = None
    SLD: MotionSection | None = None
    SLV: MotionSection | None = None
    SLC: MotionSection | None = None
    DL: MotionSection | None = None
    SD: MotionSection | None = None
    NC: MotionSection | None = None
    floor: FloorSection | None = None

    @model_validator(mode="after")
    def _keys_of_the_code(self) -> SiteSection:
        tables = {"": self.given(), **{name: own.given() for name, own in self.states().items()}}
        known = KEYS[self.code]
        for name, given in tables.items():
            for key in given:
                if key not in known:
                    where = f"{name}.{key}" if name else key
                    raise sentence(
                        f'{where} is no key of code = "{self.code}": take it out; it has '
                        + ", ".join(known)
                    )
        return self

    def states(self) -> dict[str, MotionSection]:
        """Limit states with a table of their own."""
        found = {name: getattr(self, name) for name in LIMIT_STATES}
        return {name: own for name, own in found.items() if own is not None}


class RecordSection(Section):
    """[[assessment.record]]: a ground motion to integrate under."""

    file: str = Field(description='its path from the model file, as in file = "record.csv"')
    unit: Literal["g", "m/s2"] = Field(description='of the accelerations: "g" or "m/s2"')
    scale: Positive | None = None


class PulseSection(Section):
    """[[assessment.pulse]]: a pulse to overturn under."""

    kind: Literal["half_sine", "rectangular"] = Field(description='as in kind = "half_sine"')
    amplitude: Ground = Field(description="in g, as in amplitude = 0.3")
    duration: Positive = Field(description="in seconds, as in duration = 0.5")


class AssessmentSection(Chosen):
    """[assessment]: beside these the keys that methods declare.

    The command line may name another method than the file, and say keys that it leaves out: a file
    may have the keys of all methods, and needs none of them.
    """

    chooser: ClassVar[str] = "method"
    registry: ClassVar[Registry[Any]] = METHODS

    method: str | None = None
    reading: Literal["base_shear", "energy", "literal_ec8"] | None = None
    grouping: Literal["macro_blocks", "blocks"] | None = None
    opposite: bool | None = None
    confidence_factor: Annotated[float, Field(ge=1.0, le=10.0)] | None = None
    kinematics: Literal["nonlinear", "linear"] | None = None
    limit_states: Annotated[list[State], Field(min_length=1)] | None = None
    displacement_limits: dict[State, Positive] | None = None  # m, control displacements
    elastic_period: Annotated[float, Field(ge=0.0, le=100.0)] | None = None  # s
    straight_capacity: bool | None = None
    language: Literal["en", "it"] | None = None  # of sentences, screens and reports
    parts_that_may_fall: list[str] | None = None  # ids or groups whose fall is no limit
    record: list[RecordSection] = []
    pulse: list[PulseSection] = []

    @staticmethod
    def declared(thing: Any) -> tuple[Key, ...]:
        """See `Chosen`."""
        return tuple(thing.KEYS)

    @classmethod
    def of(cls, table: Any) -> type[Self]:
        """See `Chosen`: the keys of all methods, of which two may share one."""
        if cls.extended:
            return cls
        found = {
            key.name: replace(key, default=None)
            for _, method in METHODS.loaded()
            for key in method.KEYS
        }
        return section_of(cls, tuple(found.values()))


def outside_problems(
    site: SiteSection | None, assessment: AssessmentSection | None, folder: Path
) -> list[str]:
    """A sentence on each file of [site] and [assessment] that is none of the model's folder."""
    named: dict[str, str | None] = {}
    if site is not None:
        named = {"site": site.file} | {f"site.{k}": own.file for k, own in site.states().items()}
    if assessment is not None:
        named |= {f"assessment.record[{k}]": r.file for k, r in enumerate(assessment.record, 1)}
    problems = []
    for place, name in named.items():
        try:
            within(folder, name or "")
        except ModelError as error:
            problems += [f"{place}.file: {problem}" for problem in error.problems]
    return problems


def site_of(
    section: SiteSection | None, folder: str, files: Mapping[str, str] | None = None
) -> Site | None:
    """The record of [site]; None where there is none.  For ``files`` see `Site`."""
    if section is None:
        return None
    return Site(
        code=section.code,
        values=section.given(),
        states={name: own.given() for name, own in section.states().items()},
        floor={} if section.floor is None else _given(section.floor),
        folder=folder,
        files=files,
    )


def assessment_of(
    section: AssessmentSection | None, folder: str, files: Mapping[str, str] | None = None
) -> AssessmentInput | None:
    """The record of [assessment]; None where there is none.  For ``files`` see `Site`."""
    if section is None:
        return None
    return AssessmentInput(values=_given(section), folder=folder, files=files)


def _given(section: Section) -> dict[str, Any]:
    data = section.model_dump(exclude_none=True)
    return {key: value for key, value in data.items() if value not in ([], {})}


class _Both(Section):
    site: SiteSection | None = None
    assessment: AssessmentSection | None = None


def tables_of(data: dict[str, Any]) -> tuple[Site | None, AssessmentInput | None]:
    """The records of tables ``site`` and ``assessment`` that came from elsewhere than a file.

    Raises
    ------
    ModelError
        With a sentence on everything that was found wrong.
    """
    from drystone.io.modelfile.sentences import sentences  # it knows all sections, these among them

    try:
        both = _Both.model_validate(data)
    except ValidationError as error:
        raise ModelError(sentences(error, data)) from None
    return site_of(both.site, ""), assessment_of(both.assessment, "")
