"""Displacements to and fro against closed forms: a block that slides, one that rocks, a stack.

The sliding block of weight W on a bed of area A: the control point is its centroid, at the height
h over the bed.  Its joint gives way by u = mu W / (k_s A) + mu W h^2 / (k_n A (L / 2)^2) before it
slides, as the contacts lie at both ends of its length L.  A loop to +-a is then a parallelogram of
the area 4 mu W (a - u).
"""

import numpy as np
import pytest

import drystone as ds
from drystone.model.assembly import Block
from drystone.model.builders.published import published_wall
from drystone.model.construction.model import make_model
from drystone.verification.blocks import exact_rocking, exact_stack

UNIT_WEIGHT = 10e3  # N/m3
ENGINES = ("equilibrium", "nscd", "distinct")


def rectangle(name, low, high, support=False):
    (x0, y0), (x1, y1) = low, high
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], float)
    return Block(id=name, vertices=corners, unit_weight=UNIT_WEIGHT, support=support)


BASE = rectangle("base", (-1.0, -0.2), (1.0, 0.0), support=True)


def model_of(blocks, friction, point, stiffness=1e9):
    joint = ds.JointLaw(
        friction_coefficient=friction, normal_stiffness=stiffness, shear_stiffness=stiffness
    )
    return make_model(
        [BASE, *blocks],
        joint=joint,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block=blocks[-1].id,
        control_point=point,
    )


FRICTION, LENGTH, HEIGHT, WEIGHT = 0.3, 0.6, 0.4, UNIT_WEIGHT * 0.6 * 0.4


def sliding(stiffness=1e9):
    return model_of([rectangle("b", (-0.3, 0.0), (0.3, HEIGHT))], FRICTION, "centre", stiffness)


def gives_way_by(engine, stiffness=1e9):
    """What the joint gives way by before it slides [m]; in `nscd` joints do not give way along."""
    push = FRICTION * WEIGHT
    turns = push * (0.5 * HEIGHT) ** 2 / (stiffness * LENGTH * (0.5 * LENGTH) ** 2)
    return turns if engine == "nscd" else turns + push / (stiffness * LENGTH)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sliding_block_encloses_a_parallelogram(engine):
    a = 0.01
    curve = ds.pushover(sliding().with_history(amplitudes=[a], cycles=2), engine=engine)
    assert curve.status == "finished" and "all 5 displacements" in curve.reason
    assert curve.is_cyclic and len(curve.cycles) == 2 and all(c.closed for c in curve.cycles)
    second = curve.cycles[1]
    exact = 4.0 * FRICTION * WEIGHT * (a - gives_way_by(engine))
    assert second.energy == pytest.approx(exact, rel=1e-6)
    assert second.greatest == pytest.approx(a, abs=1e-9)
    assert second.least == pytest.approx(-a, abs=1e-9)
    assert second.secant_stiffness == pytest.approx(FRICTION * WEIGHT / a, rel=1e-5)
    assert second.damping == pytest.approx(2.0 / np.pi, rel=1e-3)  # of a rectangle
    assert second.residual_after_greatest == pytest.approx(a, rel=1e-3)


@pytest.mark.parametrize("engine", ENGINES)
def test_on_stiff_joints_the_parallelogram_is_a_rectangle(engine):
    """Joints of 1e12 Pa/m give way by 2e-9 m: the energy is 4 mu W a but for 2e-7 of it."""
    a = 0.01
    curve = ds.pushover(sliding(1e12).with_history(amplitudes=[a], cycles=2), engine=engine)
    assert curve.cycles[1].energy == pytest.approx(4.0 * FRICTION * WEIGHT * a, rel=1e-6)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_displacement_is_reached_and_every_point_is_in_balance(engine):
    targets = (0.004, -0.002, 0.006, 0.003, 0.007, 0.0)
    curve = ds.pushover(sliding().with_history(targets), engine=engine)
    reached = curve.control_displacement
    at = 0
    for target in targets:  # in this order
        near = np.flatnonzero(np.abs(reached[at:] - target) < 1e-9)
        assert len(near), target
        at += int(near[0])
    assert curve.residual.max() < 1e-5


def test_a_rocking_block_goes_there_and_back_on_one_curve():
    """No loss: its load goes with its tilt alone, in both senses; the area is none."""
    half_width, half_height = 0.1, 0.4
    block = rectangle("b", (-half_width, 0.0), (half_width, 2.0 * half_height))
    model = model_of([block], 0.7, "top right", stiffness=1e10)
    curve = ds.pushover(model.with_history([0.05, -0.05, 0.0]), keep_poses=True)
    assert curve.poses is not None and "all 3 displacements" in curve.reason
    angle, load = curve.poses[:, 1, 2], curve.load_multiplier
    tilted = np.abs(curve.control_displacement) > 1e-4  # stands on a corner
    exact = -np.sign(angle) * exact_rocking(angle, 2.0 * half_width, 2.0 * half_height)
    assert np.abs(load[tilted] - exact[tilted]).max() < 1e-6
    (cycle,) = curve.cycles
    assert abs(cycle.energy) < 1e-4 * cycle.force_at_greatest * 0.05


@pytest.mark.parametrize("engine", ENGINES)
def test_engines_agree_on_a_rocking_block(engine):
    """Within 1 % of the closed form, seen from the displacement of the top."""
    half_width, half_height = 0.1, 0.4
    block = rectangle("b", (-half_width, 0.0), (half_width, 2.0 * half_height))
    model = model_of([block], 0.7, "top right")
    curve = ds.pushover(model.with_history([0.03, -0.03, 0.0]), engine=engine, keep_poses=True)
    assert curve.poses is not None
    angle, load = curve.poses[:, 1, 2], curve.load_multiplier
    tilted = np.abs(curve.control_displacement) > 1e-3
    exact = -np.sign(angle) * exact_rocking(angle, 2.0 * half_width, 2.0 * half_height)
    assert np.abs(load[tilted] / exact[tilted] - 1.0).max() < 0.01


@pytest.mark.parametrize(
    ("width", "height", "stiffness", "reach"), [(0.5, 1.0, 1e8, 0.02), (0.4, 0.9, 1e11, 0.2)]
)
def test_a_driven_block_lands_on_its_other_corner_and_turns_in_few_points(
    width, height, stiffness, reach
):
    """A step over the landing cut off a part of the loop, of 3.6 J under twice the weight in the
    second case; near a target there were 24 points.  `equilibrium` ends its steps at every corner:
    0.11 J where joints give way by 0.1 mm, 0.001 J by 0.5 um."""
    block = rectangle("b", (0.0, 0.0), (width, height))
    model = model_of([block], 0.7, "top right", stiffness).with_history([reach, -reach, reach])
    curve = ds.pushover(model, engine="distinct")
    place = curve.control_displacement
    energy = curve.cycles[0].energy
    assert energy == pytest.approx(ds.pushover(model).cycles[0].energy, rel=0.1, abs=2e-3)
    for target in (reach, -reach):
        assert np.abs(place - target).min() < 1e-8
        assert 0 < np.count_nonzero(np.abs(place - target) < 0.01 * reach) <= 10
    assert np.abs(place).max() < reach + 1e-8


def test_a_turn_where_nothing_sticks_takes_few_points():
    """Steps grew from a fiftieth of the closure of the joints, 1e-6 m, by doubling."""
    block = rectangle("b", (0.0, 0.0), (0.4, 0.9))
    model = model_of([block], 0.7, "top right", 1e11).with_history([0.2, -0.2, 0.0])
    place = ds.pushover(model).control_displacement
    assert np.count_nonzero(np.abs(np.abs(place) - 0.2) < 2e-3) <= 12


def stack(stiffness):
    """Two equal blocks, 0.2 m wide and 0.4 m high, on each other."""
    blocks = [
        rectangle("lower", (-0.1, 0.0), (0.1, 0.4)),
        rectangle("upper", (-0.1, 0.4), (0.1, 0.8)),
    ]
    return model_of(blocks, 0.7, "top right", stiffness=stiffness)


#: Of the multiplier.  `nscd` tells it to second order in the angle of a step, 1 mm over 0.8 m: its
#: square is 1.6e-6.
OF_A_STACK = {"equilibrium": 1e-6, "distinct": 1e-6, "nscd": 3e-6}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("stiffness", [1e9, 1e10])
def test_a_stack_of_two_rocks_there_and_back(engine, stiffness):
    """Two equal blocks on each other turn about a corner of the lower, nearly as one."""
    model = stack(stiffness).with_history([0.03, -0.03, 0.0])
    curve = ds.pushover(model, engine=engine, keep_poses=True)
    assert curve.poses is not None and "all 3 displacements" in curve.reason
    angle, load = curve.poses[:, 1, 2], curve.load_multiplier
    tilted = np.abs(curve.control_displacement) > 1e-3
    exact = -np.sign(angle) * exact_stack(angle, 0.2, 0.4, stiffness)
    assert np.abs(load[tilted] - exact[tilted]).max() < OF_A_STACK[engine]
    assert np.abs(load[tilted] / exact[tilted] - 1.0).max() < 0.01


def test_a_cycle_that_passes_a_collapse_ends_there_and_says_so():
    """The block overturns at about 0.2 m: the multiplier falls to zero there."""
    block = rectangle("b", (-0.1, 0.0), (0.1, 0.8))
    model = model_of([block], 0.7, "top right")
    curve = ds.pushover(model.with_history([0.05, -0.05, 0.3, -0.3]))
    assert curve.status == "finished"
    assert "on the way to displacement 3 of 4, 0.3 m" in curve.reason
    assert curve.ultimate_displacement == pytest.approx(0.19, abs=0.01)
    assert curve.load_multiplier[-1] <= curve.stop_multiplier


def test_a_monotonic_history_is_the_monotonic_curve():
    """One displacement, and the curve that ends there: the same law on the same way."""
    block = rectangle("b", (-0.1, 0.0), (0.1, 0.8))
    model = model_of([block], 0.7, "top right")
    there = ds.pushover(model.with_history([0.05]))
    curve = ds.pushover(model.with_analysis(max_displacement=0.05))
    at = np.linspace(0.001, 0.049, 25)
    one = np.interp(at, there.control_displacement, there.load_multiplier)
    other = np.interp(at, curve.control_displacement, curve.load_multiplier)
    assert np.abs(one - other).max() < 1e-5


TO_AND_FRO = (0.05, -0.05, 0.0)  # m


def test_wall_1_under_a_beam_goes_to_and_fro():
    """All of it moves with the beam: nothing falls, and peaks are those of both senses of a wall
    that is the same from both sides."""
    wall = published_wall(1)
    courses = [block for block in wall.assembly.blocks if not block.support]
    top = max(block.vertices[:, 1].max() for block in courses)
    left, right = (
        f(block.vertices[:, 0]) for f, block in ((np.min, courses[0]), (np.max, courses[-1]))
    )
    corners = np.array([[left, top], [right, top], [right, top + 0.175], [left, top + 0.175]])
    beam = Block(id="beam", vertices=corners, unit_weight=UNIT_WEIGHT)
    model = make_model(
        [*wall.assembly.blocks, beam],
        joint=wall.assembly.joint,
        corner=wall.assembly.corner,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block="beam",
        control_point="centre",
    )
    curve = ds.pushover(model.with_history(TO_AND_FRO))
    assert "all 3 displacements" in curve.reason and not curve.blocks_left
    assert curve.control_displacement[-1] == pytest.approx(0.0, abs=1e-9)
    assert curve.residual.max() < 1e-8
    there, back = curve.load_multiplier.max(), -curve.load_multiplier.min()
    assert back == pytest.approx(there, rel=1e-3)


def test_wall_1_by_its_corner_loses_what_the_corner_does_not_hold():
    """To the left the corner of the upper right block takes no part in the collapse: the other
    flank falls at the peak of that sense, which is that of the wall seen from behind."""
    curve = ds.pushover(published_wall(1).with_history(TO_AND_FRO))
    assert "all 3 displacements" in curve.reason
    assert curve.control_displacement[-1] == pytest.approx(0.0, abs=1e-9)
    assert curve.residual.max() < 1e-8  # of every point, of blocks that have not left
    falls = [event for event in curve.events if event.kind == "block_fallen"]
    assert falls[0].load_multiplier == pytest.approx(-0.578, abs=1e-3)
    assert {block[-2:] for block in falls[0].blocks} <= {"u1", "u2", "u3"}
