"""The control point: the one displacement that a pushover curve is drawn against."""

from __future__ import annotations

from dataclasses import dataclass

from drystone.common.arrays import Array
from drystone.model.assembly import Assembly


@dataclass(frozen=True, kw_only=True, eq=False)
class ControlPoint:
    """A material point of one movable block and the direction its displacement is read in."""

    block: int  # row in the assembly's arrays
    point: Array  # (dim,) m, on the block as designed
    direction: Array  # (dim,) unit vector
    default: bool = False  # whether nobody named the block or the point

    def displacement(self, assembly: Assembly, pose: Array) -> float:
        """Control displacement [m] in the given poses (n, n_dof)."""
        return float(self.direction @ assembly.displacement_at(self.block, self.point, pose))
