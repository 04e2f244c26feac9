"""Displacement pacing of engines that can solve for the multiplier of an increment.

Static steps of the control displacement, the multiplier being an unknown of each, adapt to how hard
the last one was.  A step that fails is tried again with less.  Where not even the smallest
increment has an equilibrium nearby, a block has come loose or the structure jumps: the jump is
passed with steps from rest under a slight excess of the multiplier (see `control.excess`), whose
points are marked dynamic, until the structure is steady again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from drystone.control.base import Decision
from drystone.control.excess import ExcessControl, ExcessSettings
from drystone.engines.base import Demand, StepReport


@dataclass(frozen=True, kw_only=True)
class DisplacementSettings:
    """Settings of the pacing."""

    displacement_step: float  # m, largest increment
    stop_multiplier: float = 0.01
    first_share: float = 0.02  # first increment over the largest
    floor_share: float = 0.004  # smallest increment over the largest
    time_step: float = 0.1  # s, where a jump is passed
    max_steps: int = 100_000
    max_displacement: float = float("inf")  # m, of the control point


@dataclass(frozen=True, kw_only=True)
class _State:
    increment: float
    static: float = 0.0
    highest: float = 0.0
    n_steps: int = 0
    passing: Any = None  # state of the control that passes a jump, None on the static path
    steady: int = 0  # steady steps since the jump
    wanted: int = 3  # steady steps before the static path is tried again


class DisplacementControl:
    """See the module's text."""

    def __init__(self, settings: DisplacementSettings) -> None:
        self.settings = settings
        self.passage = ExcessControl(
            ExcessSettings(
                displacement_step=0.5 * settings.displacement_step,
                time_step=settings.time_step,
                increment=0.005,
                stop_multiplier=settings.stop_multiplier,
            )
        )

    def first(self, report: StepReport) -> Decision:
        """A small first increment."""
        s = self.settings
        state = _State(increment=s.first_share * s.displacement_step)
        return Decision(accept=True, demand=Demand(increment=state.increment), state=state)

    def decide(self, state: _State, demand: Demand, report: StepReport) -> Decision:
        """Halve and try again where a step fails; else go on."""
        if state.passing is not None:
            return self._pass(state, demand, report)
        s = self.settings
        if not report.converged:
            state = replace(state, increment=0.25 * state.increment)
            if state.increment >= s.floor_share * s.displacement_step:
                return Decision(accept=False, demand=Demand(increment=state.increment), state=state)
            entered = self.passage.resume(state.static, state.highest, report)
            state = replace(state, passing=entered.state, steady=0)
            return replace(entered, accept=False, state=state)
        state = replace(
            state,
            n_steps=state.n_steps + 1,
            static=report.static_multiplier,
            highest=max(state.highest, report.static_multiplier),
        )
        over = self._over(state, report)
        if over is not None:
            return over
        if report.n_iterations <= 5:
            scale = 1.5
        else:
            scale = 1.0 if report.n_iterations <= 10 else 0.7
        increment = min(scale * abs(demand.increment or 0.0), s.displacement_step)
        state = replace(state, increment=increment, wanted=3)
        return Decision(
            accept=True,
            demand=Demand(increment=increment),
            state=state,
            load_multiplier=report.static_multiplier,
            dynamic=report.dynamic,
        )

    def _pass(self, state: _State, demand: Demand, report: StepReport) -> Decision:
        decision = self.passage.decide(state.passing, demand, report)
        if decision.demand is None or not decision.accept:
            return replace(decision, state=replace(state, passing=decision.state))
        static = decision.load_multiplier
        state = replace(
            state,
            n_steps=state.n_steps + 1,
            static=static,
            highest=max(state.highest, static),
            passing=decision.state,
            steady=0 if decision.dynamic else state.steady + 1,
        )
        if state.steady >= state.wanted:
            increment = 4.0 * self.settings.floor_share * self.settings.displacement_step
            state = replace(
                state, passing=None, increment=increment, wanted=min(2 * state.wanted, 24)
            )
            return replace(decision, demand=Demand(increment=increment), state=state)
        return replace(decision, state=state)

    def _over(self, state: _State, report: StepReport) -> Decision | None:
        s = self.settings
        over = Decision(
            accept=True,
            demand=None,
            state=state,
            load_multiplier=report.static_multiplier,
            dynamic=report.dynamic,
        )
        if state.static < s.stop_multiplier < state.highest:
            reason = f"the load multiplier fell below {s.stop_multiplier:g}"
            return replace(over, reason=reason, finished=True)
        if report.control_displacement >= s.max_displacement:
            reason = f"the control displacement reached {s.max_displacement:g} m"
            return replace(over, reason=reason, finished=True)
        if state.n_steps >= s.max_steps:
            return replace(over, reason=f"the limit of {s.max_steps} steps was reached")
        return None
