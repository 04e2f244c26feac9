"""The structure's own coordinates and units, which do not depend on the drawing's place and unit.

Coordinates are doubles: 10,000 km from the origin only some eight decimals of a metre are left, and
differences of places are no more precise.  Engines have tolerances in metres, seconds and newtons.
So engines are given the structure in its own frame.  The origin is the lower corner of the
structure.  The smallest block is as large, and the heaviest material as heavy, as those of the
published walls.  Gravity stays the same, so that times scale with the square root of lengths.

Decimal coordinates of the drawing are restored exactly.  A double is replaced by the decimal number
within its rounding, if there is one with few enough decimals.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.records import changed
from drystone.common.tolerances import FRAME_SIZE, FRAME_UNIT_WEIGHT, SAME_PLACE
from drystone.contact.forces import ContactForces
from drystone.geometry import motion
from drystone.model.assembly import Assembly
from drystone.model.joint_law import JointLaw
from drystone.model.monitor import ControlPoint
from drystone.model.ties import TieState

#: Significant digits of a quotient that are kept; further digits are rounding.
DIGITS = 13


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Converts an assembly to its own coordinates and units, and results back."""

    origin: Array  # (dim,) m, lower corner of the box around all blocks
    place_noise: float  # m, rounding of the drawing's coordinates
    length: float  # m, own unit of length
    depth: float  # m, unit of the thickness; in three dimensions that of length
    unit_weight: float  # N/m3, own unit of weight

    @classmethod
    def of(cls, assembly: Assembly, *, scaled: bool = True) -> Frame:
        """The frame of an assembly.  Without ``scaled``, only the origin changes, not the units."""
        vertices = np.vstack([block.vertices for block in assembly.blocks])
        noise = float(np.spacing(np.abs(vertices).max()))
        origin = vertices.min(axis=0)
        movable = [block for block in assembly.blocks if not block.support]
        if not scaled or not movable:
            return cls(origin=origin, place_noise=noise, length=1.0, depth=1.0, unit_weight=1.0)
        extents = assembly.extents[~assembly.fixed]
        length = float(typed(extents, noise).min()) / FRAME_SIZE
        return cls(
            origin=origin,
            place_noise=noise,
            length=length,
            depth=length if assembly.depth is None else assembly.depth,
            unit_weight=plain(max(block.unit_weight for block in movable) / FRAME_UNIT_WEIGHT),
        )

    @property
    def size(self) -> float:
        """`Assembly.smallest_extent` [m]; only if units are scaled."""
        return plain(FRAME_SIZE * self.length)

    @property
    def time(self) -> float:
        """Own unit of time [s]."""
        return math.sqrt(self.length)

    @property
    def area(self) -> float:
        """Own unit of joint area [m2]."""
        return self.length * self.depth

    @property
    def force(self) -> float:
        """Own unit of force [N]."""
        return self.unit_weight * self.area * self.length

    def place(self, points: Array) -> Array:
        """Points of the drawing (..., dim) [m] in own coordinates."""
        own = typed(np.asarray(points, float) - self.origin, self.place_noise) / self.length
        return typed(own, 2.0 * float(np.spacing(np.abs(own).max(initial=1.0))))

    @staticmethod
    def order(own: Assembly, control: ControlPoint) -> IntArray:
        """Rows of the blocks, (n,), ordered by their place, for an assembly in own coordinates.

        The rounding of a sum depends on the order of its terms, and if blocks slide or jump,
        rounding may decide their direction.  The result should depend neither on the order in which
        a drawing lists its blocks, nor on the orientation of the drawing.  So blocks are ordered by
        their height, then along the control displacement, then from its left to its right.  If the
        control displacement is vertical, the distance from the control point decides; last come the
        coordinates.
        """
        up, forward = own.up, control.direction
        keys = [own.centroid @ up, own.centroid @ forward]
        keys += [own.centroid @ across for across in motion.across_both(forward, up)]
        keys += [np.linalg.norm(own.centroid - control.point, axis=1), *own.centroid.T]
        return np.lexsort([_ranks(key) for key in reversed(keys)])

    def assembly(self, drawn: Assembly) -> Assembly:
        """The assembly in own coordinates and units."""
        corner = drawn.corner
        last = np.cumsum([len(block.vertices) for block in drawn.blocks])[:-1]
        shapes = np.split(self.place(np.vstack([b.vertices for b in drawn.blocks])), last)
        return replace(
            drawn,
            blocks=tuple(
                replace(
                    block.with_vertices(vertices),
                    unit_weight=plain(block.unit_weight / self.unit_weight),
                )
                for block, vertices in zip(drawn.blocks, shapes, strict=True)
            ),
            joint=self._law(drawn.joint),
            corner=replace(
                corner,
                radius=corner.radius and plain(corner.radius / self.length),
                chamfer=corner.chamfer and plain(corner.chamfer / self.length),
            ),
            thickness=1.0 if drawn.depth is None else plain(drawn.depth / self.depth),
            joint_between={names: self._law(law) for names, law in drawn.joint_between.items()},
        )

    def _law(self, law: JointLaw) -> JointLaw:
        """A joint law in own units.  The unit of strength is unit weight times length, that of
        stiffness (Pa/m) is unit weight."""
        strength = self.unit_weight * self.length
        units = {
            "Pa/m": self.unit_weight,
            "Pa": strength,
            "N/m": strength * self.length,
            "m": self.length,
        }
        return law.in_units(lambda value, unit: plain(value / units[unit]))

    def control_point(self, drawn: ControlPoint) -> ControlPoint:
        """The control point in own coordinates."""
        return replace(drawn, point=self.place(drawn.point))

    def forces(self, drawn: Array) -> Array:
        """Forces (..., dim) [N] in own units."""
        own: Array = np.vectorize(plain, otypes=[float])(np.asarray(drawn, float) / self.force)
        return own

    def extension(self, drawn: float) -> float:
        """A length [m] in own units."""
        return plain(drawn / self.length)

    def spring(self, drawn: float) -> float:
        """A stiffness [N/m] in own units."""
        return plain(drawn * self.length / self.force)

    def ties_of(self, own: TieState) -> TieState:
        """The state of ties with forces in newtons and elongations in metres."""
        return changed(
            own,
            plastic=self.length * own.plastic,
            force=self.force * own.force,
            elongation=self.length * own.elongation,
        )

    def height(self, drawn: float) -> float:
        """A height [m] in own coordinates."""
        return plain((drawn - float(self.origin[-1])) / self.length)

    def pressure(self, drawn: float) -> float:
        """A pressure [Pa] in own units."""
        return plain(drawn / (self.unit_weight * self.length))

    def weight(self, drawn: float) -> float:
        """A unit weight [N/m3] in own units."""
        return plain(drawn / self.unit_weight)

    def pose_of(self, own: Array) -> Array:
        """Poses (n, n_pose) in metres."""
        pose = own.copy()
        pose[:, : len(self.origin)] *= self.length
        return pose

    def contacts_of(self, own: ContactForces) -> ContactForces:
        """Contact points in the drawing's coordinates, forces in newtons."""
        return changed(
            own,
            position=self.origin + self.length * own.position,
            gap=self.length * own.gap,
            area=self.area * own.area,
            normal_reaction=self.force * own.normal_reaction,
            tangential_reaction=self.force * own.tangential_reaction,
        )


def _ranks(values: Array) -> IntArray:
    """Ranks (n,) of lengths (n,) in own units; neighbours nearer than `SAME_PLACE` share a rank."""
    order = np.argsort(values, kind="stable")
    ranks = np.empty(len(values), np.int64)
    ranks[order] = np.cumsum(np.diff(values[order], prepend=values[order[:1]]) > SAME_PLACE)
    return ranks


def typed(values: Array, noise: float) -> Array:
    """Replace values that are decimal numbers but for a rounding of ``noise`` by these numbers.

    The last decimal place is ten to a hundred times the noise.  A value that is not such a number
    is kept, so that no value changes by more than its rounding.
    """
    decimals = math.floor(-math.log10(noise)) - 1
    rounded = np.round(values, decimals)
    return np.where(np.abs(rounded - values) <= 2.0 * noise, rounded, values)


def plain(value: float) -> float:
    """A quotient or product rounded to `DIGITS` significant digits."""
    return float(f"{value:.{DIGITS - 1}e}")
