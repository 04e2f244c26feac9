"""The types that keys of a model file have: numbers with ranges, places, directions, names.

How many coordinates a place or a direction has is the file's `dimension`, which the check is told.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationInfo,
)
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from drystone.common.ranges import LARGEST, RANGES, Range
from drystone.model.builders.wall import course_problem
from drystone.model.construction.control import named_points
from drystone.model.construction.words import quoted, suggestion


def sentence(text: str) -> PydanticCustomError:
    """An error whose message goes to the user as it stands."""
    return PydanticCustomError("sentence", "{text}", {"text": text})


def dimension_of(info: ValidationInfo) -> int | None:
    """The file's; None where it gives none that there is."""
    return info.context["dimension"] if info.context else None


def of_dimension(value: list[float], info: ValidationInfo) -> list[float]:
    """The value, with as many entries as the file has coordinates."""
    wanted = dimension_of(info)
    if len(value) == wanted or (wanted is None and len(value) in (2, 3)):
        return value
    raise sentence(f"must have {wanted or '2 or 3'} entries, it has {len(value)}")


def _direction(value: list[float], info: ValidationInfo) -> list[float]:
    if not any(value):
        example = "[1.0, 0.0, 0.0]" if dimension_of(info) == 3 else "[1.0, 0.0]"
        raise sentence(f"has no length: give a direction, as in {example}")
    return of_dimension(value, info)


def in_plane_only(value: Any, info: ValidationInfo) -> Any:
    """The value, which models in space do not have."""
    if value is not None and dimension_of(info) == 3:
        raise sentence("is for models in the plane only: take it out")
    return value


def in_space_only(value: Any, info: ValidationInfo) -> Any:
    """The value, which models of the plane do not have."""
    if value is not None and dimension_of(info) == 2:
        raise sentence("is for models in space only: take it out, or set dimension = 3")
    return value


def _name(value: str) -> str:
    if not value.strip() or not value.isprintable():
        raise sentence("must be a name of printable letters on one line")
    if len(value) > LARGEST["name"]:
        raise sentence(f"has {len(value):,} letters: a name has at most {LARGEST['name']}")
    return value


def _course(value: str) -> str:
    problem = course_problem(value)
    if problem:
        raise sentence(problem)
    return value


def point_of(value: Any, info: ValidationInfo) -> str | list[float]:
    dimension = dimension_of(info) or 2
    known = named_points(dimension)
    if isinstance(value, str):
        if value not in known:
            raise sentence(f"there is no point {quoted(value)}: {suggestion(value, list(known))}")
        return value
    numbers = value if isinstance(value, list) else []
    numbers = [x for x in numbers if isinstance(x, int | float) and not isinstance(x, bool)]
    wrong = [x for x in numbers if RANGES["coordinate"].problem(x)]
    if len(numbers) != dimension or numbers != value or wrong:
        place = ", ".join("xyz"[:dimension])
        raise sentence(f'must be [{place}] in metres, or one of "' + '", "'.join(known) + '"')
    return [float(x) for x in numbers]


def rotation_of(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    angles = value if isinstance(value, list) else [value]
    if len(angles) != 1 and not (len(angles) == 3 and dimension_of(info) != 2):
        raise sentence("must be one angle in degrees, or in space three, about x, y and z")
    for angle in angles:
        if problem := RANGES["angle"].problem(angle):
            raise sentence(problem)
    return tuple(map(float, angles))


def ranged(name: str) -> PlainValidator:
    """The check of a number that has its range in `RANGES`."""
    return in_range(RANGES[name])


def in_range(range_: Range) -> PlainValidator:
    """The check of a number of a range."""

    def check(value: Any) -> float:
        problem = range_.problem(value)
        if problem:
            raise sentence(problem)
        return float(value)

    return PlainValidator(check)


def point_or_name(value: Any, info: ValidationInfo) -> str | list[float]:
    """A name of a point, or a place; which names there are is for the load to say."""
    if isinstance(value, str):
        return value
    return [float(x) for x in point_of(value, info)]


Coordinate = Annotated[float, ranged("coordinate")]
Pair = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]
Place = Annotated[list[Coordinate], AfterValidator(of_dimension)]
Direction = Annotated[list[Annotated[float, ranged("direction")]], AfterValidator(_direction)]
Name = Annotated[str, AfterValidator(_name)]
Course = Annotated[str, AfterValidator(_course)]


class Section(BaseModel):
    """A table of the file: no unknown keys, no text for numbers, no infinities.

    A field's description is what a message adds when the key is missing.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)

    @classmethod
    def keys(cls) -> dict[str, FieldInfo]:
        """The fields by their keys in files, which are their names but for words of Python's."""
        return {field.alias or name: field for name, field in cls.model_fields.items()}


Spatial = BeforeValidator(in_space_only)
