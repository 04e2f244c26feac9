"""Threads: what they return, and that results do not depend on their number."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from buildings import box_building
from drystone.common import threads
from drystone.common.threads import Team
from drystone.linear import shared_lu
from drystone.statics import static_step


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


def test_a_curve_is_the_same_to_the_last_bit_with_two_threads(monkeypatch):
    monkeypatch.setattr(shared_lu, "WORTH_SHARING", 0.0)
    monkeypatch.setattr(static_step, "MANY", 1)
    monkeypatch.setattr(static_step, "MANY_OF_LITTLE", 1)
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
