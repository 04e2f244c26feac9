"""Newton's method on steps whose joints have the strengths of where the blocks are.

See `statics.yielding`, which goes these ways, and `law.softening` for the joints.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drystone.law.strengths import Strengths
from drystone.statics.linear_step import Pace
from drystone.statics.plane import piecewise
from drystone.statics.plane.piecewise import Accuracy, StepSolution
from drystone.statics.plane.static_step import StaticStep
from drystone.statics.space.cone_solution import SpaceSettings, grows
from drystone.statics.space.cone_step import ConeStep

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


#: Farthest rotation in an iteration [rad]: a direction beyond it is not of the linearised motion.
#: Curves of six random bonded walls are the same to the last bit with 0.02 to 1.
FARTHEST_TURN = 0.2


class WayInPlane:
    """That of a `StaticStep` from increments (n, 3) and a multiplier."""

    def __init__(
        self,
        step: StaticStep,
        strengths: Strengths,
        pace: Pace | None,
        accuracy: Accuracy,
        x: Array,
        multiplier: float,
    ) -> None:
        self.step, self.strengths, self.pace = step, strengths, pace
        self.accuracy = accuracy
        self.increment, self.multiplier = x.copy(), multiplier
        self.by_multiplier = 0.0

    @property
    def residual(self) -> float:
        """See `Way.residual`."""
        return self.step.residual

    @property
    def missing(self) -> float:
        """See `Way.missing`."""
        return self.pace.missing(self.increment) if self.pace else 0.0

    def soften(self, start: Array) -> tuple[IntArray, Array]:
        """See `Way.soften`."""
        return self.step.soften(self.strengths, start, self.increment, self.multiplier)

    def gap(self, slot: IntArray) -> Array:
        """See `Way.gap`."""
        return self.step.slots.gap[slot]

    def aim(self) -> bool:
        """See `Way.aim`."""
        step = self.step
        if not self._factorise():
            return False
        self.by_multiplier = step.direction(self.missing, paced=self.pace is not None)
        return bool(np.isfinite(self.by_multiplier))

    def _factorise(self) -> bool:
        step = self.step
        gradient = self.pace.gradient(self.increment) if self.pace else step.force
        step.damping[:] = 0.0
        return step.factorise(self.pace, gradient, 0.0)

    def move(self, length: float) -> None:
        """See `Way.move`."""
        self.increment += length * self.step.frame.columns[0]
        self.multiplier += length * self.by_multiplier

    def stand(self, held: Array, solved: StepSolution) -> StepSolution | None:
        """See `Way.stand`."""
        step, x = self.step, self.increment
        step.start.held[:] = held
        if not piecewise.stands(step, self.pace, x, self.multiplier, self.accuracy):
            return None
        return replace(
            solved,
            increment=x,
            multiplier=self.multiplier,
            excess=solved.excess or (0.0, 0.0),
            bend=solved.bend or (0.0, 0.0),
            reason="",
        )

    def slope(self) -> float | None:
        """See `Way.slope`."""
        step = self.step
        if not self._factorise():
            return None
        step.force[:] = 0.0
        slope = step.direction(1.0, paced=self.pace is not None)
        return slope if step.stable and np.isfinite(slope) else None


class WayInSpace:
    """That of a `ConeStep` from where it is; forces that blocks meet with are ``slight`` [N]."""

    def __init__(
        self,
        step: ConeStep,
        strengths: Strengths,
        accuracy: Accuracy,
        settings: SpaceSettings,
        slight: float,
    ) -> None:
        self.step, self.strengths, self.accuracy, self.slight = step, strengths, accuracy, slight
        self.settings = settings
        self.by_multiplier, self.tangent, self.at_end = 0.0, np.zeros_like(step.x), np.nan

    @property
    def residual(self) -> float:
        """See `Way.residual`."""
        return self.step.residual

    @property
    def missing(self) -> float:
        """See `Way.missing`."""
        return self.step.missing

    @property
    def increment(self) -> Array:
        """See `Way.increment`."""
        return self.step.x.copy()

    def soften(self, start: Array) -> tuple[IntArray, Array]:
        """See `Way.soften`."""
        return self.step.soften(self.strengths, start)

    def gap(self, slot: IntArray) -> Array:
        """See `Way.gap`."""
        return self.step.ended().gap[slot]

    def aim(self) -> bool:
        """See `Way.aim`."""
        step = self.step
        step.damping[:] = 0.0
        if not step.factorise(step.reaction, 0.0):
            return False
        step.frame.columns[0] = step.force
        self.by_multiplier = step.solve(step.missing)
        most = float(np.abs(step.frame.columns[0][:, 3:]).max())
        return bool(np.isfinite(self.by_multiplier) and most < FARTHEST_TURN)

    def move(self, length: float) -> None:
        """See `Way.move`."""
        self.step.multiplier += length * self.by_multiplier
        self.step.move(self.step.frame.columns[0], length)

    def stand(self, held: Array, solved: StepSolution) -> StepSolution | None:
        """See `Way.stand`."""
        step, accuracy = self.step, self.accuracy
        step.take(held)
        moved = step.constants.detector.farthest(step.x)
        rounding = max(accuracy.rounding, accuracy.sliding_rounding) * moved
        enough = max(accuracy.tolerance, min(rounding, accuracy.coarsest))
        short = abs(step.missing) <= accuracy.lag
        if not (step.residual <= enough and short and moved <= accuracy.farthest):
            return None
        if step.meet(self.slight):
            return None
        return replace(
            solved,
            increment=step.x.copy(),
            multiplier=step.multiplier,
            excess=solved.excess or (0.0, 0.0),
            bend=solved.bend or (0.0, 0.0),
            slope=self.at_end,
            tangent=self.tangent,
            turn=None,
            unstable=False,
            reason="",
        )

    def slope(self) -> float | None:
        """See `Way.slope`."""
        step = self.step
        step.damping[:] = 0.0
        if not step.factorise(step.reaction, 0.0):
            return None
        step.frame.columns[0] = 0.0
        self.at_end = step.solve(1.0)
        self.tangent = step.frame.columns[0].copy()
        if not (step.stable and np.isfinite(self.at_end)):
            return None
        return None if grows(step, self.accuracy, self.settings) else self.at_end
