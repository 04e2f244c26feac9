"""The ground acceleration that is borne: what soil and corner periods ask of it moves with it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drystone.assessment.spectra.base import Spectrum
from drystone.common.language import say

#: Points of the search for the first crossing.
N_POINTS = 96

#: Doublings before a limit counts as never met.
MOST_DOUBLINGS = 40


def bearable(
    spectrum: Spectrum,
    demand: Callable[[Spectrum], float],
    limit: float,
    n_points: int = N_POINTS,
) -> float | None:
    """The least a_g [m/s2] under which a demand reaches a limit; None where none does.

    S_S falls while a_g grows, so that a demand need not grow with a_g everywhere: the first
    crossing counts.

    Parameters
    ----------
    demand
        Of a spectrum, in the unit of ``limit``; zero without ground motion.
    n_points
        Of the search for the first crossing.
    """
    if limit <= 0.0:
        return 0.0

    def excess(acceleration: float) -> float:
        return demand(spectrum.scaled(acceleration)) - limit

    high = spectrum.ground_acceleration
    for _ in range(MOST_DOUBLINGS):
        if excess(high) >= 0.0:
            break
        high *= 2.0
    else:
        return None
    grid = np.linspace(0.0, high, n_points + 1)
    values = np.array([-limit, *(excess(float(x)) for x in grid[1:])])
    return _first_crossing(excess, grid, values)


def _first_crossing(
    excess: Callable[[float], float], grid: np.ndarray, values: np.ndarray
) -> float:
    """The first zero: between points, or before a summit between them that just reaches it."""
    first = int(np.argmax(values >= 0.0))
    low, high = float(grid[first - 1]), float(grid[first])
    inner = np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] > values[2:])) + 1
    for i in inner[inner < first]:
        top = summit(excess, float(grid[i - 1]), float(grid[i + 1]))
        if excess(top) >= 0.0:
            low, high = float(grid[i - 1]), top
            break
    return bisected(excess, low, high)


def bisected(excess: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that is not above zero at ``low`` (not called there) comes to zero."""
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high or high - low <= 1e-15 * high:
            return high
        if excess(middle) >= 0.0:
            high = middle
        else:
            low = middle


def summit(value: Callable[[float], float], low: float, high: float) -> float:
    """Where a function of one summit is highest between two numbers, by golden section."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    at_a, at_b = value(a), value(b)
    while high - low > 1e-8 * abs(high):
        if at_a >= at_b:
            high, b, at_b = b, a, at_a
            a = high - ratio * (high - low)
            at_a = value(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + ratio * (high - low)
            at_b = value(b)
    return 0.5 * (low + high)


def return_period_borne(spectrum: Spectrum, acceleration: float | None) -> float | None:
    """T_RC [years] of a bearable a_g [m/s2], where the spectrum has a return period.

    T_R (a_g,C/a_g,D)^k with the code's exponent: 3 of EN 1998-1:2004 2.1(4), 1/0.41 of NTC.
    """
    years = spectrum.return_period
    power = getattr(spectrum, "return_period_exponent", None)
    if years is None or power is None or acceleration is None:
        return None
    return years * math.pow(acceleration / spectrum.ground_acceleration, power)


def of_the_ground(spectrum: Spectrum, borne: float | None) -> dict[str, Any]:
    """Ground accelerations [m/s2] and return periods [years] of a `LimitState`, by its keys.

    Parameters
    ----------
    borne
        The bearable a_g [m/s2].
    """
    return {
        "ground_acceleration_capacity": borne,
        "ground_acceleration_demand": spectrum.ground_acceleration,
        "return_period_demand": spectrum.return_period,
        "return_period_capacity": return_period_borne(spectrum, borne),
    }


#: For results that hold `return_period_borne`.
RETURN_PERIOD_UNCERTAIN = say("common.return_period")
