"""The rocking block: Housner's, and the one that stands for a mechanism."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drystone.assessment.bilinear import drop_point
from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, positive
from drystone.model.assembly import GRAVITY

#: The slope of a mechanism at its peak is taken from its curve down to this share of the peak.
SLOPE_DOWN_TO = 0.7

N_SLOPE = 41


@dataclass(frozen=True, kw_only=True)
class RockingBlock:
    """A rigid block on a rigid base, or what stands for a mechanism."""

    frequency: float  # 1/s, p
    slenderness: float  # rad, alpha

    def __post_init__(self) -> None:
        positive(self.frequency, "the frequency parameter p")
        if not 0.0 < self.slenderness < 0.5 * math.pi:
            raise AssessmentError(
                f"the slenderness alpha is an angle between 0 and 90 degrees, not "
                f"{self.slenderness:g} rad"
            )

    @property
    def uplift_acceleration(self) -> float:
        """g tan alpha [m/s2], the ground acceleration that starts it."""
        return GRAVITY * math.tan(self.slenderness)

    @property
    def restitution(self) -> float:
        """1 - 1.5 sin^2 alpha, velocity after an impact over that before it; Housner 1963."""
        return 1.0 - 1.5 * math.sin(self.slenderness) ** 2

    def free_period(self, amplitude_ratio: float) -> float:
        """T = (4/p) acosh(1/(1 - theta_0/alpha)) [s] of free rocking, slender; Housner 1963."""
        if not 0.0 < amplitude_ratio < 1.0:
            raise AssessmentError(
                f"free rocking has an amplitude between 0 and alpha, not {amplitude_ratio:g} alpha"
            )
        return 4.0 / self.frequency * math.acosh(1.0 / (1.0 - amplitude_ratio))


def equivalent_block(capacity: Capacity) -> RockingBlock:
    """The block of p_eq^2 = g |d lambda/d d*| at the peak and tan alpha_eq = lambda_0.

    In the reading of the energy, whose equation of motion is d*'' + lambda(d*) g = -u_g''; with
    Gamma_k of the whole kinetic energy it is p sqrt(cos alpha) for one block, within half a per
    cent of Housner's p for a slender one.  DeJong and Dimitrakopoulos 2014 for mechanisms.
    """
    slope = peak_slope(capacity.read_as("energy"))
    return RockingBlock(
        frequency=math.sqrt(slope), slenderness=math.atan(capacity.activation_multiplier)
    )


def peak_slope(capacity: Capacity) -> float:
    """-da*/dd* [1/s2] just past the peak: of a parabola through the curve down to 0.7 of it."""
    d, a = capacity.spectral_displacement, capacity.spectral_acceleration
    collapse = capacity.spectral_collapse_displacement
    if collapse is not None and collapse > d[-1]:
        d, a = np.append(d, collapse), np.append(a, 0.0)
    top = capacity.activation_index
    higher = np.flatnonzero(a[top:] > a[top])  # what bears more later is another mechanism
    end = top + int(higher[0]) if len(higher) else len(a)
    d, a = d[top:end], a[top:end]
    start, lowest = float(d[0]), int(np.argmin(a))
    falls_far = not len(higher) or a[lowest] <= SLOPE_DOWN_TO * a[0]
    stop = drop_point(d, a, SLOPE_DOWN_TO) if falls_far else float(d[lowest])
    x = np.linspace(start, stop, N_SLOPE)
    _, line, _ = np.polyfit((x - start) / (stop - start), np.interp(x, d, a), 2)
    slope = -float(line) / (stop - start)
    if slope <= 0.0:  # a rounded peak: the chord
        slope = float(a[0] - np.interp(stop, d, a)) / (stop - start)
    return slope
