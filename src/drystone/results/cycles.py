"""Loops of force against displacement: cycles with their energy and stiffness, and the envelope.

The same functions take computed and measured loops.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from drystone.common.arrays import Array

#: Of the largest displacement, within which a path ends at zero.
ENDS_AT_ZERO = 1e-6


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """One cycle: from zero out in the first sense, out in the other, and back to zero.

    A path that reverses before it has returned to zero begins its next cycle at the reversal.
    """

    first: int  # points it begins and ends at, or within the interval before
    last: int
    closed: bool  # whether another cycle begins behind it, or it ends at zero
    energy: float  # J, area that force and displacement enclose; of an open one, the work so far
    greatest: float  # m, displacement
    least: float  # m
    force_at_greatest: float  # N
    force_at_least: float  # N
    residual_after_greatest: float | None  # m, displacement where the force passes zero behind it
    residual_after_least: float | None  # m

    @property
    def secant_stiffness(self) -> float | None:
        """Between both extremes [N/m]; None where they are one."""
        way = self.greatest - self.least
        return (self.force_at_greatest - self.force_at_least) / way if way > 0.0 else None

    @property
    def damping(self) -> float | None:
        """Equivalent viscous damping ratio [-]: energy over 4 pi times the elastic energy that the
        secant stiffness stores at the mean amplitude (Jacobsen).  None of an open cycle."""
        stiffness = self.secant_stiffness
        if not self.closed or stiffness is None or stiffness <= 0.0:
            return None
        amplitude = 0.5 * (self.greatest - self.least)
        return self.energy / (2.0 * math.pi * stiffness * amplitude**2)

    def as_dict(self) -> dict[str, float | int | bool | None]:
        """For JSON and tables."""
        return {
            "first": self.first,
            "last": self.last,
            "closed": self.closed,
            "energy": self.energy,
            "equivalent_damping": self.damping,
            "secant_stiffness": self.secant_stiffness,
            "greatest_displacement": self.greatest,
            "least_displacement": self.least,
            "force_at_greatest": self.force_at_greatest,
            "force_at_least": self.force_at_least,
            "residual_after_greatest": self.residual_after_greatest,
            "residual_after_least": self.residual_after_least,
        }


def cycles_of(
    displacement: Array, force: Array, *, noise: float = 0.0, least_way: float = 0.0
) -> tuple[Cycle, ...]:
    """Cycles of a loop.

    Parameters
    ----------
    displacement, force
        (n_points,) [m], [N], in the order in which they were passed.
    noise
        Displacement [m] up to which a path is at zero.
    least_way
        Motion [m] up to which a reversal is none, if it is larger than the noise.
    """
    noise = max(noise, ENDS_AT_ZERO * float(np.abs(displacement).max(initial=0.0)))
    reversed_at = reversals(displacement, noise=max(noise, least_way))
    if len(reversed_at) < 2:
        return ()
    sense = 1.0 if displacement[reversed_at[1]] > displacement[reversed_at[0]] else -1.0
    out = sense * displacement
    begins = [float(reversed_at[0])]
    for k in range(2, len(reversed_at)):
        if out[reversed_at[k]] <= out[reversed_at[k - 1]]:
            continue
        begin, end = (
            reversed_at[k - 1],
            reversed_at[k],
        )  # a leg in the first sense, after one in the other
        if out[begin] < 0.0 and out[end] <= noise:  # back to zero at most
            begins += [float(end)] if abs(out[end]) <= noise else [float(begin)]
            continue
        begins.append(_passage(out, begin, end))
    n = len(displacement) - 1
    bounds = [*begins, float(n)]
    return tuple(
        _cycle(displacement, force, a, b, closed=bool(b < n or abs(out[-1]) <= noise))
        for a, b in pairwise(bounds)
        if b > a
    )


def reversals(displacement: Array, *, noise: float = 0.0) -> list[int]:
    """Points where the sense of motion changes, with the first and the last."""
    reversed_at, extreme, sense = [0], 0, 0.0
    for k in range(1, len(displacement)):
        moved = displacement[k] - displacement[extreme]
        if sense == 0.0:
            if abs(moved) > noise:
                sense, extreme = math.copysign(1.0, moved), k
        elif moved * sense >= 0.0:
            extreme = k
        elif abs(moved) > noise:
            reversed_at.append(extreme)
            sense, extreme = -sense, k
    last = len(displacement) - 1
    return reversed_at if last <= reversed_at[-1] else [*reversed_at, last]


def _passage(out: Array, begin: int, end: int) -> float:
    """Where a leg passes zero, as a point and a share of the step to the next; or its beginning."""
    for k in range(begin, end):
        if out[k] < 0.0 <= out[k + 1]:
            return k + float(-out[k] / (out[k + 1] - out[k]))
    return float(begin)


def _cycle(x: Array, y: Array, begin: float, end: float, *, closed: bool) -> Cycle:
    inner = np.arange(math.floor(begin) + 1, math.ceil(end))
    place = np.concatenate(([begin], inner, [end]))
    rows = np.arange(len(x))
    along, force = np.interp(place, rows, x), np.interp(place, rows, y)
    top, low = int(np.argmax(along)), int(np.argmin(along))
    return Cycle(
        first=math.floor(begin),
        last=math.ceil(end),
        closed=closed,
        energy=float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(along))),
        greatest=float(along[top]),
        least=float(along[low]),
        force_at_greatest=float(force[top]),
        force_at_least=float(force[low]),
        residual_after_greatest=_residual(x, y, math.ceil(place[top])),
        residual_after_least=_residual(x, y, math.ceil(place[low])),
    )


def _residual(along: Array, force: Array, begin: int) -> float | None:
    """Displacement [m] where the force first passes zero after a point: behind the second extreme
    of a cycle that may be in the next one."""
    sign = math.copysign(1.0, force[begin])
    for k in range(begin, len(force) - 1):
        a, b = sign * force[k], sign * force[k + 1]
        if a > 0.0 >= b:
            return float(along[k] + a / (a - b) * (along[k + 1] - along[k]))
    return None


def envelope(displacement: Array, force: Array, sense: float) -> tuple[Array, Array]:
    """Displacements [m] and forces [N] where the displacement is farther out in a sense, 1 or -1,
    than ever before, beginning at zero."""
    out = sense * np.asarray(displacement, np.float64)
    before = np.maximum.accumulate(np.concatenate(([0.0], out[:-1])))
    rows = np.flatnonzero(out > before)
    x = np.concatenate(([0.0], np.asarray(displacement)[rows]))
    y = np.concatenate(([0.0], np.asarray(force)[rows]))
    return x, y


def dissipated(cycles: Sequence[Cycle]) -> float:
    """Energy of all closed cycles [J]."""
    return float(sum(cycle.energy for cycle in cycles if cycle.closed))
