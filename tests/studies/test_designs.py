"""Designs and distributions: counts, marginals, correlation, and numbers by the seed alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from drystone.studies import designs
from drystone.studies.distributions import Choices, DistributionError, Uniform, continuous
from drystone.studies.errors import StudyError

UNIT = Uniform(low=0.0, high=1.0)


def drawn(design, n, laws, **more):
    return np.array(designs.values_of(design, n, laws, seed=3, steps=(None,) * len(laws), **more))


@pytest.mark.parametrize(
    ("design", "n", "count"),
    [("grid", 1, 25), ("lhs", 12, 12), ("sobol", 16, 16), ("random", 9, 9),
     ("saltelli", 8, 32), ("morris", 5, 15)],
)  # fmt: skip
def test_designs_have_as_many_samples_as_they_say(design, n, count):
    laws = [UNIT, UNIT]
    assert designs.count(design, n, laws, (None, None), False) == count
    assert drawn(design, n, laws).shape == (2, count)


def test_a_latin_hypercube_has_one_sample_in_each_share():
    values = drawn("lhs", 50, [UNIT, UNIT])
    for column in values:
        assert sorted((column * 50).astype(int)) == list(range(50))


def test_more_samples_begin_with_the_fewer():
    for design in designs.GROWING:
        few, many = drawn(design, 16, [UNIT, UNIT]), drawn(design, 64, [UNIT, UNIT])
        np.testing.assert_array_equal(few, many[:, :16])


def test_seeds_of_samples_follow_from_their_number():
    seeds = [designs.seed_of(1, k) for k in range(1000)]
    assert len(set(seeds)) == 1000 and seeds[7] == designs.seed_of(1, 7)
    assert designs.seed_of(2, 7) != seeds[7]


@pytest.mark.parametrize("second_order", [False, True])
def test_rows_of_a_base_sample_have_the_seed_of_their_matrix(second_order):
    """Row A first, B last; between them A with a column of B, then B with a column of A."""
    d, n = 3, 4
    points = designs.unit_cube("saltelli", n, [UNIT] * d, 1, 4, second_order)
    shared = designs.sharing("saltelli", d, second_order)
    blocks = points.reshape(n, len(shared), d)
    seeds = np.array([designs.seed_of(1, k, shared) for k in range(len(points))])
    for block, own in zip(blocks, seeds.reshape(n, -1), strict=True):
        matrix = block[0], block[-1]
        assert own[0] != own[-1]
        for row, seed in zip(block, own, strict=True):
            of_a = seed == own[0]
            assert of_a or seed == own[-1]
            assert (row != matrix[0 if of_a else 1]).sum() <= 1
    assert len(set(seeds)) == 2 * n


def test_a_trajectory_has_one_seed():
    d, n = 3, 4
    shared = designs.sharing("morris", d, False)
    seeds = np.array([designs.seed_of(1, k, shared) for k in range(n * (d + 1))]).reshape(n, -1)
    assert (seeds == seeds[:, :1]).all() and len(np.unique(seeds)) == n


@pytest.mark.parametrize("name", ["norm", "lognorm", "uniform", "gumbel_r"])
def test_mean_and_standard_deviation_are_those_of_the_values(name):
    """A Latin hypercube of 4000 leaves less than 1 % of the standard deviation."""
    law = continuous(name, mean=0.65, std=0.08, shapes={}, bounds=None)
    (values,) = drawn("lhs", 4000, [law])
    assert values.mean() == pytest.approx(0.65, abs=8e-4)
    assert values.std() == pytest.approx(0.08, rel=0.02)


def test_bounds_cut_the_distribution_off():
    law = continuous("norm", mean=0.0, std=1.0, shapes={}, bounds=[-1.0, 2.0])
    (values,) = drawn("lhs", 2000, [law])
    assert values.min() >= -1.0 and values.max() <= 2.0
    assert values.mean() == pytest.approx(stats.truncnorm(-1, 2).mean(), abs=0.005)


@pytest.mark.parametrize("low", [1.0, 7.0, 9.0, 30.0])
def test_bounds_far_in_either_tail_cut_the_distribution_off(low):
    """Against scipy's truncated normal law, and against the mirror image; to a few roundings."""
    shares = (np.arange(100) + 0.5) / 100
    bounds = [low, low + 0.5]
    above = continuous("norm", mean=0.0, std=1.0, shapes={}, bounds=bounds).at(shares)
    np.testing.assert_allclose(above, stats.truncnorm(*bounds).ppf(shares), rtol=1e-12)
    bounds = [-low - 0.5, -low]
    below = continuous("norm", mean=0.0, std=1.0, shapes={}, bounds=bounds).at(shares)
    np.testing.assert_allclose(above, -np.array(below[::-1]), rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "bounds"), [("norm", [40.0, 41.0]), ("norm", [-41.0, -40.0]), ("uniform", [2.0, 3.0])]
)
def test_bounds_without_a_probability_between_them_are_refused(name, bounds):
    """A uniform law of mean 0 and standard deviation 1 ends at the root of 3."""
    with pytest.raises(DistributionError, match="no probability between its bounds"):
        continuous(name, mean=0.0, std=1.0, shapes={}, bounds=bounds)


def test_correlation_is_that_of_normal_scores_and_leaves_marginals():
    """Of 4000 the standard error of a correlation of 0.6 is 0.01."""
    matrix = np.array([[1.0, 0.6], [0.6, 1.0]])
    laws = [UNIT, continuous("norm", mean=0.0, std=1.0, shapes={}, bounds=None)]
    a, b = drawn("random", 4000, laws, correlation=matrix)
    assert np.corrcoef(stats.norm.ppf(a), b)[0, 1] == pytest.approx(0.6, abs=0.03)
    assert stats.kstest(a, "uniform").pvalue > 0.01


def test_whole_numbers_and_choices_are_as_likely_as_each_other():
    whole, choice = designs.values_of(
        "lhs", 600, [Uniform(low=1, high=3, whole=True), Choices(values=("a", "b"))], seed=1
    )
    assert [whole.count(k) for k in (1, 2, 3)] == [200, 200, 200]
    assert choice.count("a") == 300
    assert all(isinstance(value, int) for value in whole)


@pytest.mark.parametrize("steps", [2, 3, 7])
def test_whole_numbers_lie_within_their_range(steps):
    law = Uniform(low=0.5, high=3.4, whole=True)
    assert set(law.spread(steps)) <= {1, 2, 3} and law.spread(7) == [1, 2, 3]
    assert set(law.at(np.linspace(0.0, 1.0, 50))) == {1, 2, 3}
    with pytest.raises(DistributionError, match="no whole number in its range"):
        Uniform(low=0.2, high=0.8, whole=True)


def test_morris_needs_ends():
    law = continuous("norm", mean=0.0, std=1.0, shapes={}, bounds=None)
    with pytest.raises(StudyError, match="give it bounds"):
        drawn("morris", 4, [law])
    assert not math.isinf(continuous("norm", mean=0, std=1, shapes={}, bounds=[-3, 3]).at(
        np.array([1.0]))[0])  # fmt: skip
