"""Where friction leaves more than one collapse multiplier: what is printed, and what is between.

A lintel lies on two piers with a narrow block on each pier beside it.  The leeward one can
overturn alone, at the multiplier arm / height of its centroid; pressed by the lintel, whose
friction then holds it down, it stands at larger loads.  Which of the two happens depends on the
normal force in the joint between them, of which limit analysis knows nothing.
"""

import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

import drystone as ds
from builders import UNIT_WEIGHT, rectangle, with_corner
from drystone.cli import app
from drystone.io.modelfile import write_model
from drystone.limit import Beside, collapse_loads, limits_beside
from drystone.model.assembly import Block, Corner
from drystone.model.builders import make_model
from drystone.model.joint_law import JointLaw

EXACT = 1e-9  # of linear programs solved to 1e-10
NARROW, HEIGHT, RADIUS = 0.18, 0.6, 0.005  # m
SHARP = Corner()


def portal(way=1.0, radius=RADIUS):
    """Two piers of four blocks, and the lintel between two narrow blocks."""
    pier, span, bearing = 0.6, 1.4, 0.6 - NARROW
    outlines = {"base": rectangle(-1.0, -0.5, 4.6, 0.5)}
    for side, x in (("left", 0.0), ("right", pier + span)):
        for i in range(4):
            outlines[f"{side}{i}"] = rectangle(x, 0.25 * i, pier, 0.25)
    outlines["lintel"] = rectangle(NARROW, 1.0, span + 2 * bearing, HEIGHT)
    outlines["west"] = rectangle(0.0, 1.0, NARROW, HEIGHT)
    outlines["east"] = rectangle(2 * pier + span - NARROW, 1.0, NARROW, HEIGHT)
    blocks = [
        Block(id=name, vertices=v, unit_weight=UNIT_WEIGHT, support=name == "base")
        for name, v in outlines.items()
    ]
    law = JointLaw(friction_coefficient=0.5, normal_stiffness=1e10, shear_stiffness=1e10)
    return make_model(
        blocks,
        joint=law,
        corner=Corner(radius=radius) if radius else None,
        thickness=1.0,
        load_direction=(way, 0.0),
    )


@pytest.mark.parametrize("way", [-1.0, 1.0])
@pytest.mark.parametrize("radius", [0.0, RADIUS])
def test_a_portal_says_what_it_may_carry_beyond_its_lowest_state(way, radius):
    associative, found = collapse_loads(portal(way, radius))
    alone = (NARROW / 2 - radius) / (HEIGHT / 2)
    assert found.load_multiplier == pytest.approx(alone, abs=EXACT)
    assert found.moving == ("east" if way > 0 else "west",)
    assert found.upper_bound == associative.load_multiplier > 1.15 * alone
    assert f"{found.upper_bound:.5g} (associative)" in found.reason


def test_a_portal_loaded_from_rest_peaks_between_the_two():
    model = portal()
    associative, found = collapse_loads(model)
    # Beyond 20 mm the curve has long passed its peak.
    peak = ds.pushover(model, max_displacement=0.02).peak.load_multiplier
    # Joints of 1e10 Pa/m close by some micrometres, over blocks of decimetres: 1e-4.
    assert 1.02 * found.load_multiplier < peak < associative.load_multiplier * (1.0 + 1e-4)


@pytest.mark.parametrize("friction", [0.65, 0.7, 0.75])
def test_the_multiplier_is_the_lowest_of_its_range(friction):
    wall = with_corner(ds.published_wall(1), SHARP)
    joint = replace(wall.assembly.joint, friction_coefficient=friction)
    model = make_model(
        wall.assembly.blocks, joint=joint, thickness=1.0, load_direction=wall.load.direction
    )
    _, found = collapse_loads(model)
    assert found.load_multiplier == found.collapse_range[0] < found.collapse_range[1]
    # The forces that belong to it are those that are printed.
    assert max(found.residual, found.friction_violation, found.duality_gap) < EXACT


def test_run_says_the_range(tmp_path):
    model = with_corner(ds.published_wall(1), SHARP)
    beside = limits_beside(model)
    low, high = beside.collapse_range
    assert beside.non_associative == low < high
    path = tmp_path / "wall.toml"
    write_model(replace(model, analysis=replace(model.analysis, options={"max_steps": 3.0})), path)
    run = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "out")])
    assert f"{low:.4f} to {high:.4f} non-associative" in run.stdout
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary["collapse_range"] == pytest.approx([low, high])


def test_one_number_is_printed_as_one():
    from drystone.limit import range_text

    assert range_text((0.58558, 0.58558), 4) == "0.5856"
    assert range_text((0.2833, 0.3412), 3) == "0.283 to 0.341"
    assert Beside().collapse_range is None
