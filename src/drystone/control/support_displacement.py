"""Support displacement, step by step: the curve is the reaction against the supports' motion.

Steps grow after few iterations and shrink where they find no equilibrium.  If the smallest step
finds none either, the structure falls: supports that move on slowly bring it down there.
"""

from __future__ import annotations

from dataclasses import dataclass

from drystone.common import tolerances
from drystone.common.language import say
from drystone.common.records import changed
from drystone.control.base import Decision, Strategy
from drystone.control.progress import End
from drystone.engines.base import Demand, StepReport


@dataclass(frozen=True, kw_only=True)
class SupportSettings:
    """Settings of the steps; lengths are angles [rad] where supports rotate."""

    largest: float  # m, how far supports go
    step: float  # m, largest step
    unit: float  # N or N m, that the multiplier counts the reaction in
    scale: float = 1.0  # m, by which an angle is a motion
    first_share: float = tolerances.FIRST_SHARE  # first step over the largest
    floor_share: float = tolerances.SUPPORT_FLOOR  # smallest step over the largest
    # Motion of a block over that of the supports, or over as much as it was in the last step, above
    # which it jumps.
    jump_ratio: float = tolerances.JUMP_RATIO
    most_jumps: int = 10  # of smallest steps in a row, after which it has fallen
    # Over the weight, above which a point is passed in motion.
    inertia: float = tolerances.STATIC_INERTIA
    # Of the largest reaction, by which it may leave its course in a step.
    bend_share: float = tolerances.SUPPORT_BEND
    time_step: float = 0.0  # s, of engines of dynamic formulations
    grow_iterations: int = 12
    max_steps: int = 100_000


@dataclass(frozen=True, kw_only=True)
class _State:
    step: float
    moved: float = 0.0
    n_steps: int = 0
    reaction: float = 0.0
    slope: float | None = None
    greatest: float = 0.0
    jumps: int = 0  # in a row
    # m, motion of the fastest block over that of the supports in the last step
    motion_ratio: float = 0.0


class SupportControl(Strategy[_State]):
    """See the module's text."""

    settings: SupportSettings

    def first(self, report: StepReport) -> Decision[_State]:
        """The structure at rest on supports that have not moved."""
        s = self.settings
        state = _State(
            step=s.first_share * s.step,
            reaction=report.reaction,
            greatest=abs(report.reaction),
        )
        return self._decided(state, load_multiplier=report.reaction / s.unit)

    def _demand(self, state: _State) -> Demand:
        s = self.settings
        left = s.largest - state.moved
        return Demand(settlement=min(state.step, left), time_step=s.time_step)

    def decide(self, state: _State, demand: Demand, report: StepReport) -> Decision[_State]:
        """Try again with less where a step fails or is a jump; else go on."""
        s, step = self.settings, demand.settlement or 0.0
        floor = s.floor_share * s.step
        usual = max(state.motion_ratio, s.scale)
        jumps = report.converged and report.motion > s.jump_ratio * usual * step
        if not report.converged or (jumps and (step > floor or state.jumps == s.most_jumps)):
            return self._again(state, report, step)
        advanced = step * report.reached
        slope = (report.reaction - state.reaction) / advanced if advanced else state.slope
        greatest = max(state.greatest, abs(report.reaction))
        worth = step > tolerances.WORTH_BENDING * floor and not jumps
        if state.slope is not None and slope is not None and worth:
            off = abs(slope - state.slope) * advanced
            first = tolerances.WORTH_OF_FIRST * s.first_share * s.step
            if off > s.bend_share * greatest and step > first:
                state = changed(state, step=tolerances.SUPPORT_SHORTER * step)
                return self._decided(state, accept=False)
        state = changed(
            state,
            moved=state.moved + advanced,
            n_steps=state.n_steps + 1,
            reaction=report.reaction,
            slope=slope,
            greatest=greatest,
            step=self._next(step, report),
            jumps=state.jumps + 1 if jumps else 0,
            motion_ratio=state.motion_ratio if jumps or not advanced else report.motion / advanced,
        )
        end = None
        if state.moved >= s.largest * tolerances.ALL_MOVED:
            end = End(reason=say("end.supports_moved"), finished=True)
        elif state.n_steps >= s.max_steps:
            end = End(reason=say("end.supports_steps", n=s.max_steps))
        return self._decided(
            state,
            end,
            load_multiplier=report.reaction / s.unit,
            dynamic_multipliers=self._dynamic_multipliers(report),
            dynamic=report.dynamic or report.inertia_ratio > s.inertia,
            jumped=jumps,
        )

    def _dynamic_multipliers(self, report: StepReport) -> tuple[float, ...]:
        """Reactions that the curve shows at the dynamic points within a step."""
        return tuple(
            passed.reaction / self.settings.unit for _, passed in report.path.dynamic_states
        )

    def _next(self, step: float, report: StepReport) -> float:
        s = self.settings
        grows = s.time_step > 0.0 or report.n_iterations <= s.grow_iterations
        return min(2.0 * step if grows else step, s.step)

    def _again(self, state: _State, report: StepReport, step: float) -> Decision[_State]:
        s, why = self.settings, report.reason or "blocks move on by themselves"
        if step <= s.floor_share * s.step:
            end = End(reason=say("end.supports_fall", why=why), finished=True)
            shown = self._dynamic_multipliers(report)
            return self._decided(state, end, accept=False, dynamic_multipliers=shown)
        state = changed(state, step=max(tolerances.SUPPORT_SHORTER * step, s.floor_share * s.step))
        return self._decided(state, accept=False)
