"""Supports that move: a settlement or a rotation of support blocks as what paces an analysis.

The blocks go on as one rigid body, all other supports stay.  What they give way to is the
*reaction*: the force along their motion, or the moment about its axis, with which the structure
drives them on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.geometry import motion

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Scale(Protocol):
    """What takes a drawing to other coordinates and units; see `frame`."""

    def place(self, points: Array) -> Array:
        """Points (..., dim) [m]."""
        ...

    def extension(self, extension: float) -> float:
        """A length [m]."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Settlement:
    """How support blocks move: along a direction, or about a centre.

    A rotation is counter-clockwise in the plane, and in space right-handed about an axis through
    the centre.
    """

    blocks: tuple[str, ...] = ()
    group: str | None = None  # all of its supports, instead of blocks
    direction: Array | None = None  # (dim,) unit vector
    centre: Array | None = None  # (dim,) m
    axis: Array | None = None  # (3,) unit vector, of a rotation in space
    clockwise: bool = False  # of a rotation in the plane
    largest: float  # m, or rad

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

        def listed(values: Array | None) -> str:
            return ", ".join(f"{x:g}" for x in ([] if values is None else values))

        who = f'group "{self.group}"' if self.group else ", ".join(f'"{b}"' for b in self.blocks)
        if not self.rotates:
            return f"settlement of {who} along ({listed(self.direction)})"
        return f"rotation of {who} about ({listed(self.centre)})"

    def rows(self, assembly: Assembly) -> IntArray:
        """Of its blocks."""
        if self.group is None:
            return np.array([assembly.index(name) for name in self.blocks], np.int64)
        rows = assembly.groups[self.group]
        return rows[assembly.fixed[rows]]

    def target(self, assembly: Assembly, amount: float) -> Array:
        """Poses (k, n_pose) of its blocks once they have gone by an amount [m, rad]."""
        rows = self.rows(assembly)
        pose = assembly.rest_pose()[rows]
        if self.direction is not None:
            motion.translations(pose)[:] = amount * self.direction
            return pose
        if assembly.dimension == 2:
            pose[:, 2] = -amount if self.clockwise else amount
        else:
            pose[:, 3] = math.cos(0.5 * amount)
            pose[:, 4:] = math.sin(0.5 * amount) * np.asarray(self.axis)
        arm = assembly.centroid[rows] - np.asarray(self.centre)
        dim = assembly.dimension
        pose[:, :dim] = motion.turned(arm, pose) - arm
        return pose

    def increment(self, assembly: Assembly, pose: Array, amount: float) -> Array:
        """Increments (n, n_dof) from poses (n, n_pose) to where its blocks have gone by an amount;
        zero for all others."""
        there = pose.copy()
        there[self.rows(assembly)] = self.target(assembly, amount)
        return assembly.difference(there, pose)

    def reaction(self, assembly: Assembly, pose: Array, force: Array) -> float:
        """Of forces (n, n_dof) on the bodies in poses (n, n_pose) [N, or N m]."""
        rows, dim = self.rows(assembly), assembly.dimension
        pushed = force[rows, :dim]
        if self.direction is not None:
            return float((pushed @ self.direction).sum())
        arm = motion.places(assembly.centroid, pose)[rows] - np.asarray(self.centre)
        about = motion.moments(arm, pushed)
        if dim == 2:
            total = float((about[:, 0] + force[rows, 2]).sum())
            return -total if self.clockwise else total
        axes = np.stack(
            [motion.turned(assembly.axes[rows][:, :, k], pose[rows]) for k in range(3)], axis=2
        )
        about = about + np.einsum("nij,nj->ni", axes, force[rows, 3:])
        return float((about @ np.asarray(self.axis)).sum())

    def in_frame(self, scale: Scale) -> Self:
        """The settlement in other coordinates and units."""
        if self.centre is None:
            return replace(self, largest=scale.extension(self.largest))
        return replace(self, centre=scale.place(self.centre))

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """That of a plane model as solids; ``vector`` takes vectors to space."""
        if self.direction is not None:
            return replace(self, direction=vector(self.direction))
        # Counter-clockwise as seen with x to the right and z up: about minus y.
        axis = np.array([0.0, 1.0 if self.clockwise else -1.0, 0.0])
        centre = vector(self.centre, point=True)
        return replace(self, centre=centre, axis=axis, clockwise=False)

    def problems(self, assembly: Assembly) -> list[str]:
        """What keeps it from acting on an assembly, a sentence each."""
        found = []
        if (self.group is None) == (not self.blocks):
            found.append("settlement: give blocks or group, the supports that move")
        for name in self.blocks:
            if name not in assembly.ids:
                found.append(f'settlement.blocks: there is no block "{name}"')
            elif not assembly.fixed[assembly.index(name)]:
                found.append(f'settlement.blocks: "{name}" is no support: set support = true')
        if self.group is not None and self.group not in assembly.groups:
            found.append(f'settlement.group: there is no group "{self.group}"')
        elif self.group is not None and not len(self.rows(assembly)):
            found.append(f'settlement.group: there is no support in "{self.group}"')
        if (self.direction is None) == (self.centre is None):
            found.append("settlement: give direction, or the centre of a rotation")
        if (self.axis is not None) != (self.rotates and assembly.dimension == 3):
            found.append("settlement.axis: belongs to a rotation in space, and only there")
        if not 0.0 < self.largest < math.inf:
            found.append("settlement.max: must be greater than 0")
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
        largest = math.degrees(self.largest) if self.rotates else self.largest
        return {**who, **vectors, **turned, "max": float(f"{largest:.12g}")}
