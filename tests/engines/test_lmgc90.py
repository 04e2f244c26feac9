"""LMGC90 as an engine: against closed forms, against our own engine of the same formulation, and
where it fails.  All is skipped where the package `drystone-lmgc90` is not installed, and what needs
LMGC90 itself where its wheel is not."""

from __future__ import annotations

import os
import signal
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fake_pylmgc90
import solids
from builders import PUBLISHED_JOINT, RockingBlock, problem_of, rectangle, stack, turned
from drystone.analysis.driver import pushover
from drystone.engines import make_engine
from drystone.engines.base import Demand, EngineError, PreferredSteps, UnstableError
from drystone.geometry.space.solid import Part
from drystone.model.assembly import Block, Corner
from drystone.model.builders import make_model, published_wall
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model
from lmgc90_here import needs_lmgc90

pytest.importorskip("drystone_lmgc90", reason="pip install ./plugins/drystone-lmgc90")
from drystone_lmgc90 import Lmgc90Engine, Lmgc90Settings, engine
from drystone_lmgc90.messages import Outcome, Ready, Setup, Step
from drystone_lmgc90.prisms import extrude, same_place

LEG = 0.02  # m, of the chamfers


def on_chamfer(width: float, height: float) -> RockingBlock:
    """A block that rocks on the end of its chamfer: like a sharp one that is narrower."""
    return RockingBlock(width=width - 2.0 * LEG, height=height)


def displaced(block: RockingBlock, theta: np.ndarray) -> np.ndarray:
    """Of the upper right corner of the whole outline [m], from the toe at the chamfer's end."""
    return LEG * np.cos(theta) + block.height * np.sin(theta) - LEG


# On LMGC90 itself


@needs_lmgc90
def test_a_rocking_block_follows_the_closed_form():
    model = stack((0.4, 1.2), corner=Corner(radius=LEG))
    curve = pushover(model, engine="lmgc90")
    block = on_chamfer(0.4, 1.2)
    assert curve.status == "finished"
    assert curve.peak.load_multiplier == pytest.approx(block.multiplier(0.0), rel=0.01)
    theta = np.linspace(0.0, block.last, 20_001)
    for wanted in (0.05, 0.1, 0.2):
        k = curve.nearest(wanted)
        turn = np.interp(curve.control_displacement[k], displaced(block, theta), theta)
        # The toe closes its joint by W / k_n A = 4.8 kN / 2e7 N/m = 0.24 mm at 0.36 m, which is
        # 7e-4 rad in the rotation that belongs to a displacement: 0.3 % of the multiplier.
        assert curve.load_multiplier[k] == pytest.approx(block.multiplier(turn), rel=0.01)
    assert "shear stiffness" in curve.reason and "chamfered" in curve.reason
    # Rounding of the rigid limit: 0.24 mm under the toe, nothing more.
    assert curve.column("penetration").max() < 3e-4


@needs_lmgc90
def test_the_published_strategy_is_biased_as_theory_says():
    model = stack((0.4, 1.2), corner=Corner(radius=LEG))
    overshoot = 1.05
    curve = pushover(
        model, engine="lmgc90", strategy="published", overshoot=overshoot, max_displacement=0.21
    )
    block = on_chamfer(0.4, 1.2)
    theta = np.linspace(0.0, block.last, 20_001)
    for wanted in (0.1, 0.2):
        k = curve.nearest(wanted)
        turn = np.interp(curve.control_displacement[k], displaced(block, theta), theta)
        ratio = curve.load_multiplier[k] / block.multiplier(turn)
        predicted = 1.0 / (1.0 - (overshoot - 1.0) / overshoot / block.share(turn))  # 1.07
        # LMGC90's inertia is that of the chamfered outline, 1 % less than the share's.
        assert ratio == pytest.approx(predicted, rel=0.01)


@needs_lmgc90
@pytest.mark.parametrize("tilt", [0.0, 0.1, -0.15])
def test_a_stack_rests_as_in_our_own_engine(tilt):
    """The same formulation, theta 1, gives the same state of rest, in any orientation."""
    model = stack((0.5, 0.3), (0.4, 0.35), corner=Corner(chamfer=LEG), tilt=tilt)
    ours, theirs = make_engine("nscd"), make_engine("lmgc90")
    state, _ = ours.start(problem_of(model))
    other, report = theirs.start(problem_of(model))
    contacts = theirs.contacts(other)
    theirs.close()
    # Each comes to rest within a hundredth of the joints' closing, which is about 0.1 mm.
    np.testing.assert_allclose(other.pose[1:], state.pose[1:], atol=5e-6)
    assert report.carried_multiplier == pytest.approx(0.0, abs=1e-3)
    # Two plane points a joint, and together the stiffness of the joint as designed, per area.
    assert contacts.n_contacts == 4
    assert contacts.area.sum() == pytest.approx(0.5 + 0.4)
    assert np.all(contacts.normal_reaction > 0.0)
    weight = model.assembly.weight[~model.assembly.fixed].sum()
    base = contacts.block_a == 0
    lifted = contacts.vectors()[base].sum(axis=0)
    np.testing.assert_allclose(lifted, [0.0, weight], atol=1e-3 * weight)


@needs_lmgc90
def test_triangles_and_odd_shapes_keep_to_their_plane():
    """Principal axes of any order; a depth that leaves them undetermined is got around."""
    outlines = {
        "base": rectangle(-1.0, -0.5, 2.0, 0.5),
        "square": rectangle(-0.5, 0.0, 1.0, 1.0),  # as deep as it is high
        "wedge": np.array([[-0.3, 1.0], [0.5, 1.0], [0.1, 1.7]]),
    }
    blocks = [
        Block(id=name, vertices=v, unit_weight=1e4, support=name == "base")
        for name, v in outlines.items()
    ]
    model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))
    ours, theirs = make_engine("nscd"), make_engine("lmgc90")
    state, _ = ours.start(problem_of(model))
    other, _ = theirs.start(problem_of(model))
    demand = Demand(multiplier=0.1, time_step=0.05)
    for _ in range(20):
        state, _ = ours.step(state, demand)
        other, report = theirs.step(other, demand)
        assert report.converged
    theirs.close()
    np.testing.assert_allclose(other.pose, state.pose, atol=2e-5)


@needs_lmgc90
def test_a_step_can_be_taken_again_but_older_states_are_not_kept():
    model = stack((0.4, 1.2), corner=Corner(chamfer=LEG))
    solver = make_engine("lmgc90")
    start, _ = solver.start(problem_of(model))
    demand = Demand(multiplier=0.2, time_step=0.05)
    first, report = solver.step(start, demand)
    solver.step(start, replace(demand, multiplier=0.4, time_step=0.02))
    again, repeated = solver.step(start, demand)
    np.testing.assert_array_equal(first.pose, again.pose)  # bit by bit
    assert repeated.carried_multiplier == report.carried_multiplier
    second, _ = solver.step(again, demand)
    assert np.abs(second.pose - again.pose).max() > 0.0
    solver.step(second, demand)
    with pytest.raises(EngineError, match="last state only"):
        solver.step(start, demand)
    solver.close()
    with pytest.raises(EngineError, match="closed"):
        solver.step(second, demand)


@needs_lmgc90
def test_a_crash_is_an_error_with_a_partial_curve():
    model = stack((0.4, 1.2), corner=Corner(chamfer=LEG))
    solver = Lmgc90Engine()

    def kill(point):
        if point.step == 5:
            os.kill(solver._process.pid, signal.SIGSEGV)

    curve = pushover(model, engine=solver, progress=kill)
    assert curve.status == "stopped"
    assert len(curve.points) == 6
    assert "was ended by SIGSEGV" in curve.reason


@needs_lmgc90
def test_what_lmgc90_says_before_it_stops_is_told():
    model = stack((0.4, 1.2))
    solver = Lmgc90Engine()
    original = solver._setup
    # LMGC90 refuses bodies of no density in its own words.
    solver._setup = lambda rest: replace(original(rest), density=np.full(2, np.nan))
    with pytest.raises(EngineError, match="LMGC90"):
        solver.start(problem_of(model))


@needs_lmgc90
def test_blocks_that_cannot_stand_are_named():
    blocks = [
        Block(id="base", vertices=rectangle(0, -0.5, 1, 0.5), unit_weight=1e4, support=True),
        Block(id="lean", vertices=rectangle(0.8, 0, 1, 0.5), unit_weight=1e4),
    ]
    model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))
    with pytest.raises(UnstableError, match='"lean"'):
        pushover(model, engine="lmgc90")


@needs_lmgc90
@pytest.mark.slow
@pytest.mark.parametrize(
    ("wall", "peak", "ultimate"),
    [
        (1, 0.575, 0.449),
        # Not strict: which multiplier ends it, and with that whether it fails, is a matter of its
        # rounding, and so of the machine.
        pytest.param(
            *(2, 0.500, 0.529),
            marks=pytest.mark.xfail(reason="its multipliers scatter by 0.01 where the curve ends"),
        ),
        (3, 0.325, 0.599),
    ],
)
@pytest.mark.long
def test_the_published_walls(wall, peak, ultimate):
    """Peaks of LMGC90 in the plane without the bias of its overshoot, and where those runs of an
    overshoot of 1.01 ended (reference/README.md); 3 % and 5 % as three dimensions find other
    contacts than two."""
    curve = pushover(published_wall(wall), engine="lmgc90")
    assert curve.status == "finished"
    assert curve.peak.load_multiplier == pytest.approx(peak, rel=0.03)
    assert curve.ultimate_displacement == pytest.approx(ultimate, rel=0.05)
    assert curve.column("penetration").max() < 2e-3


@needs_lmgc90
@pytest.mark.slow
def test_the_bias_of_the_published_strategy_on_wall_1():
    """c = 0.173 on this wall: with an overshoot of 1.05 the branch is lifted by 38 %."""
    curve = pushover(published_wall(1), engine="lmgc90", strategy="published", overshoot=1.05)
    static = {0.1: 0.466, 0.2: 0.340}  # of the same engine with "displacement"
    for displacement, multiplier in static.items():
        ratio = curve.load_multiplier[curve.nearest(displacement)] / multiplier
        assert ratio == pytest.approx(1.0 / (1.0 - 0.05 / 1.05 / 0.173), rel=0.05)


@needs_lmgc90
@pytest.mark.parametrize(
    ("angle", "corner", "leg"),
    [
        (0.0, Corner(), 0.0),
        (30.0, Corner(), 0.0),
        (30.0, Corner(chamfer=LEG), LEG),
        (0.0, Corner(radius=LEG), LEG),
    ],
)
def test_a_block_in_space_turns_over_its_edge(angle, corner, leg):
    """b x d x h on its face, pushed at an angle to b: min(mu, b / h cos, d / h sin), with b and d
    as wide as the face that the corners leave."""
    b, d, h, friction = 0.4, 0.6, 1.5, 0.7
    model = solids.one_block(b, d, h, friction=friction, stiffness=1e9, angle=angle, corner=corner)
    along, across = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    width, depth = b - 2.0 * leg, d - 2.0 * leg
    peak = min(friction, width / (h * along), depth / (h * max(across, 1e-9)))
    curve = pushover(model, engine="lmgc90", stop_multiplier=0.9 * peak)
    # The edge closes its joint by W / k_n A times two, 3e-5 m: 1e-4 of b; 3e-4 were measured.
    assert curve.status == "finished"
    assert curve.peak.load_multiplier == pytest.approx(peak, rel=1e-3)
    assert curve.column("penetration").max() < 5e-5


@needs_lmgc90
def test_motions_and_forces_in_space_balance():
    """LMGC90 counts rotations about axes of its own: a block that stands askew, pushed askew."""
    model = solids.turned(
        solids.one_block(0.4, 0.6, 1.5, stiffness=1e9, angle=20.0),
        Rotation.from_rotvec([0.3, -0.5, 0.4]),
    )
    engine, problem = make_engine("lmgc90"), problem_of(model)
    state, _ = engine.start(problem)
    before = state.pose
    state, report = engine.step(state, Demand(multiplier=0.3, time_step=0.05))
    contacts, outcome = engine.contacts(state), state.outcome
    engine.close()
    assembly = model.assembly
    weight = assembly.weight[1]
    assert report.converged and report.residual < 1e-2
    # Reactions as vectors, and their moments about the centroid, are LMGC90's sums: to the rounding
    # of a dozen terms, 3e-15 of the weight; some 1e-16 were measured.
    force, centre = contacts.vectors(), assembly.centroid[1] + before[1, :3]
    np.testing.assert_allclose(
        force.sum(axis=0), outcome.contact_force[1, :3], rtol=0.0, atol=1e-12 * weight
    )
    moment = np.cross(contacts.position - centre, force).sum(axis=0)
    axes = Rotation.from_quat(before[1, [4, 5, 6, 3]]).as_matrix() @ assembly.axes[1]
    np.testing.assert_allclose(
        axes.T @ moment, outcome.contact_force[1, 3:], rtol=0.0, atol=1e-12 * weight
    )
    # Poses are those of the velocities; LMGC90's rotation of a step is of second order.
    reached = assembly.moved(before, 0.05 * state.velocity)
    np.testing.assert_allclose(state.pose, reached, atol=1e-6)
    assert np.abs(state.pose[1] - before[1]).max() > 1e-5


def facade(stiffness: float) -> Model:
    """A façade with two returns, 92 blocks, pushed outwards; joints of a stiffness [Pa/m]."""
    path = Path(__file__).parents[1] / "cases" / "solids" / "facade_5x3x8.toml"
    model = solids.from_boxes(path, push=(0.0, -1.0, 0.0))
    joint = replace(model.assembly.joint, normal_stiffness=stiffness)
    return replace(model, assembly=replace(model.assembly, joint=joint))


@needs_lmgc90
@pytest.mark.slow
def test_a_facade_in_space_has_all_its_joints():
    model = facade(1e8)
    assembly = model.assembly
    theirs = make_engine("lmgc90")
    state, report = theirs.start(problem_of(model))
    contacts = theirs.contacts(state)
    carried = state.outcome.contact_force[assembly.fixed].sum(axis=0)
    theirs.close()
    weight = assembly.weight[~assembly.fixed].sum()
    # The supports lack the inertia of what still moves, at most the fastest block's acceleration
    # over gravity; LMGC90 does not come to the same bits twice (4e-6 to 1.2e-5 were lacking).
    assert report.acceleration < 1e-3
    np.testing.assert_allclose(
        carried[:3] / weight, [0.0, 0.0, -1.0], rtol=0.0, atol=report.acceleration
    )
    found = Counter(zip(contacts.block_a.tolist(), contacts.block_b.tolist(), strict=True))
    joints = assembly.interfaces
    designed = zip(joints.block_a.tolist(), joints.block_b.tolist(), strict=True)
    assert found == dict.fromkeys(designed, 4)  # four points each
    # Their stiffnesses add up to that of the joint's whole area.
    areas = dict.fromkeys(found, 0.0)
    for a, b, area in zip(contacts.block_a, contacts.block_b, contacts.area, strict=True):
        areas[a, b] += area
    wanted = {
        (a, b): size
        for a, b, size in zip(
            joints.block_a.tolist(), joints.block_b.tolist(), joints.size, strict=True
        )
    }
    for pair, area in areas.items():
        assert area == pytest.approx(wanted[pair], rel=1e-6)


# Without LMGC90

#: Everything of an outcome but its contacts.
NOTHING_MOVES = {
    "converged": True,
    "n_sweeps": 1,
    "pose": np.zeros((4, 7)),
    "velocity": np.zeros((4, 6)),
    "contact_force": np.zeros((4, 6)),
}


class Puppet:
    """Stands for LMGC90's process: everything rests, the supports carry a share of the weight."""

    carried = 1.0
    moved = 0.0  # m, downwards

    def __init__(self, driver):
        self.pid = 0

    def ask(self, message):
        if isinstance(message, Setup):
            self.setup = message
            return Ready(program="puppet")
        n = len(self.setup.shapes)
        pose = np.zeros((n, 3))
        pose[1:, 1] = -self.moved
        force = np.zeros((n, 3))
        force[1:] = -message.force[1:]
        force[0, :2] = self.carried * message.force[1:, :2].sum(axis=0)
        return Outcome(
            converged=True,
            n_sweeps=50,
            pose=pose,
            velocity=np.zeros((n, 3)),
            contact_force=force,
            body_a=np.zeros(2, np.int64),
            body_b=np.ones(2, np.int64),
            position=np.array([[-0.2, 0.0], [0.2, 0.0]]),
            normal=np.tile([0.0, 1.0], (2, 1)),
            tangent=np.zeros((2, 0)),
            gap=np.full(2, -1e-4),
            reaction=np.tile([2000.0, 0.0], (2, 1)),
            stiffness=np.full(2, 2e7),
        )

    def close(self):
        pass


def puppet_engine(monkeypatch, **attributes) -> Lmgc90Engine:
    monkeypatch.setattr(engine, "Process", type("Puppet", (Puppet,), attributes))
    return Lmgc90Engine(driver="wheel")


def test_supports_that_do_not_carry_the_weight_are_an_error(monkeypatch):
    solver = puppet_engine(monkeypatch, carried=0.94)
    with pytest.raises(EngineError, match=r"carry 0\.9400 of the weight"):
        solver.start(problem_of(stack((0.4, 1.0))))
    solver = puppet_engine(monkeypatch, carried=1.0005)
    solver.start(problem_of(stack((0.4, 1.0))))


def test_penetration_is_watched(monkeypatch):
    # A twentieth of the smallest extent, 0.4 m, is 20 mm.
    solver = puppet_engine(monkeypatch, moved=0.021)
    with pytest.raises(EngineError, match=r"overlap by 21\.0 mm: LMGC90 has lost a contact"):
        solver.start(problem_of(stack((0.4, 1.0))))


def test_a_shorter_time_step_is_taken_than_is_asked_for(monkeypatch):
    solver = puppet_engine(monkeypatch)
    asked = []
    problem = problem_of(stack((0.4, 1.0)))
    longest = Lmgc90Settings().longest_time_step
    assert solver.preferred_steps(problem.assembly) == PreferredSteps(time_step=longest)
    state, _ = solver.start(problem)
    original = solver._process.ask
    solver._process.ask = lambda message: asked.append(message) or original(message)
    solver.step(state, Demand(multiplier=0.1, time_step=1.0))
    assert asked[0].time_step == longest


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ({"dilatancy_angle": 5.0}, "no dilatancy"),
        ({"cohesion": 1e3}, "no dilatancy, cohesion"),
        ({"tensile_strength": 1e3}, "tensile strength"),
        ({"normal_stiffness": None}, "normal_stiffness is missing"),
    ],
)
def test_what_lmgc90_cannot_do_is_refused(law, said):
    model = stack((0.4, 1.0), joint=replace(PUBLISHED_JOINT, **law))
    with pytest.raises(EngineError, match=said):
        Lmgc90Engine(driver="wheel").start(problem_of(model))


def test_several_friction_coefficients_are_refused():
    other = JointLaw(friction_coefficient=0.3, normal_stiffness=1e8, shear_stiffness=1e8)
    model = stack((0.4, 1.0), (0.4, 1.0), joint_between={frozenset(("b1", "b2")): other})
    with pytest.raises(EngineError, match="one friction coefficient"):
        Lmgc90Engine(driver="wheel").start(problem_of(model))


def test_concave_blocks_are_refused_by_name():
    outline = np.array([[0, 0], [1, 0], [1, 1], [0.6, 1], [0.6, 0.4], [0, 0.4]], float)
    blocks = [
        Block(id="base", vertices=rectangle(-1, -0.5, 3, 0.5), unit_weight=1e4, support=True),
        Block(id="bent", vertices=outline, unit_weight=1e4),
    ]
    model = make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))
    with pytest.raises(EngineError, match='"bent" is of several convex parts'):
        Lmgc90Engine(driver="wheel").start(problem_of(model))


def test_a_full_lmgc90_leaves_space_to_the_wheel(monkeypatch):
    monkeypatch.setattr(engine.importlib.util, "find_spec", lambda name: object())
    assert engine.module_of("chipy", 2) == "chipy"
    assert engine.module_of("chipy", 3) == engine.module_of("wheel", 3) == "wheel"
    monkeypatch.setattr(engine.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(EngineError, match="in the plane only"):
        engine.module_of("chipy", 3)


def test_contacts_seen_from_the_other_block_push_it_the_same_way():
    rng = np.random.default_rng(5)
    axes = Rotation.random(4, random_state=5).as_matrix()
    outcome = Outcome(
        **NOTHING_MOVES,
        body_a=np.array([0, 3, 1, 2]),
        body_b=np.array([1, 2, 0, 3]),
        position=rng.normal(size=(4, 3)),
        normal=axes[:, 0],
        tangent=axes[:, 1],
        gap=np.zeros(4),
        reaction=rng.normal(size=(4, 3)),
        stiffness=np.ones(4),
    )

    def on_first(found):
        axes = np.concatenate((found.normal[:, None], engine.tangents_of(found)), axis=1)
        on_b = np.einsum("ki,kij->kj", found.reaction, axes)
        return np.where((found.body_b < found.body_a)[:, None], on_b, -on_b)

    lower = engine.lower_first(outcome)
    assert np.all(lower.body_a < lower.body_b)
    np.testing.assert_allclose(on_first(lower), on_first(outcome), atol=1e-15)
    np.testing.assert_array_equal(lower.reaction[:, 0], outcome.reaction[:, 0])


def test_time_steps_in_space_are_as_short_as_stiff_joints_ask_for():
    solver = Lmgc90Engine(driver="wheel")
    soft, stiff = (facade(stiffness).assembly for stiffness in (1e6, 1e10))
    assert solver.preferred_steps(soft) == PreferredSteps(time_step=0.05)
    # Half units 0.2 m wide weigh 80 N: k_n 0.04 m2 / 4 over m / h2 is a thousand.
    wanted = np.sqrt(1e3 * 80.0 / 9.81 / (1e10 * 0.2**2 / 4.0))
    assert solver.preferred_steps(stiff).time_step == pytest.approx(wanted)


def test_a_missing_package_is_said_with_what_to_install(monkeypatch):
    monkeypatch.setattr(engine.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(EngineError, match="pip install --no-deps compas-lmgc90"):
        make_engine("lmgc90")


def test_a_full_lmgc90_goes_before_the_wheel(monkeypatch):
    monkeypatch.setattr(engine.importlib.util, "find_spec", lambda name: object())
    assert engine.installed_driver() == "chipy"


def test_a_prism_is_closed_and_outwards():
    polygon = turned(np.array([[0.0, 0.0], [1.0, 0.0], [0.8, 0.7], [0.1, 0.9]]), 0.3)
    prism = extrude(polygon, 0.5)
    corner = prism.vertices[np.array(prism.faces)]
    # Volume by the divergence theorem: the sum of signed tetrahedra, area times depth.
    volume = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6.0
    x, y = polygon.T
    area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    assert volume == pytest.approx(0.5 * area)
    # Every edge belongs to two triangles, in opposite senses.
    edges = [e for f in prism.faces for e in zip(f, f[1:] + f[:1], strict=True)]
    assert len(set(edges)) == len(edges)
    assert {(j, i) for i, j in edges} == set(edges)


def test_points_at_front_and_back_are_one():
    a = np.array([0, 0, 0, 0, 0])
    b = np.array([1, 1, 1, 1, 2])
    place = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1e-4], [0.0, 1e-4], [0.0, 0.0]])
    np.testing.assert_array_equal(same_place(a, b, place, 1e-3), [0, 1, 1, 0, 2])


def test_the_engine_is_found_by_its_name():
    assert make_engine("lmgc90").name == Lmgc90Engine.name == "lmgc90"
    assert not Lmgc90Engine.capabilities.prescribes_displacement


def test_the_full_lmgc90_is_driven_by_its_names(monkeypatch, tmp_path):
    """On a stand-in: no pylmgc90 is to be had here."""
    monkeypatch.chdir(tmp_path)
    program = fake_pylmgc90.Chipy(
        np.array([0.0, 4000.0]), np.array([True, False]), contacts=[(1, 0), (1, 0)]
    )
    pre = fake_pylmgc90.install(monkeypatch, program)
    from drystone_lmgc90 import chipy

    setup = Setup(
        shapes=(Part(rectangle(-1, -1, 2, 1)), Part(rectangle(-0.2, 0, 0.4, 1.0))),
        axes=np.tile(np.eye(2), (2, 1, 1)),
        density=np.array([1e3, 1e3]),
        fixed=np.array([True, False]),
        thickness=1.0,
        friction=0.65,
        joints={(0, 1): 4e7},
        spare_stiffness=1e7,
        reach=0.1,
        theta=1.0,
        tolerance=5e-6,
        sweeps_per_check=50,
        max_sweeps=100,
        scramble=0,
        time_step=0.05,
    )
    simulation = chipy.Simulation(setup)
    assert len(pre.told("rigidPolygon")) == 2
    assert len(pre.told("imposeDrivenDof")) == 1
    force = np.array([[0.0, 0.0, 0.0], [1000.0, -4000.0, 0.0]])
    step = Step(accept=False, force=force, time_step=0.02, stop_blocks=True)
    outcome = simulation.step(step)
    # The joint's stiffness is shared over its two points, the candidate is our block b.
    assert program.internal == {1: 2e7, 2: 2e7}
    np.testing.assert_array_equal(outcome.body_a, [0, 0])
    np.testing.assert_array_equal(outcome.body_b, [1, 1])
    np.testing.assert_allclose(outcome.reaction, [[2500.0, 100.0]] * 2)  # impulses over 0.02 s
    np.testing.assert_allclose(outcome.gap, -1e-4 + 0.02 * 1e-3)  # where the step started
    assert "StockRloc" not in program.names() and "UpdateStep" not in program.names()
    again = simulation.step(step)
    np.testing.assert_array_equal(again.pose, outcome.pose)
    assert program.moved == 0.0
    simulation.step(replace(step, accept=True))
    assert program.moved == 0.01
    assert program.names().index("StockRloc") < program.names().index("UpdateStep")
