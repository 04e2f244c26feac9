"""Blocks that rollers hold in some directions: a carriage on a spring, with a block upon it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import drystone as ds

UNIT_WEIGHT, THICKNESS, STIFFNESS = 20e3, 0.5, 1e6  # N/m3, m, N/m
CARRIAGE, LOAD = 0.8 * 0.2 * 1e4, 0.3 * 0.9 * 1e4  # N


def box(name, x, z, width, height, **more):
    corners = [(x, z), (x + width, z), (x + width, z + height), (x, z + height)]
    return ds.Block(id=name, vertices=np.array(corners), unit_weight=UNIT_WEIGHT, **more)


def carriage(held=("y", "turn"), **more):
    """Free to roll, held by a spring to the ground, with a slender block on it."""
    spring = ds.spring(
        start=ds.TieEnd(point=np.array([-1.0, 0.1])),
        end=ds.TieEnd(block="carriage", point=np.array([0.0, 0.1])),
        stiffness=STIFFNESS,
    )
    return ds.make_model(
        [
            box("ground", -2.0, -1.5, 4.0, 1.0, support=True),
            box("carriage", 0.0, 0.0, 0.8, 0.2, held=held),
            box("b", 0.25, 0.2, 0.3, 0.9),
        ],
        joint=ds.JointLaw(friction_coefficient=2.0, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=THICKNESS,
        load_direction=[1.0, 0.0],
        ties=(spring,),
        **more,
    )


@pytest.mark.parametrize(
    ("engine", "exact"),
    # A thousandth of the rounding of rest; first order in the step.
    [("equilibrium", 1e-6), ("nscd", 2e-2)],
)
@pytest.mark.parametrize("space", [False, True])
def test_carriage_goes_as_far_as_its_spring_lets_it(engine, exact, space):
    """It moves by lambda (W_1 + W_2) / k, and not at all where it is held."""
    model = ds.extruded(carriage()) if space else carriage()
    curve = ds.pushover(model, engine=engine, keep_poses=True, max_displacement=0.02)
    assert len(curve.points) > 5
    for point, pose in zip(curve.points, curve.poses, strict=True):
        rolled = pose[1, 0]
        if point.status == "static":
            wanted = point.load_multiplier * (CARRIAGE + LOAD) / STIFFNESS
            assert rolled == pytest.approx(wanted, abs=exact * 0.005)
        rest = pose[1].copy()
        rest[0] = 0.0
        rest[3:4] -= 1.0 if space else 0.0  # the quaternion of no rotation
        assert np.abs(rest).max() < 1e-7
        assert point.carried_multiplier == pytest.approx(point.load_multiplier, abs=0.02)
    # The block overturns on it at b/h, but for what the joint and the carriage's tilt take.
    assert curve.peak.load_multiplier == pytest.approx(0.3 / 0.9, rel=2e-3)


@pytest.mark.parametrize("space", [False, True])
def test_limit_analysis(space):
    model = ds.extruded(carriage()) if space else carriage()
    found = ds.collapse_load(model)
    assert found.load_multiplier == pytest.approx(0.3 / 0.9, rel=1e-7)
    assert found.tie_forces.shape == (1,)


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
@pytest.mark.parametrize("held", [("turn",), ("y", "turn")])
def test_limit_analysis_of_a_slender_block_that_cannot_turn(held, flow):
    """Held as a couple it slides at 0.7, where it would overturn at 0.25; in space y is across."""
    outline = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 2.0], [0.0, 2.0]])
    base = np.array([[-1.0, -0.2], [2.0, -0.2], [2.0, 0.0], [-1.0, 0.0]])
    model = ds.make_model(
        [
            ds.Block(id="base", vertices=base, unit_weight=2e4, support=True),
            ds.Block(id="b", vertices=outline, unit_weight=2e4, held=("turn",)),
        ],
        joint=ds.JointLaw(friction_coefficient=0.7, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=0.5,
        load_direction=[1.0, 0.0],
    )
    if held != ("turn",):
        solid = ds.extruded(model)
        blocks = [replace(b, held=held if b.id == "b" else b.held) for b in solid.assembly.blocks]
        model = ds.make_model(blocks, joint=solid.assembly.joint, load_direction=[1.0, 0.0, 0.0])
    found = ds.collapse_load(model, flow=flow)
    assert found.load_multiplier == pytest.approx(0.7, rel=1e-7)


def test_through_the_file(tmp_path):
    ds.write_model(carriage(), tmp_path / "m.toml")
    again = ds.read_model(tmp_path / "m.toml")
    assert again.assembly.blocks[1].held == ("y", "turn")
    assert np.array_equal(again.assembly.restrained, carriage().assembly.restrained)


@pytest.mark.parametrize(
    ("held", "sentence"),
    [(("z",), 'there is no motion "z"'), (("x", "y", "turn"), "set support alone")],
)
def test_what_no_roller_holds(held, sentence):
    with pytest.raises(ds.ModelError, match=sentence):
        carriage(held=held)


def test_distinct_says_that_it_has_none():
    with pytest.raises(ds.EngineError, match="has no rollers"):
        ds.pushover(carriage(), engine="distinct")


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("stiffness", [1e9, 1e11, 1e13])
def test_a_roller_beside_a_joint_bears_what_it_bore(stiffness, space):
    """Rollers hold the block before the joint below it is pressed: nothing resists sliding.

    What is held does not creep into a stiff joint, step by step.  Then friction would grow.
    """
    model = ds.make_model(
        [
            box("ground", -1.0, -0.5, 3.0, 0.5, support=True),
            box("b", 0.0, 0.0, 1.0, 0.5, held=("y", "turn")),
        ],
        joint=ds.JointLaw(
            friction_coefficient=0.6, normal_stiffness=stiffness, shear_stiffness=stiffness
        ),
        thickness=THICKNESS,
        load_direction=[1.0, 0.0],
    )
    curve = ds.pushover(ds.extruded(model) if space else model, max_displacement=0.05)
    assert curve.status == "finished"
    assert len(curve.points) > 20
    assert max(abs(p.load_multiplier) for p in curve.points) < 1e-4


def held_block(held, width=0.4, height=1.2):
    """A block on the ground under a load along x."""
    return ds.make_model(
        [
            box("ground", -2.0, -0.5, 4.0, 0.5, support=True),
            box("b", 0.0, 0.0, width, height, held=held),
        ],
        joint=ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=THICKNESS,
        load_direction=[1.0, 0.0],
    )


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("held", [("x",), ("x", "turn")])
def test_a_load_against_rollers_locks(held, space):
    """It was pushed through them, by 2 cm under 3e13 times its weight, and that was "finished"."""
    model = ds.extruded(held_block(held)) if space else held_block(held)
    curve = ds.pushover(model, max_displacement=0.02)
    assert curve.status == "stopped"
    assert "the load locks the structure" in curve.reason
    assert ds.collapse_load(model, flow="associative").status == "locked"


@pytest.mark.parametrize("engine", ["equilibrium", "nscd"])
def test_a_block_rocks_between_rollers_across_the_load(engine):
    """lambda = b / h; the mass that holds it is no measure of what the control point resists."""
    solid = ds.extruded(held_block(()))
    blocks = [replace(b, held=("y",) if b.id == "b" else ()) for b in solid.assembly.blocks]
    model = ds.make_model(blocks, joint=solid.assembly.joint, load_direction=[1.0, 0.0, 0.0])
    curve = ds.pushover(model, engine=engine)
    assert curve.status == "finished"
    assert curve.peak.load_multiplier == pytest.approx(1.0 / 3.0, rel=5e-3)
    assert curve.ultimate_displacement == pytest.approx(0.4, rel=0.1)
