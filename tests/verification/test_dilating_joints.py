"""A plate that slides on a joint that dilates: friction carries it until it comes to the edge."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from drystone.model.builders import extruded

LENGTH, HEIGHT, FRICTION, ANGLE = 0.5, 0.05, 0.6, 10.0


def plate(chip=False):
    """Once it has slid by a quarter of its length, it has risen by more than a third of its
    height; a ``chip`` that stands apart is the smallest block."""

    def box(name, x, z, length, height, **more):
        outline = np.array([(x, z), (x + length, z), (x + length, z + height), (x, z + height)])
        return ds.Block(id=name, vertices=outline, unit_weight=2e4, **more)

    blocks = [box("ground", -1.0, -0.2, 3.5, 0.2, support=True), box("plate", 0, 0, LENGTH, HEIGHT)]
    if chip:
        blocks.append(box("chip", -0.5, 0.0, 0.02, 0.01))
    joint = ds.JointLaw(
        friction_coefficient=FRICTION,
        normal_stiffness=1e9,
        shear_stiffness=1e9,
        dilatancy_angle=ANGLE,
    )
    model = ds.make_model(blocks, joint=joint, thickness=1.0, load_direction=(1.0, 0.0))
    return model.with_control(block="plate")


@pytest.mark.parametrize(
    ("engine", "chip", "space"),
    [
        ("equilibrium", False, False),
        ("equilibrium", True, False),
        ("equilibrium", False, True),
        pytest.param("distinct", False, False, marks=pytest.mark.slow),
    ],
)
def test_it_rises_and_carries_on(engine, chip, space):
    """It rises by the tangent of the angle times its slide, which counts up to its own length."""
    model = extruded(plate(chip)) if space else plate(chip)
    curve = ds.pushover(
        model, engine=engine, displacement_step=0.002, max_points=600, keep_poses=True
    )
    slid, steady = curve.control_displacement, curve.control_displacement > 0.005
    assert slid[-1] > 1.1 * LENGTH
    carried = np.array([point.load_multiplier for point in curve.points])
    assert carried[steady] == pytest.approx(FRICTION, rel=1e-3)
    row = model.assembly.index("plate")
    risen = curve.poses[:, row, model.assembly.dimension - 1]
    expected = np.tan(np.radians(ANGLE)) * np.minimum(slid, model.assembly.longest_slide)
    assert risen == pytest.approx(expected, abs=1e-3 * LENGTH)
