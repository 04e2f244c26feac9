"""A static step as a whole: the methods that are tried, and the report.

A step may also find an unstable equilibrium, see `statics.stability`, and its report says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from drystone.common import tolerances
from drystone.common.arrays import Array
from drystone.engines.base import TOO_FAR, Fold
from drystone.law.branches import BONDED
from drystone.statics.equations import TOO_STIFF
from drystone.statics.interior import (
    SLOW_ITERATIONS,
    Attempt,
    InteriorPoint,
    InteriorSettings,
)
from drystone.statics.plane import piecewise
from drystone.statics.plane.piecewise import PathSettings
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.shape import shape_between
from drystone.statics.stability import Judged, StabilitySettings, growing, judge
from drystone.statics.static_step import StaticStep, StepSolution

#: How far from an unstable equilibrium a stable one is looked for, over the smallest extent.
DEPARTURES = np.geomspace(tolerances.LEAST_DEPARTURE, tolerances.MOST_DEPARTURE, 7)


@dataclass(frozen=True, kw_only=True)
class SolutionSettings:
    """How steps are solved."""

    #: Times that the contacts of a step are updated and the step is solved again.
    contact_updates: int = 3
    #: Whether linear pieces are followed where there are any, and how long.
    path: PathSettings | None = field(default_factory=PathSettings)
    interior: InteriorSettings = field(default_factory=InteriorSettings)
    stability: StabilitySettings = field(default_factory=StabilitySettings)


class _Solver(InteriorPoint):
    def find(
        self, guess: Array, multiplier: float, *, warm: bool, full_search: bool, follows: bool
    ) -> bool:
        """Find an equilibrium from a guess, near or far; whether there is one.

        A step with a prescribed displacement has one attempt.  Without a ``full_search`` the
        attempt is short.
        """
        step, s = self.step, self.settings
        if warm:
            step.restart(guess, multiplier)
            if self.newton_from_start():
                return True
        most = s.max_iterations if full_search else s.few_iterations
        first = Attempt(barrier=s.barrier, by_residual=True, iterations=most, soon=not full_search)
        step.restart(guess, multiplier)
        if self.interior(first):
            return True
        if follows or not full_search or step.prescribed is not None:
            return False  # what is not found so is tried in motion, or shorter
        step.restart(guess, multiplier)
        if self.interior(replace(first, least_damping=tolerances.LEAST_DAMPING)):
            return True
        step.restart(step.given.copy(), multiplier)
        return self.interior(
            Attempt(
                barrier=tolerances.HIGH_BARRIER,
                by_increment=True,
                second=False,
                iterations=SLOW_ITERATIONS,
            )
        )

    def update_contacts(self, most: int) -> bool:
        """Solve again where blocks press each other at contacts that were not followed; whether an
        equilibrium is found."""
        step = self.step
        for _ in range(most):
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
    """Whether to try what has not succeeded in so many steps in a row: at once, and after 1, 2, 4,
    8, ... of them."""
    return times & (times - 1) == 0


def _leave(solver: _Solver, settings: SolutionSettings) -> Judged | None:
    """A stable equilibrium beside the unstable one that the step is at, to either side of it by its
    growing mode; None where there is none, and the step is then left anywhere.

    A structure with two ways to go, as a portal of which either pier may tilt, or a column on its
    diagonal, has an equilibrium between them, which no structure stays in.  Which way it goes is of
    its imperfections: of two it is taken to go where it carries less.
    """
    step = solver.step
    way, x, multiplier = growing(step, settings.stability), step.x.copy(), step.multiplier
    if way is None:
        return None
    backwards = step.prescribed is not None and step.prescribed.increment < 0.0

    def beside(length: float) -> Judged | None:
        step.again()
        start = x + length * way
        if not solver.find(start, multiplier, warm=True, full_search=False, follows=True):
            return None
        found = _updated(solver, settings, follows=True)
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
    """Where a step begins, and what is known of the one before."""

    guesses: Sequence[Array]  # increments (n, n_dof) near which the step may end
    multiplier: float  # without a prescribed displacement, the one that is asked for
    reaction: Array  # of all contacts, (n_slots, dim) [N]
    along: Array | None = None  # (n, n_dof), one of them: that along the curve, if it is known
    repeats: bool = False  # whether the guess is where the step ended with other strengths
    slope: float = math.nan  # 1/m, of the curve, if it is known
    unstable: int = 0  # unstable equilibria in a row, that at the start included
    in_vain: int = 0  # steps in a row that Newton's method along the curve has not completed


@dataclass(frozen=True, kw_only=True)
class _Followed:
    """What following the linear pieces has come to."""

    solution: StepSolution | None = None  # None: another method is to be tried
    fold: Fold | None = None
    full_search: bool
    at_last: Callable[[], StepSolution] | None = None  # to be tried where nothing else succeeds


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

    Parameters
    ----------
    dynamic
        Whether the step is one in time, in which inertia regularises what is not stable.
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
    solved, found = _by_iterations(step, start, followed, settings, dynamic=dynamic)
    if found or solved.reason == TOO_STIFF or followed.at_last is None:
        return solved
    step.again()
    last = followed.at_last()
    return replace(last, n_iterations=solved.n_iterations + last.n_iterations)


def _follow(
    step: PlaneStep, start: StepStart, settings: PathSettings, *, whole: bool, full_search: bool
) -> _Followed:
    """Follow the linear pieces of a step."""
    prescribed = step.prescribed
    follow = partial(
        piecewise.follow, step, start.guesses[0], start.multiplier, start.reaction, settings
    )
    solution = follow(whole=whole)
    # A fold says that there is no equilibrium ahead: what follows is motion.
    folded = solution.reason == piecewise.TURNS_BACK and prescribed is not None
    if not solution.reason or folded or solution.reason == TOO_STIFF:
        return _Followed(solution=solution, full_search=full_search)
    step.again()
    # A shorter step is followed for less than a long search costs, unless it is as long a path.
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
    settings: SolutionSettings,
    *,
    dynamic: bool,
) -> tuple[StepSolution, bool]:
    """The step by Newton's method along the curve, or else by the interior-point method; and
    whether there is an equilibrium."""
    prescribed, driven = step.prescribed, step.detector.farthest(step.given)
    solver, slope = _Solver(step, settings.interior), start.slope
    follows = (prescribed is not None or driven > 0.0) and not dynamic  # a curve of equilibria
    if follows and prescribed is not None and not math.isfinite(slope):
        slope = _slope_at_start(step, start.multiplier)
        solver.iterations = 1  # a factorisation counts as one
    guess = _nearest(step, start.guesses, start.multiplier)
    along, found, in_vain = start.along if follows else None, None, start.in_vain
    # One unstable equilibrium alone says little: a stable one nearly always lies within
    # micrometres.  Where they go on, the structure has come to a branch that it would leave.
    leaves = prescribed is None or (start.unstable > 0 and _due(start.unstable))
    if along is not None:
        # Where many contacts change their branch in each step, this nearly always fails.
        if _due(in_vain):
            found = _along_curve(solver, guess, along, start.multiplier, settings)
        in_vain = 0 if found and found.stable else in_vain + 1
    if found and not found.stable and leaves:
        found, leaves = _leave(solver, settings), False
    if not (found and found.stable):
        found = _from_within(
            solver, guess, start, settings,
            full_search=followed.full_search, follows=follows, leaves=leaves,
        )  # fmt: skip
    begun = replace(start, slope=slope, along=along, in_vain=in_vain)
    return _reported(solver, begun, followed.fold, found), found is not None


def _reported(
    solver: _Solver, start: StepStart, fold: Fold | None, found: Judged | None
) -> StepSolution:
    """What there is to say of the equilibrium that has been ``found``."""
    step, prescribed = solver.step, solver.step.prescribed
    moved, reason = step.detector.farthest(step.x), ""
    if found and not found.stable and (fold is None or math.isfinite(fold.drop)):
        fold = Fold(1.0, step.multiplier)
    stable, end, tangent = found or Judged(stable=True)
    if not found:
        reason = f"no equilibrium within {solver.iterations} iterations"
        if step.residual <= step.accuracy.coarsest < step.enough(moved):
            reason = TOO_STIFF
    elif not moved <= step.accuracy.farthest:
        reason = TOO_FAR
    increment = prescribed.increment if prescribed else step.detector.farthest(step.given)
    sense = -1.0 if increment < 0.0 else 1.0  # multipliers are looked at in that of the motion
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


def _along_curve(
    solver: _Solver, guess: Array, along: Array, multiplier: float, settings: SolutionSettings
) -> Judged | None:
    """An equilibrium by Newton's method along the curve; None where there is none."""
    there = solver.newton_along(guess, along, multiplier)
    return _updated(solver, settings, follows=True) if there else None


def _from_within(
    solver: _Solver,
    guess: Array,
    start: StepStart,
    settings: SolutionSettings,
    *,
    full_search: bool,
    follows: bool,
    leaves: bool,
) -> Judged | None:
    """An equilibrium by the interior-point method; None where there is none.

    If it is unstable, and the structure ``leaves`` such ones, a stable one beside it is looked for.
    """

    def reach() -> Judged | None:
        solver.step.again()
        there = solver.find(
            guess, start.multiplier, warm=start.repeats, full_search=full_search, follows=follows
        )
        return _updated(solver, settings, follows=follows) if there else None

    found = reach()
    if found and not found.stable and leaves:
        found = _leave(solver, settings) or reach()
    return found


def _updated(solver: _Solver, settings: SolutionSettings, *, follows: bool) -> Judged | None:
    """The equilibrium with the contacts that blocks have where they are; judged on a curve."""
    if not solver.update_contacts(settings.contact_updates):
        return None
    return judge(solver.step, settings.stability) if follows else Judged(stable=True)


def deviation(step: StaticStep, increment: Array, predicted: Array) -> float | None:
    """Largest deviation of a block from what was ``predicted``, over the farthest motion; None
    where nothing has moved.

    Parameters
    ----------
    increment, predicted
        (n, n_dof) [m, rad].
    """
    moved = step.detector.farthest(increment)
    return step.detector.farthest(increment - predicted) / moved if moved > 0.0 else None


def _slope_at_start(step: StaticStep, multiplier: float) -> float:
    """Slope of the curve [1/m] where a step begins; NaN where the stiffness is singular.

    Joints that carry nothing count as open.  Whether they are just open, stick or slide is a matter
    of rounding.
    """
    step.restart(np.zeros_like(step.x), multiplier)
    step.respond()
    largest = np.abs(step.reaction[: step.n]).max(axis=1)
    idle = (largest <= step.accuracy.tolerance) & (step.branch[: step.n] != BONDED)
    step.response[: step.n][idle] = 0.0
    known = step.slope()
    return math.nan if known is None else known


def _stands(step: StaticStep, guess: Array, multiplier: float) -> bool:
    """Whether a step with a given multiplier ends where it is expected, with nothing to be done."""
    step.restart(guess if step.given.any() else np.zeros_like(guess), multiplier)
    step.respond()
    balances = step.balance(step.reaction) <= step.accuracy.tolerance
    return balances and not step.update_contacts()


def _nearest(step: StaticStep, guesses: Sequence[Array], multiplier: float) -> Array:
    """The guess, of several, that leaves least unbalanced."""
    if len(guesses) == 1:
        return guesses[0]
    left = []
    for guess in guesses:
        step.restart(guess, multiplier)
        step.respond()
        left.append(step.balance(step.reaction))
    return guesses[int(np.argmin(left))]
