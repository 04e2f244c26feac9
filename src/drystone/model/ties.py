"""Ties and springs between points of two blocks, or of a block and the ground.

Their equations are in docs/explanation/ties.md.

A tie is a straight bar without weight: elastic up to its strength, then perfectly plastic, slack
instead of compressed unless it says otherwise, broken once it is elongated too far.  A
spring is the same without a strength, and works both ways.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.names import there_is_no
from drystone.model import tie_kernels as kernel
from drystone.model.assembly import Assembly
from drystone.model.scale import Scale

#: What a tie does, in results by these names.
SLACK, ELASTIC, YIELDING, BROKEN = 0, 1, 2, 3
STATES = ("slack", "elastic", "yielding", "broken")

#: The end of a tie that is on no block, as files name it.
GROUND = "ground"

#: Share of the breaking elongation within which a tie counts as broken.
AT_IT = 3e-3

#: Over a block's size: how far from it an end may lie.
SAME = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class TieEnd:
    """Where a tie is fixed: at a point of a block as designed, or of the ground."""

    point: Array  # (dim,) m
    block: str | None = None  # None or "ground": the ground, which does not move

    def __post_init__(self) -> None:
        if self.block == GROUND:
            object.__setattr__(self, "block", None)

    def row(self, assembly: Assembly, moving: IntArray | None = None) -> int:
        """Of its block; where it is on the ground, of a support that is not among the ``moving``
        ones."""
        if self.block is not None:
            return assembly.index(self.block)
        still = assembly.fixed.copy()
        if moving is not None:
            still[moving] = False
        return int(np.argmax(still))

    def problem(self, assembly: Assembly) -> str | None:
        """What keeps it from being there, as the end of a sentence."""
        given = np.asarray(self.point, float)
        if given.shape != (assembly.dimension,) or not np.isfinite(given).all():
            return f"point: must have {assembly.dimension} coordinates in metres"
        if self.block is None:
            if not assembly.fixed.any():
                return "block: there is no ground without a support: name a block"
            named = [block for block in assembly.blocks if block.id == GROUND]
            if named and not named[0].support:
                return f'block: "{GROUND}" is what does not move: give the block another name'
            return None
        if self.block not in assembly.ids:
            return f"block: {there_is_no('block', self.block, assembly.ids)}"
        row = assembly.index(self.block)
        size = float(np.ptp(assembly.blocks[row].vertices, axis=0).max())
        if not assembly.figures[row].distance(given) <= SAME * size:
            return f'point: is not on block "{self.block}": move it onto the block'
        return None

    def keys(self) -> dict[str, Any]:
        """As in a model file."""
        block = GROUND if self.block is None else self.block
        return {"block": block, "point": np.asarray(self.point).tolist()}


@dataclass(frozen=True, kw_only=True, eq=False)
class Tie:
    """A bar between two ends; its stiffness by ``stiffness``, or by ``area`` and
    ``young_modulus``."""

    start: TieEnd
    end: TieEnd
    stiffness: float | None = None  # N/m
    area: float | None = None  # m2
    young_modulus: float | None = None  # Pa
    yield_force: float  # N; infinite of springs
    anchorage_force: float = math.inf  # N, at which its ends begin to give way
    pretension: float = 0.0  # N, in the structure as designed
    breaking_elongation: float = math.inf  # m, beyond its length as designed
    compression: bool  # whether it carries as much compression as tension
    name: str = ""
    spring: bool = False  # what files call it

    @property
    def place(self) -> str:
        """What messages call it."""
        kind = "spring" if self.spring else "tie"
        return f'{kind} "{self.name}"' if self.name else kind

    @property
    def length(self) -> float:
        """As designed [m]."""
        return float(np.linalg.norm(np.subtract(self.end.point, self.start.point)))

    @property
    def per_length(self) -> float:
        """Stiffness [N/m]."""
        if self.stiffness is not None:
            return self.stiffness
        return (self.area or 0.0) * (self.young_modulus or 0.0) / self.length

    @property
    def strength(self) -> float:
        """Largest force [N]."""
        return min(self.yield_force, self.anchorage_force)

    def in_frame(self, scale: Scale) -> Self:
        """The tie in other coordinates and units."""

        def force(newtons: float) -> float:
            return float(scale.forces(np.array(newtons)))

        return replace(
            self,
            start=replace(self.start, point=scale.place(self.start.point)),
            end=replace(self.end, point=scale.place(self.end.point)),
            stiffness=scale.spring(self.per_length),
            area=None,
            young_modulus=None,
            yield_force=force(self.yield_force),
            anchorage_force=force(self.anchorage_force),
            pretension=force(self.pretension),
            breaking_elongation=scale.extension(self.breaking_elongation),
        )

    def in_space(self, point: Callable[..., Array]) -> Self:
        """That of a plane model as solids; ``point`` takes places to space."""
        start = replace(self.start, point=point(self.start.point, point=True))
        end = replace(self.end, point=point(self.end.point, point=True))
        return replace(self, start=start, end=end)

    def problems(self, assembly: Assembly) -> list[str]:
        """What keeps it from acting on an assembly, a sentence each."""
        found = []
        for key, end in (("from", self.start), ("to", self.end)):
            if problem := end.problem(assembly):
                found.append(f"{self.place}.{key}.{problem}")
        found += [f"{self.place}.{wrong}" for wrong in self._wrong_numbers()]
        if found:
            return found
        if self.start.row(assembly) == self.end.row(assembly):
            return [f"{self.place}: both ends are on one block: name two"]
        size = assembly.smallest_extent
        if not self.length > SAME * size:
            return [f"{self.place}: has no length: move one of its ends"]
        if assembly.fixed[[self.start.row(assembly), self.end.row(assembly)]].all():
            return [f"{self.place}: joins what never moves: name a movable block"]
        return []

    def _wrong_numbers(self) -> list[str]:
        found = []
        by_area = self.area is not None and self.young_modulus is not None
        if (self.stiffness is None) != by_area or (
            not by_area and (self.area is not None or self.young_modulus is not None)
        ):
            found.append("stiffness: give stiffness [N/m], or area [m2] and young_modulus [Pa]")
        for key in ("stiffness", "area", "young_modulus"):
            value = getattr(self, key)
            if value is not None and not 0.0 < value < math.inf:
                found.append(f"{key}: must be greater than 0, it is {value:g}")
        if not self.spring and not math.isfinite(self.yield_force):
            found.append("yield_force: must be a finite number; a spring has none")
        for key in ("yield_force", "anchorage_force", "breaking_elongation"):
            if not getattr(self, key) > 0.0:
                found.append(f"{key}: must be greater than 0, it is {getattr(self, key):g}")
        least = -self.strength if self.compression else 0.0
        if not least <= self.pretension <= self.strength or not math.isfinite(self.pretension):
            found.append(
                f"pretension: must be from {least:g} to its strength of {self.strength:g} N, "
                f"it is {self.pretension:g}"
            )
        return found

    def keys(self) -> dict[str, Any]:
        """As in a model file, under [[tie]] or [[spring]]."""
        numbers = {
            key: getattr(self, key)
            for key in ("stiffness", "area", "young_modulus")
            if getattr(self, key) is not None
        }
        if not self.spring:
            bounds = ("yield_force", "anchorage_force", "breaking_elongation")
            numbers |= {
                key: float(getattr(self, key))
                for key in bounds
                if math.isfinite(getattr(self, key))
            }
            numbers["compression"] = self.compression
        if self.pretension:
            numbers["pretension"] = float(self.pretension)
        named = {"name": self.name} if self.name else {}
        return {**named, "from": self.start.keys(), "to": self.end.keys(), **numbers}


def spring(*, start: TieEnd, end: TieEnd, stiffness: float, **more: Any) -> Tie:
    """A spring between two points for tension and compression, such as a floor between two
    walls."""
    return Tie(
        start=start,
        end=end,
        stiffness=stiffness,
        yield_force=math.inf,
        compression=True,
        spring=True,
        **more,
    )


def names_of(ties: Sequence[Tie]) -> tuple[str, ...]:
    """A name for every tie: its own, else its number."""
    kinds = ["spring" if tie.spring else "tie" for tie in ties]
    return tuple(tie.name or f"{kinds[k]} {k + 1}" for k, tie in enumerate(ties))


def problems_of(
    ties: Sequence[Tie], assembly: Assembly, moving: IntArray | None = None
) -> list[str]:
    """What keeps ties from acting on an assembly, of which the supports ``moving`` will move."""
    found = [sentence for tie in ties for sentence in tie.problems(assembly)]
    if moving is not None and not np.delete(assembly.fixed, moving).any():
        found += [
            f"{tie.place}: its end on the ground needs a support that stays: add one"
            for tie in ties
            if None in (tie.start.block, tie.end.block)
        ]
    names = names_of(ties)
    found += [
        f'{tie.place}: there are two of the name "{name}": give each its own'
        for k, (tie, name) in enumerate(zip(ties, names, strict=True))
        if name in names[:k]
    ]
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class TieState:
    """What ties have come to; arrays (n_ties,)."""

    plastic: Array  # m
    branch: IntArray  # SLACK, ELASTIC, YIELDING or BROKEN
    force: Array  # N, tension positive
    elongation: Array  # m, beyond the length as designed
    margin: Array = field(repr=False)  # to the next event, see `Bars.ended`

    @property
    def n_ties(self) -> int:
        """How many."""
        return len(self.force)


@dataclass(frozen=True, kw_only=True, eq=False)
class Bars:
    """Ties of an assembly as arrays, for `model.tie_kernels`."""

    body: IntArray  # (n_ties, 2)
    value: Array  # (n_ties, N_VALUE)

    @classmethod
    def of(cls, assembly: Assembly, ties: Sequence[Tie], moving: IntArray | None = None) -> Bars:
        """Of ties without problems; see `TieEnd.row`."""
        dim = assembly.dimension
        value = np.zeros((len(ties), kernel.N_VALUE))
        ends = [[end.row(assembly, moving) for end in (tie.start, tie.end)] for tie in ties]
        body = np.array(ends, np.int64).reshape(-1, 2)
        for row, tie, (a, b) in zip(value, ties, ends, strict=True):
            first, last = (np.asarray(end.point, float) for end in (tie.start, tie.end))
            row[kernel.ARM_A : kernel.ARM_A + dim] = first - assembly.centroid[a]
            row[kernel.ARM_B : kernel.ARM_B + dim] = last - assembly.centroid[b]
            row[kernel.SPAN : kernel.SPAN + dim] = last - first
            row[kernel.LENGTH], row[kernel.STIFFNESS] = tie.length, tie.per_length
            row[kernel.PRETENSION], row[kernel.MOST] = tie.pretension, tie.strength
            row[kernel.LEAST] = -tie.strength if tie.compression else 0.0
            row[kernel.BREAKING], row[kernel.ACTIVE] = tie.breaking_elongation, 1.0
        return cls(body=body, value=value)

    @property
    def n_ties(self) -> int:
        """How many."""
        return len(self.body)

    @property
    def give_way(self) -> bool:
        """Whether any of them may yield or break."""
        bounds = self.value[:, [kernel.MOST, kernel.BREAKING]]
        return bool(np.isfinite(bounds).any())

    def first(self) -> TieState:
        """As designed."""
        n = self.n_ties
        return TieState(
            plastic=np.zeros(n),
            branch=np.full(n, ELASTIC),
            force=self.value[:, kernel.PRETENSION].copy(),
            elongation=np.zeros(n),
            margin=np.full(n, np.inf),
        )

    def at_rest(self, assembly: Assembly) -> kernel.Ties:
        """For kernels, as designed."""
        now = np.zeros((self.n_ties, kernel.N_NOW))
        value = self.value.copy()
        kernel.locate(self.body, value, assembly.design_pose(), now)
        return kernel.Ties(self.body, value, now)

    def ended(
        self,
        before: TieState,
        value: Array,
        now: Array,
        *,
        yields: bool = True,
        aged: bool = False,
    ) -> TieState:
        """The state to which a step from ``before`` has led, see `model.tie_kernels` for the
        arrays.

        The margin is what a tie is from yielding, unless it did already, or from breaking: over
        its strength, or its breaking elongation.  Without ``yields`` only breaking is an event;
        ``aged`` says that yielding has been counted.
        """
        force, trial = now[:, kernel.FORCE], now[:, kernel.TRIAL]
        most, least, active = value[:, kernel.MOST], value[:, kernel.LEAST], value[:, kernel.ACTIVE]
        over = trial - force
        plastic = (over > 0.0) | ((over < 0.0) & (least < 0.0))
        branch = np.where(plastic, YIELDING, np.where(force != 0.0, ELASTIC, SLACK))
        branch = np.where(active == 0.0, BROKEN, branch)
        margin = np.full(len(force), np.inf)
        if yields:
            first = (active > 0.0) & np.isfinite(most) & (before.branch != YIELDING)
            reserve = most - np.where(least < 0.0, np.abs(trial), trial)
            margin[first] = reserve[first] / most[first]
        breaking = value[:, kernel.BREAKING]
        breaks = (active > 0.0) & np.isfinite(breaking)
        left = (breaking[breaks] - now[breaks, kernel.ELONGATION]) / breaking[breaks]
        margin[breaks] = np.minimum(margin[breaks], left)
        grown = 0.0 if aged else np.where(plastic, over, 0.0) / value[:, kernel.STIFFNESS]
        return TieState(
            plastic=value[:, kernel.PLASTIC] + grown,
            branch=branch,
            force=force.copy(),
            elongation=now[:, kernel.ELONGATION].copy(),
            margin=margin,
        )

    def past(self, state: TieState, due: IntArray) -> TieState:
        """The state after ties that were ``due`` have yielded or broken."""
        branch, margin, force = state.branch.copy(), state.margin.copy(), state.force.copy()
        breaks = self.breaking(state, due)
        branch[due] = np.where(breaks, BROKEN, YIELDING)
        margin[due], force[due[breaks]] = np.inf, 0.0
        return replace(state, branch=branch, margin=margin, force=force)

    def torn(self, state: TieState) -> TieState:
        """The state once all have broken that are elongated too far."""
        return self.past(state, np.flatnonzero(state.elongation > self.value[:, kernel.BREAKING]))

    def whole(self, state: TieState) -> IntArray:
        """Bodies that ties join which are not broken, (., 2)."""
        return self.body[state.branch != BROKEN]

    def breaking(self, state: TieState, due: IntArray) -> BoolArray:
        """Which of the ties that are ``due`` break; others yield."""
        limit = self.value[due, kernel.BREAKING]
        return np.asarray(state.elongation[due] >= (1.0 - AT_IT) * limit)
