"""Elastic spectra of NTC 2018 (D.M. 17 January 2018), 3.2.3.2.

The hazard grid is not part of this: a_g, F_0 and T_C* of a site and a return period are given.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.spectra.shape import (
    Shape,
    ShapedSpectrum,
    checked_acceleration,
    checked_ground,
)
from drystone.common.language import say
from drystone.model.assembly import GRAVITY

SOILS = ("A", "B", "C", "D", "E")

#: S_S = least <= first - second F_0 a_g/g <= most, Table 3.2.IV: least, first, second, most.
STRATIGRAPHIC = {
    "A": (1.00, 1.00, 0.00, 1.00),
    "B": (1.00, 1.40, 0.40, 1.20),
    "C": (1.00, 1.70, 0.60, 1.50),
    "D": (0.90, 2.40, 1.50, 1.80),
    "E": (1.00, 2.00, 1.10, 1.60),
}

#: C_C = first (T_C*/s)^second, Table 3.2.IV.
CORNER = {
    "A": (1.00, 0.00),
    "B": (1.10, -0.20),
    "C": (1.05, -0.33),
    "D": (1.25, -0.50),
    "E": (1.15, -0.40),
}

#: S_T, Table 3.2.V: the largest value, at the top of a slope or on a ridge.
TOPOGRAPHIC = {"T1": 1.0, "T2": 1.2, "T3": 1.2, "T4": 1.4}

#: T_E, T_F [s], Table 3.2.VII.
LONG_PERIODS = {"A": (4.5, 10.0), "B": (5.0, 10.0), **dict.fromkeys("CDE", (6.0, 10.0))}

#: P_VR by limit state, Table 3.2.I.
PROBABILITIES = {"SLO": 0.81, "SLD": 0.63, "SLV": 0.10, "SLC": 0.05}

#: C_U by class of use, Table 2.4.II.
USE = {"I": 0.7, "II": 1.0, "III": 1.5, "IV": 2.0}

#: T_R goes with a_g to this power where the hazard of the site is not at hand.
RETURN_PERIOD_EXPONENT = 1.0 / 0.41


def reference_life(nominal_life: float, use: float | str) -> float:
    """V_R = V_N C_U [years], [2.4.1]; the use is C_U or a class "I" to "IV"."""
    if isinstance(use, str):
        if use not in USE:
            raise AssessmentError(f'there is no class of use "{use}": {", ".join(USE)}, or C_U')
        use = USE[use]
    return positive(nominal_life, "the nominal life V_N") * positive(use, "the coefficient C_U")


def return_period(life: float, state: str | float) -> float:
    """T_R = -V_R/ln(1 - P_VR) [years], [3.2.0], of a limit state or of a probability."""
    if isinstance(state, str):
        if state not in PROBABILITIES:
            raise AssessmentError(
                f'there is no limit state "{state}" in Table 3.2.I: {", ".join(PROBABILITIES)}'
            )
        state = PROBABILITIES[state]
    if not 0.0 < state < 1.0:
        raise AssessmentError(f"a probability of exceedance lies between 0 and 1, not {state:g}")
    return -positive(life, "the reference life V_R") / float(np.log1p(-state))


@dataclass(frozen=True, kw_only=True)
class NtcSpectrum(ShapedSpectrum):
    """Elastic spectrum of NTC 2018 3.2.3.2.1 and 3.2.3.2.3.

    S_S and T_D move with a_g, F_0 and T_C* do not.
    """

    amplification: float  # F_0
    reference_corner: float  # s, T_C*
    soil: str  # "A" to "E"
    topography: str  # "T1" to "T4"
    return_period: float | None = None  # years

    def __post_init__(self) -> None:
        checked_acceleration(self.ground_acceleration)
        positive(self.amplification, "F0", "give F_0 of the site and the return period")
        positive(self.reference_corner, "TC_star", "give T_C* of the site in s")
        object.__setattr__(self, "soil", checked_ground(self.soil, SOILS))
        if str(self.topography).upper() not in TOPOGRAPHIC:
            raise AssessmentError(
                f'there is no topography "{self.topography}": {", ".join(TOPOGRAPHIC)}'
            )
        object.__setattr__(self, "topography", str(self.topography).upper())

    @property
    def stratigraphic_factor(self) -> float:
        """S_S at this a_g, Table 3.2.IV."""
        least, first, second, most = STRATIGRAPHIC[self.soil]
        value = first - second * self.amplification * self.ground_acceleration / GRAVITY
        return min(max(value, least), most)

    @property
    def corner_factor(self) -> float:
        """C_C, Table 3.2.IV."""
        first, power = CORNER[self.soil]
        return first * float(self.reference_corner**power)

    @property
    def soil_factor(self) -> float:
        """S = S_S S_T, [3.2.3]."""
        return self.stratigraphic_factor * TOPOGRAPHIC[self.topography]

    @property
    def corner_period(self) -> float:
        """T_C = C_C T_C* [s], [3.2.5]."""
        return self.corner_factor * self.reference_corner

    @property
    def return_period_exponent(self) -> float:
        """T_R goes with a_g to this power."""
        return RETURN_PERIOD_EXPONENT

    @property
    def label(self) -> str:
        """For people."""
        return say(
            "ntc2018.label",
            soil=self.soil,
            topography=self.topography,
            ag=self.ground_acceleration / GRAVITY,
            F0=self.amplification,
            TC=self.reference_corner,
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed."""
        said: tuple[str, ...] = ()
        if self.topography != "T1":
            said += (say("ntc2018.topography", topography=self.topography),)
        if self.amplification < 2.2:
            said += (say("ntc2018.low_F0", F0=self.amplification),)
        return said

    @property
    def uncertain(self) -> tuple[str, ...]:
        """What was not checked against the official text."""
        said: tuple[str, ...] = (say("ntc2018.tables"),)
        if self.shape.displacement_corner > self.shape.long_period:
            corners = {"TD": self.shape.displacement_corner, "TE": self.shape.long_period}
            said += (say("ntc2018.strong", **corners),)
        return said

    @cached_property
    def shape(self) -> Shape:
        """The corners: T_B = T_C/3 [3.2.6], T_D = 4 a_g/g + 1.6 [3.2.7]."""
        long_period, ground_period = LONG_PERIODS[self.soil]
        return Shape(
            ground_acceleration=self.ground_acceleration,
            soil_factor=self.soil_factor,
            amplification=self.amplification,
            rise=self.corner_period / 3.0,
            corner=self.corner_period,
            displacement_corner=4.0 * self.ground_acceleration / GRAVITY + 1.6,
            long_period=long_period,
            ground_period=ground_period,
        )
