"""All that acts on an assembly besides contacts: dead loads and pattern under a multiplier.

As blocks turn, moments of forces that act off their centroids change; on a tilting table the dead
load shrinks as the multiplier grows.  Engines take either by what is linear in the multiplier: near
a pose and a multiplier the load is dead + multiplier * pattern, and exactly that there, to the
first order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.model.assembly import Assembly
from drystone.model.loading.base import DeadLoad, LoadPattern, masses_of
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.ties import Tie

#: Share of the sizes of a pattern's forces below which their sum is none.
NO_RESULTANT = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class Acting:
    """Loads of an assembly; none on what is fixed."""

    assembly: Assembly
    dead: DeadForces  # whatever the multiplier
    pattern: DeadForces  # at multiplier one
    tilted: DeadForces | None = None
    """Dead load that shrinks with the pattern: of a multiplier l, (tilted + l pattern) / sqrt(1 +
    l^2); None for all other patterns."""
    along: Array  # (dim,) that the pattern as a whole leads along; zeros where it has no resultant
    total: float  # N, sum of the pattern's forces along that, else of their sizes

    @classmethod
    def of(
        cls,
        assembly: Assembly,
        pattern: LoadPattern,
        dead_loads: Sequence[DeadLoad] = (),
        ties: Sequence[Tie] = (),
        *,
        stage: int | None = None,
        departed: BoolArray | None = None,
    ) -> Acting:
        """Of an assembly without the blocks that are ``departed`` (n,).

        Of the dead loads only those up to a ``stage``; masses of all of them count in the pattern,
        and all ``ties``.
        """
        none = assembly.fixed if departed is None else assembly.fixed | departed
        loads = [load for load in dead_loads if stage is None or load.stage <= stage]
        steady, weights = DeadForces.none(assembly), weight_forces(assembly)
        for load in loads:
            if pattern.turns_gravity and load.mass:
                weight, rest = _split(load.forces(assembly), assembly.up)
                weights, steady = weights + weight, steady + rest
            else:
                steady = steady + load.forces(assembly)
        masses = masses_of(assembly, dead_loads, ties)
        forces = pattern.forces(assembly, masses).without(none)
        along, total = pattern.along(assembly), 0.0
        if _has_resultant(forces.force):
            total = float((forces.force @ along)[~none].sum())
        else:
            along, total = np.zeros_like(along), float(np.linalg.norm(forces.force, axis=1).sum())
            total = total or float(
                assembly.weight[~none].sum()
            )  # without any, what inertia is over
        weights, steady = weights.without(none), steady.without(none)
        if not pattern.turns_gravity:
            dead = weights + steady if loads else weights
            return cls(assembly=assembly, dead=dead, pattern=forces, along=along, total=total)
        return cls(
            assembly=assembly,
            dead=steady,
            pattern=forces,
            tilted=weights,
            along=along,
            total=total,
        )

    @property
    def steady(self) -> bool:
        """Whether loads are the same wherever blocks are, and linear in the multiplier."""
        return self.tilted is None and not (self.dead.turns or self.pattern.turns)

    def scaled(self, share: float) -> Acting:
        """With a share of the dead load."""
        tilted = None if self.tilted is None else share * self.tilted
        return replace(self, dead=share * self.dead, tilted=tilted)

    def after(self, before: Acting, share: float) -> Acting:
        """On the way to it from another dead load."""
        here, there = self.scaled(share), before.scaled(1.0 - share)
        tilted = None
        if here.tilted is not None and there.tilted is not None:
            tilted = there.tilted + here.tilted
        return replace(self, dead=there.dead + here.dead, tilted=tilted)

    def near(self, pose: Array, multiplier: float) -> tuple[Array, Array]:
        """Dead load and pattern (n, n_dof) [N, N m] in a pose (n, n_pose), near a multiplier.

        Their sum, the latter times the multiplier, is the load, and the latter how the load grows.
        """
        dead, pattern = (f.wrenches(self.assembly, pose) for f in (self.dead, self.pattern))
        if self.tilted is None:
            return dead, pattern
        tilted, cosine = self.tilted.wrenches(self.assembly, pose), _cosine(multiplier)
        load = cosine * (tilted + multiplier * pattern)
        growth = cosine**3 * (pattern - multiplier * tilted)
        return dead + load - multiplier * growth, growth

    def stiffness(self, pose: Array, multiplier: float) -> Array:
        """By how much moments fall as blocks turn on, (n, n_rot, n_rot) [N m]."""
        if self.tilted is None:
            dead, scaled = self.dead, multiplier * self.pattern
        else:
            cosine = _cosine(multiplier)
            dead, scaled = self.dead, cosine * (self.tilted + multiplier * self.pattern)
        return sum(
            (part.stiffness(self.assembly, pose) for part in (dead, scaled) if part.turns),
            np.zeros(()),
        )


def weight_forces(assembly: Assembly) -> DeadForces:
    """The weight of every block."""
    return DeadForces(force=-assembly.weight[:, None] * assembly.up)


def dead_load(assembly: Assembly) -> Array:
    """Generalised forces of gravity, (n, n_dof) [N, N m]; zero on supports."""
    return weight_forces(assembly).without(assembly.fixed).wrenches(assembly)


def _cosine(multiplier: float) -> float:
    return 1.0 / math.sqrt(1.0 + multiplier * multiplier)


def _has_resultant(force: Array) -> bool:
    sizes = float(np.linalg.norm(force, axis=1).sum())
    return bool(np.linalg.norm(force.sum(axis=0)) > NO_RESULTANT * sizes)


def _split(forces: DeadForces, up: Array) -> tuple[DeadForces, DeadForces]:
    """What of the forces is vertical, and the rest."""
    vertical = np.outer(up, up)
    lever = None if forces.lever is None else forces.lever @ vertical
    part = DeadForces(force=forces.force @ vertical, lever=lever)
    return part, forces + (-1.0) * part
