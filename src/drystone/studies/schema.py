"""The keys of a study file, their types and ranges.  What they mean together is for `read`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from drystone.io.modelfile.keys import Name, Section, sentence

Number = Annotated[float, Field(allow_inf_nan=False)]
Range = Annotated[list[Number], Field(min_length=2, max_length=2)]

#: Most samples of a study: their numbers are drawn at once.
MOST_SAMPLES = 10_000_000


def _in_order(name: str, pair: list[float] | None) -> None:
    if pair is not None and not pair[0] < pair[1]:
        raise sentence(f"has {name} = [{pair[0]:g}, {pair[1]:g}]: the first must be the lower")


class VariedSection(Section):
    """What a parameter of a study and one of a target have in common."""

    path: str | Annotated[list[str], Field(min_length=1)] = Field(
        description='its place in the model file, as in path = "joint.friction_coefficient"'
    )
    name: Name | None = None
    apply: Literal["set", "multiply", "add"] = "set"


class ParameterSection(VariedSection):
    """[[parameter]]"""

    values: Annotated[list[Any], Field(min_length=1)] | None = None
    range: Range | None = None
    steps: Annotated[int, Field(ge=2, le=10_000)] | None = None
    whole: bool = False
    distribution: str | None = None
    mean: Number | None = None
    std: Number | None = None
    shapes: dict[str, Number] = {}
    bounds: Range | None = None

    @model_validator(mode="after")
    def _one_of_them(self) -> ParameterSection:
        kinds = ("values", "range", "distribution")
        given = [kind for kind in kinds if getattr(self, kind) is not None]
        if len(given) != 1:
            has = "none" if not given else " and ".join(given)
            raise sentence(f"has {has} of values, range and distribution: give one of them")
        _in_order("range", self.range)
        _in_order("bounds", self.bounds)
        of_distributions = {"mean", "std", "shapes", "bounds"} & self.model_fields_set
        if of_distributions and self.distribution is None:
            key = sorted(of_distributions)[0]
            raise sentence(f"has {key}, which belongs to a distribution: take it out")
        if self.whole and self.range is None:
            raise sentence("has whole, which belongs to a range: take it out")
        return self


class CorrelationSection(Section):
    """[[correlation]]"""

    between: Annotated[list[str], Field(min_length=2, max_length=2)] = Field(
        description='names or paths of two parameters, as in between = ["a", "b"]'
    )
    value: Annotated[float, Field(gt=-1.0, lt=1.0)] = Field(
        description="of their normal scores, as in value = 0.5"
    )


class ImperfectionSection(Section):
    """[imperfection]: what is drawn anew for each sample, by the sample's seed."""

    vertices: Annotated[float, Field(gt=0.0)] | None = None  # m
    unit_sizes: Annotated[float, Field(gt=0.0, lt=1.0)] | None = None  # ratio
    missing: Annotated[float, Field(ge=0.0, lt=1.0)] | None = None  # probability
    loose: Annotated[float, Field(ge=0.0, le=1.0)] | None = None  # probability
    loose_gap: Annotated[float, Field(gt=0.0)] | None = None  # m
    blocks: list[str] = []

    @model_validator(mode="after")
    def _gap_of_loose(self) -> ImperfectionSection:
        if (self.loose is None) != (self.loose_gap is None):
            raise sentence("has one of loose and loose_gap [m]: give both")
        return self


class FragilitySection(Section):
    """[[fragility]]"""

    method: Literal["capacity", "stripes", "cloud"] = Field(
        description='as in method = "capacity", "stripes" or "cloud"'
    )
    name: Name | None = None
    capacity: str | None = None
    intensity: str | None = None
    demand: str | None = None
    threshold: Number | None = None
    exceeded: Literal["above", "below"] = "above"

    @model_validator(mode="after")
    def _of_its_method(self) -> FragilitySection:
        wanted: tuple[str, ...] = ("capacity",)
        if self.method != "capacity":
            wanted = ("intensity", "demand", "threshold")
        for key in wanted:
            if getattr(self, key) is None:
                raise sentence(f'{key} is missing: method = "{self.method}" needs it')
        return self


class AimedSection(VariedSection):
    """[[target.parameter]]"""

    range: Range = Field(description="where its value is looked for, as in range = [1e3, 1e5]")
    steps: Annotated[int, Field(ge=2, le=200)] = 9

    @model_validator(mode="after")
    def _ordered(self) -> AimedSection:
        _in_order("range", self.range)
        return self


class TargetSection(Section):
    """[target]"""

    output: str = Field(description='a column of samples, as in output = "peak_multiplier"')
    value: Number = Field(description="what the output is to reach, as in value = 1.0")
    tolerance: Annotated[float, Field(gt=0.0, lt=1.0)] = 1e-3
    most_runs: Annotated[int, Field(ge=4, le=1000)] = 40
    parameter: Annotated[list[AimedSection], Field(min_length=1, max_length=2)] = Field(
        description="one table [[target.parameter]], or two for a map"
    )


Output = Literal["curve", "limit", "assess", "senses"]


class StudySection(Section):
    """The whole file."""

    title: str | None = None
    model: str | dict[str, Any] | None = None
    function: Annotated[str, Field(pattern=r"^[\w.]+:\w+$")] | None = None
    design: Literal["grid", "lhs", "sobol", "random", "saltelli", "morris"] | None = None
    samples: Annotated[int, Field(ge=1, le=MOST_SAMPLES)] | None = None
    seed: Annotated[int, Field(ge=0)] = 1
    levels: Annotated[int, Field(ge=2, le=100)] = 4
    second_order: bool = False
    outputs: Annotated[list[Output], Field(min_length=1)] = ["curve"]
    engine: str | None = None
    strategy: Literal["displacement", "published"] | None = None
    points: Annotated[int, Field(ge=2, le=10_000)] = 64
    timeout: Annotated[float, Field(gt=0.0)] | None = None  # s
    parameter: list[ParameterSection] = []
    correlation: list[CorrelationSection] = []
    imperfection: ImperfectionSection | None = None
    fragility: list[FragilitySection] = []
    target: TargetSection | None = None

    @model_validator(mode="after")
    def _one_of_them(self) -> StudySection:
        if (self.model is None) == (self.function is None):
            has = "neither" if self.model is None else "both"
            raise sentence(
                f"has {has} of model and function: give the path of a model file, or a function "
                'as in function = "module:name"'
            )
        if self.function is not None and self.imperfection is not None:
            raise sentence("has [imperfection], which belongs to a model: take it out")
        if self.target is not None and (self.parameter or self.design):
            raise sentence("has [target] beside a design: make a study of its own for each")
        return self
