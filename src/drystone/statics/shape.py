"""What the curve may hide within a step, from its tangents at both ends."""

from __future__ import annotations

import math

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array

#: Shares of a step at which its shape is looked at.  With 9 or 39 peaks of bonded walls move by up
#: to 8e-4: by where points lie, not by what is seen of a step.
SHARES = np.linspace(tolerances.FIRST_SHARE_SEEN, tolerances.LAST_SHARE_SEEN, 19)


def shape_between(
    start: float, end: float, slope: float, slope_end: float, increment: float
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Excess and bend of the curve within a step, see `StepSolution`, from its tangents at both
    ends: where these meet, the curve has its corner.

    One that rises by more than along either tangent has a steeper part between them, behind which
    it may have a peak: then it bends as a cubic does.  One that falls by more than along either has
    dropped between them, nobody knows where: it may have risen along the first tangent until then.
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
    # Of a smooth curve, the middle of a parabola is midway to where its tangents meet.
    bend = 0.5 * abs(corner - start - at * change), at
    return (corner - max(start, end), at), bend


def bend_of_cubic(rise: float, change: float, at_end: float) -> tuple[float, float]:
    """How far a cubic leaves its chord at most, and at what share of its length, that would rise by
    ``rise`` along its first tangent and by ``at_end`` along its last, and does by ``change``."""
    away = _off_chord(rise, change, at_end)
    off = int(np.argmax(np.abs(away)))
    return float(abs(away[off])), float(SHARES[off])


def excess_of_cubic(rise: float, change: float, at_end: float) -> tuple[float, float]:
    """By how much such a cubic exceeds both its ends, and at what share of its length."""
    above = SHARES * change + _off_chord(rise, change, at_end) - max(change, 0.0)
    top = int(np.argmax(above))
    return max(float(above[top]), 0.0), float(SHARES[top])


def _off_chord(rise: float, change: float, at_end: float) -> Array:
    """Of a cubic, from its chord, at `SHARES` of its length."""
    from_first, from_last = rise - change, at_end - change
    away: Array = SHARES * (1.0 - SHARES) * (from_first * (1.0 - SHARES) - from_last * SHARES)
    return away
