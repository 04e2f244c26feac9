"""Engines on assemblies that nobody has thought of: an answer or a sentence, never a crash."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from builders import UNIT_WEIGHT, rectangle
from drystone.analysis.driver import pushover
from drystone.engines.base import EngineError, UnstableError
from drystone.model.assembly import Block, Corner
from drystone.model.builders import ModelError, make_model
from drystone.model.joint_law import JointLaw
from drystone.results.curve import STATIC
from drystone.statics.equilibrium import EquilibriumEngine

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


def cut(piece, angle, shift):
    """Both parts of a convex polygon along a line, ``shift`` beside its middle [m]."""
    normal = np.array([np.cos(angle), np.sin(angle)])
    side = (piece - piece.mean(axis=0)) @ normal - shift
    parts = [], []
    for here, there, s, t in zip(
        piece, np.roll(piece, -1, axis=0), side, np.roll(side, -1), strict=True
    ):
        parts[int(s > 0.0)].append(here)
        if s * t < 0.0:
            for part in parts:
                part.append(here + s / (s - t) * (there - here))
    assume(min(len(part) for part in parts) >= 3)
    return [np.array(part) for part in parts]


@st.composite
def rubble(draw):
    """A panel cut along any lines into convex pieces of any shape and weight."""
    width, height = draw(st.floats(0.5, 1.2)), draw(st.floats(0.4, 1.0))
    pieces = [rectangle(-width / 2, 0.0, width, height)]
    for _ in range(draw(st.integers(1, 6))):
        largest = pieces.pop(int(np.argmax([np.ptp(piece, axis=0).max() for piece in pieces])))
        pieces += cut(largest, draw(st.floats(0.0, np.pi)), draw(st.floats(-0.05, 0.05)))
    edges = [np.hypot(*(np.roll(piece, -1, axis=0) - piece).T).min() for piece in pieces]
    assume(min(edges) > 0.03)
    return [
        block(f"p{i}", piece, 10.0 ** draw(st.floats(3.0, 5.0))) for i, piece in enumerate(pieces)
    ]


def model_of(blocks, corner, friction, log_stiffness, direction):
    law = JointLaw(
        friction_coefficient=friction,
        normal_stiffness=10.0**log_stiffness,
        shear_stiffness=1e3 * 10.0**log_stiffness,
    )
    try:
        return make_model(
            [base, *blocks], joint=law, corner=corner, thickness=1.0, load_direction=direction
        )
    except ModelError:
        assume(False)  # a block that hangs in the air, or a corner too large for it


models = st.builds(
    model_of,
    blocks=st.one_of(stacks(), walls(), wedges(), rubble()),
    corner=corners,
    friction=frictions,
    log_stiffness=st.floats(7.0, 10.0),
    direction=st.tuples(st.sampled_from((-1.0, 1.0)), st.floats(-0.3, 0.3)),
)


def check(model, **options):
    """The curve, or None where a sentence says which blocks do not stand."""
    try:
        curve = pushover(model, **options)
    except UnstableError as error:
        movable = [one.id for one in model.assembly.blocks if not one.support]
        assert any(f'"{name}"' in str(error) for name in movable)
        return None
    except EngineError as error:
        # Joints that the weight alone crushes; or that tell no place from another once blocks have
        # slid far, as without friction they do.
        stiff = model.assembly.joint.normal_stiffness >= 1e9
        assert ("too stiff" if stiff else "pressed") in str(error)
        return None
    assert curve.reason
    assert curve.residual.max() <= 1e-6
    assert curve.column("friction_violation").max() <= 1e-6
    assert np.all(np.isfinite(curve.load_multiplier))
    assert np.all(np.isfinite(curve.control_displacement))
    # No block goes through another, the least extent being 0.1 m.  Five of the heaviest blocks, 2e5
    # N on a corner of 0.12 m2, close a joint of 1e8 Pa/m by 16 mm.
    if model.assembly.joint.normal_stiffness >= 1e8:
        assert curve.column("penetration").max() < 0.02
    return curve


@pytest.mark.parametrize("strategy", ["displacement", "published"])
@given(model=models)
@settings(max_examples=40)
def test_nscd(strategy, model):
    check(model, engine="nscd", strategy=strategy, max_steps=MAX_STEPS)


class Counting(EquilibriumEngine):
    """Counts the steps that were tried."""

    tried = 0

    def step(self, state, demand):
        self.tried += 1
        return super().step(state, demand)


def check_equilibrium(model, max_steps):
    """Every static point is in equilibrium, and none is long in coming."""
    engine, assembly = Counting(), model.assembly
    curve = check(model, engine=engine, strategy="displacement", max_steps=max_steps)
    if curve is None:
        return
    static = curve.column("status") == STATIC
    # Gaps are differences of coordinates of metres, with a rounding of 2e-15 m, the more the
    # farther blocks have moved: light ones on the stiffest joints feel it, over 1 m2.
    # Slips are differences of motions within the step, on joints a thousand times as stiff.
    far = max(1.0, np.abs(curve.control_displacement).max())
    normal = far * assembly.joint.normal_stiffness
    sliding = curve.column("motion")[static] * assembly.joint.shear_stiffness
    rounding = 2e-15 * np.maximum(normal, sliding) / assembly.heaviest_weight
    assert np.all(curve.residual[static] <= np.maximum(1e-8, rounding))
    assert curve.column("inertia_ratio")[static].max(initial=0.0) <= 1e-3
    # A step that is tried again is tried with less, until it is too small to try.
    assert engine.tried <= 50 * len(curve.points) + 300


@given(model=models)
@settings(max_examples=50)
def test_equilibrium(model):
    check_equilibrium(model, MAX_STEPS)


@given(model=models)
@settings(max_examples=60)
def test_equilibrium_by_multipliers(model):
    check(model, engine="equilibrium", strategy="published", max_steps=MAX_STEPS)


@pytest.mark.slow
@given(model=models)
@settings(max_examples=500)
def test_equilibrium_to_the_end(model):
    check_equilibrium(model, 600)
