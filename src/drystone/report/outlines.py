"""Outlines of all blocks, packed, so that ten thousand of them are moved in one go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.geometry.motion import moved_points
from drystone.geometry.outlines import Outlines

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class MovingOutlines(Outlines):
    """Outlines as designed, to be moved.

    With ``linear`` poses are increments of a velocity field, see `motion.moved_points`.
    """

    centroid: Array  # (n, 2) m
    linear: bool = False

    @classmethod
    def of(cls, assembly: Assembly, *, linear: bool = False) -> MovingOutlines:
        """The outlines of an assembly."""
        designed = assembly.outlines
        return cls(
            vertices=designed.vertices,
            offset=designed.offset,
            body=designed.body,
            centroid=assembly.centroid,
            linear=linear,
        )

    def moved(self, pose: Array) -> Array:
        """All vertices in the poses (n, 3) [m, m, rad], (n_vertices, 2) [m]."""
        return moved_points(self.vertices, self.owner, self.centroid, pose, linear=self.linear)

    def split(self, vertices: Array) -> list[Array]:
        """One array of vertices per block."""
        return np.split(vertices, self.offset[1:-1])

    def displacement(self, pose: Array, since: Array | None = None) -> Array:
        """Largest displacement of a vertex of each block, (n,) [m], from the poses ``since``, or
        from the designed places."""
        start = self.vertices if since is None else self.moved(since)
        distance = np.linalg.norm(self.moved(pose) - start, axis=1)
        return np.asarray(np.maximum.reduceat(distance, self.offset[:-1]))

    def size(self) -> float:
        """The longer side of the box around all blocks [m]."""
        return float(np.ptp(self.vertices, axis=0).max())


def moving_blocks(
    displacement: Array, fixed: NDArray[np.bool_], share: float = 0.05
) -> NDArray[np.bool_]:
    """Which blocks (n,) move with the mechanism: more than ``share`` of the largest displacement.

    What moves less does so by the compliance of the joints.
    """
    largest = float(displacement.max(initial=0.0))
    return (displacement > share * largest) & ~fixed & (largest > 0.0)
