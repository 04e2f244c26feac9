"""A path of equilibria that turns back before the peak hides neither the peak nor the collapse."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from drystone.limit import on_what_moves
from random_kinds import KINDS

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_the_peak_is_the_same_wherever_the_path_turns_back():
    """Of a rubble wall whose control point, on stone "s9", turns back at a third of the peak.

    No equilibrium is found there with a displacement prescribed, and what followed in motion was a
    collapse under 0.066.  2e-3: the peak of each curve is known to 2e-4, and each depends a little
    on where joints began to slide.
    """
    model = KINDS["rubble-plane"](2001).with_load(ds.TriangularPattern(direction=(1.0, 0.0)))
    known = ds.pushover(on_what_moves(model), max_points=60).peak.load_multiplier
    curve = ds.pushover(model.with_control(block="s9"), max_points=60)
    assert curve.capacity.load_multiplier == pytest.approx(known, rel=2e-3)
    rising = [p for p in curve.points if p.load_multiplier <= curve.capacity.load_multiplier][:20]
    assert all(point.status == "static" for point in rising)


@pytest.mark.parametrize("stone", ["s4", "s9", "s15"])
def test_the_load_grows_on_where_no_displacement_ahead_has_an_equilibrium(stone):
    """Whichever stone is watched, the wall bears the same.

    Followed in motion from where the stone turns back, the wall fell at 0.22, 0.14 and 0.26.
    """
    model = KINDS["rubble-plane"](1016)
    known = ds.pushover(on_what_moves(model), falling="stop").capacity.load_multiplier
    curve = ds.pushover(model.with_control(block=stone), falling="stop")
    assert curve.capacity.load_multiplier == pytest.approx(known, rel=1e-3)


def test_a_history_holds_its_displacement_where_the_path_turns_back():
    """The gate's path turns back at 0.39 mm: in each leg the control point goes one way alone."""
    targets = [0.002, -0.002]
    model = ds.read_model(EXAMPLES / "gate.toml").with_history(targets)
    displacement = ds.pushover(model).control_displacement
    turn = int(displacement.argmax())
    assert displacement[turn] == pytest.approx(targets[0], abs=1e-9)
    assert np.all(np.diff(displacement[: turn + 1]) > 0.0)
    assert np.all(np.diff(displacement[turn:]) < 0.0)
