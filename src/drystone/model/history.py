"""Displacements that the control point is brought to one after another: a cyclic analysis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np

from drystone.common.errors import ModelError
from drystone.common.ranges import found, too_many
from drystone.common.tolerances import ROUNDING
from drystone.model.assembly import Assembly

#: Sizes of the structure that a displacement may be: beyond, it is in another unit.
MOST_SIZES = 1.0


@dataclass(frozen=True, kw_only=True)
class History:
    """Control displacements [m] to reach one after another, from zero.

    The load multiplier takes the sign that equilibrium asks for.
    """

    targets: tuple[float, ...]

    @classmethod
    def of_amplitudes(cls, amplitudes: Sequence[float], cycles: int = 1) -> History:
        """Each amplitude [m] in both senses, ``cycles`` times; the last target is zero."""
        both = [x for a in amplitudes for x in (a, -a) * cycles]
        return cls(targets=(*map(float, both), 0.0))

    def problems(self, assembly: Assembly | None = None) -> list[str]:
        """Sentences on what no control point can be brought to, each with its place."""
        return problems_of(self.targets, "control.history", assembly)


def problems_of(
    targets: Sequence[object], place: str, assembly: Assembly | None = None
) -> list[str]:
    """Sentences on displacements that cannot be reached, by a structure where one is given."""
    if not len(targets):
        return [f"{place}: is empty: give displacements in m, as in [0.005, -0.005]"]
    if wrong := too_many("displacements of a history", len(targets)):
        return [f"{place}: {wrong}"]
    for k, target in enumerate(targets, 1):
        number = isinstance(target, Real) and not isinstance(target, bool)
        if not number or not math.isfinite(target):  # type: ignore[arg-type]
            what = found(target)
            return [f"{place}[{k}]: must be a finite number, a displacement in m, it is {what}"]
    values = np.array([0.0, *targets], np.float64)
    still = np.flatnonzero(np.abs(np.diff(values)) <= ROUNDING * np.abs(values).max())
    if len(still):
        k = int(still[0]) + 1
        where = "at zero, where the load begins" if k == 1 else f"at {values[k]:g} m already"
        return [f"{place}[{k}]: the control point is {where}: take it out"]
    if assembly is None:
        return []
    size = assembly.largest_extent
    beyond = np.flatnonzero(np.abs(values[1:]) > MOST_SIZES * size)
    if len(beyond):
        k = int(beyond[0]) + 1
        return [
            f"{place}[{k}]: {values[k]:g} m is beyond the structure, which measures {size:.3g} m: "
            "give displacements in m"
        ]
    return []


def history_of(
    targets: Sequence[float] | None, amplitudes: Sequence[float] | None, cycles: int
) -> History | None:
    """The history by its displacements [m], or by amplitudes [m] and the cycles of each;
    raises `ModelError`."""
    if amplitudes is None:
        if targets is None:
            return None
        problems = problems_of(targets, "control.history")
        if problems:
            raise ModelError(problems)
        return History(targets=tuple(map(float, targets)))
    if targets is not None:
        raise ModelError(["control: has both history and amplitudes: give one of them"])
    problems = amplitude_problems(amplitudes, cycles)
    if problems:
        raise ModelError(problems)
    return History.of_amplitudes(amplitudes, cycles)


def amplitude_problems(amplitudes: Sequence[object], cycles: int) -> list[str]:
    """Sentences on amplitudes and numbers of cycles that are none."""
    if not len(amplitudes):
        return ["control.amplitudes: is empty: give displacements in m, as in [0.005, 0.01]"]
    if isinstance(cycles, bool) or not isinstance(cycles, int) or cycles < 1:
        return [f"control.cycles: must be a whole number from 1 on, it is {found(cycles)}"]
    for k, value in enumerate(amplitudes, 1):
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not number or not 0.0 < value < math.inf:  # type: ignore[operator]
            what = found(value)
            return [f"control.amplitudes[{k}]: must be a positive number in m, it is {what}"]
    if wrong := too_many("displacements of a history", 2 * cycles * len(amplitudes)):
        return [f"control.cycles: {wrong}"]
    return []
