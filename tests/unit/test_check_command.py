"""What ``drystone check`` warns of, and ``run`` with it: valid models, but hardly meant."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from typer.testing import CliRunner

from drystone.cli import app
from drystone.common import ranges
from drystone.model.inspection import _connected

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

MODEL = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 18e3
[joint]
friction_coefficient = 0.65
normal_stiffness = 1e8
shear_stiffness = 1e8
[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true
[[block]]
id = "b1"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]
[load]
pattern = "mass"
direction = [1.0, 0.0]
"""
WALL = """
[wall]
unit = [0.4, 0.2]
courses = ["111", "h1h"]
origin = [0.0, 0.9]
"""


def drystone(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


def written(folder, *changes, more=""):
    text = MODEL
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "model.toml"
    path.write_text(text + more)
    return path


def problems(path):
    result = drystone("check", path, "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["status"] == "valid"
    return found["problems"]


@pytest.mark.parametrize("name", ["two_blocks", "wall1", "wall2", "wall3"])
def test_examples_are_without_problems(name):
    assert problems(EXAMPLES / f"{name}.toml") == []


B1 = "vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (B1, "vertices = [[-0.2, 0.0], [0.2, 0.0], [1.0, 0.9], [0.6, 0.9]]", "does not stand"),
        ("coefficient = 0.65", "coefficient = 33", "its tangent, 0.6494"),
        ("normal_stiffness = 1e8", "normal_stiffness = 10", "is it in kPa/mm"),
        ("unit_weight = 18e3", "density = 2.2", "2.2 kg/m3, is light for masonry"),
        ("unit_weight = 18e3", "unit_weight = 18.0", "is it in kN/m3"),
        ("unit_weight = 18e3", "density = 18e3", "is heavy for masonry"),
        ("unit_weight = 18e3", "unit_weight = 1800.0", "Then write it as density"),
        ("thickness = 1.0", "thickness = 400.0", "much for a structure of 0.9 m"),
        ("coefficient = 0.65", "coefficient = 0.65\ncohesion = 0.1", "Pa, or MPa? Then take"),
        ("direction = [1.0, 0.0]", "direction = [0.0, -1.0]", "no multiple of it"),
        (B1, "vertices = [[-0.2, 0.9], [0.2, 0.9], [0.2, 0.0], [-0.2, 0.0]]", "turned round"),
        (B1, "vertices = [[-0.2, 1e-4], [0.2, 1e-4], [0.2, 0.9], [-0.2, 0.9]]", "1 joint"),
    ],
)
def test_what_is_hardly_meant_is_told_with_the_mend(tmp_path, old, new, said):
    path = written(tmp_path, (old, new))
    (problem,) = problems(path)
    assert said in problem
    assert f"warning: {problem}" in drystone("check", path).stdout


TIE = """
[[tie]]
name = "rod"
from = { block = "b1", point = [0.2, 0.8] }
to = { block = "ground", point = [2.2, 0.8] }
area = 3e-4
young_modulus = 2e11
yield_force = 70e3
compression = false
"""
SITE = """
[site]
code = "ntc2018"
ag = 0.15
F0 = 2.5
TC_star = 0.3
soil = "B"
topography = "T1"
[site.SLD]
ag = 0.06
F0 = 2.5
TC_star = 0.3
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", None),
        ("area = 3e-4", "area = 300.0", 'tie "rod": reaches its strength of 70000 N at a strain'),
        ("young_modulus = 2e11", "young_modulus = 2e5", "at a strain of 1.2e+03"),
        ("yield_force = 70e3", "yield_force = 70.0", "at a strain of 1.2e-06"),
        ("ag = 0.15", "ag = 1.5", "site.ag: 1.5 g is more than NTC 2018"),
        ("ag = 0.06", "ag = 1.2", "site.SLD.ag: 1.2 g is more than NTC 2018"),
    ],
)
def test_units_of_ties_and_of_the_ground_motion_that_are_mistaken_are_told(
    tmp_path, old, new, said
):
    found = problems(written(tmp_path, more=(TIE + SITE).replace(old, new)))
    assert len(found) == (said is not None)
    assert all(said in sentence for sentence in found)


def test_solids_of_any_size_have_no_thickness_to_doubt(tmp_path):
    solid = MODEL.replace("dimension = 2", "dimension = 3").replace("thickness = 1.0\n", "")
    head = solid[: solid.index("[[block]]")]
    blocks = "".join(
        f'[[block]]\nid = "{name}"\nbox = [[0.0, 0.0, {low}], [0.01, 0.01, {low + 0.01}]]\n{more}'
        for name, low, more in (("base", 0.0, "support = true\n"), ("b1", 0.01, ""))
    )
    path = tmp_path / "solid.toml"
    path.write_text(f'{head}{blocks}[load]\npattern = "mass"\ndirection = [1.0, 0.0, 0.0]\n')
    assert problems(path) == []


def test_a_compressive_strength_that_the_weight_exceeds_is_told(tmp_path):
    """0.9 m of 18 kN/m3 press by 16.2 kPa."""
    found = problems(written(tmp_path, ("0.65", "0.65\ncompressive_strength = 5.0")))
    assert any("less than the pressure" in one and "1.62e+04 Pa" in one for one in found)


@pytest.mark.parametrize(
    ("stage", "said"), [(1, ["own weight alone, before the dead loads of stage 1 act"]), (0, [])]
)
def test_what_stands_only_once_a_dead_load_acts_is_told(tmp_path, stage, said):
    """A block that leans too far, and a force on its heel that keeps it from falling."""
    leaning = "vertices = [[-0.2, 0.0], [0.2, 0.0], [1.0, 0.9], [0.6, 0.9]]"
    more = '[[dead_load]]\nkind = "force"\nblock = "b1"\npoint = [-0.2, 0.0]\n'
    more += f"force = [0.0, -5e3]\nmass = false\nstage = {stage}\n"
    found = problems(written(tmp_path, (B1, leaning), more=more))
    assert len(found) == len(said)
    assert all(words in sentence for words, sentence in zip(said, found, strict=True))


def test_settings_of_a_load_are_told_where_supports_move(tmp_path):
    moved = '[settlement]\nblocks = ["base"]\ndirection = [0.0, -1.0]\nmax = 0.01\n'
    moved += '[analysis]\nstrategy = "published"\nmax_displacement = 0.001\nmax_steps = 5\n'
    old = '[load]\npattern = "mass"\ndirection = [1.0, 0.0]\n'
    found = problems(written(tmp_path, (old, moved)))
    assert [sentence.split()[1] for sentence in found] == ["max_displacement", "strategy"]
    assert all("[settlement] says how far" in sentence for sentence in found)


def test_courses_of_unequal_lengths_are_told(tmp_path):
    found = problems(written(tmp_path, more=WALL))
    assert 'wall.courses[2]: "h1h" is 2 units long, the longest course 3' in found[0]


@pytest.mark.parametrize(
    ("new", "said"),
    [(".5", "0.5"), ("5.", "5.0"), ("+.25", "0.25"), ("1.e9", "1.0"), ("[.4, 1.0]", "0.4")],
)
def test_a_number_without_a_digit_beside_its_point_is_told(tmp_path, new, said):
    result = drystone("check", written(tmp_path, ("thickness = 1.0", f"thickness = {new}")))
    assert result.exit_code == 2
    assert f"write digits before and after the point, as in {said}\n" in result.stderr


@pytest.mark.parametrize("new", ["1 000", '"a.b', "0.5 m", "1.2.3"])
def test_other_torn_values_are_not_told_of_a_point(tmp_path, new):
    result = drystone("check", written(tmp_path, ("thickness = 1.0", f"thickness = {new}")))
    assert result.exit_code == 2 and "the point" not in result.stderr


@pytest.mark.parametrize(("old", "new"), [("thickness = 1.0", "thickness = 0,5")])
def test_a_decimal_comma_is_told(tmp_path, old, new):
    result = drystone("check", written(tmp_path, (old, new)))
    assert result.exit_code == 2
    assert "line 3, column" in result.stderr and "with a point, as in 0.5" in result.stderr


def test_a_decimal_comma_in_json_is_told(tmp_path):
    path = tmp_path / "model.json"
    path.write_text('{\n"dimension": 2,\n"thickness": 0,5\n}')
    assert "with a point, as in 0.5" in drystone("check", path).stderr


def test_the_tolerance_of_drawings_is_a_key(tmp_path):
    drawn = (B1, "vertices = [[-0.2, 1e-3], [0.2, 1e-3], [0.2, 0.9], [-0.2, 0.9]]")
    assert drystone("check", written(tmp_path, drawn)).exit_code == 2  # 0.2 mm would do
    wider = ("dimension = 2", "dimension = 2\ndrawing_tolerance = 0.01")
    (problem,) = problems(written(tmp_path, drawn, wider))
    assert "2 vertices were moved, by up to 1 mm" in problem


def test_run_tells_it_too_and_keeps_it(tmp_path):
    path = written(
        tmp_path, (B1, B1.replace("0.0]", "1e-4]")), ("[load]", "[analysis]\nmax_steps = 2\n[load]")
    )
    result = drystone("run", path, "--out", tmp_path / "out")
    assert "warning: block: 1 joint" in result.stderr
    (note,) = json.loads((tmp_path / "out/summary.json").read_text())["notes"]
    assert "1 joint" in note


def test_what_hangs_together_is_found_as_scipy_finds_it():
    rng = np.random.default_rng(1)
    for _ in range(200):
        n, m = int(rng.integers(1, 40)), int(rng.integers(0, 50))
        a, b = rng.integers(0, n, m), rng.integers(0, n, m)
        links = coo_array((np.ones(m), (a, b)), shape=(n, n))
        _, group = connected_components(links, directed=False)
        lowest = np.array([np.flatnonzero(group == own).min() for own in group])
        np.testing.assert_array_equal(_connected(n, a, b), lowest)


def test_a_reaction_that_is_missing_says_why(tmp_path, monkeypatch):
    path = written(tmp_path)
    told = json.loads(drystone("check", path, "--json").stdout)
    assert told["reaction"] == pytest.approx(18e3 * 0.4 * 0.9, rel=1e-9)
    assert told["reaction_note"] is None
    monkeypatch.setitem(ranges.MOST_BLOCKS, 2, 0)
    told = json.loads(drystone("check", path, "--json").stdout)
    assert told["reaction"] is None
    assert told["reaction_note"] == "not looked for in more than 0 blocks, nor whether they stand"
    assert f"reaction       {told['reaction_note']}" in drystone("check", path).stdout


def test_a_joint_with_several_straight_parts_has_contacts_on_each(tmp_path):
    """A block in a notch of its base: one joint on three sides, two contact points on each."""
    base = "[[-1.0, -0.2], [1.0, -0.2], [1.0, 0.5], [0.2, 0.5], [0.2, 0.0], [-0.2, 0.0]"
    base += ", [-0.2, 0.5], [-1.0, 0.5]]"
    flat = "[[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]"
    path = tmp_path / "notch.toml"
    path.write_text(MODEL.replace(flat, base))
    found = json.loads(CliRunner().invoke(app, ["check", str(path), "--json"]).stdout)
    assert (found["n_joints"], found["n_contacts"]) == (1, 6)
