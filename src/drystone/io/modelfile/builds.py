"""[[build]]: what tables of all kinds have; the rest are keys of the builder that is named."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field, PlainValidator, ValidationInfo, model_validator

from drystone.common.keys import Key
from drystone.common.registry import Registry
from drystone.io.modelfile.declared import Chosen, named
from drystone.io.modelfile.keys import Name, Place, dimension_of, rotation_of, sentence
from drystone.model.assembly import Block
from drystone.model.builders.kinds import BUILDERS


class BuildSection(Chosen):
    """[[build]]: beside these the keys that the builder declares."""

    chooser: ClassVar[str] = "kind"
    registry: ClassVar[Registry[Any]] = BUILDERS

    kind: Annotated[str, named(BUILDERS)] = Field(description='as in kind = "panel"')
    name: Name | None = None
    material: str | None = None
    group: Name | None = None
    origin: Place | None = None  # m
    rotation: Annotated[Any, PlainValidator(rotation_of)] = 0.0  # degrees
    base: bool = False

    @staticmethod
    def declared(thing: Any) -> tuple[Key, ...]:
        """See `Chosen`."""
        return tuple(thing.keys)

    @model_validator(mode="after")
    def _in_its_dimension(self, info: ValidationInfo) -> BuildSection:
        dimensions, own = BUILDERS[self.kind].dimensions, dimension_of(info)
        if own is not None and own not in dimensions:
            where = "space" if own == 2 else "the plane"
            raise sentence(
                f'kind = "{self.kind}" is for models in {where} only: '
                f"set dimension = {dimensions[0]}"
            )
        return self

    def blocks(self, unit_weight: float, material: str) -> list[Block]:
        """What the builder of its kind makes of its keys; raises `ModelError`."""
        return BUILDERS[self.kind].blocks(self.given, unit_weight, material)
