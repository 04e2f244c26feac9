"""Parts of a step in space, and stones that fall in them while all else stands still."""

from __future__ import annotations

import numpy as np
import pytest

from builders import problem_of
from drystone.engines.base import Demand
from drystone.geometry.motion import translations
from drystone.statics.equilibrium import EquilibriumEngine
from drystone.statics.space.cone_fall import FallSettings, come_to_rest
from drystone.statics.space.cone_search import Attempt, ConeSearch, ConeSettings
from solids import leaf


@pytest.fixture(scope="module")
def engine():
    """With the equations of a step on the rising branch of a leaf, where it has ended."""
    engine = EquilibriumEngine()
    state, _ = engine.start(problem_of(leaf()))
    for _ in range(2):
        state, report = engine.step(state, Demand(increment=1e-5))
        assert report.converged
    return engine


def chosen(step, *bodies):
    mask = np.zeros(len(step.loads.fixed), np.bool_)
    mask[list(bodies)] = True
    return mask


def on_top(step):
    """A stone of the last course, other than the one that is pushed."""
    height = step.constants.detector.assembly.centroid[:, 2].copy()
    height[step.pace.body] = -np.inf
    return int(np.argmax(height))


@pytest.mark.parametrize("rings", [0, 1, 2])
def test_a_part_has_the_forces_and_tangents_of_the_whole(engine, rings):
    step = engine.last.step
    part = step.part(chosen(step, 20), rings)
    free = ~part.loads.fixed
    assert free[20] and np.count_nonzero(free) == 1 if rings == 0 else np.count_nonzero(free) > 1
    # From here on, by the same motion of what is free: small against the closure of joints.
    rng = np.random.default_rng(0)
    away = np.where(free[:, None], rng.normal(size=step.x.shape), 0.0) * 1e-7
    at = step.place
    for equations in (step, part):
        equations.move(away, 1.0)
        equations.respond()
        equations.balance(equations.reaction)
        equations.factorise(equations.reaction, 0.0)
    weight = np.abs(step.loads.dead).max()
    np.testing.assert_allclose(part.x, step.x, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(part.force[free], step.force[free], rtol=0.0, atol=1e-9 * weight)
    body = step.pace.body  # which a spring holds in the whole
    same = free & (np.arange(len(free)) != body)
    stiffest = np.abs(step.tangent.diagonal[same]).max()
    np.testing.assert_allclose(
        part.tangent.diagonal[same], step.tangent.diagonal[same], rtol=0.0, atol=1e-9 * stiffest
    )
    step.come_back(at)


def test_no_part_of_what_is_held(engine):
    step = engine.last.step
    fixed = int(np.flatnonzero(step.loads.fixed)[0])
    assert step.part(chosen(step, fixed), 0) is None
    assert step.part(chosen(step, step.pace.body), 0) is None


def test_a_stone_that_was_lifted_falls_back(engine):
    """By a tenth of a millimetre, a hundred times what its weight closes its bed by."""
    step, accuracy = engine.last.step, engine.last.accuracy
    top = on_top(step)
    part = step.part(chosen(step, top), 0)
    rest = translations(part.x)[top].copy()
    lifted = np.zeros_like(part.x)
    lifted[top, 2] = 1e-4
    part.move(lifted, 1.0)
    search = ConeSearch(part, accuracy, ConeSettings())
    attempt = Attempt(barrier=FallSettings().barrier, iterations=30)
    assert come_to_rest(search, attempt, FallSettings(), 100.0, 200.0)
    part.respond()
    assert part.balance(part.reaction) <= accuracy.tolerance
    np.testing.assert_allclose(translations(part.x)[top], rest, rtol=0.0, atol=2e-6)
    others = np.arange(len(part.x)) != top
    np.testing.assert_allclose(part.x[others], step.x[others], rtol=0.0, atol=1e-15)


def test_what_falls_too_far_does_not_rest(engine):
    """By 50 mm onto its bed: that is a motion to be followed in time."""
    step, accuracy = engine.last.step, engine.last.accuracy
    top = on_top(step)
    part = step.part(chosen(step, top), 0)
    thrown = np.zeros_like(part.x)
    thrown[top, 2] = 0.05
    part.move(thrown, 1.0)
    search = ConeSearch(part, accuracy, ConeSettings())
    attempt = Attempt(barrier=FallSettings().barrier, iterations=30)
    assert not come_to_rest(search, attempt, FallSettings(), 100.0, 60.0)
