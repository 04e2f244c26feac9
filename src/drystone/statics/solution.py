"""A static step as a whole: the methods that are tried, the stability of the end, the report.

A step may also find an unstable equilibrium, and its report says so.  Such an equilibrium shows in
the sign of the determinant of the bordered system if the number of unstable modes is odd, and else
in the Rayleigh quotient of the lowest mode.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from drystone.common.tolerances import FIRST_SHARE_SEEN, LAST_SHARE_SEEN, WARM_GAIN
from drystone.statics.balance import solve_bordered
from drystone.statics.constants import TOO_STIFF, Accuracy
from drystone.statics.interior import (
    HIGH,
    LEAST_DAMPING,
    SLOW_ITERATIONS,
    WARM_PATIENCE,
    Attempt,
    InteriorPoint,
    InteriorSettings,
)
from drystone.statics.linear import numeric as lu_numeric
from drystone.statics.plane import piecewise
from drystone.statics.plane.piecewise import Followed, PathSettings
from drystone.statics.plane.plane_step import PlaneStep
from drystone.statics.static_step import StaticStep

Array = NDArray[np.float64]


#: Shares of a step at which its shape is looked at.  With 9 or 39 peaks of bonded walls move by up
#: to 8e-4: by where points lie, not by what is seen of a step.
SHARES = np.linspace(FIRST_SHARE_SEEN, LAST_SHARE_SEEN, 19)


@dataclass(frozen=True, kw_only=True)
class StepSolution:
    """Where the path led; with a `reason` where that is not an equilibrium."""

    increment: Array  # (n, n_dof)
    multiplier: float
    n_iterations: int
    #: First fold of the path of equilibria: share of the step, and multiplier there.
    fold: tuple[float, float] | None = None
    #: By how much the multiplier exceeds both its ends within the step, and how far it bends from
    #: its chord, each with the share of the step where it does so most.
    excess: tuple[float, float] | None = None
    bend: tuple[float, float] | None = None
    #: Largest deviation of a block from the predictor, the tangent at the start, over the farthest
    #: motion of a block; in space.
    deviation: float | None = None
    slope: float = np.nan  # 1/m, of the curve at the end; in space
    tangent: Array | None = None  # (n, n_dof) per m of the prescribed displacement, in space
    unstable: bool = False  # whether it is unstable, and no stable one was found nearby
    softened: bool = False  # whether joints soften where it is, and the slope is with that
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class StabilitySettings:
    """Numbers of the search for the lowest modes."""

    #: Modes looked for, and inverse iterations.
    modes: int = 4
    iterations: int = 4
    #: Growth [1/s2] below which a mode is neutral, such as where a joint slides as a whole: gravity
    #: over the smallest block's size is 56 of them in the structure's own frame.
    neutral: float = 0.5


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """Whether an equilibrium is stable."""

    unstable: int  # how many of the lowest modes grow
    slope: float = math.nan  # 1/m, of the curve
    tangent: Array | None = None  # (n, n_dof) per m of the prescribed displacement

    @property
    def stable(self) -> bool:
        """None grows."""
        return self.unstable == 0


@dataclass(frozen=True, kw_only=True)
class SolutionSettings:
    """How steps are solved."""

    #: Times that the contacts of a step are updated and the step is solved again.
    contact_updates: int = 3
    #: Whether linear pieces are followed where there are any, and how long.
    path: PathSettings | None = field(default_factory=PathSettings)
    interior: InteriorSettings = field(default_factory=InteriorSettings)
    stability: StabilitySettings = field(default_factory=StabilitySettings)


@dataclass(frozen=True, kw_only=True)
class Before:
    """What the last step tells the next."""

    # whether no contact changed its state: Newton's method is then tried first
    unchanged: bool = False
    slope: float = math.nan  # 1/m, of the curve where it ended, if known
    unstable: bool = False  # whether it ended at an unstable equilibrium


class _Solver:
    def __init__(self, step: StaticStep, accuracy: Accuracy, settings: SolutionSettings) -> None:
        self.step, self.settings = step, settings
        self.search = InteriorPoint(step, accuracy, settings.interior)

    def nearest(self, guesses: Sequence[Array], multiplier: float) -> Array:
        """The guess, of several, that leaves least unbalanced."""
        step = self.step
        if len(guesses) == 1:
            return guesses[0]
        left = []
        for guess in guesses:
            step.restart(guess, multiplier)
            step.respond()
            left.append(step.balance(step.reaction))
        return guesses[int(np.argmin(left))]

    def find(
        self,
        guess: Array,
        multiplier: float,
        *,
        warm: bool = False,
        full_search: bool = True,
        follows: bool = False,
    ) -> bool:
        """Find an equilibrium from a guess, near or far; whether there is one.

        A step with a prescribed displacement has one attempt.  Without a ``full_search`` the
        attempt is short.
        """
        step, s = self.step, self.settings.interior
        if warm:
            step.restart(guess, multiplier)
            if self.search.newton(s.warm_iterations, patience=WARM_PATIENCE, gain=WARM_GAIN):
                return True
        most = s.max_iterations if full_search else s.few_iterations
        first = Attempt(
            barrier=s.barrier,
            by_residual=True,
            iterations=most,
            soon=not full_search,
        )
        step.restart(guess, multiplier)
        if self.search.interior(first):
            return True
        if follows or not full_search or step.prescribed is not None:
            return False  # what is not found so is tried in motion, or shorter
        step.restart(guess, multiplier)
        if self.search.interior(replace(first, least_damping=LEAST_DAMPING)):
            return True
        step.restart(step.given.copy(), multiplier)
        return self.search.interior(
            Attempt(barrier=HIGH, by_increment=True, second=False, iterations=SLOW_ITERATIONS)
        )

    def update_contacts(self) -> bool:
        """Solve again where blocks press each other at contacts that were not followed; whether an
        equilibrium is found."""
        step, settings = self.step, self.settings
        for _ in range(settings.contact_updates):
            x, multiplier = step.x.copy(), step.multiplier
            if not step.update_contacts(self.search.accuracy):
                return True
            step.restart(x, multiplier)
            if not (self.search.newton(8) or self.find(x, multiplier)):
                return False
        return True

    def quotients(self) -> Array | None:
        """Rayleigh quotients (k,) [1/s2] of the lowest real modes at the equilibrium whose
        stiffness is factorised, with the prescribed displacement fixed; None where that is
        singular.

        Complex pairs move to and fro, and so back where joints slide, which they would not: they
        are not of the stiffness that was linearised.
        """
        step, s = self.step, self.settings.stability
        bordered, mass = step.bordered, step.loads.mass
        rng = np.random.default_rng(1)
        free = ~step.loads.fixed[:, None]
        # No more vectors than there are motions: what is left of others is rounding.
        motions = int(np.count_nonzero(free)) * mass.shape[1] - (step.prescribed is not None)
        n = min(s.modes, motions)
        x = np.where(free, rng.normal(size=(n, *mass.shape)), 0.0)
        y = x
        for _ in range(s.iterations):
            x = _orthonormal(y, mass)
            y = mass * x
            lu_numeric.solve(step.structure, step.factors, y)
            if step.prescribed is not None:
                for column in y:
                    solve_bordered(bordered, column, 0.0)
            if not np.isfinite(y).all():
                return None
        ritz = np.linalg.eigvals((x * mass).reshape(n, -1) @ y.reshape(n, -1).T)
        with np.errstate(divide="ignore"):
            quotients: Array = 1.0 / ritz.real[ritz.imag == 0.0]
        return quotients

    def linearise(self) -> bool:
        """Factorise the stiffness at the equilibrium; False if it is singular."""
        step = self.step
        step.respond()
        step.damping[:] = 0.0
        self.search.iterations += 1
        return step.factorise(step.reaction, 0.0)

    def slope_at_start(self) -> float:
        """Of the curve [1/m], where the step starts."""
        step = self.step
        step.restart(np.zeros_like(step.x), step.multiplier)
        if not self.linearise():
            return math.nan
        step.bordered.columns[0] = 0.0
        return step.solve(1.0)

    def judge(self) -> Judgement:
        """The stability of the equilibrium last evaluated."""
        step = self.step
        if not self.linearise():
            return Judgement(unstable=1)
        slope, tangent = math.nan, None
        if step.prescribed is not None:
            step.bordered.columns[0] = 0.0
            slope = step.solve(1.0)
            tangent = step.bordered.columns[0].copy()
        quotients = self.quotients()
        if quotients is None:
            quotients = np.zeros(0)
        grow = quotients < -self.settings.stability.neutral
        # One more, if the determinant says that there is another, which is none of the lowest.
        odd = np.count_nonzero(quotients < 0.0) % 2 == 1
        n = int(np.count_nonzero(grow)) + (1 if step.stable == odd else 0)
        return Judgement(unstable=n, slope=slope, tangent=tangent)

    def deviation(self, guesses: Sequence[Array]) -> float | None:
        """See `StepSolution`; the second guess is along the tangent."""
        step, farthest = self.step, self.step.constants.detector.farthest
        moved = farthest(step.x)
        return farthest(step.x - guesses[1]) / moved if len(guesses) > 1 and moved > 0.0 else None


def _orthonormal(x: Array, mass: Array) -> Array:
    """Fields (k, n, n_dof) made orthonormal by the mass (n, n_dof)."""
    k = len(x)
    root = np.sqrt(mass).ravel()
    q, _ = np.linalg.qr((x.reshape(k, -1) * root).T)
    back = np.divide(1.0, root, out=np.zeros_like(root), where=root > 0.0)
    return np.ascontiguousarray((q * back[:, None]).T).reshape(x.shape)


def solve(
    step: StaticStep,
    guesses: Sequence[Array],
    multiplier: float,
    reaction: Array,
    accuracy: Accuracy,
    settings: SolutionSettings,
    before: Before,
    *,
    dynamic: bool = False,
    full_search: bool = True,
    beyond: bool = False,
) -> StepSolution:
    """Solve a step that has begun; its equations are left evaluated at the solution.

    Parameters
    ----------
    step
        The equations.
    guesses
        Increments (n, n_dof) near which the step may end; the second along the tangent, if any.
    multiplier
        Where the step starts; without a prescribed displacement, the one that is asked for.
    reaction
        Of all contacts where it starts, (n_slots, dim) [N].
    accuracy, settings, before
        See there.
    dynamic
        Whether the step is one in time, in which inertia regularises what is not stable.
    full_search
        Whether more than the first method is tried.
    beyond
        Whether an equilibrium is looked for beyond a fold of the path, on the path of the implicit
        law.
    """
    if step.prescribed is None and _stands(step, guesses[0], multiplier, accuracy):
        return StepSolution(increment=step.x.copy(), multiplier=multiplier, n_iterations=0)
    followed: Followed | None = None
    if settings.path is not None and isinstance(step, PlaneStep):
        followed = piecewise.follow(
            step, guesses[0], multiplier, reaction, accuracy, settings.path,
            whole=step.prescribed is None or dynamic or beyond,
        )  # fmt: skip
        # A fold says that there is no equilibrium ahead: what follows is motion.
        folded = followed.folded and step.prescribed is not None
        if not followed.reason or folded or followed.reason == TOO_STIFF:
            return _as_followed(step, followed)
        step.again()
        # A shorter step is followed for less than a long search costs.
        full_search = full_search and step.prescribed is None
    return _from_inside(
        step, guesses, multiplier, accuracy, settings, before, followed,
        dynamic=dynamic, full_search=full_search,
    )  # fmt: skip


def _stands(step: StaticStep, guess: Array, multiplier: float, accuracy: Accuracy) -> bool:
    """Whether a step with a given multiplier ends where it is expected, with nothing to be done."""
    step.restart(guess if step.given.any() else np.zeros_like(guess), multiplier)
    step.respond()
    return step.balance(step.reaction) <= accuracy.tolerance and not step.update_contacts(accuracy)


def _as_followed(step: PlaneStep, followed: Followed) -> StepSolution:
    return StepSolution(
        increment=step.x.copy(),
        multiplier=step.multiplier,
        n_iterations=followed.count,
        fold=followed.fold,
        excess=followed.excess,
        bend=followed.bend,
        reason=followed.reason,
    )


def _from_inside(
    step: StaticStep,
    guesses: Sequence[Array],
    multiplier: float,
    accuracy: Accuracy,
    settings: SolutionSettings,
    before: Before,
    followed: Followed | None,
    *,
    dynamic: bool,
    full_search: bool,
) -> StepSolution:
    """Solve a step from the interior of the law, or by Newton's method where no contact changed."""
    solver = _Solver(step, accuracy, settings)
    driven = step.constants.detector.farthest(step.given)
    increment = step.prescribed.increment if step.prescribed else driven
    follows = (step.prescribed is not None or driven > 0.0) and not dynamic  # a curve of equilibria
    slope = before.slope
    if follows and step.prescribed is not None and not math.isfinite(slope):
        step.multiplier = multiplier
        slope = solver.slope_at_start()
    guess = solver.nearest(guesses, multiplier)
    found = solver.find(
        guess, multiplier, warm=before.unchanged, full_search=full_search, follows=follows
    )
    found = found and solver.update_contacts()
    n_iterations = solver.search.iterations
    fold, judged = followed.fold if followed else None, None
    if found and follows:
        judged = solver.judge()
        if not judged.stable:
            fold = fold or (1.0, step.multiplier)
    end = judged.slope if judged else math.nan
    reason = _reason(found, n_iterations, step, accuracy)
    sense = -1.0 if increment < 0.0 else 1.0  # multipliers are looked at in that of the motion
    shape = _shape(sense * multiplier, sense * step.multiplier, slope, end, sense * increment)
    if before.unstable and judged and judged.stable:
        shape = (0.0, 0.0), (0.0, 0.0)  # it has left an unstable point: nothing lies between
    return StepSolution(
        increment=step.x.copy(),
        multiplier=step.multiplier,
        n_iterations=n_iterations,
        fold=fold,
        excess=shape[0] if not reason else None,
        bend=shape[1] if not reason else None,
        deviation=solver.deviation(guesses) if follows else None,
        slope=end,
        tangent=judged.tangent if judged else None,
        unstable=judged is not None and not judged.stable,
        reason=reason,
    )


def grows(step: StaticStep, accuracy: Accuracy, settings: SolutionSettings) -> bool:
    """Whether a structure would leave where it is by one of its lowest modes, by the stiffness that
    is factorised and has been solved with."""
    quotients = _Solver(step, accuracy, settings).quotients()
    return quotients is None or bool((quotients < -settings.stability.neutral).any())


def _reason(found: bool, n_iterations: int, step: StaticStep, accuracy: Accuracy) -> str:
    """Why a step has failed; "" where it has not."""
    if not found:
        moved = step.constants.detector.farthest(step.x)
        if step.residual <= accuracy.coarsest < step.enough(accuracy, moved):
            return TOO_STIFF
        return f"no equilibrium within {n_iterations} iterations"
    if not step.constants.detector.farthest(step.x) <= accuracy.farthest:
        return "a block moves too far in one step"
    return ""


def _shape(
    start: float, end: float, slope: float, slope_end: float, increment: float
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Excess and bend of the curve within a step, see `StepSolution`, from its tangents at both
    ends: where these meet, the curve has its corner.

    One that rises by more than along either tangent has a steeper part between them, behind which
    it may have a peak: then it bends as a cubic does.
    """
    if not math.isfinite(slope + slope_end) or increment == 0.0:
        return None, None
    rise, at_end, change = slope * increment, slope_end * increment, end - start
    at = (change - at_end) / (rise - at_end) if rise != at_end else math.inf
    if change > max(rise, at_end, 0.0):
        return (0.0, 0.0), bend_of_cubic(rise, change, at_end)
    if not 0.0 < at < 1.0:
        return (0.0, 0.0), (0.0, 0.0)
    corner = start + at * rise
    # Of a smooth curve, the middle of a parabola is midway to where its tangents meet.
    bend = 0.5 * abs(corner - start - at * change), at
    return (corner - max(start, end), at), bend


def bend_of_cubic(rise: float, change: float, at_end: float) -> tuple[float, float]:
    """How far a cubic leaves its chord at most, and at what share of its length, that would rise by
    ``rise`` along its first tangent and by ``at_end`` along its last, and does by ``change``."""
    away = SHARES * (1.0 - SHARES) * ((rise - change) * (1.0 - SHARES) - (at_end - change) * SHARES)
    off = int(np.argmax(np.abs(away)))
    return float(abs(away[off])), float(SHARES[off])
