"""Model files: what is read, what is written, and what is said of broken ones."""

from __future__ import annotations

import hashlib
import json
import tomllib
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from builders import stack
from drystone.io.modelfile import ModelError, model_to_dict, read_model, write_model
from drystone.io.modelfile.schema import OPTION_NAMES, AnalysisSection
from drystone.model.assembly import GRAVITY
from drystone.model.builders import published_wall
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis

EXAMPLES = Path(__file__).parents[2] / "examples"
MODELS = sorted(set(EXAMPLES.glob("*.toml")) - set(EXAMPLES.glob("*_study.toml")))

GOOD = """\
title = "Two blocks"
dimension = 2
thickness = 1.0

[material.stone]
unit_weight = 10e3

[joint]
friction_coefficient = 0.65
normal_stiffness = 1e8
shear_stiffness = 1e11
dilatancy_angle = 0.0

[corner]
radius = 0.02

[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true

[[block]]
id = "b1"
material = "stone"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]

[load]
pattern = "mass"
direction = [1.0, 0.0]

[control]
block = "b1"
point = "top right"

[analysis]
engine = "equilibrium"
stop_multiplier = 0.01
"""
VERTICES = "[[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]"
BLOCKS = GOOD[GOOD.index("[[block]]") : GOOD.index("[load]")]


def changed(old: str, new: str) -> str:
    assert GOOD.count(old) == 1, f"{old!r} must occur once"
    return GOOD.replace(old, new)


def with_wall(*lines: str) -> str:
    """The good file with a wall in place of its blocks, and a default control point."""
    text = GOOD.replace(BLOCKS, "\n".join(["[wall]", *lines, "", ""]))
    return text.replace('block = "b1"\n', "")


def with_pair(key: str, *lines: str) -> str:
    return changed("[corner]", "\n".join([f"[joint.between.{key}]", *lines, "", "[corner]"]))


def read(tmp_path: Path, text: str | bytes, name: str = "model.toml", **options):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_model(path, **options)


def problems(tmp_path: Path, text: str | bytes, name: str = "model.toml", **options) -> list[str]:
    """What is said of a broken file, without the file's name, which every line must begin with."""
    with pytest.raises(ModelError) as caught:
        read(tmp_path, text, name, **options)
    prefix = f"{tmp_path / name}: "
    for line in str(caught.value).splitlines():
        assert line.startswith(prefix) or line.startswith("... and "), line
        for leak in ("Traceback", "pydantic", "Input should", "Error", "np.", "<class"):
            assert leak not in line
    found = caught.value.problems
    assert all(p.startswith(prefix) and "\n" not in p for p in found)
    return [p.removeprefix(prefix) for p in found]


class TestReading:
    def test_two_blocks(self, tmp_path):
        model = read(tmp_path, GOOD)
        assembly = model.assembly
        assert model.title == "Two blocks"
        assert assembly.ids == ("base", "b1")
        assert assembly.fixed.tolist() == [True, False]
        assert assembly.weight[1] == pytest.approx(10e3 * 0.4 * 0.9)
        assert assembly.corner.radius == 0.02
        assert assembly.joint == JointLaw(
            friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11
        )
        assert model.control_point.block == 1
        assert model.control_point.point.tolist() == [0.2, 0.9]
        assert model.control_point.direction.tolist() == [1.0, 0.0]
        assert (model.analysis.engine, model.analysis.strategy) == ("equilibrium", "displacement")

    def test_digest_is_of_the_bytes(self, tmp_path):
        model = read(tmp_path, GOOD)
        assert model.sha256 == hashlib.sha256(GOOD.encode()).hexdigest()
        assert model.source == str(tmp_path / "model.toml")

    @pytest.mark.parametrize("name", ["model.json", "MODEL.JSON", "model.txt"])
    def test_json_by_ending_or_content(self, tmp_path, name):
        model = read(tmp_path, json.dumps(tomllib.loads(GOOD)), name)
        assert model_to_dict(model) == model_to_dict(read(tmp_path, GOOD))

    def test_byte_order_mark(self, tmp_path):
        assert read(tmp_path, b"\xef\xbb\xbf" + GOOD.encode()).title == "Two blocks"

    def test_title_is_the_name_of_the_file_by_default(self, tmp_path):
        assert read(tmp_path, changed('title = "Two blocks"\n', "")).title == "model"

    def test_density(self, tmp_path):
        model = read(tmp_path, changed("unit_weight = 10e3", "density = 2000.0"))
        assert model.assembly.blocks[1].unit_weight == 2000.0 * GRAVITY

    def test_whole_numbers_are_numbers(self, tmp_path):
        model = read(tmp_path, changed("thickness = 1.0", "thickness = 1"))
        assert model.assembly.thickness == 1.0

    def test_direction_is_normalised(self, tmp_path):
        model = read(tmp_path, changed("direction = [1.0, 0.0]", "direction = [3, -4]"))
        assert model.load.direction == pytest.approx([0.6, -0.8])
        assert model.control_point.direction == pytest.approx([0.6, -0.8])

    def test_corner(self, tmp_path):
        assert read(tmp_path, changed("radius", "chamfer")).assembly.corner.chamfer == 0.02
        sharp = read(tmp_path, changed("[corner]\nradius = 0.02\n", "")).assembly
        assert not sharp.shapes.radius.any()
        assert not read(tmp_path, changed("0.02", "0.0")).assembly.shapes.radius.any()

    def test_control_by_default(self, tmp_path):
        control = GOOD[GOOD.index("[control]") : GOOD.index("[analysis]")]
        model = read(tmp_path, changed(control, ""))
        assert model.control_point.point.tolist() == [0.2, 0.9]

    def test_stiffness_may_be_left_out_for_limit_analysis(self, tmp_path):
        text = changed("normal_stiffness = 1e8\nshear_stiffness = 1e11\n", "")
        joint = read(tmp_path, text, need_stiffness=False).assembly.joint
        assert joint.normal_stiffness is None
        assert joint.shear_stiffness is None

    def test_wall(self, tmp_path):
        text = with_wall(
            "unit = [0.4, 0.175]", 'courses = ["h1111h", "11111"]', "repeat = 3", "base = true"
        )
        model = read(tmp_path, text)
        reference = published_wall(1)
        assert model.assembly.ids == reference.assembly.ids
        assert np.array_equal(model.assembly.shapes.vertices, reference.assembly.shapes.vertices)

    def test_wall_beside_blocks(self, tmp_path):
        text = changed(
            "[load]",
            '[wall]\nunit = [0.4, 0.2]\ncourses = ["11"]\norigin = [-0.2, 0.9]\n\n[load]',
        )
        assert read(tmp_path, text).assembly.ids == ("c1u1", "c1u2", "base", "b1")

    def test_options_of_the_analysis(self, tmp_path):
        text = changed("stop_multiplier = 0.01", "stop_multiplier = 0.02\novershoot = 1.05")
        analysis = read(tmp_path, text).analysis
        assert analysis.stop_multiplier == 0.02
        assert analysis.options == {"overshoot": 1.05}

    def test_every_option_has_its_key(self):
        own = {field.name for field in fields(Analysis)} - {"options"}
        assert set(AnalysisSection.model_fields) - own == set(OPTION_NAMES)

    def test_an_engine_that_is_not_there_is_an_error_where_one_is_needed(self, tmp_path):
        text = changed('"equilibrium"', '"mine"')
        assert read(tmp_path, text, need_engine=False).analysis.engine == "mine"
        with pytest.raises(ModelError, match=r'analysis\.engine: there is no engine "mine"'):
            read(tmp_path, text)


class TestJointBetween:
    def test_takes_the_rest_from_joint(self, tmp_path):
        assembly = read(tmp_path, with_pair('"b1 base"', "friction_coefficient = 0.3")).assembly
        (law,) = assembly.joint_between.values()
        assert law == JointLaw(friction_coefficient=0.3, normal_stiffness=1e8, shear_stiffness=1e11)
        assert assembly.law_index(np.array([0]), np.array([1])).tolist() == [1]

    def test_two_blocks_of_one_material(self, tmp_path):
        assembly = read(tmp_path, with_pair('"stone stone"', "cohesion = 1e3")).assembly
        assert list(assembly.joint_between) == [frozenset({"stone"})]

    def test_ids_may_hold_spaces(self, tmp_path):
        text = with_pair('"the base b1"', "cohesion = 1e3").replace('"base"', '"the base"')
        assert list(read(tmp_path, text).assembly.joint_between) == [frozenset({"the base", "b1"})]

    def test_materials_without_blocks_are_left_out(self, tmp_path):
        text = with_pair('"stone brick"', "cohesion = 1e3").replace(
            "[joint]", "[material.brick]\nunit_weight = 1e4\n\n[joint]"
        )
        text = text.replace('id = "base"', 'id = "base"\nmaterial = "stone"')
        assert not read(tmp_path, text).assembly.joint_between

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            (with_pair('"b1 bse"'), 'joint.between."b1 bse": there is no block or material "bse"'),
            (with_pair('"b1 bse"'), 'did you mean "base"?'),
            (with_pair('"b1"'), "joint.between.b1: must name two blocks, groups or materials"),
            (with_pair('"b1 b1"'), "names the same block twice"),
            (with_pair('"b1 stone"'), "names a block or a group and a material"),
            (with_pair('"b1 base"', "frction = 1"), 'unknown key "frction"'),
            (with_pair('"b1 base"', "cohesion = -1"), 'joint.between."b1 base".cohesion: must be'),
            (with_pair('"b1 base"', "dilatancy_angle = 34"), "more than the friction angle"),
            (
                with_pair('"b1 base"', '[joint.between."base b1"]'),
                'joint.between."base b1": this pair has a law already',
            ),
        ],
    )
    def test_broken(self, tmp_path, text, said):
        assert any(said in problem for problem in problems(tmp_path, text))


class TestBrokenText:
    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("", "is empty"),
            (" \n\n", "is empty"),
            (b"\x89PNG\r\n", "is not text (byte 1 is not UTF-8)"),
            ("dimension = 2\nthickness = \n", "line 2, column 13: not valid TOML: Invalid value"),
            ("dimension = 2\n[load", "line 2, column 6 (end of the file): not valid TOML"),
            (GOOD[: GOOD.index("0.9], [-0.2")], "not valid TOML"),
            ("dimension = 2\ndimension = 2\n", "line 2, column 14: not valid TOML: Cannot over"),
            ("a = " + "[" * 10_000, "nested too deeply"),
            ("a = 1" + "0" * 5000, "thousands of digits"),
            ("a" + ".a" * 200_000 + " = 1", "a key of too many parts"),
            ("[a" + ' . "a b" ' * 200_000 + "]", "a key of too many parts"),
            ("[joint]\nbetween = { a" + ".a" * 40 + " = 1 }", "a key of too many parts"),
            ("a = " + "[" * 100 + "]" * 100, "nested too deeply"),
            ("dimension = 2020-13-45", "not valid TOML"),
        ],
    )
    def test_toml(self, tmp_path, text, said):
        (problem,) = problems(tmp_path, text)
        assert said in problem

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ('{"dimension": 2,', "line 1, column 17: not valid JSON"),
            ('{"a": 1}\n{"b": 1}', "line 2, column 1: not valid JSON"),
            ("[1, 2]", "must hold a table"),
            ('{"load": {"a": 1, "a": 2}}', 'key "a" is given twice'),
            ('{"title": "\\ud800"}', "half a character"),
            ('{"a": ' * 900 + "1" + "}" * 900, "nested too deeply"),
            ('{"title": ' + "[" * 100_000, "nested too deeply"),
            (b"\xff", "is not text"),
            ("dimension = 2", "not valid JSON"),
        ],
    )
    def test_json(self, tmp_path, text, said):
        (problem,) = problems(tmp_path, text, "model.json")
        assert said in problem

    def test_missing_file(self, tmp_path):
        with pytest.raises(ModelError, match=r"nowhere\.toml: there is no such file"):
            read_model(tmp_path / "nowhere.toml")

    def test_folder(self, tmp_path):
        with pytest.raises(ModelError, match="is a folder"):
            read_model(tmp_path)

    def test_impossible_name(self):
        with pytest.raises(ModelError, match="cannot be read"):
            read_model("a\0b")


class TestBrokenKeys:
    @pytest.mark.parametrize(
        ("old", "new", "said"),
        [
            # dimension, thickness
            ("dimension = 2\n", "", "dimension is missing: add it (dimension = 2, or 3)"),
            ("dimension = 2", "dimension = 3", "thickness: is for models in the plane only"),
            ("dimension = 2", "dimension = 4", "dimension: must be 2 or 3, it is 4"),
            ("dimension = 2", 'dimension = "2"', "dimension: must be 2 or 3, it is the text"),
            ("thickness = 1.0\n", "", "thickness is missing"),
            ("thickness", "thicknes", 'unknown key "thicknes": did you mean "thickness"?'),
            ("thickness = 1.0", "thickness = 0", "thickness: must be greater than 0, it is 0"),
            ("thickness = 1.0", 'thickness = "1.0"', "thickness: must be a number"),
            ("thickness = 1.0", 'thickness = "1.0"', "take the quotes off"),
            ("thickness = 1.0", "thickness = true", "must be a number, it is true"),
            ("thickness = 1.0", "thickness = nan", "thickness: must be a finite number, it is nan"),
            ("thickness = 1.0", "thickness = -inf", "thickness: must be a finite number"),
            ("thickness = 1.0", "thickness = 1e300", "thickness: must be at most 1e+06"),
            ("thickness = 1.0", "thickness = 1" + "0" * 400, "thickness: must be a number"),
            # material
            ("[material.stone]\nunit_weight = 10e3\n", "", "material is missing"),
            ("unit_weight = 10e3", "", "material.stone: has neither unit_weight"),
            ("10e3", "10e3\ndensity = 1", "material.stone: has both unit_weight"),
            ("unit_weight", "weight", 'material.stone: unknown key "weight"'),
            ("10e3", "-10e3", "material.stone.unit_weight: must be greater than 0, it is -10000"),
            ("[material.stone]\n", "[material]\nstone = 3\n", "material.stone: must be a table"),
            # joint
            ("friction_coefficient = 0.65\n", "", "joint: friction_coefficient is missing"),
            ("friction_coefficient", "friction", 'did you mean "friction_coefficient"?'),
            ("0.65", "-0.65", "joint.friction_coefficient: must be at least 0, it is -0.65"),
            ("normal_stiffness = 1e8\n", "", "joint: normal_stiffness is missing: add it in Pa/m"),
            ("shear_stiffness = 1e11\n", "", "joint: shear_stiffness is missing"),
            ("1e8", "-1e8", "joint.normal_stiffness: must be greater than 0"),
            ("1e8", "0.0", "joint.normal_stiffness: must be greater than 0"),
            ("1e8", "inf", "joint.normal_stiffness: must be a finite number"),
            ("angle = 0.0", "angle = 40.0", "joint.dilatancy_angle: 40 degrees is more than"),
            ("angle = 0.0", "angle = -1.0", "joint.dilatancy_angle: must be at least 0"),
            # corner
            ("0.02", "0.02\nchamfer = 0.02", "corner: has both radius and chamfer"),
            ("0.02", "-0.02", "corner.radius: must be at least 0"),
            ("0.02", "0.1", 'corner, at block[1] "base": the corner radius 0.1 m leaves nothing'),
            ("radius = 0.02", "chamfer = 0.2", 'corner, at block[1] "base": the chamfer of 0.2 m'),
            # block
            ('id = "b1"\n', "", "block[2]: id is missing"),
            ('id = "b1"', "id = 1", "block[2].id: must be text in quotes, it is 1"),
            ('id = "b1"', 'id = ""', 'block[2] "" id: must be a name'),
            ('id = "b1"', 'id = "a\\nb"', 'block[2] "a\\nb" id: must be a name'),
            ('id = "b1"', 'id = "base"', 'the id is taken by block[1] "base": give it another'),
            ('id = "b1"', 'id = "b1"\ncolour = 1', 'block[2] "b1": unknown key "colour"'),
            ('material = "stone"', 'material = "ston"', 'block[2] "b1" material: there is no mat'),
            ("support = true", "support = 1", 'block[1] "base" support: must be true or false'),
            ("support = true", "support = false", "no block is a support: set support = true"),
            (f"vertices = {VERTICES}\n", "", 'block[2] "b1": vertices is missing'),
            (VERTICES, f"{VERTICES}\nsupport = true", "every block is a support"),
            (VERTICES, '"square"', 'block[2] "b1" vertices: must be a list'),
            (VERTICES, "[[0, 0], [1, 0], [1]]", 'block[2] "b1" vertices[3]: must have 2 entries'),
            (VERTICES, "[[0, 0], [1, 0, 0], [1, 1]]", "vertices[2]: must have 2 entries, it has 3"),
            (VERTICES, '[[0, 0], [1, "0"], [1, 1]]', "vertices[2][2]: must be a number"),
            (VERTICES, "[[0, 0], [1, nan], [1, 1]]", "vertices[2][2]: must be a finite number"),
            (VERTICES, "[[0, 0], [1e9, 0], [1, 1]]", "vertices[2][1]: must be at most 1e+08"),
            (VERTICES, "[]", 'block[2] "b1" vertices: a polygon needs at least 3 vertices'),
            (VERTICES, "[[0, 0], [1, 0], [2, 0]]", "vertices: the outline encloses no area"),
            (VERTICES, "[[0, 0], [2, 2], [2, 0], [0, 1]]", "vertices: the outline crosses itself"),
            (VERTICES, "[[0, 0], [1, 0], [1, 0], [1, 1]]", "vertices 2 and 3 are the same point"),
            (
                VERTICES,
                "[[0, -0.0123], [0.4, -0.0123], [0.4, 1], [0, 1]]",
                'block[1] "base" and block[2] "b1" overlap by 12.3 mm: move them apart',
            ),
            (
                VERTICES,
                "[[0, 0.05], [0.4, 0.05], [0.4, 1], [0, 1]]",
                'block[2] "b1" touches no other block (block[1] "base" is nearest, 50 mm away)',
            ),
            # load
            ("[load]", "[loads]", 'unknown key "loads": did you mean "load"?'),
            ('pattern = "mass"\n', "", "load: pattern is missing"),
            ('"mass"', '"masses"', 'load.pattern: must not be "masses": did you mean "mass"?'),
            ('"mass"', '"forces"', 'load: has direction, which does not belong to pattern'),
            ("direction = [1.0, 0.0]\n", "", "load: direction is missing"),
            ("[1.0, 0.0]\n\n[control]", "[0.0, 0.0]\n\n[control]", "load.direction: has no length"),
            ("[1.0, 0.0]\n\n[control]", "[0, 0, 1]\n\n[control]", "load.direction: must have 2"),
            ("[1.0, 0.0]\n\n[control]", "[inf, 0]\n\n[control]", "load.direction[1]: must be a"),
            # control
            ('block = "b1"', 'block = "b2"', 'there is no block "b2": did you mean "b1"?'),
            ('block = "b1"', 'block = "base"', 'control.block: "base" is a support'),
            ('"top right"', '"top rigth"', 'control.point: there is no point "top rigth": did you'),
            ('"top right"', "[0.3, 0.3]", 'control.point: (0.3, 0.3) is not on block "b1"'),
            ('"top right"', "[0.3]", "control.point: must be [x, y] in metres"),
            ('"top right"', "[nan, 0.3]", "control.point: must be [x, y] in metres"),
            ('"top right"', "[true, 0.3]", "control.point: must be [x, y] in metres"),
            ('"top right"', '"centre"\ndirection = [0, 0]', "control.direction: has no length"),
            # analysis
            ('"equilibrium"', '"equilibrum"', 'analysis.engine: there is no engine "equilibrum"'),
            ('"equilibrium"', '"equilibrum"', 'did you mean "equilibrium"?'),
            ("[analysis]", '[analysis]\nstrategy = "publishd"', 'did you mean "published"?'),
            ("stop_multiplier = 0.01", "stop_multiplier = 0", "analysis.stop_multiplier: must be"),
            ("stop_multiplier = 0.01", "overshoot = 0.99", "analysis.overshoot: must be at"),
            ("stop_multiplier = 0.01", "time_step = 0", "analysis.time_step: must be greater than"),
            ("stop_multiplier = 0.01", "overshot = 1.1", 'did you mean "overshoot"?'),
        ],
    )  # fmt: skip
    def test_names_the_place_and_the_mend(self, tmp_path, old, new, said):
        found = problems(tmp_path, changed(old, new))
        assert any(said in problem for problem in found), found

    @pytest.mark.parametrize("key", ["1.1.1.1." * 9, '"a.b" # a.a.a' + ".a" * 50])
    def test_dots_that_are_no_keys(self, tmp_path, key):
        title = key if "#" in key else f'"{key}"'
        assert read(tmp_path, changed('"Two blocks"', title)).title in title

    @pytest.mark.parametrize(
        ("old", "new", "said"),
        [
            ("10e3", "1e-200", "unit_weight: must be at least 0.001, it is 1e-200: give it in N"),
            ("thickness = 1.0", "thickness = 1e-300", "must be at least 1e-06, it is 1e-300: give"),
            ("1e8", "1e-200", "normal_stiffness: must be at least 0.001, it is 1e-200: give it in"),
            ("1e8", "1e200", "normal_stiffness: must be at most 1e+20, it is 1e+200: give it in"),
            ("0.65", "1e29", "friction_coefficient: must be at most 1e+06, it is 1e+29"),
            ("angle = 0.0", "angle = 89.999999", "dilatancy_angle: must be at most 89.9"),
            ("stop_multiplier = 0.01", "time_step = 1e-300", "time_step: must be at least 1e-09"),
            ("stop_multiplier = 0.01", "increment = 1e30", "increment: must be at most 1000"),
            ("stop_multiplier = 0.01", "max_steps = 0.5", "max_steps: must be a whole number"),
            ("stop_multiplier = 0.01", "max_penetration = 0", "max_penetration: must be greater"),
            ("stop_multiplier = 0.01", "patience = 1.5", "patience: must be a whole number"),
            ("stop_multiplier = 0.01", "displacement_step = 1e-300", "must be at least 1e-09, it"),
            (
                '"top right"',
                '"top right"\ndirection = [-1, 0.5]',
                "control.direction: leads against",
            ),
            ('"top right"', '"top right"\ndirection = [0, 1]', "control.direction: leads against"),
        ],
    )
    def test_values_at_the_rim(self, tmp_path, old, new, said):
        (problem,) = problems(tmp_path, changed(old, new))
        assert said in problem

    @pytest.mark.parametrize(
        ("lines", "said"),
        [
            (["unit = [0.4, 0.2]"], "wall: courses is missing"),
            (['courses = ["1"]'], "wall: unit is missing"),
            (["unit = [0.4, 0.2]", "courses = []"], "wall.courses: must have at least 1 entry"),
            (["unit = [0.4]", 'courses = ["1"]'], "wall.unit: must have 2 entries, it has 1"),
            (["unit = [0.4, 0]", 'courses = ["1"]'], "wall.unit[2]: must be greater than 0"),
            (["unit = [0.4, 0.2]", 'courses = ["1x"]'], 'wall.courses[1]: has "x" as letter 2'),
            (["unit = [0.4, 0.2]", 'courses = ["1", ""]'], "wall.courses[2]: is empty"),
            (["unit = [0.4, 0.2]", "courses = [11]"], "wall.courses[1]: must be text in quotes"),
            (["unit = [0.4, 0.2]", 'courses = ["1"]', "repeat = 0"], "wall.repeat: must be at"),
            (["unit = [0.4, 0.2]", 'courses = ["1"]', "repeat = 1.5"], "must be a whole number"),
            (["unit = [0.4, 0.2]", 'courses = ["1"]'], "no block is a support"),
            (["unit = [0.4, 0.2]", 'courses = ["1"]', 'material = "x"'], "wall.material: there is"),
            (["unit = [0.4, 0.2]", 'courses = [".."]', "base = true"], "nothing can move"),
            (
                ["unit = [0.4, 0.2]", 'courses = ["1", "..", "1"]', "base = true"],
                'wall block "c3u1" touches no other block (wall block "c1u1" is nearest, 200 mm',
            ),
        ],
    )
    def test_wall(self, tmp_path, lines, said):
        found = problems(tmp_path, with_wall(*lines))
        assert any(said in problem for problem in found), found

    def test_base_of_a_wall_has_its_name_taken(self, tmp_path):
        text = changed(
            "[load]",
            '[wall]\nunit = [0.4, 0.2]\ncourses = ["1"]\nbase = true\norigin = [5, 0]\n\n[load]',
        )
        (problem,) = problems(tmp_path, text)
        assert 'block[1] "base": the id is taken by wall block "base"' in problem

    def test_material_must_be_named_where_there_are_two(self, tmp_path):
        text = changed("[joint]", "[material.brick]\nunit_weight = 1e4\n\n[joint]")
        (problem,) = problems(tmp_path, text)
        assert problem.startswith('block[1] "base" material is missing')

    def test_single_brackets_for_a_block(self, tmp_path):
        text = GOOD.replace(BLOCKS, '[block]\nid = "b1"\n\n')
        assert "write [[block]] with two brackets" in problems(tmp_path, text)[0]

    def test_no_block_at_all(self, tmp_path):
        text = GOOD.replace(BLOCKS, "")
        assert problems(tmp_path, text) == [
            "block: there is none: add [[block]], [[build]] or [wall]"
        ]

    def test_everything_wrong_is_said_at_once(self, tmp_path):
        text = changed("thickness", "thicknes").replace("0.65", "-0.65").replace("10e3", "nan")
        found = problems(tmp_path, text)
        assert len(found) == 4  # missing, unknown, negative, not finite

    def test_no_more_than_ten_are_listed(self, tmp_path):
        blocks = "".join(
            f'[[block]]\nid = "x{i}"\nvertices = [[0, 0], [1, 0], [2, 0]]\n' for i in range(30)
        )
        with pytest.raises(ModelError) as caught:
            read(tmp_path, changed("[load]", blocks + "\n[load]"))
        assert len(caught.value.problems) == 30
        lines = str(caught.value).splitlines()
        assert len(lines) == 11
        assert lines[-1] == "... and 20 more"


class TestWriting:
    @pytest.mark.parametrize("ending", ["toml", "json"])
    @pytest.mark.parametrize("number", [1, 2, 3])
    def test_published_walls_come_back_the_same(self, tmp_path, number, ending):
        model = published_wall(number)
        write_model(model, tmp_path / f"wall.{ending}")
        again = read_model(tmp_path / f"wall.{ending}")
        assert model_to_dict(again) == model_to_dict(model)
        assert np.array_equal(again.assembly.mass, model.assembly.mass)
        assert np.array_equal(again.assembly.shapes.vertices, model.assembly.shapes.vertices)
        assert again.assembly.laws == model.assembly.laws
        assert again.control_point.block == model.control_point.block

    @pytest.mark.parametrize("ending", ["toml", "json"])
    def test_odd_names_numbers_and_settings(self, tmp_path, ending):
        text = with_pair('"stone stone"', "friction_coefficient = 0.3", "cohesion = 1e-300")
        text = text.replace("Two blocks", 'A \\"wall\\" \\\\ of\\tstöne \\u007f')
        text = text.replace('"b1"', "\"b.1 'é'\"").replace("stop_multiplier = 0.01", "patience = 7")
        text = text.replace("direction = [1.0, 0.0]", "direction = [1.0, 0.3]").replace(
            '"top right"', "[0.1, 0.1]"
        )
        model = read(tmp_path, text)
        path = tmp_path / f"written.{ending}"
        write_model(model, path)
        assert model_to_dict(read_model(path)) == model_to_dict(model)

    def test_without_stiffness(self, tmp_path):
        text = changed("normal_stiffness = 1e8\nshear_stiffness = 1e11\n", "")
        write_model(read(tmp_path, text, need_stiffness=False), tmp_path / "limit.toml")
        again = read_model(tmp_path / "limit.toml", need_stiffness=False)
        assert again.assembly.joint.normal_stiffness is None


class TestExamples:
    @pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
    def test_can_be_read(self, path):
        assert read_model(path).assembly.n_blocks > 0

    @pytest.mark.parametrize("number", [1, 2, 3])
    def test_walls_are_the_published_ones(self, number):
        example, published = read_model(EXAMPLES / f"wall{number}.toml"), published_wall(number)
        a, b = model_to_dict(example), model_to_dict(published)
        assert {**a, "title": ""} == {**b, "title": ""}


def test_a_default_control_point_is_written_as_one(tmp_path):
    """Named, it would stay on its block where another one falls first."""
    write_model(stack((0.4, 1.0)), tmp_path / "model.toml")
    assert read_model(tmp_path / "model.toml").control_point.default
    write_model(stack((0.4, 1.0), control_point="top left"), tmp_path / "model.toml")
    assert not read_model(tmp_path / "model.toml").control_point.default


def test_a_default_control_point_that_was_moved_on_its_block_is_written(tmp_path):
    """A reader would take the usual one, whose displacements are others."""
    model = stack((0.4, 1.0))
    usual = model.control_point
    moved = replace(model, control_point=replace(usual, point=np.array([-0.2, 0.0])))
    assert moved.sha256 != model.sha256
    write_model(moved, tmp_path / "model.toml")
    again = read_model(tmp_path / "model.toml").control_point
    assert again.point.tolist() == [-0.2, 0.0] and again.block == usual.block
    solid = ds.extruded(model)  # halfway between two usual points
    write_model(solid, tmp_path / "solid.toml")
    assert read_model(tmp_path / "solid.toml").control_point.default
