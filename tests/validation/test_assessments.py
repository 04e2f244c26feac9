"""Traced curves assessed: wall 1, a façade in space, an arch, and a wall cut into courses."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.analysis.directions import towards
from drystone.assessment.capacity import Capacity, participation
from drystone.assessment.errors import AssessmentError
from drystone.assessment.mechanism import course_of, initial_shape, reduced
from drystone.assessment.methods.ntc2018_local import sudden_loss
from drystone.assessment.rocking.block import peak_slope
from drystone.assessment.verdict import turned
from drystone.cli import app
from drystone.io.modelfile import write_model
from drystone.model.site import Site
from rigid_walls import evenly, wall_in_courses

EXAMPLES = Path(__file__).parents[2] / "examples"
SITE = Site(
    code="ntc2018",
    values={"ag": 0.172, "F0": 2.458, "TC_star": 0.285, "soil": "B", "topography": "T1"},
)
EC8 = Site(code="ec8", values={"ag": 0.17, "type": 1, "ground": "B", "importance": "II"})
#: What each method needs.
METHODS = {
    "ntc2018-local": {"confidence_factor": 1.35},
    "ntc2009-local": {"confidence_factor": 1.35},
    "ntc2018-global": {"procedure": "A", "secant_share": 0.6},
    "ec8-n2": {},
    "en1998-3-2025-rocking": {
        "elastic_period": 0.0,
        "knowledge_level": 1,
        "infinitely_strong_blocks": True,
        "demand_factor": 1.0,
        "damping": {"SD": 5.0, "NC": 5.0},
    },
    "asce41": {"site_class": "B", "effective_mass_factor": 1.0, "near_fault": False},
    "rocking": {"pulse": [{"kind": "half_sine", "amplitude": 0.5, "duration": 0.5}]},
}


@cache
def wall_1():
    model = ds.read_model(EXAMPLES / "wall1.toml")
    return ds.pushover(model), model


@cache
def arch():
    model = ds.read_model(EXAMPLES / "builders" / "arch.toml")
    return ds.pushover(model), model


@cache
def facade():
    model = ds.read_model(EXAMPLES / "facade.toml")
    return ds.pushover(model), model


def test_participation_along_the_branch_of_wall_1():
    """Values of an independent script on this engine's curve, printed with three digits; tangents
    over six points: 1 per cent.  (Another at 0.201 m lies where the wall jumps; within a millimetre
    it is on the one side or the other.)"""
    curve, model = wall_1()
    rows = [curve.nearest(d) for d in (0.021, 0.049, 0.102, 0.299)]
    course = course_of(curve, model, rows)
    assert course.n_bodies.tolist() == [4, 4, 5, 3]
    for found, expected in (
        (course.participating_mass_ratio, (0.746, 0.756, 0.717, 0.786)),
        (course.participation_factor, (1.60, 1.58, 1.56, 1.30)),
        (course.kinetic_ratio, (0.169, 0.176, 0.191, 0.165)),
        (course.secant_mass_ratio, (0.247, 0.234, 0.233, 0.194)),
    ):
        assert found == pytest.approx(expected, rel=0.01)


def test_the_initial_mechanism_of_wall_1():
    """That of the branch at 0.021 m, on the undeformed wall; c as measured by a step's inertia,
    0.173, which is that of the whole branch."""
    curve, model = wall_1()
    shape = initial_shape(curve, model)
    assert (shape.n_bodies, shape.n_moving) == (4, 11)
    assert shape.bodies.mass_ratio == pytest.approx(0.746, rel=0.01)
    assert shape.blocks.mass_ratio == pytest.approx(0.70, rel=0.01)
    assert shape.kinetic_ratio == pytest.approx(0.173, rel=0.05)
    assert not shape.twists


def test_the_arch_falls_as_three_bodies():
    """Four hinges part the arch that fails into three bodies; four others stand beside it."""
    curve, model = arch()
    shape = initial_shape(curve, model)
    assert shape.n_bodies == 3
    ids = [name for name, label in zip(model.assembly.ids, shape.labels, strict=True) if label >= 0]
    assert len({name.split("/")[0] for name in ids}) == 1  # all of one arch


def test_the_facade_falls_outwards_and_not_twisting():
    curve, model = facade()
    found = reduced(curve, model, course=False)
    assert not found.shape.twists
    # The front turns about its foot as one body: e* = 1; brick by brick it is at least the 3/4 of
    # a wall in many courses.
    assert found.shape.n_bodies == 1 and found.shape.n_moving > 5
    assert found.shape.bodies.mass_ratio == pytest.approx(1.0, rel=1e-12)
    assert 0.75 < found.shape.blocks.mass_ratio < 1.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("structure", [wall_1, arch, facade])
def test_every_method_gives_an_answer_or_says_why_not(structure, method):
    curve, model = structure()
    site = EC8 if method.startswith(("ec8", "en1998")) else SITE
    verdict = curve.assess(model, site=site, method=method, **METHODS[method])
    found = verdict.as_dict()
    assert found["method"] == method and found["limit_states"]
    assert set(found["readings"]) == {"base_shear", "energy", "literal_ec8"}
    if method == "asce41":  # a rocking branch has no strength that hardens: no verdict
        assert verdict.satisfied is None
        return
    assert verdict.satisfied is bool(verdict.safety_index >= 1.0)
    for state in verdict.limit_states:
        if state.ground_acceleration_capacity is not None and state.ground_acceleration_demand:
            index = state.ground_acceleration_capacity / state.ground_acceleration_demand
            assert state.satisfied is None or state.satisfied is bool(index >= 1.0)


def test_a_wall_that_leans_on_another_is_activated_where_it_begins_to_rock():
    """b/h = 0.125 alone; the highest multiplier, 0.217, follows when it has met the second wall."""

    def wall(name, left, right):
        corners = [(left, 0.0), (right, 0.0), (right, 4.0), (left, 4.0)]
        return ds.Block(id=name, vertices=np.array(corners), unit_weight=18e3)

    ground = [(-2.0, -0.5), (2.0, -0.5), (2.0, 0.0), (-2.0, 0.0)]
    model = ds.make_model(
        [
            ds.Block(id="ground", vertices=np.array(ground), unit_weight=18e3, support=True),
            wall("b", 0.0, 0.5),
            wall("c", 0.7, 1.7),
        ],
        joint=ds.JointLaw(friction_coefficient=2.0, normal_stiffness=1e12, shear_stiffness=1e12),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block="b",
        control_point=(0.5, 4.0),
    )
    curve = ds.pushover(model)
    assert curve.peak.load_multiplier > 0.21
    verdict = curve.assess(model, site=SITE, method="ntc2018-local", confidence_factor=1.35)
    found = verdict.as_dict()
    assert found["activation_multiplier"] == pytest.approx(0.125, rel=1e-3)
    told = " ".join(map(str, verdict.capacity.notes))
    assert "from which it falls by more than a fifth" in told


def held_wall(breaking, strength=4e3, stiffness=1e6):
    """4 m x 0.5 m, held at 3.5 m by a rod of a few millimetres that breaks; None: without it."""
    rod = ds.Tie(
        start=ds.TieEnd(block="wall", point=np.array([-0.25, 3.5])),
        end=ds.TieEnd(point=np.array([-3.0, 3.5])),
        stiffness=stiffness,
        yield_force=strength,
        breaking_elongation=breaking,
        compression=False,
        name="rod",
    )
    ground = [(-1.0, -0.2), (1.0, -0.2), (1.0, 0.0), (-1.0, 0.0)]
    wall = [(-0.25, 0.0), (0.25, 0.0), (0.25, 4.0), (-0.25, 4.0)]
    return ds.make_model(
        [
            ds.Block(id="base", vertices=np.array(ground), unit_weight=18e3, support=True),
            ds.Block(id="wall", vertices=np.array(wall), unit_weight=18e3),
        ],
        joint=ds.JointLaw(friction_coefficient=0.7, normal_stiffness=1e10, shear_stiffness=1e10),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        ties=[] if breaking is None else [rod],
    )


@pytest.mark.parametrize("strength", [4e3, 1e5])  # it yields first, or does not
def test_beyond_a_tie_that_breaks_the_wall_is_that_without_it(strength):
    """By 2009 the SLV is read off the curve at 0.16 and 0.4 of the collapse displacement, where the
    rod has broken; by 2018 the SLV ends where it breaks, the SLC is that of the free wall."""
    model, free = held_wall(0.02, strength), held_wall(None)
    curve, alone = ds.pushover(model), ds.pushover(free)
    place = next(e.control_displacement for e in curve.events if e.kind == "tie_broken")
    asked = {"site": SITE, "confidence_factor": 1.35}
    old = {"method": "ntc2009-local", **asked}
    found = curve.assess(model, **old).state("SLV")
    expected = alone.assess(free, straight_capacity=False, **old).state("SLV")
    assert found.limit_period == pytest.approx(expected.limit_period, rel=1e-3)
    assert found.safety_index == pytest.approx(expected.safety_index, rel=1e-3)
    new = {"method": "ntc2018-local", **asked}
    states = curve.assess(model, **new)
    assert states.state("SLV").limit_control_displacement == pytest.approx(place, rel=1e-7)
    assert "sudden loss" in states.state("SLV").details["limit_set_by"]
    late, late_alone = states.state("SLC"), alone.assess(free, **new).state("SLC")
    for key in ("limit_period", "displacement_demand", "limit_displacement"):
        assert getattr(late, key) == pytest.approx(getattr(late_alone, key), rel=1e-3), key
    with pytest.raises(AssessmentError, match=r'pulses.*the tie "rod"'):
        curve.assess(model, method="rocking", **METHODS["rocking"])


def test_a_rod_that_breaks_before_the_wall_rocks_forms_no_mechanism():
    """It breaks at a hundredth of b/h, by which four fifths of the load are lost; the wall was said
    to be activated there, with a safety index of 0.03."""
    model, free = held_wall(1e-6, 1e5, stiffness=1e8), held_wall(None)
    curve, alone = ds.pushover(model), ds.pushover(free)
    broken = next(e for e in curve.events if e.kind == "tie_broken")
    assert broken.load_multiplier < 0.01
    asked = {"site": SITE, "method": "ntc2018-local", "confidence_factor": 1.35}
    found, expected = curve.assess(model, **asked), alone.assess(free, **asked)
    assert found.as_dict()["activation_multiplier"] == pytest.approx(0.125, rel=1e-2)
    assert found.safety_index == pytest.approx(expected.safety_index, rel=1e-3)


def test_a_mass_on_a_block_participates_where_it_lies():
    """20 kN of wall, and 80 kN at a tenth of its height: 1/Gamma = (20 + 80 x 0.2)/(2 x 100)."""
    ground = [(-2.0, -0.5), (6.0, -0.5), (6.0, 0.0), (-2.0, 0.0)]
    wall = [(0.0, 0.0), (0.5, 0.0), (0.5, 2.0), (0.0, 2.0)]
    model = ds.make_model(
        [
            ds.Block(id="ground", vertices=np.array(ground), unit_weight=20e3, support=True),
            ds.Block(id="wall", vertices=np.array(wall), unit_weight=20e3),
        ],
        joint=ds.JointLaw(friction_coefficient=1.5, normal_stiffness=1e10, shear_stiffness=1e10),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        dead_loads=[
            ds.ForceLoad(
                block="wall", point=np.array([0.25, 0.2]), force=np.array([0.0, -80e3]), mass=True
            )
        ],
    )
    curve = ds.pushover(model)
    found = reduced(curve, model, course=False).capacities["base_shear"]
    assert found.transformation_factor == pytest.approx(1.0 / 0.18, rel=1e-3)


def test_a_loss_before_the_highest_acceleration_counts():
    """More than half of what was borne is lost at 0.03 m; the highest multiplier comes later."""
    d = [0.0, 0.01, 0.03, 0.0301, 0.2, 0.5, 2.0]
    x = [0.0, 0.55, 0.58, 0.23, 0.62, 0.62, 0.0]
    capacity = Capacity.of(
        d, x, participation([1000.0], [0.5], 300.0), reading="base_shear", collapse_displacement=2.0
    )
    assert sudden_loss(capacity) == pytest.approx(0.03 / capacity.transformation_factor)


def test_the_slope_of_a_rocking_block_is_that_past_its_first_peak():
    """Of a line to zero at 0.5 m, though the block leans on another one from 0.2 m on."""
    d = [0.0, 1e-6, 0.1, 0.2, 0.25, 1.0]
    x = [0.0, 0.25, 0.2, 0.15, 0.6, 0.0]
    bodies = participation([1000.0], [0.5], 300.0)
    made = {"reading": "energy", "activation_multiplier": 0.25}
    capacity = Capacity.of(d, x, bodies, **made)
    alone = Capacity.of([0.0, 1e-6, 0.5], [0.0, 0.25, 0.0], bodies, **made)
    assert peak_slope(capacity) == pytest.approx(peak_slope(alone), rel=1e-3)


def test_what_a_method_needs_is_asked_for():
    curve, model = wall_1()
    for method, needed in METHODS.items():
        if needed and method not in ("ntc2018-global",):
            with pytest.raises(AssessmentError):
                curve.assess(model, site=SITE, method=method)


def test_a_wall_cut_into_courses_that_move_as_one_has_one_verdict():
    """Joints of 1e13 Pa/m: twenty of them take 3e-7 of lambda_0; steps of 1 mm keep the polygon of
    the curve, whose points are elsewhere on each, nearer to it than 1e-7."""
    answers = []
    for n in (1, 2, 5, 20):
        heights = [0.5 * height for height in evenly(n)]  # 2 m: stiffer than the wall of 4 m
        model = wall_in_courses(heights, displacement_step=0.001)
        curve = ds.pushover(model)
        verdict = curve.assess(model, site=SITE, method="ntc2018-local", confidence_factor=1.35)
        slv = verdict.state("SLV")
        capacity = verdict.capacity
        assert verdict.reduction.shape.n_bodies == 1
        answers.append(
            (
                capacity.participating_mass_ratio,
                capacity.participation_factor,
                capacity.activation_multiplier,
                capacity.collapse_displacement,
                slv.limit_period,
                slv.displacement_demand,
                slv.ground_acceleration_capacity,
            )
        )
    whole = np.array(answers[0])
    for cut in answers[1:]:
        assert np.array(cut) == pytest.approx(whole, rel=1e-6)


def test_the_same_by_the_command_line_from_model_files_in_both_senses(tmp_path):
    """The wall of the test above, whose bound is this one's: 2 m high, in steps of 1 mm."""
    site = {"ag": 0.172, "F0": 2.458, "TC_star": 0.285, "soil": "B", "topography": "T1"}
    flags = [f"--{key.replace('_', '-')}={value}" for key, value in site.items()]
    flags += ["--code=ntc2018", "--method=ntc2018-local", "--confidence-factor=1.35"]
    found = []
    for n in (1, 20):
        path = tmp_path / f"courses {n}.toml"
        heights = [0.5 * height for height in evenly(n)]
        write_model(wall_in_courses(heights, displacement_step=0.001), path)
        words = ["assess", str(path), "--out", str(tmp_path / f"out {n}"), "--json", *flags]
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, result.output
        senses = json.loads(result.stdout)["senses"]
        found.append([sense["safety_index"] for sense in senses.values()])
    assert found[0][1] == pytest.approx(found[0][0], rel=1e-6)  # the wall is its own mirror image
    assert found[1] == pytest.approx(found[0], rel=1e-6)


@pytest.mark.parametrize("cyclic", [False, True])
def test_a_control_direction_that_was_named_is_turned_round_with_the_load(cyclic):
    """It led against the load then, and there was no verdict on the other sense."""
    model = ds.published_wall(1).with_control(direction=(0.96, 0.28))
    other = turned(model) if cyclic else towards(model, 180.0)
    assert other.load_along == pytest.approx([-1.0, 0.0])
    assert other.control_point.direction[0] == pytest.approx(-0.96)
    assert other.control_point.block == model.control_point.block or not cyclic
