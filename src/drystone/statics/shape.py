"""Estimates of the curve within a step, from its tangents at both ends.

The multiplier may have a peak between the ends of a step.  These estimates show where a shorter
step is needed.
"""

from __future__ import annotations

import math

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array

#: Shares of a step at which the shape of the curve is evaluated.  With 9 or 39 shares, peaks of
#: bonded walls move by up to 8e-4, because points of the curve lie elsewhere, not because a step
#: would hide more.
SHARES = np.linspace(tolerances.FIRST_SHARE_SEEN, tolerances.LAST_SHARE_SEEN, 19)


def shape_between(
    start: float, end: float, slope: float, slope_end: float, increment: float
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Excess and bend of the curve within a step, see `StepSolution`, from its tangents at both
    ends.  The curve is taken to have a corner where the tangents meet.

    If the curve rises by more than along either tangent, it has a steeper part between the ends,
    behind which it may have a peak.  Its bend is then that of a cubic.  If the curve falls by more
    than along either tangent, it has dropped somewhere between the ends.  It may have risen along
    the first tangent before the drop.

    ``start`` and ``end`` are multipliers, ``slope`` and ``slope_end`` slopes [1/m] at the ends, and
    ``increment`` is the displacement [m].  Returns None for both if a slope is not known.
    """
    if not math.isfinite(slope + slope_end) or increment == 0.0:
        return None, None
    rise, at_end, change = slope * increment, slope_end * increment, end - start
    at = (change - at_end) / (rise - at_end) if rise != at_end else math.inf
    if change > max(rise, at_end, 0.0):
        return (0.0, 0.0), bend_of_cubic(rise, change, at_end)
    if change < min(rise, at_end):
        return (max(rise, 0.0) - max(change, 0.0), 0.5), (0.0, 0.0)
    if not 0.0 < at < 1.0:
        return (0.0, 0.0), (0.0, 0.0)
    corner = start + at * rise
    # A smooth curve bends half as far as the corner: a parabola passes midway between its chord
    # and the point where its tangents meet.
    bend = 0.5 * abs(corner - start - at * change), at
    return (corner - max(start, end), at), bend


def bend_of_cubic(rise: float, change: float, at_end: float) -> tuple[float, float]:
    """Largest distance of a cubic from its chord, and the share of its length where it is reached.

    The cubic rises by ``change``.  It would rise by ``rise`` along its first tangent, and by
    ``at_end`` along its last.
    """
    away = _off_chord(rise, change, at_end)
    off = int(np.argmax(np.abs(away)))
    return float(abs(away[off])), float(SHARES[off])


def excess_of_cubic(rise: float, change: float, at_end: float) -> tuple[float, float]:
    """By how much a cubic exceeds both its ends, and the share of its length where it does so most;
    see `bend_of_cubic`."""
    above = SHARES * change + _off_chord(rise, change, at_end) - max(change, 0.0)
    top = int(np.argmax(above))
    return max(float(above[top]), 0.0), float(SHARES[top])


def _off_chord(rise: float, change: float, at_end: float) -> Array:
    """Distances of a cubic from its chord, at `SHARES` of its length; see `bend_of_cubic`."""
    from_first, from_last = rise - change, at_end - change
    away: Array = SHARES * (1.0 - SHARES) * (from_first * (1.0 - SHARES) - from_last * SHARES)
    return away
