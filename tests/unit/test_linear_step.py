"""Parts of a structure's equations."""

from __future__ import annotations

import numpy as np
import pytest

from builders import problem_of
from drystone.engines.base import Demand
from drystone.model.builders import published_wall
from drystone.statics.equilibrium import EquilibriumEngine
from interpreted import fewer

pytestmark = pytest.mark.kernels


@pytest.fixture(scope="module")
def step():
    """Equations linearised on the rising branch of a wall."""
    engine = EquilibriumEngine()
    state, _ = engine.start(problem_of(published_wall(2)))
    for _ in range(fewer(8, 2)):
        state, report = engine.step(state, Demand(increment=2e-4))
        assert report.converged
    step = engine.last.step
    nothing = np.zeros_like(state.pose)
    assert step.linearise(nothing, state.multiplier, nothing, None, nothing)
    return step


@pytest.mark.parametrize("rings", [0, 1, 3])
def test_a_part_has_the_forces_and_tangents_of_the_whole(step, rings):
    bodies = np.zeros(len(step.loads.fixed), np.bool_)
    bodies[[7, 30]] = True
    part = step.part(bodies, rings)
    free = part.bodies[~part.step.loads.fixed]
    assert set(np.flatnonzero(bodies)) <= set(free.tolist())
    assert len(free) == 2 if rings == 0 else len(free) > 2
    rng = np.random.default_rng(0)
    away = np.where(part.step.loads.fixed[:, None], 0.0, rng.normal(size=(len(part.bodies), 3)))
    away *= 1e-6
    whole = np.zeros_like(step.force)
    whole[part.bodies] = away
    for equations, x in ((step, whole), (part.step, away)):
        equations.respond()
        equations.assemble(x, 0.3, x)
    movable = ~part.step.loads.fixed
    np.testing.assert_allclose(
        part.step.force[movable], step.force[part.bodies][movable], rtol=1e-9, atol=1e-6
    )
    np.testing.assert_allclose(
        part.step.tangent.diagonal[movable], step.tangent.diagonal[part.bodies][movable], rtol=1e-9,
        atol=1e-3,
    )  # fmt: skip


def test_a_part_is_a_copy(step):
    bodies = np.zeros(len(step.loads.fixed), np.bool_)
    bodies[20] = True
    before = step.contacts.table.copy()
    part = step.part(bodies, 1)
    part.step.contacts.table[:] = np.nan
    assert np.array_equal(step.contacts.table, before)
    assert np.array_equal(part.rows, np.unique(part.rows))
