"""Support displacement: a settlement or a rotation of support blocks, in place of a load.

The blocks move as one rigid body; all other supports stay.  The *reaction* is the force along their
motion, or the moment about its axis, with which the structure drives them on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.errors import ModelError
from drystone.common.language import say
from drystone.common.names import there_is_no
from drystone.common.vectors import direction_of, vector
from drystone.geometry import motion
from drystone.model.assembly import Assembly
from drystone.model.scale import Scale


@dataclass(frozen=True, kw_only=True, eq=False)
class Settlement:
    """How support blocks move: along a direction, or about a centre.

    A rotation is counter-clockwise in the plane, and in space right-handed about an axis through
    the centre.  Names and units are those of model files; vectors may be any numbers in a row.

    Raises `ModelError` where what is given makes no motion.
    """

    blocks: tuple[str, ...] = ()
    group: str | None = None  # all of its supports, instead of blocks
    direction: Array | None = None  # (dim,) unit vector
    centre: Array | None = None  # (dim,) m
    axis: Array | None = None  # (3,) unit vector, of a rotation in space
    clockwise: bool = False  # of a rotation in the plane
    max: float  # how far they go: m, or degrees about a centre

    def __post_init__(self) -> None:
        def put(key: str, value: Any) -> None:
            object.__setattr__(self, key, value)

        put("blocks", (self.blocks,) if isinstance(self.blocks, str) else tuple(self.blocks))
        if self.centre is not None:
            put("centre", vector(self.centre, "settlement.centre"))
        for key in ("direction", "axis"):
            if (given := getattr(self, key)) is not None:
                put(key, direction_of(given, f"settlement.{key}"))
        found = []
        if (self.group is None) == (not self.blocks):
            found.append("settlement: give blocks or group, the supports that move")
        if (self.direction is None) == (self.centre is None):
            found.append("settlement: give direction, or the centre of a rotation")
        if not 0.0 < self.max < math.inf:
            found.append("settlement.max: must be greater than 0")
        if found:
            raise ModelError(found)

    @property
    def largest(self) -> float:
        """How far they go [m, or rad]."""
        return math.radians(self.max) if self.rotates else self.max

    @property
    def rotates(self) -> bool:
        """Whether it is a rotation."""
        return self.direction is None

    @property
    def unit(self) -> str:
        """Of its amount."""
        return "rad" if self.rotates else "m"

    @property
    def words(self) -> str:
        """What it is, for people."""

        def listed(values: Array | None) -> list[float]:
            return [] if values is None else [float(x) for x in values]

        who = say("load.group", name=self.group) if self.group else [f'"{b}"' for b in self.blocks]
        if not self.rotates:
            return say("load.settlement", who=who, direction=listed(self.direction))
        return say("load.rotation", who=who, centre=listed(self.centre))

    def rows(self, assembly: Assembly) -> IntArray:
        """Of its blocks."""
        if self.group is None:
            return np.array([assembly.index(name) for name in self.blocks], np.int64)
        rows = assembly.groups[self.group]
        return rows[assembly.fixed[rows]]

    def lever(self, assembly: Assembly) -> float:
        """Distance [m] from the axis of a rotation to the farthest vertex of what turns."""
        corners = np.vstack([assembly.blocks[i].vertices for i in self.rows(assembly)])
        arm = corners - np.asarray(self.centre)
        if self.axis is not None:
            arm = arm - np.outer(arm @ self.axis, self.axis)
        return float(np.linalg.norm(arm, axis=1).max())

    def target(self, assembly: Assembly, amount: float) -> Array:
        """Poses (k, n_pose) of its blocks once they have moved by an amount [m, rad]."""
        rows = self.rows(assembly)
        pose = assembly.design_pose()[rows]
        if self.direction is not None:
            motion.translations(pose)[:] = amount * self.direction
            return pose
        angle = -amount if self.clockwise else amount
        motion.rotated_by(pose, angle, None if self.axis is None else np.asarray(self.axis))
        arm = assembly.centroid[rows] - np.asarray(self.centre)
        motion.translations(pose)[:] = motion.rotated(arm, pose) - arm
        return pose

    def increment(self, assembly: Assembly, pose: Array, amount: float) -> Array:
        """Increments (n, n_dof) from poses (n, n_pose) to where its blocks have moved by an amount;
        zero for all others."""
        there = pose.copy()
        there[self.rows(assembly)] = self.target(assembly, amount)
        return assembly.difference(there, pose)

    def reaction(self, assembly: Assembly, pose: Array, force: Array) -> float:
        """Of forces (n, n_dof) on the bodies in poses (n, n_pose) [N, or N m]."""
        rows = self.rows(assembly)
        pushed = motion.translations(force[rows])
        if self.direction is not None:
            return float((pushed @ self.direction).sum())
        arm = motion.places(assembly.centroid, pose)[rows] - np.asarray(self.centre)
        about = motion.moments(arm, pushed)
        n_axes = assembly.axes.shape[2]
        axes = np.stack(
            [motion.rotated(assembly.axes[rows][:, :, k], pose[rows]) for k in range(n_axes)],
            axis=2,
        )
        about = about + motion.about_the_world(motion.rotations(force[rows]), axes)
        if self.axis is not None:
            return float((about @ np.asarray(self.axis)).sum())
        total = float(about[:, 0].sum())
        return -total if self.clockwise else total

    def in_frame(self, scale: Scale) -> Self:
        """The settlement in other coordinates and units."""
        if self.centre is None:
            return replace(self, max=scale.extension(self.max))
        return replace(self, centre=scale.place(self.centre))

    def in_space(self, into: Callable[..., Array]) -> Self:
        """That of a plane model as solids; ``into`` takes vectors to space."""
        if self.direction is not None:
            return replace(self, direction=into(self.direction))
        # Counter-clockwise as seen with x to the right and z up: about minus y.
        axis = np.array([0.0, 1.0 if self.clockwise else -1.0, 0.0])
        centre = into(self.centre, point=True)
        return replace(self, centre=centre, axis=axis, clockwise=False)

    def problems(self, assembly: Assembly) -> list[str]:
        """What keeps it from acting on an assembly, a sentence each."""
        found = []
        for name in self.blocks:
            if name not in assembly.ids:
                found.append(f"settlement.blocks: {there_is_no('block', name, assembly.ids)}")
            elif not assembly.fixed[assembly.index(name)]:
                found.append(f'settlement.blocks: "{name}" is no support: set support = true')
        if self.group is not None and self.group not in assembly.groups:
            found.append(f"settlement.group: {there_is_no('group', self.group, assembly.groups)}")
        elif self.group is not None and not len(self.rows(assembly)):
            found.append(f'settlement.group: there is no support in "{self.group}"')
        for key in ("direction", "centre"):
            given = getattr(self, key)
            if given is not None and len(given) != assembly.dimension:
                found.append(f"settlement.{key}: must have {assembly.dimension} entries")
        if (self.axis is not None) != (self.rotates and assembly.dimension == 3):
            found.append("settlement.axis: belongs to a rotation in space, and only there")
        elif self.axis is not None and len(self.axis) != 3:
            found.append("settlement.axis: must have 3 entries")
        return found

    def keys(self) -> dict[str, Any]:
        """As in a model file."""
        who = {"blocks": list(self.blocks)} if self.group is None else {"group": self.group}
        vectors = {
            key: np.asarray(value).tolist()
            for key in ("direction", "centre", "axis")
            if (value := getattr(self, key)) is not None
        }
        turned = {"clockwise": True} if self.clockwise else {}
        return {**who, **vectors, **turned, "max": float(self.max)}
