"""How analyses begin and end, over all engines: settlement, joints crushed, blocks that leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import PUBLISHED_JOINT, UNIT_WEIGHT, rectangle, stack, stiff_joint
from drystone.analysis.driver import pushover
from drystone.contact.contacts import Slots
from drystone.contact.detection import Detector
from drystone.engines.base import EngineError, Problem
from drystone.engines.departure import departing
from drystone.engines.measures import LoadArrays
from drystone.limit import collapse_load, limits_beside
from drystone.model.assembly import Block
from drystone.model.builders import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.loading import SurchargeLoad, TiltPattern
from drystone.model.loading.forces import ForcesPattern
from drystone.model.loading.targets import PointForce
from drystone.model.model import Analysis
from drystone.results.curve import STATIC, BlockLeft
from random_kinds import KINDS
from structures import structure

ENGINES = pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])


def leaning():
    """A block that leans over by 0.1 m along the load, so that it sinks along it."""
    outline = np.array([[-0.2, 0.0], [0.2, 0.0], [0.3, 0.9], [-0.1, 0.9]])
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 2, 1), unit_weight=UNIT_WEIGHT, support=True),
        Block(id="leaning", vertices=outline, unit_weight=UNIT_WEIGHT),
    ]
    return make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(1.0, 0.0))


@ENGINES
def test_a_stop_value_changes_where_a_curve_ends_and_nothing_before(engine):
    model = KINDS["arches-plane"](10)
    whole, part = (pushover(model, engine=engine, stop_multiplier=stop) for stop in (0.01, 0.1))
    assert len(whole.points) > len(part.points) > 20
    n = len(part.points) - 1  # the last step is shortened to end there
    assert part.points[:n] == whole.points[:n]


@ENGINES
def test_curves_begin_where_the_load_does(engine):
    """With the weight W off the middle by e, two contact points b apart close by W/2 (1 -+ 2e/b)
    over k_n b/2 each, which turns the block by 4 W e / (k_n b^3)."""
    curve = pushover(leaning(), engine=engine, max_steps=3, keep_poses=True)
    weight, e, b, height = 0.4 * 0.9 * UNIT_WEIGHT, 0.05, 0.4, 0.9
    turn = 4.0 * weight * e / (PUBLISHED_JOINT.normal_stiffness * b**3)
    # The turned block's weight acts 5e-5 m further out, 1e-3 of e; nscd stops a thousandth
    # of the closing short of rest.
    assert curve.settlement == pytest.approx(height * turn, rel=5e-3)
    assert curve.control_displacement[0] == 0.0
    assert curve.load_multiplier[0] == pytest.approx(0.0, abs=1e-3)
    # Poses stay those from the designed places.
    assert curve.poses[0][1, 2] == pytest.approx(-turn, rel=5e-3)
    model = leaning()
    moved = [model.control_point.displacement(model.assembly, pose) for pose in curve.poses]
    assert curve.control_displacement == pytest.approx(
        np.array(moved) - curve.settlement, abs=1e-15
    )


def lifted():
    """A block of 0.4 by 0.9 m on a base of 2 m that a load lifts."""
    base = rectangle(-1, -1, 2, 1)
    blocks = [
        Block(id="base", vertices=base, unit_weight=UNIT_WEIGHT, support=True),
        Block(id="b", vertices=rectangle(-0.2, 0.0, 0.4, 0.9), unit_weight=UNIT_WEIGHT),
    ]
    return make_model(blocks, joint=PUBLISHED_JOINT, thickness=1.0, load_direction=(0.0, 1.0))


@pytest.mark.parametrize("most", [None, 3.0])
def test_a_block_that_is_lifted_stops_the_run(most):
    """Its weight is what it takes, for ever: the run stops where it has risen by 2 m, or as far
    as it is asked to."""
    options = {} if most is None else {"max_displacement": most}
    curve = pushover(lifted(), **options)
    assert curve.status == ("stopped" if most is None else "finished")
    assert curve.control_displacement[-1] == pytest.approx(most or 2.0, abs=0.1)
    assert curve.peak.load_multiplier == pytest.approx(1.0, rel=1e-6)


@ENGINES
def test_the_largest_displacement_counts_from_where_the_load_begins(engine):
    settlement = pushover(leaning(), engine=engine, max_steps=1).settlement
    most = 5.0 * settlement
    curve = pushover(leaning(), engine=engine, max_displacement=most)
    assert curve.status == "finished"
    last = curve.control_displacement[-2:]
    assert last[0] < most and last[1] >= most * (1.0 - 1e-9)  # rounding


STIFF_JOINT = JointLaw(friction_coefficient=0.9, normal_stiffness=1e10, shear_stiffness=1e10)
SLIPPERY = JointLaw(friction_coefficient=0.2, normal_stiffness=1e10, shear_stiffness=1e10)
#: A block 0.4 m wide and 1 m high carries tan(ANGLE) on its toe, and tan(ANGLE - theta) turned by
#: theta; its upper corner, right above the toe at first, is then at sin(theta).
ANGLE = np.arctan(0.4)


def falling(**analysis):
    """A small block near the edge of the base slides at 0.2 and falls off; a tall one rocks on."""
    outlines = {
        "base": rectangle(-1.0, -0.5, 2.0, 0.5),
        "small": rectangle(0.78, 0.0, 0.2, 0.1),
        "tall": rectangle(-0.8, 0.0, 0.4, 1.0),
    }
    blocks = [
        Block(id=name, vertices=outline, unit_weight=20e3, support=name == "base")
        for name, outline in outlines.items()
    ]
    return make_model(
        blocks,
        joint=STIFF_JOINT,
        joint_between={frozenset({"base", "small"}): SLIPPERY},
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block="tall",
        control_point=(-0.4, 1.0),
        analysis=Analysis(**analysis),
    )


def fallen(engine, **options):
    return pushover(falling(), engine=engine, max_steps=4000, keep_poses=True, **options)


@ENGINES
def test_a_block_that_falls_off_is_told_and_the_rest_goes_on(engine):
    curve = fallen(engine)
    assert curve.status == "finished", curve.reason
    (left,) = curve.blocks_left
    assert left.block == "small" and '"small" left the structure' in curve.reason
    assert left.control_displacement == curve.points[left.step].control_displacement
    # Where it was last it stays: it is no part of what is balanced.
    small = curve.poses[left.step + 1 :, 1]
    assert np.all(small == small[0])

    static = np.array([point.status == STATIC for point in curve.points])
    d, multiplier = curve.control_displacement, curve.load_multiplier
    branch = static & (np.arange(len(d)) > curve.peak.step)
    exact = np.tan(ANGLE - np.arcsin(d[branch]))
    # The toe, a hundredth of the edge long, closes by 8000 N / (1e10 Pa/m 0.004 m2) = 0.2 mm at
    # most, and less where it is not yet alone.
    tolerance = 2e-4
    assert np.count_nonzero(branch) > 100
    assert multiplier[branch] == pytest.approx(exact, abs=tolerance)
    end = np.sin(ANGLE - np.arctan(0.01))
    assert curve.ultimate_displacement == pytest.approx(end, abs=tolerance)
    # What is applied is carried, by the blocks that are left, but for what accelerates.
    excess = np.abs(curve.applied_multiplier - multiplier)[branch]
    assert np.all(np.abs(curve.carried_multiplier - multiplier)[branch] <= excess + 1e-3)


def test_a_bound_on_the_whole_structure_is_none_on_the_rest():
    """The small block slides at 0.2, where the whole collapses; the tall one then carries 0.4."""
    curve = fallen("equilibrium")
    bound = limits_beside(falling())
    assert bound.associative == pytest.approx(0.2, abs=1e-6)
    assert curve.peak.load_multiplier > 0.39
    assert 0.19 < curve.capacity.load_multiplier <= 0.2 + 1e-6  # the last point before it slides
    assert bound.warning(curve, falling()) is None


@pytest.mark.parametrize(("at", "said"), [(-1.7e-8, "0 m"), (5.21e-5, "5.21e-05 m")])
def test_no_rounding_is_named_as_the_place_where_a_block_left(at, said):
    left = BlockLeft(block="small", step=92, control_displacement=at)
    assert str(left) == f'the block "small" left the structure at {said} (step 92)'


def test_a_fall_takes_no_more_points_than_a_slide():
    """It slides 0.12 m to over the edge and turns there, by some millimetres to a point; the fall
    of half a metre to the ground adds none."""
    curve = fallen("equilibrium")
    dynamic = sum(point.status != STATIC for point in curve.points)
    assert 0 < dynamic < 200


@ENGINES
def test_an_analysis_may_end_where_a_block_collapses(engine):
    curve = fallen(engine, falling="stop")
    assert curve.status == "finished" and 'falling is "stop"' in curve.reason
    assert curve.first_collapse.blocks == ("small",)
    assert all(block.step == curve.points[-1].step for block in curve.blocks_left)


def against_a_support(gap=0.0, **analysis):
    """A block, 0.4 m, on a plane with a fixed one beside it, to where the load pushes."""
    outlines = {
        "base": rectangle(-1.0, -1.0, 4.0, 1.0),
        "pushed": rectangle(-0.2, 0.0, 0.4, 0.4),
        "wall": rectangle(0.2 + gap, 0.0, 0.4, 0.4),
    }
    blocks = [
        Block(id=name, vertices=outline, unit_weight=UNIT_WEIGHT, support=name != "pushed")
        for name, outline in outlines.items()
    ]
    return make_model(
        blocks,
        joint=PUBLISHED_JOINT,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        analysis=Analysis(**analysis),
    )


STRATEGIES = pytest.mark.parametrize(
    ("engine", "strategy"),
    [
        ("equilibrium", "displacement"),
        ("nscd", "displacement"),
        ("nscd", "published"),
        ("distinct", "displacement"),
        ("distinct", "published"),
    ],
)


@STRATEGIES
def test_a_load_that_locks_the_structure_is_said_so(engine, strategy):
    """It was pressed half a metre into its support, with a peak of 50,000, "finished"."""
    model = against_a_support(engine=engine, strategy=strategy)
    curve = pushover(model, increment=0.1)
    assert curve.status == "stopped"
    assert curve.reason == "the load locks the structure: no multiple of it brings it down"
    assert curve.load_multiplier.max() <= 5.0


@pytest.mark.parametrize("unit", [1e-2, 1e5])
def test_a_load_locks_whatever_its_unit(unit):
    """Of forces five times as large as the block's weight on, not of multipliers."""
    model = against_a_support(engine="equilibrium", strategy="displacement")
    weight = 0.4 * 0.4 * UNIT_WEIGHT
    push = PointForce(block="pushed", force=np.array([unit, 0.0]))
    curve = pushover(replace(model, load=ForcesPattern(entries=(push,))), increment=0.1)
    assert "the load locks the structure" in curve.reason
    assert curve.load_multiplier.max() * unit <= 5.0 * weight
    assert curve.load_multiplier.max() * unit >= 0.5 * weight


@STRATEGIES
def test_blocks_pressed_into_each_other_end_the_run(engine, strategy):
    """Behind a gap of 1 mm: limit analysis knows the structure as designed, which slides."""
    share = 1e-3
    model = against_a_support(1e-3, engine=engine, strategy=strategy, max_penetration=share)
    # Half of the penetration that is allowed: a step ends in it, behind the gap.
    curve = pushover(model, increment=0.1, displacement_step=0.5 * share * 0.4)
    assert curve.status == "stopped"
    assert '"pushed" and "wall" are pressed' in curve.reason
    assert "max_penetration" in curve.reason
    # The block slides at 0.65 until it is through the gap, but for roundings.
    assert curve.control_displacement[-1] > 1e-3 * (1.0 - 1e-9)
    assert curve.load_multiplier[-1] > 0.64
    assert curve.column("penetration").max() <= share * 0.4


@ENGINES
def test_no_joint_closes_by_a_twentieth_of_a_block(engine):
    """What nothing is said about: 0.05 of 0.4 m.  `nscd` pressed on by 0.01 of the multiplier in
    each of 50,000 steps."""
    curve = pushover(against_a_support(0.05), engine=engine, max_steps=3000)
    assert curve.status == "stopped" and '"pushed" and "wall"' in curve.reason
    assert 0.01 < curve.column("penetration").max() <= 0.02


@ENGINES
def test_joints_crushed_by_the_weight_alone_carry_no_analysis(engine):
    """A joint of 0.4 m2 closes by 1e4 0.4^2 N / (1e5 Pa/m 0.4 m2) = 0.04 m."""
    soft = JointLaw(friction_coefficient=0.65, normal_stiffness=1e5, shear_stiffness=1e5)
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 4, 1), unit_weight=UNIT_WEIGHT, support=True),
        Block(id="on", vertices=rectangle(0, 0, 0.4, 0.4), unit_weight=UNIT_WEIGHT),
    ]
    model = make_model(blocks, joint=soft, thickness=1.0, load_direction=(1.0, 0.0))
    with pytest.raises(EngineError, match=r'"base" and "on" are pressed 0\.04'):
        pushover(model, engine=engine)
    assert pushover(model, engine=engine, max_penetration=0.2, max_steps=3).n_steps == 3


def test_steep_but_finite_multipliers_are_no_lock():
    """A block ten times as wide as high, rough as nothing is, topples at 10 about its toe."""
    rough = JointLaw(friction_coefficient=20.0, normal_stiffness=1e9, shear_stiffness=1e9)
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 9, 1), unit_weight=UNIT_WEIGHT, support=True),
        Block(id="flat", vertices=rectangle(0, 0, 4, 0.4), unit_weight=UNIT_WEIGHT),
    ]
    model = make_model(blocks, joint=rough, thickness=1.0, load_direction=(1.0, 0.0))
    curve = pushover(model)
    assert curve.status == "finished"
    # It peaks turned by 2e-4, 0.08 mm over its height: tan(arctan 10 - 2e-4) = 9.98.
    assert curve.peak.load_multiplier == pytest.approx(10.0, abs=0.02)


@pytest.mark.parametrize("level", [None, 0.3])
def test_blocks_below_the_ground_have_left(level):
    """Above it they have not, where something lies in their way."""
    model = falling()
    assembly = model.assembly
    problem = Problem(
        assembly=assembly, load=model.load, control_point=model.control_point, ground=level
    )
    detector, pose = Detector(assembly), assembly.design_pose()
    pose[1, 1] = 0.05  # lifted a little above the base
    pairs = detector.pairs(pose)
    slots = Slots.empty(pairs.n_slots, 2)
    detector.fill(pairs, pose, slots)
    arguments = (detector, LoadArrays.of(problem), pose, 0.0, pairs, slots)
    left = departing(problem, *arguments, np.zeros((len(slots.kind), 2)))
    assert left.tolist() == [False, level == 0.3, False]


def test_blocks_leave_together_past_what_is_no_obstacle():
    """Two blocks, one upon the other, beside the base: both fall, and neither stops the other."""
    model = falling()
    assembly = model.assembly
    problem = Problem(assembly=assembly, load=model.load, control_point=model.control_point)
    detector, pose = Detector(assembly), assembly.design_pose()
    pose[1, :2] = 0.5, -0.2  # the small one beside the base
    pose[2, :2] = 2.0, 0.5  # the tall one high above it
    pairs = detector.pairs(pose)
    slots = Slots.empty(pairs.n_slots, 2)
    detector.fill(pairs, pose, slots)
    arguments = (detector, LoadArrays.of(problem), pose, 0.0, pairs, slots)
    nothing = np.zeros((len(slots.kind), 2))
    assert departing(problem, *arguments, nothing).tolist() == [False, True, True]
    pose[1, 0] = 0.0  # back over the base, inside it: neither the small one nor what is above it
    assert departing(problem, *arguments, nothing).tolist() == [False, False, True]


def test_what_carries_all_that_is_applied_is_at_rest_in_the_published_strategy():
    """The engine called its timed steps dynamic, so that the curve had no peak.

    A block of 0.4 m by 0.9 m overturns at 0.444; the last multiplier in balance lies at most one
    increment below, or above by the tolerance of balance, 1e-3.
    """
    model = stack((0.4, 0.9), joint=stiff_joint(0.65))
    curve = pushover(model, engine="equilibrium", strategy="published", max_displacement=0.01)
    assert 0.4 / 0.9 - 0.006 <= curve.peak.load_multiplier <= 0.4 / 0.9 + 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("steps", [{}, {"displacement_step": 3e-3}, {"displacement_step": 1e-3}])
def test_a_far_equilibrium_below_the_stop_value_ends_no_curve(steps):
    """Arch 333 stands on, by its joints that slip one after another.

    A small step, or the first one of a jump, had found an equilibrium elsewhere.  The curve ended
    there, "finished", at a third of its peak; `distinct` moves on through it.  With steps of 1 mm
    no jump was ever over, as the next joint slipped before.
    """
    ours = pushover(structure(333), engine="equilibrium", **steps)
    other = pushover(structure(333), engine="distinct")
    assert ours.status == "finished"
    peaks = ours.peak.load_multiplier, other.peak.load_multiplier
    assert peaks[0] == pytest.approx(peaks[1], rel=0.01)
    assert ours.ultimate_displacement == pytest.approx(other.ultimate_displacement, rel=0.01)


@pytest.mark.slow
def test_the_end_of_a_wall_whose_bonds_break_does_not_depend_on_the_steps():
    """Bonds break one after another.  Between them the wall is at rest.

    Jumps were over only after long time steps, and went on through the next bond.  With default
    steps the wall ended at 0.024 m, with steps of 0.3 mm at 0.041 m.
    """
    model = KINDS["bonded"](2)
    ends = [
        pushover(model, engine="equilibrium", **steps).points[-1].control_displacement
        for steps in ({}, {"displacement_step": 1e-3})
    ]
    assert ends[0] == pytest.approx(ends[1], rel=0.05)


@pytest.mark.parametrize("engine", ["equilibrium", "distinct"])
def test_what_stands_on_a_ground_turned_upright_has_no_peak(engine):
    """A force without mass presses the block on, with the block's weight, however the ground turns.

    By `distinct` the block had "collapsed in motion", at a multiplier of 1e11.
    """
    load = TiltPattern(direction=np.array([1.0, 0.0]))
    pressing = SurchargeLoad(block="b1", weight=5.0 * UNIT_WEIGHT * 0.8 * 0.4, mass=False)
    model = stack((0.8, 0.4), joint=stiff_joint(0.7)).with_load(load, dead_loads=(pressing,))
    assert collapse_load(model).status == "locked"
    curve = pushover(model, engine=engine)
    assert curve.status == "stopped" and "no angle brings the structure down" in curve.reason
    assert 1e3 < curve.points[-1].load_multiplier < 1e4


@ENGINES
def test_a_slender_wall_is_followed_to_a_tenth_of_its_peak(engine):
    """It overturns at b / h = 0.05, and carries a tenth of that at nine tenths of b.

    A stop value that somebody gives ends it there.
    """
    model = stack((0.1, 2.0), joint=stiff_joint(0.6))
    curve = pushover(model, engine=engine)
    peak = curve.peak.load_multiplier
    assert peak == pytest.approx(0.05, rel=0.02)
    assert curve.status == "finished"
    assert curve.stop_multiplier == pytest.approx(0.1 * peak, rel=1e-9)
    assert 0.0 <= curve.points[-1].load_multiplier < curve.stop_multiplier
    assert curve.ultimate_displacement == pytest.approx(0.09, rel=0.03)
    asked = pushover(model, engine=engine, stop_multiplier=0.02)
    assert asked.stop_multiplier == 0.02
    assert asked.ultimate_displacement == pytest.approx(0.06, rel=0.03)


def drawn_up(*stones, stiffness=1e9):
    """Stones of 0.5 m x 0.3 m at given corners [m], of which a force of 1 kN lifts the first."""
    joint = replace(PUBLISHED_JOINT, normal_stiffness=stiffness, shear_stiffness=stiffness)
    base = Block(id="base", vertices=rectangle(-1, -1, 4, 1), unit_weight=20e3, support=True)
    blocks = [
        Block(id=f"s{i}", vertices=rectangle(*at, *size), unit_weight=20e3)
        for i, (*at, size) in enumerate(stones)
    ]
    lift = PointForce(block="s0", force=np.array([0.0, 1e3]))
    model = make_model(
        [base, *blocks],
        joint=joint,
        thickness=1.0,
        load_direction=(0.0, 1.0),
        control_block="s0",
        control_point="centre",
        control_direction=(0.0, 1.0),
    )
    return replace(model, load=ForcesPattern(entries=(lift,)))


@ENGINES
def test_a_stone_that_is_lifted_weighs_what_it_does(engine):
    """0.5 m x 0.3 m x 20 kN/m3 are 3 kN.  In flight it bears nothing, however little it
    accelerates.  The step in which it leaves counts as at rest: in `nscd` it is one of time."""
    bound = 1e-2 if engine == "nscd" else 1e-6
    curve = pushover(drawn_up((0.0, 0.0, (0.5, 0.3)), (1.0, 0.0, (0.5, 0.3))), engine=engine)
    assert curve.status == "stopped"
    assert curve.peak.load_multiplier == pytest.approx(3.0, rel=bound)


@ENGINES
def test_a_load_on_nothing_that_is_left_ends_the_run(engine):
    """A stone is drawn out from under two others, and leaves with all of the load.  What it takes
    is within the range of limit analysis, 6.62 to 6.71."""
    whole, half = (0.5, 0.3), (0.25, 0.3)
    stones = [(0.0, 0.0, whole), (0.5, 0.0, whole), (0.0, 0.3, half), (0.25, 0.3, whole)]
    model = drawn_up(*stones, (0.75, 0.3, half))
    curve = pushover(model, engine=engine)
    low, high = collapse_load(model, flow="non-associative").collapse_range
    # Elastic joints lean; what is left out of balance in `nscd` is a step of the load.
    assert low * (1.0 - 5e-3) < curve.capacity.load_multiplier < high * (1.0 + 5e-3)
