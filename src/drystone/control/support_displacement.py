"""Support displacement, step by step: the curve is the reaction against the supports' motion.

Steps grow after few iterations and shrink where they find no stable equilibrium.  If the smallest
step finds none either, it is taken in a short step of time, and then the supports are held: time
steps grow as the blocks come to rest.  Either a joint has slipped and the structure rests again,
and the supports go on; or it falls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from drystone.common import tolerances
from drystone.common.language import say
from drystone.common.records import changed
from drystone.control.base import Decision, Strategy
from drystone.control.progress import End, Progress
from drystone.control.stops import Stops, stops_of
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
    fall: float = math.inf  # m, that a block has moved with the supports held, when it has fallen
    # s, first one with the supports held; 0 of engines that cannot follow them so
    jump_time_step: float = 0.0
    jump_steps: int = 5000  # with the supports held, after which the motion is not followed further
    # Of the largest reaction, by which it may leave its course in a step.
    bend_share: float = tolerances.SUPPORT_BEND
    # Largest deviation of a block from the course of the last step, over the farthest motion.  It
    # counts where the reaction leaves its own by more than `deviation_bend` of the largest, in
    # steps longer than `deviation_step` of the largest.
    deviation_share: float = tolerances.DEVIATION_SHARE
    deviation_bend: float = tolerances.DEVIATION_BEND
    deviation_step: float = tolerances.DEVIATION_STEP
    time_step: float = 0.0  # s, of engines of dynamic formulations
    grow_iterations: int = 12
    stops: Stops = field(default_factory=lambda: stops_of({}))  # see `drystone.control.stops`


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
    held_step: float = 0.0  # s, time step while the supports are held; 0 while they move
    n_held: int = 0  # of these steps in a row
    travelled: float = 0.0  # m, in these steps


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
        if state.held_step:
            push = 0.0 if state.n_held else min(self._floor(), left)
            return Demand(settlement=push, time_step=state.held_step)
        return Demand(settlement=min(state.step, left), time_step=s.time_step)

    def decide(self, state: _State, demand: Demand, report: StepReport) -> Decision[_State]:
        """Try again with less where a step fails or is a jump; else go on."""
        if state.held_step:
            return self._held(state, demand, report)
        s, step, floor = self.settings, demand.settlement or 0.0, self._floor()
        usual = max(state.motion_ratio, s.scale)
        jumps = report.converged and report.motion > s.jump_ratio * usual * step
        may_jump = step <= floor and state.jumps < s.most_jumps
        if not report.converged or report.unstable or (jumps and not may_jump):
            return self._again(state, report, step)
        advanced = step * report.reached
        slope = (report.reaction - state.reaction) / advanced if advanced else state.slope
        greatest = max(state.greatest, abs(report.reaction))
        worth = step > tolerances.WORTH_BENDING * floor and not jumps
        if state.slope is not None and slope is not None and worth:
            off = abs(slope - state.slope) * advanced
            first = tolerances.WORTH_OF_FIRST * s.first_share * s.step
            known = max(greatest, tolerances.LEAST_REACTION)
            turns = (report.path.deviation or 0.0) > s.deviation_share
            turns = turns and off > s.deviation_bend * known and step > s.deviation_step * s.step
            if turns or (off > s.bend_share * known and step > first):
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
            motion_ratio=report.motion / advanced if advanced else state.motion_ratio,
        )
        dynamic = report.dynamic or report.inertia_ratio > s.inertia
        return self._decided(
            state,
            self._over(state, static=not dynamic),
            load_multiplier=report.reaction / s.unit,
            dynamic_multipliers=self._dynamic_multipliers(report),
            dynamic=dynamic,
            jumped=jumps,
        )

    def _over(self, state: _State, *, static: bool) -> End | None:
        s = self.settings
        if not state.held_step and state.moved >= s.largest * tolerances.ALL_MOVED:
            return End(reason=say("end.supports_moved"), finished=True)
        progress = Progress(
            multiplier=state.reaction / s.unit,
            highest=state.greatest / s.unit,
            displacement=state.moved,
            n_steps=state.n_steps,
            static=static,
        )
        ends = (stop.end(value, progress) for stop, value in s.stops)
        return next(filter(None, ends), None)

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
        s = self.settings
        if step <= self._floor():
            if s.jump_time_step == 0.0 or state.jumps == s.most_jumps:
                return self._falls(state, report)
            state = changed(state, held_step=s.jump_time_step, n_held=0, travelled=0.0)
            return self._decided(state, accept=False)
        state = changed(state, step=max(tolerances.SUPPORT_SHORTER * step, self._floor()))
        return self._decided(state, accept=False)

    def _floor(self) -> float:
        """The smallest step [m]."""
        return self.settings.floor_share * self.settings.step

    def _held(self, state: _State, demand: Demand, report: StepReport) -> Decision[_State]:
        """What a step of time with the supports held has come to."""
        s, h = self.settings, state.held_step
        if not report.converged:
            state = changed(state, held_step=0.5 * h)
            if state.held_step < tolerances.LEAST_JUMP * s.jump_time_step:
                return self._falls(state, report)
            return self._decided(state, accept=False)
        state = changed(
            state,
            n_steps=state.n_steps + 1,
            n_held=state.n_held + 1,
            travelled=state.travelled + report.motion,
            moved=state.moved + (demand.settlement or 0.0),
            reaction=report.reaction,
            slope=None,
        )
        end, inertia = None, max(report.inertia_ratio, report.acceleration)
        dynamic = not (inertia < s.inertia and h > tolerances.LONG_ENOUGH * s.jump_time_step)
        if state.travelled > s.fall:
            end = self._fall(report)
        elif state.n_held >= s.jump_steps:
            end = End(reason=say("end.no_rest", n=s.jump_steps))
        elif dynamic:
            longest = tolerances.LONGEST_HELD * s.jump_time_step
            state = changed(state, held_step=min(tolerances.JUMP_GROWTH * h, longest))
            end = self._over(state, static=False)
        else:
            state = changed(state, held_step=0.0, step=self._floor(), jumps=state.jumps + 1)
            end = self._over(state, static=True)
        return self._decided(
            state,
            end,
            load_multiplier=report.reaction / s.unit,
            dynamic_multipliers=self._dynamic_multipliers(report),
            dynamic=dynamic,
            jumped=True,
        )

    def _falls(self, state: _State, report: StepReport) -> Decision[_State]:
        shown = self._dynamic_multipliers(report)
        return self._decided(state, self._fall(report), accept=False, dynamic_multipliers=shown)

    @staticmethod
    def _fall(report: StepReport) -> End:
        """A structure whose blocks move on falls; a step that is not solved shows nothing."""
        if not (report.converged or report.dynamic):
            return End(reason=say("end.supports_unsolved", why=report.reason))
        why = report.reason or "blocks move on by themselves"
        return End(reason=say("end.supports_fall", why=why), finished=True)
