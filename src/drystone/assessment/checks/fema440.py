"""Equivalent linearisation by FEMA 440 chapter 6, as a check: it was not made for rocking.

Written from second hand.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drystone.assessment.bilinear import Bilinear
from drystone.assessment.errors import AssessmentError
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum

#: Ductilities that the formulas given are fitted to.
LEAST_DUCTILITY, MOST_DUCTILITY = 1.0, 4.0

UNCERTAIN = ("FEMA 440 chapter 6: from second hand; the formulas of 1 < mu < 4 alone are at hand.",)


class EffectiveOscillator(NamedTuple):
    """The linear oscillator of a ductility, see `effective`."""

    period_ratio: float  # T_eff/T_0
    damping: float  # beta_eff, ratio
    reduction: float  # B, spectral accelerations are divided by it


def effective(ductility: float) -> EffectiveOscillator:
    """T_eff/T_0, beta_eff and B of 1 < mu < 4, FEMA 440 6.2.

    beta_eff = 4.9 (mu - 1)^2 - 1.1 (mu - 1)^3 + 5 per cent,
    T_eff/T_0 = 0.20 (mu - 1)^2 - 0.038 (mu - 1)^3 + 1, B = 4/(5.6 - ln beta_eff).

    Raises
    ------
    AssessmentError
        Outside 1 to 4.
    """
    if not LEAST_DUCTILITY <= ductility <= MOST_DUCTILITY:
        raise AssessmentError(
            f"FEMA 440 is known here for ductilities from 1 to 4, not {ductility:.3g}"
        )
    x = ductility - 1.0
    percent = 4.9 * x**2 - 1.1 * x**3 + 5.0
    ratio = 0.20 * x**2 - 0.038 * x**3 + 1.0
    return EffectiveOscillator(ratio, percent / 100.0, reduction(percent / 100.0))


def reduction(damping: float) -> float:
    """B = 4/(5.6 - ln beta), beta in per cent there and a ratio here, FEMA 440 (6-17)."""
    return 4.0 / (5.6 - math.log(100.0 * damping))


def madrs_factor(ductility: float, hardening: float = 0.0) -> float:
    """M = (T_eff/T_sec)^2 of the modified spectrum, T_sec/T_0 = sqrt(mu/(1 + alpha (mu - 1)))."""
    secant = ductility / (1.0 + hardening * (ductility - 1.0))
    return effective(ductility).period_ratio ** 2 / secant


def performance_point(spectrum: Spectrum, curve: Bilinear) -> float:
    """Displacement [m] of a bilinear in d*, a*: that of T_eff and beta_eff at its own ductility.

    S_a(T_eff, 5 %)/B; the elastic displacement where the bilinear does not yield.  The smallest
    solution counts.

    Raises
    ------
    AssessmentError
        Where there is none up to a ductility of 4.
    """
    base = curve.period

    def moved(ductility: float) -> float:
        found = effective(ductility)
        period = base * found.period_ratio
        return float(spectrum.sd(period, REFERENCE_DAMPING)) / found.reduction

    if float(spectrum.sd(base, REFERENCE_DAMPING)) <= curve.yield_displacement:
        return float(spectrum.sd(base, REFERENCE_DAMPING))
    last = LEAST_DUCTILITY
    for mu in np.linspace(LEAST_DUCTILITY, MOST_DUCTILITY, 301)[1:].tolist():
        if moved(mu) <= mu * curve.yield_displacement:
            low, high = last, mu
            for _ in range(80):
                middle = 0.5 * (low + high)
                if moved(middle) <= middle * curve.yield_displacement:
                    high = middle
                else:
                    low = middle
            return high * curve.yield_displacement
        last = mu
    raise AssessmentError(
        "FEMA 440 finds no displacement of a ductility up to 4: it does not apply; use non-linear "
        'dynamics, method "rocking"'
    )
