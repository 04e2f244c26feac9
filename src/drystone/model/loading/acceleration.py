"""``pattern = "acceleration"``: masses times accelerations that are given by groups."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import Key, Tables, Vector
from drystone.common.language import say
from drystone.common.ranges import RANGES
from drystone.model.assembly import Assembly
from drystone.model.loading.base import NO_MASSES, Masses
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.loading.forces import leading
from drystone.model.loading.targets import TARGET_KEYS, Target
from drystone.model.scale import Scale


@dataclass(frozen=True, kw_only=True, eq=False)
class Acceleration(Target):
    """Acceleration of a block, or of the blocks of a group, at multiplier one."""

    acceleration: Array  # (dim,) over that of gravity


@dataclass(frozen=True, kw_only=True, eq=False)
class AccelerationPattern:
    """Forces as large as mass times an acceleration; blocks that are not named feel none."""

    entries: tuple[Acceleration, ...]
    name: ClassVar[str] = "acceleration"
    turns_gravity: ClassVar[bool] = False
    file_keys: ClassVar[tuple[Key, ...]] = (
        Key(
            name="acceleration",
            type=Tables(
                (
                    *TARGET_KEYS,
                    Key(
                        name="acceleration",
                        type=Vector(RANGES["acceleration"]),
                        says="over that of gravity, as in acceleration = [1.0, 0.0]",
                    ),
                )
            ),
            default=(),
        ),
    )

    @classmethod
    def from_keys(cls, values: dict[str, Any]) -> Self:
        """See `LoadPattern`."""
        return cls(entries=tuple(Acceleration(**t) for t in values.get("acceleration", ())))

    def field(self, assembly: Assembly) -> Array:
        """Accelerations of the blocks over that of gravity, (n, dim)."""
        field = np.zeros((assembly.n_bodies, assembly.dimension))
        for entry in self.entries:
            field[entry.rows(assembly)] = entry.acceleration
        return field

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """See `LoadPattern`."""
        return masses.forces(assembly, self.field(assembly))

    def along(self, assembly: Assembly) -> Array:
        """That of the sum of forces; of forces that have none, of the first."""
        force = self.forces(assembly).without(assembly.fixed).force
        return leading(force.sum(axis=0), force)

    def towards(self, direction: Array) -> Self:
        """See `LoadPattern`."""
        raise ValueError('the pattern "acceleration" has the directions of its field: change these')

    def opposite(self, assembly: Assembly) -> Self:
        """See `LoadPattern`."""
        entries = (replace(e, acceleration=-np.asarray(e.acceleration)) for e in self.entries)
        return replace(self, entries=tuple(entries))

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `LoadPattern`."""
        entries = (replace(e, acceleration=vector(e.acceleration)) for e in self.entries)
        return replace(self, entries=tuple(entries))

    def in_frame(self, scale: Scale) -> Self:
        """See `LoadPattern`."""
        return self

    def problems(self, assembly: Assembly) -> list[str]:
        """See `LoadPattern`."""
        found = [] if self.entries else ["load.acceleration: is missing: give those of the groups"]
        for k, entry in enumerate(self.entries):
            place = f"load.acceleration[{k + 1}]"
            found += entry.target_problems(assembly, place)
            if np.shape(entry.acceleration) != (assembly.dimension,):
                found.append(f"{place}.acceleration: must have {assembly.dimension} entries")
        if found:
            return found
        count = np.zeros(assembly.n_bodies, np.int64)
        for entry in self.entries:
            count[entry.rows(assembly)] += 1
        if (count > 1).any():
            name = assembly.ids[int(np.argmax(count > 1))]
            return [f'load.acceleration: block "{name}" is given two: leave one of them out']
        if not self.field(assembly).any():
            return ["load.acceleration: all accelerations are zero"]
        return []

    def keys(self) -> dict[str, Any]:
        """See `LoadPattern`."""
        return {
            "acceleration": [
                {**e.target_keys(), "acceleration": np.asarray(e.acceleration).tolist()}
                for e in self.entries
            ]
        }

    @property
    def words(self) -> str:
        """See `LoadPattern`."""
        return say("load.acceleration", n=len(self.entries))
