"""Nothing changes when a whole model is turned and moved, gravity with it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from builders import stack
from drystone.analysis.driver import pushover
from drystone.model.assembly import Corner
from solids import from_boxes, leaf, one_block, turned

TURN = Rotation.from_rotvec([0.4, -0.9, 1.3])
SHIFT = (12.0, -7.0, 3.0)

MODELS = {
    "block": lambda: one_block(angle=30.0),
    "rounded": lambda: one_block(angle=30.0, corner=Corner(radius=0.02)),
    "leaf": lambda: leaf(length=0.8, courses=3, stiffness=1e9),
}


#: Of the peak, and of every point, over the peak.  Roundings differ, and with them the sweep or the
#: cycle after which a step is near enough to its rest: `distinct` rests to 1e-5 of a weight, and
#: `nscd` is satisfied with 5e-7 of it, of which a leaf shows 4e-8.  `equilibrium` is satisfied with
#: 1e-9 on each block.  The multiplier is off by these forces times the blocks' motions, over the
#: weights times their horizontal motions.  A leaf that rocks moves at most as far up as to the
#: side, so that two curves are apart by 4e-9, or 1.3e-8 of a peak of 0.3.
SAME = {"nscd": (1e-7, 1e-7), "distinct": (2e-6, 5e-6), "equilibrium": (1e-9, 1.3e-8)}


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


FACADE = Path(__file__).parents[1] / "cases" / "solids" / "facade_2.4m.toml"


def test_a_facade_in_another_place_has_the_same_curve():
    """92 blocks, to 0.03 m, where no step jumps: 1e-9 of the peak at every point.

    Units of its returns meet others in single points, where three faces separate them as well as
    each other; which of them counts is no matter of axes.
    """
    model = from_boxes(FACADE, push=(0.0, -1.0, 0.0))
    other = turned(model, TURN, SHIFT)
    curves = [pushover(m, engine="equilibrium", max_displacement=0.03) for m in (model, other)]
    first, second = (curve.load_multiplier for curve in curves)
    assert len(first) == len(second)
    assert not any(point.jumped for curve in curves for point in curve.points)
    assert np.abs(first - second).max() <= 1e-9 * first.max()


@pytest.mark.parametrize("push", [(0.0, 1.0, 0.0), (1.0, 0.0, 0.0)])
def test_joints_that_carry_nothing_do_not_decide_how_long_steps_are(push):
    """The head joints of the facade carry nothing at first: whether they are just open or just
    closed is rounding, and differs where all is turned."""
    model = from_boxes(FACADE, push=push)
    models = (model, turned(model, TURN), turned(model, TURN.inv()))
    first, *others = (pushover(m, engine="equilibrium", max_displacement=5e-5) for m in models)
    assert len(first.points) > 3
    for other in others:
        assert len(other.points) == len(first.points)
        assert other.control_displacement == pytest.approx(first.control_displacement, rel=1e-6)


def test_the_extent_of_a_block_turns_with_it():
    """In the plane it was a side of the box along the axes; see `geometry.figure`."""
    upright = stack((0.4, 0.1), (0.3, 0.05)).assembly
    for tilt in (0.1, 0.5, 1.2):
        assembly = stack((0.4, 0.1), (0.3, 0.05), tilt=tilt).assembly
        np.testing.assert_allclose(assembly.extents, upright.extents, rtol=1e-12)
    np.testing.assert_allclose(upright.extents[1:], [0.1, 0.05], rtol=1e-12)
