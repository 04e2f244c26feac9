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

import numpy as np
from numpy.typing import NDArray

from drystone.contact.strengths import Strengths, difference
from drystone.kernels.law import H_ROOM
from drystone.kernels.yielding import BONDED, CRUSHED, OPEN, STICKING, TORN
from drystone.solvers.piecewise import StepSolution
from drystone.solvers.static_step import StaticStep

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Solutions of a step before it counts as failed.
MOST_SOLUTIONS = 60


def solve(
    step: StaticStep,
    strengths: Strengths,
    history: Array,
    gap: Array,
    branch: IntArray,
    multiplier: float,
    begin: Callable[[Array], None],
    once: Callable[[IntArray], StepSolution],
    tolerance: float,
) -> StepSolution:
    """Solve a step; its equations are left evaluated at the solution, with its history.

    Parameters
    ----------
    step
        The equations.
    strengths
        Of the joints.
    history, gap, branch
        Where the step starts, (n_slots, N_HISTORY), (n_slots,) [m] and (n_slots,).
    multiplier
        Where the step starts.
    begin
        Begins the step with what contacts hold, (n_slots, N_HELD).
    once
        Solves it from the branches (n_slots,).
    tolerance
        Force [N] by which what contacts hold may still change.
    """
    law = step.pairs.law_of_slot
    now = strengths.first(history, gap)
    held, iterations = strengths.held(law, history, now), 0
    first: StepSolution | None = None
    for _ in range(MOST_SOLUTIONS):
        begin(held)
        solved = once(_fitting(branch, held))
        iterations += solved.n_iterations
        solved = replace(solved, n_iterations=iterations)
        if solved.reason:
            return solved
        first = first or solved
        origin = step.origin
        before = np.where((origin >= 0)[:, None], history[origin], step.history_before)
        then = strengths.reached(law, before, step.history, step.slots.gap)
        after = strengths.held(law, before, then)
        area = step.start.size * step.constants.thickness
        if difference(after, step.start.held, step.reaction[:, 0], area) <= tolerance:
            strengths.write(law, then, step.history)
            return replace(solved, excess=_hidden(first, solved, multiplier))
        back = np.full(len(origin), -1)
        back[origin[origin >= 0]] = np.flatnonzero(origin >= 0)
        kept = strengths.held(law, history, now)
        held = np.where((back >= 0)[:, None], after[back], kept)
    return replace(solved, reason="joints do not come to rest as they soften")


def _hidden(
    first: StepSolution, last: StepSolution, multiplier: float
) -> tuple[float, float] | None:
    """By how much the multiplier may exceed both ends within the step, and where, see
    `StepSolution`: no more than with the strengths at its start."""
    if first.excess is None or first.bend is None:
        return None
    highest = max(first.multiplier, multiplier) + max(first.excess[0], 0.0)
    share = first.excess[1] if first.excess[0] > 0.0 else first.bend[1]
    return highest - max(last.multiplier, multiplier), share


def _fitting(branch: IntArray, held: Array) -> IntArray:
    """Branches (n_slots,) that there are with what contacts hold: without room none is torn."""
    room, torn = held[:, H_ROOM] > 0.0, (branch > BONDED) & (branch <= CRUSHED)
    fitting = np.where((branch == OPEN) & room, TORN + STICKING, branch)
    return np.where(torn & ~room, OPEN, fitting)
