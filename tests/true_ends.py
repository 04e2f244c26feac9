"""Whether a curve has ended for a true reason, and whether its points at rest are balanced."""

from __future__ import annotations

from drystone.common.language import say
from drystone.control.ends import COLLAPSED
from drystone.results.curve import DYNAMIC, FINISHED, CapacityCurve, CurvePoint

#: Residual over the heaviest weight that a point at rest may leave; the engine keeps a tenth of it.
BALANCED = 1e-8
#: The control point has left the structure with its block: nothing more can be read.
LEFT = str(say("end.control_left"))
#: Begins the reason of a curve that has come as far as was asked.
REACHED = str(say("end.reached", most=0.0)).split("0")[0]


def at_rest(curve: CapacityCurve) -> list[CurvePoint]:
    """Points that no inertia holds."""
    return [point for point in curve.points if point.status != DYNAMIC]


def unbalanced(curve: CapacityCurve) -> list[CurvePoint]:
    """Points at rest that leave more than `BALANCED`."""
    return [point for point in at_rest(curve) if not point.residual <= BALANCED]


def why_no_end(curve: CapacityCurve) -> str:
    """Empty where the curve is over: down to the stop value at rest, collapsed in motion and saying
    so, as far as was asked, or its control point gone with its block."""
    last = curve.points[-1]
    if LEFT in curve.reason:
        return "" if curve.blocks_left else "no block has left"
    if curve.status != FINISHED:
        return f"{curve.status}: {curve.reason}"
    if COLLAPSED in curve.reason:
        return "" if last.status == DYNAMIC else "collapsed in motion, and ends at rest"
    if last.status == DYNAMIC:
        return f"ends in motion that is no collapse: {curve.reason}"
    if curve.reason.startswith(REACHED):
        return ""
    if last.load_multiplier > curve.stop_multiplier:
        return f"at rest under {last.load_multiplier:.3g}, which is not the end: {curve.reason}"
    return ""
