"""What a method asks of the ground: an elastic response spectrum that knows its ground motion."""

from __future__ import annotations

from typing import Protocol, Self, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError
from drystone.common.arrays import Array

#: Damping of the spectra of the codes; a ratio, as everywhere but in files.
REFERENCE_DAMPING = 0.05

Value = TypeVar("Value", float, Array)


@runtime_checkable
class Spectrum(Protocol):
    """An elastic response spectrum at the ground, the soil included, or at a height above it.

    Damping is a ratio.  Periods are a number or an array; results have their shape.
    """

    @property
    def ground_acceleration(self) -> float:
        """a_g [m/s2], of the ground as the code counts it: on rock, without the soil factor."""
        ...

    @property
    def soil_factor(self) -> float:
        """S, of soil and topography, at this ground acceleration."""
        ...

    @property
    def corner_period(self) -> float:
        """T_C [s], where the plateau ends."""
        ...

    @property
    def site_specific(self) -> bool:
        """Whether it is of a site and may have any shape, rather than of a code's formula."""
        ...

    @property
    def return_period(self) -> float | None:
        """T_R [years], or None where nobody has said."""
        ...

    @property
    def label(self) -> str:
        """What it is, for people: code, soil and ground acceleration."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed, a sentence each."""
        ...

    @property
    def uncertain(self) -> tuple[str, ...]:
        """Clauses that it rests on whose text was not at hand, a sentence each."""
        ...

    def sa(self, period: ArrayLike, damping: float) -> Array:
        """Elastic pseudo-acceleration S_e [m/s2] at periods [s]."""
        ...

    def sd(self, period: ArrayLike, damping: float) -> Array:
        """Elastic displacement S_De [m] at periods [s]."""
        ...

    def scaled(self, ground_acceleration: float) -> Self:
        """The spectrum of another a_g [m/s2]; whatever the code ties to a_g moves with it."""
        ...


def damping_factor(damping: float) -> float:
    """eta = sqrt(10/(5 + xi)) >= 0.55, xi in percent: EN 1998-1:2004 (3.6), NTC 2018 [3.2.4].

    Parameters
    ----------
    damping
        A ratio.
    """
    if not np.isfinite(damping) or damping < 0.0 or damping >= 1.0:
        raise AssessmentError(
            f"a damping of {damping:g} is not a ratio: 5 per cent of critical damping is 0.05"
        )
    return max(float(np.sqrt(10.0 / (5.0 + 100.0 * damping))), 0.55)


def periods(values: ArrayLike) -> Array:
    """Periods as an array [s]; none is below zero."""
    array = np.asarray(values, dtype=np.float64)
    if not np.isfinite(array).all() or (array < 0.0).any():
        raise AssessmentError("a period of a spectrum is a number of seconds, zero or more")
    return array


def largest_displacement(
    spectrum: Spectrum, first: float, last: float, damping: float, n: int = 512
) -> float:
    """The largest S_De [m] between two periods [s], on a grid and at both ends."""
    if last < first:
        raise AssessmentError(f"no periods between {first:g} s and {last:g} s")
    nodes = getattr(spectrum, "nodes", np.empty(0))
    inside = nodes[(nodes > first) & (nodes < last)]
    return float(
        np.max(spectrum.sd(np.concatenate((np.linspace(first, last, n), inside)), damping))
    )
