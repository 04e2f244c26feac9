"""Drawings that are no model yet, or cannot be one: check, show, convert; names of blocks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drawn import box, obj_text
from drystone.cli import app
from drystone.model.builders import ModelError

pytest.importorskip("ezdxf")

ALL = """\
thickness = 0.5
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.7
normal_stiffness = 1e9
shear_stiffness = 1e9
[load]
pattern = "mass"
direction = [1.0, 0.0]
"""
HEAD = "dimension = 2\n"
IMPORT = '[[import]]\nfile = "wall.dxf"\n'


def drystone(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


def drawing(folder: Path, *, deep=0.0, support=True):
    """A wall of two courses; the last stone stands in that beside it by ``deep`` [m]."""
    import ezdxf

    document = ezdxf.new(units=6)
    outlines = [
        ("stone", (0.0, 0.0, 0.4, 0.2)),
        ("stone", (0.4, 0.0, 0.8, 0.2)),
        ("stone", (0.2, 0.2, 0.6, 0.4)),
        ("stone", (0.6 - deep, 0.2, 0.9, 0.4)),
        ("support" if support else "ground", (-0.1, -0.2, 0.9, 0.0)),
    ]
    for layer, (x0, y0, x1, y1) in outlines:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    path = folder / "wall.dxf"
    document.saveas(path)
    return path


def model_file(folder: Path, text: str) -> Path:
    path = folder / "wall.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        (HEAD + IMPORT, ["thickness", "[material]", "[joint]", "[load]", "a support"]),
        (HEAD + ALL + IMPORT, ["a support"]),
        (HEAD + ALL.split("[load]")[0] + IMPORT, ["[load]", "a support"]),
    ],
)
def test_check_and_show_a_file_that_is_no_model_yet(tmp_path, text, missing):
    drawing(tmp_path, support=False)
    path = model_file(tmp_path, text)
    result = drystone("check", path, "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["status"] == "incomplete" and found["missing"] == missing
    assert (found["n_blocks"], found["n_supports"], found["weight"]) == (5, 0, None)
    assert found["problems"] == [f"a model needs {', '.join(missing)} as well"]
    result = drystone("show", path, "--names", "--out", tmp_path / "wall.png")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "wall.png").read_bytes().startswith(b"\x89PNG")
    assert drystone("run", path, "--out", tmp_path / "out").exit_code == 2


def test_check_and_show_a_drawing_itself(tmp_path):
    path = drawing(tmp_path)
    found = json.loads(drystone("check", path, "--json", "--blocks").stdout)
    assert (found["n_blocks"], found["n_supports"], found["n_joints"]) == (4, 1, 7)
    assert [row["id"] for row in found["blocks"] if row["support"]] == ["support/5"]
    first = found["blocks"][0]
    assert first["centre"] == pytest.approx([0.2, 0.1]) and first["upper"] == [0.4, 0.2]
    told = drystone("check", path, "--blocks").stdout
    assert "stone/1        at (0.2, 0.1) m, 0.4 x 0.2 m, stone" in told
    result = drystone("show", path, "--out", tmp_path / "wall.svg", "--names")
    assert result.exit_code == 0, result.output
    assert "stone/3" in (tmp_path / "wall.svg").read_text()
    result = drystone("show", path, "--out", tmp_path / "wall.html")
    assert result.exit_code == 2 and "take a picture" in result.stderr


def test_blocks_of_a_whole_model_are_listed_and_named(tmp_path):
    drawing(tmp_path)
    path = model_file(tmp_path, HEAD + ALL + IMPORT)
    found = json.loads(drystone("check", path, "--blocks", "--json").stdout)
    assert found["status"] == "valid" and len(found["blocks"]) == 5
    assert "stone/4        at" in drystone("check", path, "--blocks").stdout
    for names in ([], ["--names"]):
        drystone("show", path, "--out", tmp_path / "wall.svg", *names)
        assert ("stone/4" in (tmp_path / "wall.svg").read_text()) == bool(names)
    assert drystone("show", path, "--names", "--out", tmp_path / "wall.html").exit_code == 2


def test_overlaps_are_refused_with_the_key_that_closes_them_and_drawn(tmp_path):
    drawing(tmp_path, deep=0.01)  # 0.02 of 0.2 m may be closed
    path = model_file(tmp_path, HEAD + ALL + IMPORT)
    result = drystone("check", path)
    assert result.exit_code == 2
    assert "overlap by 10 mm" in result.stderr and "drystone show draws in red" in result.stderr
    key = "overlap = 0.011"
    assert f"let {key} in [[import]] close the joint" in result.stderr
    result = drystone("show", path, "--out", tmp_path / "wall.svg")
    assert result.exit_code == 2 and "wall.svg shows the blocks" in result.stderr
    picture = (tmp_path / "wall.svg").read_text()
    assert "10 mm" in picture and "#d7191c" in picture
    path.write_text(path.read_text() + key + "\n")
    result = drystone("check", path, "--json")
    assert result.exit_code == 0, result.output
    moved = [r for r in json.loads(result.stdout)["mended"] if "moved" in r["what"]]
    assert max(record["how_much"] for record in moved) == pytest.approx(0.005, rel=0.05)


def test_convert_writes_no_model_that_is_refused(tmp_path):
    path, out = drawing(tmp_path, deep=0.01), tmp_path / "out.toml"
    result = drystone("convert", path, out)
    assert result.exit_code == 2 and not out.exists()
    assert "overlap by 10 mm" in result.stderr and "let --overlap 0.011 close" in result.stderr
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    assert drystone("convert", path, out, "--overlap", "0.011").exit_code == 0
    # What it wrote is no model yet, and shown all the same.
    assert json.loads(drystone("check", out, "--json").stdout)["n_joints"] == 7
    assert drystone("show", out, "--out", tmp_path / "out.png").exit_code == 0


def test_a_block_drawn_twice_is_to_be_taken_out(tmp_path):
    """No overlap closes it: each would lose half."""
    solids = [("a", *box((0, 0, 0), (1, 1, 1))), ("b", *box((0.1, 0, 0), (1, 1, 1)))]
    (tmp_path / "wall.obj").write_text(obj_text(solids))
    words = ("convert", tmp_path / "wall.obj", tmp_path / "out.toml", "--unit", "m", "--up", "z")
    result = drystone(*words)
    assert result.exit_code == 2
    assert "one lies within the other: take it out" in result.stderr
    assert "--overlap" not in result.stderr


def test_a_control_point_beside_all_blocks_is_refused(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    document.header["$INSUNITS"] = 6  # m
    space = document.modelspace()
    for name, low in (("support", -0.5), ("stone", 0.0)):
        corners = [(0.0, low), (0.5, low), (0.5, low + 0.5), (0.0, low + 0.5)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": name})
    space.add_point((0.8, 0.5), dxfattribs={"layer": "control"})
    document.saveas(tmp_path / "wall.dxf")
    result = drystone("convert", tmp_path / "wall.dxf", tmp_path / "out.toml")
    assert result.exit_code == 2 and not (tmp_path / "out.toml").exists()
    assert "is nearest, 300 mm away" in result.stderr


def test_overlapping_solids_are_drawn_too(tmp_path):
    solids = [("a", *box((0, 0, 0), (1, 1, 1))), ("b", *box((0.9, 0, 0), (2, 1, 1)))]
    (tmp_path / "wall.obj").write_text(obj_text(solids))
    out = tmp_path / "out.toml"
    result = drystone("convert", tmp_path / "wall.obj", out, "--unit", "m", "--up", "z")
    assert result.exit_code == 2 and not out.exists()
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")


BAR = """
[[tie]]
name = "a"
from = {{ point = [{0}, {1}] }}
to = {{ block = "ground", point = [-1.0, 0.3] }}
stiffness = 1e6
yield_force = 1e4
compression = false
"""
FORCE = '\n[[dead_load]]\nkind = "force"\nmass = false\npoint = [{0}, {1}]\nforce = [0.0, -10.0]\n'


def test_ties_and_forces_find_the_block_that_holds_their_point(tmp_path):
    drawing(tmp_path)
    text = HEAD + ALL + IMPORT + BAR.format(0.2, 0.3) + FORCE.format(0.7, 0.4)
    model = ds.read_model(model_file(tmp_path, text))
    assert model.ties[0].start.block == "stone/3"
    (load,) = model.dead_loads
    assert load.block == "stone/4"
    at = load.forces(model.assembly)
    assert np.flatnonzero(at.force.any(axis=1)).tolist() == [3]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (BAR.format(0.1, 0.5), 'tie "a".from: no block holds the point (0.1, 0.5)'),
        (BAR.format(0.4, 0.1), 'tie "a".from: 2 blocks hold the point (0.4, 0.1): name one'),
        (FORCE.format(0.4, 0.2), "dead_load[1]: 3 blocks hold the point (0.4, 0.2)"),
        (FORCE.format(0.4, -0.1), 'nearest is "stone/1", 100 mm away'),
    ],
)
def test_points_that_none_or_several_hold_are_told(tmp_path, more, said):
    drawing(tmp_path)
    with pytest.raises(ModelError) as error:
        ds.read_model(model_file(tmp_path, HEAD + ALL + IMPORT + more))
    assert any(said in problem for problem in error.value.problems), error.value.problems


def test_a_pattern_of_forces_finds_its_blocks(tmp_path):
    drawing(tmp_path)
    forces = '[load]\npattern = "forces"\n[[load.force]]\npoint = [0.3, 0.4]\nforce = [1.0, 0.0]\n'
    text = HEAD + ALL.split("[load]")[0] + IMPORT + forces
    assert ds.read_model(model_file(tmp_path, text)).load.entries[0].block == "stone/3"


def test_what_a_drawing_left_out_is_told_where_nothing_is_left_to_move(tmp_path):
    import ezdxf

    path = drawing(tmp_path)
    document = ezdxf.readfile(path)
    document.layers.add("stone").off()
    document.saveas(path)
    model = model_file(tmp_path, HEAD + ALL + IMPORT)
    for file in (path, model):
        for command in ("check", "limit")[: 1 + (file is model)]:
            said = drystone(command, file).stderr
            assert "nothing can move" in said, (command, file)
            assert '4 left out: LWPOLYLINE on layer "stone", which is switched off' in said
