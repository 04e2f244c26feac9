"""[load] and [[dead_load]]: patterns and dead loads from their tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drystone.common.vectors import unit_vector
from drystone.io.modelfile.schema import DeadLoadSection, ForceSection, LoadSection
from drystone.model.loading import Acceleration, DeadLoad, LoadPattern, PointForce
from drystone.model.loading.acceleration import AccelerationPattern
from drystone.model.loading.dead import KINDS
from drystone.model.loading.forces import ForcesPattern
from drystone.model.loading.patterns import DIRECTED


def pattern_of(section: LoadSection, dimension: int) -> LoadPattern:
    """The load pattern that a file asks for; raises `ModelError`."""
    if section.pattern == ForcesPattern.name:
        return ForcesPattern(entries=tuple(map(_force, section.force)))
    if section.pattern == AccelerationPattern.name:
        return AccelerationPattern(
            entries=tuple(
                Acceleration(
                    block=entry.block, group=entry.group, acceleration=np.array(entry.acceleration)
                )
                for entry in section.acceleration
            )
        )
    kind: Any = DIRECTED[section.pattern]
    more = {} if section.base is None else {"base": section.base}
    return kind(  # type: ignore[no-any-return]
        direction=unit_vector(section.direction or (), "load.direction", dimension), **more
    )


def dead_loads_of(sections: Sequence[DeadLoadSection], dimension: int) -> tuple[DeadLoad, ...]:
    """The dead loads that a file gives; raises `ModelError`."""
    return tuple(_dead(section, dimension) for section in sections)


def _force(section: ForceSection) -> PointForce:
    return PointForce(
        block=section.block,
        group=section.group,
        point=section.point if isinstance(section.point, str) else np.array(section.point),
        force=np.array(section.force),
    )


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
