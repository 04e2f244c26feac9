"""Elastic spectra from a table, as a study of the site gives them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.columns import checked_columns, read_columns, unit_of
from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.spectra.base import damping_factor, periods
from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.model.assembly import GRAVITY
from drystone.model.construction.contents import Held, name_of

HEADER = ("T", "Se")

#: Largest acceleration of the ground [g] that is none of another unit; that of [site] ag, too.
MOST = 10.0


@dataclass(frozen=True, kw_only=True, eq=False)
class TableSpectrum:
    """Elastic spectrum by points: straight between them, S_De constant beyond the last one.

    Its first period is zero, where it is the acceleration of the surface.
    """

    table_period: Array  # (n,) s, from zero upwards
    table_acceleration: Array  # (n,) m/s2, of the surface
    table_damping: float  # ratio
    soil_factor: float = 1.0  # a_g = S_e(0)/S
    corner: float | None = None  # s, T_C; None: 2 pi max(PSV)/max(S_e)
    site_specific: bool = True
    return_period: float | None = None  # years
    label: str = say("table.unnamed")

    def __post_init__(self) -> None:
        t, a = checked_columns(self.table_period, self.table_acceleration, self.label, "period")
        if t[0] != 0.0:
            raise AssessmentError(
                f"{self.label}: the first period is {t[0]:g} s; begin with T = 0, the acceleration "
                "of the ground"
            )
        if a[0] <= 0.0 or (a < 0.0).any():
            i = int(np.argmin(a))
            raise AssessmentError(
                f"{self.label}: the value at {t[i]:g} s is {a[i]:g}; accelerations are not below "
                "zero, and that of the ground is above it"
            )
        if not (a[1:] > 0.0).any():
            raise AssessmentError(
                f"{self.label}: no value after the first is above zero: that is no spectrum"
            )
        damping_factor(self.table_damping)
        positive(self.soil_factor, "the soil factor S")
        if self.corner is not None:
            positive(self.corner, "the corner period T_C")
        object.__setattr__(self, "table_period", t)
        object.__setattr__(self, "table_acceleration", a)

    @property
    def ground_acceleration(self) -> float:
        """a_g = S_e(0)/S [m/s2]."""
        return float(self.table_acceleration[0]) / self.soil_factor

    @cached_property
    def corner_period(self) -> float:
        """T_C [s]: as given, or 2 pi max(PSV)/max(S_e) over the points."""
        if self.corner is not None:
            return self.corner
        largest = float(np.max(self.table_acceleration * self.table_period))
        return largest / float(np.max(self.table_acceleration))

    @property
    def nodes(self) -> Array:
        """Periods of the points [s]."""
        return self.table_period

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed."""
        percent = 100.0 * self.table_damping
        said: tuple[str, ...] = (
            say("table.ends", last=float(self.table_period[-1])),
            say("table.damping", percent=percent),
        )
        if self.corner is None:
            said += (say("table.corner", TC=self.corner_period),)
        if self.soil_factor == 1.0:
            said += (say("table.surface"),)
        return said

    @property
    def uncertain(self) -> tuple[str, ...]:
        """Nothing: it is the engineer's."""
        return ()

    def sa(self, period: ArrayLike, damping: float) -> Array:
        """S_e [m/s2] in the shape of ``period`` [s]; damping is a ratio.

        Of another damping than the table's, by eta from T_B = T_C/3 on, NTC 2018 [3.2.5].  The
        ground itself has no damping: between, S_e = a_g S (1 + (eta F - 1) T/T_B), as of codes.
        """
        t = periods(period)
        last = float(self.table_period[-1])
        value = np.interp(t, self.table_period, self.table_acceleration)
        value = np.where(t > last, value * (last / np.maximum(t, last)) ** 2, value)
        more = damping_factor(damping) / damping_factor(self.table_damping) - 1.0
        before = np.maximum(1.0 - 3.0 * t / self.corner_period, 0.0)
        return value + more * (value - before * self.table_acceleration[0])

    def sd(self, period: ArrayLike, damping: float) -> Array:
        """S_De = S_e (T/2 pi)^2 [m] in the shape of ``period`` [s]."""
        t = periods(period)
        return self.sa(t, damping) * t**2 / (4.0 * np.pi**2)

    def scaled(self, ground_acceleration: float) -> TableSpectrum:
        """All ordinates in proportion to a_g [m/s2]: the soil factor and T_C stay."""
        new = positive(ground_acceleration, "the ground acceleration a_g")
        factor = new / self.ground_acceleration
        return replace(
            self,
            table_acceleration=self.table_acceleration * factor,
            corner=self.corner_period,
        )


def read_spectrum(
    path: str | Path | Held,
    *,
    unit: str,
    damping: float,
    soil_factor: float = 1.0,
    corner_period: float | None = None,
    site_specific: bool = True,
    return_period: float | None = None,
) -> TableSpectrum:
    """The spectrum in a CSV file with the header ``T,Se``, periods in s from zero upwards.

    Parameters
    ----------
    unit
        Of the accelerations: "g" or "m/s2".
    damping
        Of the table, a ratio.
    soil_factor
        S that the table holds; a_g is S_e(0)/S.
    site_specific
        False for a code's formula in points: local mechanisms then look at one period alone.

    Raises
    ------
    AssessmentError
        Where the file is missing or is no spectrum: names the line and what would mend it.
    """
    name = say("table.name", file=name_of(path))
    factor = unit_of(unit, name)
    period, value = read_columns(path, HEADER, name)
    if value[0] * factor > MOST * GRAVITY:
        raise AssessmentError(
            f"{name}: the ground acceleration S_e(0) is {value[0]:g} {unit}, more than "
            f"{MOST:g} g: look at the unit of the table"
        )
    return TableSpectrum(
        table_period=period,
        table_acceleration=value * factor,
        table_damping=damping,
        soil_factor=soil_factor,
        corner=corner_period,
        site_specific=site_specific,
        return_period=return_period,
        label=name,
    )
