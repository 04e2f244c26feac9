"""Ties against closed forms: blocks that rock, held by bars that stretch, yield and break.

Of a block that rocks on a vertex the moments of weight, load and tie about that vertex vanish,
wherever it has come to.  The pose alone gives the tie's length, and so its force and the
multiplier.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import drystone as ds
from builders import problem_of, rectangle, stack
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.dynamics.distinct.workspace import Workspace
from drystone.model.ties import names_of

UNIT_WEIGHT, THICKNESS = 20e3, 0.5
WIDTH, HEIGHT = 0.4, 1.0
WEIGHT = UNIT_WEIGHT * WIDTH * HEIGHT * THICKNESS  # 4 kN
WALL, ANCHOR = (0.0, 0.8), (-1.0, 0.8)
STIFFNESS, STRENGTH = 1e5, 2e3  # N/m, N
#: Of rocking branches, over the larger of 1 and the multiplier: a static step of 30 s leaves
#: inertia of 3e-7 of the weight (`equilibrium`), cycles end at 1e-5 of it (`distinct`); `nscd`
#: tells the multiplier where a step begins, its displacement where it ends: a step of 2 mm times
#: the branch's slope, here up to 1.5 per metre of the control point.
EXACT = {"equilibrium": 1e-6, "distinct": 1e-4, "nscd": 4e-3}


def box(name, x, width=WIDTH, height=HEIGHT, y=0.0, **more):
    corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    return ds.Block(id=name, vertices=np.array(corners), unit_weight=UNIT_WEIGHT, **more)


def model_of(ties, *others, **more):
    """A block on rock, and others beside it."""
    return ds.make_model(
        [box("ground", -1.0, 6.0, 0.5, -0.5, support=True), box("b", 0.0), *others],
        joint=ds.JointLaw(friction_coefficient=5.0, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=THICKNESS,
        load_direction=[1.0, 0.0],
        ties=ties,
        **more,
    )


def tie(**more):
    given = {
        "start": ds.TieEnd(point=np.array(ANCHOR)),
        "end": ds.TieEnd(block="b", point=np.array(WALL)),
        "stiffness": STIFFNESS,
        "yield_force": STRENGTH,
        "compression": False,
        "name": "t",
    }
    return ds.Tie(**{**given, **more})


def place(model, block, point, pose):
    """(x, z) of a material point."""
    point = np.asarray(point, float)
    if model.assembly.dimension == 3:
        point = np.array([point[0], 0.5 * THICKNESS, point[1]])
    moved = point + model.assembly.displacement_at(block, point, pose)
    return moved[[0, -1]]


def carried(model, block, pose, at, force, x=0.0):
    """Multiplier of a block at ``x`` that rocks, a force (2,) [N] acting at a point of it."""
    toe = place(model, block, (x + WIDTH, 0.0), pose)
    centre = place(model, block, (x + 0.5 * WIDTH, 0.5 * HEIGHT), pose) - toe
    arm = place(model, block, at, pose) - toe
    moment = arm[0] * force[1] - arm[1] * force[0]
    return (moment - centre[0] * WEIGHT) / (centre[1] * WEIGHT)


def law(elongation, plastic, one):
    """Force and plastic elongation of a tie that is not broken."""
    trial = one.pretension + one.per_length * (elongation - plastic)
    force = min(max(trial, -one.strength if one.compression else 0.0), one.strength)
    return force, plastic + max(trial - one.strength, 0.0) / one.per_length


def errors_of(model, curve):
    """Errors of multiplier and tie force over the rocking branch, by the poses alone."""
    (one,) = model.ties
    plastic, whole, errors, forces = 0.0, True, [], []
    for k, (point, pose) in enumerate(zip(curve.points, curve.poses, strict=True)):
        end = place(model, 1, WALL, pose)
        line = end - ANCHOR
        length = np.linalg.norm(line)
        force, plastic = law(length - 1.0, plastic, one)
        whole = whole and curve.ties.state(k, 0) != "broken"
        if not whole:
            force = 0.0
        tilt = abs(ds_angle(pose[1]))
        held = curve.engine == "equilibrium" and point.inertia_ratio > 5e-6
        if tilt < 0.004 or point.status != "static" or point.jumped or held:
            continue  # a joint still closes, or inertia holds it where a tie has just broken
        exact = carried(model, 1, pose, WALL, -force * line / length)
        errors.append((point.load_multiplier - exact) / max(1.0, abs(exact)))
        forces.append((curve.ties.force[k, 0] - force) / STRENGTH)
        assert curve.ties.elongation[k, 0] == pytest.approx(length - 1.0, abs=1e-6)
    assert len(errors) > 10
    return np.abs(errors).max(), np.abs(forces).max()


def ds_angle(pose):
    return pose[2] if len(pose) == 3 else 2.0 * math.atan2(np.linalg.norm(pose[4:]), pose[3])


CASES = {
    "yielding": tie(),
    "breaking": tie(breaking_elongation=0.05),
    "pretension": tie(pretension=500.0),
    "anchorage": tie(anchorage_force=1500.0),
    "both ways": tie(compression=True),
    "by area": tie(stiffness=None, area=1e-4, young_modulus=1e9),
}


@pytest.mark.parametrize("engine", EXACT)
@pytest.mark.parametrize("case", CASES)
def test_tie_on_a_rocking_block(case, engine):
    if engine != "equilibrium" and case not in ("breaking", "pretension"):
        pytest.skip("the law of ties is one")
    model = model_of((CASES[case],))
    curve = ds.pushover(model, engine=engine, keep_poses=True)
    assert curve.status == "finished"
    error, force = errors_of(model, curve)
    assert error < EXACT[engine]
    assert force < EXACT[engine]
    assert ("broken" in {curve.ties.state(k, 0) for k in range(len(curve.points))}) == (
        case == "breaking"
    )


@pytest.mark.parametrize("engine", EXACT)
def test_tie_in_space(engine):
    model = ds.extruded(model_of((CASES["breaking"],)))
    curve = ds.pushover(model, engine=engine, keep_poses=True)
    error, force = errors_of(model, curve)
    assert error < EXACT[engine]
    assert force < EXACT[engine]


def corner(one):
    """Rotation and multiplier at which the tie begins to yield, of a rigid block on its toe."""
    e = (one.strength - one.pretension) / one.per_length
    toe = np.array([WIDTH, 0.0])

    def turned(angle, point):
        c, s = math.cos(angle), math.sin(angle)
        x, y = np.subtract(point, toe)
        return toe + (c * x + s * y, -s * x + c * y)

    low, high = 0.0, 0.5
    for _ in range(100):
        middle = 0.5 * (low + high)
        longer = np.linalg.norm(turned(middle, WALL) - ANCHOR) - 1.0 > e
        low, high = (low, middle) if longer else (middle, high)
    line = turned(low, WALL) - ANCHOR
    arm, centre = turned(low, WALL) - toe, turned(low, (0.2, 0.5)) - toe
    force = -one.strength * line / np.linalg.norm(line)
    moment = arm[0] * force[1] - arm[1] * force[0]
    return low, (moment - centre[0] * WEIGHT) / (centre[1] * WEIGHT)


@pytest.mark.parametrize("name", ["yielding", "anchorage", "pretension"])
@pytest.mark.parametrize("engine", ["equilibrium", "distinct"])
@pytest.mark.parametrize("space", [False, True])
def test_peak_is_where_the_tie_begins_to_yield(name, engine, space):
    """Steps end there to 5e-5 of the strength; the toe sinks by 1e-5 of the height."""
    if space and name == "anchorage":
        pytest.skip("a strength is as good as another")
    model = model_of((CASES[name],))
    curve = ds.pushover(ds.extruded(model) if space else model, engine=engine, max_displacement=0.1)
    _, multiplier = corner(CASES[name])
    assert curve.peak.load_multiplier == pytest.approx(multiplier, rel=1e-4)


@pytest.mark.parametrize("engine", ["equilibrium", "distinct"])
def test_pretension_does_not_draw_a_block_along(engine):
    """Weight and pretension come together: 500 N on a joint that holds 0.2 of 4 kN."""
    model = model_of((CASES["pretension"],)).with_joint(friction_coefficient=0.2)
    curve = ds.pushover(model, engine=engine, max_steps=1, keep_poses=True)
    # Elastic: shear by 500 N / (1e9 Pa/m of 0.2 m2), and rocking on the joint's springs.
    assert abs(curve.poses[0][1, 0]) < 5e-5


def test_breaking_is_a_tooth_of_the_curve():
    """The tie holds its strength up to the breaking elongation, then none, at the same place."""
    model = model_of((CASES["breaking"],))
    curve = ds.pushover(model)
    broken = [curve.ties.state(k, 0) == "broken" for k in range(len(curve.points))].index(True)
    last, first = curve.points[broken - 1], curve.points[broken]
    assert curve.ties.elongation[broken - 1, 0] == pytest.approx(0.05, rel=1e-4)
    assert last.control_displacement == pytest.approx(first.control_displacement, abs=1e-9)
    assert last.load_multiplier - first.load_multiplier > 0.75  # 0.81 by moments
    assert not curve.ties.force[broken:, 0].any()


@pytest.mark.parametrize("engine", EXACT)
@pytest.mark.parametrize("elongation", [0.002, 0.02])
def test_an_elastic_tie_breaks_where_it_is_to_break(engine, elongation):
    """Its force is never larger than that at which it breaks, however long the steps."""
    model = model_of((tie(breaking_elongation=elongation, yield_force=1e6),))
    curve = ds.pushover(model, engine=engine, keep_poses=True)
    k = max(k for k in range(len(curve.points)) if curve.ties.state(k, 0) == "elastic")
    assert curve.ties.state(k + 1, 0) == "broken"
    assert curve.ties.elongation[k, 0] == pytest.approx(elongation, rel=2e-2)
    assert curve.ties.elongation[: k + 1, 0].max() <= (1.0 + 1e-3) * elongation
    end = place(model, 1, WALL, curve.poses[k])
    line = end - ANCHOR
    force = STIFFNESS * elongation * line / np.linalg.norm(line)
    exact = carried(model, 1, curve.poses[k], WALL, -force)
    assert curve.points[k].load_multiplier == pytest.approx(exact, rel=2e-2)


@pytest.mark.parametrize("engine", EXACT)
def test_a_tie_breaks_as_its_support_moves_away(engine):
    """The support is never pulled by more than the force at which the tie breaks."""
    breaking = 0.0021
    away = {"block": None, "point": np.array((-1.0, 0.05))}
    model = ds.make_model(
        [
            box("rock", -3.0, 1.0, 0.5, -0.5, support=True),
            box("sled", 0.0, 1.0, 0.5, -0.5, support=True),
            box("b", 0.0),
        ],
        joint=ds.JointLaw(friction_coefficient=5.0, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=THICKNESS,
        ties=[
            tie(
                start=ds.TieEnd(**away),
                end=ds.TieEnd(block="b", point=np.array((0.0, 0.05))),
                breaking_elongation=breaking,
                yield_force=1e6,
            )
        ],
        settlement=ds.Settlement(blocks=("sled",), direction=np.array([1.0, 0.0]), max=0.01),
    )
    curve = ds.pushover(model, engine=engine)
    assert curve.status == "finished"
    assert np.abs(curve.reaction).max() == pytest.approx(STIFFNESS * breaking, rel=2e-3)
    assert curve.ties.state(len(curve.points) - 1, 0) == "broken"


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
@pytest.mark.parametrize("space", [False, True])
def test_limit_analysis_takes_the_strength(flow, space):
    """Moments about the toe as designed: (W b/2 + S 0.8) / (W h/2)."""
    model = model_of((tie(anchorage_force=1500.0),))
    model = ds.extruded(model) if space else model
    found = ds.collapse_load(model, flow=flow)
    exact = (WEIGHT * 0.5 * WIDTH + 1500.0 * 0.8) / (WEIGHT * 0.5 * HEIGHT)
    assert found.load_multiplier == pytest.approx(exact, rel=1e-8)
    assert found.tie_forces == pytest.approx([1500.0], rel=1e-8)


def test_limit_analysis_of_a_strut():
    """A bar on the other side is compressed: it counts only if it can be."""
    for compression, force in ((True, 2e3), (False, 0.0)):
        bar = replace(
            tie(compression=compression), start=ds.TieEnd(point=np.array([2.0, 0.8])),
            end=ds.TieEnd(block="b", point=np.array([0.4, 0.8])),
        )  # fmt: skip
        found = ds.collapse_load(model_of((bar,)), flow="associative")
        exact = (WEIGHT * 0.5 * WIDTH + force * 0.8) / (WEIGHT * 0.5 * HEIGHT)
        assert found.load_multiplier == pytest.approx(exact, rel=1e-8)
        assert found.tie_forces == pytest.approx([-force], abs=1e-6)


def floor(stiffness=2e5):
    """A spring between the tops of two blocks of other widths, which rock together."""
    spring = ds.spring(
        start=ds.TieEnd(block="b", point=np.array([WIDTH, 0.9])),
        end=ds.TieEnd(block="c", point=np.array([2.0, 0.7])),
        stiffness=stiffness,
        name="floor",
    )
    return model_of((spring,), box("c", 2.0, width=0.6))


@pytest.mark.parametrize("engine", ["equilibrium", "distinct"])
def test_spring_between_two_blocks(engine):
    """Both blocks in balance under one multiplier; the slender one leans on the other."""
    model = floor()
    curve = ds.pushover(model, engine=engine, keep_poses=True, max_displacement=0.2)
    checked = 0
    for k, (point, pose) in enumerate(zip(curve.points, curve.poses, strict=True)):
        if min(abs(pose[1:, 2])) < 0.004 or point.status != "static":
            continue
        first, last = place(model, 1, (WIDTH, 0.9), pose), place(model, 2, (2.0, 0.7), pose)
        line = last - first
        length = np.linalg.norm(line)
        force = 2e5 * (length - math.hypot(1.6, 0.2)) * line / length
        assert curve.ties.force[k, 0] < -100.0  # compressed
        wide = 1.5 * WEIGHT
        toe = place(model, 2, (2.6, 0.0), pose)
        centre, arm = place(model, 2, (2.3, 0.5), pose) - toe, last - toe
        moment = -arm[0] * force[1] + arm[1] * force[0]
        exact = (
            carried(model, 1, pose, (WIDTH, 0.9), force),
            (moment - centre[0] * wide) / (centre[1] * wide),
        )
        assert point.load_multiplier == pytest.approx(exact[0], abs=2.0 * EXACT[engine])
        assert point.load_multiplier == pytest.approx(exact[1], abs=2.0 * EXACT[engine])
        checked += 1
    assert checked > 10


def test_through_the_file_as_in_python(tmp_path):
    model = model_of((CASES["by area"], floor().ties[0]), box("c", 2.0, width=0.6))
    ds.write_model(model, tmp_path / "m.toml")
    again = ds.read_model(tmp_path / "m.toml")
    one, other = (ds.pushover(m, max_displacement=0.05) for m in (model, again))
    assert one.load_multiplier == pytest.approx(other.load_multiplier, abs=0.0)
    assert again.ties[1].spring
    assert one.ties.names == other.ties.names == ("t", "floor")


def test_results_hold_every_tie(tmp_path):
    model = model_of((CASES["breaking"],))
    with ds.ResultsDirectory(tmp_path / "out") as recorder:
        curve = ds.pushover(model, recorder=recorder)
    read = ds.load_results(tmp_path / "out").curve
    assert np.array_equal(read.ties.force, curve.ties.force)
    assert np.array_equal(read.ties.branch, curve.ties.branch)
    lines = (tmp_path / "out" / "ties.csv").read_text().splitlines()
    assert lines[0] == "step,control_displacement,tie,force,elongation,state"
    assert len(lines) == 1 + len(curve.points)
    assert lines[-1].endswith(",broken")


def test_lmgc90_says_that_it_has_none():
    engine = pytest.importorskip("drystone_lmgc90").Lmgc90Engine(driver="wheel")
    model = model_of((tie(),))
    with pytest.raises(ds.EngineError, match="no ties and springs"):
        ds.pushover(model, engine=engine)


WRONG = (
    (replace(tie(), end=ds.TieEnd(block="x", point=np.array(WALL))), "to.block: there is no block"),
    (replace(tie(), end=ds.TieEnd(block="b", point=np.array([1.0, 1.0]))), "is not on block"),
    (replace(tie(), start=ds.TieEnd(block="b", point=np.array([0.1, 0.1]))), "both ends"),
    (tie(stiffness=None), "stiffness: give"),
    (tie(area=1.0), "stiffness: give"),
    (tie(pretension=2500.0), "pretension: must be from 0 to its strength"),
    (tie(breaking_elongation=0.0), "breaking_elongation: must be greater than 0"),
    (tie(yield_force=math.inf), "yield_force: must be a finite number"),
)


@pytest.mark.parametrize(("one", "sentence"), WRONG)
def test_what_no_tie_can_be(one, sentence):
    with pytest.raises(ds.ModelError, match=sentence):
        model_of((one,))


FILE = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9
[[block]]
id = "g"
vertices = [[-1, -1], [2, -1], [2, 0], [-1, 0]]
support = true
[[block]]
id = "b"
vertices = [[0, 0], [0.4, 0], [0.4, 1], [0, 1]]
[load]
pattern = "mass"
direction = [1, 0]
[[tie]]
from = { block = "ground", point = [-1, 0.8] }
to = { block = "b", point = [0, 0.8] }
"""


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ("stiffness = 1e5\ncompression = false", "yield_force is missing"),
        ("stiffness = 1e5\nyield_force = 1e3", "compression is missing"),
        ("yield_force = 1e3\ncompression = false", r"give stiffness \[N/m\], or area"),
        ("stiffness = -1.0\nyield_force = 1e3\ncompression = false", "stiffness"),
        ("stiffness = 1e5\nyield_force = 1e3\ncompression = false\nslip = 1", "slip"),
    ],
)
def test_what_no_file_can_say(keys, sentence, tmp_path):
    (tmp_path / "m.toml").write_text(FILE + keys)
    with pytest.raises(ds.ModelError, match=sentence):
        ds.read_model(tmp_path / "m.toml")


def test_the_ground_has_the_name_that_files_give_it():
    assert ds.TieEnd(block="ground", point=np.array(WALL)).block is None


def test_a_movable_block_is_not_called_ground():
    """Its ties would have held to what does not move."""
    held = tie(end=ds.TieEnd(block="ground", point=np.array(WALL)))
    with pytest.raises(ds.ModelError, match="give the block another name"):
        ds.make_model(
            [box("base", -1.0, 6.0, 0.5, -0.5, support=True), box("ground", 0.0)],
            joint=ds.JointLaw(friction_coefficient=5.0, normal_stiffness=1e9, shear_stiffness=1e9),
            thickness=THICKNESS,
            load_direction=[1.0, 0.0],
            ties=[held],
        )


def test_a_block_that_is_squeezed_out_below_one_that_a_stiff_spring_holds():
    """The lower one slides on both faces: lambda W = mu W + mu 2 W, and the upper one stays."""
    held = ds.spring(
        start=ds.TieEnd(block="b2", point=np.array([0.5, 0.75])),
        end=ds.TieEnd(point=np.array([20.0, 0.75])),
        stiffness=1e8,
    )
    joint = ds.JointLaw(friction_coefficient=1.0, normal_stiffness=1e8, shear_stiffness=1e7)
    model = stack((1.0, 0.5), (1.0, 0.5), joint=joint, control_block="b2", ties=(held,))
    curve = ds.pushover(model)
    assert curve.status == "finished"
    assert curve.peak.load_multiplier == pytest.approx(3.0, rel=1e-3)


def test_ties_stand_in_the_order_of_files(tmp_path):
    """Forces of a loaded curve stood under the names of others where a spring came first."""

    def ends(height):
        there = ds.TieEnd(point=np.array([-1.25, height]))
        return {"start": ds.TieEnd(block="b1", point=np.array([-0.25, height])), "end": there}

    rod = ds.Tie(**ends(1.0), stiffness=2e5, yield_force=500.0, compression=False)
    model = stack((0.5, 2.0), ties=(ds.spring(**ends(1.9), stiffness=1e3), rod))
    curve = ds.pushover(model, max_displacement=0.02, keep_poses=True)
    ds.save_results(curve, model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out")
    assert [tie.spring for tie in model.ties] == [tie.spring for tie in loaded.model.ties]
    assert curve.ties.names == loaded.curve.ties.names == tuple(names_of(loaded.model.ties))
    yielding = int(loaded.curve.ties.force[-1].argmax())
    assert loaded.curve.ties.force[-1][yielding] == pytest.approx(500.0, rel=1e-6)
    assert not loaded.model.ties[yielding].spring


@pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])
def test_two_blocks_pushed_apart_against_a_tie(engine):
    """As both go, 1/4 of W and h T/W of the tie, which yields at 600 N where each top has moved
    0.06 m: 0.338; as one goes it is less.  `nscd` told 4.2 of a step whose forces did no work."""
    base = rectangle(-3.0, -1.0, 10.0, 1.0)
    outlines = {"b0": rectangle(0.0, 0.0, 0.5, 2.0), "b1": rectangle(2.0, 0.0, 0.5, 2.0)}
    weight = 1e4

    def push(name, x, sense):
        return ds.PointForce(
            block=name, point=np.array([x, 1.0]), force=np.array([sense * weight, 0.0])
        )

    tie = ds.Tie(
        start=ds.TieEnd(block="b0", point=np.array([0.5, 2.0])),
        end=ds.TieEnd(block="b1", point=np.array([2.0, 2.0])),
        stiffness=5e3,
        yield_force=600.0,
        compression=False,
    )
    model = ds.make_model(
        [
            ds.Block(id="base", vertices=base, unit_weight=weight, support=True),
            *(ds.Block(id=name, vertices=v, unit_weight=weight) for name, v in outlines.items()),
        ],
        joint=ds.JointLaw(friction_coefficient=1.0, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=1.0,
        load=ds.ForcesPattern(entries=(push("b0", 0.25, -1.0), push("b1", 2.25, 1.0))),
        ties=(tie,),
        control_block="b1",
        control_direction=(1.0, 0.0),
    )
    curve = ds.pushover(model, engine=engine)
    assert curve.status == "finished"
    assert 0.30 < curve.capacity.load_multiplier < 0.339
    assert curve.peak.load_multiplier < 0.38  # of what is left, 1/4 and h T/W of the tie: 0.37


@pytest.mark.parametrize("engine", ["equilibrium", "nscd"])
def test_two_blocks_drawn_together_until_the_tie_is_slack(engine):
    """Twice the pull that tips them: both lean inwards, by 1 mm at 0.8 m.  Pushed, the one leans
    farther and the other sits down again, under a multiplier of -1e-3.  Then they carry B/H less
    what the first leans by: 2.5e-3, and 0.04 mm by which its toe closes, over 0.1 m."""
    drawn = tie(
        start=ds.TieEnd(block="b", point=np.array(WALL)),
        end=ds.TieEnd(block="c", point=np.array([2.4, 0.8])),
        stiffness=1e6,
        yield_force=1e6,
        pretension=2.0 * WEIGHT * 0.5 * WIDTH / 0.8,
    )
    curve = ds.pushover(model_of([drawn], box("c", 2.0), control_block="c"), engine=engine)
    assert curve.status == "finished", curve.reason
    assert WIDTH / HEIGHT - 3.5e-3 < curve.capacity.load_multiplier < WIDTH / HEIGHT


def test_a_block_that_hangs_on_a_tie_alone_falls_as_slowly_as_any():
    """By the stiffness of its tie it would have a mass so small that it meets the next block at a
    speed that no joint stops within a cycle, and rebounds without an end."""
    hung = ds.TieEnd(block="c", point=np.array((0.0, 1.2)))
    model = model_of([tie(end=hung)], box("c", 0.0, y=1.0))
    problem = replace(problem_of(model), ties=model.ties)
    engine, assembly = DistinctEngine(), problem.assembly
    lying, hanging = (assembly.index(name) for name in ("b", "c"))
    pose = assembly.design_pose()
    pose[hanging, 1] += 0.5
    work = Workspace(engine.settings, engine.release(problem, pose), real_masses=False)
    assert work.mass[hanging] == pytest.approx(work.mass[lying])
