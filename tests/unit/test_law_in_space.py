"""The cone of friction in space: impulses of one contact, and the measure that judges reactions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drystone.contact.contacts import FRICTION, N_TABLE, STIFF_N, STIFF_T
from drystone.law.branches import OPEN, STICKING
from drystone.law.impulse import local_impulse, local_impulse_in_space, projected_impulse_in_space
from drystone.law.status import SLIDING
from drystone.law.violation import joint_law_violation

pytestmark = pytest.mark.kernels

#: Angles are found to 1e-9 before the last step of Newton's method, which squares it; where they
#: are found by bisection, to 60 halvings.  The rest is rounding of the blocks' inverses.
ROUNDING = 1e-10


def solved(b, w, compliance, mu):
    impulse = np.zeros(3)
    local_impulse_in_space(*b, w, w[0, 0] + compliance, mu, impulse)
    return impulse


def violation(b, w, compliance, mu, p):
    """How far impulses are from u = W p + b, Signorini's law and Coulomb's, over their size."""
    u = w @ p + b
    u[0] += compliance * p[0]
    size = np.linalg.norm(b) / np.linalg.eigvalsh(w)[0]  # impulse that stops the contact
    speed = np.linalg.norm(b)
    normal = max(-p[0] / size, -u[0] / speed, abs(p[0] * u[0]) / (size * speed))
    shear, slip = np.linalg.norm(p[1:]), np.linalg.norm(u[1:])
    cone = (shear - mu * p[0]) / size
    # What slides has all its friction, against the sliding: p_t |u_t| = -mu p_n u_t.
    against = np.linalg.norm(p[1:] * slip + mu * p[0] * u[1:]) / (size * speed)
    return max(normal, cone, against)


def blocks(rng, coupling=1.0):
    """A Delassus block of a contact at random places of two bodies, as in blocks."""
    rows = rng.normal(size=(3, 12))
    rows[:, 3:6] *= coupling
    rows[:, 9:] *= coupling
    return rows @ rows.T


@settings(deadline=None, max_examples=200)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_impulses_of_one_contact_are_those_of_the_laws(seed, mu, coupling):
    rng = np.random.default_rng(seed)
    w, b = blocks(rng, coupling), rng.normal(size=3)
    compliance = rng.choice([0.0, 1e-3, 1.0])
    p = solved(b, w, compliance, mu)
    assert violation(b, w, compliance, mu, p) < ROUNDING


def test_of_all_impulses_on_the_cone_it_is_the_one_that_fits():
    """Against a search over all directions of friction in steps of 1e-4 rad."""
    rng = np.random.default_rng(5)
    angle = np.arange(0.0, 2.0 * np.pi, 1e-4)
    along = np.column_stack((np.cos(angle), np.sin(angle)))
    for _ in range(20):
        w, b, mu = blocks(rng), rng.normal(size=3), rng.uniform(0.2, 0.9)
        b[0] = -abs(b[0])
        p = solved(b, w, 0.1, mu)
        if np.linalg.norm(p[1:]) < mu * p[0] * (1.0 - 1e-9):
            continue  # sticks
        normal = -b[0] / (w[0, 0] + 0.1 + mu * along @ w[0, 1:])
        slip = normal[:, None] * (w[1:, 0] + mu * along @ w[1:, 1:]) + b[1:]
        across = along[:, 0] * slip[:, 1] - along[:, 1] * slip[:, 0]
        opposed = np.einsum("ij,ij->i", along, slip) < 0.0
        zero = np.flatnonzero((across[:-1] * across[1:] <= 0.0) & opposed[1:] & (normal[1:] > 0.0))
        off = np.abs(along[zero] - p[1:] / (mu * p[0])).max(axis=1)
        assert off.min() < 2e-4


def test_it_is_the_law_of_the_plane_where_nothing_leaves_it():
    rng = np.random.default_rng(1)
    for _ in range(100):
        w, b, mu = blocks(rng), rng.normal(size=3), rng.uniform(0.1, 0.9)
        w[2, :2] = w[:2, 2] = b[2] = 0.0
        p = solved(b, w, 0.2, mu)
        flat = local_impulse(b[0], b[1], w[0, 0] + 0.2, w[0, 1], w[1, 1], mu)
        if abs(abs(flat[1]) - mu * flat[0]) > 1e-12 or w[0, 1] ** 2 < 0.1:
            assert p == pytest.approx((*flat, 0.0), abs=ROUNDING)


def test_turned_tangents_turn_the_impulse():
    rng = np.random.default_rng(2)
    for _ in range(50):
        w, b, a = blocks(rng, 0.3), rng.normal(size=3), rng.uniform(0.0, 2.0 * np.pi)
        turn = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        p = solved(b, w, 0.0, 0.5)
        assert solved(turn @ b, turn @ w @ turn.T, 0.0, 0.5) == pytest.approx(turn @ p, abs=1e-9)


def test_branches_of_a_held_contact():
    assert projected_impulse_in_space(-1.0, 3.0, 4.0, 0.5, False) == (0.0, 0.0, 0.0, OPEN)
    assert projected_impulse_in_space(20.0, 3.0, 4.0, 0.5, False) == (20.0, 3.0, 4.0, STICKING)
    # 0.5 x 4 = 2 of 5 along (3, 4).
    found = projected_impulse_in_space(4.0, 3.0, 4.0, 0.5, False)
    assert found == pytest.approx((4.0, 1.2, 1.6, SLIDING))
    assert projected_impulse_in_space(4.0, 3.0, 4.0, 0.5, True) == (4.0, 3.0, 4.0, STICKING)


class TestMeasure:
    KN, KS, MU = 1e6, 2e6, 0.6

    def of(self, gap, slip, reaction, before):
        table = np.zeros((1, N_TABLE))
        table[0, [STIFF_N, STIFF_T, FRICTION]] = self.KN, self.KS, self.MU
        one = np.ones(1)
        arrays = (np.array([a], float) for a in (slip, reaction, before))
        return joint_law_violation(table, gap * one, *arrays, one, 0.0 * one)

    @given(st.integers(0, 2**32 - 1))
    def test_the_law_itself_leaves_nothing_and_an_error_counts_in_full(self, seed):
        rng = np.random.default_rng(seed)
        gap, slip, before = (
            rng.uniform(-1e-3, 1e-4),
            rng.uniform(-1e-3, 1e-3, 2),
            rng.normal(size=2),
        )
        rn = max(-self.KN * gap, 0.0)
        trial = 300.0 * before - self.KS * slip
        shear = trial * min(1.0, self.MU * rn / np.linalg.norm(trial))
        # Forces of kN, a few roundings.
        assert max(self.of(gap, slip, (rn, *shear), 300.0 * before)) < 1e-9
        wrong = 50.0 * rng.normal(size=2)
        found = self.of(gap, slip, (rn, *(shear + wrong)), 300.0 * before)
        assert found[1] == pytest.approx(np.linalg.norm(wrong), abs=1e-9)

    def test_the_cone_is_round(self):
        # 1000 N x 0.6 against 300 and 600 N: 670.82 N.
        violation = self.of(-1e-3, (0.0, 0.0), (1e3, 300.0, 600.0), (300.0, 600.0))
        assert violation == pytest.approx((0.0, 70.8204, 70.8204), abs=1e-4)

    def test_what_is_no_number_is_not_lost(self):
        for wrong in (np.nan, np.inf):
            assert np.isnan(self.of(-1e-3, (0.0, 0.0), (1e3, 0.0, wrong), (0.0, 0.0))).all()
