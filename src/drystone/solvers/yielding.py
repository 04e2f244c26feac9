"""Steps of structures whose joints soften, are crushed or close hyperbolically.

Within a solution all strengths are constants: those of what contacts have come to where the step
ends (`contact.strengths`).  So a step is solved, what contacts have come to is read off, and it is
solved again with the strengths of that, until these stand.  Strengths at the end, and not at the
start, make the curve independent of how long steps are; beginning with those at the start, they
fall from one solution to the next to the first ones that the structure can have.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from drystone.contact.strengths import Reached, Strengths, difference
from drystone.kernels.contacts import Pairs
from drystone.kernels.law import H_ROOM
from drystone.kernels.yielding import BONDED, CRUSHED, OPEN, STICKING, TORN
from drystone.solvers.piecewise import StepSolution
from drystone.solvers.static_step import Ended

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Shares of what is missing that are gone at a time.
LEAST_SHARE, MOST_SHARE = 0.3, 10.0

#: Solutions of a step before it counts as failed.
MOST_SOLUTIONS = 60


class YieldingStep(Protocol):
    """Equations of a step, of either dimension, as far as strengths follow from them."""

    @property
    def pairs(self) -> Pairs:
        """Those of its slots."""
        ...

    def ended(self) -> Ended:
        """What the solution last evaluated has led to; its `after` is the step's history."""
        ...


class Beginning(NamedTuple):
    """Where a step starts."""

    history: Array  # (n_slots, N_HISTORY + dim - 2)
    gap: Array  # (n_slots,) m
    branch: IntArray  # (n_slots,)
    multiplier: float


def solve(
    step: YieldingStep,
    strengths: Strengths,
    start: Beginning,
    once: Callable[[Array, Array, IntArray], StepSolution],
    tolerance: float,
) -> StepSolution:
    """Solve a step; its equations are left evaluated at the solution, with its history.

    Parameters
    ----------
    step
        The equations.
    strengths
        Of the joints.
    start
        Where the step starts.
    once
        Begins the step with what contacts hold (n_slots, N_HELD), and what those hold that are made
        in it (n_slots, N_HELD), and solves it from the branches (n_slots,).
    tolerance
        Force [N] by which what contacts hold may still change.
    """
    law, history = step.pairs.law_of_slot, start.history
    now = strengths.first(history, start.gap)
    held, iterations = strengths.held(law, history, now), 0
    fresh = strengths.fresh[law]
    first: StepSolution | None = None
    relaxation = _Relaxation(strengths, law)
    for _ in range(MOST_SOLUTIONS):
        solved = once(held, fresh, _fitting(start.branch, held))
        iterations += solved.n_iterations
        solved = replace(solved, n_iterations=iterations)
        if solved.reason:
            return solved
        first = first or solved
        end = step.ended()
        origin = end.origin
        made = (origin < 0)[:, None]
        before = np.where(made, end.before, history[origin])
        then = strengths.reached(law, before, end.after, end.gap)
        after = strengths.held(law, before, then)
        if difference(after, end.held, end.normal, end.area) <= tolerance:
            strengths.write(law, then, end.after)
            return replace(solved, excess=_hidden(first, solved, start.multiplier))
        now = relaxation.next(now, then, origin)
        held, fresh = strengths.held(law, history, now), np.where(made, after, fresh)
    return replace(solved, reason="joints do not come to rest as they soften")


class _Relaxation:
    """What contacts come to, extrapolated from how it changes (Irons and Tuck 1969).

    Where joints soften nearly as fast as the structure lets go, one solution takes a small part of
    the way, and the same part as the one before.
    """

    def __init__(self, strengths: Strengths, law: IntArray) -> None:
        self.scale = strengths.per_slip[law], strengths.by_crushing[law]
        self.share, self.last = 1.0, np.zeros(0)

    def next(self, now: Reached, then: Reached, origin: IntArray) -> Reached:
        """What to go on with, in the slots where the step starts: ``origin`` (n_slots,) of those
        that have come to ``then``."""
        known = origin >= 0
        found = []
        for mine, theirs in zip(now, then, strict=True):
            at = mine.copy()
            at[origin[known]] = theirs[known]
            found.append(at)
        there = Reached(*found)
        per_slip, by_crushing = self.scale
        missing = np.concatenate(
            (
                there.softened - now.softened,
                per_slip * (there.slid - now.slid),
                by_crushing * (there.crushed - now.crushed),
            )
        )
        if len(self.last):
            change = missing - self.last
            size = float(change @ change)
            share = -self.share * float(self.last @ change) / size if size > 0.0 else 1.0
            self.share = min(max(share, LEAST_SHARE), MOST_SHARE)
        self.last = missing
        more = self.share
        return there._replace(
            softened=np.maximum(now.softened + more * (there.softened - now.softened), 0.0),
            slid=now.slid + more * (there.slid - now.slid),
            crushed=np.maximum(now.crushed + more * (there.crushed - now.crushed), 0.0),
        )


def _hidden(
    first: StepSolution, last: StepSolution, multiplier: float
) -> tuple[float, float] | None:
    """By how much the multiplier may exceed both ends within the step, and where, see
    `StepSolution`.

    It is no higher than with the strengths at the start.  Where the way with these is straight, it
    leaves it with the square of what has been gone.
    """
    if first.excess is None or first.bend is None:
        return None
    rise, drop = first.multiplier - multiplier, first.multiplier - last.multiplier
    if abs(first.bend[0]) <= 0.1 * abs(drop) and first.excess[0] <= 0.0:
        if drop <= 0.0 or not 0.0 < rise < 2.0 * drop:
            return 0.0, 0.0
        top = multiplier + 0.25 * rise * rise / drop
        return top - max(last.multiplier, multiplier), 0.5 * rise / drop
    highest = max(first.multiplier, multiplier) + max(first.excess[0], 0.0)
    share = first.excess[1] if first.excess[0] > 0.0 else first.bend[1]
    return highest - max(last.multiplier, multiplier), share


def _fitting(branch: IntArray, held: Array) -> IntArray:
    """Branches (n_slots,) that there are with what contacts hold: without room none is torn."""
    room, torn = held[:, H_ROOM] > 0.0, (branch > BONDED) & (branch <= CRUSHED)
    fitting = np.where((branch == OPEN) & room, TORN + STICKING, branch)
    return np.where(torn & ~room, OPEN, fitting)
