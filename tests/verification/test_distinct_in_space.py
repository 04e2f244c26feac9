"""The distinct element engine in space against closed forms, and its books of energy and momentum.

Where the motion is real, damping is off; see `test_distinct_closed_forms` for the tolerances.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import drystone as ds
from builders import problem_of
from drystone.dynamics.distinct.cycles import run
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.state import DistinctSettings, DistinctState
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.base import Demand, UnstableError
from drystone.geometry.space import solid
from drystone.model.assembly import GRAVITY, Block, Corner
from drystone.model.builders import make_model
from drystone.model.builders.circular_arch import circular_arch
from drystone.model.joint_law import JointLaw
from energy_books import energy_of
from solids import box, joint, model_of, one_block, turned, twisting_lever

UNDAMPED = DistinctSettings(local_damping=0.0, safety=0.05)
UP = np.array([0.0, 0.0, 1.0])


def released_for(engine: DistinctEngine, state: DistinctState, time: float) -> DistinctState:
    """Real motion of a given length under the dead load."""
    demand = Demand(multiplier=0.0, time_step=time, stop_blocks=False)
    return engine.step(state, demand)[0]


class TestOneBlock:
    """0.4 x 0.6 x 1.5 m, friction 0.7, on joints of 1e11 Pa/m."""

    @pytest.mark.parametrize(("angle", "peak"), [(30.0, 0.30792), (45.0, 0.37712)])
    @pytest.mark.parametrize("points", [4, 9])
    def test_peak_of_an_oblique_push(self, angle, peak, points):
        """It tips over the edge that gives way first: b / (h cos) or d / (h sin)."""
        rigid = min(
            0.4 / (1.5 * np.cos(np.radians(angle))), 0.6 / (1.5 * np.sin(np.radians(angle)))
        )
        assert rigid == pytest.approx(peak, abs=1e-5)
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(one_block(angle=angle, points=points)))
        highest = 0.0
        for _ in range(4):
            state, report = engine.step(state, Demand(increment=2e-4))
            assert report.converged
            highest = max(highest, report.static_multiplier)
        # 1e-3 of it: at 0.4 mm it leans by 0.3 mrad, its edge has closed by 1e-6 m of 0.4.
        assert highest == pytest.approx(peak, rel=1e-3)

    @pytest.mark.parametrize("angle", [0.0, 30.0, 77.0])
    def test_slides_straight_wherever_it_is_pushed(self, angle):
        """A low block with friction 0.2, by 2 cm: multiplier mu, path straight to 1e-6 of it."""
        model = one_block(0.4, 0.6, 0.3, friction=0.2, stiffness=1e10, angle=angle)
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(model))
        begin = state.pose.copy()
        for _ in range(10):
            state, report = engine.step(state, Demand(increment=2e-3))
            assert report.converged
            # At rest after sliding it has lost next to nothing of its friction.
            assert report.static_multiplier == pytest.approx(0.2, abs=1e-4)
        path = (state.pose - begin)[1, :3]
        along = path @ model.load.direction
        assert along > 0.019
        across = np.cross(UP, model.load.direction)
        assert abs(path @ across) < 1e-6 * along
        assert abs(state.pose[1, 6]) < 1e-6  # nor does it twist


class TestTwist:
    """A cube on its base, twisted: friction of the points, uniform pressure shared by area."""

    side, friction = 0.4, 0.6

    @pytest.mark.parametrize(("points", "factor"), [(4, 1.85), (9, 1.12), (16, 1.09)])
    def test_strength(self, points, factor):
        blocks = [
            box("base", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), support=True),
            box("b1", *np.array([[-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]]) * self.side),
        ]
        model = model_of(blocks, joint(self.friction), push=(1.0, 0.0, 0.0), points=points)
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(model))
        work = Workspace(engine.settings, state, real_masses=False)
        pattern = np.zeros_like(work.loads.pattern)
        pattern[1, 3:] = model.assembly.axes[1].T @ UP  # 1 N m
        work.loads = work.loads._replace(pattern=pattern)
        # The strength is used up at some 1e-6 m of sliding; driven slowly, to 1e-4 m.
        rate = 5e-4 / 20_000
        run(work, 16_000, guided=True, rate=rate, combined=True)
        torques = []
        for _ in range(40):
            run(work, 100, guided=True, rate=rate, combined=True)
            torques.append(work.multiplier)
        weight = model.assembly.weight[1]
        torque = float(np.mean(torques)) / (self.friction * weight)
        assert torque == pytest.approx(twisting_lever(self.side, points), rel=2e-3)
        uniform = self.side / 6.0 * (np.sqrt(2.0) + np.log(1.0 + np.sqrt(2.0)))
        assert torque / uniform == pytest.approx(factor, rel=0.01)


class TestDrop:
    """A block falls turned anyhow, on an edge, or rounded like a ball."""

    height = 0.02  # m, of its lowest point

    def start(self, rotation: Rotation, corner: Corner | None):
        blocks = [
            box("base", (-2.0, -2.0, -0.5), (2.0, 2.0, 0.0), support=True),
            box("b1", (-0.2, -0.15, 0.0), (0.2, 0.15, 0.25)),
        ]
        model = model_of(blocks, joint(0.4, 1e8), push=(1.0, 0.0, 0.0), corner=corner)
        assembly = model.assembly
        pose = assembly.design_pose()
        pose[1, 3:] = rotation.as_quat(scalar_first=True)
        core = rotation.apply(assembly.shapes.of(1))
        lowest = core[:, 2].min() - assembly.shapes.radius[1]
        pose[1, 2] = self.height - lowest - assembly.centroid[1, 2]
        engine = DistinctEngine(UNDAMPED)
        return engine, engine.release(problem_of(model), pose)

    @pytest.mark.parametrize("corner", [None, Corner(radius=0.12)], ids=["sharp", "like a ball"])
    @pytest.mark.parametrize(
        "vector", [(0.6, 0.0, 0.0), (0.0, -0.4, 0.0), (0.5, -0.3, 0.9)], ids=["x", "y", "any"]
    )
    def test_lands_when_it_should_and_keeps_the_books(self, vector, corner):
        engine, state = self.start(Rotation.from_rotvec(vector), corner)
        fall = np.sqrt(2.0 * self.height / GRAVITY)
        weight = state.prepared.assembly.weight[1]
        work = Workspace(engine.settings, state, real_masses=True)
        dt = work.dt
        while not (work.reaction[:, 0] > 0.0).any():
            assert work.n_cycles * dt < 2.0 * fall
            run(work, 1)
            work.unpack()
        # Semi-implicit Euler is ahead by g t dt / 2, half a step of its last velocity.
        assert work.n_cycles * dt == pytest.approx(fall, abs=2.0 * dt)
        # Through the impact and what comes of it: it slides, tips, and flies up again.
        for _ in range(6):
            state = released_for(engine, state, 0.02)
            # Friction changes while it slides, and so its work is of first order in the time step.
            assert abs(energy_of(engine, state).defect) < 1e-2 * weight * self.height

    def test_what_the_books_miss_goes_with_the_time_step(self):
        missed = []
        for safety in (0.1, 0.05):
            engine, state = self.start(Rotation.from_rotvec((0.5, -0.3, 0.9)), None)
            engine.settings = replace(UNDAMPED, safety=safety)
            state = released_for(engine, released_for(engine, state, 0.05), 0.05)
            missed.append(energy_of(engine, state).defect)
        assert missed[0] / missed[1] == pytest.approx(2.0, rel=0.15)


class TestFlight:
    """Two blocks thrown at each other: every kind of contact in turn, and nothing else."""

    @pytest.mark.parametrize("seed", range(3))
    def test_momentum_is_kept_to_rounding(self, seed):
        random = np.random.default_rng(seed)
        blocks = [
            box("base", (-9.0, -9.0, -60.0), (9.0, 9.0, -50.0), support=True),
            box("b1", (-0.7, -0.1, 0.0), (-0.3, 0.1, 0.3)),
            box("b2", (0.3, -0.2, 0.0), (0.5, 0.2, 0.4)),
        ]
        model = model_of(blocks, joint(0.5, 1e8), push=(1.0, 0.0, 0.0))
        engine = DistinctEngine(replace(UNDAMPED, safety=0.2))
        assembly = model.assembly
        pose, velocity = assembly.design_pose(), assembly.no_motion()
        pose[1:, 3:] = Rotation.random(2, random_state=random).as_quat(scalar_first=True)
        velocity[1:, 0] = 3.0, -3.0
        velocity[1:, 1:3] = random.uniform(-0.3, 0.3, (2, 2))
        velocity[1:, 3:] = random.uniform(-4.0, 4.0, (2, 3))
        state = engine.release(problem_of(model), pose, velocity)
        work = Workspace(engine.settings, state, real_masses=True)
        still = np.zeros_like(work.loads.dead)
        work.acting = replace(work.acting, dead=still)
        work.loads = work.loads._replace(dead=still)
        mass, first = assembly.mass[1:], None
        for _ in range(100):
            place = (assembly.centroid + work.motion.pose[:, :3])[1:]
            v = work.motion.velocity[1:]
            spin = np.einsum("nij,nj->ni", work.motion.rotation.axes[1:], mass[:, 3:] * v[:, 3:])
            linear = mass[:, :3] * v[:, :3]
            total = np.array([linear.sum(axis=0), np.sum(np.cross(place, linear) + spin, axis=0)])
            first = total if first is None else first
            # Of blocks of 60 and 80 kg at 3 m/s: some 300 kg m/s, in thousands of cycles.
            assert total == pytest.approx(first, abs=1e-9)
            run(work, round(5e-3 / work.dt))
        assert np.abs(work.motion.velocity[1:, :3] - velocity[1:, :3]).max() > 1.0  # they met


class TestArch:
    """The semicircular arch that 3DEC was run on: 20 voussoirs of 9 degrees, 0.5 m deep.

    Inner radius 5.0 m, outer 5.5 m, the two at the springings fixed; 1000 kg/m3, g = 9.806 m/s2,
    k_n = 9e10, k_s = 5e10 Pa/m, friction angle 35 degrees.
    """

    def model(self, inner: float) -> ds.Model:
        law = JointLaw(
            friction_coefficient=float(np.tan(np.radians(35.0))),
            normal_stiffness=9e10,
            shear_stiffness=5e10,
        )
        blocks = circular_arch(
            radius=0.5 * (inner + 5.5),
            thickness=5.5 - inner,
            embrace=180.0,
            n_voussoirs=20,
            unit_weight=9806.0,
            abutments=False,
        )
        blocks = [replace(b, support=b.id in ("v1", "v20")) for b in blocks]
        return ds.extruded(make_model(blocks, joint=law, thickness=0.5, load_direction=(1.0, 0.0)))

    def resultant(self, engine, state, a: int, b: int) -> tuple[float, float]:
        """Normal force of a joint [N] and the radius where it acts [m]."""
        forces = engine.contacts(state)
        here = (forces.block_a == a) & (forces.block_b == b)
        normal, place = forces.normal_reaction[here], forces.position[here]
        radius = np.hypot(place[:, 0], place[:, 2])
        return float(normal.sum()), float(normal @ radius / normal.sum())

    def test_thrust(self):
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(self.model(5.0)))
        thrust, radius = self.resultant(engine, state, 9, 10)
        # What 3DEC gives, by joint resultants.
        assert thrust == pytest.approx(8629.0, rel=5e-3)
        assert radius == pytest.approx(5.5, abs=1e-3)
        for pair in ((0, 1), (18, 19)):
            assert self.resultant(engine, state, *pair)[0] == pytest.approx(19247.0, rel=5e-3)

    def test_a_thinner_one_falls(self):
        with pytest.raises(UnstableError):
            DistinctEngine().start(problem_of(self.model(5.3)))


def test_turned_as_a_whole_it_goes_the_same_way():
    """Gravity, load and control point turned with it: the same multipliers."""
    model = one_block(friction=0.7, stiffness=1e9, angle=20.0)
    other = turned(model, Rotation.from_rotvec((0.4, -0.7, 1.1)), (3.0, -2.0, 5.0))
    curves = []
    for each in (model, other):
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(each))
        curve = []
        for _ in range(5):
            state, report = engine.step(state, Demand(increment=5e-3))
            assert report.converged
            curve.append((report.control_displacement, report.static_multiplier))
        curves.append(np.array(curve))
    # At rest up to unbalanced forces of 1e-5 weights.
    np.testing.assert_allclose(curves[1], curves[0], atol=2e-5)


def test_pieces_of_a_block_move_as_one():
    """A block of two parts, side by side, goes as the same block in one piece."""
    low, high = np.array([0.0, 0.0, 0.0]), np.array([0.4, 0.6, 1.5])
    halves = [
        solid.Part(*solid.box([low, (0.2, 0.6, 1.5)])),
        solid.Part(*solid.box([(0.2, 0.0, 0.0), high])),
    ]
    base = box("base", (-2.0, -2.0, -0.3), (2.4, 2.6, 0.0), support=True)
    two = Block(
        id="b1",
        vertices=np.vstack([part.vertices for part in halves]),
        parts=tuple(halves),
        unit_weight=10e3,
        material="stone",
    )
    multipliers = []
    for block in (box("b1", low, high), two):
        model = model_of([base, block], joint(0.7, 1e9), push=(1.0, 0.0, 0.0), point=high)
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(model))
        for _ in range(3):
            state, report = engine.step(state, Demand(increment=0.01))
        multipliers.append(report.static_multiplier)
    # On its edge by then: where the parts touch the base elsewhere does not matter.
    assert multipliers[1] == pytest.approx(multipliers[0], abs=1e-4)
