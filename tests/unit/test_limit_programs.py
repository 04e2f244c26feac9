"""Linear programs: the interior-point method against HiGHS, cones against inequalities."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csc_array, random_array

import drystone.limit.associative as method
from drystone.limit import interior_point
from drystone.limit.cones import Regions, least_normal, shear_strength
from drystone.limit.equilibrium import Equilibrium
from drystone.model.assembly import Assembly
from drystone.model.builders import coursed_wall
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern

LAWS = [
    {"friction_coefficient": 0.6},
    {"friction_coefficient": 0.6, "cohesion": 900.0},
    {"friction_coefficient": 0.6, "cohesion": 900.0, "tensile_strength": 400.0},
    {"friction_coefficient": 0.6, "cohesion": 900.0, "tensile_strength": 1e6},
    {"friction_coefficient": 0.0, "cohesion": 900.0, "tensile_strength": 50.0},
]


def wall(**law):
    blocks = coursed_wall(
        unit=(0.4, 0.2), courses=("h11h", "111"), repeat=3, base=True, unit_weight=1e4
    )
    joint = JointLaw(normal_stiffness=None, shear_stiffness=None, **law)
    load = MassPattern(direction=np.array([1.0, 0.0]))
    return Equilibrium.of(Assembly.build(blocks, joint=joint), load)


@pytest.mark.parametrize("seed", range(5))
def test_interior_point_finds_the_optimum_of_random_programs(seed):
    rng = np.random.default_rng(seed)
    a = random_array((12, 40), density=0.3, rng=rng, data_sampler=rng.standard_normal)
    a = csc_array(a) + csc_array((rng.normal(size=12), (range(12), range(12))), shape=(12, 40))
    # Feasible and bounded by construction: x > 0 and z > 0 are there; the last column is free.
    b = a @ rng.uniform(0.1, 1.0, 40)
    cost = a.T @ rng.normal(size=12) + np.append(rng.uniform(0.1, 1.0, 39), 0.0)
    found = interior_point.solve(cost, csc_array(a), b, np.array([39]))
    bounds = [(0, None)] * 39 + [(None, None)]
    expected = linprog(cost, A_eq=a.toarray(), b_eq=b, bounds=bounds)
    assert found.converged
    assert cost @ found.x == pytest.approx(expected.fun, abs=1e-7)
    np.testing.assert_allclose(a @ found.x, b, atol=1e-7)
    assert b @ found.y == pytest.approx(expected.fun, abs=1e-7)


@pytest.mark.parametrize("law", LAWS)
def test_both_methods_agree_on_a_wall(law, monkeypatch):
    equilibrium = wall(**law)
    answers = []
    for large in (10**9, 1):
        monkeypatch.setitem(method.INTERIOR_FROM, 2, large)
        answer = method.collapse(equilibrium)
        assert answer.status == "optimal"
        assert method.dead_load_factor(equilibrium).factor == pytest.approx(1.0, abs=1e-6)
        upper = method.upper_bound(equilibrium, answer.velocity)
        assert upper == pytest.approx(answer.factor, abs=1e-6)
        assert equilibrium.live @ answer.velocity == pytest.approx(1.0, abs=1e-6)
        answers.append(answer)
    assert answers[0].factor == pytest.approx(answers[1].factor, abs=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_regions_stay_within_the_strength(law):
    equilibrium = wall(**law)
    regions = Regions.of(equilibrium)
    rng = np.random.default_rng(0)
    amounts = []
    for k, (count, size) in enumerate(regions.cones):
        vectors = rng.normal(size=(count, size))
        vectors[:, 0] = np.linalg.norm(vectors[:, 1:], axis=1) + rng.uniform(0.0, 1.0, count)
        amounts.append((vectors / vectors[:, :1] if k == 1 else vectors).ravel())
    amounts = np.concatenate(amounts)
    np.testing.assert_allclose(regions.sharing @ amounts, 1.0, atol=1e-15)
    normal, tangential = (regions.fixed + regions.combination @ amounts).reshape(-1, 2).T
    assert np.all(normal >= least_normal(equilibrium) - 1e-12)
    assert np.all(np.abs(tangential) <= shear_strength(equilibrium, normal) + 1e-12)


def test_locked_is_found_by_both_methods(monkeypatch):
    equilibrium = wall(friction_coefficient=0.6)
    downwards = MassPattern(direction=np.array([0.0, -1.0]))
    equilibrium = Equilibrium.of(equilibrium.assembly, downwards)
    for large in (10**9, 1):
        monkeypatch.setitem(method.INTERIOR_FROM, 2, large)
        assert method.is_locked(equilibrium)
        assert method.collapse(equilibrium).status == "unbounded"


def test_unstable_is_found_by_both_methods(monkeypatch):
    blocks = coursed_wall(
        unit=(0.4, 0.2), courses=("1.1", "1..", "111"), base=True, unit_weight=1e4
    )  # the third course has nothing under two of its units
    joint = JointLaw(friction_coefficient=0.6, normal_stiffness=None, shear_stiffness=None)
    load = MassPattern(direction=np.array([1.0, 0.0]))
    equilibrium = Equilibrium.of(Assembly.build(blocks, joint=joint), load)
    for large in (10**9, 1):
        monkeypatch.setitem(method.INTERIOR_FROM, 2, large)
        answer = method.dead_load_factor(equilibrium)
        assert answer.factor == pytest.approx(0.0, abs=1e-6)
        # The dead load does work on the mechanism.
        assert equilibrium.dead @ answer.velocity == pytest.approx(1.0, abs=1e-6)


def test_interior_point_says_that_equal_free_columns_cannot_be_told_apart():
    """The small system of the free columns is singular from the start: no traceback."""
    a = np.hstack((np.eye(4), np.ones((4, 2))))
    found = interior_point.solve(np.ones(6), csc_array(a), np.ones(4), np.array([4, 5]))
    assert not found.converged and found.error == np.inf
