"""Tables of a model file whose keys are declared by what they name: a pattern, a builder, a method.

Whoever adds such a thing declares its keys in its own file (`common.keys`); the check of a table is
made of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from types import GenericAlias
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    Field,
    ModelWrapValidatorHandler,
    PlainValidator,
    ValidationInfo,
    create_model,
    model_validator,
)
from pydantic_core import PydanticCustomError

from drystone.common import keys as declared
from drystone.common.keys import NEEDED, Key
from drystone.common.registry import Registry, RegistryError
from drystone.io.modelfile.keys import (
    Direction,
    Section,
    dimension_of,
    in_range,
    in_space_only,
    of_dimension,
    point_or_name,
    sentence,
)
from drystone.model.construction.words import quoted, suggestion
from drystone.model.site import known_states


def _state(value: str) -> str:
    known = known_states()
    if value not in known:
        raise sentence(f"must not be {quoted(value)}: {suggestion(value, list(known))}")
    return value


#: A limit state of any method.
State = Annotated[str, AfterValidator(_state)]


def _annotation(type_: declared.Type) -> Any:
    """What pydantic checks a value by."""
    match type_:
        case declared.Number(range_):
            return Annotated[float, in_range(range_)]
        case declared.Whole(least, most):
            return Annotated[int, Field(ge=least, le=most)]
        case declared.Flag():
            return bool
        case declared.Text():
            return str
        case declared.Choice(among):
            return Literal[among]
        case declared.Direction():
            return Direction
        case declared.Vector(range_):
            return Annotated[_list(declared.Number(range_)), AfterValidator(of_dimension)]
        case declared.BlockPoint():
            return Annotated[Any, PlainValidator(point_or_name)]
        case declared.Several(of, least, most):
            return Annotated[_list(of), Field(min_length=least, max_length=most)]
        case declared.ByState(of):
            return GenericAlias(dict, (State, _annotation(of)))
        case declared.Tables(keys):
            return GenericAlias(list, (section_of(Section, keys),))
    raise TypeError(f"no key has the type {type_}")


def _list(type_: declared.Type) -> Any:
    return GenericAlias(list, (_annotation(type_),))


def _needed_in_space(value: Any, info: ValidationInfo) -> Any:
    if value is None and dimension_of(info) == 3:
        raise PydanticCustomError("missing", "missing")
    return in_space_only(value, info)


def _field(key: Key) -> tuple[Any, Any]:
    annotation = _annotation(key.type)
    says = key.says or None
    if key.of_space and key.default is NEEDED:
        annotation = Annotated[annotation | None, AfterValidator(_needed_in_space)]
        return annotation, Field(default=None, validate_default=True, description=says)
    if key.default is NEEDED:
        return annotation, Field(description=says)
    if key.default is None or key.of_space:
        annotation = annotation | None
    if key.of_space:
        annotation = Annotated[annotation, AfterValidator(in_space_only)]
    return annotation, Field(default=key.default, description=says)


@cache
def section_of(base: type[Section], keys: tuple[Key, ...]) -> type[Any]:
    """A section with the keys of ``base`` and those that are declared."""
    fields: dict[str, Any] = {key.name: _field(key) for key in keys}
    made = create_model(base.__name__, __base__=base, __doc__=base.__doc__, **fields)
    if issubclass(made, Extended):
        made.extended = True
    return made


def plain(value: Any) -> Any:
    """Sections as the tables that they were, with the keys that the file gave."""
    if isinstance(value, list):
        return [plain(entry) for entry in value]
    if isinstance(value, Section):
        return {key: getattr(value, key) for key in value.model_fields_set}
    return value


class Extended(Section):
    """A table with keys beside its own that others declare."""

    extended: ClassVar[bool] = False  # whether they are in it already

    @classmethod
    def of(cls, table: Any) -> type[Self]:
        """The section for a table, as far as the table tells."""
        raise NotImplementedError

    @model_validator(mode="wrap")
    @classmethod
    def _extend(
        cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo
    ) -> Self:
        if cls.extended or not isinstance(data, dict):
            return handler(data)
        own = cls.of(data)
        if own is cls:
            return handler(cls.told_by(data))
        known = own.keys()
        for key in data:
            if key not in known:
                cls.refuse(key, data)
        return own.model_validate(data, context=info.context)

    @classmethod
    def told_by(cls, data: dict[str, Any]) -> dict[str, Any]:
        """What is checked of a table whose section is not known."""
        return data

    @classmethod
    def refuse(cls, key: str, data: dict[str, Any]) -> None:
        """Say more of a key that is not known than that, by an error."""


class Chosen(Extended):
    """A table with the keys of what one of its keys names, beside keys that all have.

    A class says by which key a thing of which registry is named, and gives the keys of one.
    """

    chooser: ClassVar[str]
    registry: ClassVar[Registry[Any]]

    @staticmethod
    def declared(thing: Any) -> tuple[Key, ...]:
        """Keys of a thing of the registry."""
        return tuple(thing.file_keys)

    @classmethod
    def variant(cls, name: str) -> type[Self]:
        """The section for a thing of the registry; raises `RegistryError`."""
        return section_of(cls, cls.declared(cls.registry[name]))

    @classmethod
    def variants(cls) -> dict[str, type[Self]]:
        """Those of the things of this package, by name."""
        return {name: cls.variant(name) for name in cls.registry.ours}

    @classmethod
    def of(cls, table: Any) -> type[Self]:
        """The section for a table, as far as the table tells."""
        name = table.get(cls.chooser) if isinstance(table, dict) else None
        try:
            return cls.variant(name) if isinstance(name, str) else cls
        except RegistryError:
            return cls

    @property
    def given(self) -> dict[str, Any]:
        """What the file gives of the keys that were declared."""
        own = {key.name for key in self.declared(self.registry[getattr(self, self.chooser)])}
        return {name: plain(getattr(self, name)) for name in self.model_fields_set & own}

    @classmethod
    def told_by(cls, data: dict[str, Any]) -> dict[str, Any]:
        """The name, which is what is wrong, and says nothing of the other keys."""
        return {key: data[key] for key in (cls.chooser,) if key in data}

    @classmethod
    def refuse(cls, key: str, data: dict[str, Any]) -> None:
        """Refuse a key that others of this package have."""
        name = str(data.get(cls.chooser))
        owners = [quoted(other) for other, thing in cls.registry.own()
                  if any(own.name == key for own in cls.declared(thing))]  # fmt: skip
        if len(owners) == 1:
            raise sentence(f"has {key}, which belongs to {cls.chooser} = {owners[0]}: take it out")
        if owners:
            raise sentence(
                f"has {key}, which does not belong to {cls.chooser} = {quoted(name)}: take it out"
            )


def named(registry: Registry[Any]) -> AfterValidator:
    """The check of a name of a registry."""

    def check(value: str) -> str:
        if value in registry.ours:
            return value
        if value not in registry:
            known = list(registry.names())
            raise sentence(f"must not be {quoted(value)}: {suggestion(value, known)}")
        try:
            registry[value]
        except RegistryError as error:
            raise sentence(f"cannot be {quoted(value)}: {error}") from None
        return value

    return AfterValidator(check)


def sections_in(section: type[Section]) -> Iterator[type[Section]]:
    """The section itself, or of one whose keys depend on what it names all that there are."""
    if issubclass(section, Chosen) and not section.extended:
        yield from section.variants().values()
    elif issubclass(section, Extended) and not section.extended:
        yield section.of({})
    else:
        yield section
