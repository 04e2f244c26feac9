"""Cyclic analysis by engines that step under a given multiplier.

Each leg applies an excess over the static multiplier, as in `control.excess`, in the sense of the
leg.  `control.history` says what a leg is and what ends it.  The multiplier may have either sign:
if blocks would fall back, the load holds them, and each step reduces the load by the excess.

How far a step leads is known only at its end.  A step that leads beyond the target of its leg is
repeated with a smaller excess, found by the rule of false position, until it ends at the target.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from drystone.common import tolerances
from drystone.common.records import changed
from drystone.control.base import Decision
from drystone.control.ends import End
from drystone.control.excess import ExcessControl, ExcessSettings, ExcessState
from drystone.control.history import InLegs, Leg, over_in_leg, seen
from drystone.engines.base import Demand, StepReport

#: Trials of the excess with which a step ends at the target.
MOST_TRIES = 30


@dataclass(frozen=True, kw_only=True)
class ExcessHistorySettings(ExcessSettings):
    """Settings of the steps, and the targets."""

    targets: tuple[float, ...] = ()  # m, control displacements to reach one after another


@dataclass(frozen=True, kw_only=True)
class ExcessHistoryState(ExcessState):
    """The state within a leg, in the sense of the leg; the leg; and the trials from its last
    point."""

    leg: Leg = field(default_factory=Leg)
    tries: int = 0
    #: The excess and the distance left to the target [m], of the largest excess that fell short of
    #: the target, and of the smallest that led beyond it.
    short: tuple[float, float] = (0.0, math.inf)
    beyond: tuple[float, float] = (math.inf, 0.0)


class ExcessHistoryControl(InLegs, ExcessControl):
    """The strategy of the module's text."""

    settings: ExcessHistorySettings
    at_target = tolerances.AT_TARGET_OF_EXCESS
    _anew: ClassVar[Mapping[str, Any]] = {
        "tries": 0, "short": ExcessHistoryState.short, "beyond": ExcessHistoryState.beyond
    }  # fmt: skip

    def _fresh(self, excess: float, time_step: float) -> ExcessState:
        return ExcessHistoryState(excess=excess, time_step=time_step)

    def _demand(self, state: ExcessState) -> Demand:
        assert isinstance(state, ExcessHistoryState)
        multiplier = state.leg.sense(self.settings.targets) * (state.static + state.excess)
        return Demand(multiplier=multiplier, time_step=state.time_step)

    def decide(
        self, state: ExcessState, demand: Demand, report: StepReport
    ) -> Decision[ExcessState]:
        """Decide as for a monotonic curve, in the sense of the leg; at its end begin the next."""
        assert isinstance(state, ExcessHistoryState)
        if report.converged:
            again = self._again(state, report)
            if again is not None:
                return self._decided(again, accept=False)
        sense = state.leg.sense(self.settings.targets)
        return self._in_leg(state.leg, report, super().decide(state, demand, seen(report, sense)))

    def _again(self, state: ExcessHistoryState, report: StepReport) -> ExcessHistoryState | None:
        """The state with another excess, if a step has not ended at the target but could; None if
        the step is to be taken as it is."""
        s, leg = self.settings, state.leg
        corner = self._corner(state, report)
        if corner is not None:
            return corner
        before = leg.left(s.targets)
        left = changed(leg, now=report.control_displacement).left(s.targets)
        if abs(left) <= self._near(report) or state.tries >= MOST_TRIES:
            return None
        short, beyond = state.short, state.beyond
        if left < 0.0:
            beyond = state.excess, left
        elif beyond[1] < 0.0:
            short = state.excess, left
        else:
            return None
        if math.isinf(short[1]):
            short = 0.0, before
        share = short[1] / (short[1] - beyond[1])
        # If one end of the interval stays, the limits move the trial away from it.
        share = min(max(share, tolerances.LEAST_SHARE_TRIED), 1.0 - tolerances.LEAST_SHARE_TRIED)
        excess = short[0] + share * (beyond[0] - short[0])
        if not short[0] < excess < beyond[0]:
            return None
        return changed(state, excess=excess, tries=state.tries + 1, short=short, beyond=beyond)

    def _corner(self, state: ExcessHistoryState, report: StepReport) -> ExcessHistoryState | None:
        """The state with an excess that leads hardly beyond a corner of the curve, or None.

        There is a corner if the structure moved far with the excess and carries more at the end of
        the step than at its start: up to the corner it hardly moved.  The corner matters because it
        bounds the area of a loop.  It is tried once.
        """
        s, leg = self.settings, state.leg
        sense = leg.sense(s.targets)
        rise = sense * report.static_multiplier - state.static
        far = abs(report.control_displacement - leg.now) > tolerances.CORNER * s.displacement_step
        if state.tries or not far or rise <= tolerances.LEAST_RISE * state.excess:
            return None
        excess = (1.0 + tolerances.LEAST_RISE) * rise
        if not excess < (1.0 - tolerances.LEAST_RISE) * state.excess:
            return None
        return changed(state, excess=excess, tries=1)

    def _largest(self, state: ExcessState) -> float:
        """As for a monotonic curve once the multiplier is positive; before, there is no peak that a
        step could hide."""
        if state.static > 0.0:
            return super()._largest(state)
        return self.settings.increment * max(1.0, -state.static)

    def _turned(
        self, state: ExcessHistoryState, leg: Leg, sense: float, last: float
    ) -> ExcessHistoryState:
        s = self.settings
        return ExcessHistoryState(
            excess=tolerances.FIRST_EXCESS * s.increment,
            time_step=s.time_step,
            static=last,
            highest=max(last, 0.0),
            highest_at=-math.inf,
            displacement=sense * leg.now,
            static_at=sense * leg.now,
            n_steps=state.n_steps,
            leg=leg,
        )

    def _over(self, state: ExcessState, report: StepReport, dynamic: bool) -> End | None:
        assert isinstance(state, ExcessHistoryState)
        if state.leg.number == 0:
            return super()._over(state, report, dynamic)
        outward = report.control_displacement > 0.0
        collapsed = self._collapsed(state, report, dynamic) if outward else None
        return collapsed or over_in_leg(self.settings, self._progress(state, report, dynamic))
