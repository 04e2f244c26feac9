"""What is particular to the distinct element engine: cycles, searches, masses, damping."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from builders import UNIT_WEIGHT, problem_of, rectangle, stack, stiff_joint
from drystone.analysis.driver import pushover
from drystone.dynamics import explicit
from drystone.dynamics.distinct.cycles import relax, run
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.masses import masses
from drystone.dynamics.distinct.search import search
from drystone.dynamics.distinct.state import DistinctSettings, DistinctState
from drystone.dynamics.distinct.workspace import Workspace
from drystone.engines.base import Demand, EngineError, UnstableError
from drystone.law.columns import BROKEN
from drystone.limit import ASSOCIATIVE, collapse_load
from drystone.model.assembly import Block, Corner
from drystone.model.builders import make_model
from drystone.model.builders.circular_arch import circular_arch
from drystone.model.builders.wall import coursed_wall
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model
from structures import structure

JOINT = JointLaw(friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11)


def small_wall() -> Model:
    """Four courses of two units and a half, as the published walls are made."""
    blocks = coursed_wall(
        unit=(0.4, 0.175), courses=("h1h", "11"), repeat=2, base=True, unit_weight=UNIT_WEIGHT
    )
    return make_model(
        blocks, joint=JOINT, corner=Corner(radius=0.02), thickness=1.0, load_direction=(1.0, 0.0)
    )


def masses_of(engine: DistinctEngine, state: DistinctState, *, real: bool):
    """Masses and time step of a state's contacts."""
    return masses(
        engine.settings, state.prepared, state.pairs, state.slots, state.pose, state.history,
        real=real,
    )  # fmt: skip


def walked(engine: DistinctEngine, n_steps: int = 6, increment: float = 5e-4):
    state, _ = engine.start(problem_of(small_wall()))
    report = None
    for _ in range(n_steps):
        state, report = engine.step(state, Demand(increment=increment))
        assert report.converged, report.reason
    return state, report


class TestTimeStep:
    @pytest.mark.parametrize("real", [True, False])
    def test_undamped_and_linear(self, real):
        """Shaken so little that all joints stay closed and stick, the blocks gain no energy."""
        law = JointLaw(friction_coefficient=1e3, normal_stiffness=1e8, shear_stiffness=1e10)
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(stack((0.4, 0.4), (0.4, 0.2), (0.3, 0.3), joint=law)))
        engine.settings = DistinctSettings(safety=0.95, local_damping=0.0)
        work = Workspace(engine.settings, state, real_masses=real)
        random = np.random.default_rng(1)
        work.motion.velocity[1:] = random.choice([-1.0, 1.0], (3, 3)) * 1e-9 / work.dt
        first = np.sum(work.mass * work.motion.velocity**2)
        run(work, 20_000)
        # Bounded: velocity and force of the highest waves share 1 / (1 - 0.95^2) times the energy.
        assert np.sum(work.mass * work.motion.velocity**2) < 10.0 * first

    @pytest.mark.parametrize("local_damping", [0.5, 0.8])
    @pytest.mark.parametrize("real", [True, False])
    def test_damped_with_impacts(self, real, local_damping):
        """Thrown apart by joints that are all closed by 0.2 mm, the blocks land where they were."""
        engine = DistinctEngine(DistinctSettings(safety=1.0, local_damping=local_damping))
        problem = problem_of(small_wall())
        pose = problem.assembly.design_pose()
        for i, block in enumerate(problem.assembly.blocks[1:], start=1):
            pose[i, 1] = -2e-4 * round(block.vertices[:, 1].max() / 0.175)
        work = Workspace(engine.settings, engine.release(problem, pose), real_masses=real)
        run(work, 20_000)
        assert np.abs(work.motion.pose).max() < 5e-3

    def test_limit_is_not_far_from_the_edge(self):
        """One block on a fixed base: the bound counts the base's share of stiffness too."""
        engine = DistinctEngine(DistinctSettings(safety=1.0, local_damping=0.0))
        law = JointLaw(friction_coefficient=0.65, normal_stiffness=1e9, shear_stiffness=1e6)
        state = engine.release(problem_of(stack((0.4, 0.4), joint=law)))
        work = Workspace(engine.settings, state, real_masses=True)
        mass, stiffness = work.mass[1, 1], 1e9 * 0.4
        assert work.dt < 2.0 / np.sqrt(stiffness / mass)
        # Twice the stiffness, and the rotation: corners 0.2 m out, k d^2 over m d^2 / 1.5.
        assert work.dt > 2.0 / np.sqrt(2.0 * 3.0 * stiffness / mass)

    def test_mass_scaling_lengthens_it(self):
        engine = DistinctEngine()
        state = engine.release(problem_of(small_wall()))
        real, dt = masses_of(engine, state, real=True)
        np.testing.assert_array_equal(real, state.prepared.assembly.mass)
        engine.settings = replace(engine.settings, mass_scaling=100.0)
        scaled, longer = masses_of(engine, state, real=True)
        assert longer == pytest.approx(10.0 * dt)
        assert (scaled >= real).all()


class TestMasses:
    def test_a_block_that_touches_nothing_has_one(self):
        """It falls onto the column below, with no division by zero; the column bears both."""
        outlines = {
            "base": rectangle(-1.0, -0.2, 2.0, 0.2),
            "b1": rectangle(-0.2, 0.0, 0.4, 0.4),
            "b2": rectangle(-0.2, 0.4, 0.4, 0.2),
        }
        blocks = [
            Block(id=name, vertices=v, unit_weight=UNIT_WEIGHT, support=name == "base")
            for name, v in outlines.items()
        ]
        model = make_model(blocks, joint=JOINT, thickness=1.0, load_direction=(1.0, 0.0))
        engine = DistinctEngine()
        lifted = model.assembly.design_pose()
        lifted[2, 1] = 0.05  # out of the reach within which contacts count
        state = engine.release(problem_of(model), lifted)
        mass, _ = masses_of(engine, state, real=False)
        assert (mass[1:] > 0.0).all()
        work = Workspace(engine.settings, state, real_masses=False)
        assert relax(work, guided=False)
        # Closed by the weight of one block under b2, of both under b1: 5 and 15 um at 1e8 Pa/m.
        closing = np.array([0.6, 0.2]) * UNIT_WEIGHT / JOINT.normal_stiffness
        expected = -np.array([closing[0], closing.sum()])
        np.testing.assert_allclose(work.motion.pose[1:, 1], expected, rtol=1e-3)

    @pytest.mark.parametrize(("broken", "n_felt"), [(0.0, 2), (1.0, 1)])
    def test_a_joint_that_was_torn_counts_as_long_as_its_bond_is_not_lost(self, broken, n_felt):
        """However far it has opened: it pulls with all its stiffness, and sticks."""
        law = JointLaw(
            friction_coefficient=0.7,
            normal_stiffness=1e9,
            shear_stiffness=4e8,
            cohesion=8e4,
            tensile_strength=5e4,
            shear_fracture_energy=100.0,
            tensile_fracture_energy=20.0,
            residual_friction_coefficient=0.6,
        )
        engine = DistinctEngine()

        def mass_of_lower(n_blocks, lift):
            problem = problem_of(stack(*[(0.4, 0.4)] * n_blocks, joint=law))
            pose = problem.assembly.design_pose()
            pose[-1, 1] = lift
            state = engine.release(problem, pose)
            state.history[:, BROKEN] = np.where(state.slots.gap > 0.0, broken, 0.0)
            mass, _ = masses_of(engine, state, real=False)
            return mass[1]

        # Far beyond what may close before the next search; arms are longer by a fiftieth, too.
        lift = 0.02 * 0.4
        np.testing.assert_allclose(mass_of_lower(2, lift), mass_of_lower(n_felt, 0.0), rtol=3e-2)

    def test_where_nothing_touches_blocks_fall_with_their_own(self):
        engine = DistinctEngine()
        problem = problem_of(stack((0.4, 0.4), joint=JOINT))
        pose = problem.assembly.design_pose()
        pose[1, 1] = 0.3
        state = engine.release(problem, pose)
        mass, dt = masses_of(engine, state, real=False)
        work = Workspace(engine.settings, state, real_masses=False)
        run(work, 50)
        np.testing.assert_array_equal(mass, state.prepared.assembly.mass)
        # Local damping takes half of the weight off a block that moves: from the second cycle on.
        fallen = 9.81 * dt**2 * (50 + 50 * 49 / 4)
        assert pose[1, 1] - work.motion.pose[1, 1] == pytest.approx(fallen, rel=1e-9)


class TestSearch:
    def test_only_where_blocks_have_moved(self):
        searches = []
        for tolerance in (2e-3, 0.0):
            engine = DistinctEngine(DistinctSettings(search_tolerance=tolerance))
            state, _ = engine.start(problem_of(small_wall()))
            work = Workspace(engine.settings, replace(state, multiplier=0.3), real_masses=True)
            run(work, 200)
            searches.append(work.n_searches)
        assert searches == [0, 200]

    def test_tolerance_moves_no_static_point(self):
        """Frozen features cost what a vertex has moved past an edge's end: 1 um in 0.4 m."""
        multipliers = []
        for tolerance in (2e-3, 2e-5):
            engine = DistinctEngine(DistinctSettings(search_tolerance=tolerance))
            _, report = walked(engine)
            multipliers.append(report.static_multiplier)
        # The path between two points is another one, and friction remembers it.
        assert multipliers[0] == pytest.approx(multipliers[1], rel=5e-3)

    def test_keeps_the_forces(self):
        """A search where nothing has changed changes nothing."""
        engine = DistinctEngine()
        state, _ = walked(engine)
        work = Workspace(engine.settings, state, real_masses=False)
        search(work)
        np.testing.assert_array_equal(work.slots.feature, state.slots.feature)
        np.testing.assert_allclose(work.slots.gap, state.slots.gap, atol=1e-12)
        np.testing.assert_array_equal(work.history, state.history)


class TestStep:
    def test_leaves_its_state_alone_and_repeats_itself(self):
        engine = DistinctEngine()
        state, _ = walked(engine, 2)
        kept = {f.name: getattr(state, f.name) for f in fields(state)}
        copies = {k: v.copy() for k, v in kept.items() if isinstance(v, np.ndarray)}
        first, _ = engine.step(state, Demand(increment=5e-4))
        second, _ = engine.step(state, Demand(increment=5e-4))
        for name, copy in copies.items():
            np.testing.assert_array_equal(getattr(state, name), copy)
        np.testing.assert_array_equal(first.pose, second.pose)
        np.testing.assert_array_equal(first.history, second.history)

    def test_reaches_the_increment_at_rest(self):
        engine = DistinctEngine()
        state, report = walked(engine, 3)
        before = report.control_displacement
        state, report = engine.step(state, Demand(increment=5e-4))
        assert report.control_displacement - before == pytest.approx(5e-4, rel=0.15)
        assert report.residual <= engine.settings.tolerance
        assert report.carried_multiplier == pytest.approx(report.static_multiplier, abs=1e-4)
        assert not state.velocity.any()

    def test_stops_the_blocks_or_does_not(self):
        """Free of friction, a block goes from rest by half of what it goes at its last speed."""
        engine = DistinctEngine(DistinctSettings(local_damping=0.0, safety=0.2))
        model = stack((0.8, 0.2), joint=stiff_joint(0.0, 1e9))
        state = engine.release(problem_of(model))
        demand = Demand(multiplier=0.1, time_step=0.02, stop_blocks=True)
        state, first = engine.step(state, demand)
        _, stopped = engine.step(state, demand)
        _, running = engine.step(state, replace(demand, stop_blocks=False))
        acceleration = 0.1 * 9.81
        assert first.motion == pytest.approx(0.5 * acceleration * 0.02**2, rel=0.02)
        assert stopped.motion == pytest.approx(first.motion, rel=0.02)
        assert running.motion == pytest.approx(3.0 * first.motion, rel=0.02)

    def test_names_a_block_that_topples(self):
        outlines = {
            "base": rectangle(-1.0, -0.2, 2.0, 0.2),
            "b1": rectangle(-0.2, 0.0, 0.4, 0.4),
            "b2": rectangle(0.1, 0.4, 0.4, 0.2),  # its middle is 0.1 m outside of b1
        }
        blocks = [
            Block(id=name, vertices=v, unit_weight=UNIT_WEIGHT, support=name == "base")
            for name, v in outlines.items()
        ]
        model = make_model(blocks, joint=JOINT, thickness=1.0, load_direction=(1.0, 0.0))
        with pytest.raises(UnstableError, match='"b2"'):
            DistinctEngine().start(problem_of(model))

    @pytest.mark.parametrize("time_step", [1e-300, 1e6])
    def test_says_what_time_steps_it_can_take(self, time_step):
        """Two cycles at least, and no more at once than a user would wait for."""
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(small_wall()))
        same, report = engine.step(state, Demand(multiplier=0.1, time_step=time_step))
        assert same is state
        assert not report.converged
        assert report.reason.startswith(f"a time step of {time_step:.1e} s is")
        assert "from 2 to 200000 at a time" in report.reason
        assert report.n_iterations <= 2

    def test_can_be_interrupted(self, monkeypatch):
        """No call of the compiled cycles is longer than a thousand of them."""
        calls = []
        cycle = explicit.cycle
        monkeypatch.setattr(
            explicit, "cycle", lambda *given: calls.append(given[7]) or cycle(*given)
        )
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(small_wall()))
        engine.step(state, Demand(multiplier=0.1, time_step=0.5))
        assert max(calls) <= 1000

    @pytest.mark.parametrize("multiplier", [1e6, 1e30, 1e300])
    def test_numbers_of_no_meaning_are_no_step(self, multiplier):
        """Blocks that fly farther than the structure is large, or that overflow, are told."""
        engine = DistinctEngine()
        state, _ = engine.start(problem_of(small_wall()))
        same, report = engine.step(state, Demand(multiplier=multiplier, time_step=0.05))
        assert same is state
        assert not report.converged
        assert "runs away" in report.reason

    def test_needs_stiffnesses(self):
        law = JointLaw(friction_coefficient=0.65, normal_stiffness=None, shear_stiffness=None)
        with pytest.raises(EngineError, match="normal_stiffness"):
            DistinctEngine().start(problem_of(stack((0.4, 0.4), joint=law)))


def test_stiff_arch_is_not_past_its_peak_at_its_first_points():
    """Semicircular, 17 voussoirs, inner radius 3.75 m, 0.5 m thick, k_n = 1e11 Pa/m.

    Four hinges under a horizontal load: limit analysis, which knows of no elasticity, has the
    peak; 0.5 %: the joints' compression, and what the chord to the peak may hide (0.2 %).
    """
    blocks = circular_arch(
        radius=4.0, thickness=0.5, embrace=180.0, n_voussoirs=17, unit_weight=20e3
    )
    law = JointLaw(friction_coefficient=0.7, normal_stiffness=1e11, shear_stiffness=1e11)
    model = make_model(blocks, joint=law, thickness=1.0, load_direction=(1.0, 0.0))
    curve = pushover(model, engine="distinct", strategy="displacement", max_displacement=1e-4)
    limit = collapse_load(model, flow=ASSOCIATIVE).load_multiplier
    assert curve.peak.load_multiplier == pytest.approx(limit, rel=5e-3)
    assert curve.peak.step >= 3


def test_a_sharp_stiff_arch_comes_to_rest_in_its_jumps():
    """Five voussoirs over 120 degrees, k_n = 1e11 Pa/m, k_s = 1000 k_n.

    What vibrates upon a jump must not hold it back.  The peak lies before all jumps: 0.2 % is what
    the chords of both curves to it may hide.  The jump, at a third of the way, leaves joints slid
    as its motion takes them: 5 % of an end at 27 mm.
    """
    blocks = circular_arch(
        radius=1.0, thickness=0.1, embrace=120.0, n_voussoirs=5, unit_weight=20e3
    )
    law = JointLaw(friction_coefficient=0.7, normal_stiffness=1e11, shear_stiffness=1e14)
    model = make_model(blocks, joint=law, thickness=1.0, load_direction=(1.0, 0.0))
    curve = pushover(model, engine="distinct")
    static = pushover(model, engine="equilibrium")
    assert curve.status == "finished" and "fell below" in curve.reason
    assert curve.peak.load_multiplier == pytest.approx(static.peak.load_multiplier, rel=2e-3)
    assert curve.ultimate_displacement == pytest.approx(static.ultimate_displacement, rel=0.05)


def test_an_end_in_a_jump_is_that_of_the_static_path():
    """An arch in soft joints loses its equilibrium at half of its multiplier.

    The control point goes back in the jump, for F.x is held in it.  Both engines find the place to
    what a step of `distinct` is long, 5 % of it.
    """
    model = structure(3)
    curve = pushover(model, engine="distinct")
    static = pushover(model, engine="equilibrium")
    before, after = curve.points[-2:]
    assert after.jumped and before.load_multiplier > 10.0 * curve.stop_multiplier
    assert after.control_displacement < before.control_displacement
    step = DistinctEngine().preferred_steps(model.assembly).displacement_step
    assert curve.ultimate_displacement == pytest.approx(static.ultimate_displacement, abs=step)


@pytest.mark.parametrize(
    "settings",
    [
        {"local_damping": 0.8},
        {"mass_scaling": 1.0},
        {"mass_scaling": 10.0},
        {"mass_scaling": 100.0},
    ],
)
def test_means_of_relaxation_do_not_move_the_peak(settings):
    """Issue 4: by no more than 0.5 %."""
    options = {"strategy": "displacement", "max_displacement": 0.02}
    base = pushover(small_wall(), engine=DistinctEngine(), **options)
    other = pushover(small_wall(), engine=DistinctEngine(DistinctSettings(**settings)), **options)
    assert other.peak.load_multiplier == pytest.approx(base.peak.load_multiplier, rel=5e-3)


#: Random structures by seed, with how far they are pushed [m]: past the peak.
LOCKED = [(21, 7e-4), (136, 1.2e-5)]
SHARP = [(105, 1.5e-4), (86, 6e-3)]


@pytest.mark.parametrize(("seed", "end"), LOCKED)
def test_the_dead_load_locks_no_friction_in(seed, end):
    """Put on at once, the dead load overshot: joints slipped, and the peaks were +1.2, -1.7 % off.

    Under a load that grows slowly they do not, which is what `equilibrium` finds; 0.5 % is what a
    step may hide of a peak, `OVERSHOOT_SHARE`.
    """
    ours, other = (
        pushover(structure(seed), engine=engine, max_displacement=end).peak.load_multiplier
        for engine in ("distinct", "equilibrium")
    )
    assert ours == pytest.approx(other, rel=5e-3)


@pytest.mark.parametrize(("seed", "end"), SHARP)
def test_a_peak_that_is_passed_within_a_step_is_found(seed, end):
    """The multipliers at both ends of the step said nothing of it: 1.7 and 1.1 % were missed.

    By `OVERSHOOT_SHARE` a step may hide 0.5 % of it.
    """
    ours, other = (
        pushover(structure(seed), engine=engine, max_displacement=end).peak.load_multiplier
        for engine in ("distinct", "equilibrium")
    )
    assert ours == pytest.approx(other, rel=5e-3)
