"""The measure that judges every solver is zero for solutions and as large as what is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    BOND,
    FRICTION,
    N_TABLE,
    STIFF_N,
    STIFF_T,
    TENSILE,
    Contacts,
)
from drystone.law.residual import add_contact_forces, mark_touched, unbalanced_force
from drystone.law.violation import joint_law_violation

pytestmark = pytest.mark.kernels

KN, MU = 1e6, 0.65  # N/m, -
# A few rounding errors of forces of kN.
ROUNDING = 1e-9  # N


def law_residual(gap, slip, reaction, *, before=None, shear_stiffness=1e6, bond=0.0, tension=0.0):
    """Residual of a single contact; ``before`` None stands for the natural map."""
    return max(violation(gap, slip, reaction, before, shear_stiffness, bond, tension)[:2])


def violation(gap, slip, reaction, before, shear_stiffness=1e6, bond=0.0, tension=0.0):
    """Normal, tangential and over the cone, of a single contact."""
    reaction = np.array([reaction], float)
    one = np.ones(1)
    table = joints(1, shear_stiffness, bond, tension)
    before = reaction[:, 1:].copy() if before is None else before * one[:, None]
    return joint_law_violation(
        table, gap * one, slip * one[:, None], reaction, before, one, 0.0 * one
    )


def joints(n, shear_stiffness=1.0, bond=0.0, tension=0.0):
    """A table of contacts that are all alike."""
    table = np.zeros((n, N_TABLE))
    table[:, [STIFF_N, STIFF_T, FRICTION, BOND, TENSILE]] = KN, shear_stiffness, MU, bond, tension
    return table


class TestJointLaw:
    gaps = st.floats(-1e-2, 1e-2)
    slips = st.floats(-1e-2, 1e-2)
    shears = st.floats(-1e4, 1e4)

    @staticmethod
    def law(gap, slip, before, shear_stiffness=1e6, bond=0.0):
        """r_n = k_n <-g>,  r_t = clip(t_0 - k_s s, +-(mu r_n + bond))."""
        rn = max(-KN * gap, 0.0)
        limit = MU * rn + bond
        return rn, min(max(before - shear_stiffness * slip, -limit), limit)

    @given(gaps, slips, shears)
    def test_the_law_itself_leaves_nothing(self, gap, slip, before):
        reaction = self.law(gap, slip, before)
        assert law_residual(gap, slip, reaction, before=before) <= ROUNDING

    @given(gaps, slips, shears, st.floats(-1e3, 1e3))
    def test_a_wrong_normal_reaction_counts_in_full(self, gap, slip, before, error):
        rn, rt = self.law(gap, slip, before)
        assert law_residual(gap, slip, (rn + error, rt), before=before) >= abs(error) - ROUNDING

    @given(gaps, slips, shears, st.floats(-1e3, 1e3))
    def test_a_wrong_shear_counts_in_full(self, gap, slip, before, error):
        rn, rt = self.law(gap, slip, before)
        found = law_residual(gap, slip, (rn, rt + error), before=before)
        assert found == pytest.approx(abs(error), abs=ROUNDING)

    @pytest.mark.parametrize(
        ("gap", "slip", "reaction", "expected"),
        [
            (1e-3, 0.0, (50.0, 0.0), 50.0),  # presses though open
            (-1e-3, 0.0, (0.0, 0.0), 1e3),  # closed by 1 mm and carries nothing: k_n g
            (-1e-3, 0.0, (1e3, 700.0), 50.0),  # beyond the cone of 650 N
            (-1e-3, 1e-3, (1e3, -650.0), 0.0),  # slides, and friction opposes it
            (-1e-3, 0.0, (1e3, -650.0), 0.0),  # sticks at the limit
            # Slides with its friction: the natural map clips 650 - 1e6 * 1e-3 to -350.
            (-1e-3, 1e-3, (1e3, 650.0), 1e3),
            # Slides though inside the cone: 100 - 1e6 * 1e-4 is 0.
            (-1e-3, 1e-4, (1e3, 100.0), 100.0),
        ],
    )
    def test_friction_without_shear_stiffness(self, gap, slip, reaction, expected):
        assert law_residual(gap, slip, reaction) == pytest.approx(expected, abs=ROUNDING)

    def test_tension_up_to_the_strength(self):
        # 0.1 mm open at 1e6 N/m pulls with 100 N.
        assert law_residual(1e-4, 0.0, (-100.0, 0.0), tension=150.0) <= ROUNDING
        # Beyond the strength the joint is open, and any pull is wrong.
        assert law_residual(2e-4, 0.0, (-200.0, 0.0), tension=150.0) == pytest.approx(200.0)

    def test_cohesion_widens_the_cone(self):
        assert law_residual(-1e-3, 0.0, (1e3, 700.0), bond=60.0) <= ROUNDING
        assert law_residual(-1e-3, 0.0, (1e3, 700.0)) == pytest.approx(50.0)

    def test_the_worst_contact_counts(self):
        one = np.ones(3)
        reaction = np.array([[0.0, 0.0], [10.0, 0.0], [3.0, 0.0]])
        found = joint_law_violation(
            joints(3), one, 0 * reaction[:, 1:], reaction, reaction[:, 1:], one, 0.0 * one
        )
        assert found == pytest.approx((10.0, 0.0, 0.0))

    def test_no_contacts(self):
        nothing = np.zeros(0)
        two = np.zeros((0, 2))
        found = joint_law_violation(
            joints(0), nothing, two[:, 1:], two, two[:, 1:], nothing, nothing
        )
        assert found == (0.0, 0.0, 0.0)

    def test_cohesion_belongs_to_the_cone(self):
        # 650 N of friction and 60 N of cohesion.
        assert violation(-1e-3, 0.0, (1e3, 700.0), None, bond=60.0)[2] == 0.0
        assert violation(-1e-3, 0.0, (1e3, 730.0), None, bond=60.0)[2] == pytest.approx(20.0)

    def test_a_bond_at_its_strength_holds(self):
        """To a millionth: it is where the step to its break ends."""
        exact, over = 150.0 / KN, 150.0 * (1.0 + 2e-6) / KN
        assert law_residual(exact * (1.0 + 1e-9), 0.0, (-150.0, 0.0), tension=150.0) < 1e-6
        assert law_residual(over, 0.0, (-150.0, 0.0), tension=150.0) == pytest.approx(150.0)

    def test_what_is_no_number_is_not_lost(self):
        assert np.isnan(violation(np.nan, 0.0, (1e3, 0.0), 0.0)).all()
        for wrong in (np.nan, np.inf):
            assert np.isnan(violation(-1e-3, 0.0, (1e3, wrong), 0.0)).all()


class TestUnbalancedForce:
    def test_of_force_moment_and_inertia(self):
        extent, free = np.array([0.5, 0.25]), np.zeros(2, bool)
        rest = np.zeros((2, 3))
        push = np.array([[3.0, -4.0, 0.0], [0.0, 0.0, 0.0]])
        assert unbalanced_force(push, rest, extent, free) == pytest.approx(5.0)
        turn = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
        assert unbalanced_force(turn, rest, extent, free) == pytest.approx(8.0)  # 2 N m / 0.25 m
        assert unbalanced_force(push, push, extent, free) == 0.0  # it accelerates as it should

    def test_of_supports_does_not_count(self):
        force = np.array([[1e6, 0.0, 0.0], [0.0, 0.5, 0.0]])
        fixed = np.array([True, False])
        assert unbalanced_force(force, np.zeros((2, 3)), np.ones(2), fixed) == pytest.approx(0.5)

    def test_that_is_no_number(self):
        """Comparisons would pass over it."""
        rest, one, free = np.zeros((2, 3)), np.ones(2), np.zeros(2, bool)
        force = np.array([[np.nan, 0.0, 0.0], [1.0, 0.0, 0.0]])
        assert np.isnan(unbalanced_force(force, rest, one, free))


def contacts_between(body_a, body_b, rows=0.0):
    """Contacts of these bodies, with these gradients (n_contacts, 2, 6)."""
    contacts = Contacts.empty(len(body_a), 2, 3)
    contacts.which[:, BODY_A], contacts.which[:, BODY_B] = body_a, body_b
    contacts.rows[:, :2] = rows
    return contacts


def test_a_block_is_held_by_contacts_that_push_it():
    """Whatever their sum is: two that hold a block between them add up to next to nothing."""
    body_a, body_b = np.array([0, 1, 3]), np.array([1, 2, 4])
    reaction = np.array([[5.0, 0.0], [5.0, 0.0], [0.0, 0.0]])
    held = np.zeros(6, bool)
    mark_touched(contacts_between(body_a, body_b), reaction, held)
    assert held.tolist() == [True, True, True, False, False, False]


def test_contact_forces_are_the_transposed_mapping():
    # H^T r by dense algebra: rows of six columns, (a, b), scattered to the bodies.
    random = np.random.default_rng(3)
    body_a, body_b = np.array([0, 0, 1]), np.array([1, 2, 2])
    mapping, reaction = random.normal(size=(3, 2, 6)), random.normal(size=(3, 2))
    dense = np.zeros((6, 9))
    for c in range(3):
        rows = slice(2 * c, 2 * c + 2)
        dense[rows, 3 * body_a[c] : 3 * body_a[c] + 3] += mapping[c, :, :3]
        dense[rows, 3 * body_b[c] : 3 * body_b[c] + 3] += mapping[c, :, 3:]
    force = np.ones((3, 3))  # added to what is there
    add_contact_forces(contacts_between(body_a, body_b, mapping), reaction, force)
    assert force.ravel() == pytest.approx(1.0 + dense.T @ reaction.ravel(), rel=1e-13)
