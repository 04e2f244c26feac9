"""A plate that slides on a joint that dilates: friction carries it until it comes to the edge."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from builders import UNIT_WEIGHT, stack
from drystone.limit import ASSOCIATIVE, collapse_load
from drystone.model.builders import extruded
from random_kinds import KINDS

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


class TestWhereDilatancyEnds:
    """A block of 0.8 x 0.5 m under a long spring: it rises by end tan(psi), however far it goes on.

    The step in which the slip reaches the end is cut there, whatever its length.
    """

    END, STIFFNESS, WIDTH, BLOCK = 0.003, 1e7, 0.8, 0.5  # m, N/m, m, m

    def model(self, *, spring):
        joint = ds.JointLaw(
            friction_coefficient=FRICTION,
            normal_stiffness=1e10,
            shear_stiffness=1e10,
            dilatancy_angle=ANGLE,
            dilatancy_end=self.END,
        )
        held = ds.spring(
            start=ds.TieEnd(block="b1", point=np.array([0.0, 0.25])),
            end=ds.TieEnd(point=np.array([0.0, 300.0])),
            stiffness=self.STIFFNESS,
        )
        ties = (held,) if spring else ()
        return stack((self.WIDTH, self.BLOCK), joint=joint, ties=ties)

    @pytest.mark.parametrize("space", [False, True])
    @pytest.mark.parametrize("step", [None, 2e-3, 5e-4])
    def test_it_rises_no_more(self, step, space):
        model = self.model(spring=False)
        options = {} if step is None else {"displacement_step": step}
        curve = ds.pushover(
            extruded(model) if space else model, max_displacement=0.02, keep_poses=True, **options
        )
        risen = curve.poses[-1, 1, 2 if space else 1] - curve.poses[0, 1, 2 if space else 1]
        # The joint closes by W / (k_n A) under its weight, and by that still where it has risen.
        assert risen == pytest.approx(self.END * np.tan(np.radians(ANGLE)), rel=1e-3)
        assert curve.load_multiplier.max() == pytest.approx(FRICTION, rel=1e-4)
        assert curve.load_multiplier[-1] == pytest.approx(FRICTION, rel=1e-4)

    @pytest.mark.parametrize(
        ("engine", "space"), [("equilibrium", False), ("equilibrium", True), ("distinct", False)]
    )
    def test_a_spring_above_it_is_stretched_no_more(self, engine, space):
        model = self.model(spring=True)
        curve = ds.pushover(
            extruded(model) if space else model, engine=engine, max_displacement=0.02
        )
        weight = UNIT_WEIGHT * self.WIDTH * self.BLOCK
        force = self.STIFFNESS * self.END * np.tan(np.radians(ANGLE))
        # The joint closes by the spring's force over k_n A = 8e9 N/m: 1e7 / 8e9 of the lift.
        assert curve.load_multiplier.max() == pytest.approx(
            FRICTION * (weight + force) / weight, rel=2e-3
        )
        assert curve.load_multiplier[-1] == pytest.approx(curve.load_multiplier.max(), rel=2e-3)


def test_a_stiff_arch_in_space_carries_the_associative_multiplier():
    """Its joints dilate as much as they rub.  Normal reactions are small differences of trial
    reactions and lifts, so that a search that mistakes one of the two does not come to rest."""
    arch = KINDS["arch"](1001)
    angle = np.degrees(np.arctan(arch.assembly.joint.friction_coefficient))
    model = arch.with_joint(dilatancy_angle=angle, normal_stiffness=1e12, shear_stiffness=1e12)
    curve = ds.pushover(model, engine="equilibrium")
    assert curve.status == "finished"
    assert all(point.status != "dynamic" for point in curve.points)
    bound = collapse_load(model, flow=ASSOCIATIVE).load_multiplier
    assert curve.peak.load_multiplier == pytest.approx(bound, rel=5e-4)
