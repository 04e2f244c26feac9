"""``pattern = "mass"``: forces in proportion to the mass of each block, along any direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from drystone.model.assembly import Assembly
from drystone.model.loading.base import NO_MASSES, Directed, Masses
from drystone.model.loading.dead_forces import DeadForces


@dataclass(frozen=True, kw_only=True, eq=False)
class MassPattern(Directed):
    """A force on each movable block, as large as its weight, along one direction."""

    name: ClassVar[str] = "mass"

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """See `LoadPattern`."""
        return masses.forces(assembly, np.broadcast_to(self.direction, assembly.centroid.shape))
