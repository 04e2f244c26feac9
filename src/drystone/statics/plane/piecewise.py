"""A static step in the plane: its linear pieces followed from the last equilibrium to the next.

The joint law is piecewise linear.  With friction there is no energy to minimise, and full Newton
steps do not converge if many contacts open, slide and stick at once.  So the pieces are followed
one by one (`statics.plane.path`).  The gradients of gaps and slips are constant meanwhile; they are
those at the predicted end of the step.  Then the gradients are computed anew.  The remaining error
is of second order in the error of the prediction, and is corrected in the same manner.

If a path turns back and never goes on, no equilibrium lies ahead: the structure snaps.  An unstable
equilibrium is never taken.  If a path is too long to be followed, the step is solved by the
interior-point method (`statics.interior`), which finds the same equilibria.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.contact.contacts import SLOT
from drystone.engines.base import TOO_FAR, Fold
from drystone.statics.equations import TOO_STIFF
from drystone.statics.plane import path
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.static_step import StepSolution

#: Reason of a step whose path ends at a fold: no equilibrium lies ahead.
TURNS_BACK = say("end.turns_back")
#: Reason of a step whose path is not followed to its end.
MANY_CHANGES = say("end.many_changes")

_ENDS = {
    path.FOLDED: TURNS_BACK,
    path.EXHAUSTED: MANY_CHANGES,
    path.SINGULAR: say("end.free_to_move"),
}


@dataclass(frozen=True, kw_only=True)
class PathSettings:
    """How long a path is followed."""

    #: Largest number of renewals of the gradients; most steps take two.
    renewals: int = 12
    #: Changes of contacts after which the interior-point method takes over.  It needs some 25
    #: iterations, each of which costs as much as ten changes: solutions, and a pass over all
    #: contacts.  Range: from 100 to 5000, peaks of published walls are the same to 1e-7, and that
    #: of a facade of 92 blocks to 3e-7.  A facade of 502 blocks takes 21, 11 and 9 s with 100, 250
    #: and 500; its peak is the same to 2e-5.
    changes: int = 250
    #: Changes in a row that bring the path no farther, after which the interior-point method takes
    #: over.  If many joints are at the limit of friction, changes may repeat each other; if the
    #: path turns back, there is nothing ahead to find.  Range: with 64 and 250, peaks of a facade
    #: of 92 blocks move by 1.6e-4, and a facade of 502 blocks takes 15.8 and 18.9 s (16.1 s with
    #: 128); with 64, random structures take a tenth more iterations.
    idle: int = 128
    #: Changes per contact of a last attempt, if these are more than `changes`.  It is made under a
    #: given load for which the interior-point method has found no equilibrium.
    changes_at_last: float = 2.0

    def at_last(self, n_contacts: int) -> int:
        """Largest number of changes of a last attempt, for this number of contacts."""
        return max(self.changes, int(self.changes_at_last * n_contacts))


# Long: one loop, in which each renewal of the gradients may end the step in its own way.
def follow(
    step: PlaneStep,
    guess: Array,
    multiplier: float,
    reaction: Array,
    settings: PathSettings,
    *,
    whole: bool,
    patient: bool = False,
) -> StepSolution:
    """Follow the pieces with gradients at the ``guess`` (n, n_dof), then renew the gradients and
    follow the pieces again, until the forces balance.

    The step is left evaluated where it has led.  ``reaction`` (n_slots, 2) [N] are the reactions at
    the start.  With ``whole``, sliding counts over the whole step from the start on, as in the
    implicit law.  With ``patient``, a path may have as many changes as a last attempt.
    """
    prescribed, accuracy, x = step.prescribed, step.accuracy, step.given
    start, reason, count = multiplier, "", 0
    follows = prescribed is not None or bool(step.given.any())
    most = settings.at_last(step.n) if patient else settings.changes
    idle = settings.idle if prescribed is not None else most
    begun = step.branch[: step.n].copy()
    step.evaluate(guess, multiplier)
    step.branch[: step.n] = begun
    step.reaction[: step.n, :2] = reaction[step.which[: step.n, SLOT]]
    step.way.fold[:] = np.nan
    excess = bend = 0.0, 0.0
    for count in range(1, settings.renewals + 1):
        x = x.copy()
        end, multiplier, changes = step.walk(
            x, multiplier, whole=whole or count > 1, patience=most, idle=idle
        )
        if end == path.DONE and follows and not step.stable:
            end = path.FOLDED
        if end != path.DONE:
            reason = _ENDS[end]
            break
        step.remember()
        moved = step.detector.farthest(x)
        if not moved <= accuracy.farthest:  # also if it is NaN
            reason = TOO_FAR
            break
        step.evaluate(x, multiplier)
        if count == 1 and prescribed:
            sense = -1.0 if prescribed.increment < 0.0 else 1.0
            excess, bend = _shape(step.bends(changes), start, multiplier, sense)
        enough = step.enough(moved)
        if enough > max(accuracy.coarsest, accuracy.tolerance):
            reason = TOO_STIFF
            break
        if step.residual > enough or abs(step.missing) > accuracy.lag:
            continue
        if not step.update_contacts():
            break
        step.evaluate(x, multiplier)
    else:
        reason = say("end.no_equilibrium", n=settings.renewals)
    fold = Fold(*step.way.fold.tolist())
    return StepSolution(
        increment=step.x.copy(),
        multiplier=step.multiplier,
        n_iterations=count,
        fold=fold if np.isfinite(fold.share) else None,
        excess=excess if not reason else None,
        bend=bend if not reason else None,
        reason=reason,
    )


def _shape(
    bends: Array, start: float, end: float, sense: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Excess and bend of a path, see `StepSolution`, from ``bends`` (n, 2): the share of the step
    and the multiplier at each change.

    ``start`` and ``end`` are the multipliers at the ends.  ``sense`` is the sign of the increment,
    1 or -1: multipliers are compared in that sense.
    """
    if len(bends) == 0:
        return (0.0, 0.0), (0.0, 0.0)
    share, multiplier = bends.T.tolist()  # lists, which are faster than arrays for a few numbers
    if sense < 0.0:
        start, end, multiplier = -start, -end, [-m for m in multiplier]
    top = max(range(len(share)), key=multiplier.__getitem__)
    off = [abs(m - start - t * (end - start)) for t, m in zip(share, multiplier, strict=True)]
    far = max(range(len(share)), key=off.__getitem__)
    return (multiplier[top] - max(start, end), share[top]), (off[far], share[far])
