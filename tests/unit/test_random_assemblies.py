"""Engines on assemblies that nobody has thought of: an answer or a sentence, never a crash."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from builders import UNIT_WEIGHT, rectangle
from drystone.analysis import pushover
from drystone.assembly import Block, Corner, JointLaw
from drystone.builders import ModelError, make_model
from drystone.engines.base import UnstableError

ENGINES = ["nscd", "equilibrium"]

MAX_STEPS = 25

corners = st.sampled_from(
    (Corner(), Corner(radius=0.01), Corner(radius=0.02), Corner(chamfer=0.015))
)
frictions = st.sampled_from((0.0, 0.1, 0.3, 0.65, 1.5))
base = Block(
    id="base", vertices=rectangle(-3.0, -0.5, 6.0, 0.5), unit_weight=UNIT_WEIGHT, support=True
)


def block(name, vertices, unit_weight=UNIT_WEIGHT):
    return Block(id=name, vertices=np.array(vertices), unit_weight=unit_weight)


@st.composite
def stacks(draw):
    """Up to five trapezoids of different sizes and weights, each a little beside the last."""
    blocks, x, y = [], 0.0, 0.0
    for i in range(draw(st.integers(1, 5))):
        width, height = draw(st.floats(0.25, 0.8)), draw(st.floats(0.1, 0.5))
        left, right = (width * draw(st.floats(0.0, 0.3)) for _ in range(2))
        x += draw(st.floats(-0.06, 0.06))
        vertices = [
            [x - width / 2, y],
            [x + width / 2, y],
            [x + width / 2 - right, y + height],
            [x - width / 2 + left, y + height],
        ]
        blocks.append(block(f"b{i}", vertices, 10.0 ** draw(st.floats(3.0, 5.0))))
        y += height
    return blocks


@st.composite
def walls(draw):
    """Courses of unequal units that start anywhere, some with gaps between them."""
    blocks = []
    for course in range(draw(st.integers(1, 4))):
        x = -0.6 + draw(st.floats(-0.1, 0.1))
        for unit in range(draw(st.integers(1, 3))):
            width = draw(st.floats(0.25, 0.5))
            blocks.append(block(f"c{course}u{unit}", rectangle(x, 0.2 * course, width, 0.2)))
            x += width + draw(st.sampled_from((0.0, 0.0, 0.013, 0.05)))
    return blocks


@st.composite
def wedges(draw):
    """A panel cut by slanting joints, which press the pieces apart."""
    height = draw(st.floats(0.2, 0.8))
    cuts = np.cumsum([-0.8] + [draw(st.floats(0.25, 0.6)) for _ in range(draw(st.integers(1, 4)))])
    slant = np.array([draw(st.floats(-0.08, 0.08)) for _ in cuts])
    foot, head = cuts - slant, cuts + slant
    return [
        block(
            f"w{i}", [[foot[i], 0.0], [foot[i + 1], 0.0], [head[i + 1], height], [head[i], height]]
        )
        for i in range(len(cuts) - 1)
    ]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("strategy", ["displacement", "published"])
@given(
    blocks=st.one_of(stacks(), walls(), wedges()),
    corner=corners,
    friction=frictions,
    log_stiffness=st.floats(7.0, 10.0),
    direction=st.tuples(st.sampled_from((-1.0, 1.0)), st.floats(-0.3, 0.3)),
)
@settings(max_examples=100)
def test_random_assemblies(engine, strategy, blocks, corner, friction, log_stiffness, direction):
    law = JointLaw(
        friction_coefficient=friction,
        normal_stiffness=10.0**log_stiffness,
        shear_stiffness=1e3 * 10.0**log_stiffness,
    )
    try:
        model = make_model(
            [base, *blocks], joint=law, corner=corner, thickness=1.0, load_direction=direction
        )
    except ModelError:
        assume(False)  # a block that hangs in the air, or a corner too large for it
    try:
        curve = pushover(model, engine=engine, strategy=strategy, max_steps=MAX_STEPS)
    except UnstableError as error:
        assert any(f'"{one.id}"' in str(error) for one in blocks)
        return
    assert curve.reason
    assert curve.residual.max() <= 1e-6
    assert curve.column("friction_violation").max() <= 1e-6
    assert np.all(np.isfinite(curve.load_multiplier))
    assert np.all(np.isfinite(curve.control_displacement))
    # No block goes through another, the least extent being 0.1 m.  Five of the heaviest blocks, 2e5
    # N on a corner of 0.12 m2, close a joint of 1e8 Pa/m by 16 mm.
    if log_stiffness >= 8.0:
        assert curve.column("penetration").max() < 0.02
