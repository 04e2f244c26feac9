"""[[import]] in model files, and `drystone convert` between drawings and models."""

from __future__ import annotations

import csv
import json
import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drawn import bent_dome, brick_wall, obj_text
from drystone.cli import app
from drystone.io.convert.like import fitting
from drystone.io.modelfile import read_model
from drystone.model.builders import ModelError
from drystone.model.inspection import inspect

HEAD = """\
dimension = 3
[material.stone]
unit_weight = 20e3
[material.brick]
unit_weight = 18e3
[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9
[load]
pattern = "mass"
direction = [0.0, 1.0, 0.0]
"""
IMPORT = """\
[[import]]
file = "wall.obj"
unit = "m"
up = "z"
material = "stone"
support = ["c0*"]
"""


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "wall.obj").write_text(obj_text(brick_wall()))
    return tmp_path


def read(folder: Path, text: str) -> ds.Model:
    path = folder / "model.toml"
    path.write_text(text)
    return read_model(path)


def pairs(model: ds.Model) -> dict[tuple[str, str], float]:
    """Area of the joints between each two blocks, by their ids."""
    found: dict[tuple[str, str], float] = {}
    joints, ids = model.assembly.interfaces, model.assembly.ids
    for a, b, size in zip(joints.block_a, joints.block_b, joints.size, strict=True):
        found[ids[a], ids[b]] = found.get((ids[a], ids[b]), 0.0) + float(size)
    return found


class TestModelFile:
    def test_blocks_of_a_file_beside_others(self, folder):
        text = HEAD + IMPORT + 'name = "south"\ngroup = "wall"\n'
        text += '[[block]]\nid = "b"\nmaterial = "brick"\nsupport = true\n'
        text += "box = [[9, 0, 0], [10, 1, 1]]\n"
        assembly = read(folder, text).assembly
        assert assembly.ids[:2] == ("b", "south/c0u0")
        assert assembly.n_supports == 3
        assert len(assembly.groups["wall"]) == 6
        assert set(assembly.weight[assembly.groups["wall"]].round(6)) == {20e3 * 0.4 * 0.15 * 0.2}

    def test_layers_are_materials_of_their_names(self, folder):
        text = obj_text(brick_wall()).replace("o c2u0", "o c2u0\nusemtl brick")
        (folder / "wall.obj").write_text(text)
        assembly = read(folder, HEAD + IMPORT).assembly
        materials = {b.id: b.material for b in assembly.blocks}
        assert [name for name, own in materials.items() if own == "brick"] == ["c2u0", "c2u1"]

    def test_letters_of_a_layer_may_be_of_another_case(self, folder):
        text = obj_text(brick_wall()).replace("o c2u0", "o c2u0\nusemtl BRICK")
        (folder / "wall.obj").write_text(text)
        between = '[joint.between."stone brick"]\nfriction_coefficient = 0.1\n'
        assembly = read(folder, HEAD + between + IMPORT).assembly
        assert {b.material for b in assembly.blocks if "BRICK" in b.groups} == {"brick"}
        assert len(assembly.laws) == 2
        back, model = folder / "back.toml", folder / "model.toml"
        given = ("--like", model, "--unit", "m", "--up", "z", "--material", "stone")
        assert run(folder / "wall.obj", back, *given, "--support", "c0*")[0] == 0
        again = read_model(back).assembly
        assert [b.material for b in again.blocks] == [b.material for b in assembly.blocks]

    def test_of_materials_that_differ_by_case_the_exact_one_is_taken(self, folder):
        text = obj_text(brick_wall()).replace("o c2u0", "o c2u0\nusemtl BRICK")
        (folder / "wall.obj").write_text(text)
        more = "[material.BRICK]\nunit_weight = 15e3\n"
        assembly = read(folder, HEAD + more + IMPORT).assembly
        assert {b.material for b in assembly.blocks} == {"stone", "BRICK"}

    def test_a_joint_between_materials_that_layers_are_named_after(self, folder):
        text = obj_text(brick_wall()).replace("o c2u0", "o c2u0\nusemtl brick")
        (folder / "wall.obj").write_text(text.replace("o c1u0", "o c1u0\nusemtl stone"))
        between = '[joint.between."stone brick"]\nfriction_coefficient = 0.1\n'
        assembly = read(folder, HEAD + between + IMPORT).assembly
        assert set(assembly.groups) == {"stone", "brick"}
        joints, bricks = assembly.interfaces, assembly.groups["brick"]
        index = assembly.law_index(joints.block_a, joints.block_b)
        mixed = np.isin(joints.block_a, bricks) != np.isin(joints.block_b, bricks)
        assert (index == np.where(mixed, 1, 0)).all() and mixed.any()

    def test_groups_of_patterns_hold_imported_blocks(self, folder):
        text = HEAD + IMPORT + '[group.top]\nblocks = ["c2*"]\n'
        text += '[joint.between."top c1u0"]\nfriction_coefficient = 0.1\n'
        assembly = read(folder, text).assembly
        assert len(assembly.groups["top"]) == 2
        assert len(assembly.laws) == 2

    def test_what_was_mended_is_told(self, folder):
        rounded = [(n, np.round(v, 3), f + f) for n, v, f in bent_dome()]
        (folder / "wall.obj").write_text(obj_text(rounded, decimals=3))
        text = HEAD + IMPORT.replace('["c0*"]', '["r0*"]')
        model = read(folder, text)
        assert {record.block for record in model.mended} == {n for n, _, _ in rounded}
        notes = "\n".join(model.notes)
        assert 'import "wall.obj": 18 blocks had faces that were drawn twice: "r0b0"' in notes
        assert model.with_joint(friction_coefficient=0.8).mended == model.mended

    @pytest.mark.parametrize(
        ("old", "new", "said"),
        [
            ('file = "wall.obj"\n', "", "import[1]: file is missing"),
            ('"wall.obj"', '"wal.obj"', 'import[1] "wal.obj": there is no such file'),
            ('unit = "m"\n', "", 'import[1] "wall.obj": unit is missing'),
            ('unit = "m"', 'unit = "km"', 'import[1].unit: must not be "km"'),
            ('up = "z"\n', "", 'import[1] "wall.obj": up is missing'),
            ('"stone"\nsupport', '"stne"\nsupport', 'no material "stne": did you mean "stone"'),
            ('material = "stone"\nsupport', "support", "material is missing"),
            ('["c0*"]', '["d*"]', 'support: there is no block, group or layer "d*"'),
            ('up = "z"', 'up = "z"\ntolerance = 2', "import[1].tolerance: must be at most 0.2"),
            ('up = "z"', 'up = "z"\nrotation = [1, 2]', "one angle in degrees, or in space three"),
            ('up = "z"', 'up = "z"\norigin = [1, 2]', "import[1].origin: must have 3 entries"),
            ('up = "z"', 'up = "z"\nbent_faces = "x"', 'import[1].bent_faces: must not be "x"'),
            ('up = "z"', 'up = "z"\noverlap = -1', "import[1].overlap: must be at least 0"),
            ('up = "z"', 'up = "z"\nunits = 1', 'unknown key "units": did you mean "unit"'),
        ],
    )
    def test_what_is_said_of_tables_that_are_wrong(self, folder, old, new, said):
        text = HEAD + IMPORT
        assert text.count(old) == 1
        with pytest.raises(ModelError) as error:
            read(folder, text.replace(old, new))
        assert said in str(error.value)

    def test_dimensions_must_be_those_of_the_model(self, folder):
        text = HEAD.replace("dimension = 3", "dimension = 2\nthickness = 1.0")
        text = text.replace("[0.0, 1.0, 0.0]", "[1.0, 0.0]")
        with pytest.raises(ModelError, match="holds blocks of 3 dimensions, the model has 2"):
            read(folder, text + IMPORT.replace('up = "z"\n', ""))

    def test_overlaps_are_refused_and_the_option_that_is_named_mends_them(self, folder):
        blocks = brick_wall()
        name, vertices, faces = blocks[2]
        blocks[2] = (name, vertices - [0.0, 0.0, 0.02], faces)
        (folder / "wall.obj").write_text(obj_text(blocks))
        with pytest.raises(ModelError, match=r"overlap by 20 mm: .* overlap = 0\.021 in") as error:
            read(folder, HEAD + IMPORT)
        assert len(error.value.problems) == 2  # it stands on two
        model = read(folder, HEAD + IMPORT + "overlap = 0.021\n")
        assert len(pairs(model)) == 9
        assert "had vertices moved to close joints" in "\n".join(model.notes)

    def test_what_lies_between_two_imports_is_told_and_not_mended(self, folder):
        blocks = brick_wall()
        (folder / "wall.obj").write_text(obj_text(blocks[:4]))
        above = [
            (name, vertices + [0.0, 0.0, 0.001], faces) for name, vertices, faces in blocks[4:]
        ]
        (folder / "top.obj").write_text(obj_text(above))
        text = HEAD + IMPORT + IMPORT.replace("wall", "top").replace('support = ["c0*"]\n', "")
        told = "\n".join(inspect(read(folder, text)).problems)
        for pair in ('"c1u0" and "c2u0"', '"c1u0" and "c2u1"', '"c1u1" and "c2u1"'):
            assert f"{pair} have faces 1 mm apart" in told
        with pytest.raises(ModelError, match=r"overlap by 1 mm: .* smaller$"):
            read(folder, text + "origin = [0, 0, -0.002]\n")

    def test_plane_drawings(self, tmp_path):
        ezdxf = pytest.importorskip("ezdxf")
        document = ezdxf.new("R2010", units=5)
        for k, layer in enumerate(("support", "stone", "brick")):
            outline = [(0, 50 * k), (100, 50 * k), (100, 50 * k + 50), (0, 50 * k + 50)]
            document.modelspace().add_lwpolyline(outline, close=True, dxfattribs={"layer": layer})
        document.modelspace().add_point((100, 140), dxfattribs={"layer": "control"})
        document.saveas(tmp_path / "pile.dxf")
        text = HEAD.replace("dimension = 3", "dimension = 2\nthickness = 1.0")
        text = text.replace("[0.0, 1.0, 0.0]", "[1.0, 0.0]")
        model = read(tmp_path, text + '[[import]]\nfile = "pile.dxf"\nmaterial = "stone"\n')
        assert model.assembly.ids == ("support/1", "stone/2", "brick/3")
        assert model.assembly.fixed.tolist() == [True, False, False]
        assert model.assembly.weight.tolist() == [10e3, 10e3, 9e3]
        assert model.control_point.block == 2
        assert model.control_point.point.tolist() == pytest.approx([1.0, 1.4])
        # A square on a square: the upper one topples where its weight is 1 m wide and 0.5 m high,
        # both together at one, all sliding at 0.7.
        assert ds.collapse_load(model).load_multiplier == pytest.approx(0.7, rel=1e-6)


ARCH = """
[[build]]
kind = "arch"
name = "a"
material = "stone"
span = 2.0
thickness = 0.35
depth = 0.5
voussoirs = 7
base = true
"""


def peak(model: ds.Model) -> float:
    """Of a curve that is followed until it has fallen by a tenth."""
    limit = ds.collapse_load(model, flow="associative").load_multiplier
    assert limit is not None
    curve = ds.pushover(model.with_analysis(stop_multiplier=0.9 * limit))
    return max(point.load_multiplier for point in curve.points)


def run(*words: object):
    result = CliRunner().invoke(app, ["convert", *map(str, words), "--json"])
    return result.exit_code, json.loads(result.stdout) if result.stdout else {}, result.stderr


class TestConvert:
    @pytest.fixture
    def model(self, folder) -> Path:
        path = folder / "model.toml"
        path.write_text(HEAD + IMPORT)
        return path

    @pytest.mark.parametrize("ending", ["dxf", "obj", "json", "ply", "stl"])
    def test_a_model_as_a_drawing_and_back(self, folder, model, ending):
        if ending == "dxf":
            pytest.importorskip("ezdxf")
        file = folder / f"again.{ending}"
        assert run(model, file)[0] == 0
        given = [] if ending == "dxf" else ["--unit", "m"]
        given += ["--up", "z"] * (ending in ("obj", "ply", "stl"))
        given += ["--support", "c0*"] * (ending in ("ply", "stl"))
        back = folder / "back.toml"
        code, told, _ = run(file, back, *given, "--like", model, "--material", "stone")
        assert code == 0
        assert told["n_blocks"] == 6
        first, again = read_model(model), read_model(back)
        assert again.assembly.ids == first.assembly.ids
        assert again.assembly.fixed.tolist() == first.assembly.fixed.tolist()
        assert pairs(again) == pytest.approx(pairs(first), rel=1e-9)
        a, b = (ds.collapse_load(m, flow="associative").load_multiplier for m in (first, again))
        assert b == pytest.approx(a, rel=1e-6)  # of the solver

    def test_what_names_blocks_of_the_other_model_is_left_out_and_told(self, folder, model):
        assert run(model, folder / "again.obj")[0] == 0
        site = '[site]\ncode = "ec8"\nag = 0.2\ntype = 1\nground = "B"\nimportance = "II"\n'
        dead = '[[dead_load]]\nkind = "point"\nblock = "c0"\nforce = [0.0, -1.0]\n'
        model.write_text(model.read_text() + site + '[assessment]\nmethod = "ec8-n2"\n' + dead)
        back = folder / "back.toml"
        given = ("--unit", "m", "--up", "z", "--like", model, "--material", "stone")
        code, told, _ = run(folder / "again.obj", back, *given)
        text = back.read_text()
        assert code == 0 and "[site]" in text and "[assessment]" in text
        assert "dead_load" not in text
        assert any("[dead_load] left out" in note for note in told["notes"])

    def test_names_of_other_blocks_are_left_out_one_by_one(self, folder, model):
        """What was written was refused as it was read; what fits stays."""
        assert run(model, folder / "again.obj")[0] == 0
        text = model.read_text()
        like, back = folder / "like.toml", folder / "back.toml"
        first, second = read_model(model).assembly.ids[:2]
        law = "friction_coefficient = 0.4\nnormal_stiffness = 1e9\nshear_stiffness = 1e9\n"
        like.write_text(
            text.replace("[control]", '[control]\nblock = "pier"')
            + ("" if "[control]" in text else '[control]\nblock = "pier"\n')
            + f'[joint.between."{first} {second}"]\n{law}[joint.between."base pier"]\n{law}'
            + f'[assessment]\nmethod = "ec8-n2"\nparts_that_may_fall = ["{first}", "pier"]\n'
        )
        given = ("--unit", "m", "--up", "z", "--like", like, "--material", "stone")
        code, told, _ = run(folder / "again.obj", back, *given)
        assert code == 0
        assert any('"base pier"' in n and '"pier"' in n and "left out" in n for n in told["notes"])
        again = read_model(back)
        assert list(again.assembly.joint_between) == [frozenset((first, second))]
        assert again.parts_that_may_fall == {first}
        forces = [{"block": name, "force": [1.0, 0.0, 0.0]} for name in (first, "pier")]
        for given, left in ((forces, forces[:1]), (forces[1:], None)):
            load = {"load": {"pattern": "forces", "force": given}}
            kept, notes = fitting(load, again.assembly.blocks, like)
            assert len(notes) == 1
            assert kept.get("load") == (left and {"pattern": "forces", "force": left})

    def test_a_model_of_other_dimensions_is_no_pattern(self, folder, model):
        assert run(model, folder / "again.obj")[0] == 0
        plane = folder / "plane.toml"
        plane.write_text(HEAD.replace("dimension = 3", "dimension = 2"))
        given = ("--unit", "m", "--up", "z", "--like", plane, "--material", "stone")
        code, told, _ = run(folder / "again.obj", folder / "back.toml", *given)
        assert code == 2 and not (folder / "back.toml").exists()
        assert "has 2 dimensions, and the drawing 3" in told["problems"][0]

    def test_peaks_of_drawings_are_those_of_the_model(self, folder, model):
        first = read_model(model)
        exact = peak(first)
        for ending in ("dxf", "obj", "json", "ply", "stl"):
            if ending == "dxf" and not find_spec("ezdxf"):
                continue
            assert run(model, folder / f"again.{ending}")[0] == 0
            again = self.read_back(folder, f"again.{ending}", model)
            assert pairs(again).keys() == pairs(first).keys()
            assert peak(again) == pytest.approx(exact, rel=1e-3)

    def test_peaks_of_an_arch_with_all_digits_and_with_three(self, folder):
        arch = folder / "arch.toml"
        arch.write_text(HEAD.replace("[0.0, 1.0, 0.0]", "[1.0, 0.0, 0.0]") + ARCH)
        first = read_model(arch)
        exact = peak(first)
        assert run(arch, folder / "all.obj")[0] == 0
        numbers = r"(?m)(?<=\s)-?\d+\.\d+(e-?\d+)?"
        text = re.sub(numbers, lambda x: f"{float(x[0]):.3f}", (folder / "all.obj").read_text())
        (folder / "three.obj").write_text(text)
        for name in ("all.obj", "three.obj"):
            again = self.read_back(folder, name, arch, "*base*")
            assert pairs(again).keys() == pairs(first).keys()
            # Half a millimetre at either side of 0.35 m is 3e-3 of a joint; of the peak, which
            # seven joints share, less than a third of that.
            assert peak(again) == pytest.approx(exact, rel=1e-3)

    @staticmethod
    def read_back(folder, name, like, support="c0*"):
        given = ["--unit", "m"] * (not name.endswith("dxf"))
        given += ["--up", "z"] * name.endswith(("obj", "ply", "stl"))
        given += ["--support", support] * name.endswith(("obj", "ply", "stl"))
        back = folder / "back.toml"
        assert run(folder / name, back, *given, "--like", like, "--material", "stone")[0] == 0
        return read_model(back)

    def test_three_decimals_give_the_same_joints_after_mending(self, folder, model):
        rng = np.random.default_rng(3)
        disturbed = brick_wall(rng, noise=4e-4, decimals=3)
        (folder / "rounded.obj").write_text(obj_text(disturbed, decimals=3))
        back = folder / "back.toml"
        given = ("--unit", "m", "--up", "z", "--support", "c0*", "--like", model)
        code, told, _ = run(folder / "rounded.obj", back, *given, "--material", "stone")
        assert code == 0
        first, again = read_model(model), read_model(back)
        # Up to 0.9 mm at either end of 0.15 m.
        assert pairs(again) == pytest.approx(pairs(first), rel=0.012)
        a, b = (ds.collapse_load(m, flow="associative").load_multiplier for m in (first, again))
        assert b == pytest.approx(a, abs=3e-3)  # 0.25, with a thickness of 0.15 m less 0.9 mm twice
        with open(folder / "back.mended.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == len(told["mended"]) > 0
        assert max(float(row["how_much_m"]) for row in rows) < 1e-3
        (folder / "exact.obj").write_text(obj_text(brick_wall()))
        assert run(folder / "exact.obj", back, *given, "--material", "stone")[0] == 0
        assert not (folder / "back.mended.csv").exists()  # it was that of the first drawing

    def test_a_plane_model_as_a_drawing_and_back(self, folder):
        pytest.importorskip("ezdxf")
        text = HEAD.replace("dimension = 3", "dimension = 2\nthickness = 1.0")
        text = text.replace("[0.0, 1.0, 0.0]", "[1.0, 0.0]")
        text += '[wall]\nunit = [0.4, 0.175]\ncourses = ["11", "h1h"]\nrepeat = 2\nbase = true\n'
        text += 'material = "brick"\n'
        model = folder / "plane.toml"
        model.write_text(text)
        assert run(model, folder / "plane.dxf")[0] == 0
        assert run(folder / "plane.dxf", folder / "back.toml", "--like", model)[0] == 0
        first, again = read_model(model), read_model(folder / "back.toml")
        assert again.assembly.ids == first.assembly.ids
        assert {b.material for b in again.assembly.blocks} == {"brick"}
        assert pairs(again) == pairs(first)
        assert again.control_point.point.tolist() == first.control_point.point.tolist()
        a, b = (ds.collapse_load(m).load_multiplier for m in (first, again))
        assert b == pytest.approx(a, rel=1e-9)

    def test_what_a_drawing_does_not_say_is_left_to_fill_in(self, folder):
        back = folder / "back.toml"
        code, told, _ = run(folder / "wall.obj", back, "--unit", "m", "--up", "z")
        assert code == 0
        assert "does not say [material], [joint], [load]" in told["notes"][-1]
        marked = back.read_text().splitlines()
        start = (
            len(marked)
            - 1
            - marked[::-1].index(
                "# A drawing does not say this: fill in your numbers and remove the marks."
            )
        )
        filled = [line.removeprefix("# ") if k > start else line for k, line in enumerate(marked)]
        back.write_text("\n".join([*filled, '[group.foot]\nblocks = ["c0*"]\nsupport = true']))
        assert read_model(back).assembly.n_blocks == 4

    @pytest.mark.parametrize(
        ("words", "said"),
        [
            (("wall.obj", "out.toml", "--up", "z"), "unit is missing"),
            (("wall.obj", "out.toml", "--unit", "km", "--up", "z"), "--unit: must be one of m, cm"),
            (("wall.obj", "out.dxf", "--unit", "m"), "make a model of it first"),
            (("none.obj", "out.toml", "--unit", "m", "--up", "z"), "there is no such file"),
            (("wall.obj", "out.toml", "--from", "xyz"), 'nothing to read from "xyz"'),
            (("model.toml", "out.obj", "--to", "?"), "take one of model, udec"),
            (("model.toml", "out.obj", "--unit", "m"), "--unit: is for drawings"),
            (("wall.obj", "out.toml", "--bent-faces", "x"), "--bent-faces: must be fans or bends"),
            (("wall.obj", "out.toml", "--overlap", "-1"), "--overlap: "),
            (("wall.obj", "out.toml", "--like", "none.toml"), "none.toml: there is no such file"),
        ],
    )
    def test_what_is_said_of_commands_that_are_wrong(self, folder, model, words, said):
        words = [str(folder / w) if "." in w else w for w in words]
        result = CliRunner().invoke(app, ["convert", *words])
        assert result.exit_code == 2
        assert said in result.stderr
        assert not (folder / "out.toml").exists()

    def test_models_between_their_own_formats(self, folder, model):
        assert run(model, folder / "plain.toml")[0] == 0
        assert run(folder / "plain.toml", folder / "same.json", "--to", "model")[0] in (0, 2)
        assert pairs(read_model(folder / "plain.toml")) == pairs(read_model(model))
