"""What does not keep the engine's residual is no point of the curve, and the run says so."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from builders import PUBLISHED_JOINT, stack
from drystone.analysis.driver import pushover
from drystone.analysis.tracing import obeyed
from drystone.cli.outcome import UNFINISHED, exit_code
from drystone.contact.forces import ContactForces
from drystone.engines.base import Capabilities, Engine, EngineError, StepPath, StepReport
from drystone.model.builders import make_model


@dataclass
class State:
    pose: np.ndarray
    reached: float = 0.0


class Stub(Engine):
    """Reports a branch of multipliers that rises by its increments, with a residual per step."""

    name = "stub"
    capabilities = Capabilities(prescribes_displacement=True, residual_limit=1e-6)

    def __init__(self, residuals, dynamic=False):
        self.residuals, self.dynamic = iter(residuals), dynamic

    def _report(self, displacement):
        return StepReport(
            converged=True,
            static_multiplier=100.0 * displacement,
            applied_multiplier=100.0 * displacement,
            control_displacement=displacement,
            residual=next(self.residuals),
            penetration=0.0,
            inertia_ratio=1.0 if self.dynamic else 0.0,
            motion=0.0,
            path=StepPath(excess=(0.0, 0.0), bend=(0.0, 0.0)),
            dynamic=self.dynamic,
        )

    def start(self, problem):
        return State(problem.assembly.design_pose()), self._report(0.0)

    def contacts(self, state):
        none = np.zeros(0)
        number = np.zeros(0, np.int64)
        return ContactForces(
            block_a=number, block_b=number, position=np.zeros((0, 2)), normal=np.zeros((0, 2)),
            gap=none, area=none, normal_reaction=none, tangential_reaction=np.zeros((0, 1)),
            status=number,
        )  # fmt: skip

    def step(self, state, demand):
        if demand.increment is None:
            reached = 0.01 * demand.multiplier
        else:
            reached = state.reached + demand.increment
        return State(state.pose, reached), self._report(reached)


def trace(residuals, **options):
    return pushover(stack((0.4, 0.9)), engine=Stub(residuals, **options), max_steps=200)


def good_then(value, n=4):
    yield from [1e-9] * n
    while True:
        yield value


@pytest.mark.parametrize("residual", [7.6, 2e-6, np.inf])
@pytest.mark.parametrize("dynamic", [False, True])
def test_a_residual_above_the_limit_ends_the_run_unfinished(residual, dynamic):
    curve = trace(good_then(residual), dynamic=dynamic)
    assert curve.status == "stopped"
    assert exit_code(curve.status) == UNFINISHED
    assert "residual" in curve.reason and f"{residual:.1e}" in curve.reason
    assert len(curve.points) == 4  # those before, and none of the others
    assert curve.residual.max() <= Stub.capabilities.residual_limit
    assert curve.peak.step == (0 if dynamic else 3)


def test_a_single_bad_step_is_tried_again():
    def once():
        yield from [1e-9] * 4
        yield 1.0
        yield from good_then(1e-9)

    curve = trace(once())
    assert curve.n_steps == 200
    assert curve.residual.max() <= Stub.capabilities.residual_limit


def test_rest_that_is_none_is_refused():
    with pytest.raises(EngineError, match=r"own weight, the step leaves a residual of 2\.6e\+00"):
        trace(good_then(2.6, n=0))


def test_an_engine_that_does_not_say_is_not_judged():
    untold = StepReport(converged=True)
    assert obeyed(untold, None) is untold


def test_a_residual_that_is_no_number_is_none():
    assert not obeyed(StepReport(converged=True), 1e-6).converged


def test_joints_far_too_stiff_for_the_weight():
    """k_n A / W = 1e8 Pa/m x 0.4 m2 / 4e-4 N: the rounding of a gap tells in weights."""
    light = replace(stack((0.4, 0.9)).assembly.blocks[1], unit_weight=1e-3)
    base = stack((0.4, 0.9)).assembly.blocks[0]
    model = make_model(
        [base, light], joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0)
    )
    try:
        curve = pushover(model, engine="equilibrium", max_steps=50)
    except EngineError as error:
        assert "residual" in str(error)
    else:
        assert curve.residual.max() <= 1e-6
