"""Load patterns: which force each block feels at a load multiplier of one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.geometry.motion import translations

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadPattern:
    """Forces proportional to the weight of each movable block, along one direction."""

    direction: Array  # (dim,) unit vector

    def forces(self, assembly: Assembly) -> Array:
        """Generalised forces at multiplier one, (n, n_dof) [N, N m]; zero on supports."""
        force = np.zeros((assembly.n_bodies, assembly.n_dof))
        translations(force)[:] = assembly.weight[:, None] * self.direction
        force[assembly.fixed] = 0.0
        return force

    def total(self, assembly: Assembly) -> float:
        """Sum of the pattern's forces along its direction [N]."""
        return float(assembly.weight[~assembly.fixed].sum())


def dead_load(assembly: Assembly) -> Array:
    """Generalised forces of gravity, (n, n_dof) [N, N m]; zero on supports."""
    force = np.zeros((assembly.n_bodies, assembly.n_dof))
    translations(force)[:] = -assembly.weight[:, None] * assembly.up
    force[assembly.fixed] = 0.0
    return force
