"""Engines of other packages, found by their entry points."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from builders import stack
from drystone.analysis.driver import pushover
from drystone.cli import app
from drystone.common import registry
from drystone.engines import ENGINES, engine_names, make_engine
from drystone.engines.base import EngineError
from drystone.io.modelfile import write_model
from drystone.model.model import Analysis

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "own_engine.py"

#: Classes that are no engines, by what is said of them.
WRONG = """
from drystone.engines.base import Capabilities, Engine

class Unrelated:
    name, prescribes_displacement = "unrelated", False

class Half(Engine):
    name = "half"
    def start(self, problem): ...
    def contacts(self, state): ...

class Nameless(Engine):
    def start(self, problem): ...
    def step(self, state, demand): ...
    def contacts(self, state): ...
"""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """The example as an installed package would be: a module, and a line of metadata."""
    site = tmp_path / "site"
    site.mkdir()
    shutil.copy(EXAMPLE, site / "rocking_program.py")
    info = site / "rocking_program-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: rocking-program\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        f"[{ENGINES.group}]\nrocking = rocking_program:RockingEngine\n"
        "torn = rocking_program:NoSuchEngine\nnscd = rocking_program:RockingEngine\n"
        "unrelated = wrong_engines:Unrelated\nhalf = wrong_engines:Half\n"
        "nameless = wrong_engines:Nameless\nold = old_engine:Old\n"
    )
    (site / "wrong_engines.py").write_text(WRONG)
    (site / "old_engine.py").write_text(
        "from drystone.engines.base import Engine\n"
        "class Old(Engine):\n    prescribes_displacement = True\n"
    )
    monkeypatch.syspath_prepend(str(site))
    return site


def test_an_engine_is_found_by_its_entry_point(installed):
    assert {"rocking", "torn"} <= set(engine_names())
    assert make_engine("rocking").name == "rocking"


def test_a_name_of_ours_stays_ours(installed):
    assert make_engine("nscd").name == "nscd"


def test_an_engine_that_cannot_be_loaded_is_told(installed):
    with pytest.raises(EngineError, match=r'"torn".*NoSuchEngine'):
        make_engine("torn")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("unrelated", r"wrong_engines\.Unrelated is no engine: .*derive.*base\.Engine"),
        ("half", r'"half" \(wrong_engines:Half\) cannot be made: .*abstract.*step'),
        ("nameless", r"wrong_engines\.Nameless: the engine has no name"),
        ("old", r'"old".*Old\.prescribes_displacement: say it in .*capabilities'),
    ],
)
def test_what_an_engine_misses_is_told(installed, name, told):
    with pytest.raises(EngineError, match=told):
        make_engine(name)


def test_what_is_no_engine_is_told_before_it_runs():
    with pytest.raises(EngineError, match=r"object is no engine"):
        pushover(stack((0.4, 1.2)), engine=object())


def test_an_unknown_name_lists_the_known_ones(installed):
    with pytest.raises(EngineError, match=r"equilibrium.*lmgc90.*rocking"):
        make_engine("rockin")


def test_an_engine_of_ours_that_is_not_installed_names_the_command(monkeypatch, tmp_path):
    monkeypatch.setattr(registry, "outside", lambda group: {})
    assert "lmgc90" in engine_names()
    write_model(stack((0.4, 1.2)), tmp_path / "block.toml")
    run = CliRunner().invoke(
        app,
        ["run", str(tmp_path / "block.toml"), "--engine", "lmgc90", "--out", str(tmp_path / "out")],
    )
    assert run.exit_code == 2, run.output
    assert run.stderr == (
        'drystone: the engine "lmgc90" is a package of its own and is not installed: '
        "pip install ./plugins/drystone-lmgc90, in the folder of drystone's source\n"
    )
    assert not (tmp_path / "out").exists()


def test_the_command_line_and_model_files_take_it(installed, tmp_path):
    model = stack((0.4, 1.2), analysis=Analysis(engine="rocking"))
    write_model(model, tmp_path / "block.toml")
    run = CliRunner().invoke(
        app, ["run", str(tmp_path / "block.toml"), "--out", str(tmp_path / "out"), "--json"]
    )
    assert run.exit_code == 0, run.output
    summary = json.loads(run.stdout)
    assert summary["engine"] == "rocking"
    assert "the toe is a hinge" in summary["reason"]
    assert summary["peak_multiplier"] == pytest.approx(0.4 / 1.2, rel=0.01)
    for command in ("check", "limit"):
        done = CliRunner().invoke(app, [command, str(tmp_path / "block.toml")])
        assert done.exit_code == 0, done.output


def test_limit_analysis_asks_for_no_engine(tmp_path):
    # A model from a machine where the engine's package is installed.
    model = stack((0.4, 1.2), analysis=Analysis(engine="elsewhere"))
    write_model(model, tmp_path / "block.toml")
    done = CliRunner().invoke(app, ["limit", str(tmp_path / "block.toml")])
    assert done.exit_code == 0, done.output
