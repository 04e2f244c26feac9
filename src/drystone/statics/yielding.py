"""Steps of structures whose joints soften, are crushed or close hyperbolically.

The stiffness and the strengths of such joints change within a step.  A step is solved with constant
values: those that the contacts have at its end (`law.strengths`).  They are not known beforehand.
So the step is solved, the values at its end are read off, and the step is solved again until the
values no longer change.  Values of the end, not of the start, make the curve independent of the
length of steps.

From such a solution Newton's method continues with strengths that depend on the motion of the
blocks (`law.softening`).  It finds the strengths at the end in a few iterations if the structure
has a stable equilibrium.  If it has none, because a joint fails, the strengths are lowered from one
solution to the next, at the same prescribed displacement, until the structure has one.  That is a
snap, and Newton's method continues from its end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array, IntArray
from drystone.common.language import say
from drystone.contact.contacts import INTERCEPT
from drystone.geometry.motion import rotations
from drystone.law import softening
from drystone.law.branches import ACROSS, OPEN, TORN, TORN_STICKING
from drystone.law.strengths import Reached, difference
from drystone.statics.shape import bend_of_cubic, excess_of_cubic
from drystone.statics.stability import grows
from drystone.statics.static_step import StaticStep, StepSolution

#: Solutions of a step before it counts as failed: if joints may fail within it; and if a shorter
#: step can be tried instead.  With 15 to 60 of the former, twenty random walls end alike.  With 3
#: to 12 of the latter, seven peaks are the same to the last bit, and steps 2 to 6 % fewer.
MOST_SOLUTIONS, FEW_SOLUTIONS = 30, 3

#: Iterations of Newton's method, and halvings of one iteration.  With 4 to 8 halvings, seven peaks
#: are the same to the last bit; with 2, one peak moves by 3e-4.
MOST_ITERATIONS, MOST_HALVINGS = 20, 4


class YieldingStart(NamedTuple):
    """Where a step starts whose joints may yield."""

    history: Array  # (n_slots, N_HISTORY + dim - 2)
    gap: Array  # (n_slots,) m
    branch: IntArray  # (n_slots,)
    multiplier: float
    rise: float  # of the multiplier along the tangent; NaN if there is no tangent


_UNSOLVED = StepSolution(
    increment=np.zeros((0, 0)), multiplier=np.nan, n_iterations=1, excess=None, bend=None
)

SolveOnce = Callable[[Array, Array, IntArray, Array | None], StepSolution]


# Long: Newton's method and falling strengths alternate, each from what the other has found.
def solve(
    step: StaticStep,
    start: YieldingStart,
    solve_once: SolveOnce,
    put_at_prediction: Callable[[Array, Array], None],
    increment: float | None,
    *,
    may_snap: bool,
) -> StepSolution:
    """Solve a step; its equations are left evaluated at the solution, with its history.

    Parameters
    ----------
    solve_once
        Begins and solves the step.  Its arguments: the parameters of contacts and those of contacts
        made in the step, (n_slots, N_CURRENT) each; the branches (n_slots,) at the start; and the
        increments (n, n_dof) near which the step will end, None if not known.
    put_at_prediction
        Puts the step where it is expected to end, with the same parameters of contacts.
    increment
        Prescribed displacement [m]; None if there is none.
    may_snap
        Whether joints may fail within the step, so that it ends at an equilibrium far away.
    """
    law, history, prepared = step.pairs.law_of_slot, start.history, step.loaded.prepared
    strengths = prepared.strengths
    tolerance = tolerances.STRENGTHS_FIXED * prepared.assembly.heaviest_weight
    now = strengths.first(history, start.gap)
    current, iterations = strengths.current(law, history, now), 0
    fresh = strengths.fresh[law]
    first: StepSolution | None = None
    near: Array | None = None
    slope: float | None = None
    n_lowered, most = 0, MOST_SOLUTIONS if may_snap or not strengths.smooth else FEW_SOLUTIONS
    at_start = _EndOfStep(np.arange(len(law)), history, history, now, np.inf)
    solved = _UNSOLVED  # a curve that has a tangent is continued along it
    for k in range(most + 1):
        going: StepSolution | None = None
        end = at_start
        if k or not np.isfinite(start.rise):
            solved = solve_once(current, fresh, _fitting(start.branch, current), near)
            iterations = max(iterations, solved.n_iterations)
            solved = replace(solved, n_iterations=iterations)
            if not solved.reason:
                going, first = solved, first or solved
                end = _EndOfStep.of(step, history)
                if end.change <= tolerance:
                    strengths.write(law, end.reached, end.after)
                    if first is solved:  # nothing has yielded
                        return solved
                    return _shaped(solved, first, start, increment, slope, n_lowered > 0, may_snap)
                near = solved.increment
            elif k > 1 or np.isfinite(start.rise):
                return solved
        found = None
        if strengths.smooth:
            if not going:
                put_at_prediction(current, fresh)
            found = _converge(step, end, tolerances.LEFT * tolerance)
        if found:
            slope, near = found.slope, step.x.copy()
            current = strengths.current(law, end.before, found.reached)
            stood = _stood(step, history, found, current, solved, tolerance)
            if stood:
                return _shaped(stood, first, start, increment, slope, n_lowered > 0, may_snap)
            now = _at(found.reached, now, end.origin)
        elif going:
            now, n_lowered = _at(end.reached, now, end.origin), n_lowered + 1
        elif solved.reason:
            return solved
        after = strengths.current(law, end.before, found.reached if found else end.reached)
        current = strengths.current(law, history, now)
        fresh = np.where((end.origin < 0)[:, None], after, fresh)
    return replace(solved, reason=say("end.strengths"))


class _EndOfStep(NamedTuple):
    """Softening of the contacts where a step was last evaluated."""

    origin: IntArray  # (n_slots,) slot of each contact when the step started; -1 if it had none
    before: Array  # (n_slots, N_HISTORY + dim - 2) history where the step starts
    after: Array  # (n_slots, N_HISTORY + dim - 2) history where the step is; the step's own array
    reached: Reached
    change: float  # N, difference of the strengths reached from those that the step was solved with

    @classmethod
    def of(cls, step: StaticStep, history: Array) -> _EndOfStep:
        """The state of a step that starts with a ``history`` (n_slots, N_HISTORY + dim - 2)."""
        law, (after, gap, normal, area) = step.pairs.law_of_slot, step.ended()
        strengths = step.loaded.prepared.strengths
        before = np.where((step.origin < 0)[:, None], step.history_before, history[step.origin])
        reached = strengths.reached(law, before, after, gap)
        change = difference(strengths.current(law, before, reached), step.current, normal, area)
        # A copy: contacts may be found anew before it is used.
        return cls(step.origin.copy(), before, after, reached, change)


class _Converged(NamedTuple):
    """The end of Newton's method: the softening reached, and the tangent of the curve."""

    reached: Reached
    slope: float  # 1/m
    tangent: Array  # (n, n_dof)


def _stood(
    step: StaticStep,
    history: Array,
    found: _Converged,
    current: Array,
    solved: StepSolution,
    tolerance: float,
) -> StepSolution | None:
    """The end of Newton's method as a solution; None if it is no equilibrium.

    It must balance with the ``current`` parameters of joints (n_slots, N_CURRENT), those at this
    end, and nothing may change with them.  The step then has the history of its end.  Figures that
    are not known here are those of ``solved``, the last solution with constant strengths.
    """
    step.take(current)
    moved = step.detector.farthest(step.x)
    if not (step.balanced() and moved <= step.accuracy.farthest) or step.update_contacts():
        return None
    there = _EndOfStep.of(step, history)
    if there.change > tolerance:
        return None
    law, strengths = step.pairs.law_of_slot, step.loaded.prepared.strengths
    strengths.write(law, there.reached, there.after)
    return replace(
        solved,
        increment=step.x.copy(),
        multiplier=step.multiplier,
        excess=solved.excess or (0.0, 0.0),
        bend=solved.bend or (0.0, 0.0),
        slope=found.slope,
        tangent=found.tangent,
        fold=None,
        unstable=False,
        reason="",
    )


def _converge(step: StaticStep, end: _EndOfStep, enough: float) -> _Converged | None:
    """Newton's method with strengths that depend on the motion, from where the step is.

    Returns None if it leads to no stable equilibrium.  ``end`` is the state of softening where it
    starts; ``enough`` [N] is the unbalanced force that may be left.
    """
    slot, point = step.soften(end.before)
    for _ in range(MOST_ITERATIONS):
        residual = step.residual
        if residual <= enough and abs(step.missing) <= tolerances.MISSING:
            break
        by_multiplier = step.aim() if np.isfinite(residual) else np.nan
        direction, length = step.bordered.columns[0], 1.0
        most = float(np.abs(rotations(direction)).max())
        if not (np.isfinite(by_multiplier) and most < tolerances.FARTHEST_ROTATION):
            return None
        step.multiplier += by_multiplier
        step.move(direction, 1.0)
        slot, point = step.soften(end.before)
        for _ in range(MOST_HALVINGS):
            if step.residual < max(residual, enough):
                break
            length *= 0.5
            step.multiplier -= length * by_multiplier
            step.move(direction, -length)
            slot, point = step.soften(end.before)
        else:
            if not step.residual < max(residual, enough):
                return None
    else:
        return None
    slope, tangent = step.slope(), step.bordered.columns[0].copy()
    if slope is None or not (step.stable and np.isfinite(slope)) or grows(step):
        return None
    reached = Reached(*(a.copy() for a in end.reached))
    for own, column in (
        (reached.softened, softening.P_SOFTENED),
        (reached.opened, softening.P_OPENED),
        (reached.slid, softening.P_SLID),
        (reached.crushed, softening.P_CRUSHED),
    ):
        own[slot] = point[:, column]
    reached.gap[slot] = step.ended()[1][slot] + reached.crushed[slot]
    return _Converged(reached, slope, tangent)


def _at(then: Reached, now: Reached, origin: IntArray) -> Reached:
    """The state ``now``, listed by slots at the start of the step, with the values of ``then``
    written over it; ``origin`` (n_slots,) is the slot at the start of each contact in ``then``."""
    known = origin >= 0
    found = []
    for mine, theirs in zip(now, then, strict=True):
        at = mine.copy()
        at[origin[known]] = theirs[known]
        found.append(at)
    return Reached(*found)


def _shaped(
    solved: StepSolution,
    first: StepSolution | None,
    start: YieldingStart,
    increment: float | None,
    slope: float | None,
    lowered: bool,
    may_snap: bool,
) -> StepSolution:
    """The solution of a step with its excess, bend and slope; see `StepSolution`.

    If the curve has tangents at both ends, excess and bend are those of the cubic between them.  If
    strengths were ``lowered`` without ``may_snap``, the curve may have followed the first
    tangent to just before the end.
    """
    if increment is None:
        return replace(solved, excess=None)
    sense = -1.0 if increment < 0.0 else 1.0  # multipliers are compared in the sense of the motion
    before, after = sense * start.multiplier, sense * solved.multiplier
    known = sense * first.multiplier if first else after
    rise = sense * start.rise if np.isfinite(start.rise) else known - before
    change, top = after - before, max(before, after)
    if lowered and may_snap:
        return replace(solved, excess=None, bend=None)
    if lowered:
        off = abs(rise - change)
        return replace(solved, excess=(before + max(rise, 0.0) - top, 0.5), bend=(off, 0.5))
    at_end = change if slope is None else slope * abs(increment)
    excess = 0.0, 0.0
    if rise > 0.0 > at_end:
        # The peak may be a corner, where the tangents meet; or that of the cubic, if it is higher.
        share = min(max((change - at_end) / (rise - at_end), 0.0), 1.0)
        at_corner = max(before + share * rise - top, 0.0), share
        excess = max(at_corner, excess_of_cubic(rise, change, at_end))
    if first and not np.isfinite(start.rise):
        excess = _hidden(first, solved, before, sense) or excess
    bend = max(solved.bend or (0.0, 0.0), bend_of_cubic(rise, change, at_end))
    bend = bend[0], min(bend[1], tolerances.FARTHEST_AGAIN)
    if slope is None:
        return replace(solved, excess=excess, bend=bend)
    return replace(solved, excess=excess, bend=bend, slope=slope, softened=True)


def _hidden(
    first: StepSolution, last: StepSolution, multiplier: float, sense: float
) -> tuple[float, float] | None:
    """The excess of the curve within the step, see `StepSolution`, from the ``first`` and the
    ``last`` solution; None if it cannot be told.

    The multiplier is no higher than with the strengths at the start, as in the first solution.  If
    the path of the first solution is straight, the curve departs from it with the square of the
    displacement.
    """
    if first.excess is None or first.bend is None:
        return None
    with_start, with_end = sense * first.multiplier, sense * last.multiplier
    rise, drop = with_start - multiplier, with_start - with_end
    if abs(first.bend[0]) <= tolerances.STRAIGHT * abs(drop) and first.excess[0] <= 0.0:
        if drop <= 0.0 or not 0.0 < rise < 2.0 * drop:
            return 0.0, 0.0
        top = multiplier + 0.25 * rise * rise / drop
        return top - max(with_end, multiplier), 0.5 * rise / drop
    highest = max(with_start, multiplier) + max(first.excess[0], 0.0)
    share = first.excess[1] if first.excess[0] > 0.0 else first.bend[1]
    return highest - max(with_end, multiplier), share


def _fitting(branch: IntArray, current: Array) -> IntArray:
    """The branches (n_slots,), changed to such as exist with the ``current`` parameters (n_slots,
    N_CURRENT).

    A torn contact has a cohesion intercept: without one it is open, and an open one with an
    intercept is torn.
    """
    intercept, torn = current[:, INTERCEPT] > 0.0, ACROSS[branch] == TORN
    fitting = np.where((branch == OPEN) & intercept, TORN_STICKING, branch)
    return np.where(torn & ~intercept, OPEN, fitting)
