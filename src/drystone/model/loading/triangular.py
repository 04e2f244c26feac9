"""``pattern = "triangular"``: forces in proportion to mass times height above the base."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import Key, Number
from drystone.common.ranges import RANGES
from drystone.model.assembly import Assembly
from drystone.model.loading.base import NO_MASSES, Directed, Masses
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.scale import Scale


@dataclass(frozen=True, kw_only=True, eq=False)
class TriangularPattern(Directed):
    """Sideways forces F_i = W m_i z_i / sum m_j z_j with the weight W of all masses: EN 1998-1,
    (4.11).

    Heights are those of the blocks' centroids, and of dead loads with a mass where they act. What
    lies below the base has no force.
    """

    name: ClassVar[str] = "triangular"
    horizontal: ClassVar[bool] = True
    file_keys: ClassVar[tuple[Key, ...]] = (
        *Directed.file_keys,
        Key(name="base", type=Number(RANGES["coordinate"]), default=None),
    )
    base: float | None = None  # m, height; None: where the lowest movable block begins

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """See `LoadPattern`."""
        heights = [self.heights(assembly, arm) for arm in masses.arms(assembly)]
        mean = masses.mean(assembly, heights)
        shares = [height / mean if mean > 0.0 else np.zeros_like(height) for height in heights]
        return masses.forces_in_place(
            assembly, [share[:, None] * self.direction for share in shares]
        )

    def heights(self, assembly: Assembly, arm: Array | float = 0.0) -> Array:
        """Above the base, (n,) [m], of the centroids or of places at arms (n, dim) from them."""
        base = self.base
        if base is None:
            movable = [block.vertices for block in assembly.blocks if not block.support]
            base = min(float((vertices @ assembly.up).min()) for vertices in movable)
        return np.maximum((assembly.centroid + arm) @ assembly.up - base, 0.0)

    def in_frame(self, scale: Scale) -> Self:
        """See `LoadPattern`."""
        return replace(self, base=None if self.base is None else scale.height(self.base))

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `LoadPattern`."""
        return replace(self, direction=vector(self.direction))

    def problems(self, assembly: Assembly) -> list[str]:
        """See `LoadPattern`."""
        found = super().problems(assembly)
        if assembly.n_blocks and not self.heights(assembly)[~assembly.fixed].any():
            found.append("load.base: all blocks lie below it: lower it")
        return found

    def keys(self) -> dict[str, Any]:
        """See `LoadPattern`."""
        return super().keys() | ({} if self.base is None else {"base": self.base})
