"""Steps of structures whose bonds break, for engines that solve for the multiplier of an increment.

A bond that breaks loses its force, and the multiplier drops.  So the curve is a saw-tooth with one
tooth for each break.  The teeth must not depend on the length of steps:

- Bonds stay intact, whatever they carry, while a step is being solved.
- If bonds exceed their strength in a step, the step is repeated with the increment at which the
  first bond reaches its strength.  So the tip of a tooth is a point of the curve.
- The next step has no increment.  The bond breaks, and the equilibrium at the same displacement is
  found.  As long as other bonds then exceed their strength, the weakest one breaks too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.language import say
from drystone.common.tolerances import BOND_TIE, DUE_TOGETHER, LEAST_INCREMENT, SLIGHT
from drystone.contact.contacts import A, B
from drystone.engines.base import StepReport
from drystone.law.bonds import crossing, release, weakest
from drystone.model.ties import Bars

#: A frozen dataclass with `pairs`, `ties`, `reaction` (n_slots, dim) [N], `margin`
#: (n_slots + n_ties,) of the bonds and ties, see `law.bonds`, and `due`: the rows of `margin` at
#: whose limit the step has ended.
State = TypeVar("State", bound=Any)
Solved = tuple[State, StepReport]

#: Reason of a step that fails because its end is far away, where none of the bonds that are near
#: their strength at its start is the first to reach it.
TOO_WEAK = say("end.too_weak")


@dataclass(frozen=True, kw_only=True)
class BondSteps(Generic[State]):
    """The steps of one engine."""

    solve: Callable[[State, float], tuple[State, StepReport]]  # a step of a share of the increment
    broken: Callable[[State, IntArray], State]  # the state without the bonds of some rows
    laws: Array  # table of `law.table`
    weight: Array  # (n,) N, of blocks, to which the force that a bond releases is compared
    near: float  # margin up to which a bond counts as at its strength
    bars: Bars | None = None  # ties, which may break, as bonds do, or yield
    most_trials: int = 20  # for the share at which the first bond reaches its strength

    def advance(self, state: State) -> Solved[State]:
        """Take as much of the increment as the bonds allow, or break the bonds that are due.

        Bonds that release next to nothing, such as those of joints without pressure, break within
        the step.
        """
        if len(state.due):
            return self._break(state, state.due)
        at, reached, parts = state, 0.0, 0
        motion, iterations = 0.0, 0
        passed: tuple[tuple[Any, StepReport], ...] = ()
        report = StepReport(converged=False)
        while True:
            new, found = self._towards(at, 1.0 - reached)
            passed += found.path.dynamic_states
            if not found.converged:
                return state, replace(found, path=replace(found.path, dynamic_states=passed))
            if found.reached > 0.0:
                parts, report = parts + 1, found
                motion, iterations = motion + found.motion, iterations + found.n_iterations
            reached = reached + found.reached if len(new.due) else 1.0
            if not len(new.due):
                break
            if self._yields(new):
                at = new = self.broken(new, new.due)
                if reached > 0.0:
                    break
                continue
            if self._released(new) > SLIGHT:
                if reached == 0.0:
                    return self._break(new, new.due)
                break
            at = self.broken(new, new.due)
        path = replace(report.path, dynamic_states=passed)
        if parts > 1:  # the path is known in the last part only
            path = replace(path, excess=None, bend=None)
        return new, replace(
            report, reached=reached, motion=motion, n_iterations=iterations, path=path
        )

    def _released(self, state: State) -> float:
        """The largest force that a due bond or tie will release, over the weight of the lighter of
        its two blocks."""
        due, n_slots, pairs = state.due, len(state.reaction), state.pairs
        bonds, ties = due[due < n_slots], due[due >= n_slots] - n_slots
        force = release(self.laws, pairs.law_of_slot[bonds], state.reaction[bonds])
        joined = pairs.which[pairs.of_slot[bonds]][:, [A, B]]
        share = float((force / self.weight[joined].min(axis=1)).max(initial=0.0))
        if self.bars is not None and len(ties):
            breaks = ties[self.bars.breaking(state.ties, ties)]
            pulled = np.abs(state.ties.force[breaks])
            lighter = self.weight[self.bars.body[breaks]].min(axis=1)
            share = max(share, float((pulled / lighter).max(initial=0.0)))
        return share

    def _yields(self, state: State) -> bool:
        """Whether the step has ended where ties begin to yield.  There the curve has a corner, and
        no force is released."""
        ties = state.due - len(state.reaction)
        return self.bars is not None and not (
            (ties < 0).any() or self.bars.breaking(state.ties, ties).any()
        )

    def _towards(self, state: State, whole: float) -> Solved[State]:
        """Take a share ``whole`` of the increment, or as much as the first bond allows.

        In the second case the bond is ``due`` in the new state.  `StepReport.reached` is the share
        that was taken.
        """
        beyond, report = self.solve(state, whole)
        if not report.converged or beyond.margin.min(initial=np.inf) >= -BOND_TIE:
            return beyond, replace(report, reached=whole)
        low, high = (0.0, state.margin), (whole, beyond.margin)
        earlier: tuple[float, Array] | None = None  # the former ``low``, if ``low`` moved last
        best = state, StepReport(converged=True, reached=0.0)
        for trial in range(self.most_trials):
            share = self._share(earlier, low, high, halve=trial % 4 == 3)
            if share <= LEAST_INCREMENT:
                break
            new, report = self.solve(state, share)
            if not report.converged:
                return state, report
            worst = new.margin.min()
            if worst < -BOND_TIE:
                high, earlier = (share, new.margin), None
                continue
            earlier, low, best = low, (share, new.margin), (new, replace(report, reached=share))
            if worst <= self.near:
                break
        new, report = best
        if report.reached == 0.0 and new.margin.min() > self.near:
            # However short the step, it leads to a place where bonds exceed their strength.
            return state, StepReport(converged=False, reason=TOO_WEAK)
        return replace(new, due=self._first(new.margin)), report

    def _share(
        self,
        earlier: tuple[float, Array] | None,
        low: tuple[float, Array],
        high: tuple[float, Array],
        *,
        halve: bool,
    ) -> float:
        """The share of the step to try next, between ``low`` and ``high``.

        A margin far beyond the strength tells little about where the strength is reached.  So two
        margins before the strength are extrapolated, if there are two.  Every fourth trial halves
        the range.
        """
        if earlier is not None:
            share = self._crossing(earlier, low)
            if low[0] < share < high[0]:
                return share
        share = self._crossing(low, high)
        if halve or not low[0] <= share < high[0]:
            return float(np.sqrt(low[0] * high[0])) if low[0] else 0.5 * high[0]
        return share

    def _crossing(self, first: tuple[float, Array], second: tuple[float, Array]) -> float:
        (one, before), (two, after) = first, second
        if len(before) != len(after):  # the list of contacts has changed
            before, after = before.min(keepdims=True), after.min(keepdims=True)
        return crossing(one, before, two, after, 0.5 * self.near)

    def _first(self, margin: Array) -> IntArray:
        """Rows of the bonds that reach their strength nearly together."""
        return np.flatnonzero(margin <= margin.min() + DUE_TOGETHER * self.near)

    def _break(self, state: State, due: IntArray) -> Solved[State]:
        """Break the bonds that are ``due``, and those that are then overloaded, at the same
        displacement."""
        new, report = self.remainder(self.broken(state, due), 0.0)
        return (new if report.converged else state), replace(report, reached=0.0)

    def remainder(self, state: State, share: float) -> Solved[State]:
        """Take a step of a share of the increment.  As long as bonds exceed their strength, break
        the weakest and take a further step from its end."""
        new, report = self.solve(state, share)
        motion, iterations, passed = report.motion, report.n_iterations, report.path.dynamic_states
        while report.converged and len(due := weakest(new.margin)):
            new, report = self.solve(self.broken(new, due), share)
            motion, iterations = motion + report.motion, iterations + report.n_iterations
            passed += report.path.dynamic_states
        path = replace(report.path, dynamic_states=passed)
        return new, replace(report, motion=motion, n_iterations=iterations, path=path)

    def again(self, state: State) -> Solved[State]:
        """Take a step in time.  It is repeated without the bonds that break in it, until none
        breaks."""
        begin = self.broken(state, state.due)
        for _ in range(len(state.margin) + 1):
            new, report = self.solve(begin, 1.0)
            due = weakest(new.margin) if report.converged else new.due
            if not report.converged or not len(due):
                return (new if report.converged else state), report
            begin = self.broken(begin, due)
        return state, StepReport(converged=False, reason=say("end.bonds_break"))
