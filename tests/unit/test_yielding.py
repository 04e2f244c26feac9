"""Joints that are torn and crushed: pieces of their law, and what solvers make of them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from test_interior import KN, KT, centred, contacts

from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    PULL,
    ROOM,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.contact.rows import MEASURED, OF_GAP, OF_SLIP
from drystone.law import branches, pieces
from drystone.law import interior as interior_law
from drystone.law import plane as plane_law
from drystone.law.branches import BACKWARD, CRUSHED, FORWARD, OPEN, STICKING, TORN, both
from drystone.law.columns import N_RESPONSE, NN, NT, RN, TN, TT
from drystone.law.interior import CAP, D_TRIAL_N, N_CHANGE, N_INNER, V
from drystone.statics.plane import interior_kernels as interior

pytestmark = pytest.mark.kernels

ROOM_OF, CRUSH_OF, PULL_OF = 3e3, 800.0, 150.0  # N, beside trial reactions of 1e3 and 1e4


def yielding_contacts(n, **options):
    packed, n, branch = contacts(n, **options)
    table = packed.table
    table[:, ROOM], table[:, CRUSH], table[:, PULL] = ROOM_OF, CRUSH_OF, PULL_OF
    return packed, n, branch


def closed(tn, tt, mu):
    """Reactions from the tension on: each clipped, friction by the clipped pressure."""
    rn = np.clip(tn, 0.0, CRUSH_OF)
    most = mu * rn + ROOM_OF
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
        assert pieces.landing(table, c, OPEN) == now
    assert len(seen) == 9


@pytest.mark.parametrize("room", [ROOM_OF, 0.0])
def test_a_branch_ends_where_the_law_changes(room):
    """Up to the distance told the reactions are linear, and right beyond it in the branch told."""
    packed, n, _ = yielding_contacts(200)
    table, random, changed = packed.table, np.random.default_rng(3), 0
    table[:, ROOM] = room
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


@pytest.mark.parametrize("barrier", [1e-16, 1e-6, 1.0])
def test_central_contacts(barrier):
    every = yielding_contacts(300)
    table, v = every[0].table, centred(every, barrier)
    rn, rt, w, p, q, near, far, crushed, cap = v.T
    tn, tt, mu = table[:, TRIAL_N], table[:, TRIAL_T], table[:, FRICTION]
    np.testing.assert_allclose(rn - w + crushed, tn, atol=1e-9 * np.abs(tn).max())
    np.testing.assert_allclose(rt + p - q, tt, atol=1e-7 * np.abs(tt).max())
    np.testing.assert_allclose(cap * crushed, KN * barrier, rtol=1e-9)
    np.testing.assert_allclose(rn * w, KN * barrier, rtol=1e-9)
    if barrier < 1e-10:
        return  # rooms are those that the products leave, beyond what shear is known to
    most = mu * rn + ROOM_OF
    np.testing.assert_allclose(near, most - rt, atol=1e-8 * np.abs(tt).max())
    np.testing.assert_allclose(far, most + rt, atol=1e-8 * np.abs(tt).max())


def test_without_a_barrier_the_branches_are_those_of_the_law():
    packed, n, branch = every = yielding_contacts(500)
    interior_law.choose(packed, n, centred(every, 1e-24), branch)
    expected = [plane_law.branch_of(packed.table, c, OPEN) for c in range(n)]
    assert branch.tolist() == expected


@pytest.mark.parametrize("mu", [0.0, 0.65])
def test_response_is_the_derivative_of_central_reactions(mu):
    every = yielding_contacts(100, mu=mu)
    table, barrier = every[0].table, 1e-3
    response = np.zeros((100, N_RESPONSE))
    energy = interior_law.respond_within(*every, centred(every, barrier), response)
    assert energy == pytest.approx(barrier, rel=1e-6)
    for trial, columns, step in (
        (TRIAL_N, [NN, TN], 1e-3),
        (TRIAL_T, [NT, TT], 1e-1),
    ):
        there = table[:, trial].copy()
        table[:, trial] = there + step
        ahead = centred(every, barrier)[:, :2]
        table[:, trial] = there - step
        behind = centred(every, barrier)[:, :2]
        table[:, trial] = there
        # Shear is found to 1e-12 of the friction, over steps of 1e-3 N.
        np.testing.assert_allclose(
            response[:, columns], (ahead - behind) / (2.0 * step), rtol=1e-4, atol=1e-5
        )


@pytest.mark.parametrize("second", [False, True])
def test_directions_solve_the_equations_linearised(second):
    """A full step leaves of the product of crushing what is of second order, and nothing else."""
    every = yielding_contacts(100)
    table, n = every[0].table, every[1]
    v = centred(every, 1e-2)
    response, b = np.zeros((n, N_RESPONSE)), np.zeros((n, 2))
    change, force = np.zeros((n, N_CHANGE)), np.zeros((2, 3))
    before = interior_law.respond_within(*every, v, response)
    direction = np.random.default_rng(1).normal(size=(2, 3)) * 1e-6
    for again in (False, True)[: 1 + second]:
        interior.offset(*every, v, 1e-3, again, change, response, b, force)
        first = change.copy()
        _, _, by_way, by_square = interior.changes(
            *every, v, 1e-3, again, response, b, direction, change
        )
    moved, d = v + change[:, :N_INNER], change
    tn = table[:, TRIAL_N] + d[:, D_TRIAL_N]
    rn, _, w, *_, crushed, cap = moved.T
    np.testing.assert_allclose(rn, tn + w - crushed, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(rn + cap, v[:, RN] + v[:, CAP], rtol=1e-12)
    one, other = CAP, V
    left = v[:, one] * v[:, other] + d[:, one] * v[:, other] + v[:, one] * d[:, other]
    if second:
        left += first[:, one] * first[:, other]
    np.testing.assert_allclose(left, KN * 1e-3, rtol=1e-6)
    after = interior_law.respond_within(*every, moved, response)
    assert after == pytest.approx(before + by_way + by_square, rel=1e-9)
