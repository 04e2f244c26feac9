"""The contracts of load patterns and dead loads, and what both stand on: masses and directions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, Self

import numpy as np

from drystone.common.arrays import Array
from drystone.common.keys import Direction, Key
from drystone.common.language import Saying, say
from drystone.common.tolerances import ROUNDING
from drystone.common.vectors import direction_of
from drystone.model.assembly import Assembly
from drystone.model.loading.dead_forces import DeadForces
from drystone.model.scale import Scale
from drystone.model.ties import Tie


@dataclass(frozen=True, kw_only=True, eq=False)
class CarriedMasses:
    """Masses of dead loads as weights, one on each block that carries any."""

    weight: Array  # (n,) N
    moment: Array  # (n, dim) N m, of the weights, with arms from the centroids

    @classmethod
    def of(cls, assembly: Assembly, forces: DeadForces) -> CarriedMasses:
        """Of what weighs on the blocks."""
        moment = np.zeros_like(forces.force)
        if forces.lever is not None:
            moment = -(forces.lever @ assembly.up)
        return cls(weight=-(forces.force @ assembly.up), moment=moment)

    @property
    def arm(self) -> Array:
        """Where they lie, from the centroids, (n, dim) [m]; zero where there is none."""
        arm, weight = np.zeros_like(self.moment), self.weight[:, None]
        return np.divide(self.moment, weight, out=arm, where=weight > 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Masses:
    """Masses of dead loads that count in patterns, beside those of the blocks, and the ties that
    they vibrate on."""

    carried: tuple[CarriedMasses, ...] = ()  # of each load
    ties: tuple[Tie, ...] = ()  # and springs

    @property
    def together(self) -> CarriedMasses | None:
        """Those of all loads, at the centre of what each block carries; None where there are
        none."""
        if not self.carried:
            return None
        weight = np.sum([carried.weight for carried in self.carried], axis=0)
        moment = np.sum([carried.moment for carried in self.carried], axis=0)
        return CarriedMasses(weight=weight, moment=moment)

    def forces(self, assembly: Assembly, over_weight: Array) -> DeadForces:
        """Forces of all masses, (n, dim) over the weight at each block's centroid.

        Masses that lie elsewhere feel what the block's centroid feels.
        """
        return self.forces_in_place(assembly, [over_weight] * (1 + len(self.carried)))

    def forces_in_place(self, assembly: Assembly, over_weight: Sequence[Array]) -> DeadForces:
        """Forces of all masses, (n, dim) over the weight at each of the `arms`."""
        own, *others = over_weight
        sums = DeadForces(force=assembly.weight[:, None] * own)
        for carried, over in zip(self.carried, others, strict=True):
            lever = carried.moment[:, :, None] * over[:, None, :]
            sums = sums + DeadForces(force=carried.weight[:, None] * over, lever=lever)
        return sums

    def arms(self, assembly: Assembly) -> list[Array]:
        """Of the blocks' own masses, which is none, and of each dead load, (n, dim) [m]."""
        return [np.zeros_like(assembly.centroid), *(carried.arm for carried in self.carried)]

    def mean(self, assembly: Assembly, values: Sequence[Array]) -> float:
        """Of values (n,) at each of the `arms`, by weight; of masses that move alone."""
        weights = [assembly.weight, *(carried.weight for carried in self.carried)]
        free = ~assembly.fixed
        of_all = sum(float(w[free] @ v[free]) for w, v in zip(weights, values, strict=True))
        return of_all / float(self.weights(assembly).sum())

    def weights(self, assembly: Assembly) -> Array:
        """Of the blocks with what they carry, (n,) [N]; zero on supports."""
        all_ = sum((carried.weight for carried in self.carried), assembly.weight)
        return np.where(assembly.fixed, 0.0, all_)


#: Those of the blocks alone.
NO_MASSES = Masses()


class LoadPattern(Protocol):
    """The load that the multiplier scales.

    A pattern knows by itself which way it leads: whoever wants a direction asks `along`.
    """

    name: ClassVar[str]  # as in files: [load] pattern
    #: Whether the dead load shrinks as the pattern grows, see `tilt`.
    turns_gravity: ClassVar[bool]
    #: Keys that [load] has of it.
    file_keys: ClassVar[tuple[Key, ...]]

    @classmethod
    def from_keys(cls, values: dict[str, Any]) -> Self:
        """The pattern of the keys that a file gives: directions (dim,) as unit vectors, forces and
        places as arrays (dim,), lists of tables as lists of dicts."""
        ...

    def forces(self, assembly: Assembly, masses: Masses = NO_MASSES) -> DeadForces:
        """Forces at multiplier one; those on supports do not count."""
        ...

    def along(self, assembly: Assembly) -> Array:
        """(dim,) unit vector that the load as a whole leads along."""
        ...

    def towards(self, direction: Array) -> Self:
        """The pattern along another direction (dim,), a unit vector; raises `ValueError`."""
        ...

    def opposite(self, assembly: Assembly) -> Self:
        """The pattern in the other sense."""
        ...

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """That of a plane model as solids; ``vector`` takes vectors to space."""
        ...

    def in_frame(self, scale: Scale) -> Self:
        """The pattern in other coordinates and units."""
        ...

    def problems(self, assembly: Assembly) -> list[str]:
        """What keeps it from acting on an assembly, a sentence each that begins with its key."""
        ...

    def keys(self) -> dict[str, Any]:
        """What a model file says of it under [load], its name apart."""
        ...

    @property
    def words(self) -> str:
        """What it is, for people, as the end of a sentence."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Directed:
    """What patterns along one direction have in common."""

    direction: Array  # (dim,) unit vector; any two or three numbers are made one
    name: ClassVar[str]
    turns_gravity: ClassVar[bool] = False
    horizontal: ClassVar[bool] = False  # whether its direction must be
    file_keys: ClassVar[tuple[Key, ...]] = (
        Key(name="direction", type=Direction(), says="as in direction = [1.0, 0.0]"),
    )

    @classmethod
    def from_keys(cls, values: dict[str, Any]) -> Self:
        """See `LoadPattern`."""
        return cls(**values)

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", direction_of(self.direction, "load.direction"))

    def along(self, assembly: Assembly) -> Array:
        """See `LoadPattern`."""
        return self.direction

    def towards(self, direction: Array) -> Self:
        """See `LoadPattern`."""
        return replace(self, direction=direction)

    def opposite(self, assembly: Assembly) -> Self:
        """Sideways the other way; what it has of up or down stays, where it leads sideways."""
        upright = float(self.direction @ assembly.up) * assembly.up
        sideways = self.direction - upright
        kept = upright if np.linalg.norm(sideways) > LEVEL else -upright
        return self.towards(kept - sideways)

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """See `LoadPattern`."""
        return replace(self, direction=vector(self.direction))

    def in_frame(self, scale: Scale) -> Self:
        """See `LoadPattern`."""
        return self

    def problems(self, assembly: Assembly) -> list[str]:
        """See `LoadPattern`."""
        if len(self.direction) != assembly.dimension:
            return [f"load.direction: must have {assembly.dimension} entries"]
        if self.horizontal and abs(float(self.direction @ assembly.up)) > LEVEL:
            return [
                f'load.direction: the pattern "{self.name}" acts sideways: give a horizontal '
                'direction, or take pattern = "mass"'
            ]
        return []

    def keys(self) -> dict[str, Any]:
        """See `LoadPattern`."""
        return {"direction": self.direction.tolist()}

    @property
    def words(self) -> str:
        """See `LoadPattern`."""
        direction = [float(x) for x in self.direction]
        return say("load.along", pattern=self.name, direction=direction)


#: Rise of a direction that is level.
LEVEL = 1e-9


class DeadLoad(Protocol):
    """A load beside the blocks' weight that the multiplier does not scale."""

    name: str  # "" where it has none
    stage: int  # 0: with the weight; else once the structure rests under lower stages
    mass: bool  # whether its downward part is the weight of a mass, which counts in patterns

    def forces(self, assembly: Assembly) -> DeadForces:
        """Forces on the blocks."""
        ...

    def in_space(self, vector: Callable[..., Array]) -> Self:
        """That of a plane model as solids; ``vector`` takes vectors to space."""
        ...

    def in_frame(self, scale: Scale) -> Self:
        """The load in other coordinates and units."""
        ...

    def problems(self, assembly: Assembly, place: str) -> list[str]:
        """What keeps it from acting on an assembly, a sentence each that begins with its place."""
        ...

    def keys(self) -> dict[str, Any]:
        """What a model file says of it under [[dead_load]]."""
        ...


def stages_of(loads: Sequence[DeadLoad]) -> tuple[int, ...]:
    """Stages of dead loads, the weight first.  Each acts once the structure rests under those
    before it."""
    return tuple(sorted({0, *(load.stage for load in loads)}))


def dead_words(loads: Sequence[DeadLoad], stage: int | None = None) -> Saying:
    """What acts on a structure in a stage, or in all, as the end of "under its"."""
    later = [] if stage is None else [s for s in stages_of(loads) if s > stage]
    if any(stage is None or load.stage <= stage for load in loads):
        return say("end.with_loads_of", stage=stage) if later else say("end.with_loads")
    return say("end.weight_before", stage=min(later)) if later else say("end.own_weight")


def masses_of(assembly: Assembly, loads: Sequence[DeadLoad], ties: Sequence[Tie] = ()) -> Masses:
    """Masses that go with the loads that say so: what they weigh, where they lie."""
    counted = [load.forces(assembly) for load in loads if load.mass]
    carried = tuple(CarriedMasses.of(assembly, forces) for forces in counted)
    return Masses(carried=carried, ties=tuple(ties))


def rises(load: DeadLoad, assembly: Assembly, place: str) -> list[str]:
    """A sentence on a load that is called a mass, and acts upwards on a block."""
    if not load.mass:
        return []
    upwards = load.forces(assembly).force @ assembly.up
    if not (rows := np.flatnonzero(upwards > ROUNDING * np.abs(upwards).max(initial=0.0))).size:
        return []
    name = assembly.ids[rows[0]]
    return [f'{place}.mass: the load on block "{name}" acts upwards: set mass = false']
