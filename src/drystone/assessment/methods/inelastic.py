"""Displacement of an elastic-plastic oscillator from the elastic spectrum."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from drystone.assessment.bilinear import Bilinear
from drystone.assessment.errors import AssessmentError
from drystone.assessment.spectra.base import REFERENCE_DAMPING, Spectrum
from drystone.assessment.spectra.floor import FloorSpectrum

#: d*_t need not exceed this many times d*_et, EN 1998-1:2004 B.5(b); NTC 2018 has no such rule.
EC8_MOST = 3.0


class Target(NamedTuple):
    """What an oscillator of a bilinear does under a spectrum."""

    displacement: float  # m, d*_t
    elastic_displacement: float  # m, d*_et
    strength_ratio: float  # q_u, q*: S_e(T*) m*/F*_y
    ductility: float  # mu: d*_t over d*_y


def inelastic_displacement(
    elastic_displacement: float,
    strength_ratio: float,
    period: float,
    corner_period: float,
    most: float | None = None,
) -> float:
    """d*_t [m] of d*_et [m], q_u, T* [s] and T_C [s].

    EN 1998-1:2004 (B.9), (B.10) and (B.12), Circ. 7/2019 (C7.3.7) and (C7.3.8): as large as the
    elastic one, below T_C d*_et/q_u (1 + (q_u - 1) T_C/T*), at most ``most`` times the elastic one.
    """
    if period >= corner_period or strength_ratio <= 1.0:
        return elastic_displacement
    share = (1.0 + (strength_ratio - 1.0) * corner_period / period) / strength_ratio
    if most is not None:
        share = min(share, most)
    return elastic_displacement * max(share, 1.0)


def target(spectrum: Spectrum, curve: Bilinear, most: float | None = None) -> Target:
    """The target displacement of a bilinear in d*, a*; ``most`` is 3 in EN 1998-1, else None."""
    period = curve.period
    elastic = float(spectrum.sd(period, REFERENCE_DAMPING))
    ratio = float(spectrum.sa(period, REFERENCE_DAMPING)) / curve.yield_acceleration
    moved = inelastic_displacement(elastic, ratio, period, spectrum.corner_period, most)
    return Target(moved, elastic, ratio, moved / curve.yield_displacement)


def check_on_the_ground(spectra: Iterable[Spectrum], method: str) -> None:
    """`AssessmentError` where a spectrum is at a height: the formulas know T_C of the ground."""
    if any(isinstance(spectrum, FloorSpectrum) for spectrum in spectra):
        raise AssessmentError(
            f'method "{method}" is for walls that stand on the ground: take the height out, or use '
            "a method for local mechanisms"
        )
