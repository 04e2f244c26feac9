"""Several directions in a folder that holds results: these stay until the first new point."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from drystone.io.results.checkpoint import read_plan
from drystone.io.results.folder import FolderLock
from drystone.report.folder.taking_over import CLAIM, TakingOver

EXAMPLES = Path(__file__).parents[2] / "examples"
MODEL = EXAMPLES / "two_blocks.toml"


def drystone(*arguments: object) -> tuple[int, str]:
    """Exit status of a command, and what it says."""
    told = CliRunner().invoke(app, [*map(str, arguments), "--quiet"])
    assert told.exception is None or isinstance(told.exception, SystemExit), told.output
    return told.exit_code, " ".join(told.output.split())


def contents(folder: Path) -> dict[Path, bytes | None]:
    """What is in a folder, and which folders."""
    paths = sorted(folder.rglob("*"))
    return {path: path.read_bytes() if path.is_file() else None for path in paths}


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """The results of a run, and those of both senses; nothing stopped either."""
    folder = tmp_path_factory.mktemp("made")
    assert drystone("run", MODEL, "--out", folder / "one")[0] == 0
    assert drystone("run", MODEL, "--out", folder / "both", "--directions", "both")[0] == 0
    return folder


@pytest.fixture(params=["one", "both"])
def earlier(request, made, tmp_path) -> Path:
    """A folder with earlier results of either kind."""
    shutil.copytree(made / request.param, tmp_path / "out")
    return tmp_path / "out"


def falling(folder: Path) -> Path:
    """A model that does not stand: its block leans beyond its base."""
    text = MODEL.read_text().replace("[0.2, 0.9], [-0.2, 0.9]", "[1.2, 0.9], [0.8, 0.9]")
    path = folder / "falling.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("number", "more"),
    [
        ("3", ()),  # of the plane, which has two
        ("both", ("--engine", "none-such")),
    ],
)
def test_what_is_refused_leaves_earlier_results(earlier, number, more):
    before = contents(earlier)
    code, said = drystone("run", MODEL, "--out", earlier, "--directions", number, *more)
    assert code == 2, said
    assert contents(earlier) == before


def test_what_does_not_stand_leaves_earlier_results(earlier, tmp_path):
    before = contents(earlier)
    code, said = drystone("run", falling(tmp_path), "--out", earlier, "--directions", "both")
    assert code == 2 and "nothing was written" in said
    assert contents(earlier) == before
    assert drystone("run", falling(tmp_path), "--out", tmp_path / "n", "--directions", "both")[0]
    assert not (tmp_path / "n").exists()


def test_what_runs_takes_the_place_of_earlier_results(earlier, made):
    (earlier / "mine.txt").write_text("mine")
    (earlier / "direction-090").mkdir()
    (earlier / "direction-090" / "results.h5").write_text("of four directions before")
    assert drystone("run", MODEL, "--out", earlier, "--directions", "both")[0] == 0
    assert (earlier / "mine.txt").read_text() == "mine"
    names = {path.relative_to(earlier) for path in earlier.rglob("*")} - {Path("mine.txt")}
    assert names == {path.relative_to(made / "both") for path in (made / "both").rglob("*")}


def test_a_direction_that_another_run_writes_in(made, tmp_path):
    """Nothing is touched, whether several directions or one run would take its place."""
    folder = tmp_path / "out"
    shutil.copytree(made / "both", folder)
    before, lock = contents(folder), FolderLock(folder / "direction-180")
    try:
        for more in (("--directions", "both"), ()):
            code, said = drystone("run", MODEL, "--out", folder, *more)
            assert code in (2, 3) and "another run is writing" in said, said
            assert contents(folder) == before
    finally:
        lock.release()


def test_a_direction_that_was_killed_as_it_took_over_holds_no_other_up(tmp_path):
    model = ds.read_model(MODEL)
    takes_over = TakingOver.of(tmp_path, model, {"number": 2, "asked": []}, ["0", "180"])
    (tmp_path / CLAIM).mkdir()  # what is left of it: its lock went with the process
    takes_over()
    assert read_plan(tmp_path)[1]["run"] == takes_over.plan["run"]
