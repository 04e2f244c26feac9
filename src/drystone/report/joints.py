"""Designed joints of an assembly and what became of them: closed, slid or opened.

Taken from the outlines and the poses alone, so that a joint that gapes far wider than any engine
watches its contacts is still drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.motion import moved_points
from drystone.model.assembly import Assembly


@dataclass(frozen=True, kw_only=True)
class Joints:
    """Joints of a plane assembly as designed, to be followed as its blocks move."""

    designed: Interfaces
    centroid: Array  # (n, 2) m, of the blocks
    linear: bool = False  # see `motion.moved_points`

    @classmethod
    def of(cls, assembly: Assembly, *, linear: bool = False) -> Joints:
        """All joints of an assembly."""
        return cls(designed=assembly.interfaces, centroid=assembly.centroid, linear=linear)

    def faces(self, pose: Array) -> tuple[Array, Array]:
        """Ends of each joint on block a and on block b in the poses, two (k, 2, 2) [m]."""
        ends = self.designed.ends
        face_a, face_b = (
            moved_points(
                ends.reshape(-1, 2), np.repeat(owner, 2), self.centroid, pose, linear=self.linear
            ).reshape(ends.shape)
            for owner in (self.designed.block_a, self.designed.block_b)
        )
        return face_a, face_b

    def opening_and_slip(self, pose: Array, since: Array | None = None) -> tuple[Array, Array]:
        """Largest opening and largest slip over the two ends, seen from block a, (k,) each [m].

        By which a joint was open or had slid in the poses ``since`` is taken off.
        """
        opening, slip = self._apart(pose)
        if since is not None:
            before = self._apart(since)
            opening, slip = opening - before[0], slip - before[1]
        return opening.max(axis=1), np.abs(slip).max(axis=1)

    def closing(self, pose: Array) -> Array:
        """Largest closing over the two ends in the poses, (k,) [m]; negative of an open joint."""
        opening, _ = self._apart(pose)
        return -opening.min(axis=1)

    def _apart(self, pose: Array) -> tuple[Array, Array]:
        """Opening and slip at both ends, (k, 2) each [m]."""
        face_a, face_b = self.faces(pose)
        tangent = face_a[:, 1] - face_a[:, 0]
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        outward = np.column_stack((tangent[:, 1], -tangent[:, 0]))
        jump = face_b - face_a
        opening = np.einsum("kij,kj->ki", jump, outward)
        return opening, np.einsum("kij,kj->ki", jump, tangent)
