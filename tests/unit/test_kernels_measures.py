"""The sums of a step in one pass are those of whole arrays."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.contact.contacts import NONE, VERTEX_A, VERTEX_B, VERTICES, Slots
from drystone.contact.measures import count_contacts, sum_blocks

pytestmark = pytest.mark.kernels

ROUNDING = 1e-12


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def test_sums_of_blocks(rng):
    n, multiplier, direction = 40, 0.3, np.array([0.6, 0.8])
    x, a, v, contact, dead, pattern = rng.normal(size=(6, n, 3))
    mass = rng.uniform(1.0, 2.0, (n, 3))
    fixed = rng.random(n) < 0.2
    held = rng.random(n) < 0.7
    expected = (
        (contact[fixed, :2] @ direction).sum() - (dead[:, :2] @ direction).sum(),
        np.linalg.norm((mass * a)[:, :2], axis=1).sum(),
        np.linalg.norm(a[:, :2], axis=1).max(),
        0.5 * (mass * v**2).sum(),
        abs(((dead + multiplier * pattern) * x).sum()),
        (pattern * x)[held].sum(),
        np.abs(pattern * x)[held].sum(),
        (mass * a * x)[held].sum(),
        np.abs(pattern * x)[~held].sum(),
    )
    found = sum_blocks(x, a, v, contact, held, dead, pattern, mass, fixed, direction, multiplier)
    assert found == pytest.approx(expected, rel=ROUNDING)


def test_contacts_are_counted_where_there_are_any():
    slots, counts = Slots.empty(5, 2), np.full(3, 9)
    slots.kind[:] = VERTEX_B, VERTEX_A, NONE, VERTICES, VERTEX_B
    slots.gap[:] = -1e-3, 2e-3, np.inf, -2e-3, 0.0
    assert count_contacts(slots, np.array([1, 0, 1, 2, 1]), counts) == 2e-3
    assert counts.tolist() == [1, 2, 1]  # open, sticking, sliding
    assert count_contacts(Slots.empty(0, 2), np.zeros(0, np.int64), counts) == 0.0
    assert not counts.any()
