"""[load] and [[dead_load]]: patterns and dead loads from their tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drystone.common.keys import Direction
from drystone.common.vectors import unit_vector
from drystone.io.modelfile.schema import DeadLoadSection, LoadSection
from drystone.model.loading import DeadLoad, LoadPattern
from drystone.model.loading.dead import KINDS
from drystone.model.loading.patterns import PATTERNS


def pattern_of(section: LoadSection, dimension: int) -> LoadPattern:
    """The load pattern that a file asks for; raises `ModelError`."""
    kind = PATTERNS[section.pattern]
    directions = {key.name for key in kind.file_keys if isinstance(key.type, Direction)}
    values = {
        key: unit_vector(value, f"load.{key}", dimension) if key in directions else _arrays(value)
        for key, value in section.given.items()
        if value is not None
    }
    return kind.from_keys(values)


def _arrays(value: Any) -> Any:
    """Lists of numbers as arrays, also within tables."""
    if isinstance(value, dict):
        return {key: _arrays(entry) for key, entry in value.items()}
    if isinstance(value, list) and all(isinstance(entry, float) for entry in value):
        return np.array(value)
    return [_arrays(entry) for entry in value] if isinstance(value, list) else value


def dead_loads_of(sections: Sequence[DeadLoadSection], dimension: int) -> tuple[DeadLoad, ...]:
    """The dead loads that a file gives; raises `ModelError`."""
    return tuple(_dead(section, dimension) for section in sections)


def _dead(section: DeadLoadSection, dimension: int) -> DeadLoad:
    given: dict[str, Any] = {
        key: getattr(section, key) for key in section.model_fields_set if key != "kind"
    }
    values = {
        key: np.array(value, float) if isinstance(value, list) else value
        for key, value in given.items()
        if value is not None
    }
    if "side" in values:
        values["side"] = unit_vector(values["side"], "dead_load.side", dimension)
    kind: Any = KINDS[section.kind]
    return kind(**values)  # type: ignore[no-any-return]
