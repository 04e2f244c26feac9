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


#: Of the peak, and of every point, over the peak.  Roundings differ, and with them the sweep or the
#: cycle after which a step is near enough to its rest: `distinct` rests to 1e-5 of a weight.
SAME = {"nscd": (5e-9, 1e-8), "distinct": (2e-6, 5e-6)}


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("engine", SAME)
def test_a_turned_model_has_the_same_curve(name, engine):
    model = MODELS[name]()
    first = pushover(model, engine=engine, max_steps=40)
    second = pushover(turned(model, TURN, SHIFT), engine=engine, max_steps=40)
    assert len(first.points) == len(second.points)
    peak, other = first.peak.load_multiplier, second.peak.load_multiplier
    off = np.abs(first.load_multiplier - second.load_multiplier).max()
    of_peak, of_all = SAME[engine]
    assert other == pytest.approx(peak, rel=of_peak)
    assert off <= of_all * peak
