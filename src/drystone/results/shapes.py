"""Shapes of all blocks, packed, so that ten thousand of them are moved in one go."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.motion import moved_points
from drystone.model.assembly import Assembly

#: Displacements below this share of the structure's size count as those under the dead load.
LEAST = 1e-5
#: Share of the largest displacement from which on a block moves with a mechanism.
MOVING = 0.05


@dataclass(frozen=True, kw_only=True)
class MovingShapes:
    """Shapes as designed, to be moved: outlines in the plane, convex parts in space.

    In the plane a block is one outline, which may be concave, but for one that is given in parts.
    With ``linear`` poses are increments of a velocity field, see `motion.moved_points`.
    """

    vertices: Array  # (n_vertices, dim) m
    offset: IntArray  # (n_shapes + 1,); shape s owns vertices[offset[s]:offset[s + 1]]
    body: IntArray  # (n_shapes,) row of the block, in ascending order
    centroid: Array  # (n, dim) m
    linear: bool = False

    @classmethod
    def of(cls, assembly: Assembly, *, linear: bool = False) -> MovingShapes:
        """The shapes of an assembly."""
        own = [[part.vertices for part in block.parts or (block,)] for block in assembly.blocks]
        shapes = assembly.kind.drawn(own, assembly.packed)
        vertices, offset, body = shapes.vertices, shapes.offset, shapes.body
        return cls(
            vertices=vertices, offset=offset, body=body, centroid=assembly.centroid, linear=linear
        )

    @cached_property
    def owner(self) -> IntArray:
        """Row of the block that each vertex belongs to, (n_vertices,)."""
        return np.repeat(self.body, np.diff(self.offset))

    @cached_property
    def _first(self) -> IntArray:
        """First vertex of each block, (n,)."""
        return np.searchsorted(self.owner, np.arange(len(self.centroid)))

    def moved(self, pose: Array) -> Array:
        """All vertices in the poses (n, n_pose), (n_vertices, dim) [m]."""
        return moved_points(self.vertices, self.owner, self.centroid, pose, linear=self.linear)

    def split(self, vertices: Array) -> list[Array]:
        """One array of vertices per shape."""
        return np.split(vertices, self.offset[1:-1])

    def displacement(self, pose: Array, since: Array | None = None) -> Array:
        """Largest displacement of a vertex of each block, (n,) [m], from the poses ``since``, or
        from the designed places."""
        start = self.vertices if since is None else self.moved(since)
        return self.largest(self.moved(pose) - start)

    def largest(self, away: Array) -> Array:
        """Largest displacement of a vertex of each block, (n,) [m], of those of all vertices
        (n_vertices, dim)."""
        return np.asarray(np.maximum.reduceat(np.linalg.norm(away, axis=1), self._first))

    def size(self) -> float:
        """The longest side of the box around all blocks [m]."""
        return float(np.ptp(self.vertices, axis=0).max())


def compliance(shapes: MovingShapes, initial: Array | None, fixed: BoolArray) -> float:
    """Displacement that a block may have by the compliance of the joints alone [m].

    The measure is the motion under the dead load, in which all joints closed: the largest
    displacement of the poses ``initial`` (n, n_pose) among blocks that are not ``fixed`` (n,).
    Without these, and for rates, there is no such measure: infinite.
    """
    if shapes.linear or initial is None:
        return np.inf
    sunk = float(shapes.displacement(initial)[~fixed].max(initial=0.0))
    return max(sunk, LEAST * shapes.size())


def moving_blocks(displacement: Array, fixed: BoolArray, compliant: float = np.inf) -> BoolArray:
    """Which blocks (n,) move with the mechanism.

    Those do that move by more than ``compliant``, see `compliance`: however far a part falls, what
    has moved by that is not at rest.  As long as the largest displacement is small itself, they are
    those that move by more than `MOVING` of it.
    """
    largest = float(displacement.max(initial=0.0))
    least = min(MOVING * largest, compliant)
    return (displacement > least) & ~fixed & (largest > 0.0)
