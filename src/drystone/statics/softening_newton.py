"""Newton's method on a step whose joints soften with the motion of the blocks.

`statics.yielding` uses it; see `law.softening` for the joints.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drystone.common.tolerances import FARTHEST_ROTATION
from drystone.geometry.motion import rotations
from drystone.law.strengths import Strengths
from drystone.statics.constants import Accuracy
from drystone.statics.solution import SolutionSettings, StepSolution, grows
from drystone.statics.static_step import StaticStep

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class SofteningNewton:
    """Newton's method from where a step is to an equilibrium with the strengths that the joints
    have there."""

    def __init__(
        self,
        step: StaticStep,
        strengths: Strengths,
        accuracy: Accuracy,
        settings: SolutionSettings,
    ) -> None:
        self.step, self.strengths, self.accuracy, self.settings = (
            step,
            strengths,
            accuracy,
            settings,
        )
        self.by_multiplier, self.tangent, self.at_end = 0.0, np.zeros_like(step.x), np.nan

    @property
    def residual(self) -> float:
        """Largest unbalanced force [N]."""
        return self.step.residual

    @property
    def missing(self) -> float:
        """What is missing of the prescribed displacement [m]."""
        return self.step.missing

    @property
    def increment(self) -> Array:
        """Increments (n, n_dof) of the present iterate."""
        return self.step.x.copy()

    def soften(self, start: Array) -> tuple[IntArray, Array]:
        """Evaluate the unbalanced forces and the tangent at the present iterate.

        Returns slots (n,) of joints that yield and their state there (n, N_POINT), by their history
        ``start`` (n_slots, N_HISTORY + dim - 2).
        """
        return self.step.soften(self.strengths, start)

    def gap(self, slot: IntArray) -> Array:
        """Gaps of slots (n,) [m]."""
        return self.step.ended().gap[slot]

    def aim(self) -> bool:
        """Find the direction of Newton's method; whether there is one."""
        step = self.step
        step.damping[:] = 0.0
        if not step.factorise(step.reaction, 0.0):
            return False
        step.bordered.columns[0] = step.force
        self.by_multiplier = step.solve(step.missing)
        most = float(np.abs(rotations(step.bordered.columns[0])).max())
        return bool(np.isfinite(self.by_multiplier) and most < FARTHEST_ROTATION)

    def move(self, length: float) -> None:
        """Move by a ``length`` of the direction."""
        self.step.multiplier += length * self.by_multiplier
        self.step.move(self.step.bordered.columns[0], length)

    def stand(self, current: Array, solved: StepSolution) -> StepSolution | None:
        """The solution at the present iterate, if it balances with the ``current`` parameters of
        joints there (n_slots, N_CURRENT); all else is that of one ``solved`` before."""
        step, accuracy = self.step, self.accuracy
        step.take(current)
        moved = step.constants.detector.farthest(step.x)
        if not (step.balanced(accuracy) and moved <= accuracy.farthest) or step.update_contacts(
            accuracy
        ):
            return None
        return replace(
            solved,
            increment=step.x.copy(),
            multiplier=step.multiplier,
            excess=solved.excess or (0.0, 0.0),
            bend=solved.bend or (0.0, 0.0),
            slope=self.at_end,
            tangent=self.tangent,
            fold=None,
            unstable=False,
            reason="",
        )

    def slope(self) -> float | None:
        """Slope of the curve [1/m] at the present iterate; None where it is unstable."""
        step = self.step
        step.damping[:] = 0.0
        if not step.factorise(step.reaction, 0.0):
            return None
        step.bordered.columns[0] = 0.0
        self.at_end = step.solve(1.0)
        self.tangent = step.bordered.columns[0].copy()
        if not (step.stable and np.isfinite(self.at_end)):
            return None
        return None if grows(step, self.accuracy, self.settings) else self.at_end
