"""The published strategy: section 2 and the flowchart of Bouckaert, Godio and de Almeida (2022).

The paper can be read in several ways.  Here it is read as follows:

- Multipliers are *equal* if they differ by no more than ``balance_tolerance``.
- While applied and carried multipliers differ, the same multiplier is applied again.  A structure
  is past its peak if their difference has not shrunk by a tenth within ``patience`` steps, or if it
  carries a tenth less than before, because it falls.  Taken literally, the flowchart takes the
  first loaded step for the peak, because the carried multiplier lags behind.
- Blocks are stopped at every step, on the ascending branch too.  Otherwise the wall runs away while
  the multiplier waits for balance.
- The paper's time step is constant.  Here it adapts on the descending branch to a displacement
  per step.  The fixed point of the recursion does not depend on it.
- The analysis ends at a multiplier below ``stop_multiplier`` only on the descending branch, and
  only if the structure moves on under it without help by inertia.  A structure that stands still
  under it is loaded again, at points that do not belong to the branch.  A structure that falls on
  for long has collapsed in motion.

The load multiplier of the curve is the applied one, as in the paper's figures.  It is biased; see
the page on theory.  The bias of the descent, several times ``overshoot - 1``, must not count as a
part of the peak.  So points whose applied multiplier exceeds all those ever carried in balance are
marked dynamic.
"""

from __future__ import annotations

from dataclasses import dataclass

from drystone.common import tolerances
from drystone.common.records import changed
from drystone.control.base import Decision, Strategy, check_settings
from drystone.control.ends import End, Progress, StepSettings, end_of_curve, fallen_freely
from drystone.engines.base import Demand, StepReport


@dataclass(frozen=True, kw_only=True)
class PublishedSettings(StepSettings):
    """Settings of the published strategy.  The displacement step is that of the fastest block in a
    step of the descending branch."""

    increment: float = tolerances.PUBLISHED_INCREMENT  # of the multiplier, ascending
    overshoot: float = tolerances.OVERSHOOT  # applied over carried multiplier, descending
    # Difference of multipliers that counts as equal.
    balance_tolerance: float = tolerances.BALANCE_TOLERANCE
    patience: int = 20  # steps without balance, nor progress towards it, after the peak is passed
    time_step: float = tolerances.PUBLISHED_TIME_STEP  # s, ascending, and at first descending

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, kw_only=True)
class _State:
    multiplier: float
    descending: bool = False
    highest: float = 0.0  # highest multiplier that was applied and carried in balance so far
    waited: int = 0  # steps since balance, or since the difference last shrank by a tenth
    missing: float = float("inf")  # difference of applied and carried when it last shrank so
    carried: float = 0.0  # highest carried multiplier so far
    time_step: float = 0.0  # s
    displacement: float = 0.0  # m, control displacement of the last point
    fallen: float = 0.0  # m, motion of a block under next to no load
    n_steps: int = 0


class PublishedControl(Strategy[_State]):
    """The strategy of the module's text."""

    settings: PublishedSettings

    def first(self, report: StepReport) -> Decision[_State]:
        """Demand the first increment of the multiplier."""
        s = self.settings
        return self._decided(_State(multiplier=s.increment, time_step=s.time_step))

    def _demand(self, state: _State) -> Demand:
        return Demand(multiplier=state.multiplier, time_step=state.time_step)

    def decide(self, state: _State, demand: Demand, report: StepReport) -> Decision[_State]:
        """Ascend by increments, descend by the recursion on the carried multiplier."""
        decision = self._decide(state, demand, report)
        applied = report.applied_multiplier
        # A multiplier above all those carried in balance moves the structure, and is no peak.
        beyond = decision.accept and applied > decision.state.highest
        low = state.descending and applied < self.settings.stop_after(state.highest)
        stands = low and not self._goes_on(state, report)
        # The strategy's own measure of rest: the applied multiplier is carried.
        missing = abs(applied - report.carried_multiplier)
        moves = report.dynamic and missing > self.settings.balance_tolerance
        dynamic = moves or beyond or stands
        return changed(decision, load_multiplier=applied, dynamic=dynamic)

    def _decide(self, state: _State, demand: Demand, report: StepReport) -> Decision[_State]:
        s = self.settings
        too_far = (
            report.converged and state.descending and report.motion > 2.0 * s.displacement_step
        )
        if not report.converged or too_far:
            state = changed(state, time_step=0.5 * state.time_step)
            if state.time_step < tolerances.LEAST_PUBLISHED_TIME_STEP * s.time_step:
                return self._decided(state, End(reason=report.reason), accept=False)
            return self._decided(state, accept=False)
        state = changed(state, n_steps=state.n_steps + 1)
        if not state.descending:
            state = self._ascend(state, report)
        state = changed(state, fallen=self._fallen(state, report))
        end = self._end(state, report)
        state = changed(state, displacement=report.control_displacement)
        if end:
            return self._decided(state, end)
        if not state.descending:
            return self._decided(changed(state, time_step=s.time_step))
        least = 0.5 * tolerances.NEXT_TO_NOTHING * min(s.stop_multiplier, state.highest)
        multiplier = max(s.overshoot * report.carried_multiplier, least)
        share = s.displacement_step / max(
            report.motion, tolerances.LEAST_MOTION * s.displacement_step
        )
        scale = min(max(share**0.5, tolerances.LEAST_CHANGE), tolerances.MOST_CHANGE)
        state = changed(state, multiplier=multiplier, time_step=state.time_step * scale)
        return self._decided(state)

    def _ascend(self, state: _State, report: StepReport) -> _State:
        """Increase the multiplier if the applied one is carried; if it is not carried for too long,
        the peak is passed."""
        s, applied = self.settings, report.applied_multiplier
        carried = max(state.carried, report.carried_multiplier)
        missing = abs(applied - report.carried_multiplier)
        if missing <= s.balance_tolerance:
            return changed(
                state,
                multiplier=state.multiplier + s.increment,
                waited=0,
                missing=float("inf"),
                carried=carried,
                highest=max(state.highest, applied),
            )
        if missing < (1.0 - tolerances.SHRUNK) * state.missing:
            state = changed(state, missing=missing, waited=0)
        waited = state.waited + 1
        falls = (
            report.carried_multiplier < (1.0 - tolerances.FALLEN_BY) * carried - s.balance_tolerance
        )
        return changed(
            state, waited=waited, carried=carried, descending=falls or waited > s.patience
        )

    def _goes_on(self, state: _State, report: StepReport) -> bool:
        """Whether the structure moves on, by more than its joints deform elastically."""
        moves = report.motion > tolerances.GOES_ON * self.settings.displacement_step
        return moves and report.control_displacement > state.displacement

    def _steady(self, state: _State, report: StepReport) -> bool:
        """Whether inertia carries no more of the applied multiplier than the recursion implies.

        This is twice the overshoot, and a share `tolerances.LAG` of the peak, by which the branch
        may fall in a step.
        """
        s, applied = self.settings, report.applied_multiplier
        left = 2.0 * (s.overshoot - 1.0) * abs(applied) + tolerances.LAG * state.highest
        return abs(applied - report.carried_multiplier) <= s.balance_tolerance + left

    def _fallen(self, state: _State, report: StepReport) -> float:
        nothing = tolerances.NEXT_TO_NOTHING * min(self.settings.stop_multiplier, state.highest)
        falls = state.descending and report.applied_multiplier < nothing
        return state.fallen + report.motion if falls and not self._steady(state, report) else 0.0

    def _end(self, state: _State, report: StepReport) -> End | None:
        s = self.settings
        if state.fallen > tolerances.FALL_MOTION * s.motion_length:
            return fallen_freely(state.highest, s.stop_multiplier)
        goes_on = state.descending and self._goes_on(state, report)
        return end_of_curve(
            s,
            Progress(
                multiplier=report.applied_multiplier if goes_on else state.highest,
                static=self._steady(state, report),
                highest=state.highest,
                displacement=report.control_displacement,
                n_steps=state.n_steps,
            ),
        )
