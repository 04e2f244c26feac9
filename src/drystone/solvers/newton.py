"""Newton's method for a static step, kept from losing its way among the branches of the joint law.

The equations are smooth but for contacts that open, close, stick and slide, and with friction they
have no energy to descend on.  Four things keep the iteration on its way:

- Directions are taken while they lower the unbalanced forces; otherwise they are shortened, and
  damped by inertia when that does not help.
- A contact that a direction takes from sliding one way to sliding the other has passed the band in
  which it sticks, narrow where the shear stiffness is high: it is held there and the direction is
  found again.
- Where a direction leads far away, contacts that have just left their cones have set a part of the
  structure free: all but the worst are held again.
- Features of contacts are followed, not found anew, until the blocks are balanced; then they are
  checked, and the iteration goes on where one has changed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import GRAVITY
from drystone.contact.forces import SLIDING, STICKING
from drystone.kernels import narrow
from drystone.solvers.linear import SingularMatrixError
from drystone.solvers.static_step import Pace, StaticStep

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class NewtonSettings:
    """When to stop."""

    tolerance: float  # N, largest unbalanced force
    lag: float = 1e-12  # m, what may be missing of the increment
    depth: float  # m, penetration too small to tell two contacts apart
    farthest: float  # m, motion of a block over which the step has failed
    reach: float  # m, motion of a block in one iteration that is not believed
    max_iterations: int = 30
    max_attempts: int = 6  # directions tried in one iteration
    max_rounds: int = 3  # times that the features of contacts are checked


@dataclass(frozen=True, kw_only=True)
class NewtonResult:
    """Where the iteration came to; with a `reason` where it did not converge."""

    increment: Array  # (n, n_dof)
    multiplier: float
    n_iterations: int
    reason: str = ""


def solve(
    step: StaticStep,
    pace: Pace | None,
    x: Array,
    multiplier: float,
    stuck: BoolArray,
    sense: Array,
    settings: NewtonSettings,
) -> NewtonResult:
    """Solve a step that has begun.

    Parameters
    ----------
    step
        The equations; left evaluated at the solution.
    pace
        What paces the step, the multiplier being an unknown; None where it is given.
    x, multiplier
        First guess.
    stuck, sense
        Contacts that stuck, and which way others slid, in the last step, (n_slots,).
    """
    iteration = _Iteration(step, pace, settings, sense)
    # The extrapolated shear of a stiff joint tells nothing of its cone: what stuck in the last
    # step is taken to stick until the first correction has been made.
    step.evaluate(x, multiplier, stuck)
    rounds, reason, count = 0, "", 0
    for count in range(1, settings.max_iterations + 1):
        lag, gradient = pace.measure(x) if pace else (0.0, np.zeros(3))
        balanced = step.residual <= settings.tolerance and abs(lag) <= settings.lag
        if balanced and count > 1:
            step.find(x)
            same = not narrow.changed_contacts(step.slots, step.found, settings.depth)
            if same or rounds == settings.max_rounds:
                return NewtonResult(increment=x, multiplier=multiplier, n_iterations=count)
            rounds += 1
            step.follow(step.found)
            step.evaluate(x, multiplier)
        # The increment itself unbalances the blocks: the first direction is taken as it is.
        bound = np.inf if count == 1 else step.merit
        moved = iteration.advance(x, multiplier, lag, gradient, bound)
        if moved is None:
            reason = "no direction leads nearer to equilibrium"
            break
        x, multiplier = moved
        if step.constants.detector.motion(x).max() > settings.farthest:
            reason = "a block moves too far in one step"
            break
    reason = reason or f"no equilibrium within {settings.max_iterations} iterations"
    return NewtonResult(increment=x, multiplier=multiplier, n_iterations=count, reason=reason)


class _Iteration:
    """What is remembered from one iteration to the next."""

    def __init__(
        self, step: StaticStep, pace: Pace | None, settings: NewtonSettings, sense: Array
    ) -> None:
        self.step, self.pace, self.settings = step, pace, settings
        self.sense = sense
        self.stuck = np.zeros(len(sense), np.bool_)
        self.damping = 0.0
        #: Inertia under which a block would fall by the reach in one iteration [1/s2].
        self.first_damping = GRAVITY / settings.reach

    def advance(
        self, x: Array, multiplier: float, lag: float, gradient: Array, bound: float
    ) -> tuple[Array, float] | None:
        """Go where the merit is below ``bound``, and leave the step evaluated there.

        Returns None where no direction leads there.
        """
        step = self.step
        sense, status = step.sense(), step.status
        turned = sense * self.sense < 0.0
        released = np.where(self.stuck & (status == SLIDING), step.excess, 0.0)
        self.stuck, self.sense = status == STICKING, sense
        held = np.zeros(len(sense), np.bool_)
        here = True  # whether the step is evaluated at x, with the contacts held that should be
        for _ in range(self.settings.max_attempts):
            if not here:
                step.evaluate(x, multiplier, held)
                here = True
            try:
                direction, change = step.direction(self.pace, x, lag, gradient, self.damping)
            except SingularMatrixError:
                self._damp()
                continue
            if not self._believable(direction):
                again = _hold_back(held, turned, released)
                here = not again
                if not again:
                    self._damp()
                continue
            here = False
            for length in (1.0, 0.5, 0.25):
                trial, trial_multiplier = x + length * direction, multiplier + length * change
                step.evaluate(trial, trial_multiplier)
                if step.merit <= bound and np.isfinite(step.merit):
                    if length == 1.0:
                        self._relax()
                    return trial, trial_multiplier
                skipped = (sense * step.sense() < 0.0) & ~held
                if length == 1.0 and skipped.any():
                    held |= skipped
                    break
            else:
                self._damp()
        return None

    def _believable(self, direction: Array) -> bool:
        motion = self.step.constants.detector.motion(direction).max()
        return bool(motion <= self.settings.reach)

    def _damp(self) -> None:
        self.damping = max(16.0 * self.damping, self.first_damping)

    def _relax(self) -> None:
        self.damping = self.damping / 16.0 if self.damping > self.first_damping else 0.0


def _hold_back(held: BoolArray, turned: BoolArray, released: Array) -> bool:
    """Hold contacts that have turned round, then those released that exceed their cone least.

    Changes all three in place; returns False where there is none left to hold.
    """
    if turned.any():
        held |= turned
        turned[:] = False
        return True
    if np.count_nonzero(released) > 1:
        keep = (released > 0.0) & (released < 0.5 * released.max())
        if not keep.any():
            keep = (released > 0.0) & (released < released.max())
        held |= keep
        released[keep] = 0.0
        return bool(keep.any())
    return False
