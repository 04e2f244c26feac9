"""Designs: which values the parameters of each sample have.

All samples of a study are drawn at once, from its seed alone, so that who computes them, and in
which order, changes no number.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.studies.distributions import Continuous, Law
from drystone.studies.errors import StudyError, needed

#: Designs of which the first samples stay what they are when more are asked for.
GROWING = ("sobol", "random")
#: Values of a parameter of a grid that does not say how many.
STEPS = 5


def count(
    design: str, n: int, laws: Sequence[Law], steps: Sequence[int | None], second_order: bool
) -> int:
    """How many samples a design has.

    Parameters
    ----------
    n
        Of "saltelli" and "morris" base samples and trajectories; of "grid" nothing.
    """
    d = len(laws)
    if design == "grid":
        return math.prod(len(law.spread(k or STEPS)) for law, k in zip(laws, steps, strict=True))
    if design == "saltelli":
        return n * ((2 * d + 2) if second_order else (d + 2))
    return n * (d + 1) if design == "morris" else n


def values_of(
    design: str,
    n: int,
    laws: Sequence[Law],
    *,
    seed: int,
    steps: Sequence[int | None] = (),
    levels: int = 4,
    second_order: bool = False,
    correlation: Array | None = None,
) -> list[list[Any]]:
    """Values of all samples, a list for each parameter.

    Parameters
    ----------
    levels
        Of "morris": values a parameter takes.
    correlation
        (d, d), of the normal scores (a Gaussian copula); None where parameters are independent.
    """
    if design == "grid":
        spread = [law.spread(k or STEPS) for law, k in zip(laws, steps, strict=True)]
        return [list(column) for column in zip(*itertools.product(*spread), strict=True)]
    unit = unit_cube(design, n, laws, seed, levels, second_order)
    if correlation is not None:
        unit = _correlated(unit, correlation)
    return [law.at(unit[:, k]) for k, law in enumerate(laws)]


def unit_cube(
    design: str, n: int, laws: Sequence[Law], seed: int, levels: int, second_order: bool
) -> Array:
    """Points of the unit cube, (count, d)."""
    from scipy.stats import qmc

    d = len(laws)
    if d == 0:
        return np.empty((n, 0))
    if design == "random":
        return np.random.default_rng(seed).random((n, d))
    if design == "lhs":
        return qmc.LatinHypercube(d, seed=seed).random(n)
    if design == "sobol":
        return qmc.Sobol(d, scramble=True, seed=seed).random(n)
    problem = problem_of([f"x{k}" for k in range(d)])
    if design == "saltelli":
        sample = needed("SALib.sample.sobol").sample
        return np.asarray(
            sample(problem, n, calc_second_order=second_order, seed=seed), dtype=float
        )
    unbounded = [law for law in laws if isinstance(law, Continuous) and not law.is_bounded]
    if unbounded:
        raise StudyError(
            [f'design = "morris" goes to the ends of {unbounded[0].name}: give it bounds']
        )
    sample = needed("SALib.sample.morris").sample
    return np.asarray(sample(problem, n, num_levels=levels, seed=seed), dtype=float)


def problem_of(names: Sequence[str]) -> dict[str, Any]:
    """What SALib calls a problem: parameters of the unit cube."""
    return {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}


def _correlated(unit: Array, correlation: Array) -> Array:
    """Points of the unit cube with correlated normal scores; each column stays uniform."""
    from scipy.stats import norm

    scores = norm.ppf(unit) @ np.linalg.cholesky(correlation).T
    return np.asarray(norm.cdf(scores))


def sharing(design: str, d: int, second_order: bool) -> tuple[int, ...]:
    """Which samples have the same seed: for each row of a base sample, the number of its seed.

    The seed is one more factor of "saltelli", independent of the parameters: a base sample has one
    value of it in matrix A, another in B.  Row A and the rows AB_i (A with column i of B) have
    number 0; row B and the rows BA_i have number 1.  A total index compares A with AB_i, which
    differ in parameter i alone.  A first index compares B with AB_i, which have parameter i alone
    in common; a second index compares BA_i with AB_j, which have parameters i and j in common.  So
    each index is that of its parameters among all factors, and the variance that it is a share of
    holds what the seed makes.  Of "morris" a trajectory has one seed.  Other designs have one row.

    Parameters
    ----------
    d
        How many parameters there are.
    """
    if design == "saltelli":
        return (0,) * (d + 1) + (1,) * (d + 1 if second_order else 1)
    return (0,) * (d + 1) if design == "morris" else (0,)


def seed_of(seed: int, sample: int, shared: Sequence[int] = (0,)) -> int:
    """The seed of a sample, by the study's seed and the sample's number alone.

    Parameters
    ----------
    shared
        As of `sharing`; all samples have one seed where it is empty.
    """
    number = 0
    if shared:
        base, row = divmod(sample, len(shared))
        number = base * (max(shared) + 1) + shared[row]
    state = np.random.SeedSequence(entropy=seed, spawn_key=(number,)).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))
