"""The distinct element engine against closed forms of one block, and its books of energy.

Where the motion is real, damping is off.  The cycles are of second order in the time step: with a
share s of the critical one their error is about s^2 / 2, which is what tolerances are taken from,
beside the closing of the joints that rigid closed forms do not know.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from builders import RockingBlock, problem_of, stack
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.state import DistinctSettings, DistinctState
from drystone.engines.base import Demand, Problem
from drystone.model.assembly import GRAVITY, Corner
from drystone.model.joint_law import JointLaw
from energy_books import energy_of

UNDAMPED = DistinctSettings(local_damping=0.0, safety=0.05)


def law(friction: float, stiffness: float = 1e10, **more: float) -> JointLaw:
    """As stiff in shear as in closing [Pa/m]."""
    return JointLaw(
        friction_coefficient=friction,
        normal_stiffness=stiffness,
        shear_stiffness=stiffness,
        **more,
    )


def released_for(
    engine: DistinctEngine, state: DistinctState, time: float, multiplier: float = 0.0
) -> DistinctState:
    """Real motion of a given length."""
    demand = Demand(multiplier=multiplier, time_step=time, stop_blocks=False)
    return engine.step(state, demand)[0]


def raised(problem: Problem, height: float) -> np.ndarray:
    pose = problem.assembly.design_pose()
    pose[1, 1] = height
    return pose


class TestDrop:
    """A block 0.4 m x 0.4 m falls flat by 10 mm on joints of 1e8 Pa/m: W = 1.6 kN, k = 4e7 N/m."""

    height, weight, stiffness = 0.01, 1600.0, 4e7

    def start(self) -> tuple[DistinctEngine, DistinctState]:
        problem = problem_of(stack((0.4, 0.4), joint=law(0.65, 1e8)))
        engine = DistinctEngine(UNDAMPED)
        return engine, engine.release(problem, raised(problem, self.height))

    def test_free_fall(self):
        engine, state = self.start()
        time = 0.04  # s, before it lands at 0.0452 s
        state = released_for(engine, state, time)
        # Semi-implicit Euler is ahead by g t dt / 2, dt being below 0.2 ms.
        assert state.pose[1, 1] == pytest.approx(
            self.height - 0.5 * GRAVITY * time**2, abs=0.5 * GRAVITY * time * 2e-4
        )

    def test_deepest_overlap_and_rebound(self):
        engine, state = self.start()
        heights = []
        for _ in range(500):
            state = released_for(engine, state, 2e-4)
            heights.append(state.pose[1, 1])
        # From W (h + d) = k d^2 / 2.
        flat = self.weight / self.stiffness
        deepest = flat * (1.0 + np.sqrt(1.0 + 2.0 * self.height / flat))
        assert -min(heights) == pytest.approx(deepest, rel=2e-3)
        rebound = max(heights[int(np.argmin(heights)) :])
        assert rebound == pytest.approx(self.height, rel=5e-3)

    def test_energy(self):
        engine, state = self.start()
        for _ in range(20):
            state = released_for(engine, state, 5e-3)
            assert abs(energy_of(engine, state).defect) < 1e-3 * self.weight * self.height


class TestSlide:
    """A block slides down a plane of slope tan(alpha) = 1 with friction 0.5."""

    def test_acceleration_and_heat(self):
        alpha, friction, time = np.pi / 4, 0.5, 0.2
        model = stack((0.8, 0.2), joint=law(friction), tilt=-alpha)
        engine = DistinctEngine(UNDAMPED)
        state = released_for(engine, engine.release(problem_of(model)), time)
        along = np.array([np.cos(alpha), -np.sin(alpha)])
        distance = 0.5 * GRAVITY * (np.sin(alpha) - friction * np.cos(alpha)) * time**2
        # It drops on its springs at first, by twice W cos(alpha) / k = 0.4 um.
        assert state.pose[1, :2] @ along == pytest.approx(distance, rel=2e-3)
        energy = energy_of(engine, state)
        assert abs(energy.defect) < 1e-3 * energy.load_work
        # Heat: friction times distance.
        normal = model.assembly.weight[1] * np.cos(alpha)
        assert energy.friction == pytest.approx(friction * normal * distance, rel=5e-3)

    def test_rests_below_its_friction(self):
        model = stack((0.8, 0.2), joint=law(0.5), tilt=-np.arctan(0.49))
        engine = DistinctEngine()
        state, report = engine.start(problem_of(model))
        assert report.residual < engine.settings.tolerance
        assert np.hypot(*state.pose[1, :2]) < 1e-6  # elastic: W / k = 1.8 kN / 8e9 N/m


class TestRocking:
    """A slender block released where it leans on its toe."""

    size, stiffness = (0.4, 1.6), 1e11  # m, Pa/m

    def lean(self, angle: float) -> tuple[Problem, np.ndarray]:
        problem = problem_of(stack(self.size, joint=law(0.8, self.stiffness)))
        pose = problem.assembly.design_pose()
        toe = np.array([self.size[0] / 2, 0.0])
        arm = problem.assembly.centroid[1] - toe
        c, s = np.cos(angle), -np.sin(angle)
        pose[1] = (*(toe + (c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]) - toe - arm), -angle)
        return problem, pose

    def test_time_of_fall_and_energy(self):
        width, height = self.size
        radius, alpha = 0.5 * np.hypot(width, height), np.arctan(width / height)
        first = 0.5 * alpha
        problem, pose = self.lean(first)
        weight = problem.assembly.weight[1]
        engine = DistinctEngine(replace(UNDAMPED, safety=0.2))
        state = engine.release(problem, pose)
        # (4/3) R^2 w^2 / 2 = g R (cos(alpha - theta) - cos(alpha - first)), Housner (1963).
        speed = np.sqrt(1.5 * GRAVITY / radius)

        def slowness(u: float) -> float:
            """dt / du, with theta = first - u^2, which takes the root out of the start."""
            come_down = np.cos(alpha - first) - np.cos(alpha - first + u**2)
            return 2.0 * u / (speed * np.sqrt(come_down))

        fall = quad(slowness, 1e-9, np.sqrt(first))[0]
        lift = weight * radius * (np.cos(alpha - first) - np.cos(alpha))
        step, time = 1e-3, 0.0
        angles = [first]
        while angles[-1] > 0.0:
            state = released_for(engine, state, step)
            time += step
            angles.append(-state.pose[1, 2])
            energy = energy_of(engine, state)
            assert abs(energy.defect) < 1e-3 * lift
        time += step * angles[-1] / (angles[-2] - angles[-1])
        assert time == pytest.approx(fall, rel=2e-3)

    @pytest.mark.parametrize("radius", [0.0, 0.03])
    def test_static_curve(self, radius):
        block = RockingBlock(*self.size, radius)
        corner = Corner(radius=radius) if radius else None
        model = stack(self.size, joint=law(0.8, self.stiffness), corner=corner)
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(model))
        for _ in range(20):
            state, report = engine.step(state, Demand(increment=0.01))
            assert report.converged
            theta = block.rotation(report.control_displacement)
            # Unbalanced forces of 1e-5 weights, elastic closing of 1e-7 m.
            assert report.static_multiplier == pytest.approx(block.multiplier(theta), abs=1e-4)


class TestDilatancy:
    size, friction, angle = (0.8, 0.2), 0.5, 10.0

    def test_acceleration_of_steady_sliding(self):
        # N = m (g + tan(psi) a) and a = lambda g - mu N / m.
        multiplier = 0.8
        model = stack(self.size, joint=law(self.friction, dilatancy_angle=self.angle))
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(model))
        begin = state.pose.copy()
        engine.settings = UNDAMPED
        # Nothing damps the springs, which the load has shaken: velocities some 60 periods apart.
        first = released_for(engine, state, 0.03, multiplier)
        second = released_for(engine, first, 0.02, multiplier)
        slope = np.tan(np.radians(self.angle))
        acceleration = GRAVITY * (multiplier - self.friction) / (1.0 + self.friction * slope)
        gained = (second.velocity - first.velocity)[1, 0]
        assert gained == pytest.approx(acceleration * 0.02, rel=5e-3)
        moved = second.pose[1] - begin[1]
        assert moved[1] == pytest.approx(slope * moved[0], rel=1e-3)

    def test_ends(self):
        # Driven slowly: a joint that lifts fast hops, and does not dilate while it is open.
        end, engine = 2e-3, DistinctEngine(DistinctSettings(drive_cycles=3000))
        joint = law(self.friction, dilatancy_angle=self.angle, dilatancy_end=end)
        state, _ = engine.start(problem_of(stack(self.size, joint=joint)))
        begin = state.pose.copy()
        slope = np.tan(np.radians(self.angle))
        for _ in range(10):
            state, report = engine.step(state, Demand(increment=4e-4))
            # It lifts until it is stopped, and comes to rest with a little less than all its
            # friction.
            assert report.static_multiplier == pytest.approx(self.friction, abs=1e-3)
            moved = state.pose[1] - begin[1]
            # The elastic shear before sliding is 0.5 W / k_s = 1e-7 m, a cycle slides 1e-6 m.
            assert moved[1] == pytest.approx(slope * min(moved[0], end), abs=1e-6)
        assert moved[0] > 1.5 * end


class TestBond:
    def test_cohesion_without_friction(self):
        width, height = 0.8, 0.2
        model = stack((width, height), joint=law(0.0, cohesion=1e3))
        limit = 1e3 * width / model.assembly.weight[1]  # c A / W = 0.5
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(model))
        for share in np.arange(0.1, 1.2, 0.1):  # in steps, for the joint swings beyond each of them
            state, report = engine.step(state, Demand(multiplier=share * limit, time_step=0.02))
            # Elastic: 0.8 kN / 8e9 N/m.
            assert (report.motion < 1e-6) == (share < 1.0)

    @pytest.mark.parametrize(("share", "holds"), [(0.95, True), (1.05, False)])
    def test_tensile_strength(self, share, holds):
        """A block glued under a ceiling: f_t A against its weight, 10 kN/m3 x 0.2 m."""
        strength = 10e3 * 0.2 / share
        model = stack(
            (0.8, 0.2), joint=law(0.5, cohesion=1e4, tensile_strength=strength), tilt=np.pi
        )
        engine = DistinctEngine()
        state = engine.release(problem_of(model))
        # Hung gently, without swinging: omega = (k / m)^1/2 = 7e3 1/s.
        engine.settings = replace(engine.settings, viscous_damping=2e4)
        _, report = engine.step(state, Demand(multiplier=0.0, time_step=0.05))
        assert (report.motion < 1e-6) == holds  # elastic: W / k = 2e-7 m
