"""Velocities of blocks on a branch of a curve, per unit of the control point's velocity.

The chord between two states of a body is a rigid velocity field to the last bit: with the angle
between them, theta about the axis n, every point x goes by 2 tan(theta / 2) n x (x_m - o), x_m
halfway between where it was and where it is.  A velocity field of a body, its twist, may therefore
be read off states that lie far apart, and be asked for at other points than it was found at.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry import motion
from drystone.model.assembly import Assembly
from drystone.model.monitor import ControlPoint

#: Control velocity, over the largest of a block, below which a field moves past its control point.
STILL = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class VelocityField:
    """A rigid velocity field for each block."""

    place: Array  # (n, dim) m, of the centroids
    velocity: Array  # (n, dim) of the centroids, over the control point's velocity
    spin: Array  # (n, 1) 1/m, or in space (n, 3) about axes of the world

    def at(self, points: Array, owner: IntArray) -> Array:
        """Velocities (k, dim) of points (k, dim) [m] of blocks ``owner`` (k,)."""
        return self.velocity[owner] + motion.across(self.spin[owner], points - self.place[owner])

    def carried_to(self, place: Array) -> VelocityField:
        """The same motions in space, read at other centroids (n, dim) [m]."""
        everyone = np.arange(len(place))
        return VelocityField(place=place, velocity=self.at(place, everyone), spin=self.spin)

    def along(self, direction: Array) -> Array:
        """Components along a direction (dim,): the shape, (n,)."""
        return np.asarray(self.velocity @ direction)

    def over(
        self, control: ControlPoint, point: Array, *, still: float = STILL
    ) -> VelocityField | None:
        """The field over the velocity of the control point, which is at ``point`` (dim,) [m]; None
        where that is no more than the share ``still`` of the largest of a block."""
        (velocity,) = self.at(point[None], np.array([control.block]))
        speed = float(velocity @ control.direction)
        if not abs(speed) > still * float(np.abs(self.velocity).max(initial=0.0)):
            return None
        return VelocityField(
            place=self.place, velocity=self.velocity / speed, spin=self.spin / speed
        )


def chord(assembly: Assembly, before: Array, after: Array) -> VelocityField:
    """The field that leads from the poses ``before`` (n, n_pose) to ``after``, not scaled [m]."""
    velocity = motion.translations(after) - motion.translations(before)
    place = assembly.centroid + 0.5 * (motion.translations(after) + motion.translations(before))
    return VelocityField(
        place=np.ascontiguousarray(place), velocity=velocity, spin=motion.chord_spin(before, after)
    )


def less(field: VelocityField, other: VelocityField, share: float) -> VelocityField:
    """A field without ``share`` of another one of the same blocks."""
    return VelocityField(
        place=field.place,
        velocity=field.velocity - share * other.velocity,
        spin=field.spin - share * other.spin,
    )
