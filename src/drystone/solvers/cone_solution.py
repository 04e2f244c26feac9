"""A static step in space as a whole: attempts, the equilibrium's stability, and its report.

Equilibria that a structure would not keep are found as well as others.  They show in the sign of
the bordered determinant, where the number of their unstable modes is odd, or in the quotient of
Rayleigh of the lowest mode.  Nearly always a stable one lies within micrometres, where a contact
more is closed or slides: a push along the mode finds it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from drystone.geometry.motion import translations
from drystone.kernels import lu_numeric, path
from drystone.solvers.cone_search import Attempt, ConeSearch, ConeSettings
from drystone.solvers.cone_step import ConeStep, Place
from drystone.solvers.piecewise import Accuracy, StepSolution

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class StabilitySettings:
    """Numbers of the search for the lowest mode, and of pushes along it."""

    #: Inverse iterations.
    iterations: int = 5
    #: Pushes [m] of the body that moves most; the other way as well.
    pushes: tuple[float, ...] = (1e-5, 1e-4)
    #: Barrier of a push, see `Attempt`, and how hard bodies are held in it that nothing holds.
    barrier: float = 1e-4
    least_damping: float = 3.0
    #: Motion over the increment, and at least over the smallest block, beyond which what a push
    #: finds is not the same place.
    near: float = 20.0
    near_least: float = 0.03


@dataclass(frozen=True, kw_only=True)
class SpaceSettings:
    """How steps in space are solved."""

    cones: ConeSettings = field(default_factory=ConeSettings)
    stability: StabilitySettings = field(default_factory=StabilitySettings)


class _Solver:
    def __init__(self, step: ConeStep, accuracy: Accuracy, settings: SpaceSettings) -> None:
        self.step, self.settings, self.accuracy = step, settings, accuracy
        self.search = ConeSearch(step, accuracy, settings.cones)

    def find(self, guess: Array, multiplier: float, *, warm: bool) -> bool:
        """An equilibrium from a guess, be it from far; whether there is one."""
        step, s = self.step, self.settings.cones
        if warm:
            step.set_out(guess, multiplier)
            if self.search.newton(
                s.warm_iterations, patience=s.warm_patience, gain=s.warm_gain
            ):
                return True
        for attempt in (
            Attempt(barrier=s.low, iterations=s.max_iterations),
            Attempt(
                barrier=s.high,
                by_increment=True,
                second=False,
                iterations=s.max_slow_iterations,
            ),
        ):
            step.set_out(guess, multiplier)
            if self.search.interior(attempt):
                return True
        return False

    def mode(self) -> tuple[float, Array]:
        """Quotient of Rayleigh [1/s2] and shape (n, n_dof) of the lowest mode with the pacing
        displacement held, at the equilibrium last evaluated; negative where it is unstable."""
        step = self.step
        columns, mass = step.frame.columns, step.loads.mass
        rng = np.random.default_rng(1)
        x = np.where(step.loads.fixed[:, None], 0.0, rng.normal(size=mass.shape))
        quotient = math.inf
        for _ in range(self.settings.stability.iterations):
            columns[0] = mass * x
            lu_numeric.solve(step.structure, step.factors, columns[:1])
            if step.pace is not None:
                path.border(step.frame, columns[0], 0.0)
            y = columns[0].copy()
            by_both, size = float(np.vdot(x, mass * y)), float(np.vdot(y, mass * y))
            if not (math.isfinite(size) and size > 0.0):
                return -math.inf, x
            quotient = by_both / size
            x = y / math.sqrt(size)
        return quotient, x

    def linearise(self) -> bool:
        """Factorise the stiffness at the equilibrium; False if it is singular."""
        step = self.step
        step.respond()
        step.damping[:] = 0.0
        self.search.iterations += 1
        return step.factorise(step.reaction, 0.0)

    def judge(self) -> tuple[bool, float, Array]:
        """Whether the structure would keep the equilibrium; the slope of the curve there [1/m], and
        the lowest mode."""
        step = self.step
        if not self.linearise():
            return False, math.nan, np.zeros_like(step.x)
        slope = math.nan
        if step.pace is not None:
            step.frame.columns[0] = 0.0
            slope = step.solve(1.0)
        quotient, mode = self.mode()
        return step.stable and quotient > 0.0, slope, mode

    def push(self, mode: Array, increment: float) -> tuple[bool, float]:
        """Look for a stable equilibrium beside the present one; what was found, or, where there is
        none, the present one.  Returns whether it is stable, and the slope."""
        step, s = self.step, self.settings.stability
        start, at = step.x.copy(), step.place
        most = float(np.linalg.norm(translations(mode), axis=1).max())
        size = step.constants.detector.assembly.smallest_extent
        room = max(s.near * abs(increment), s.near_least * size)
        attempt = Attempt(barrier=s.barrier, least_damping=s.least_damping)
        for push in s.pushes if most > 0.0 else ():
            for sense in (1.0, -1.0):
                step.come_back(at)
                step.move(mode, sense * push / most)
                if not self.search.interior(attempt):
                    continue
                moved = step.constants.detector.farthest(step.x - start)
                if not moved < room:
                    continue
                stable, slope, _ = self.judge()
                if stable:
                    return True, slope
        self._return(at)
        return False, math.nan

    def _return(self, at: Place) -> None:
        step = self.step
        step.come_back(at)
        step.respond()
        step.balance(step.reaction)


def solve(
    step: ConeStep,
    guess: Array,
    multiplier: float,
    accuracy: Accuracy,
    settings: SpaceSettings,
    *,
    warm: bool = False,
    slope: float = math.nan,
    dynamic: bool = False,
) -> StepSolution:
    """Solve a step that has begun; its equations are left evaluated at the solution.

    Parameters
    ----------
    step
        The equations.
    guess
        Increments (n, n_dof) near which the step will end.
    multiplier
        Where the step starts; without a pace, the one that is asked for.
    accuracy, settings
        See there.
    warm
        Whether Newton's method is tried from the guess.
    slope
        Of the curve where the step starts [1/m], not a number where nobody knows.
    dynamic
        Whether the step is one in time, in which inertia holds what is not stable.
    """
    solver = _Solver(step, accuracy, settings)
    begun = multiplier
    pace = step.pace
    increment = pace.missing(np.zeros_like(guess)) if pace else 0.0
    found = solver.find(guess, multiplier, warm=warm)
    turn, stable, end = None, True, math.nan
    if found and pace is not None and not dynamic:
        stable, end, mode = solver.judge()
        if not stable:
            was = step.multiplier
            stable, after = solver.push(mode, increment)
            turn, end = (1.0, was), after if stable else end
    reason = ""
    if not found:
        reason = f"no equilibrium within {solver.search.iterations} iterations"
    elif not step.constants.detector.farthest(step.x) <= accuracy.farthest:
        reason = "a block moves too far in one step"
    shape = _shape(begun, step.multiplier, slope, end, increment)
    return StepSolution(
        increment=step.x.copy(),
        multiplier=step.multiplier,
        n_iterations=solver.search.iterations,
        turn=turn,
        excess=shape[0] if not reason else None,
        bend=shape[1] if not reason else None,
        slope=end,
        unstable=not stable,
        reason=reason,
    )


def _shape(
    start: float, end: float, slope: float, slope_end: float, increment: float
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Excess and bend of the curve within a step, see `StepSolution`, from its tangents at both
    ends: where these meet, the curve has its corner, if it has one."""
    if not math.isfinite(slope + slope_end) or increment == 0.0:
        return None, None
    if slope == slope_end:
        return (0.0, 0.0), (0.0, 0.0)
    at = (end - slope_end * increment - start) / (slope - slope_end) / increment
    if not 0.0 < at < 1.0:
        return (0.0, 0.0), (0.0, 0.0)
    corner = start + slope * at * increment
    # Of a smooth curve, the middle of a parabola is half way to where its tangents meet.
    bend = 0.5 * abs(corner - start - at * (end - start))
    return (corner - max(start, end), at), (bend, at)
