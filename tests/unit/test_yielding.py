"""Joints that are torn and crushed: pieces of their law, and what solvers make of them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from drystone.contact.contacts import (
    BODY_B,
    CRUSH,
    FRICTION,
    INTERCEPT,
    LIFT,
    PULL,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
    Contacts,
)
from drystone.contact.rows import MEASURED, OF_GAP, OF_SLIP
from drystone.law import branches, pieces
from drystone.law import plane as plane_law
from drystone.law.branches import BACKWARD, CRUSHED, FORWARD, OPEN, STICKING, TORN, both

pytestmark = pytest.mark.kernels

INTERCEPT_OF, CRUSH_OF, PULL_OF = 3e3, 800.0, 150.0  # N, beside trial reactions of 1e3 and 1e4


KN, KT = 2e7, 2e10  # N/m


def contacts(n, *, mu=0.65, dilation=0.0, seed=0):
    """Contacts of two bodies with random trial reactions of all kinds, and their branches."""
    random = np.random.default_rng(seed)
    contacts = Contacts.empty(n, 2, 3)
    contacts.rows[:] = random.normal(size=(n, 3, 6))
    contacts.slot[:], contacts.which[:, BODY_B] = np.arange(n), 1
    table = contacts.table
    table[:, STIFF_N], table[:, STIFF_T] = KN, KT
    table[:, FRICTION], table[:, LIFT] = mu, KN * dilation
    table[:, TRIAL_N] = random.normal(size=n) * 1e3
    table[:, TRIAL_T] = random.normal(size=n) * 1e4
    return contacts, n, np.full(n, STICKING)


def yielding_contacts(n, **options):
    packed, n, branch = contacts(n, **options)
    table = packed.table
    table[:, INTERCEPT], table[:, CRUSH], table[:, PULL] = INTERCEPT_OF, CRUSH_OF, PULL_OF
    return packed, n, branch


def closed(tn, tt, mu):
    """Reactions from the tension on: each clipped, friction by the clipped pressure."""
    rn = np.clip(tn, 0.0, CRUSH_OF)
    most = mu * rn + INTERCEPT_OF
    return rn, np.clip(tt, -most, most)


def test_branches_and_reactions_are_those_of_the_clipped_law():
    packed, n, _ = yielding_contacts(500)
    table, seen = packed.table, set()
    for c in range(n):
        now = plane_law.branch_of(table, c, OPEN)
        seen.add(now)
        rn, rt, slid = plane_law.reactions(table, c, now)
        tn, tt, mu = table[c, TRIAL_N], table[c, TRIAL_T], table[c, FRICTION]
        expected = closed(tn, tt, mu)
        assert (rn + PULL_OF, rt) == pytest.approx(expected, rel=1e-12, abs=1e-9)
        assert slid == pytest.approx(abs(tt - expected[1]) / KT, rel=1e-9, abs=1e-18)
    assert len(seen) == 9


@pytest.mark.parametrize("intercept", [INTERCEPT_OF, 0.0])
def test_a_branch_ends_where_the_law_changes(intercept):
    """Up to the distance told the reactions are linear, and right beyond it in the branch told."""
    packed, n, _ = yielding_contacts(200)
    table, random, changed = packed.table, np.random.default_rng(3), 0
    table[:, INTERCEPT] = intercept
    for c in range(n):
        rate_n, rate_t = random.normal(size=2) * (1e3, 1e4)
        now = plane_law.branch_of(table, c, OPEN)
        far, following = pieces.distance(table, c, now, rate_n, rate_t, True)
        start = table[c, [TRIAL_N, TRIAL_T]].copy()
        for share in (0.5, 1.0 - 1e-6):
            table[c, [TRIAL_N, TRIAL_T]] = start + share * min(far, 10.0) * np.array(
                [rate_n, rate_t]
            )
            assert plane_law.branch_of(table, c, now) == now
        if not np.isfinite(far):
            continue
        changed += 1
        table[c, [TRIAL_N, TRIAL_T]] = start + (1.0 + 1e-6) * far * np.array([rate_n, rate_t])
        assert plane_law.branch_of(table, c, OPEN) == following
    assert changed > 100


def response_of(table, c, branch):
    """Derivatives of both reactions by both trial ones, (2, 2)."""
    sign, t = branches.sense(branch), branches.along_joint(branch)
    normal = float(branch in (STICKING, FORWARD, BACKWARD))
    return np.array([[normal, 0.0], [sign * table[c, FRICTION] * normal, float(t == STICKING)]])


def test_changes_of_the_matrix():
    """u v^T is the difference of the contact's stiffness in both branches."""
    packed, _, _ = yielding_contacts(1)
    table, rows = packed.table, packed.rows
    along = (STICKING, FORWARD, BACKWARD)
    pairs = [
        (both(state, x), both(state, y))
        for state in (TORN, CRUSHED)
        for x in along[:1]
        for y in along
    ]
    pairs += [(x, both(state, x)) for state in (TORN, CRUSHED) for x in along]
    stiffness = np.diag([table[0, STIFF_N], table[0, STIFF_T]])
    forces, measured = rows[0, [OF_GAP, OF_SLIP]], rows[0, [OF_GAP, MEASURED]]
    for pair in pairs:
        for before, after in itertools.permutations(pair) if pair[0] != pair[1] else ():
            u, v = np.zeros(6), np.zeros((1, 1, 6))
            pieces.change(table, rows, 0, before, after, u, v, 0)
            by_trial = response_of(table, 0, after) - response_of(table, 0, before)
            expected = forces.T @ by_trial @ stiffness @ measured
            np.testing.assert_allclose(np.outer(u, v[0, 0]), expected, rtol=1e-12, atol=1e-3)
