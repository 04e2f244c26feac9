"""Threads: what they return, and that results do not depend on their number."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from buildings import box_building
from drystone import threads
from drystone.kernels import lu_numeric, lu_symbolic
from drystone.kernels.forces import Tangent
from drystone.solvers import cone_step, shared_lu
from drystone.solvers.shared_lu import SharedLU
from drystone.threads import Team


@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_team_returns_what_its_tasks_do_in_their_order(number):
    assert Team(number).run([lambda k=k: k * k for k in range(5)]) == [0, 1, 4, 9, 16]


@pytest.mark.parametrize("number", [1, 2])
def test_an_error_in_a_task_is_raised_when_all_are_over(number):
    done = []
    with pytest.raises(ZeroDivisionError):
        Team(number).run([lambda: done.append(0), lambda: 1 // 0])
    assert done == [0]


def test_the_number_of_threads_holds_for_what_is_inside():
    with threads.limited(3):
        with threads.limited(1):
            assert threads.team().number == 1
        assert threads.team().number == 3
    with threads.limited(None):
        assert threads.team().number == threads.available()
    with pytest.raises(ValueError, match="threads is 0"), threads.limited(0):
        pass


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
    monkeypatch.setattr(shared_lu, "WORTH", 0.0)
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


def test_a_curve_is_the_same_to_the_last_bit_with_two_threads(monkeypatch):
    monkeypatch.setattr(shared_lu, "WORTH", 0.0)
    monkeypatch.setattr(cone_step, "MANY", 1)
    monkeypatch.setattr(cone_step, "MANY_OF_LITTLE", 1)
    run, shared = Team.run, []
    monkeypatch.setattr(
        Team, "run", lambda self, tasks: shared.append(len(tasks)) or run(self, tasks)
    )
    model = box_building(units=2, courses=3, friction=0.6, stiffness=1e9)
    curves = [
        ds.pushover(model, engine="equilibrium", max_displacement=0.02, threads=number)
        for number in (1, 2)
    ]
    assert set(shared) == {2}
    first, second = ([(p.load_multiplier, p.residual) for p in c.points] for c in curves)
    assert len(first) > 3
    assert first == second
    assert np.array_equal(curves[0].poses, curves[1].poses)
