"""Support displacement, step by step: the curve shows the reaction against the supports' motion.

Steps grow after few iterations, and become shorter if they find no stable equilibrium.  If the
smallest step finds none either, it is taken as a short time step, and then the supports are held.
Time steps grow as the blocks come to rest.  If a joint has slipped and the structure is at rest
again, the supports go on.  Otherwise the structure falls.
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

#: Smallest steps with a jump in a row after which the structure falls.
MOST_JUMPS = 10

#: Steps with the supports held after which the motion is given up.
HELD_STEPS = 5000


@dataclass(frozen=True, kw_only=True)
class SupportSettings:
    """Settings of the steps.  If supports rotate, the lengths of steps are angles [rad]."""

    largest: float  # m, displacement at which supports stop
    step: float  # m, largest step
    unit: float  # N or N m, reaction of which the multiplier is one
    scale: float = 1.0  # m, motion of a block per rad if supports rotate
    fall: float = math.inf  # m, motion with the supports held after which a block has fallen
    # s, first time step with the supports held; 0 for engines that cannot follow such a motion
    jump_time_step: float = 0.0
    time_step: float = 0.0  # s, for engines of dynamic formulations; 0 for others
    grow_iterations: int = 12  # iterations of a step up to which steps grow
    stops: Stops = field(default_factory=lambda: stops_of({}))  # see `drystone.control.stops`


@dataclass(frozen=True, kw_only=True)
class _State:
    step: float  # m, length of the next step
    moved: float = 0.0  # m, by which the supports have moved
    n_steps: int = 0
    reaction: float = 0.0  # N or N m, at the last point
    slope: float | None = None  # N/m, of the reaction in the last step
    greatest: float = 0.0  # N or N m, largest reaction so far, whatever its sign
    jumps: int = 0  # in a row
    # Motion of the fastest block over that of the supports in the last step
    motion_ratio: float = 0.0
    held_step: float = 0.0  # s, time step while the supports are held; 0 while they move
    n_held: int = 0  # steps in a row with the supports held
    travelled: float = 0.0  # m, motion of blocks in these steps


class SupportControl(Strategy[_State]):
    """The strategy of the module's text."""

    settings: SupportSettings

    def first(self, report: StepReport) -> Decision[_State]:
        """Demand the first step, after the structure is at rest on supports that have not moved."""
        s = self.settings
        state = _State(
            step=tolerances.FIRST_SHARE * s.step,
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
        """Try again with less if a step fails or is a jump; otherwise go on."""
        if state.held_step:
            return self._held(state, demand, report)
        s, step, floor = self.settings, demand.settlement or 0.0, self._floor()
        usual = max(state.motion_ratio, s.scale)
        jumps = report.converged and report.motion > tolerances.JUMP_RATIO * usual * step
        may_jump = step <= floor and state.jumps < MOST_JUMPS
        if not report.converged or report.unstable or (jumps and not may_jump):
            return self._again(state, report, step)
        if report.late > tolerances.LATE and step > floor:
            return self._shorter(state, step)
        advanced = step * report.reached
        slope = (report.reaction - state.reaction) / advanced if advanced else state.slope
        greatest = max(state.greatest, abs(report.reaction))
        worth = step > floor and not jumps
        if state.slope is not None and slope is not None and worth:
            off = abs(slope - state.slope) * advanced
            known = max(greatest, tolerances.LEAST_REACTION)
            turns = (
                (report.path.deviation or 0.0) > tolerances.DEVIATION_SHARE
                and off > tolerances.DEVIATION_BEND * known
                and step > tolerances.DEVIATION_STEP * s.step
            )
            if turns or off > tolerances.SUPPORT_BEND * known:
                return self._shorter(state, step)
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
        dynamic = report.dynamic or report.inertia_ratio > tolerances.STATIC_INERTIA
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
            if s.jump_time_step == 0.0 or state.jumps == MOST_JUMPS:
                return self._falls(state, report)
            state = changed(state, held_step=s.jump_time_step, n_held=0, travelled=0.0)
            return self._decided(state, accept=False)
        return self._shorter(state, step)

    def _shorter(self, state: _State, step: float) -> Decision[_State]:
        """Try the step again, shorter."""
        state = changed(state, step=max(tolerances.SUPPORT_SHORTER * step, self._floor()))
        return self._decided(state, accept=False)

    def _floor(self) -> float:
        """The smallest step [m]."""
        return tolerances.SUPPORT_FLOOR * self.settings.step

    def _held(self, state: _State, demand: Demand, report: StepReport) -> Decision[_State]:
        """Decide after a time step with the supports held."""
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
        long = h > tolerances.LONG_ENOUGH * s.jump_time_step
        dynamic = not (long and inertia < tolerances.STATIC_INERTIA)
        if state.travelled > s.fall:
            end = self._fall(report)
        elif state.n_held >= HELD_STEPS:
            end = End(reason=say("end.no_rest", n=HELD_STEPS))
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
        """The end by a fall, if blocks move on.  A step that is not solved does not show a fall."""
        if not (report.converged or report.dynamic):
            return End(reason=say("end.supports_unsolved", why=report.reason))
        why = report.reason or say("end.moves_on")
        return End(reason=say("end.supports_fall", why=why), finished=True)
