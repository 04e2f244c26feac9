"""Whether a curve has ended for a true reason, and whether its points at rest are balanced."""

from __future__ import annotations

import numpy as np

from drystone.common.language import say
from drystone.common.tolerances import COARSEST
from drystone.control.ends import COLLAPSED
from drystone.model.model import Model
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


def unbalanced(curve: CapacityCurve, most: float = BALANCED) -> list[CurvePoint]:
    """Points at rest that leave a residual of more than ``most``."""
    return [point for point in at_rest(curve) if not point.residual <= most]


def balance_of(model: Model) -> float:
    """Residual over the heaviest weight that a point at rest of a model may leave.

    `BALANCED`, or what rounding leaves where joints are stiff: a gap is a difference of coordinates
    of up to L, the extent of the structure, and known to 4 eps L; a joint of area A, as long as the
    smallest block, makes a force of k A 4 eps L of it, k being the larger of both stiffnesses.  No
    more than the engine takes for solved.
    """
    a = model.assembly
    laws = [a.joint, *a.joint_between.values()]
    stiffest = max(max(law.normal_stiffness or 0.0, law.shear_stiffness or 0.0) for law in laws)
    area = a.smallest_extent * (a.thickness if a.dimension == 2 else a.smallest_extent)
    extent = float(np.ptp(a.centroid[~a.fixed], axis=0).max()) + a.smallest_extent
    rounding = 4.0 * np.finfo(float).eps * extent * stiffest * area / float(a.heaviest_weight)
    return min(max(BALANCED, rounding), COARSEST)


def why_no_end(curve: CapacityCurve) -> str:
    """Empty where the curve is over: down to the stop value at rest, collapsed in motion and saying
    so, as far as was asked, or its control point lost with its block."""
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
