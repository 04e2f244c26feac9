"""Dead loads beside the blocks' weight: forces at points, surcharge, what lies and leans on faces.

They keep their direction and stay at the points of the blocks where they were applied, so that
their moments change as blocks turn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from drystone.common.arrays import Array
from drystone.common.vectors import direction_of
from drystone.model.assembly import Assembly
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.loading.faces import Traction, faces_towards, has_faces
from drystone.model.loading.targets import CENTRE, PointForce, Target
from drystone.model.scale import Scale

#: Angle to a side up to which faces look there [degrees], where nothing is said.
WITHIN = 45.0


@dataclass(frozen=True, kw_only=True, eq=False)
class _Dead:
    """What all have in common."""

    kind: ClassVar[str]
    mass: bool  # whether its downward part is the weight of a mass, which counts in patterns
    name: str = ""
    stage: int = 1  # 0: comes with the blocks' weight; else after what has a lower one

    def common_keys(self) -> dict[str, Any]:
        """As in a model file."""
        named = {"name": self.name} if self.name else {}
        return {"kind": self.kind, **named, "mass": self.mass, "stage": self.stage}


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceLoad(PointForce, _Dead):
    """A force at a point of a block, or of each block of a group."""

    kind: ClassVar[str] = "force"

    def problems(self, assembly: Assembly, place: str) -> list[str]:
        """See `DeadLoad`."""
        return self.point_problems(assembly, place)

    def keys(self) -> dict[str, Any]:
        """See `DeadLoad`."""
        return {**self.common_keys(), **self.point_keys()}


@dataclass(frozen=True, kw_only=True, eq=False)
class SurchargeLoad(Target, _Dead):
    """A weight spread over the blocks of a target in proportion to their volume."""

    kind: ClassVar[str] = "surcharge"
    weight: float  # N, of all together
    point: str = CENTRE  # of each block: its centre, or the middle of its top

    def forces(self, assembly: Assembly) -> DeadForces:
        """See `DeadLoad`."""
        rows = self.rows(assembly)
        share = assembly.volume[rows] / assembly.volume[rows].sum()
        force = -self.weight * share[:, None] * assembly.up
        points = PointForce(
            block=self.block, group=self.group, point=self.point, force=assembly.up
        ).points(assembly)
        return DeadForces.at_points(assembly, rows, points, force)

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `DeadLoad`."""
        return self

    def in_frame(self, scale: Scale) -> Self:
        """See `DeadLoad`."""
        return replace(self, weight=float(scale.forces(np.array([self.weight]))[0]))

    def problems(self, assembly: Assembly, place: str) -> list[str]:
        """See `DeadLoad`."""
        at = PointForce(block=self.block, group=self.group, point=self.point, force=assembly.up)
        return at.point_problems(assembly, place)

    def keys(self) -> dict[str, Any]:
        """See `DeadLoad`."""
        return {
            **self.common_keys(),
            **self.target_keys(),
            "weight": self.weight,
            "point": self.point,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class _OnFaces(Target, _Dead):
    """Of the free faces that look to a side."""

    side: Array  # (dim,) unit vector, of any length when given
    within: float = WITHIN  # degrees, largest angle between a face's normal and the side

    def __post_init__(self) -> None:
        object.__setattr__(self, "side", direction_of(self.side, "dead_load.side"))

    def traction(self, assembly: Assembly) -> Traction:
        """What acts on an area."""
        raise NotImplementedError

    def forces(self, assembly: Assembly) -> DeadForces:
        """See `DeadLoad`."""
        faces = faces_towards(assembly, self.rows(assembly), self.side, self.within)
        return faces.forces(assembly, self.traction(assembly))

    def problems(self, assembly: Assembly, place: str) -> list[str]:
        """See `DeadLoad`."""
        found = self.target_problems(assembly, place)
        if np.shape(self.side) != (assembly.dimension,):
            found.append(f"{place}.side: must have {assembly.dimension} entries")
        if found:
            return found
        if several := [assembly.ids[i] for i in self.rows(assembly) if not has_faces(assembly, i)]:
            return [
                f'{place}: block "{several[0]}" is made of several parts, whose faces are not '
                'told from the joints between them: take kind = "force", or one outline'
            ]
        faces = faces_towards(assembly, self.rows(assembly), self.side, self.within)
        if not faces.area(assembly) > 0.0:
            found.append(f"{place}.side: no free face looks there: choose another")
        return found

    def face_keys(self) -> dict[str, Any]:
        """As in a model file."""
        return {
            **self.common_keys(),
            **self.target_keys(),
            "side": np.asarray(self.side).tolist(),
            "within": self.within,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceLoad(_OnFaces):
    """A load spread evenly over free faces: by area, or by how much it is in all."""

    kind: ClassVar[str] = "face"
    pressure: Array | None = None  # (dim,) Pa, force of fixed direction over area
    total: Array | None = None  # (dim,) N, of all faces together

    def traction(self, assembly: Assembly) -> Traction:
        """See above."""
        if self.pressure is not None:
            return Traction(even=np.asarray(self.pressure, float))
        faces = faces_towards(assembly, self.rows(assembly), self.side, self.within)
        return Traction(even=np.asarray(self.total, float) / faces.area(assembly))

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `DeadLoad`."""
        return replace(
            self,
            side=vector(self.side),
            pressure=None if self.pressure is None else vector(self.pressure),
            total=None if self.total is None else vector(self.total),
        )

    def in_frame(self, scale: Scale) -> Self:
        """See `DeadLoad`."""
        if self.pressure is None:
            return replace(self, total=scale.forces(np.asarray(self.total)))
        return replace(self, pressure=np.array([scale.pressure(p) for p in self.pressure]))

    def problems(self, assembly: Assembly, place: str) -> list[str]:
        """See `DeadLoad`."""
        if (self.pressure is None) == (self.total is None):
            has = "neither pressure [Pa] nor total [N]"
            if self.total is not None:
                has = "both pressure and total"
            return [f"{place}: has {has}: give one of them"]
        key, load = ("total", self.total) if self.pressure is None else ("pressure", self.pressure)
        if np.asarray(load).shape != (assembly.dimension,):
            return [f"{place}.{key}: must have {assembly.dimension} entries"]
        return super().problems(assembly, place)

    def keys(self) -> dict[str, Any]:
        """See `DeadLoad`."""
        key, load = ("total", self.total) if self.pressure is None else ("pressure", self.pressure)
        return {**self.face_keys(), key: np.asarray(load).tolist()}


@dataclass(frozen=True, kw_only=True, eq=False)
class FillLoad(_OnFaces):
    """Loose fill at rest against free faces, up to a level: its weight above, its thrust aside.

    In a depth d below the level the stress is g d upright and K g d sideways.
    """

    kind: ClassVar[str] = "fill"
    unit_weight: float  # N/m3
    level: float  # m, height of its surface
    at_rest: float  # K, sideways over upright stress

    def traction(self, assembly: Assembly) -> Traction:
        """See above."""
        return Traction(unit_weight=self.unit_weight, level=self.level, at_rest=self.at_rest)

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `DeadLoad`."""
        return replace(self, side=vector(self.side))

    def in_frame(self, scale: Scale) -> Self:
        """See `DeadLoad`."""
        return replace(
            self, unit_weight=scale.weight(self.unit_weight), level=scale.height(self.level)
        )

    def problems(self, assembly: Assembly, place: str) -> list[str]:
        """See `DeadLoad`."""
        found = super().problems(assembly, place)
        if not found and not self.forces(assembly).force.any():
            found = [f"{place}.level: lies below the faces: raise it"]
        return found

    def keys(self) -> dict[str, Any]:
        """See `DeadLoad`."""
        return {
            **self.face_keys(),
            "unit_weight": self.unit_weight,
            "level": self.level,
            "at_rest": self.at_rest,
        }


#: By the names of their kinds in model files.
KINDS = {kind.kind: kind for kind in (ForceLoad, SurchargeLoad, FaceLoad, FillLoad)}
