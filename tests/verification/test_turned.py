"""Nothing changes when a whole model is turned and moved, gravity with it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drystone.analysis import pushover
from drystone.assembly import Corner
from solids import leaf, one_block, turned

TURN = Rotation.from_rotvec([0.4, -0.9, 1.3])
SHIFT = (12.0, -7.0, 3.0)

MODELS = {
    "block": lambda: one_block(angle=30.0),
    "rounded": lambda: one_block(angle=30.0, corner=Corner(radius=0.02)),
    "leaf": lambda: leaf(length=0.8, courses=3, stiffness=1e9),
}


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("engine", ["nscd", "distinct"])
def test_a_turned_model_has_the_same_curve(name, engine):
    """To 1e-9 of the peak where `nscd` solves to rounding; `distinct` rests to 1e-5 of a weight."""
    model = MODELS[name]()
    first = pushover(model, engine=engine, max_steps=40)
    second = pushover(turned(model, TURN, SHIFT), engine=engine, max_steps=40)
    assert len(first.points) == len(second.points)
    peak = first.peak.load_multiplier
    off = np.abs(first.load_multiplier - second.load_multiplier).max()
    moved = np.abs(first.control_displacement - second.control_displacement).max()
    print(name, engine, peak, off / peak, moved)
    assert off <= 1e-9 * peak
