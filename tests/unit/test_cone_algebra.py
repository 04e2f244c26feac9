"""Vectors in products of cones, and programs of cones by two methods."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array, csc_matrix, hstack

import solids
from drystone.limit import associative, interior_point
from drystone.limit.cone_algebra import Cones
from drystone.limit.cone_program import minimise
from drystone.limit.equilibrium import Equilibrium

LAWS = [{}, {"cohesion": 900.0}, {"cohesion": 900.0, "tensile_strength": 9.0}]
GROUPS = [(4, 3), (3, 1), (2, 2), (1, 5)]
#: Of numbers of order one.
EXACT = 1e-13


def inside(rng, groups=GROUPS):
    parts = []
    for count, size in groups:
        v = rng.normal(size=(count, size))
        v[:, 0] = np.linalg.norm(v[:, 1:], axis=1) + rng.uniform(0.1, 1.0, count)
        parts.append(v.ravel())
    return np.concatenate(parts)


@pytest.fixture(params=range(5))
def scaled(request):
    rng = np.random.default_rng(request.param)
    cones, x, z = Cones(GROUPS), inside(rng), inside(rng)
    cones.scale(x, z)
    return cones, x, z, rng


def test_the_scaling_takes_both_to_one_point(scaled):
    cones, x, z, _ = scaled
    np.testing.assert_allclose(cones.scaled(z), cones.scaled(x, inverse=True), atol=EXACT)
    np.testing.assert_allclose(cones.squared(z), x, atol=EXACT)
    np.testing.assert_allclose(cones.matrix() @ z, x, atol=EXACT)
    np.testing.assert_allclose(cones.scaled(cones.scaled(z)), x, atol=EXACT)


def test_quotients_undo_products(scaled):
    cones, x, _, rng = scaled
    y = rng.normal(size=cones.size)
    np.testing.assert_allclose(cones.quotient(x, cones.product(x, y)), y, atol=1e-12)
    np.testing.assert_allclose(cones.product(x, cones.unity), x, atol=EXACT)


def test_a_step_reaches_the_boundary(scaled):
    cones, x, _, rng = scaled
    for _ in range(20):
        step = rng.normal(size=cones.size)
        share = cones.reach(x, step, np.inf)
        assert cones.depth(x + share * step) == pytest.approx(0.0, abs=1e-12 * (1.0 + share))
        assert cones.depth(x + 0.999 * share * step) > 0.0
    assert cones.reach(x, cones.unity, 7.0) == 7.0


def test_eigenvalues_are_brought_between_bounds(scaled):
    cones, _, _, rng = scaled
    x = 0.5 * rng.normal(size=cones.size)
    moved = x + cones.towards(x, 0.1, 10.0)
    assert cones.depth(moved) >= 0.1 - EXACT
    well = inside(rng) + 0.2 * cones.unity
    np.testing.assert_allclose(cones.towards(well, 0.1, 100.0), 0.0, atol=EXACT)


@pytest.mark.parametrize("seed", range(6))
def test_random_programs_by_two_methods(seed):
    """Feasible and bounded by construction: inner x and z are there; the last column is free."""
    rng = np.random.default_rng(seed)
    groups = [(8, 3), (4, 2), (5, 1)]
    size = Cones(groups).size
    dense = rng.normal(size=(12, size + 1)) * (rng.uniform(size=(12, size + 1)) < 0.5)
    dense[:, :12] += 3.0 * np.eye(12)
    a = csc_array(dense)
    b = a @ np.append(inside(rng, groups), rng.normal())
    cost = a.T @ rng.normal(size=12) + np.append(inside(rng, groups), 0.0)
    found = interior_point.solve(cost, a, b, np.array([size]), cones=groups, tolerance=1e-10)
    assert found.converged and Cones(groups).depth(found.x[:-1]) > 0.0
    kinds = [(12, "zero"), *((d, "cone") for count, d in groups for _ in range(count) if d > 1)]
    kinds.append((5, "nonnegative"))
    inner = -hstack([csc_array(np.eye(size)), csc_array((size, 1))])
    matrix = csc_matrix(np.vstack((dense, inner.toarray())))
    status, x, _, _ = minimise(cost, matrix, np.append(b, np.zeros(size)), kinds)
    assert status == "optimal"
    assert cost @ found.x == pytest.approx(cost @ x, abs=1e-7)
    assert b @ found.y == pytest.approx(cost @ x, abs=1e-7)
    np.testing.assert_allclose(a @ found.x, b, atol=1e-8)


def test_a_program_with_an_answer_by_hand():
    """The nearest point of a plane: the least x0 >= |x1| with n.x1 = 1 is 1 / |n|."""
    n = np.array([3.0, 4.0])
    a = csc_array(np.array([[0.0, *n]]))
    found = interior_point.solve(
        np.array([1.0, 0.0, 0.0]), a, np.ones(1), np.zeros(0, int), cones=[(1, 3)]
    )
    np.testing.assert_allclose(found.x, [0.2, 0.12, 0.16], atol=1e-7)


@pytest.mark.parametrize("make", [solids.leaf, solids.one_block])
@pytest.mark.parametrize("law", LAWS)
def test_both_methods_agree_in_space(make, law, monkeypatch):
    model = make()
    joint = replace(model.assembly.joint, **law)
    equilibrium = Equilibrium.of(replace(model.assembly, joint=joint), model.load)
    one = associative.collapse(equilibrium)
    fraction = associative.dead_load_factor(equilibrium).factor
    monkeypatch.setattr(associative, "is_large", lambda _: False)
    other = associative.collapse(equilibrium)
    assert one.status == other.status == "optimal"
    assert one.factor == pytest.approx(other.factor, abs=1e-8)
    assert fraction == pytest.approx(associative.dead_load_factor(equilibrium).factor, abs=1e-6)
    for answer in (one, other):
        upper = associative.upper_bound(equilibrium, answer.velocity)
        assert upper == pytest.approx(answer.factor, abs=1e-8)


def test_locked_and_unstable_by_both_methods(monkeypatch):
    model = solids.one_block()
    down = Equilibrium.of(model.assembly, type(model.load)(direction=np.array([0.0, 0.0, -1.0])))
    hanging = solids.model_of(
        (*model.assembly.blocks, solids.box("loose", (5, 0, 1), (6, 1, 2))),
        model.assembly.joint,
        push=(1, 0, 0),
    )
    falling = Equilibrium.of(hanging.assembly, hanging.load)
    for inside_first in (True, False):
        monkeypatch.setattr(associative, "is_large", lambda _, first=inside_first: first)
        assert associative.is_locked(down)
        assert associative.collapse(down).status == "unbounded"
        answer = associative.dead_load_factor(falling)
        assert answer.factor == pytest.approx(0.0, abs=1e-6)
