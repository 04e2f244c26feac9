"""Spectra at a height of a building, for mechanisms that do not stand on the ground.

Circolare 7/2019 to NTC 2018, C7.2.3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError, not_negative, positive
from drystone.assessment.spectra.base import Spectrum, damping_factor, periods
from drystone.common.arrays import Array
from drystone.common.language import say

#: a and b of (C7.2.6): the plateau of a floor spectrum lies between a T_k and b T_k.
BELOW, ABOVE = 0.8, 1.1


@dataclass(frozen=True, kw_only=True)
class Mode:
    """A mode of the building as the mechanism feels it."""

    period: float  # s, T_k
    participation: float  # gamma_k
    shape: float  # psi_k at the height of the mechanism
    damping: float  # xi_k, ratio

    def __post_init__(self) -> None:
        positive(self.period, "the building's period T_k")
        if not np.isfinite(self.participation * self.shape):
            raise AssessmentError("gamma_k and psi_k of a mode are numbers")
        positive(self.damping, "the building's damping xi_k", "give a ratio, 0.05 for 5 per cent")
        damping_factor(self.damping)


def masonry_period(building_height: float) -> float:
    """T_1 = 0.05 H^0.75 [s] of a masonry building of height H [m], Circ. 7/2019 (C7.3.2)."""
    return 0.05 * positive(building_height, "the building's height H") ** 0.75


def storeys_participation(storeys: int) -> float:
    """gamma_1 = 3 n/(2 n + 1) of n storeys, Circ. 7/2019 (C7.2.10)."""
    n = positive(storeys, "the number of storeys")
    return 3.0 * n / (2.0 * n + 1.0)


def first_mode(
    *,
    height: float,
    building_height: float,
    damping: float,
    storeys: int | None = None,
    participation: float | None = None,
    shape: float | None = None,
    period: float | None = None,
    period_factor: float = 1.0,
) -> tuple[Mode, tuple[str, ...]]:
    """The first mode of a building at a height, and what was assumed for it, a sentence each.

    Parameters
    ----------
    height, building_height
        z and H [m], both from the foundation.
    damping
        xi_1, a ratio; 0.10 to 0.20 of a damaged building, C8.7.1.2.1.4.
    storeys
        n, in place of ``participation``, (C7.2.10).
    shape
        psi_1(z); z/H where it is left out, (C7.2.10).
    period
        T_1 [s]; 0.05 H^0.75 where it is left out, (C7.3.2).
    period_factor
        1.5 to 2 of a damaged building, C8.7.1.2.1.4.
    """
    z = not_negative(height, "the height z of the mechanism")
    top = positive(building_height, "the building's height H")
    if z > top:
        raise AssessmentError(f"the mechanism at z = {z:g} m lies above the building's {top:g} m")
    said: tuple[str, ...] = ()
    if participation is None:
        if storeys is None:
            raise AssessmentError(
                "a mechanism at a height needs gamma_1: give it, or the number of storeys"
            )
        participation = storeys_participation(storeys)
        said += (say("floor.participation", value=participation, storeys=storeys),)
    if shape is None:
        shape = z / top
        said += (say("floor.shape", value=shape),)
    if period is None:
        period = masonry_period(top)
        said += (say("floor.period", value=period),)
    period *= positive(period_factor, "the factor of T_1")
    if period_factor != 1.0:
        said += (say("floor.longer", factor=period_factor, value=period),)
    mode = Mode(period=period, participation=participation, shape=shape, damping=damping)
    return mode, said


@dataclass(frozen=True, kw_only=True)
class FloorSpectrum:
    """Spectrum at a height, Circ. 7/2019 (C7.2.5) to (C7.2.8); a_g is that of the ground."""

    ground: Spectrum
    modes: tuple[Mode, ...]  # the first one first
    assumed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.modes:
            raise AssessmentError("a spectrum at a height needs a mode of the building")

    @property
    def ground_acceleration(self) -> float:
        """a_g [m/s2] of the ground."""
        return self.ground.ground_acceleration

    @property
    def soil_factor(self) -> float:
        """S of the ground."""
        return self.ground.soil_factor

    @property
    def corner_period(self) -> float:
        """T_C [s] of the ground."""
        return self.ground.corner_period

    @property
    def site_specific(self) -> bool:
        """As the spectrum of the ground."""
        return self.ground.site_specific

    @property
    def return_period(self) -> float | None:
        """As the spectrum of the ground."""
        return self.ground.return_period

    @property
    def return_period_exponent(self) -> float | None:
        """As the spectrum of the ground."""
        return getattr(self.ground, "return_period_exponent", None)

    @property
    def label(self) -> str:
        """For people."""
        return say("floor.label", ground=self.ground.label, T1=self.modes[0].period)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed."""
        return (*self.ground.notes, *self.assumed)

    @property
    def uncertain(self) -> tuple[str, ...]:
        """What the sources tell differently."""
        return (
            *self.ground.uncertain,
            say("floor.percent"),
        )

    @property
    def nodes(self) -> Array:
        """Periods where the formula changes [s]."""
        own = [f * mode.period for mode in self.modes for f in (BELOW, 1.0, ABOVE)]
        return np.unique(np.concatenate((getattr(self.ground, "nodes", np.empty(0)), own)))

    @property
    def accelerations(self) -> Array:
        """(n_modes,) a_Z,k [m/s2], (C7.2.7): S_e(T_k, xi_k) gamma_k psi_k sqrt(1 + 0.0004 xi^2)."""
        return np.array([self._acceleration(mode) for mode in self.modes])

    @property
    def acceleration(self) -> float:
        """a_Z [m/s2], the largest acceleration of the floor, (C7.2.8)."""
        return float(np.sqrt(np.sum(self.accelerations**2)))

    def amplification(self, mode: Mode, damping: float) -> float:
        """A_k = 1.1 xi_k^-0.5 eta(xi) of (C7.2.6), xi_k a ratio."""
        return 1.1 * mode.damping**-0.5 * damping_factor(damping)

    def sa(self, period: ArrayLike, damping: float) -> Array:
        """S_eZ [m/s2] in the shape of ``period`` [s], (C7.2.5); at zero it is a_Z.

        Above T_1 it is not less than the spectrum of the ground.
        """
        t = periods(period)
        square = np.zeros_like(t)
        for mode in self.modes:
            square += self._of_mode(t, damping, mode) ** 2
        value = np.sqrt(square)
        bound = np.maximum(value, self.ground.sa(t, damping))
        return np.where(t > self.modes[0].period, bound, value)

    def sd(self, period: ArrayLike, damping: float) -> Array:
        """Displacement demand [m] in the shape of ``period`` [s], (C8.7.1.12).

        S_eZ(T) T^2/4 pi^2, above b T_1 not less than S_eZ(T_1) (b T_1)^2/4 pi^2.
        """
        t = periods(period)
        value = self.sa(t, damping) * t**2
        edge = self.modes[0].period
        least = float(self.sa(edge, damping)) * (ABOVE * edge) ** 2
        value = np.where(t > ABOVE * edge, np.maximum(value, least), value)
        return value / (4.0 * np.pi**2)

    def scaled(self, ground_acceleration: float) -> FloorSpectrum:
        """On the ground's spectrum of another a_g [m/s2]."""
        return replace(self, ground=self.ground.scaled(ground_acceleration))

    def _acceleration(self, mode: Mode) -> float:
        level = float(self.ground.sa(mode.period, mode.damping))
        percent = 100.0 * mode.damping
        moved = abs(mode.participation * mode.shape)
        return level * moved * float(np.sqrt(1.0 + 0.0004 * percent**2))

    def _of_mode(self, t: Array, damping: float, mode: Mode) -> Array:
        """S_eZ,k [m/s2], (C7.2.6)."""
        top = self.amplification(mode, damping)
        below = np.maximum(1.0 - t / (BELOW * mode.period), 0.0) ** 1.6
        above = np.maximum(t / (ABOVE * mode.period) - 1.0, 0.0) ** 1.2
        return top * self._acceleration(mode) / (1.0 + (top - 1.0) * (below + above))
