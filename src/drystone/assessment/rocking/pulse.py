"""Overturning of a slender rocking block by one pulse of the ground, without impact.

It overturns where p int_0^inf exp(-p s) u_g(s) ds >= g alpha, s from uplift: closed forms of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError, positive
from drystone.common.arrays import Array

KINDS = ("half_sine", "rectangular")


@dataclass(frozen=True, kw_only=True)
class Pulse:
    """A pulse of one sign that begins at zero time."""

    kind: str  # one of `KINDS`
    amplitude: float  # m/s2
    duration: float  # s

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise AssessmentError(f'there is no pulse "{self.kind}": {", ".join(KINDS)}')
        positive(self.amplitude, "the amplitude of a pulse")
        positive(self.duration, "the duration of a pulse")

    def acceleration(self, time: ArrayLike) -> Array:
        """Acceleration of the ground [m/s2] at times [s]."""
        t = np.asarray(time, dtype=np.float64)
        inside = (t >= 0.0) & (t <= self.duration)
        if self.kind == "rectangular":
            return np.where(inside, self.amplitude, 0.0)
        return np.where(inside, self.amplitude * np.sin(math.pi * t / self.duration), 0.0)


def half_sine_excess(amplitude_ratio: float, frequency_ratio: float) -> float:
    """sqrt(a^2 - 1) + a exp(-(pi - asin(1/a))/r) - r: not below zero where a block overturns.

    Parameters
    ----------
    amplitude_ratio
        a = A/(g alpha), 1 or more.
    frequency_ratio
        r = omega/p.
    """
    a, r = amplitude_ratio, frequency_ratio
    return math.sqrt(a**2 - 1.0) + a * math.exp(-(math.pi - math.asin(1.0 / a)) / r) - r


def least_amplitude(kind: str, duration: float, frequency: float) -> float:
    """The least A/(g alpha) of a pulse that overturns, without impact.

    Half sine: the zero of `half_sine_excess`.  Rectangular: cosh p t_1 = 1 + 1/(2 a (a - 1)).
    """
    p = positive(frequency, "the frequency parameter p")
    t = positive(duration, "the duration of a pulse")
    if kind == "rectangular":
        return 1.0 / -math.expm1(-p * t)
    if kind != "half_sine":
        raise AssessmentError(f'there is no pulse "{kind}": {", ".join(KINDS)}')
    r = math.pi / (t * p)
    low, high = 1.0, 1.0 + r
    if half_sine_excess(low, r) >= 0.0:
        return low
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if half_sine_excess(middle, r) >= 0.0 else (middle, high)
    return high
