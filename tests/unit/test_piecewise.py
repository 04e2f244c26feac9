"""Features of contacts that take turns from solution to solution;
`drystone.statics.plane.plane_step`."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.contact.contacts import KIND, NONE, VERTEX_A, VERTEX_B, Pairs, Slots
from drystone.statics.equations import Accuracy
from drystone.statics.plane.plane_step import KEEP_STEPS, PlaneStep

pytestmark = pytest.mark.kernels

#: Far more than `depth`, what may be told apart [m].
PRESSED = -1e-3


def slots(*kinds: int) -> Slots:
    """One contact a pair that presses, or none."""
    made = Slots.empty(len(kinds), 2)
    made.which[:, KIND] = kinds
    made.gap[:] = np.where(made.kind == NONE, np.inf, PRESSED)
    return made


class Step:
    """As much of `PlaneStep` as is asked for: what was followed, and what is found."""

    update_contacts = PlaneStep.update_contacts

    def __init__(self, n_pairs: int) -> None:
        columns = np.zeros((5, n_pairs), np.int64)
        self.pairs = Pairs.of(columns, np.ones(n_pairs, np.int64), np.zeros((2, 3)))
        self.kept = np.zeros(n_pairs, np.int64)

    def _find(self) -> None:
        self.found = self.detect(self.slots).copied()

    def _follow(self, slots: Slots) -> None:
        self.slots, self.solutions = slots, self.solutions + 1

    def solve(self, start: Slots, detect) -> tuple[Slots, int]:
        """A step from these contacts: those that it ends with, and how often it was solved."""
        self.accuracy = Accuracy(
            tolerance=1e-6, rounding=0.0, sliding_rounding=0.0, coarsest=1.0, depth=1e-12,
            pressed=0.0, farthest=1.0,
        )  # fmt: skip
        self.detect, self.slots, self.solutions = detect, start, 1
        self.before, self.rounds = self.kept.copy(), 0
        self.changes = np.where(self.kept > 0, 2, 0)
        while self.update_contacts():
            pass
        return self.found, self.solutions


def turns(followed: Slots) -> Slots:
    """Of the first pair the other features than were followed, of the second always the same."""
    return slots(NONE if followed.kind[0] == VERTEX_B else VERTEX_B, VERTEX_A)


def test_features_that_agree_are_solved_for_once():
    step = Step(2)
    ended, solutions = step.solve(slots(VERTEX_B, VERTEX_A), lambda _: slots(VERTEX_B, VERTEX_A))
    assert solutions == 1
    assert not step.kept.any()
    assert list(ended.kind) == [VERTEX_B, VERTEX_A]


def test_features_change_and_change_back_and_then_stay():
    step = Step(2)
    ended, solutions = step.solve(slots(VERTEX_B, VERTEX_A), turns)
    assert solutions == 3  # as they were, the others, as they were
    assert list(ended.kind) == [VERTEX_B, VERTEX_A]
    assert list(step.kept) == [KEEP_STEPS, 0]


def test_kept_features_cost_one_solution_a_step_and_are_tried_again_in_the_end():
    step = Step(2)
    ended, _ = step.solve(slots(VERTEX_B, VERTEX_A), turns)
    counts = []
    for _ in range(KEEP_STEPS + 1):
        ended, solutions = step.solve(ended, turns)
        counts.append(solutions)
        assert list(ended.kind) == [VERTEX_B, VERTEX_A]
    assert counts == [1] * KEEP_STEPS + [3]


def test_pairs_beside_one_that_takes_turns_change_as_ever():
    # The second pair is found with a contact once the first has been solved with its own again.
    solved = []

    def detect(followed: Slots) -> Slots:
        solved.append(followed)
        return slots(turns(followed).kind[0], VERTEX_A if len(solved) > 1 else NONE)

    step = Step(2)
    ended, _ = step.solve(slots(VERTEX_B, NONE), detect)
    assert list(ended.kind) == [VERTEX_B, VERTEX_A]
    assert list(step.kept) == [KEEP_STEPS, 0]


def test_features_found_agree_again_and_are_not_kept_any_longer():
    step = Step(2)
    ended, _ = step.solve(slots(VERTEX_B, VERTEX_A), turns)
    step.solve(ended, lambda followed: followed)
    assert not step.kept.any()
