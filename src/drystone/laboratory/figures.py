"""Figures of a wall's curve, by the same functions for measured and computed ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.assessment.bilinear import RESIDUAL, Bilinear, bilinear, initial_stiffness
from drystone.assessment.errors import AssessmentError
from drystone.common.arrays import Array
from drystone.laboratory.walls import REVERSAL_NOISE, Wall
from drystone.results.cycles import Cycle, cycles_of, envelope

#: Drifts [%] at which forces are compared.
DRIFTS = (1.0, 2.0, 3.0)
#: Jump of force or displacement between two records, over its range in a cycle, from which on there
#: is a gap.
GAP = 0.4
#: Share of the peak at which the initial stiffness is read, and rule of the bilinear.
STIFFNESS_SHARE, RULE = 0.4, "eighty_percent"
#: Share of the peak that the bilinear's first branch passes through: that of the database (Vanin et
#: al. 2017), whose K_eff is the secant there.
SECANT_SHARE = 0.7


@dataclass(frozen=True, kw_only=True)
class Figures:
    """Of one sense; in SI units, drifts in per cent."""

    peak: float  # N
    peak_drift: float  # %
    stiffness: float  # N/m, secant at `STIFFNESS_SHARE` of the peak
    at_drift: tuple[float | None, ...]  # N, at `DRIFTS`; None beyond the end
    ultimate_drift: float  # %, at a drop by 20 %, or the end
    ends_before_drop: bool  # whether it ends there without that drop
    bilinear: Bilinear | None  # by `RULE` and `SECANT_SHARE`, up to the ultimate drift
    #: Whether more than `SECANT_SHARE` of the peak is carried where the curve passes zero: of loops
    #: in the sense that comes second.  There is no first branch then.
    begins_loaded: bool

    @property
    def bilinear_values(self) -> tuple[float | None, float | None, float]:
        """Level [kN], yield and ultimate drift [%]; None where there is no bilinear, or no first
        branch."""
        line = self.bilinear
        if line is None:
            return None, None, self.ultimate_drift
        share = self.ultimate_drift / line.ultimate_displacement  # % over m
        start = None if self.begins_loaded else share * line.yield_displacement
        return 1e-3 * line.yield_acceleration, start, self.ultimate_drift

    @property
    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        line = self.bilinear
        return {
            "peak": self.peak,
            "peak_drift": self.peak_drift,
            "stiffness": self.stiffness,
            "at_drift": dict(zip(map(str, DRIFTS), self.at_drift, strict=True)),
            "ultimate_drift": self.ultimate_drift,
            "ends_before_drop": self.ends_before_drop,
            "bilinear_force": line and line.yield_acceleration,
            "bilinear_yield_displacement": line and line.yield_displacement,
        }


def figures_of(wall: Wall, displacement: Array, force: Array, sense: float = 1.0) -> Figures:
    """Figures of a curve (n,) [m], (n,) [N] in a sense; of loops, of their envelope."""
    x, y = envelope(displacement, force, sense)
    x, y = sense * x, sense * y
    top = int(np.argmax(y))
    below = np.flatnonzero(y[top:] <= RESIDUAL[RULE] * y[top])
    end = float(x[top + below[0]]) if len(below) else float(x[-1])
    at = [0.01 * drift * wall.load_height for drift in DRIFTS]
    try:
        line = bilinear(x, y, RULE, ultimate=end, secant_share=SECANT_SHARE)
    except AssessmentError:
        line = None
    return Figures(
        peak=float(y[top]),
        peak_drift=wall.drift(float(x[top])),
        stiffness=initial_stiffness(x, y, STIFFNESS_SHARE),
        at_drift=tuple(float(np.interp(d, x, y)) if d <= x[-1] else None for d in at),
        ultimate_drift=wall.drift(end),
        ends_before_drop=not len(below),
        bilinear=line,
        begins_loaded=bool(y[1] > SECANT_SHARE * y[top]),
    )


def loops_of(displacement: Array, force: Array) -> tuple[Cycle, ...]:
    """Closed cycles that go to both sides, begin and end at zero, and have no gap in the record."""
    noise = REVERSAL_NOISE * float(np.abs(displacement).max())
    found = cycles_of(displacement, force, noise=noise)

    def at_zero(row: int) -> bool:
        """Whether zero is passed between a record and the next, or nearly there."""
        pair = displacement[row : row + 2]
        return bool(pair.min() <= 0.0 <= pair.max() or np.abs(pair).min() <= noise)

    def is_whole(c: Cycle) -> bool:
        if not (at_zero(c.first) and at_zero(max(c.last - 1, 0))):
            return False  # it turned before it came back
        rows = slice(c.first, c.last + 1)
        return all(
            float(np.abs(np.diff(values[rows])).max()) < GAP * float(np.ptp(values[rows]))
            for values in (displacement, force)
        )

    return tuple(c for c in found if c.closed and c.least < 0.0 < c.greatest and is_whole(c))


def amplitude(cycle: Cycle) -> float:
    """Mean of both senses [m]."""
    return 0.5 * (cycle.greatest - cycle.least)
