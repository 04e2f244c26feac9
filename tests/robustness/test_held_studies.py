"""Study files name a model and a function of their own folder alone, unless the command does."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drystone.cli import app
from drystone.studies.conduct import conduct, extremes_of
from drystone.studies.errors import StudyError
from drystone.studies.read import read_study

EXAMPLES = Path(__file__).parents[2] / "examples"
FRICTION = """
design = "grid"
[[parameter]]
path = "joint.friction_coefficient"
values = [0.5, 0.6]
"""
VALUE = """
design = "grid"
[[parameter]]
path = "a"
values = [1.0, 2.0]
"""


@pytest.fixture
def theirs(tmp_path):
    folder = tmp_path / "theirs"
    folder.mkdir()
    return folder


def drystone(*arguments: object) -> tuple[int, str]:
    told = CliRunner().invoke(app, [*map(str, arguments), "--quiet"])
    assert told.exception is None or isinstance(told.exception, SystemExit), told.output
    return told.exit_code, told.output


@pytest.mark.parametrize("link", [False, True])
def test_a_model_elsewhere_is_for_the_command_to_name(theirs, tmp_path, link):
    mine = tmp_path / "mine.toml"
    shutil.copy(EXAMPLES / "two_blocks.toml", mine)
    name = "../mine.toml"
    if link:
        (theirs / "link.toml").symlink_to(mine)
        name = "link.toml"
    study = theirs / "study.toml"
    study.write_text(f'model = "{name}"\n' + FRICTION)
    with pytest.raises(StudyError, match="outside of the study file's folder"):
        read_study(study)
    code, said = drystone("study", study, "--out", tmp_path / "out")
    assert code == 2 and "--model FILE" in said and not (tmp_path / "out").exists()
    assert read_study(study, model=mine).task.model["title"] == "Two blocks"


def test_a_function_elsewhere_is_for_the_command_to_name(theirs, tmp_path, monkeypatch):
    study = theirs / "study.toml"
    study.write_text('function = "os:system"\n' + VALUE)
    with pytest.raises(StudyError, match="in the study file"):
        read_study(study)
    (theirs / "os.py").write_text("def system(x):\n    return {'y': 2.0 * x['a']}\n")
    own = conduct(read_study(study), tmp_path / "own", workers=1)
    assert own.failed == 0  # their file, not Python's module of that name
    (tmp_path / "of_mine.py").write_text("def f(x):\n    return {'y': x['a']}\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=":")
    code, said = drystone("study", study, "--function", "of_mine:f", "--out", tmp_path / "out")
    assert code == 0, said


def test_extremes_come_from_what_the_folder_holds(tmp_path):
    """Neither the study file nor its model is read again."""
    folder = tmp_path / "study"
    folder.mkdir()
    model = (EXAMPLES / "two_blocks.toml").read_text()
    (folder / "history.txt").write_text("0.001\n-0.001\n0\n")
    assert "[control]" in model
    (folder / "model.toml").write_text(
        model.replace("[control]", '[control]\nhistory = "history.txt"')
    )
    study, out = folder / "study.toml", tmp_path / "out"
    study.write_text('model = "model.toml"\n' + FRICTION)
    code, said = drystone("study", study, "--out", out, "--workers", 1)
    assert code == 0, said
    shutil.rmtree(folder)
    assert json.loads((out / "study.json").read_text())["files"].keys() == {"history.txt"}
    extremes = extremes_of(out)
    assert len(extremes) == 2 and all((own / "results.h5").is_file() for own in extremes)
