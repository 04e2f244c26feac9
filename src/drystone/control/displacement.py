"""Displacement pacing of engines that can solve for the multiplier of an increment."""

from __future__ import annotations

from dataclasses import dataclass, replace

from drystone.control.base import Decision
from drystone.engines.base import Demand, StepReport


@dataclass(frozen=True, kw_only=True)
class DisplacementSettings:
    """Settings of the pacing."""

    displacement_step: float  # m, largest increment
    stop_multiplier: float = 0.01
    first_share: float = 0.05  # first increment over the largest
    floor_share: float = 0.005  # smallest increment over the largest
    max_steps: int = 100_000
    max_displacement: float = float("inf")  # m, of the control point


@dataclass(frozen=True, kw_only=True)
class _State:
    increment: float
    static: float = 0.0
    highest: float = 0.0
    n_steps: int = 0


class DisplacementControl:
    """Increments that adapt to how hard the last one was."""

    def __init__(self, settings: DisplacementSettings) -> None:
        self.settings = settings

    def first(self, report: StepReport) -> Decision:
        """A small first increment."""
        s = self.settings
        state = _State(increment=s.first_share * s.displacement_step)
        return Decision(accept=True, demand=Demand(increment=state.increment), state=state)

    def decide(self, state: _State, demand: Demand, report: StepReport) -> Decision:
        """Halve and try again where a step fails; else go on."""
        s = self.settings
        if not report.converged:
            state = replace(state, increment=0.5 * state.increment)
            if state.increment < s.floor_share * s.displacement_step:
                return Decision(accept=False, demand=None, state=state, reason=report.reason)
            return Decision(accept=False, demand=Demand(increment=state.increment), state=state)
        static = report.static_multiplier
        state = replace(
            state, n_steps=state.n_steps + 1, static=static, highest=max(state.highest, static)
        )
        decision = self._go_on(state, report)
        return replace(decision, load_multiplier=static, dynamic=report.dynamic)

    def _go_on(self, state: _State, report: StepReport) -> Decision:
        s, static = self.settings, state.static
        if static < s.stop_multiplier < state.highest:
            reason = f"the load multiplier fell below {s.stop_multiplier:g}"
            return Decision(accept=True, demand=None, state=state, reason=reason, finished=True)
        scale = 1.5 if report.n_iterations < 6 else 1.0
        state = replace(state, increment=min(scale * state.increment, s.displacement_step))
        return Decision(accept=True, demand=Demand(increment=state.increment), state=state)
