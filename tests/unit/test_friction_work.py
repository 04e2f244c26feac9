"""What a step of contact dynamics tells of its static multiplier, where joints slide or turn."""

from types import SimpleNamespace

import numpy as np
import pytest

from drystone.dynamics.nscd import NscdEngine
from drystone.engines.base import Demand, Problem
from drystone.engines.measures import _friction_of
from drystone.verification.blocks import on_base, solid_on_base


def told(model, multiplier):
    """The report of one step from rest under a multiplier, in the model's own frame."""
    engine = NscdEngine()
    problem = Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)
    state, _ = engine.start(problem)
    _, report = engine.step(state, Demand(multiplier=multiplier, time_step=0.05))
    assert report.converged
    return report


@pytest.mark.parametrize("slope", [-0.3, -0.1, 0.2])
def test_the_static_multiplier_does_not_go_with_what_is_applied(slope):
    """A load that presses a sliding joint more raises its friction: what is told stays."""
    model = on_base(1.0, (0.2,), friction=0.5, stiffness=1e9, slope=slope, point="centre")
    exact = np.tan(np.arctan(0.5) - slope)
    for beyond in (0.002, 0.02, 0.1):
        report = told(model, exact + beyond)
        assert report.static_multiplier == pytest.approx(exact, abs=3e-5 * (1.0 + 20.0 * beyond))
        assert report.multiplier_at_start == pytest.approx(exact, abs=3e-5 * (1.0 + 20.0 * beyond))


def test_in_space_friction_is_along_the_slip():
    """Pushed across a level joint nothing presses it; pushed and lifted it bears less."""
    model = solid_on_base((1.0, 1.0, 0.2), np.radians(30.0), friction=0.4, stiffness=1e9)
    report = told(model, 0.45)
    assert report.static_multiplier == pytest.approx(0.4, abs=1e-5)


def test_without_sliding_nothing_is_added():
    """A block that rocks: friction does no work, and the start's multiplier is the arm's."""
    model = on_base(0.4, (0.9,), friction=2.0, stiffness=1e11)
    report = told(model, 0.46)
    assert report.multiplier_at_start == pytest.approx(0.4 / 0.9, abs=1e-5)
    fall = (1.0 + (0.4 / 0.9) ** 2) / 0.9 * report.control_displacement
    assert report.static_multiplier == pytest.approx(0.4 / 0.9 - fall, abs=0.02 * fall + 1e-5)


def test_friction_that_takes_more_than_the_work_of_the_load_counts_for_nothing():
    """Nor does its part of what turns: `nscd` told spikes of 3 % of the peak."""
    sound = SimpleNamespace(friction=(0.5, 0.3, 0.1))
    jammed = SimpleNamespace(friction=(-2.0, 0.3, 0.1))
    assert tuple(_friction_of(sound, push=1.0, least=0.0)) == sound.friction
    assert tuple(_friction_of(jammed, push=1.0, least=0.0)) == (0.0, 0.0, 0.0)
