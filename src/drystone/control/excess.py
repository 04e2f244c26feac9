"""Load increments without bias, for engines that step under a given multiplier.

Every step starts from rest, under the static multiplier of the last point plus a small excess.  The
excess adapts so that the fastest block moves by a given amount in the step.  With a long time step
the excess is tiny.  Virtual work tells which part of the excess went into inertia, so that the
static multiplier of the point does not depend on the excess (see `engines.measures`).
"""

from __future__ import annotations

from dataclasses import dataclass

from drystone.common import tolerances
from drystone.common.language import say
from drystone.common.records import changed
from drystone.control.base import Decision, Strategy, check_settings
from drystone.control.ends import (
    End,
    Progress,
    StepSettings,
    collapsed,
    end_of_curve,
    fallen_freely,
)
from drystone.engines.base import Demand, StepReport


@dataclass(frozen=True, kw_only=True)
class ExcessSettings(StepSettings):
    """Settings of the steps.  The displacement step is that of the fastest block."""

    time_step: float = tolerances.EXCESS_TIME_STEP  # s
    # Largest excess of the multiplier; relative to the multiplier if that is above one.
    increment: float = tolerances.EXCESS
    # Motion of the control point, over the `motion_length`, after which the structure has
    # collapsed.  It counts in motion while less than the stop value is carried.
    fall: float = tolerances.EXCESS_FALL
    # The same, whatever multiplier is carried; by default twice the smallest block.
    jump: float = tolerances.EXCESS_JUMP

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, kw_only=True)
class ExcessState:
    """What the control remembers from step to step."""

    excess: float
    time_step: float  # s
    static: float = 0.0  # static multiplier of the last point
    drop: float = 0.0  # its absolute difference from that of the point before
    advance: float = 0.0  # m, motion of the control point over that difference
    # The static multiplier by virtual work, if a block seemed to be loose.
    virtual_work: float | None = None
    highest: float = 0.0  # highest static multiplier so far
    highest_at: float = 0.0  # m, control displacement there
    displacement: float = 0.0  # m, control displacement of the last point
    # m, control displacement since which, in motion, less than the stop value has been carried.
    low_since: float | None = None
    moving: bool = False  # whether inertia helped to carry the last point
    static_at: float = 0.0  # m, control displacement of the last point at rest
    # m, control displacement where a motion came to rest with less than the stop value carried, so
    # that the load begins again; None after the control point has moved on from there.
    begun_at: float | None = None
    n_steps: int = 0


class ExcessControl(Strategy[ExcessState]):
    """The strategy of the module's text."""

    settings: ExcessSettings

    def first(self, report: StepReport) -> Decision[ExcessState]:
        """Demand a step with a small share of the largest excess."""
        s = self.settings
        return self._decided(self._fresh(tolerances.FIRST_EXCESS * s.increment, s.time_step))

    def _fresh(self, excess: float, time_step: float) -> ExcessState:
        return ExcessState(excess=excess, time_step=time_step)

    def _demand(self, state: ExcessState) -> Demand:
        # The multiplier is not negative, so that blocks which it would hold back fall instead.
        return Demand(multiplier=max(state.static, 0.0) + state.excess, time_step=state.time_step)

    def decide(
        self, state: ExcessState, demand: Demand, report: StepReport
    ) -> Decision[ExcessState]:
        """Adapt the excess to the motion; a step that fails or goes too far is tried with less."""
        s = self.settings
        too_far = report.motion > 2.0 * s.displacement_step or report.late > tolerances.LATE
        if not report.converged or too_far:
            state = changed(
                state,
                excess=max(0.5 * state.excess, tolerances.LEAST_EXCESS * s.increment),
                time_step=tolerances.FAILED_TIME_STEP * state.time_step,
            )
            if state.time_step < tolerances.LEAST_EXCESS_TIME_STEP * s.time_step:
                reason = report.reason or say("end.runs_away")
                return self._decided(state, End(reason=reason), accept=False)
            return self._decided(state, accept=False)
        less = self._less(state, report)
        if less is not None:
            return self._decided(changed(state, excess=less), accept=False)
        # In a steady step the applied multiplier exceeds the static one by little more than the
        # excess.  If the difference is far larger, a block has come loose, and its fall says
        # nothing about the other blocks.  The carried multiplier lies between the static and the
        # applied one.  It is then the safe multiplier to continue from.
        applied = report.applied_multiplier
        explained = tolerances.LOOSE + 2.0 * (state.excess + state.drop)
        loose = abs(applied - report.static_multiplier) > explained
        if loose and self._steady(state, report):
            # Nothing falls any more.  The carried multiplier would only push too much.
            state = changed(state, excess=applied - report.static_multiplier)
            explained, loose = tolerances.LOOSE + 2.0 * (state.excess + state.drop), False
        # From rest, the static multiplier cannot exceed the applied one.  If it does, the load
        # pattern does next to no work on the motion, and the result of virtual work is noise.
        beyond = report.static_multiplier > applied + tolerances.LOOSE
        static = report.carried_multiplier if loose or beyond else report.static_multiplier
        load = max(abs(applied), tolerances.LEAST_LOAD)
        inertia = report.inertia_ratio * load  # over the whole load
        dynamic = loose or inertia > explained
        if static > state.highest:
            state = changed(state, highest=static, highest_at=report.control_displacement)
        state = changed(
            state,
            n_steps=state.n_steps + 1,
            static=static,
            drop=state.drop if loose else abs(static - state.static),
            advance=abs(report.control_displacement - state.displacement)
            / max(abs(static - state.static), tolerances.TINY),
            virtual_work=report.static_multiplier if loose else None,
        )
        state = self._begun(state, report, dynamic)
        dynamic = dynamic or state.begun_at is not None
        state = changed(
            state,
            low_since=self._low_since(state, report, dynamic),
            static_at=state.static_at if dynamic else report.control_displacement,
        )
        decision = self._go_on(state, report, dynamic)
        return changed(decision, load_multiplier=static, dynamic=dynamic)

    def _less(self, state: ExcessState, report: StepReport) -> float | None:
        """The smaller excess with which a step that hides a peak or a bend is tried again; None if
        it hides none."""
        nearer = self._nearer_to_peak(state, report)
        if nearer is not None:
            return nearer
        if not self._yields(state, report):
            return None
        if report.static_multiplier < state.static == state.highest:
            # Somewhere between the last point and the applied multiplier is the peak.
            finest = tolerances.OVERSHOOT_SHARE * state.highest
            return max(0.5 * state.excess, finest) if state.excess > finest else None
        finest = self._finest(max(state.highest, report.applied_multiplier))
        if state.excess <= (1.0 + tolerances.ROUNDING) * finest:
            return None
        # The finest excess of the next trial, whose applied multiplier contains the excess itself.
        finest = max(
            self._finest(state.highest),
            tolerances.HIDES / (1.0 - tolerances.HIDES) * max(state.static, 0.0),
        )
        return max(0.5 * state.excess, finest)

    def _finest(self, highest: float) -> float:
        """An excess that hides neither a peak of the multiplier ``highest`` nor a bend after it."""
        return max(tolerances.HIDES * highest, tolerances.FIRST_EXCESS * self.settings.increment)

    def _nearer_to_peak(self, state: ExcessState, report: StepReport) -> float | None:
        """The excess with which a step ends nearer to the peak that it has passed, or None.

        The estimate is that the structure moves as in the step before up to the peak, and beyond it
        by the rest of the excess, while the multiplier falls.
        """
        peak = report.multiplier_at_start
        rise, fall = peak - state.static, peak - report.static_multiplier
        known = tolerances.HIDES_NOTHING * tolerances.PEAK_SHARE * peak
        beyond = state.excess - rise
        if not (peak > state.highest and fall > known and rise > 0.0):
            return None
        moved = abs(report.control_displacement - state.displacement)
        if not 0.0 < tolerances.SOFTER * state.advance * rise < moved:
            return None  # the structure is as soft as before, or it is the first step
        if not beyond > tolerances.LEAST_EXCESS * self.settings.increment:
            return None
        nearer = rise + 0.5 * beyond * known / fall
        return nearer if nearer < tolerances.ALL_BUT * state.excess else None

    def _yields(self, state: ExcessState, report: StepReport) -> bool:
        """Whether less than half of the excess is carried where a step ends."""
        return report.static_multiplier < report.applied_multiplier - 0.5 * state.excess

    def _step(self, state: ExcessState, report: StepReport) -> float:
        """The motion of the fastest block to aim at [m]: smaller if the multiplier has fallen
        steeply since its peak."""
        largest = self.settings.displacement_step
        advanced = max(report.control_displacement - state.highest_at, largest)
        fallen = (state.highest - state.static) * largest / advanced  # in a displacement step
        share = tolerances.STEEP * state.highest / max(fallen, tolerances.TINY)
        return largest * min(1.0, max(share, tolerances.LEAST_STEEP))

    def _steady(self, state: ExcessState, report: StepReport) -> bool:
        """Whether the whole structure moves as it did in the step before.

        This is so if the control point moves with the rest, and virtual work gives the same
        multiplier again.  A negative static multiplier means a fall.
        """
        if state.virtual_work is None or report.static_multiplier < 0.0:
            return False
        above = report.applied_multiplier - report.static_multiplier
        onwards = report.control_displacement - state.displacement
        return (
            above > 0.0
            and onwards > tolerances.WITH_THE_REST * report.motion
            and abs(report.static_multiplier - state.virtual_work)
            < tolerances.SAME_MULTIPLIER * above
        )

    def _low_since(self, state: ExcessState, report: StepReport, dynamic: bool) -> float | None:
        if not dynamic or state.static >= self.settings.stop_after(state.highest):
            return None
        return report.control_displacement if state.low_since is None else state.low_since

    def _begun(self, state: ExcessState, report: StepReport, dynamic: bool) -> ExcessState:
        """The state with `moving` and `begun_at` after this step."""
        s, begun_at = self.settings, state.begun_at
        if dynamic:
            begun_at = None
        elif state.moving and state.static < s.stop_after(state.highest):
            begun_at = report.control_displacement
        elif begun_at is not None and (
            report.control_displacement > begun_at + s.displacement_step
        ):
            begun_at = None
        return changed(state, moving=dynamic, begun_at=begun_at)

    def _collapsed(self, state: ExcessState, report: StepReport, dynamic: bool) -> End | None:
        """The end of a structure that has moved too far from its last rest to be the same
        structure, or None."""
        s = self.settings
        moved = (report.control_displacement - state.static_at) / s.motion_length
        since = state.low_since
        fallen = 0.0 if since is None else report.control_displacement - since
        if fallen > s.fall * s.motion_length and state.highest > s.stop_multiplier:
            return fallen_freely(state.highest, s.stop_multiplier)
        if dynamic and moved > s.jump:
            return collapsed(say("end.in_motion"), state.highest, s.stop_multiplier)
        if state.begun_at is not None and not -1.0 <= moved <= s.fall:
            return collapsed(say("end.rests_unloaded"), state.highest, s.stop_multiplier)
        return None

    def _over(self, state: ExcessState, report: StepReport, dynamic: bool) -> End | None:
        """The end of the curve, or None if it goes on."""
        return self._collapsed(state, report, dynamic) or end_of_curve(
            self.settings, self._progress(state, report, dynamic)
        )

    def _progress(self, state: ExcessState, report: StepReport, dynamic: bool) -> Progress:
        """The figures by which the end of a curve is judged."""
        return Progress(
            multiplier=state.static,
            highest=state.highest,
            displacement=report.control_displacement,
            n_steps=state.n_steps,
            static=not dynamic,
            highest_at=state.highest_at,
        )

    def _largest(self, state: ExcessState) -> float:
        """The largest excess of the next step."""
        largest = self.settings.increment * max(1.0, state.static)
        if state.static < state.highest:
            largest = min(largest, self._finest(state.highest))
        return largest

    def _go_on(
        self, state: ExcessState, report: StepReport, dynamic: bool
    ) -> Decision[ExcessState]:
        s = self.settings
        end = self._over(state, report, dynamic)
        if end:
            return self._decided(state, end)
        step = self._step(state, report)
        share = step / max(report.motion, tolerances.LEAST_MOTION * s.displacement_step)
        if report.control_displacement < state.displacement:
            share = 2.0  # the excess was too small for the structure to go on
        growth = min(max(share, 0.5), tolerances.EXCESS_GROWTH)
        excess = min(state.excess * growth, self._largest(state))
        time_step = min(tolerances.EXCESS_TIME_GROWTH * state.time_step, s.time_step)
        state = changed(
            state, excess=excess, time_step=time_step, displacement=report.control_displacement
        )
        return self._decided(state)
