"""Folders in which another model was traced or assessed before: nothing of that one is taken."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drystone.cli import app
from drystone.io.results.own_files import clear

#: A wall 4 m high; ``LEAN`` [m] towards -x makes it weak that way.
MODEL = """
title = "A wall that leans by LEAN m"
dimension = 2
thickness = 1.0
[material.m]
unit_weight = 20e3
[joint]
friction_coefficient = 0.8
normal_stiffness = 1e11
shear_stiffness = 1e11
[[block]]
id = "base"
vertices = [[-1, -0.3], [2, -0.3], [2, 0], [-1, 0]]
support = true
[[block]]
id = "wall"
vertices = [[0, 0], [0.8, 0], [0.8, 4], [0, 4]]
[load]
pattern = "mass"
direction = [1.0, 0.0]
[site]
code = "ntc2018"
ag = 0.20
F0 = 2.45
TC_star = 0.32
soil = "B"
topography = "T1"
[assessment]
method = "ntc2018-local"
confidence_factor = 1.35
"""


def drystone(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments), "--quiet"])


@pytest.fixture(scope="module")
def models(tmp_path_factory) -> Path:
    """Two model files, and the folder in which the straight wall was assessed."""
    folder = tmp_path_factory.mktemp("stale")
    straight = MODEL.replace("LEAN", "0")
    leaning = MODEL.replace("LEAN", "0.25").replace("[0.8, 4], [0, 4]", "[0.55, 4], [-0.25, 4]")
    (folder / "straight.toml").write_text(straight)
    (folder / "leaning.toml").write_text(leaning)
    result = drystone("assess", folder / "straight.toml", "--out", folder / "straight")
    assert result.exit_code == 0, result.output
    return folder


@pytest.fixture
def before(models, tmp_path) -> Path:
    """A folder of results of the straight wall, assessed and reported."""
    shutil.copytree(models / "straight", tmp_path / "out")
    assert drystone("report", tmp_path / "out").exit_code == 0
    return tmp_path / "out"


def test_a_run_removes_what_it_will_not_write(models, before):
    """The other sense, assessment and report of the model before, but no file of someone else."""
    (before / "opposite" / "notes.txt").write_text("mine")
    (before / "view.html").write_text("<html>mine</html>")
    assert drystone("run", models / "leaning.toml", "--out", before).exit_code == 0
    assert not (before / "opposite" / "results.h5").exists()
    assert not (before / "report.html").exists() and not (before / "assessment.json").exists()
    assert (before / "opposite" / "notes.txt").read_text() == "mine"
    assert (before / "view.html").read_text() == "<html>mine</html>"
    (before / "opposite" / "notes.txt").unlink()
    assert drystone("run", models / "leaning.toml", "--out", before).exit_code == 0
    verdict = drystone("assess", before)
    assert verdict.exit_code == 0, verdict.output
    assert "only one, along the load: the other was not traced" in verdict.output
    assert "note: Only one sense of the load was traced, along the load" in verdict.output


def test_the_other_sense_of_another_model_is_refused(models, before, tmp_path):
    assert drystone("run", models / "leaning.toml", "--out", tmp_path / "new").exit_code == 0
    shutil.copytree(before / "opposite", tmp_path / "new" / "opposite")
    for command in ("assess", "report"):
        result = drystone(command, tmp_path / "new")
        assert result.exit_code == 2
        assert "opposite/results.h5 belongs to another model" in " ".join(result.output.split())


def test_the_other_sense_of_the_same_model_is_taken(before):
    result = drystone("assess", before)
    assert result.exit_code == 0 and "against the load" in result.output


def test_an_assessment_of_another_model_is_refused(models, before, tmp_path):
    assert drystone("run", models / "leaning.toml", "--out", tmp_path / "new").exit_code == 0
    shutil.copy(before / "assessment.json", tmp_path / "new")
    for command in ("report", "view"):
        result = drystone(command, tmp_path / "new")
        assert result.exit_code == 2
        assert "assessment.json belongs to another model" in " ".join(result.output.split())


def test_directions_of_before_go(models, tmp_path):
    out = tmp_path / "out"
    assert (
        drystone("run", models / "leaning.toml", "--directions", "both", "--out", out).exit_code
        == 0
    )
    assert (out / "direction-180" / "results.h5").is_file()
    assert drystone("run", models / "straight.toml", "--out", out).exit_code == 0
    assert not list(out.glob("direction*")) and (out / "results.h5").is_file()


def test_links_are_not_followed(tmp_path):
    """A link in place of a folder of ours leads to what may be anyone's."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "results.h5").write_text("mine")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "opposite").symlink_to(tmp_path / "elsewhere")
    clear(tmp_path / "out")
    assert (tmp_path / "elsewhere" / "results.h5").read_text() == "mine"
