"""Runs that stopped go on: the curve is that of a run that never did, to the last bit."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import synthetic
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from drystone.common.codec import CodecError, Derived, Packed, packed, unpacked
from drystone.engines.base import EngineError
from drystone.io.results import diskfile, journal
from drystone.io.results.checkpoint import CHECKPOINT
from drystone.io.results.diskfile import DiskFile
from drystone.io.results.folder import FolderLock, OutputError
from drystone.report.folder import directory

EXAMPLES = Path(__file__).parents[2] / "examples"
AT_A_SITE = EXAMPLES / "wall_at_a_site.toml"


def same(first: ds.CapacityCurve, second: ds.CapacityCurve) -> bool:
    """Whether two curves agree to the last bit, nan with nan."""
    return (
        repr(first.points) == repr(second.points)
        and first.events == second.events
        and first.blocks_left == second.blocks_left
        and (first.status, first.reason) == (second.status, second.reason)
    )


def test_a_folder_that_is_not_there_is_named():
    with pytest.raises(OutputError, match="there is no folder nowhere"):
        ds.resume("nowhere")


# Records as trees and arrays.


class Colour(Enum):
    RED = 1


@dataclass(frozen=True)
class Remembered:
    number: float
    rows: np.ndarray
    also: np.ndarray
    inner: tuple[object, ...]


class Known(Derived):
    pass


def test_what_a_control_remembers_comes_back_without_a_line_of_its_own():
    rows = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    inner = (np.int64(3), None, {"a": [1, True]}, frozenset({2}), Colour.RED, ())
    value = Remembered(-0.0, rows, rows, (float("nan"), float("-inf"), 0.1 + 0.2, *inner))
    parts = packed(value)
    parts = Packed(json.loads(json.dumps(parts.tree)), parts.arrays)
    back = unpacked(parts, packages={__name__.partition(".")[0]})
    assert repr(back) == repr(value)
    assert back.rows is back.also  # one object stays one
    assert back.rows.flags.f_contiguous and type(back.inner[3]) is np.int64


def test_what_follows_from_the_problem_is_not_kept():
    known = Known()
    parts = packed((known, known))
    assert unpacked(parts, derived=[known]) == (known, known)
    with pytest.raises(CodecError, match="damaged"):
        unpacked(parts)


@pytest.mark.parametrize(
    "tree",
    [
        {"record": "os:system", "fields": {}},
        {"record": "subprocess:Popen", "fields": {}},
        {"record": "drystone.__main__:Anything", "fields": {}},
        {"record": "drystone.common.workers:_Worker", "fields": {}},
        {"record": "drystone.engines.base:Demand", "fields": {"multiplier": 1.0}},
        {"record": "drystone.engines.base:Demand.__init__", "fields": {}},
        {"enum": "drystone.engines.base:Demand", "member": "x"},
        {"array": 7},
        {"same": 0},
        [1],
        {},
    ],
)
def test_a_tree_that_is_none_of_ours_is_refused(tree):
    with pytest.raises(CodecError):
        unpacked(Packed(tree, []))


def test_what_cannot_be_kept_is_told_with_its_place():
    with pytest.raises(CodecError, match=r"it\.inner\[0\] is of builtins:function"):
        packed(Remembered(0.0, np.zeros(1), np.zeros(1), (len.__class__, lambda: 0)[1:]))


# Runs.

SHORT = {
    ("two_blocks.toml", "equilibrium"): {},
    ("two_blocks.toml", "nscd"): {"max_steps": 30},
    ("two_blocks.toml", "distinct"): {"max_steps": 6},
    ("solids.toml", "equilibrium"): {"max_steps": 25},
    ("solids.toml", "nscd"): {"max_steps": 25},
    ("solids.toml", "distinct"): {"max_steps": 4},
}


@pytest.mark.usefixtures("often", "bare")
@pytest.mark.parametrize(("name", "engine"), list(SHORT))
def test_paused_again_and_again_the_curve_is_the_same(tmp_path, name, engine):
    model = ds.read_model(EXAMPLES / name).with_analysis(**SHORT[name, engine])
    whole = ds.pushover(model, engine=engine, recorder=ds.ResultsDirectory(tmp_path / "whole"))
    n = max(len(whole.points) // 4, 1)
    pausing, recorder = model.with_analysis(max_points=n), ds.ResultsDirectory(tmp_path / "out")
    parts = ds.pushover(pausing, engine=engine, recorder=recorder)
    assert parts.status == "stopped" and len(parts.points) == n
    for _ in range(6):
        if not parts.reason.startswith("paused"):
            break
        parts = ds.resume(tmp_path / "out")
    assert same(parts, whole)
    stored, kept = ds.load_results(tmp_path / "whole"), ds.load_results(tmp_path / "out")
    assert same(kept.curve, stored.curve)
    assert np.array_equal(kept.poses, stored.poses)
    for a, b in zip(kept.contacts, stored.contacts, strict=True):
        assert np.array_equal(a.normal_reaction, b.normal_reaction)
        assert np.array_equal(a.gap, b.gap)


@pytest.mark.usefixtures("often", "bare")
def test_points_after_the_last_checkpoint_are_computed_again(tmp_path, monkeypatch):
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    whole = ds.pushover(model)
    taken = []

    def some(self, make, *, last=False):
        if not last and len(taken) < 10:  # then none, as of a process that is killed
            taken.append(make())
            self._put(self._writer, taken[-1])

    with monkeypatch.context() as patch:
        patch.setattr(ds.ResultsDirectory, "keep", some)
        ds.pushover(model, recorder=ds.ResultsDirectory(tmp_path / "out"))
    (tmp_path / "out/summary.json").unlink()
    assert (
        taken[-1].n_points
        < len(whole.points)
        == len(ds.load_results(tmp_path / "out").curve.points)
    )
    assert same(ds.resume(tmp_path / "out"), whole)


def test_a_complete_curve_goes_on_to_another_end(tmp_path):
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    far = ds.pushover(model.with_analysis(max_displacement=0.05))
    near = ds.pushover(
        model.with_analysis(max_displacement=0.02), recorder=ds.ResultsDirectory(tmp_path / "out")
    )
    assert near.status == "finished"
    assert len(ds.resume(tmp_path / "out").points) == len(near.points)  # nothing is left to do
    assert same(ds.resume(tmp_path / "out", max_displacement=0.05), far)
    with pytest.raises(EngineError, match='"friction" is no end'):
        ds.resume(tmp_path / "out", friction=0.3)
    with pytest.raises(EngineError, match="m already: take more"):
        ds.resume(tmp_path / "out", max_displacement=0.01)
    with pytest.raises(EngineError, match="already: take less"):
        ds.resume(tmp_path / "out", stop_multiplier=0.1)


SINKS = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e9
shear_stiffness = 1e9
[[block]]
id = "left"
vertices = [[-1.0, -0.3], [0.4, -0.3], [0.4, 0.0], [-1.0, 0.0]]
support = true
[[block]]
id = "right"
vertices = [[0.6, -0.3], [2.0, -0.3], [2.0, 0.0], [0.6, 0.0]]
support = true
[[block]]
id = "lintel"
vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.2], [0.0, 0.2]]
[settlement]
blocks = ["right"]
direction = [0.0, -1.0]
max = MAX
"""


def test_supports_go_farther(tmp_path):
    """The curve goes on beyond where they were to stop, and ends where one that went there does."""

    def going(largest: float) -> ds.Model:
        path = tmp_path / "model.toml"
        path.write_text(SINKS.replace("MAX", str(largest)))
        return ds.read_model(path)

    far = ds.pushover(going(0.02))
    near = ds.pushover(going(0.01), recorder=ds.ResultsDirectory(tmp_path / "out"))
    extended = ds.resume(tmp_path / "out", settlement=0.02)
    assert near.status == extended.status == far.status == "finished"
    assert len(near.points) < len(extended.points)
    assert extended.control_displacement[-1] == pytest.approx(far.control_displacement[-1])
    assert extended.reaction[-1] == pytest.approx(far.reaction[-1], rel=1e-6)
    again = ds.resume(tmp_path / "out", settlement=0.02)  # a command repeated after a kill
    assert same(again, extended)
    for amount, said in ((0.01, "goes to 0.02 m already"), (-0.01, "must be")):
        with pytest.raises(EngineError, match=said):
            ds.resume(tmp_path / "out", settlement=amount)


def test_supports_that_do_not_move_go_no_farther(tmp_path):
    paused(tmp_path / "out")
    with pytest.raises(EngineError, match="do not move"):
        ds.resume(tmp_path / "out", settlement=0.01)


def test_states_are_kept_every_few_seconds_however_short_steps_are(tmp_path, monkeypatch):
    """On a clock by which a step takes one second, and a state no time."""
    kept: list[float] = []
    clock = [0.0]

    class Watched(ds.ResultsDirectory):
        def keep(self, make, *, last=False):
            clock[0] += 1.0

            def made():
                kept.append(clock[0])
                return make()

            super().keep(made, last=last)

    monkeypatch.setattr(directory.time, "monotonic", lambda: clock[0])
    model = ds.read_model(EXAMPLES / "two_blocks.toml").with_analysis(max_points=40)
    ds.pushover(model, engine="equilibrium", recorder=Watched(tmp_path), progress=False)
    assert kept[0] == directory.SECONDS
    assert np.diff(kept[:-1]) == pytest.approx(directory.SECONDS)  # the last one is at the end
    assert clock[0] - kept[-2] < directory.SECONDS
    assert len(kept) > 3


def test_max_time_pauses(tmp_path):
    model = ds.read_model(EXAMPLES / "two_blocks.toml").with_analysis(max_time=1e-3)
    curve = ds.pushover(model, recorder=ds.ResultsDirectory(tmp_path / "out"))
    assert curve.status == "stopped" and "max_time" in curve.reason
    whole = ds.pushover(model.with_analysis(max_time=None))
    assert same(ds.resume(tmp_path / "out", max_time=None), whole)


# Folders from which no run can go on.


def paused(folder: Path, **options: float) -> ds.CapacityCurve:
    """A run of two blocks that has paused after five points."""
    model = ds.read_model(EXAMPLES / "two_blocks.toml").with_analysis(max_points=5, **options)
    return ds.pushover(model, recorder=ds.ResultsDirectory(folder))


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def refused(folder: Path, *arguments: str) -> str:
    """The sentence with which a run that goes on is refused; nothing in its folder has changed."""
    before = contents(folder)
    told = CliRunner().invoke(app, ["run", "--resume", str(folder), *arguments])
    assert told.exit_code == 2 and "Traceback" not in told.output
    assert contents(folder) == before
    return told.output


def test_one_run_at_a_time_goes_on(tmp_path):
    paused(tmp_path / "out")
    lock = FolderLock(tmp_path / "out")
    try:
        assert "another run is writing" in refused(tmp_path / "out")
    finally:
        lock.release()
    assert CliRunner().invoke(app, ["run", "--resume", str(tmp_path / "out"), "-q"]).exit_code == 3


def test_nothing_kept_damaged_or_of_another_run(tmp_path):
    assert "there is nothing to go on with" in refused(tmp_path)
    folder = tmp_path / "out"
    paused(folder)
    content = (folder / CHECKPOINT).read_bytes()
    middle = len(content) // 2
    (folder / CHECKPOINT).write_bytes(content[:middle] + bytes(64) + content[middle + 64 :])
    assert "is damaged" in refused(folder)
    (folder / CHECKPOINT).write_bytes(content[:middle])
    assert "is damaged" in refused(folder)
    other = EXAMPLES / "wall1.toml"
    (folder / CHECKPOINT).write_bytes(content)
    told = CliRunner().invoke(app, ["run", str(other), "--resume", str(folder)])
    assert told.exit_code == 2 and "or is another model" in told.output
    (folder / CHECKPOINT).unlink()  # killed before it kept any: it begins anew
    assert len(ds.resume(folder, max_points=None).points) > 5


def test_a_state_of_sources_with_other_fields_is_refused(tmp_path):
    """Sources between two releases have one version; the run ended in a traceback."""
    folder = tmp_path / "out"
    paused(folder)
    with np.load(folder / CHECKPOINT) as file:
        entries = dict(file)
    told = json.loads(entries["standing"].tobytes())
    memory = told["tree"]["fields"]["memory"]
    assert memory["fields"].pop("displacement") is not None
    entries["standing"] = np.frombuffer(json.dumps(told).encode(), np.uint8)
    with (folder / CHECKPOINT).open("wb") as file:
        np.savez(file, **entries)
    said = " ".join(refused(folder).split())
    assert "another version has written its state" in said and "run the model again" in said
    with pytest.raises(OutputError, match="DisplacementState has other fields"):
        ds.resume(folder)


def test_an_engine_that_keeps_no_states_says_so(tmp_path, monkeypatch):
    from dataclasses import replace

    from drystone.statics.equilibrium import EquilibriumEngine

    can = replace(EquilibriumEngine.capabilities, resumes=False)
    monkeypatch.setattr(EquilibriumEngine, "capabilities", can)
    paused(tmp_path / "out")
    assert not (tmp_path / "out" / CHECKPOINT).exists()
    assert "stores no states" in refused(tmp_path / "out")


def test_a_file_that_is_removed_while_it_runs(tmp_path):
    """The folder is removed meanwhile: an end with its reason, and what was reached."""

    def remove(point):
        if point.step == 3:
            shutil.rmtree(tmp_path / "out")

    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    with pytest.raises(OutputError, match="was removed"):
        ds.pushover(model, recorder=ds.ResultsDirectory(tmp_path / "out"), progress=remove)


# Commands on the folder of a run that was killed.


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """The folder of a wall whose run ended by a kill."""
    folder = tmp_path_factory.mktemp("killed") / "out"
    code = (
        "import os, sys, drystone as ds\n"
        "from drystone.io.results import results_writer as writer\n"
        "from drystone.report.folder import directory\n"
        "writer.SECONDS = writer.TIMES = directory.SECONDS = 0.0\n"
        "def seen(point):\n    if point.step == 60: os.kill(os.getpid(), 9)\n"
        "ds.pushover(ds.read_model(sys.argv[1]), recorder=ds.ResultsDirectory(sys.argv[2]), "
        "progress=seen)\n"
    )
    model = EXAMPLES / "wall_at_a_site.toml"
    done = subprocess.run(
        [sys.executable, "-c", code, str(model), str(folder)], env=synthetic.environment()
    )
    assert done.returncode == -signal.SIGKILL
    return folder


@pytest.mark.parametrize("command", ["report", "view", "compare"])
def test_commands_read_the_folder_of_a_killed_run(killed, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where `compare` writes its picture
    told = CliRunner().invoke(app, [command, str(killed)])
    assert told.exit_code == 0, told.output


def test_the_other_files_of_a_killed_run_are_written(killed, tmp_path):
    """Those of a run that stopped at the same point; another can still go on."""
    pages = shutil.ignore_patterns("*.html")  # of other tests
    folder = shutil.copytree(killed, tmp_path / "out", ignore=pages)
    assert not (folder / "curve.csv").exists()
    told = CliRunner().invoke(app, ["report", str(folder), "--files"])
    assert told.exit_code == 0, told.output
    n = len(ds.load_results(folder).curve.points)
    stopped = tmp_path / "stopped"
    model = ds.read_model(EXAMPLES / "wall_at_a_site.toml").with_analysis(max_points=n)
    ds.pushover(model, recorder=ds.ResultsDirectory(stopped))

    def names(path):
        return {str(file.relative_to(path)) for file in path.rglob("*") if file.is_file()}

    assert names(folder) == names(stopped) | {"report.html"}
    assert (folder / "curve.csv").read_bytes() == (stopped / "curve.csv").read_bytes()
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == "stopped" and "killed" in summary["reason"]
    assert summary["n_points"] == n and summary["associative_multiplier"] > 0.0
    assert ds.resume(folder, max_points=1).status == "stopped"


def test_the_other_files_of_a_run_that_goes_on_are_not_written(killed):
    lock = FolderLock(killed)
    try:
        told = CliRunner().invoke(app, ["report", str(killed), "--files"])
    finally:
        lock.release()
    assert told.exit_code == 2 and "another run is writing" in told.output
    assert not (killed / "curve.csv").exists()


def test_an_assessment_of_a_killed_run_says_what_it_lacks(killed):
    told = CliRunner().invoke(app, ["assess", str(killed)])
    assert told.exit_code == 3 and "the curve does not come down to it" in told.output
    assert "was killed" in told.output


@pytest.fixture(scope="module")
def assessed(tmp_path_factory):
    """What an assessment of both senses says that nothing stopped."""
    out = str(tmp_path_factory.mktemp("assessed") / "w")
    told = CliRunner().invoke(app, ["assess", str(AT_A_SITE), "--out", out, "--json"])
    assert told.exit_code == 0
    return json.loads(told.stdout)


@pytest.mark.usefixtures("bare")
@pytest.mark.parametrize("stopped", [None, "out", "out/opposite"])
def test_an_assessment_of_both_senses_goes_on(tmp_path, monkeypatch, assessed, stopped):
    """Whichever sense was stopped; none is traced again that is complete."""
    model, out = AT_A_SITE, tmp_path / "out"
    folder = tmp_path / (stopped or "")
    begin = ds.ResultsDirectory.begin

    def stops(self, *about):
        begin(self, *about)
        if self.path == folder:
            self.point = partial(interrupts, self.point)

    def interrupts(take, point, *state):
        if point.step == 20:
            raise KeyboardInterrupt
        take(point, *state)

    ask = ["assess", str(model), "--out", str(out), "--json"]
    with monkeypatch.context() as patch:
        patch.setattr(ds.ResultsDirectory, "begin", stops)
        first = CliRunner().invoke(app, ask)
    assert first.exit_code == (130 if stopped else 0)
    complete = [path for path in out.rglob("results.h5") if path.parent != folder]
    written = {path: path.stat().st_mtime_ns for path in complete}
    again = CliRunner().invoke(app, [*ask, "--resume"])
    assert again.exit_code == 0, again.output
    assert {path: path.stat().st_mtime_ns for path in complete} == written
    known, found = assessed, json.loads(again.stdout)
    for key in ("safety_index", "governing_sense", "activation_multiplier", "limit_states"):
        assert known[key] == found[key]
    text = model.read_text().replace("friction_coefficient = ", "friction_coefficient = 0.9 #")
    (tmp_path / "other.toml").write_text(text)
    ask[1] = str(tmp_path / "other.toml")
    other = CliRunner().invoke(app, [*ask, "--resume"])
    assert other.exit_code == 2 and "the run of another model" in other.output


# The journal.


def test_a_file_is_readable_wherever_its_writer_is_killed(tmp_path, monkeypatch):
    """Every write of a commit fails once: what is on the disk is the state before or after."""
    path = tmp_path / "file"
    monkeypatch.setattr(diskfile, "YOUNG", 0.0)

    def states(count: int) -> tuple[bytes, bytes]:
        before, after = b"a" * 100, b"b" * 40 + b"a" * 60 + b"c" * 50
        path.unlink(missing_ok=True)
        file = DiskFile(path)
        file.write(before)
        file.commit()
        file.seek(0)
        file.write(b"b" * 40)
        file.seek(100)
        file.write(b"c" * 50)
        calls = iter(range(1000))

        def dies(*arguments):
            if next(calls) == count:
                raise KeyboardInterrupt  # as if the process ended here
            return sync(*arguments)

        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", dies)
            with suppress(KeyboardInterrupt):
                file.commit()
        file.close()
        return before, after

    sync, seen = os.fsync, set()
    for count in range(5):
        before, after = states(count)
        found = journal.pending(path)
        if found is None:
            read = path.read_bytes()
        else:
            read = journal.overlaid(path, *found).read()
        assert read in (after, before, before + b"c" * 50)  # nobody reads what is behind the end
        journal.recover(path)
        assert path.read_bytes() == read and not journal.journal_of(path).exists()
        seen.add(read)
    assert len(seen) > 1


def test_a_journal_that_is_cut_is_none(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"a" * 10)
    whole = journal.written(path, 10, [(2, b"bb")]).read_bytes()
    assert journal.pending(path) == (10, [(2, b"bb")])
    for length in range(len(whole)):
        journal.journal_of(path).write_bytes(whole[:length])
        assert journal.pending(path) is None


# Killed at any moment, for each engine.


#: There and back [m].
HISTORY = {"history": [0.002, -0.002, 0.0]}
#: Of every engine one that is always killed: plane and space, pushed and cyclic.
ALWAYS = {
    ("two_blocks.toml", "equilibrium", True),
    ("solids.toml", "nscd", False),
    ("solids.toml", "distinct", False),
}
KILLED = [
    pytest.param(
        *(name, engine, HISTORY if cyclic else SHORT[name, engine]),
        marks=[pytest.mark.slow, *[pytest.mark.gate] * ((name, engine, cyclic) in ALWAYS)],
        id=f"{name}-{engine}" + "-cyclic" * cyclic,
    )
    for name, engine in SHORT
    for cyclic in (False, True)
] + [
    pytest.param(
        *("two_blocks.toml", "equilibrium", {"directions": 2}),
        marks=pytest.mark.slow,
        id="directions",
    )
]


@pytest.mark.parametrize(("name", "engine", "options"), KILLED)
def test_killed_at_random_moments(tmp_path, name, engine, options):
    """The file opens, and what goes on ends as if it had never stopped; see killed.py."""
    import killed as kills

    found = kills.killed_at_random(
        EXAMPLES / name, engine, options, tmp_path, kills=6, seed=1, seconds=30.0
    )
    assert found["unread"] == found["different"] == found["failed"] == 0
    assert found["kills"] > 0 and found["ended"] > 0
