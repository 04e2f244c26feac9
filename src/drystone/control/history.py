"""Cyclic analysis: control displacements are reached one after another, in both senses.

The path from one target displacement to the next is a leg.  In its own sense, a leg is a monotonic
curve.  Reports of the engine are converted into the sense of the leg, and demands are converted
back into the sense of the structure.  So steps adapt, peaks and bends are found, and jumps are
followed as in `control.displacement`.  The last step of a leg ends at its target.  The multiplier
takes the sign that equilibrium requires.  On the return the load may have to hold the structure
back.

The structure may collapse in a leg that leads away from zero: at rest, the multiplier falls from
above the stop value to below it; or moving blocks find no rest.  The curve is then complete.  Its
reason names the leg, and later targets are left out.  On the return towards zero, no multiplier
ends the curve, whatever its sign.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from drystone.common import tolerances
from drystone.common.language import say
from drystone.common.records import changed
from drystone.control.base import Decision, Memory
from drystone.control.displacement import (
    DisplacementControl,
    DisplacementSettings,
    DisplacementState,
)
from drystone.control.ends import End, EndSettings, Progress
from drystone.engines.base import OVERSHOOT_PARTS, Demand, Fold, StepReport

#: Times that a step is shortened to a corner of the path.
MOST_SHORTER = 8


@dataclass(frozen=True, kw_only=True)
class HistorySettings(DisplacementSettings):
    """Settings of the steps, and the targets."""

    targets: tuple[float, ...] = ()  # m, control displacements to reach one after another


@dataclass(frozen=True, kw_only=True)
class Leg:
    """The path to one target displacement."""

    number: int = 0  # index of its target
    begun: float = 0.0  # m, control displacement where it begins
    now: float = 0.0  # m, control displacement of the last point
    largest: float = 0.0  # absolute value of the multiplier so far, in all legs

    def sense(self, targets: tuple[float, ...]) -> float:
        """Sign of its motion, 1 or -1."""
        return 1.0 if targets[self.number] >= self.begun else -1.0

    def left(self, targets: tuple[float, ...]) -> float:
        """Distance to its target [m]; negative beyond it."""
        return self.sense(targets) * (targets[self.number] - self.now)

    def at(self, report: StepReport, multiplier: float) -> Leg:
        """The leg after a new point, by a report and a multiplier in the structure's sense."""
        largest = max(self.largest, abs(multiplier))
        return changed(self, now=report.control_displacement, largest=largest)

    def next(self) -> Leg:
        """The leg that begins where this one ends."""
        return changed(self, number=self.number + 1, begun=self.now)

    def named(self, targets: tuple[float, ...]) -> str:
        """A phrase that names the leg, for messages."""
        target = f"{targets[self.number]:.4g}"
        return str(say("end.leg", k=self.number + 1, n=len(targets), target=target))


def seen(report: StepReport, sense: float) -> StepReport:
    """A report with displacements and multipliers in the sense 1 or -1.  Two conversions give the
    report itself."""
    if sense > 0.0:
        return report
    fold, way = report.path.fold, report.path.dynamic_states
    path = changed(
        report.path,
        fold=None if fold is None else Fold(fold.share, -fold.multiplier, -fold.drop),
        dynamic_states=tuple((state, seen(passed, sense)) for state, passed in way),
    )
    return changed(
        report,
        applied_multiplier=-report.applied_multiplier,
        carried_multiplier=-report.carried_multiplier,
        static_multiplier=-report.static_multiplier,
        multiplier_at_start=-report.multiplier_at_start,
        control_displacement=-report.control_displacement,
        path=path,
    )


def told(decision: Decision[Memory], sense: float) -> Decision[Memory]:
    """A decision with multipliers converted back from the sense of a leg to the structure's."""
    if sense > 0.0:
        return decision
    return changed(
        decision,
        load_multiplier=0.0 - decision.load_multiplier,
        dynamic_multipliers=tuple(-multiplier for multiplier in decision.dynamic_multipliers),
    )


def over_in_leg(settings: EndSettings, progress: Progress) -> End | None:
    """The end of the curve before the target of a leg is reached, or None; for legs after the
    first, with a progress in the sense of the leg."""
    s, p = settings, progress
    onwards = p.may_end(max(p.highest_at, 0.0))
    stop_value = s.stop_after(p.highest)
    if onwards and p.multiplier < stop_value < p.highest:
        return End(reason=say("end.fell_below", stop=stop_value), finished=True)
    for stop, value in s.stops:
        if end := stop.end(value, p):
            return end
    return None


class InLegs:
    """Mixin for a strategy that works in the sense of a leg.  It converts decisions into the sense
    of the structure, and begins the next leg where one ends.

    ``_anew`` are the fields of the state that are reset at each point.  ``_near`` is the largest
    distance [m] from the target at which a leg may end.  ``_turned`` makes the state with which a
    leg begins if the motion reverses, under the multiplier ``last`` in the sense of that leg.
    """

    settings: Any
    _demand: Callable[[Any], Demand]
    _turned: Callable[[Any, Leg, float, float], Any]
    _anew: ClassVar[Mapping[str, Any]] = {}
    at_target = tolerances.AT_TARGET

    def _near(self, report: StepReport) -> float:
        return float(self.at_target * self.settings.displacement_step)

    def _in_leg(self, leg: Leg, report: StepReport, decision: Decision[Any]) -> Decision[Any]:
        """The decision to continue the leg, to begin the next one, or to end the analysis, from one
        in the sense of the leg."""
        targets = self.settings.targets
        sense = leg.sense(targets)
        decision = told(decision, sense)
        if decision.demand is None:
            how = say("end.in_leg", how=decision.reason, leg=leg.named(targets))
            return changed(decision, reason=how)
        if not decision.accept:
            return decision
        leg = leg.at(report, decision.load_multiplier)
        state = changed(decision.state, leg=leg, **self._anew)
        if leg.left(targets) <= self._near(report):
            if leg.number + 1 == len(targets):
                how = say("end.history", n=len(targets))
                return changed(decision, state=state, demand=None, reason=how, finished=True)
            leg = leg.next()
            back = leg.sense(targets)
            state = changed(state, leg=leg)
            if back != sense:
                state = self._turned(state, leg, back, back * decision.load_multiplier)
        return changed(decision, state=state, demand=self._demand(state))


@dataclass(frozen=True, kw_only=True)
class HistoryState(DisplacementState):
    """The state within a leg, in the sense of the leg, and the leg."""

    leg: Leg = field(default_factory=Leg)
    #: Motion of the control point in the last step, over that demanded: an engine that drives the
    #: structure comes only near.
    gain: float = 1.0
    #: 1/m, slope of the curve before the motion turned, until a step has been taken back.
    before_turn: float | None = None


class HistoryControl(InLegs, DisplacementControl):
    """The strategy of the module's text."""

    settings: HistorySettings

    def _begun(self, increment: float, closing: float) -> DisplacementState:
        return HistoryState(increment=increment, closing=closing)

    def _demand(self, state: DisplacementState) -> Demand:
        """The demand in the structure's sense, no farther than to the target of the leg."""
        assert isinstance(state, HistoryState)
        demand, targets = super()._demand(state), self.settings.targets
        if demand.increment is None:
            return demand
        left = max(state.leg.left(targets), 0.0) / state.gain
        if abs(state.gain - 1.0) > tolerances.SHORT_OF_TARGET:  # it is known from the last step
            left *= 1.0 - tolerances.SHORT_OF_TARGET
        increment = min(demand.increment, left)
        return changed(demand, increment=state.leg.sense(targets) * increment)

    def decide(
        self, state: DisplacementState, demand: Demand, report: StepReport
    ) -> Decision[DisplacementState]:
        """Decide as for a monotonic curve, in the sense of the leg; at its end begin the next."""
        assert isinstance(state, HistoryState)
        sense = state.leg.sense(self.settings.targets)
        decision = super().decide(state, demand, seen(report, sense))
        if decision.accept and decision.demand is not None and demand.increment:
            went = (report.control_displacement - state.leg.now) / demand.increment
            gain = min(max(went, tolerances.LEAST_GAIN), 1.0 / tolerances.LEAST_GAIN)
            decision = changed(decision, state=changed(decision.state, gain=gain))
        return self._in_leg(state.leg, report, decision)

    def _near(self, report: StepReport) -> float:
        """Nearer to a target the end of a step is noise, for an engine that moves through it."""
        moves = report.path.overshoot is not None
        share = tolerances.AT_TARGET_OF_EXCESS if moves else tolerances.AT_TARGET
        return share * self.settings.displacement_step

    def _adapted(self, state: DisplacementState, report: StepReport) -> DisplacementState:
        """As for a monotonic curve.  If the first step back goes on along the curve, nothing sticks
        at the target, and steps need not grow from so short a one."""
        assert isinstance(state, HistoryState)
        s = self.settings
        found = super()._adapted(state, report)
        if state.before_turn is None:
            return found
        increment, bend = found.increment, (state.slope - state.before_turn) * state.increment
        if abs(bend) <= s.bend_share * self._scale(state):
            increment = max(increment, tolerances.FIRST_SHARE * s.displacement_step)
        return changed(found, increment=increment, before_turn=None)

    def _turned(self, state: HistoryState, leg: Leg, sense: float, last: float) -> HistoryState:
        s = self.settings
        return HistoryState(
            # Joints that slid at the target stick as soon as the motion turns.  A step as long as
            # the first of all would round off this corner of the loop.
            increment=tolerances.FIRST_SHARE * min(s.displacement_step, state.closing),
            highest=max(last, 0.0),
            highest_at=-math.inf,
            last=last,
            displacement=sense * leg.begun,
            n_steps=state.n_steps,
            closing=state.closing,
            leg=leg,
            gain=state.gain,
            before_turn=state.slope,
        )

    def _finer(self, state: DisplacementState, report: StepReport) -> float | None:
        """As for a monotonic curve.  In addition, steps end at corners of the path, however short
        they are: a corner, where a contact suddenly sticks again, bounds the area of a loop."""
        finer = super()._finer(state, report)
        if finer is not None:
            return finer
        s = self.settings
        if report.path.bend is not None:
            bend, share = report.path.bend
        else:  # as if the curve went on with its last slope, and then level
            ahead = state.slope * state.increment
            bend = ahead - (report.static_multiplier - state.last)
            if (rise := self._before_rise(state, report, -bend)) is not None:
                return rise
            share = 1.0 - bend / ahead if ahead > 0.0 else 0.0
        finest = tolerances.REFINED_SHARE * state.closing
        hidden = bend > s.bend_share * self._scale(state) and state.n_shorter < MOST_SHORTER
        if hidden and finest < share * state.increment < state.increment - finest:
            return share * state.increment
        return None

    def _before_rise(
        self, state: DisplacementState, report: StepReport, above: float
    ) -> float | None:
        """A smaller increment [m] that ends where the multiplier rises within a step, or None.

        ``above`` is its rise above that with the last slope.  So it rises where a block that rocks
        back lands on its other corner: a step that hides this cuts off a part of the loop.
        """
        s, share = self.settings, report.path.rise
        hidden = above / (self._scale(state) * s.bend_share)
        if report.path.overshoot is None or hidden <= 1.0 or state.n_shorter >= MOST_SHORTER:
            return None
        if share is None:  # it rises all along, and a parabola leaves its tangent by four times
            if hidden <= 4.0:  # what it leaves its chord by
                return None
            share = 0.5
        nearer = max(share, 1.0 / OVERSHOOT_PARTS) * state.increment
        return nearer if nearer > tolerances.CLOSING_SHARE * state.closing else None

    def _scale(self, state: DisplacementState) -> float:
        return max(super()._scale(state), self._carried(state))

    def _carried(self, state: DisplacementState) -> float:
        """The highest multiplier that the structure has carried in all legs, whatever its sign."""
        assert isinstance(state, HistoryState)
        return max(state.highest, state.leg.largest)

    def _load_grows_on(self, state: DisplacementState) -> bool:
        return False  # under a larger load the control point might return, which no target asks for

    def _thrown_back(self, state: DisplacementState, report: StepReport) -> bool:
        return False  # the control point is where the targets put it

    def _falls_freely(self, state: DisplacementState, report: StepReport) -> bool:
        return report.control_displacement > 0.0 and super()._falls_freely(state, report)

    def _fallen(self, state: DisplacementState, report: StepReport) -> float:
        return super()._fallen(state, report) if report.control_displacement > 0.0 else 0.0

    def _over(self, state: DisplacementState, report: StepReport) -> End | None:
        assert isinstance(state, HistoryState)
        if state.leg.number == 0:
            return super()._over(state, report)
        return self._over_in_motion(state, report) or over_in_leg(
            self.settings, self._progress(state, report)
        )
