"""A static step as a whole: the methods that are tried, and the report.

A step may also end at an unstable equilibrium.  Its report then says so; see `statics.stability`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array
from drystone.common.language import say
from drystone.engines.base import TOO_FAR, Fold
from drystone.law.branches import BONDED
from drystone.statics.equations import TOO_STIFF
from drystone.statics.interior import FEW_ITERATIONS, MAX_ITERATIONS, InteriorPoint
from drystone.statics.plane import piecewise
from drystone.statics.plane.piecewise import PathSettings
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.shape import shape_between
from drystone.statics.stability import Judged, growing, judge
from drystone.statics.static_step import StaticStep, StepSolution

#: Distances from an unstable equilibrium at which a stable one is looked for, over the smallest
#: extent.
DEPARTURES = np.geomspace(tolerances.LEAST_DEPARTURE, tolerances.MOST_DEPARTURE, 7)


#: Times that the contacts of a step are updated and the step is solved again.
CONTACT_UPDATES = 3


@dataclass(frozen=True, kw_only=True)
class SolutionSettings:
    """How steps are solved."""

    #: How long linear pieces are followed, which exist in the plane only; None: they are not.
    path: PathSettings | None = field(default_factory=PathSettings)


class _Solver(InteriorPoint):
    """The interior-point method and Newton's method, tried in an order that fits the step."""

    def find(
        self, guess: Array, multiplier: float, *, warm: bool, full_search: bool, follows: bool
    ) -> bool:
        """Find an equilibrium from a ``guess`` (n, n_dof); whether one has been found.

        With ``warm``, Newton's method is tried first, because the guess is near.  A step that
        ``follows`` a curve has one attempt of the interior-point method, as has a step with a
        prescribed displacement.  Without a ``full_search`` the attempt is the only one, and short.
        """
        step = self.step
        if warm:
            step.restart(guess, multiplier)
            if self.newton_from_start():
                return True
        most = MAX_ITERATIONS if full_search else FEW_ITERATIONS
        step.restart(guess, multiplier)
        if self.interior(most, soon=not full_search):
            return True
        if follows or not full_search or step.prescribed is not None:
            return False  # if this is not found, motion or a shorter step is tried
        step.restart(guess, multiplier)
        return self.interior(most, least_damping=tolerances.LEAST_DAMPING)

    def update_contacts(self) -> bool:
        """Solve again, at most `CONTACT_UPDATES` times, while blocks press each other at contacts
        that were not followed; whether an equilibrium is found."""
        step = self.step
        for _ in range(CONTACT_UPDATES):
            x, multiplier = step.x.copy(), step.multiplier
            if not step.update_contacts():
                return True
            step.restart(x, multiplier)
            if not (
                self.newton(8)
                or self.find(x, multiplier, warm=False, full_search=True, follows=False)
            ):
                return False
        return True


def _due(times: int) -> bool:
    """Whether to try again what has failed so many ``times`` in a row: after 0, 1, 2, 4, 8, ...
    failures."""
    return times & (times - 1) == 0


def _leave(solver: _Solver) -> Judged | None:
    """Find a stable equilibrium beside the unstable one that the step is at.

    It is looked for on both sides, along the growing mode.  Returns None if there is none; the
    poses of the step are then arbitrary.

    A structure may have two ways to go: either pier of a portal may tilt, or a column may turn to
    either side of its diagonal.  The equilibrium between the two is unstable, and no structure
    stays in it.  Imperfections decide which way a structure goes.  If both ways lead to an
    equilibrium, the one that carries less is taken.
    """
    step = solver.step
    way, x, multiplier = growing(step), step.x.copy(), step.multiplier
    if way is None:
        return None
    backwards = step.prescribed is not None and step.prescribed.increment < 0.0

    def beside(length: float) -> Judged | None:
        step.again()
        start = x + length * way
        if not solver.find(start, multiplier, warm=True, full_search=False, follows=True):
            return None
        found = _updated(solver, follows=True)
        return found if found and found.stable else None

    for length in DEPARTURES * step.loaded.prepared.assembly.smallest_extent:
        one, of_one = beside(length), step.multiplier
        other = beside(-length)
        less = step.multiplier > of_one if backwards else step.multiplier < of_one
        if other and (one is None or less):
            return other
        if one:
            return beside(length)
    return None


@dataclass(frozen=True, kw_only=True)
class StepStart:
    """Where a step begins, and what is known from the steps before."""

    guesses: Sequence[Array]  # increments (n, n_dof) near which the step may end
    multiplier: float  # at the start; without a prescribed displacement, the one asked for
    reaction: Array  # of all contacts, (n_slots, dim) [N]
    along: Array | None = None  # (n, n_dof) the increments along the curve, if they are known
    repeats: bool = False  # whether the guess is where the step ended with other strengths
    slope: float = math.nan  # 1/m, of the curve, if it is known
    unstable: int = 0  # unstable equilibria in a row, the one at the start included
    may_leave: bool = True  # whether a stable equilibrium is looked for beside an unstable one
    in_vain: int = 0  # steps in a row that Newton's method along the curve has not completed


@dataclass(frozen=True, kw_only=True)
class _Followed:
    """Outcome of following the linear pieces."""

    solution: StepSolution | None = None  # None: another method is to be tried
    fold: Fold | None = None
    full_search: bool  # whether the other method is to search in full
    at_last: Callable[[], StepSolution] | None = None  # to be tried if nothing else succeeds


def solve(
    step: StaticStep,
    start: StepStart,
    settings: SolutionSettings,
    *,
    dynamic: bool = False,
    full_search: bool = True,
    beyond: bool = False,
) -> StepSolution:
    """Solve a step that has begun; its equations are left evaluated at the solution.

    A step that fails returns a solution with a ``reason``.

    Parameters
    ----------
    dynamic
        Whether the step is a step in time, in which inertia regularises unstable directions.
    full_search
        Whether more than the first method is tried.
    beyond
        Whether an equilibrium is looked for beyond a fold of the path, on the path of the implicit
        law.
    """
    if step.prescribed is None and _stands(step, start.guesses[0], start.multiplier):
        return StepSolution(increment=step.x.copy(), multiplier=start.multiplier, n_iterations=0)
    followed = _Followed(full_search=full_search)
    if settings.path is not None and isinstance(step, PlaneStep):
        whole = step.prescribed is None or dynamic or beyond
        followed = _follow(step, start, settings.path, whole=whole, full_search=full_search)
        if followed.solution is not None:
            return followed.solution
    solved, found = _by_iterations(step, start, followed, dynamic=dynamic)
    if found or solved.reason == TOO_STIFF or followed.at_last is None:
        return solved
    step.again()
    last = followed.at_last()
    return replace(last, n_iterations=solved.n_iterations + last.n_iterations)


def _follow(
    step: PlaneStep, start: StepStart, settings: PathSettings, *, whole: bool, full_search: bool
) -> _Followed:
    """Follow the linear pieces of a step, and choose what is to be tried if that fails."""
    prescribed = step.prescribed
    follow = partial(
        piecewise.follow, step, start.guesses[0], start.multiplier, start.reaction, settings
    )
    solution = follow(whole=whole)
    # At a fold there is no equilibrium ahead: the structure goes on in motion.
    folded = solution.reason == piecewise.TURNS_BACK and prescribed is not None
    if not solution.reason or folded or solution.reason == TOO_STIFF:
        return _Followed(solution=solution, full_search=full_search)
    step.again()
    # A shorter step costs less than a full search, unless its path has as many changes.
    given_up, at_last = solution.reason == piecewise.MANY_CHANGES, None
    if prescribed is not None:
        full_search = full_search and given_up
    elif given_up and settings.at_last(step.n) > settings.changes:
        at_last = partial(follow, whole=True, patient=True)
    return _Followed(fold=solution.fold, full_search=full_search, at_last=at_last)


def _by_iterations(
    step: StaticStep,
    start: StepStart,
    followed: _Followed,
    *,
    dynamic: bool,
) -> tuple[StepSolution, bool]:
    """Solve the step by Newton's method along the curve, or else by the interior-point method.

    Returns the solution, and whether there is an equilibrium.
    """
    prescribed, driven = step.prescribed, step.detector.farthest(step.given)
    solver, slope = _Solver(step), start.slope
    follows = (prescribed is not None or driven > 0.0) and not dynamic  # a curve of equilibria
    if follows and prescribed is not None and not math.isfinite(slope):
        slope = _slope_at_start(step, start.multiplier)
        solver.iterations = 1  # a factorisation counts as one
    guess = _nearest(step, start.guesses, start.multiplier)
    along, found, in_vain = start.along if follows else None, None, start.in_vain
    # A single unstable equilibrium says little: a stable one nearly always lies within
    # micrometres.  If several follow in a row, the structure is on a branch that it would leave.
    due = prescribed is None or (start.unstable > 0 and _due(start.unstable))
    leaves = start.may_leave and due
    if along is not None:
        # If many contacts change their branch in each step, this nearly always fails.
        if _due(in_vain):
            found = _along_curve(solver, guess, along, start.multiplier)
        in_vain = 0 if found and found.stable else in_vain + 1
    if found and not found.stable and leaves:
        found, leaves = _leave(solver), False
    if not (found and found.stable):
        found = _from_within(
            solver, guess, start,
            full_search=followed.full_search, follows=follows, leaves=leaves,
        )  # fmt: skip
    begun = replace(start, slope=slope, along=along, in_vain=in_vain)
    return _reported(solver, begun, followed.fold, found), found is not None


def _reported(
    solver: _Solver, start: StepStart, fold: Fold | None, found: Judged | None
) -> StepSolution:
    """The solution that reports the equilibrium ``found``, or the reason why there is none."""
    step, prescribed = solver.step, solver.step.prescribed
    moved, reason = step.detector.farthest(step.x), ""
    if found and not found.stable and (fold is None or math.isfinite(fold.drop)):
        fold = Fold(1.0, step.multiplier)
    stable, end, tangent = found or Judged(stable=True)
    if not found:
        reason = say("end.no_equilibrium", n=solver.iterations)
        if step.residual <= step.accuracy.coarsest < step.enough(moved):
            reason = TOO_STIFF
    elif not moved <= step.accuracy.farthest:
        reason = TOO_FAR
    increment = prescribed.increment if prescribed else step.detector.farthest(step.given)
    sense = -1.0 if increment < 0.0 else 1.0  # multipliers are compared in the sense of the motion
    begun, ended = sense * start.multiplier, sense * step.multiplier
    excess, bend = shape_between(begun, ended, start.slope, end, sense * increment)
    return StepSolution(
        increment=step.x.copy(),
        multiplier=step.multiplier,
        n_iterations=solver.iterations,
        fold=fold,
        excess=excess if not reason else None,
        bend=bend if not reason else None,
        deviation=None if start.along is None else deviation(step, step.x, start.along),
        slope=end,
        tangent=tangent,
        unstable=not stable,
        in_vain=start.in_vain,
        reason=reason,
    )


def _along_curve(solver: _Solver, guess: Array, along: Array, multiplier: float) -> Judged | None:
    """Find an equilibrium by Newton's method along the curve; None if it finds none."""
    there = solver.newton_along(guess, along, multiplier)
    return _updated(solver, follows=True) if there else None


def _from_within(
    solver: _Solver,
    guess: Array,
    start: StepStart,
    *,
    full_search: bool,
    follows: bool,
    leaves: bool,
) -> Judged | None:
    """Find an equilibrium by the interior-point method; None if it finds none.

    If the equilibrium is unstable and the structure ``leaves`` unstable equilibria, a stable one
    beside it is looked for.
    """

    def reach() -> Judged | None:
        solver.step.again()
        there = solver.find(
            guess, start.multiplier, warm=start.repeats, full_search=full_search, follows=follows
        )
        return _updated(solver, follows=follows) if there else None

    found = reach()
    if found and not found.stable and leaves:
        found = _leave(solver) or reach()
    return found


def _updated(solver: _Solver, *, follows: bool) -> Judged | None:
    """Update the contacts of an equilibrium, and solve it again with them; None if that fails.

    Its stability is judged if the step ``follows`` a curve; otherwise it counts as stable.
    """
    if not solver.update_contacts():
        return None
    return judge(solver.step) if follows else Judged(stable=True)


def deviation(step: StaticStep, increment: Array, predicted: Array) -> float | None:
    """Largest deviation of a block from its ``predicted`` increment, over the farthest motion; None
    if nothing has moved.

    Parameters
    ----------
    increment, predicted
        (n, n_dof) [m, rad].
    """
    moved = step.detector.farthest(increment)
    return step.detector.farthest(increment - predicted) / moved if moved > 0.0 else None


def _slope_at_start(step: StaticStep, multiplier: float) -> float:
    """Slope of the curve [1/m] where a step begins; NaN if the stiffness is singular.

    Joints that carry nothing count as open, because only rounding decides whether they are just
    open, stick or slide.
    """
    step.restart(np.zeros_like(step.x), multiplier)
    step.respond()
    largest = np.abs(step.reaction[: step.n]).max(axis=1)
    idle = (largest <= step.accuracy.tolerance) & (step.branch[: step.n] != BONDED)
    step.response[: step.n][idle] = 0.0
    known = step.slope()
    return math.nan if known is None else known


def _stands(step: StaticStep, guess: Array, multiplier: float) -> bool:
    """Whether a step with a given multiplier is in equilibrium where it starts, or, if supports
    move, at the ``guess`` (n, n_dof)."""
    step.restart(guess if step.given.any() else np.zeros_like(guess), multiplier)
    step.respond()
    balances = step.balance(step.reaction) <= step.accuracy.tolerance
    return balances and not step.update_contacts()


def _nearest(step: StaticStep, guesses: Sequence[Array], multiplier: float) -> Array:
    """The one of several guesses (n, n_dof) that leaves the smallest unbalanced force."""
    if len(guesses) == 1:
        return guesses[0]
    left = []
    for guess in guesses:
        step.restart(guess, multiplier)
        step.respond()
        left.append(step.balance(step.reaction))
    return guesses[int(np.argmin(left))]
