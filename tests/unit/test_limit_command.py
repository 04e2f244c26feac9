"""``drystone limit`` and what ``run`` says beside its curve."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from drystone.limit import Beside, NonAssociativeSettings, collapse_load, limits_beside
from drystone.model.builders import ModelError, circular_arch, stack

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
#: Least keys of the object that is printed.
KEYS = {"flow", "collapse_multiplier", "collapse_range", "status", "reason"}

MODEL = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 10e3
[joint]
friction_coefficient = 0.65
[[block]]
id = "base"
vertices = [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
support = true
[[block]]
id = "b1"
vertices = [[-0.2, 0.0], [0.2, 0.0], [{top}, 0.9], [{left}, 0.9]]
[load]
pattern = "mass"
direction = [1.0, 0.0]
"""


def drystone(*arguments):
    return CliRunner().invoke(app, ["limit", *map(str, arguments)])


@pytest.fixture
def upright(tmp_path):
    path = tmp_path / "upright.toml"
    path.write_text(MODEL.format(top=0.2, left=-0.2))
    return path


@pytest.fixture
def leaning(tmp_path):
    path = tmp_path / "leaning.toml"
    path.write_text(MODEL.format(top=1.0, left=0.6))
    return path


def test_both_flows_are_printed(upright):
    result = drystone(upright)
    assert result.exit_code == 0 and result.stderr == ""
    lines = [line for line in result.stdout.splitlines() if "0.44444" in line]
    assert [line.split()[0] for line in lines] == ["associative", "non-associative"]


def test_no_multiplier_is_minus_zero(upright):
    """Without friction the block slides under no load; rounding leaves about -1e-17."""
    upright.write_text(upright.read_text().replace("0.65", "0.0"))
    result = drystone(upright)
    assert result.exit_code == 0
    found = [line for line in result.stdout.splitlines() if "associative" in line]
    assert all(" 0.00000" in line and "-0.0" not in line for line in found)


@pytest.mark.parametrize("flow", [None, "associative", "non-associative"])
def test_json_has_the_promised_keys(upright, flow):
    result = drystone(upright, "--json", *(["--flow", flow] if flow else []))
    found = json.loads(result.stdout)
    assert set(found) >= KEYS and found["flow"] == (flow or "non-associative")
    assert found["collapse_multiplier"] == pytest.approx(0.4 / 0.9, abs=1e-9)
    assert len(found["flows"]) == (1 if flow else 2) and set(found["flows"][0]) >= KEYS


def test_pictures_of_the_mechanism(upright, tmp_path):
    result = drystone(upright, "--out", tmp_path / "deep/er")
    assert result.exit_code == 0
    names = {path.name for path in (tmp_path / "deep/er").iterdir()}
    pictures = {"mechanism.png", "mechanism-associative.png", "mechanism-non-associative.png"}
    assert names == {"limit.json", *pictures}


def test_what_does_not_stand_is_the_models_fault(leaning, tmp_path):
    result = drystone(leaning, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert str(leaning) in result.stderr and '"b1"' in result.stderr
    found = json.loads(result.stdout)
    assert found["status"] == "unstable" and found["collapse_multiplier"] is None
    assert (tmp_path / "out/mechanism.png").is_file()  # how it falls


def test_supports_that_move_are_the_models_fault_too(tmp_path):
    """Said once, as `assess` says it, and before anything is written."""
    path = tmp_path / "sinks.toml"
    sinks = '[settlement]\nblocks = ["base"]\ndirection = [0.0, -1.0]\nmax = 0.01\n'
    path.write_text(MODEL[: MODEL.index("[load]")].format(top=0.2, left=-0.2) + sinks)
    result = drystone(path, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 2 and set(json.loads(result.stdout)) >= KEYS
    assert drystone(path).output.count("give a [load]") == 1
    assert not (tmp_path / "out").exists()


def test_a_faulty_file_is_told_as_json_too(tmp_path):
    path = tmp_path / "faulty.toml"
    path.write_text("dimension = 2")
    result = drystone(path, "--json")
    assert result.exit_code == 2 and set(json.loads(result.stdout)) >= KEYS


@pytest.mark.parametrize(
    "arguments", [("--flow", "sideways"), ("--paths", "0"), ("--beta", "0"), ("--alpha", "1")]
)
def test_a_wrong_option_exits_with_2(upright, arguments):
    assert drystone(upright, *arguments).exit_code == 2


def test_python_name():
    model = ds.read_model(EXAMPLES / "wall1.toml")
    found = ds.collapse_load(model, flow="non-associative")
    assert found.load_multiplier == pytest.approx(0.5856, rel=2e-3)
    with pytest.raises(ValueError, match="there is no flow"):
        ds.collapse_load(model, flow="sideways")


def test_results_are_the_same_every_time():
    model = ds.read_model(EXAMPLES / "wall1.toml")
    one, two = (collapse_load(model) for _ in range(2))
    assert one.load_multiplier == two.load_multiplier and one.collapse_range == two.collapse_range
    np.testing.assert_array_equal(one.velocities, two.velocities)


def test_mechanism_is_scaled_to_its_fastest_vertex():
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    found = collapse_load(model)
    i = model.assembly.index("b1")
    arm = model.assembly.blocks[i].vertices - model.assembly.centroid[i]
    u, v, turn = found.velocities[i]
    speed = np.hypot(u - turn * arm[:, 1], v + turn * arm[:, 0])
    assert speed.max() == pytest.approx(1.0)
    assert found.moving == ("b1",) and turn < 0.0


def test_beside_a_curve():
    beside = limits_beside(ds.published_wall(1))
    assert beside.associative == pytest.approx(0.59946, abs=1e-5)
    assert beside.non_associative == pytest.approx(0.58558, abs=1e-5)
    assert beside.note == "" and len(beside.limits) == 2


def test_a_peak_above_the_bound_is_told():
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    curve = ds.pushover(model, max_steps=10)
    peak = curve.capacity.load_multiplier
    assert Beside().warning(curve, model) is None
    assert Beside(associative=peak * (1.0 - 0.9e-4)).warning(curve, model) is None
    told = Beside(associative=peak * (1.0 - 1.1e-4)).warning(curve, model)
    assert "lies above the associative collapse multiplier" in told


@pytest.mark.parametrize(
    "values", [{"alpha": 1.0}, {"beta": 0.0}, {"tolerance": 0.0}, {"n_paths": 0}]
)
def test_settings_are_checked(values):
    with pytest.raises(ValueError, match=next(iter(values))):
        NonAssociativeSettings(**values)


@pytest.mark.parametrize(
    "values",
    [{"thickness": 0.0}, {"thickness": 30.0}, {"embrace": 200.0}, {"n_voussoirs": 0}],
)
def test_impossible_arches_are_refused(values):
    sizes = {"radius": 10.0, "thickness": 1.0, "embrace": 180.0, "n_voussoirs": 9, **values}
    with pytest.raises(ModelError, match=next(iter(values))):
        circular_arch(unit_weight=1e4, **sizes)


def test_impossible_stacks_are_refused():
    with pytest.raises(ModelError, match="one of each"):
        stack(widths=[1.0], heights=[1.0, 2.0], unit_weight=1e4)
    with pytest.raises(ModelError, match="greater than 0"):
        stack(widths=[1.0], heights=[0.0], unit_weight=1e4)


@pytest.mark.parametrize("wall", [1, 3])
def test_the_picture_does_not_tear_what_moves_as_one_body(wall, tmp_path, monkeypatch):
    """Corners that two blocks share as designed, and that move alike, are drawn as one point."""
    from drystone.report import canvas
    from drystone.report.folder.limit import write_collapse

    drawn = []

    def save(figure, path, *_):
        drawn.append(figure)
        path.touch()

    monkeypatch.setattr(canvas, "save", save)
    model = ds.published_wall(wall)
    found = collapse_load(model)
    write_collapse([found], model, tmp_path)
    (axes,) = drawn[0].axes
    (moving,) = (c for c in axes.collections if c.get_label() == "moving")
    rows = [model.assembly.index(name) for name in found.moving]
    shapes = [path.vertices for path in moving.get_paths()]
    assert len(shapes) == len(rows)
    points = []
    for i, shape in zip(rows, shapes, strict=True):
        designed = model.assembly.blocks[i].vertices
        u, v, turn = found.velocities[i]
        arm = designed - model.assembly.centroid[i]
        velocity = np.column_stack((u - turn * arm[:, 1], v + turn * arm[:, 0]))
        points.append((np.hstack((designed, velocity)), shape[: len(designed)]))
    shared = 0
    for k, (key_a, shape_a) in enumerate(points):
        for key_b, shape_b in points[k + 1 :]:
            # The linear program is solved to 1e-10.
            same = np.abs(key_a[:, None] - key_b[None]).max(axis=2) < 1e-8
            for i, j in zip(*np.nonzero(same), strict=True):
                shared += 1
                np.testing.assert_allclose(shape_a[i], shape_b[j], atol=1e-8)
    assert shared >= 8  # wall 1: of twelve blocks few move alike
