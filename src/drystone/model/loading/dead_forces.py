"""Forces on blocks that keep their direction however blocks move: what any load comes down to.

A force P acts at a point of its block, whose arm b from the centroid turns with the block to a = R
b.  All that a block feels of several is the sum of P and the sum of the moments a x P.  The latter
are those of the tensor B = sum a P^T, which turns as B = R B_0 and so is kept as designed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.motion import (
    about_own_axes,
    axial,
    moments,
    moments_falling,
    rotation_matrices,
    rotations,
    translations,
)
from drystone.model.assembly import Assembly


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadForces:
    """Forces of fixed direction at points of the blocks, summed up by blocks."""

    force: Array  # (n, dim) N
    lever: Array | None = None
    """(n, dim, dim) [N m] sum of arm times force, of arms from the centroids as designed; None
    where all forces act at centroids."""

    @classmethod
    def none(cls, assembly: Assembly) -> DeadForces:
        """No force at all."""
        return cls(force=np.zeros((assembly.n_bodies, assembly.dimension)))

    @classmethod
    def at_points(
        cls, assembly: Assembly, body: IntArray, point: Array, force: Array
    ) -> DeadForces:
        """Forces (m, dim) [N] at points (m, dim) [m], as designed, of the blocks ``body`` (m,)."""
        dim = assembly.dimension
        sums, lever = (np.zeros((assembly.n_bodies, *shape)) for shape in ((dim,), (dim, dim)))
        arm = point - assembly.centroid[body]
        np.add.at(sums, body, force)
        np.add.at(lever, body, arm[:, :, None] * force[:, None, :])
        return cls(force=sums, lever=lever if lever.any() else None)

    def __add__(self, other: DeadForces) -> DeadForces:
        levers = [lever for lever in (self.lever, other.lever) if lever is not None]
        return DeadForces(
            force=self.force + other.force, lever=np.sum(levers, axis=0) if levers else None
        )

    def __mul__(self, factor: float) -> DeadForces:
        lever = None if self.lever is None else factor * self.lever
        return DeadForces(force=factor * self.force, lever=lever)

    __rmul__ = __mul__

    def without(self, rows: BoolArray) -> DeadForces:
        """Those on all blocks but some, (n,)."""
        force = np.where(rows[:, None], 0.0, self.force)
        lever = None if self.lever is None else np.where(rows[:, None, None], 0.0, self.lever)
        return replace(self, force=force, lever=lever)

    @property
    def turns(self) -> bool:
        """Whether moments change as blocks turn."""
        return self.lever is not None

    def tensor(self, pose: Array) -> Array:
        """B = sum a P^T of arms in the poses (n, n_pose), (n, dim, dim) [N m]."""
        assert self.lever is not None
        return rotation_matrices(pose) @ self.lever

    def wrenches(self, assembly: Assembly, pose: Array | None = None) -> Array:
        """Generalised forces about the centroids, (n, n_dof) [N, N m], as designed or in poses (n,
        n_pose); in space moments are about the principal axes there, see `geometry.motion`."""
        found = np.zeros((assembly.n_bodies, assembly.n_dof))
        translations(found)[:] = self.force
        if self.lever is None:
            return found
        if pose is None:
            pose = assembly.design_pose()
        about = axial(self.tensor(pose))
        rotations(found)[:] = about_own_axes(about, principal_axes(assembly, pose))
        return found

    def moments(self, pose: Array | None = None) -> Array:
        """Moments about the axes of the world, as designed or in poses (n, n_pose), (n, 1) in the
        plane, (n, 3) in space [N m]."""
        if self.lever is None:
            return np.zeros_like(moments(self.force, self.force))
        return axial(self.lever if pose is None else self.tensor(pose))

    def stiffness(self, assembly: Assembly, pose: Array) -> Array:
        """By how much moments fall as blocks turn on, (n, n_rot, n_rot) [N m], in space about the
        principal axes."""
        if self.lever is None:
            n, n_rot = rotations(assembly.no_motion()).shape
            return np.zeros((n, n_rot, n_rot))
        return moments_falling(self.tensor(pose), principal_axes(assembly, pose))


def principal_axes(assembly: Assembly, pose: Array) -> Array:
    """Principal axes of blocks in poses (n, n_pose), (n, dim, dim) in columns."""
    return rotation_matrices(pose) @ assembly.axes
