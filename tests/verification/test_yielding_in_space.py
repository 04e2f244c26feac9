"""Joints in space that soften, are crushed and close hyperbolically, against closed forms and the
plane; see `test_joint_laws` for the forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import test_joint_laws as in_plane
from test_joint_laws import CLOSURES, STEPS, STRENGTHS, OnTwoPads, integral, joint, mortar_wall

from drystone.analysis import driver as analysis
from drystone.common.tolerances import BALANCE
from drystone.model.builders import extruded
from solids import UNIT_WEIGHT, box, model_of, one_block


def pushover(model, **options):
    return analysis.pushover(model, engine="equilibrium", **options)


def resting(size, law, push, **values):
    """A block (3,) [m] on a wide base."""
    low = [-1.0, -1.0, -0.5]
    base = box("base", low, [size[0] + 1.0, size[1] + 1.0, 0.0], support=True)
    return model_of([base, box("block", (0, 0, 0), size)], law, push=push, **values)


class TestTension:
    """A block is pulled off its base by (lambda - 1) W = f_t(k) A, k what it was torn by."""

    size = (1.0, 0.8, 0.5)
    area, weight = 0.8, UNIT_WEIGHT * 0.4
    strength, energy, stiffness = 1e5, 20.0, 1e11

    @pytest.mark.parametrize("step", [1e-4, 5e-5])
    def test_what_it_carries_and_releases(self, step):
        law = joint(
            0.6,
            self.stiffness,
            cohesion=4e5,
            tensile_strength=self.strength,
            tensile_fracture_energy=self.energy,
            shear_fracture_energy=200.0,
        )
        model = resting(self.size, law, (0.0, 0.0, 1.0))
        curve = pushover(model, displacement_step=step, max_displacement=4.1e-3)
        force = (curve.column("load_multiplier") - 1.0) * self.weight
        most, soft = self.strength * self.area, self.stiffness * self.area
        # Displacements are counted from where its weight has pressed it to.
        opened = curve.column("control_displacement") - self.weight / soft - force / soft
        # What a step may hide of a peak is 2e-4 of it.
        assert force.max() == pytest.approx(most, rel=3e-4)
        torn = opened > 0.0
        left = np.exp(-self.strength * opened[torn] / self.energy)
        # Strengths converge to 1e-6 of the weight, a share of the solutions before at a time.
        assert force[torn] == pytest.approx(most * left, abs=1e-4 * most)
        places, forces = np.append(0.0, opened[torn]), np.append(most, force[torn])
        assert opened[-1] > 4e-3  # all but exp(-20)
        assert integral(forces, places) == pytest.approx(self.energy * self.area, rel=1e-3)


class TestShear:
    """A flat block is pushed off its base, askew: T = mu(k) W + c(k) A, k what has slid."""

    size, friction, residual = (4.0, 3.0, 0.05), 0.6, 0.4
    stiffness, cohesion, energy = 1e10, 2e3, 1.0
    area, weight = 12.0, UNIT_WEIGHT * 0.6
    way = (np.cos(0.5), np.sin(0.5), 0.0)

    def trace(self, step, **values):
        law = joint(self.friction, self.stiffness, **values)
        model = resting(self.size, law, self.way)
        curve = pushover(model, displacement_step=step, max_displacement=8e-3, keep_poses=True)
        force = curve.column("load_multiplier") * self.weight
        slid = curve.column("control_displacement") - force / (self.stiffness * self.area)
        return curve, force, slid

    @pytest.mark.parametrize("step", STEPS)
    def test_cohesion_and_friction(self, step):
        curve, force, slid = self.trace(
            step,
            cohesion=self.cohesion,
            shear_fracture_energy=self.energy,
            residual_friction_coefficient=self.residual,
        )
        left = np.exp(-self.cohesion * slid / self.energy)
        friction = self.residual + (self.friction - self.residual) * left
        expected = friction * self.weight + self.cohesion * self.area * left
        later = slid > 1e-6
        assert np.count_nonzero(later) > 10
        # Cohesion and friction of four points each converge to 1e-6 of the weight.
        assert force[later] == pytest.approx(expected[later], abs=8e-6 * self.weight)
        peak = self.friction * self.weight + self.cohesion * self.area
        # What a step may hide of a peak is 2e-4 of it.
        assert curve.peak.load_multiplier * self.weight == pytest.approx(peak, rel=3e-4)
        path = curve.poses[-1][1, :3] - curve.poses[0][1, :3]
        assert abs(np.cross(path, self.way)[2]) < 1e-6 * np.linalg.norm(path)

    def test_what_is_released(self):
        _, force, slid = self.trace(5e-5, cohesion=self.cohesion, shear_fracture_energy=self.energy)
        later = slid > 0.0
        most = self.friction * self.weight + self.cohesion * self.area
        found = integral(np.append(most, force[later]), np.append(0.0, slid[later]))
        found -= self.friction * self.weight * slid[-1]
        assert found == pytest.approx(self.energy * self.area, rel=1e-3)

    def test_friction_over_a_slip(self):
        length = 5e-4
        _, force, slid = self.trace(
            1e-4, residual_friction_coefficient=self.residual, residual_slip=length
        )
        later = slid > 1e-6
        friction = self.residual + (self.friction - self.residual) * np.exp(-slid / length)
        assert force[later] == pytest.approx(self.weight * friction[later], rel=1e-5)


class InSpace(OnTwoPads):
    """The same with a depth of one metre, on four points a pad."""

    def trace(self, left, right, direction, step, **options):
        model = extruded(self.model(left, right, direction))
        return pushover(model, displacement_step=step, stop_multiplier=1e-3, **options)


class TestBending:
    """The left of two pads is glued, and torn off by turning the block about the right one."""

    pads, plane = InSpace(), in_plane.TestTensionAndBending()

    @pytest.mark.parametrize("step", STEPS)
    def test_the_peak_and_the_branch(self, step):
        plane = self.plane
        curve = self.pads.trace(plane.left, joint(), (1.0, 0.0), step, max_displacement=4e-3)
        peak = self.pads.multipliers(np.linspace(4e-6, 6e-6, 400), plane.pull).max()
        assert curve.peak.load_multiplier == pytest.approx(peak, rel=3e-4)
        moved, found = curve.column("control_displacement"), curve.column("load_multiplier")
        turns = np.linspace(5e-5, 3e-3, 200)
        expected = self.pads.multipliers(turns, plane.pull)
        place = 0.5 * (1.0 - np.cos(turns)) + np.sin(turns)
        later = (moved > 2e-4) & (moved < 2e-3)
        # As in the plane: the joints are sheared by 1e-6 m, at a slope of 3e3 1/m.
        assert found[later] == pytest.approx(np.interp(moved[later], place, expected), abs=3e-3)

    def test_a_pad_that_is_crushed_carries_what_it_does_in_the_plane(self):
        weak = joint(compressive_strength=3e5, compressive_fracture_energy=60.0)
        peaks = [
            pads.trace(
                weak, joint(), (0.0, -1.0), 1e-5, max_displacement=1.5e-4
            ).peak.load_multiplier
            for pads in (self.pads, OnTwoPads())
        ]
        assert peaks[0] == pytest.approx(peaks[1], rel=1e-6)


class TestToe:
    """`TestCrushing` of the plane, 0.7 m deep on a grid of 17 by 17 points."""

    plane, depth, n, crushed = in_plane.TestCrushing(), 0.7, 17, 0.15

    def trace(self, law, points, push=(1.0, 0.0, 0.0), **options):
        model = resting((self.plane.width, self.depth, self.plane.height), law, push, points=points)
        options = {"displacement_step": 2e-3, "max_displacement": 0.1, **options}
        return pushover(model, **options)

    @pytest.mark.parametrize("step", [2e-3, 1e-3, 4e-3])
    def test_the_branch(self, step):
        plane = self.plane
        strength = plane.weight / self.crushed  # of both per metre of depth
        law = joint(1.0, 1e11, compressive_strength=strength)
        curve = self.trace(law, self.n**2, displacement_step=step)
        slender, between = plane.width / plane.height, plane.width / (self.n - 1)
        error = between**2 / (8.0 * self.crushed) / plane.height
        peak = (plane.width - self.crushed) / plane.height
        assert curve.peak.load_multiplier == pytest.approx(peak, abs=2.0 * error + 1e-3 * slender)
        moved, found = curve.column("control_displacement"), curve.column("load_multiplier")
        later = moved > 2e-2
        branch = plane.expected(moved[later], self.crushed)
        assert found[later] == pytest.approx(branch, abs=2.0 * error + 6e-3 * slender)
        assert curve.points[-1].penetration < 1e-4 * plane.width  # what is crushed is none

    def test_where_nothing_is_said_it_has_as_many_points_along_an_edge(self):
        law = joint(1.0, 1e11, compressive_strength=self.plane.weight / 0.2)
        size = self.plane.width, self.depth, self.plane.height
        assert resting(size, law, (1.0, 0.0, 0.0), points=None).assembly.points == 81
        peak = self.trace(law, None, max_displacement=0.02).peak.load_multiplier
        exact = (self.plane.width - 0.2) / self.plane.height
        above = 2.0 * (self.plane.width / 8.0) ** 2 / (8.0 * 0.2) / self.plane.height
        assert exact * (1.0 - 4e-3) <= peak <= exact + above

    def test_a_strong_one_is_dry(self):
        """Both balance to `BALANCE` of the weight, in different ways.  At a multiplier of one the
        load is the weight."""
        strong = self.trace(joint(1.0, 1e11, compressive_strength=1e13), 4)
        dry = self.trace(joint(1.0, 1e11), 4)
        for name, off in (("control_displacement", 1e-12), ("load_multiplier", 2.0 * BALANCE)):
            assert strong.column(name) == pytest.approx(dry.column(name), rel=1e-9, abs=off)

    def test_pushed_askew_it_carries_less_than_a_dry_one(self):
        """On the corner both toes are crushed; with a softening joint it carries less again."""
        strength = self.plane.weight / self.crushed
        askew = (np.cos(0.4), np.sin(0.4), 0.0)
        laws = [
            joint(1.0, 1e11),
            joint(1.0, 1e11, compressive_strength=strength),
            joint(1.0, 1e11, compressive_strength=strength, compressive_fracture_energy=1e3),
        ]
        peaks = [
            self.trace(law, 81, askew, max_displacement=0.02).peak.load_multiplier for law in laws
        ]
        assert peaks[0] > 1.1 * peaks[1] > 1.1 * peaks[2]


@pytest.mark.parametrize("key", CLOSURES)
@pytest.mark.parametrize("step", [2e-4, 1e-4])
def test_closure_that_is_not_linear(key, step):
    """As in the plane."""
    size, stiffness, length = (1.0, 0.8, 0.2), 1e7, 1e-3
    law = joint(0.6, stiffness, **{key: length})
    model = resting(size, law, (0.0, 0.0, -1.0))
    curve = pushover(model, displacement_step=step, max_displacement=6e-4)
    pressure = (1.0 + curve.column("load_multiplier")) * UNIT_WEIGHT * size[2]
    closed = CLOSURES[key](pressure, stiffness, length)
    moved = curve.column("control_displacement") + closed[0]
    assert moved == pytest.approx(closed, rel=1e-6)
    assert len(curve.points) > 3


def test_laws_that_say_nothing_leave_the_dry_curve():
    """Residual friction as high as the other, over a slip: the way of joints that soften, and the
    solutions of dry ones."""
    model = one_block(0.4, 0.6, 0.9, stiffness=1e10, angle=30.0)
    assembly = model.assembly
    law = replace(assembly.joint, residual_friction_coefficient=0.7, residual_slip=1e-3)
    assert law.friction_coefficient == 0.7
    curves = [
        pushover(m, max_displacement=0.05)
        for m in (model, replace(model, assembly=replace(assembly, joint=law)))
    ]
    for name in ("control_displacement", "load_multiplier"):
        assert curves[1].column(name) == pytest.approx(curves[0].column(name), rel=1e-9, abs=1e-12)


@pytest.mark.slow
def test_a_wall_in_mortar_carries_what_it_does_in_the_plane_on_any_step():
    model = mortar_wall(**STRENGTHS)
    peaks = [
        pushover(extruded(model), displacement_step=step, max_displacement=6e-4).peak
        for step in STEPS
    ]
    found = [peak.load_multiplier for peak in peaks]
    assert np.ptp(found) <= 1e-3 * max(found)
    plane = pushover(model, displacement_step=STEPS[0], max_displacement=6e-4).peak
    assert found[0] == pytest.approx(plane.load_multiplier, rel=1e-3)
