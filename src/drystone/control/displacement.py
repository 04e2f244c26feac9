"""Prescribed displacement, for engines that can solve for the multiplier of an increment.

Each static step prescribes an increment of the control displacement; the multiplier is an unknown
of the step.  The next increment depends on the iterations that the last step took.

A step may pass over a fold of the path of equilibria if the multiplier hardly drops there and no
block moves far by itself.  Otherwise steps follow the path up to the fold, and one small step
crosses it.  If that step finds no equilibrium, a block has come loose, or the structure jumps to
another shape.

A jump is followed in motion.  The control displacement creeps on, and time steps are so short that
inertia decides where the blocks go.  The time steps grow as the blocks come to rest.  Points that
inertia helps to carry are marked dynamic.  Their multiplier is that of an instant, so it cannot end
the curve: only a point at rest below the stop value can.  If the structure falls for long, and only
a negative load would hold the control point back, it has collapsed in motion.  The curve then ends
with its last point at rest.

If a step hides a peak or a bend of the curve, it is repeated with a shorter increment that ends at
the peak or bend.  The engine reports where it is, from the multiplier within the step.  The last
step ends where the chord of the curve meets the stop value.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from drystone.common import tolerances
from drystone.common.language import say
from drystone.common.records import changed
from drystone.control.base import Decision, Strategy, check_settings
from drystone.control.ends import (
    End,
    Progress,
    StepSettings,
    carries_nothing,
    collapsed,
    end_of_curve,
    fallen_freely,
    nothing_carried,
)
from drystone.engines.base import OVERSHOOT_PARTS, Demand, StepReport

#: Times that a step is shortened to where its chord meets the stop value, before it is halved too.
CHORDS = 2

#: Steps after a failure until increments grow again.
GROWN_AFTER = 3

#: Steps of a jump after which a time step that failed is tried again.
RETRIED_AFTER = 5

#: Number of steps since the last failure, if no step has failed.
LONG_AGO = 1_000_000


@dataclass(frozen=True, kw_only=True)
class DisplacementSettings(StepSettings):
    """Settings of the steps and of the jumps.  The displacement step is the largest increment."""

    bend_share: float = tolerances.BEND_SHARE  # largest bend of the curve in a step, over the peak
    time_step: float = tolerances.JUMP_TIME_STEP  # s, of the first step of a jump
    grow_iterations: int = 12  # iterations of a step up to which increments grow
    # Steps without rest after which a jump is not followed further.  A falling block moves by about
    # the `motion_length` in each.
    jump_steps: int = 5000

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, kw_only=True)
class DisplacementState:
    """What the control remembers from step to step."""

    increment: float  # m
    highest: float = 0.0  # highest multiplier so far
    highest_at: float = 0.0  # m, control displacement there
    released: bool = False  # whether the load is taken off, so that loose blocks fall
    last: float = 0.0  # multiplier of the last point
    displacement: float = 0.0  # m, of the control point there
    slope: float = 0.0  # 1/m, of the curve there
    n_steps: int = 0
    n_shorter: int = 0  # times that this step was repeated with a shorter increment
    n_jump_steps: int = 0  # steps of the jump since the structure was at rest
    jump_time: float = 0.0  # s, sum of the time steps of these steps
    fallen: float = 0.0  # m, motion in those of these steps that held the control point back
    time_step: float = 0.0  # s, of a jump; 0 on the static path
    acceleration: float = 0.0  # m/s2, of the fastest block in the last step of the jump
    shortened: bool = False  # whether this step of a jump has failed with a longer time step
    too_long: float = math.inf  # s, time step of a jump that failed last
    n_since: int = LONG_AGO  # steps since one failed
    # s, duration of the jump when it last seemed to be over; 0 if none did since a static step
    rested_at: float = 0.0
    load_increment: float = 0.0  # of a step with a given multiplier; 0 under displacement control
    loaded_from: float = 0.0  # m, control displacement of the fold from which the load grows
    next_load: float = 0.0  # next load increment, until a displacement increment succeeds
    closing: float = math.inf  # m, closure of the joint that closes most under the dead load
    crossing: bool = False  # whether the next step is to pass over a fold
    unstable: bool = False  # whether the last point was an unstable equilibrium


class DisplacementControl(Strategy[DisplacementState]):
    """The strategy of the module's text."""

    settings: DisplacementSettings

    def first(self, report: StepReport) -> Decision[DisplacementState]:
        """Demand a small first increment, no larger than joints close under the dead load."""
        s = self.settings
        closing = report.penetration if report.penetration > 0.0 else math.inf
        first = min(tolerances.FIRST_SHARE * s.displacement_step, closing)
        return self._decided(self._begun(first, closing))

    def _begun(self, increment: float, closing: float) -> DisplacementState:
        """The state before the first step."""
        return DisplacementState(increment=increment, closing=closing)

    def _demand(self, state: DisplacementState) -> Demand:
        if state.released:
            return Demand(multiplier=0.0)
        if state.load_increment:
            return Demand(multiplier=state.last + state.load_increment)
        if state.time_step == 0.0:
            return Demand(
                increment=self._within(state),
                over_fold=state.crossing,
                full_search=self._wants_full_search(state),
            )
        # In a jump the control point creeps with an acceleration that does not depend on the step.
        s = self.settings
        share = min((state.time_step / s.time_step) ** 2, tolerances.MOST_CREEP)
        creep = tolerances.CREEP_SHARE * s.displacement_step * share
        return Demand(increment=creep, time_step=state.time_step)

    def _within(self, state: DisplacementState) -> float:
        """The increment [m], shortened so that the curve ends at the last displacement asked for.

        It is not shortened below a smallest increment, because engines that drive the structure
        there come only near what is demanded.
        """
        s = self.settings
        left = s.last_displacement - state.displacement
        least = tolerances.FLOOR_SHARE * min(s.displacement_step, s.last_displacement)
        return min(state.increment, max(left, least))

    def _wants_full_search(self, state: DisplacementState) -> bool:
        """Whether a static step may use the full search.

        A long step may not: if it fails, a shorter one is tried.  A step that crosses a fold may
        not either: if it fails, the motion is followed.
        """
        s = self.settings
        small = state.increment <= tolerances.FULL_SEARCH_SHARE * s.displacement_step
        return small and not state.crossing

    def decide(
        self, state: DisplacementState, demand: Demand, report: StepReport
    ) -> Decision[DisplacementState]:
        """Try again with less if a step fails; otherwise go on."""
        if state.released:
            return self._begin_again(state, report)
        if state.load_increment:
            return self._under_load(state, report)
        if not state.time_step and demand.increment is not None:
            state = changed(state, increment=abs(demand.increment))  # it may have been shortened
        if not report.converged or self._snaps(state, report) or self._strays(state, report):
            return self._retry(state, report)
        if self._thrown_back(state, report) or self._falls_freely(state, report):
            report = changed(report, dynamic=True)  # it is another structure at rest
        multiplier = report.static_multiplier
        advanced = report.reached * state.increment
        jumped = bool(state.time_step or report.path.dynamic_states) or self._is_jump(state, report)
        finer = None
        if not state.time_step and advanced:
            finer = self._finer(changed(state, increment=advanced), report)
        if finer is not None:
            state = changed(state, increment=finer, n_shorter=state.n_shorter + 1)
            return self._decided(state, accept=False)
        if multiplier > state.highest and not report.dynamic:
            state = changed(state, highest=multiplier, highest_at=report.control_displacement)
        behind = advanced != 0.0 and report.control_displacement < state.highest_at
        back = multiplier < 0.0 and behind  # not as a bond breaks: then `advanced` is zero
        state = changed(
            state,
            n_steps=state.n_steps + 1,
            n_shorter=0,
            n_jump_steps=state.n_jump_steps + 1 if state.time_step else 0,
            jump_time=state.jump_time + state.time_step if state.time_step else 0.0,
            fallen=self._fallen(state, report),
            released=back and not state.time_step,
            last=multiplier,
            displacement=report.control_displacement,
            unstable=report.unstable,
            slope=(multiplier - state.last) / advanced if advanced and not state.time_step else 0.0,
            next_load=0.0,
        )
        over = self._over(state, report)
        if over is None:
            state = (
                self._jumping(state, report) if state.time_step else self._adapted(state, report)
            )
        return self._decided(
            state,
            over,
            load_multiplier=multiplier,
            dynamic=report.dynamic,
            jumped=jumped,
            dynamic_multipliers=_dynamic_multipliers(report),
        )

    def _begin_again(
        self, state: DisplacementState, report: StepReport
    ) -> Decision[DisplacementState]:
        """Begin to load again after the structure has come to rest without load."""
        if not report.converged:
            return self._decided(state, End(reason=report.reason), accept=False)
        s = self.settings
        first = tolerances.FIRST_SHARE * s.displacement_step
        n_steps = state.n_steps + 1
        state = changed(
            state,
            n_steps=n_steps,
            last=0.0,
            displacement=report.control_displacement,
            slope=0.0,
            released=False,
            increment=first,
        )
        return self._decided(state, dynamic_multipliers=_dynamic_multipliers(report))

    def _under_load(
        self, state: DisplacementState, report: StepReport
    ) -> Decision[DisplacementState]:
        """Let the load grow on if the control point turns back before the peak.

        Displacements are prescribed again as soon as the control point is beyond the fold.  If even
        the smallest increase of the load finds no equilibrium, this is the peak, and the jump from
        it is followed in motion.

        Blocks may jump far if the control point moves back, for instance as a bond breaks: with the
        control point held, the structure would fall below the load that it carries.  A far jump
        ahead of the fold is not accepted, because the structure may reach that equilibrium only by
        falling.
        """
        s = self.settings
        near = report.motion <= s.displacement_step
        back = report.control_displacement <= state.loaded_from
        if not report.converged or report.dynamic or not (near or back):
            less = 0.5 * state.load_increment
            if less < tolerances.PEAK_SHARE * self._scale(state):
                state = self._in_motion(changed(state, load_increment=0.0))
            else:
                state = changed(state, load_increment=less)
            return self._decided(state, accept=False)
        multiplier, there = report.static_multiplier, report.control_displacement
        beyond = there > state.loaded_from
        more = min(2.0 * state.load_increment, tolerances.LOAD_SHARE * self._scale(state))
        state = changed(
            state,
            n_steps=state.n_steps + 1,
            last=multiplier,
            displacement=there,
            slope=0.0,
            highest=max(multiplier, state.highest),
            highest_at=there,
            load_increment=0.0 if beyond else more,
            next_load=more,
            n_jump_steps=0,
            jump_time=0.0,
            rested_at=0.0,
            crossing=False,
        )
        over = end_of_curve(s, self._progress(state, report))
        return self._decided(state, over, load_multiplier=multiplier, jumped=not near)

    def _scale(self, state: DisplacementState) -> float:
        """The multiplier that shares of the peak refer to: the peak so far, or a least value."""
        return max(state.highest, tolerances.LEAST_PEAK)

    def _carried(self, state: DisplacementState) -> float:
        """The highest multiplier that the structure has carried so far."""
        return state.highest

    def _finer(self, state: DisplacementState, report: StepReport) -> float | None:
        """A smaller increment [m] if the step hides the peak, a bend or the stop value, or None."""
        s = self.settings
        multiplier = report.static_multiplier
        least = tolerances.REFINED_SHARE * s.displacement_step
        stop = s.stop_after(state.highest)
        if multiplier < stop < state.last:
            # Aim just below the stop value, along the chord; a jump has no equilibria on its chord.
            if stop - multiplier <= tolerances.REFINED_SHARE * stop:
                return None
            if self._is_jump(state, report):
                return self._looked_at(state)
            aim = (1.0 - 0.5 * tolerances.REFINED_SHARE) * stop
            share = (state.last - aim) / (state.last - multiplier)
            if state.n_shorter >= CHORDS:
                share = 0.5 * share  # the curve is bent so much that halving is better
            finer = share * state.increment
            return finer if finer > tolerances.LEAST_CHORD * least else None
        scale = max(self._scale(state), multiplier)
        if report.path.excess is None or report.path.bend is None:  # the engine does not tell
            return self._nearer(state, report, scale, least)
        excess, share = report.path.excess
        highest = max(state.last, multiplier) + excess > state.highest
        hidden = excess > tolerances.PEAK_SHARE * scale and highest
        # With stiff joints a peak comes early.
        finest = min(least, tolerances.REFINED_SHARE * state.closing)
        if hidden and finest < share * state.increment < tolerances.ALL_BUT * state.increment:
            return share * state.increment
        bend, share = report.path.bend
        hidden = bend > s.bend_share * scale
        if hidden and finest < share * state.increment < tolerances.ALL_BUT * state.increment:
            return share * state.increment
        if report.unstable and not state.unstable and not state.n_shorter:
            # A stable equilibrium may lie nearby, and the unstable one be of another branch.
            looked_at = self._looked_at(state)
            if looked_at is not None:
                return looked_at
        return self._straighter(state, report, scale)

    def _looked_at(self, state: DisplacementState) -> float | None:
        """A smaller increment [m] for a step that has come to another branch; None if it would be
        too small."""
        s = self.settings
        finer = tolerances.LOOKED_AT_SHARE * state.increment
        return finer if finer > tolerances.FLOOR_SHARE * s.displacement_step else None

    def _straighter(
        self, state: DisplacementState, report: StepReport, scale: float
    ) -> float | None:
        """A smaller increment [m] if blocks have deviated from the predictor, or None.

        Joints have changed within the step, and blocks have changed their direction of motion.  The
        step knows only its two ends, not where the change was.  The error in the places of the
        blocks would remain.
        """
        s = self.settings
        if report.path.deviation is None or report.path.bend is None:
            return None
        least = tolerances.DEVIATION_STEP * s.displacement_step
        if (
            report.path.deviation <= tolerances.DEVIATION_SHARE
            or report.path.bend[0] <= tolerances.DEVIATION_BEND * scale
        ):
            return None
        if state.increment <= least:
            return None
        return max(tolerances.LOOKED_AT_SHARE * state.increment, least)

    def _nearer(
        self, state: DisplacementState, report: StepReport, scale: float, least: float
    ) -> float | None:
        """A smaller increment [m] if the curve, continued with its last slope, might have a peak
        within the step, or None; for engines that do not report excess and bend."""
        s = self.settings
        multiplier = report.static_multiplier
        finest = min(least, tolerances.REFINED_SHARE * state.closing)
        ahead = state.slope * state.increment
        if report.path.overshoot is not None:
            finer = self._less_overshoot(state, report, scale, finest)
            if finer is not None:
                return finer
            # The overshoot is a mean over parts of the step, and shows no peak sharper than a part.
            unseen = ahead / OVERSHOOT_PARTS if state.last == state.highest else 0.0
            seen = unseen <= tolerances.OVERSHOOT_SHARE * scale
            if (
                multiplier < state.last
                and seen
                and report.path.overshoot
                <= tolerances.NO_OVERSHOOT * tolerances.OVERSHOOT_SHARE * scale
            ):
                return None  # there was no peak within the step
        if state.last != state.highest or ahead <= 0.0:
            return None
        rise = max(multiplier - state.last, 0.0)
        hidden = ahead - rise
        if hidden > s.bend_share * scale:
            least = finest
        elif (
            multiplier >= state.last
            or hidden <= tolerances.HIDES_NOTHING * tolerances.PEAK_SHARE * scale
        ):
            return None
        if rise > tolerances.KINK * ahead or state.increment <= least:
            return None
        return max(tolerances.NEARER_TO_KINK * state.increment, least)

    def _less_overshoot(
        self, state: DisplacementState, report: StepReport, scale: float, finest: float
    ) -> float | None:
        """A smaller increment [m] if the overshoot of the step is too large, or None.

        Either the step hides a peak, or inertia drives the blocks.  In the second case joints slide
        that would have stuck, or stick that would have slid, and their history stays changed.
        """
        s = self.settings
        overshoot, multiplier = report.path.overshoot or 0.0, report.static_multiplier
        above = max(state.last, multiplier) + overshoot - max(state.highest, multiplier)
        if above > tolerances.OVERSHOOT_SHARE * scale:
            most, least = tolerances.OVERSHOOT_SHARE * scale, finest
        else:
            most = tolerances.DRIVE_SHARE * scale
            least = tolerances.FLOOR_SHARE * s.displacement_step
        if overshoot <= most or state.increment <= least:
            return None
        return max(min(max(most / overshoot, 0.25), 0.5) * state.increment, least)

    def _is_jump(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether blocks have moved too far for the increment, so that there are no equilibria on
        their way."""
        return report.motion > tolerances.SNAP_MOTION * state.increment

    def _thrown_back(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether the step is a jump to an equilibrium behind the start of the load.

        The structure then fell while the load held the control point back.  It stands as another
        structure than the one that was loaded.
        """
        behind = report.control_displacement < -self.settings.motion_length
        return behind and not state.time_step and self._is_jump(state, report)

    def _snaps(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether a step has passed over a fold with a jump that the curve should show."""
        if state.time_step:
            return False
        if self._is_jump(state, report) and self._would_end(state, report):
            return True
        if report.path.fold is None and not state.crossing:
            return False
        if self._is_jump(state, report):
            return True
        if report.path.fold is None or state.crossing:
            return False
        share, multiplier, drop = report.path.fold
        if math.isnan(drop):
            expected = state.last + state.slope * state.increment
            if share > tolerances.FOLD_KNOWN:
                expected = state.last + (multiplier - state.last) / share
            drop = expected - report.static_multiplier
        return abs(drop) > tolerances.SNAP_SHARE * self._scale(state)

    def _strays(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether a step of a jump leads much farther than the blocks were moving.

        With a short time step the equations have one solution.  With a long one they may have
        several, of which the structure reaches the nearest.  Before there is an acceleration to
        expect a motion from, a step is as long as one of the curve.
        """
        s = self.settings
        expected = tolerances.FARTHER * state.acceleration * state.time_step**2
        far = max(tolerances.JUMP_MOTION * s.displacement_step, expected)
        return state.time_step > 0.0 and report.motion > far

    def _falls_freely(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether the control point moves far without load within a step that ends at rest, and the
        structure would carry load again there.

        The block of the control point, or a block below it, has then fallen, so that the structure
        is another one than that which was loaded.  If it carries nothing at rest, the point ends
        the curve anyway.
        """
        s, since = self.settings, math.inf
        stop = s.stop_after(state.highest)
        if report.static_multiplier < stop:
            return False
        for _, passed in report.path.dynamic_states:
            if passed.static_multiplier >= stop:
                since = math.inf
                continue
            since = min(since, passed.control_displacement)
            if passed.control_displacement - since > tolerances.FALL_MOTION * s.motion_length:
                return True
        return False

    def _would_end(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether a static step ends below the stop value, at an equilibrium that does not count.

        An equilibrium far away need not be the one to which the structure falls.  But an engine
        that reports an overshoot has followed the step in motion, so that its end counts.
        """
        stop = self.settings.stop_after(state.highest)
        return report.static_multiplier < stop < state.last and report.path.overshoot is None

    def _retry(self, state: DisplacementState, report: StepReport) -> Decision[DisplacementState]:
        s, floor = self.settings, self._floor(state)
        if state.time_step:
            state = changed(
                state,
                time_step=0.5 * state.time_step,
                shortened=True,
                too_long=state.time_step,
                n_since=0,
            )
            if state.time_step < tolerances.LEAST_JUMP * s.time_step:
                reason: str = say("end.jump_lost", why=report.reason)
                if self._carried(state) <= 0.0:
                    reason = say("end.nothing_found", why=report.reason)
                return self._lost(state, report, reason)
        elif state.crossing and report.path.dynamic_states and report.dynamic:
            # The step has followed the collapse itself: there is no jump left to follow.
            return self._lost(state, report, report.reason)
        elif state.crossing and self._load_grows_on(state):
            load = max(tolerances.PEAK_SHARE * self._scale(state), state.next_load)
            state = changed(state, load_increment=load, loaded_from=state.highest_at)
        elif state.crossing:
            state = self._in_motion(state)
        else:
            state = changed(state, n_since=0)
            share = report.path.fold.share if report.path.fold else 0.5
            within = share < tolerances.FOLD_WITHIN
            shorter = tolerances.ALL_BUT * share if within else tolerances.SHORTER
            nearer = shorter * state.increment
            if nearer >= floor:
                state = changed(state, increment=nearer)
            else:
                state = changed(state, crossing=True, increment=tolerances.CROSSING_LENGTH * floor)
        return self._decided(state, accept=False)

    def _load_grows_on(self, state: DisplacementState) -> bool:
        """Whether a larger load is tried if no displacement ahead has an equilibrium."""
        return state.last == state.highest

    def _in_motion(self, state: DisplacementState) -> DisplacementState:
        """The state from which a jump is followed.  The jump may be one that seemed to be over."""
        first = self.settings.time_step
        return changed(state, crossing=False, time_step=first, acceleration=0.0, n_since=LONG_AGO)

    def _floor(self, state: DisplacementState) -> float:
        """The smallest increment that is tried along the path."""
        s = self.settings
        floor = tolerances.FLOOR_SHARE * s.displacement_step
        if state.last == state.highest:
            floor = min(floor, tolerances.CLOSING_SHARE * state.closing)
            if state.slope > 0.0:  # a crossing hides no more than a bend may
                steepest = tolerances.CROSSING_LENGTH * state.slope
                floor = min(floor, s.bend_share * self._carried(state) / steepest)
        return floor

    def _lost(
        self, state: DisplacementState, report: StepReport, reason: str
    ) -> Decision[DisplacementState]:
        """End the curve because no step succeeds: with a collapse if blocks were seen to run away.

        Without dynamic states of a failed motion it is no collapse.
        """
        end = End(reason=reason)
        if report.path.dynamic_states and report.dynamic:
            how = say("end.no_rest_found", why=report.reason)
            end = collapsed(how, self._carried(state), self.settings.stop_multiplier)
        shown = _dynamic_multipliers(report)
        return self._decided(state, end, accept=False, dynamic_multipliers=shown)

    def _adapted(self, state: DisplacementState, report: StepReport) -> DisplacementState:
        s = self.settings
        if report.reached < 1.0:  # the step has ended early, where a bond breaks
            least = tolerances.FLOOR_SHARE * s.displacement_step
            increment = max(2.0 * report.reached * state.increment, least)
            increment = min(increment, state.increment) if report.reached else state.increment
            return changed(state, increment=increment, crossing=False, rested_at=0.0)
        scale = self._growth(state, report) if report.n_iterations <= s.grow_iterations else 1.0
        n_since = state.n_since + 1
        if n_since < GROWN_AFTER:
            scale = min(scale, 1.0)  # a longer step has just failed, and would fail again
        increment = min(scale * state.increment, s.displacement_step)
        return changed(state, increment=increment, crossing=False, rested_at=0.0, n_since=n_since)

    def _growth(self, state: DisplacementState, report: StepReport) -> float:
        """Factor for the next increment after few iterations: smaller for a larger bend or
        overshoot."""
        s = self.settings
        if report.path.bend is not None:
            # A bend is proportional to the square of the step.
            most = s.bend_share * self._scale(state)
            bend = max(report.path.bend[0], tolerances.TINY)
            return min(max(math.sqrt(tolerances.BEND_AIM * most / bend), 0.5), 2.0)
        if report.path.overshoot is None:
            return 2.0
        overshoot = report.path.overshoot / self._scale(state)
        if overshoot <= tolerances.SMALL_OVERSHOOT * tolerances.OVERSHOOT_SHARE:
            return 3.0
        return 2.0 if overshoot <= 0.5 * tolerances.OVERSHOOT_SHARE else 1.0

    def _jumping(self, state: DisplacementState, report: StepReport) -> DisplacementState:
        s = self.settings
        if self._is_static(state, report):
            increment = tolerances.CROSSING_LENGTH * tolerances.FLOOR_SHARE * s.displacement_step
            state = changed(state, time_step=0.0, rested_at=state.jump_time, increment=increment)
            return changed(state, too_long=math.inf, n_since=LONG_AGO)
        state = changed(state, acceleration=report.motion / state.time_step**2)
        if state.shortened:
            return changed(state, shortened=False)  # a longer time step has just failed
        longer, n_since = tolerances.JUMP_GROWTH * state.time_step, state.n_since + 1
        if longer >= state.too_long and n_since < RETRIED_AFTER:
            return changed(state, n_since=n_since)
        if report.motion < tolerances.JUMP_MOTION * s.motion_length:
            return changed(state, time_step=longer, n_since=n_since)
        return state

    def _fallen(self, state: DisplacementState, report: StepReport) -> float:
        """How far a block has moved in a jump while the control point was held back [m]."""
        if not state.time_step:
            return 0.0
        held_back = report.dynamic and report.static_multiplier < -self.settings.stop_multiplier
        return state.fallen + (report.motion if held_back else 0.0)

    def _is_static(self, state: DisplacementState, report: StepReport) -> bool:
        """Whether the structure is at rest.

        A jump is over if inertia carries hardly anything, and blocks do not accelerate, as they do
        at the beginning of a jump.  If a jump seemed to be over and was not, the next look comes
        only after a longer time: time steps grow as long as nothing moves by itself.
        """
        if not state.time_step:
            return not report.dynamic
        if state.jump_time < tolerances.LATER * state.rested_at:
            return False
        inertia = max(report.inertia_ratio, report.acceleration)
        before = state.acceleration * state.time_step**2
        return (
            inertia < tolerances.STATIC_INERTIA and report.motion <= tolerances.NO_FASTER * before
        )

    def _over(self, state: DisplacementState, report: StepReport) -> End | None:
        """The end of the curve, or None if it goes on."""
        return self._over_in_motion(state, report) or end_of_curve(
            self.settings, self._progress(state, report)
        )

    def _progress(self, state: DisplacementState, report: StepReport) -> Progress:
        """The figures by which the end of a curve is judged."""
        return Progress(
            multiplier=report.static_multiplier,
            highest=state.highest,
            displacement=report.control_displacement,
            n_steps=state.n_steps,
            static=self._is_static(state, report),
            highest_at=state.highest_at,
            multiplier_falls=report.reached != 0.0 and state.slope <= 0.0,
        )

    def _over_in_motion(self, state: DisplacementState, report: StepReport) -> End | None:
        """The end of a curve whose structure has fallen, or None."""
        s, carried = self.settings, self._carried(state)
        if self._thrown_back(state, report):
            return collapsed(say("end.falls_back"), carried, s.stop_multiplier)
        if self._falls_freely(state, report):
            return fallen_freely(carried, s.stop_multiplier)
        if state.fallen > tolerances.FALL_MOTION * s.motion_length:
            if carries_nothing(s, carried):
                return nothing_carried(s, state.n_steps)
            return fallen_freely(carried, s.stop_multiplier)
        if state.n_jump_steps >= s.jump_steps:
            how = say("end.no_rest", n=s.jump_steps)
            return End(reason=say("end.collapsed", how=how))
        return None


def _dynamic_multipliers(report: StepReport) -> tuple[float, ...]:
    """Multipliers that the curve shows at the dynamic points within a step."""
    return tuple(passed.static_multiplier for _, passed in report.path.dynamic_states)
