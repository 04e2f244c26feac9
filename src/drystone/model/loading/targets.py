"""Which blocks a load is on, and at which points of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.keys import Key, Text
from drystone.common.names import quoted, there_is_no
from drystone.model.assembly import Assembly
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.scale import Scale

#: Points of a block that have names: its centroid, the middle of its highest vertices.
CENTRE, TOP = "centre", "top"
POINTS = (CENTRE, TOP)

#: Relative size under which heights are the same, and a point is on a block.
SAME = 1e-6

#: Keys that name one in a file.
TARGET_KEYS = (
    Key(name="block", type=Text(), default=None),
    Key(name="group", type=Text(), default=None),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """A block, or all movable blocks of a group: one of the two is named."""

    block: str | None = None
    group: str | None = None

    def rows(self, assembly: Assembly) -> IntArray:
        """Rows of the blocks, supports left out."""
        if self.block is not None:
            return np.array([assembly.index(self.block)], np.int64)
        rows = assembly.groups[self.group or ""]
        return rows[~assembly.fixed[rows]]

    def target_problems(self, assembly: Assembly, place: str) -> list[str]:
        """Sentences on names that nothing movable goes by."""
        if (self.block is None) == (self.group is None):
            has = "neither block nor group" if self.block is None else "both block and group"
            return [f"{place}: has {has}: give one of them"]
        if self.block is not None:
            if self.block not in assembly.ids:
                return [f"{place}.block: {there_is_no('block', self.block, assembly.ids)}"]
            if assembly.fixed[assembly.index(self.block)]:
                return [f'{place}.block: "{self.block}" is a support: name a movable block']
            return []
        if self.group not in assembly.groups:
            return [f"{place}.group: {there_is_no('group', self.group or '', assembly.groups)}"]
        if not len(self.rows(assembly)):
            return [f'{place}.group: all blocks of "{self.group}" are supports']
        return []

    def target_keys(self) -> dict[str, Any]:
        """As in a model file."""
        return {"group": self.group} if self.block is None else {"block": self.block}


@dataclass(frozen=True, kw_only=True, eq=False)
class PointForce(Target):
    """A force of fixed direction at a point of a block, or of each block of a group."""

    force: Array  # (dim,) N, on each block
    point: str | Array = CENTRE  # a name of `POINTS`, or (dim,) m, on the block as designed

    def points(self, assembly: Assembly) -> Array:
        """Where it acts on each of its blocks, (m, dim) [m]."""
        if not isinstance(self.point, str):
            return np.asarray(self.point, float)[None]
        rows = self.rows(assembly)
        if self.point == CENTRE:
            return assembly.centroid[rows]
        return np.array([_top(assembly, i) for i in rows])

    def forces(self, assembly: Assembly) -> DeadForces:
        """Forces on the blocks."""
        rows = self.rows(assembly)
        force = np.broadcast_to(self.force, (len(rows), assembly.dimension))
        return DeadForces.at_points(assembly, rows, self.points(assembly), force)

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `LoadPattern`."""
        point = self.point if isinstance(self.point, str) else vector(self.point, point=True)
        return replace(self, force=vector(self.force), point=point)

    def in_frame(self, scale: Scale) -> Self:
        """See `LoadPattern`."""
        point = self.point if isinstance(self.point, str) else scale.place(self.point)
        return replace(self, force=scale.forces(self.force), point=point)

    def point_problems(self, assembly: Assembly, place: str) -> list[str]:
        """Sentences on what keeps it from acting on an assembly."""
        found = self.target_problems(assembly, place)
        if np.shape(self.force) != (assembly.dimension,):
            found.append(f"{place}.force: must have {assembly.dimension} entries")
        if found or (isinstance(self.point, str) and self.point in POINTS):
            return found
        if isinstance(self.point, str):
            names = '" or "'.join(POINTS)
            return [f'{place}.point: there is no point {quoted(self.point)}: take "{names}"']
        if self.block is None:
            return [f"{place}.point: the blocks of a group have no point in common: name a block"]
        row = assembly.index(self.block)
        size = float(np.ptp(assembly.blocks[row].vertices, axis=0).max())
        given = np.asarray(self.point, float)
        if given.shape != (assembly.dimension,) or not (
            assembly.figures[row].distance(given) <= SAME * size
        ):
            return [f'{place}.point: is not on block "{self.block}": move it onto the block']
        return []

    def point_keys(self) -> dict[str, Any]:
        """As in a model file."""
        point = self.point if isinstance(self.point, str) else np.asarray(self.point).tolist()
        return {**self.target_keys(), "point": point, "force": np.asarray(self.force).tolist()}


def _top(assembly: Assembly, i: int) -> Array:
    vertices = assembly.blocks[i].vertices
    height = vertices @ assembly.up
    highest = vertices[height >= height.max() - SAME * float(np.ptp(vertices, axis=0).max())]
    return np.asarray(np.unique(highest, axis=0).mean(axis=0))
