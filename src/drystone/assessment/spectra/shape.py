"""The shape that the elastic spectra of EN 1998-1 and NTC 2018 have in common."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.spectra.base import damping_factor, periods
from drystone.common.arrays import Array

#: Of the displacement of the ground, d_g = 0.025 a_g S T_C T_D; 1/4 pi^2 rounded by both codes.
GROUND_DISPLACEMENT = 0.025

FOUR_PI_SQUARED = 4.0 * math.pi**2


@dataclass(frozen=True, kw_only=True)
class Shape:
    """Elastic spectrum by its corners.

    EN 1998-1:2004 (3.2) to (3.5) and (A.1), (A.2); NTC 2018 [3.2.2] and [3.2.10] to [3.2.12].
    """

    ground_acceleration: float  # m/s2
    soil_factor: float  # S
    amplification: float  # 2.5, or F_0
    rise: float  # s, T_B
    corner: float  # s, T_C
    displacement_corner: float  # s, T_D
    long_period: float  # s, T_E
    ground_period: float  # s, T_F

    @property
    def nodes(self) -> Array:
        """Periods where the formula changes [s]."""
        return np.array(
            [self.rise, self.corner, self.displacement_corner, self.long_period, self.ground_period]
        )

    def sa(self, period: ArrayLike, damping: float) -> Array:
        """S_e [m/s2]: (3.2) to (3.5); above T_E what S_De says, (2 pi/T)^2 S_De."""
        t, eta = periods(period), damping_factor(damping)
        return np.array([self._sa(x, eta) for x in t.ravel().tolist()]).reshape(t.shape)

    def sd(self, period: ArrayLike, damping: float) -> Array:
        """S_De [m]: S_e (T/2 pi)^2 up to T_E, (A.1) to T_F, (A.2) above.

        The rounded 0.025 makes a step of -1.3 per cent at T_E.
        """
        t, eta = periods(period), damping_factor(damping)
        return np.array([self._sd(x, eta) for x in t.ravel().tolist()]).reshape(t.shape)

    def _sa(self, t: float, eta: float) -> float:
        if t > self.long_period:
            return self._long(t, eta) * FOUR_PI_SQUARED / t**2
        return self._short(t, eta)

    def _sd(self, t: float, eta: float) -> float:
        if t > self.long_period:
            return self._long(t, eta)
        return self._short(t, eta) * t**2 / FOUR_PI_SQUARED

    def _short(self, t: float, eta: float) -> float:
        level, plateau = self.ground_acceleration * self.soil_factor, eta * self.amplification
        tc, td = self.corner, self.displacement_corner
        if t < self.rise:
            return level * (1.0 + t / self.rise * (plateau - 1.0))
        if t <= tc:
            return level * plateau
        if t <= td:
            return level * plateau * tc / t
        return level * plateau * tc * td / t**2

    def _long(self, t: float, eta: float) -> float:
        ground = GROUND_DISPLACEMENT * self.ground_acceleration * self.soil_factor
        ground *= self.corner * self.displacement_corner
        plateau = eta * self.amplification
        share = (t - self.long_period) / (self.ground_period - self.long_period)
        return ground * (plateau + (1.0 - plateau) * min(share, 1.0))


@dataclass(frozen=True, kw_only=True)
class ShapedSpectrum(ABC):
    """What the spectra of both codes have in common: a `Spectrum` but for its own factors."""

    ground_acceleration: float  # m/s2, a_g on rock, which is ground A

    @property
    @abstractmethod
    def shape(self) -> Shape:
        """The corners at this ground acceleration."""

    @property
    def site_specific(self) -> bool:
        """Never: it is a code's formula."""
        return False

    @property
    def nodes(self) -> Array:
        """Periods where the formula changes [s]."""
        return self.shape.nodes

    def sa(self, period: ArrayLike, damping: float) -> Array:
        """S_e [m/s2] in the shape of ``period`` [s]; damping is a ratio."""
        return self.shape.sa(period, damping)

    def sd(self, period: ArrayLike, damping: float) -> Array:
        """S_De [m] in the shape of ``period`` [s]; damping is a ratio."""
        return self.shape.sd(period, damping)

    def scaled(self, ground_acceleration: float) -> Self:
        """The spectrum of another a_g [m/s2]; what the code ties to a_g moves with it."""
        return replace(self, ground_acceleration=float(ground_acceleration))


def checked_ground(name: str, known: tuple[str, ...]) -> str:
    """A ground or soil category in capitals; `AssessmentError` where there is no such one."""
    ground = str(name).upper()
    if ground not in known:
        raise AssessmentError(
            f'there is no ground "{name}": {", ".join(known)}; other grounds need a study of the '
            "site, whose spectrum is given as a table"
        )
    return ground


def checked_acceleration(value: float) -> float:
    """A ground acceleration [m/s2] above zero."""
    return positive(value, "the ground acceleration a_g", "give a_g of the site in m/s2")
