"""``pattern = "forces"``: given forces at points of blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import Any, ClassVar, Self

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import BlockPoint, Key, Tables, Vector
from drystone.common.language import say
from drystone.common.ranges import RANGES
from drystone.common.tolerances import ROUNDING
from drystone.geometry.motion import rotations, translations
from drystone.model.assembly import Assembly
from drystone.model.loading.base import NO_MASSES, Masses
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.loading.targets import CENTRE, TARGET_KEYS, PointForce
from drystone.model.scale import Scale


@dataclass(frozen=True, kw_only=True, eq=False)
class ForcesPattern:
    """Forces that are given, those at multiplier one."""

    entries: tuple[PointForce, ...]
    name: ClassVar[str] = "forces"
    turns_gravity: ClassVar[bool] = False
    file_keys: ClassVar[tuple[Key, ...]] = (
        Key(
            name="force",
            type=Tables(
                (
                    *TARGET_KEYS,
                    Key(name="point", type=BlockPoint(), default=CENTRE),
                    Key(
                        name="force",
                        type=Vector(RANGES["force"]),
                        says="on each block, in N, as in force = [1000.0, 0.0]",
                    ),
                )
            ),
            default=(),
        ),
    )

    @classmethod
    def from_keys(cls, values: dict[str, Any]) -> Self:
        """See `LoadPattern`."""
        return cls(entries=tuple(PointForce(**table) for table in values.get("force", ())))

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """See `LoadPattern`."""
        return reduce(add, (entry.forces(assembly) for entry in self.entries))

    def along(self, assembly: Assembly) -> Array:
        """That of their sum; of forces that have none, of the first."""
        force = self.forces(assembly).force
        if not force.any():  # those of each block are a couple
            force = np.array([entry.force for entry in self.entries])
        return leading(force.sum(axis=0), force)

    def towards(self, direction: Array) -> Self:
        """See `LoadPattern`."""
        raise ValueError('the pattern "forces" has the directions of its forces: change those')

    def opposite(self, assembly: Assembly) -> Self:
        """See `LoadPattern`."""
        entries = (replace(entry, force=-np.asarray(entry.force)) for entry in self.entries)
        return replace(self, entries=tuple(entries))

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `LoadPattern`."""
        return replace(self, entries=tuple(entry.in_space(vector) for entry in self.entries))

    def in_frame(self, scale: Scale) -> Self:
        """See `LoadPattern`."""
        return replace(self, entries=tuple(entry.in_frame(scale) for entry in self.entries))

    def problems(self, assembly: Assembly) -> list[str]:
        """See `LoadPattern`."""
        found = [] if self.entries else ["load.force: is missing: give the forces of the pattern"]
        for k, entry in enumerate(self.entries):
            found += entry.point_problems(assembly, f"load.force[{k + 1}]")
        if not found and not np.any([entry.force for entry in self.entries]):
            found = ["load.force: all forces are zero"]
        if not found and not self._acts(assembly):
            found = ["load.force: the forces on each block balance each other: nothing is loaded"]
        return found

    def _acts(self, assembly: Assembly) -> bool:
        """Whether any block feels a force or a moment, but for rounding."""
        forces = self.forces(assembly)
        largest = max(float(np.linalg.norm(entry.force)) for entry in self.entries)
        least = ROUNDING * largest * np.array([1.0, assembly.largest_extent])
        wrench = forces.wrenches(assembly)
        moved = np.abs(translations(wrench)).max(), np.abs(rotations(wrench)).max()
        return bool(np.any(np.array(moved) > least))

    def keys(self) -> dict[str, Any]:
        """See `LoadPattern`."""
        return {"force": [entry.point_keys() for entry in self.entries]}

    @property
    def words(self) -> str:
        """See `LoadPattern`."""
        return say("load.forces", n=len(self.entries))


def leading(resultant: Array, force: Array) -> Array:
    """Unit vector along a resultant (dim,), or where it is none along the first of forces."""
    sizes = np.linalg.norm(force, axis=1)
    size = float(np.linalg.norm(resultant))
    if size > 1e-6 * float(sizes.sum()):
        return np.asarray(resultant / size)
    first = int(np.argmax(sizes > 0.0))
    return np.asarray(force[first] / sizes[first])
