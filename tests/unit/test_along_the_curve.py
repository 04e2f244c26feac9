"""Steps in space that follow the curve begin in the branches that its tangent leads to."""

from __future__ import annotations

import numpy as np
import pytest

from builders import problem_of
from drystone.analysis.driver import pushover
from drystone.engines.base import Demand
from drystone.statics.equilibrium import EquilibriumEngine
from drystone.statics.interior import InteriorPoint
from solids import leaf, one_block

pytestmark = pytest.mark.kernels


@pytest.mark.compiled
@pytest.mark.parametrize("stiffness", [1e9, 1e12])
def test_a_leaf_that_rocks_takes_few_iterations_however_stiff_its_joints(stiffness):
    curve = pushover(leaf(courses=4, stiffness=stiffness), engine="equilibrium")
    rocking = [p.n_iterations for p in curve.points if p.control_displacement > 0.01]
    assert len(rocking) > 20
    assert np.mean(rocking) <= 2.0


def test_what_has_failed_is_tried_again_after_twice_as_many_steps(monkeypatch):
    """Newton's method along the curve is made to fail; the interior-point method goes on."""
    engine, tried = EquilibriumEngine(), []
    state, _ = engine.start(problem_of(one_block(stiffness=1e9)))
    state, _ = engine.step(state, Demand(increment=1e-6))
    assert state.tangent is not None

    def fails(*_):
        tried.append(state.in_vain)
        return False

    with monkeypatch.context() as patched:
        patched.setattr(InteriorPoint, "newton_along", fails)
        for k in range(10):
            state, report = engine.step(state, Demand(increment=1e-6))
            assert report.converged
            assert state.in_vain == k + 1
    assert tried == [0, 1, 2, 4, 8]
    for _ in range(7):  # to the sixteenth
        state, _ = engine.step(state, Demand(increment=1e-6))
    assert state.in_vain == 0
