"""How analyses begin and end, over all engines: settlement, joints crushed, blocks that leave."""

from __future__ import annotations

import numpy as np
import pytest

from builders import PUBLISHED_JOINT, UNIT_WEIGHT, rectangle
from drystone.analysis import pushover
from drystone.assembly import Block
from drystone.builders import make_model

ENGINES = pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])


def leaning():
    """A block that leans over by 0.1 m along the load, so that it settles along it."""
    outline = np.array([[-0.2, 0.0], [0.2, 0.0], [0.3, 0.9], [-0.1, 0.9]])
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 2, 1), unit_weight=UNIT_WEIGHT, support=True),
        Block(id="leaning", vertices=outline, unit_weight=UNIT_WEIGHT),
    ]
    return make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))


@ENGINES
def test_curves_begin_where_the_load_does(engine):
    """With the weight W off the middle by e, two contact points b apart close by W/2 (1 -+ 2e/b)
    over k_n b/2 each, which turns the block by 4 W e / (k_n b^3)."""
    curve = pushover(leaning(), engine=engine, max_steps=3, keep_poses=True)
    weight, e, b, height = 0.4 * 0.9 * UNIT_WEIGHT, 0.05, 0.4, 0.9
    turn = 4.0 * weight * e / (PUBLISHED_JOINT.normal_stiffness * b**3)
    # The turned block's weight acts 5e-5 m further out, 1e-3 of e; nscd stops settling a thousandth
    # of the closing short of rest.
    assert curve.settlement == pytest.approx(height * turn, rel=5e-3)
    assert curve.control_displacement[0] == 0.0
    assert curve.load_multiplier[0] == pytest.approx(0.0, abs=1e-3)
    # Poses stay those from the designed places.
    assert curve.poses[0][1, 2] == pytest.approx(-turn, rel=5e-3)
    model = leaning()
    moved = [model.control_point.displacement(model.assembly, pose) for pose in curve.poses]
    assert curve.control_displacement == pytest.approx(
        np.array(moved) - curve.settlement, abs=1e-15
    )


@ENGINES
def test_the_largest_displacement_counts_from_where_the_load_begins(engine):
    settlement = pushover(leaning(), engine=engine, max_steps=1).settlement
    curve = pushover(leaning(), engine=engine, max_displacement=5.0 * settlement)
    assert curve.status == "finished"
    last = curve.control_displacement[-2:]
    assert last[0] < 5.0 * settlement <= last[1]
