"""Designed joints of a structure in space and what became of them, as `joints` has them of the
plane: from the shapes and the poses alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.motion import moved_points
from drystone.model.assembly import Assembly


@dataclass(frozen=True, kw_only=True, eq=False)
class SolidJoints:
    """Joints as designed, polygons that both blocks carry along."""

    designed: Interfaces
    centroid: Array  # (n, 3) m, of the blocks
    linear: bool = False  # see `motion.moved_points`

    @classmethod
    def of(cls, assembly: Assembly, *, linear: bool = False) -> SolidJoints:
        """All joints of an assembly."""
        return cls(designed=assembly.interfaces, centroid=assembly.centroid, linear=linear)

    def corners(self, pose: Array) -> tuple[Array, Array]:
        """Corners of all joints on block a and on block b in the poses, two (n_corners, 3) [m]."""
        joints = self.designed
        on_a, on_b = (
            moved_points(
                joints.corners, owner[joints.joint], self.centroid, pose, linear=self.linear
            )
            for owner in (joints.block_a, joints.block_b)
        )
        return on_a, on_b

    def opening_and_slip(self, pose: Array, since: Array | None = None) -> tuple[Array, Array]:
        """Largest opening and largest slip over the corners, seen from block a, (k,) each [m].

        By which a joint was open or had slid in the poses ``since`` is taken off.
        """
        joints = self.designed
        if not len(joints.block_a):
            return np.zeros(0), np.zeros(0)
        opening, slip = self._apart(pose)
        if since is not None:
            before = self._apart(since)
            opening, slip = opening - before[0], slip - before[1]
        first = joints.offset[:-1]
        size = np.linalg.norm(slip, axis=1)
        return np.maximum.reduceat(opening, first), np.maximum.reduceat(size, first)

    def rims(self, which: BoolArray, pose: Array) -> Array:
        """Sides of the joints ``which`` (k,) on both of their blocks, (n_sides, 2, 3) [m]."""
        joints = self.designed
        after = np.arange(1, len(joints.corners) + 1)
        after[joints.offset[1:] - 1] = joints.offset[:-1]
        kept = which[joints.joint]
        return np.concatenate(
            [np.stack((on[kept], on[after[kept]]), axis=1) for on in self.corners(pose)]
        )

    def _apart(self, pose: Array) -> tuple[Array, Array]:
        """Opening (n_corners,) and slip (n_corners, 2) at the corners [m], along the normal and the
        tangents that block a carries along."""
        joints = self.designed
        on_a, on_b = self.corners(pose)
        jump = on_b - on_a
        frame = self._frames(pose)[joints.joint]
        local = np.einsum("kij,ki->kj", frame, jump)  # along normal, tangent and across
        return local[:, 0], local[:, 1:]

    def _frames(self, pose: Array) -> Array:
        """Normal, tangent and their product of every joint on block a, (k, 3, 3), in columns."""
        joints = self.designed
        normal, tangent = joints.normal, joints.tangent
        tips = np.stack((normal, tangent, np.cross(normal, tangent)), axis=1).reshape(-1, 3)
        if self.linear:  # rates: by the first order in the joint as designed
            return tips.reshape(-1, 3, 3).transpose(0, 2, 1)
        owner = np.repeat(joints.block_a, 3)
        none = np.zeros_like(self.centroid)
        still = np.array(pose)
        still[:, :3] = 0.0
        turned = moved_points(tips, owner, none, still)
        return turned.reshape(-1, 3, 3).transpose(0, 2, 1)
