"""Factors that threads share, against those of one alone."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.common.threads import Team
from drystone.linear import numeric as lu_numeric
from drystone.linear import shared_lu
from drystone.linear import symbolic as lu_symbolic
from drystone.linear.shared_lu import SharedLU
from drystone.linear.symbolic import Tangent

pytestmark = pytest.mark.kernels


def grid(rng, side):
    """Bodies on a square grid, joined to their neighbours, one of them fixed; their matrix."""
    n = side * side
    at = np.arange(n).reshape(side, side)
    a = np.concatenate((at[:, :-1].ravel(), at[:-1].ravel()))
    b = np.concatenate((at[:, 1:].ravel(), at[1:].ravel()))
    fixed = np.zeros(n, np.bool_)
    fixed[n // 2] = True
    place = np.column_stack((*np.divmod(np.arange(n), side), np.zeros(n))).astype(float)
    matrix = Tangent.zeros(n, len(a), 6)
    for block in matrix:
        block[:] = rng.normal(size=block.shape)
    matrix.diagonal[:] += 30.0 * np.eye(6)
    return lu_symbolic.analyse(a, b, fixed, place, 6), matrix


@pytest.mark.parametrize("number", [2, 3, 7])
def test_a_shared_factorisation_is_the_same_to_the_last_bit(number, monkeypatch):
    monkeypatch.setattr(shared_lu, "WORTH_SHARING", 0.0)
    rng = np.random.default_rng(number)
    structure, matrix = grid(rng, 9)
    n = len(matrix.diagonal)
    matrix.diagonal[::7, 0] *= -1.0  # their determinants are negative: such bodies are held
    alone, shared = SharedLU(structure, Team(1)), SharedLU(structure, Team(number))
    assert not alone.parts
    assert 2 <= len(shared.parts) <= number
    assert all(shared.parts)
    for least in (0.0, 10.0):
        held = np.zeros((2, n))
        found = [
            lu.factorise(matrix, np.ones((n, 6)), damping, least)
            for lu, damping in zip((alone, shared), held, strict=True)
        ]
        assert found[0] == found[1] != 0.0
        assert np.array_equal(*held)
        assert held.any() == (least > 0.0)
        assert np.array_equal(alone.factors.panels, shared.factors.panels)
        assert np.array_equal(alone.factors.inverse, shared.factors.inverse)
        x = rng.normal(size=(1, n, 6))
        y = x.copy()
        lu_numeric.solve(alone.structure, alone.factors, x)
        lu_numeric.solve(shared.structure, shared.factors, y)
        assert np.array_equal(x, y)
    matrix.diagonal[3] = np.nan
    assert shared.factorise(matrix, np.ones((n, 6)), np.zeros(n), 0.0) == 0.0
