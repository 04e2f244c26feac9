"""Bilinear curves in place of a capacity curve, rule by rule."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drystone.assessment.errors import AssessmentError, positive
from drystone.common.arrays import Array
from drystone.common.language import say

#: Rules by name: what is level, where the first branch lies, where it ends unless that is given.
RULES: dict[str, str] = {
    "ec8": "level at the highest ordinate, first branch by equal area up to the displacement "
    "given: EN 1998-1:2004 (B.6)",
    "ntc2018": "first branch through 0.6 of the highest ordinate, level by equal area, up to a "
    "drop by 15 per cent: Circ. 7/2019 C7.3.4.2",
    "eighty_percent": "as ntc2018, up to a drop by 20 per cent: existing masonry, Circ. 7/2019 "
    "C8.7.1.3.1",
}

#: Share of the highest ordinate at which a rule's curve ends.
RESIDUAL = {"ntc2018": 0.85, "eighty_percent": 0.8}

#: Share of the highest ordinate that the first branch of NTC 2018 passes through; 0.7 in older use.
SECANT_SHARE = 0.6


@dataclass(frozen=True, kw_only=True)
class Bilinear:
    """Elastic up to the yield point, then level up to the ultimate displacement."""

    yield_displacement: float  # m
    yield_acceleration: float  # m/s2, or a multiplier where the curve was one
    ultimate_displacement: float  # m

    @property
    def period(self) -> float:
        """T* = 2 pi sqrt(m* d*_y/F*_y) [s]: EN 1998-1:2004 (B.7), Circ. 7/2019 (C7.3.6)."""
        return float(2.0 * np.pi * np.sqrt(self.yield_displacement / self.yield_acceleration))

    def at(self, displacement: ArrayLike) -> Array:
        """Ordinates at displacements."""
        d = np.asarray(displacement, dtype=np.float64)
        rising = d * (self.yield_acceleration / self.yield_displacement)
        level = np.minimum(rising, self.yield_acceleration)
        return np.where(d > self.ultimate_displacement, 0.0, level)


def drop_point(displacement: ArrayLike, ordinate: ArrayLike, share: float) -> float:
    """The displacement after the highest ordinate where a share of it is left, first met.

    Raises
    ------
    AssessmentError
        Where the curve ends above it.
    """
    d, f = _curve(displacement, ordinate)
    top = int(np.argmax(f))
    level = share * f[top]
    below = np.flatnonzero(f[top:] <= level)
    if not len(below):
        left = float(f[-1] / f[top])
        raise AssessmentError(say("refused.not_past", end=float(d[-1]), left=left, share=share))
    i = top + int(below[0])
    if i == 0:
        return float(d[0])
    part = (f[i - 1] - level) / (f[i - 1] - f[i])
    return float(d[i - 1] + part * (d[i] - d[i - 1]))


def bilinear(
    displacement: ArrayLike,
    ordinate: ArrayLike,
    rule: str,
    *,
    ultimate: float | None = None,
    secant_share: float = SECANT_SHARE,
) -> Bilinear:
    """The bilinear of a curve (n,) [m], (n,) by one of `RULES`.

    Parameters
    ----------
    ultimate
        Where it ends [m]; the rule "ec8" needs it, d*_m.
    secant_share
        Of the highest ordinate, where the first branch of the other rules passes through.
    """
    d, f = _curve(displacement, ordinate)
    if rule not in RULES:
        raise AssessmentError(f'there is no rule "{rule}": choose one of {", ".join(RULES)}')
    if ultimate is None:
        if rule == "ec8":
            raise AssessmentError('the rule "ec8" needs the displacement d*_m where it ends')
        ultimate = drop_point(d, f, RESIDUAL[rule])
    end = positive(ultimate, "the ultimate displacement")
    if end > d[-1] * (1.0 + 1e-12):
        raise AssessmentError(say("refused.short", last=float(d[-1]), end=end))
    before = d < end
    d, f = np.append(d[before], end), np.append(f[before], np.interp(end, d, f))
    area = float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(d)))
    if rule == "ec8":
        return _level_at_peak(float(f.max()), area, end)
    stiffness = initial_stiffness(d, f, secant_share)
    return _level_by_area(stiffness, area, end)


def initial_stiffness(displacement: ArrayLike, ordinate: ArrayLike, share: float) -> float:
    """Ordinate over displacement where a share of the highest ordinate is first reached [1/m]."""
    d, f = _curve(displacement, ordinate)
    if not 0.0 < share <= 1.0:
        raise AssessmentError(f"the share of the secant lies between 0 and 1, not {share:g}")
    level = share * f.max()
    if f[0] >= level:
        raise AssessmentError(say("refused.rigid"))
    i = int(np.argmax(f >= level))
    part = (level - f[i - 1]) / (f[i] - f[i - 1])
    return float(level / (d[i - 1] + part * (d[i] - d[i - 1])))


def _level_at_peak(top: float, area: float, end: float) -> Bilinear:
    """d*_y = 2 (d*_m - E*_m/F*_y), EN 1998-1:2004 (B.6)."""
    start = 2.0 * (end - area / top)
    if start <= 1e-12 * end:
        raise AssessmentError(say("refused.level"))
    if start >= end * (1.0 - 1e-12):
        raise AssessmentError(say("refused.softened", start=start, end=end))
    return Bilinear(yield_displacement=start, yield_acceleration=top, ultimate_displacement=end)


def _level_by_area(stiffness: float, area: float, end: float) -> Bilinear:
    """F_y = k d_u - sqrt((k d_u)^2 - 2 k E), k the first branch and E the area."""
    square = (stiffness * end) ** 2 - 2.0 * stiffness * area
    if square < -1e-12 * (stiffness * end) ** 2:
        raise AssessmentError(say("refused.area"))
    level = stiffness * end - float(np.sqrt(max(square, 0.0)))
    return Bilinear(
        yield_displacement=level / stiffness, yield_acceleration=level, ultimate_displacement=end
    )


def _curve(displacement: ArrayLike, ordinate: ArrayLike) -> tuple[Array, Array]:
    """A curve from the displacement zero, checked."""
    d = np.asarray(displacement, dtype=np.float64)
    f = np.asarray(ordinate, dtype=np.float64)
    if d.ndim != 1 or d.shape != f.shape or len(d) < 2 or not np.isfinite([d, f]).all():
        raise AssessmentError("a curve is two equal lists of two finite numbers or more")
    if d[0] < 0.0 or (np.diff(d) <= 0.0).any() or f.max() <= 0.0:
        raise AssessmentError("a curve has displacements that grow from zero and carries something")
    if d[0] > 0.0:
        return np.append(0.0, d), np.append(0.0, f)
    return d, f
