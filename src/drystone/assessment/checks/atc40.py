"""The capacity spectrum method of ATC-40 8.2.2.1, procedure A, as a check.

Written from second hand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError, positive
from drystone.common.arrays import Array
from drystone.model.assembly import GRAVITY

#: kappa by structural behaviour type for moderate loops; type C is the one of poor dissipation.
POOR_DISSIPATION = 0.33

#: Least SR_A and SR_V of type C, Table 8-2.
LEAST_SRA, LEAST_SRV = 0.56, 0.67

UNCERTAIN = ("ATC-40 8.2.2.1: from second hand; behaviour type C alone is at hand.",)


@dataclass(frozen=True, kw_only=True)
class PerformancePoint:
    """Where the capacity meets the reduced demand."""

    displacement: float  # m, d_p
    acceleration: float  # m/s2, a_p
    damping: float  # beta_eff, ratio
    yield_displacement: float  # m, d_y
    yield_acceleration: float  # m/s2, a_y


def effective_damping(
    yield_acceleration: float,
    yield_displacement: float,
    acceleration: float,
    displacement: float,
    kappa: float = POOR_DISSIPATION,
) -> float:
    """beta_eff, a ratio: 5 + 63.7 kappa (a_y d_p - d_y a_p)/(a_p d_p) per cent, (8-8)."""
    loop = yield_acceleration * displacement - yield_displacement * acceleration
    return 0.05 + 0.637 * kappa * loop / (acceleration * displacement)


def reductions(damping: float) -> tuple[float, float]:
    """SR_A = (3.21 - 0.68 ln beta)/2.12, SR_V = (2.31 - 0.41 ln beta)/1.65, (8-9), (8-10).

    beta in per cent there and a ratio here; not less than 0.56 and 0.67 of type C, nor above 1.
    """
    percent = math.log(100.0 * damping)
    sra = (3.21 - 0.68 * percent) / 2.12
    srv = (2.31 - 0.41 * percent) / 1.65
    return min(max(sra, LEAST_SRA), 1.0), min(max(srv, LEAST_SRV), 1.0)


def demand(period: float, ca: float, cv: float, damping: float) -> float:
    """Reduced acceleration [m/s2]: 2.5 C_A SR_A g, or C_V SR_V g/T where that is less."""
    sra, srv = reductions(damping)
    return GRAVITY * min(2.5 * ca * sra, cv * srv / period)


def performance_point(
    displacement: ArrayLike,
    acceleration: ArrayLike,
    *,
    ca: float,
    cv: float,
    kappa: float = POOR_DISSIPATION,
) -> PerformancePoint:
    """The smallest displacement at which the capacity (n,) [m], (n,) [m/s2] meets the demand.

    The first branch of the bilinear is that of the first point of the capacity, areas up to the
    performance point are equal.  The exact intersection: hand calculations stop within 5 per cent.

    Raises
    ------
    AssessmentError
        Where the capacity lies below the demand up to its end.
    """
    positive(ca, "C_A")
    positive(cv, "C_V")
    d = np.append(0.0, np.asarray(displacement, dtype=np.float64))
    a = np.append(0.0, np.asarray(acceleration, dtype=np.float64))
    if len(d) < 3 or not np.isfinite([d, a]).all() or (np.diff(d) <= 0.0).any():
        raise AssessmentError("a capacity of ATC-40 has displacements that grow from above zero")

    def at(x: float) -> PerformancePoint:
        return _point(d, a, x, kappa)

    def excess(x: float) -> float:
        point = at(x)
        period = 2.0 * math.pi * math.sqrt(x / point.acceleration)
        return demand(period, ca, cv, point.damping) - point.acceleration

    last = 0.0
    for x in np.linspace(0.0, d[-1], 1001)[1:].tolist():
        if excess(x) <= 0.0:
            low, high = last, x
            for _ in range(80):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if excess(middle) <= 0.0 else (middle, high)
            return at(high)
        last = x
    raise AssessmentError(
        f"the capacity lies below the demand up to its end at {d[-1]:.4g} m: ATC-40 finds no "
        "performance point; trace the curve further"
    )


def _point(d: Array, a: Array, x: float, kappa: float) -> PerformancePoint:
    """The bilinear of equal area through the capacity's point at x [m], and its damping."""
    stiffness = float(a[1] / d[1])
    end = float(np.interp(x, d, a))
    before = d < x
    px, py = np.append(d[before], x), np.append(a[before], end)
    area = float(np.sum(0.5 * (py[1:] + py[:-1]) * np.diff(px)))
    first = x
    if stiffness * x > end * (1.0 + 1e-12):
        first = (2.0 * area - end * x) / (stiffness * x - end)
    level = stiffness * first
    return PerformancePoint(
        displacement=x,
        acceleration=end,
        damping=max(effective_damping(level, first, end, x, kappa), 0.05),
        yield_displacement=first,
        yield_acceleration=level,
    )
