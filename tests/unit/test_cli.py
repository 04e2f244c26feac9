"""The command line, with a made-up analysis in place of the engines."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import types
import warnings
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
import typer
from typer.testing import CliRunner

import drystone as drystone_package
from drystone.analysis.benchmark import benchmark
from drystone.cli import app
from drystone.cli.outcome import outcome
from drystone.common.progress import progress_for
from drystone.common.progress.forecast import Forecast
from drystone.common.progress.points import Bar, Lines, clock_time
from drystone.engines.base import EngineError, UnstableError
from drystone.io.results.folder import FolderLock
from drystone.model.construction.errors import ModelError
from drystone.report.folder.benchmark import recorded_curves
from drystone.report.folder.directory import ResultsDirectory
from drystone.report.folder.results import load_results

#: Modules that take long to load, which help and version must not wait for.
HEAVY = ("numpy", "scipy", "numba", "h5py", "matplotlib", "rich.progress")
#: Where the package is, for Python started without its site.
SOURCE = str(Path(drystone_package.__file__).parents[1])


@pytest.fixture
def analysis(monkeypatch):
    """Sets what stands in for the pushover analysis."""

    def use(function):
        module = types.SimpleNamespace(pushover=function)
        monkeypatch.setitem(sys.modules, "drystone.analysis.driver", module)

    use(synthetic.pushover)
    return use


@pytest.fixture
def reads(monkeypatch):
    """Sets what stands in for the reader of model files."""

    def use(function):
        monkeypatch.setattr("drystone.io.modelfile.read_model", function)

    use(lambda path, **_: synthetic.wall_model(source=str(path)))
    return use


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def drystone(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def failing(error):
    def function(*_, **__):
        raise error

    return function


# run


def test_run_writes_the_folder_and_says_the_peak(here, analysis, reads):
    result = drystone("run", "wall.toml")
    assert result.exit_code == 0
    assert "0.5000 at 0.00200 m" in result.stdout and "wall-results/" in result.stdout
    assert (here / "wall-results/summary.json").is_file()
    assert result.stderr == ""  # too short for a line of progress


def test_run_as_json_prints_the_summary_and_nothing_else(here, analysis, reads):
    result = drystone("run", "wall.toml", "--json", "--quiet", "--out", "deep/er")
    printed = json.loads(result.stdout)
    written = json.loads((here / "deep/er/summary.json").read_text())
    assert printed == {**written, "directory": "deep/er"}


def test_run_hands_its_options_on(here, analysis, reads):
    given = {}

    def pushover(model, **options):
        given.update(options)
        return synthetic.pushover(model, **options)

    analysis(pushover)
    arguments = ("--engine", "distinct", "--strategy", "published", "--mechanism-at", "0.1")
    assert drystone("run", "wall.toml", *arguments).exit_code == 0
    assert (given["engine"], given["strategy"]) == ("distinct", "published")
    assert json.loads((here / "wall-results/summary.json").read_text())["engine"] == "distinct"

    drystone("run", "wall.toml")
    assert given["engine"] is None and given["strategy"] is None  # what the model says


@pytest.mark.parametrize(
    "arguments",
    [
        ("run",),
        ("run", "a.toml", "b.toml"),
        ("run", "a.toml", "--strategy", "brute"),
        ("run", "a.toml", "--mechanism-at", "-1"),
        ("run", "a.toml", "--mechanism-at", "nan"),
        ("benchmark", "--wall", "4"),
        ("benchmark", "--reference", "nowhere"),
        ("benchmark", "laboratory", "--engine", "nscd"),
        ("benchmark", "laboratory", "--strategy", "published"),
        ("fly",),
    ],
)
def test_a_wrong_command_line_exits_with_2(here, arguments):
    result = drystone(*arguments)
    assert result.exit_code == 2 and result.stderr and not result.stdout
    assert list(here.iterdir()) == []


@pytest.mark.parametrize(
    "error",
    [
        EngineError("there is no engine fast: take nscd"),
        UnstableError("block b1 falls"),
        OSError(13, "Permission denied", "wall.toml"),
    ],
)
@pytest.mark.parametrize("as_json", [False, True])
def test_an_analysis_that_cannot_begin_exits_with_2(here, analysis, reads, error, as_json):
    analysis(failing(error))
    result = drystone("run", "wall.toml", *(["--json"] if as_json else []))
    sentence = str(error) if isinstance(error, EngineError) else "wall.toml: Permission denied"
    assert result.exit_code == 2
    assert result.stderr == f"drystone: {sentence}\n"
    assert list(here.iterdir()) == []
    if as_json:
        assert json.loads(result.stdout)["problems"] == [sentence]
    else:
        assert result.stdout == ""


def test_a_wrong_model_exits_with_2_and_every_sentence(here, analysis, reads):
    reads(failing(ModelError(["wall.toml: joint: one", "wall.toml: load: two"])))
    result = drystone("run", "wall.toml")
    assert result.exit_code == 2
    assert result.stderr.splitlines() == [
        "drystone: wall.toml: joint: one",
        "drystone: wall.toml: load: two",
    ]


def test_a_folder_that_cannot_be_written_exits_with_2_before_the_analysis(here, analysis, reads):
    analysis(failing(AssertionError("the analysis ran")))
    (here / "file").write_text("")
    result = drystone("run", "wall.toml", "--out", "file")
    assert result.exit_code == 2 and "file is a file" in result.stderr


@pytest.mark.parametrize("name", ["summary.json", "curve.csv", "results.h5"])
def test_a_model_inside_the_folder_of_results_is_not_overwritten(here, analysis, reads, name):
    analysis(failing(AssertionError("the analysis ran")))
    (here / "out").mkdir()
    model = here / "out" / name
    model.write_text("a model")
    (here / "link.toml").symlink_to(model)
    for given in (f"out/{name}", "link.toml"):
        result = drystone("run", given, "--out", "out")
        assert result.exit_code == 2 and "the model file itself" in result.stderr
    assert model.read_text() == "a model"


def test_converting_a_file_into_itself_is_refused(here, reads):
    (here / "model.py").write_text("a model")
    for target in ("model.py", "./model.py"):
        result = drystone("convert", "model.py", target)
        assert result.exit_code == 2 and "the model file itself" in result.stderr
    assert (here / "model.py").read_text() == "a model"


def test_limit_does_not_overwrite_its_model(here, reads):
    (here / "out").mkdir()
    (here / "out/limit.json").write_text("a model")
    result = drystone("limit", "out/limit.json", "--out", "out")
    assert result.exit_code == 2 and "the model file itself" in result.stderr
    assert (here / "out/limit.json").read_text() == "a model"


def test_a_second_run_into_one_folder_exits_with_2(here, analysis, reads):
    (here / "out").mkdir()
    analysis(failing(AssertionError("the analysis ran")))
    lock = FolderLock(here / "out")
    result = drystone("run", "wall.toml", "--out", "out")
    assert result.exit_code == 2 and "another run is writing its results into out" in result.stderr
    lock.release()


def test_a_full_disk_exits_with_3_and_keeps_the_curve(here, analysis, reads, monkeypatch):
    """The recorder fails after some points: all files have those of them that are on the disk, and
    the summary says why."""
    from drystone.io.results.results_writer import ResultsWriter

    append = ResultsWriter.append

    def full(self, point, pose, contacts, ties=None):
        if point.step == 10:
            self.whole = False
            raise OSError(28, "No space left on device")
        append(self, point, pose, contacts, ties)

    monkeypatch.setattr(ResultsWriter, "append", full)
    analysis(synthetic.pushover)
    result = drystone("run", "wall.toml", "--json")
    assert result.exit_code == 3 and "No space left on device" in result.stderr
    assert json.loads(result.stdout)["status"] == "stopped"
    kept = load_results(here / "wall-results").curve
    assert 0 < len(kept.points) <= 10
    assert len((here / "wall-results/curve.csv").read_text().splitlines()) == 1 + len(kept.points)
    assert f"of 10 points results.h5 took the first {len(kept.points)}" in kept.reason
    assert kept.status == "stopped" and kept.reason == json.loads(result.stdout)["reason"]
    for command in ("report", "view"):
        told = drystone(command, "wall-results")
        assert "the curve is not whole: " in told.stderr and "No space left" in told.stderr


def test_a_disk_too_full_for_the_first_point_is_left_as_it_was(here, analysis, reads, monkeypatch):
    """`results.h5` was left without a point, and report and viewer made pages of it."""
    from drystone.io.results.diskfile import DiskFile

    commit, done = DiskFile.commit, []

    def full(self):
        done.append(self)
        if len(done) > 1:  # the layout fits, the first chunks do not
            raise OSError(28, "No space left on device")
        commit(self)

    monkeypatch.setattr(DiskFile, "commit", full)
    analysis(synthetic.pushover)
    result = drystone("run", "wall.toml")
    assert result.exit_code != 0 and "nothing was written" in result.stderr
    assert "No space left on device" in result.stderr
    assert list(here.iterdir()) == []


def test_files_of_results_that_disagree_say_so(here, analysis, reads):
    analysis(synthetic.pushover)
    drystone("run", "wall.toml")
    folder = here / "wall-results"
    with h5py.File(folder / "results.h5", "r+") as file:
        file.attrs["status"] = "running"  # the disk was full as it ended
    assert load_results(folder).curve.status == "finished"
    text = (folder / "summary.json").read_text()
    n = json.loads(text)["n_points"]
    (folder / "summary.json").write_text(text.replace(f'"n_points": {n}', f'"n_points": {n + 9}'))
    assert f"has {n} points, and summary.json is of {n + 9}" in load_results(folder).curve.reason
    assert "trace it again" in drystone("view", "wall-results").stderr


def test_an_analysis_that_stops_exits_with_3_and_keeps_what_it_has(here, analysis, reads):
    analysis(lambda model, **options: synthetic.pushover(model, status="stopped", **options))
    result = drystone("run", "wall.toml", "--json")
    assert result.exit_code == 3 and "drystone: stopped: Made up." in result.stderr
    assert json.loads(result.stdout)["status"] == "stopped"
    assert (here / "wall-results/curve.png").is_file()


def test_an_error_on_the_way_exits_with_3(here, analysis, reads):
    def breaks(model, **options):
        synthetic.pushover(model, **options)
        raise EngineError("the solver died")

    analysis(breaks)
    result = drystone("run", "wall.toml")
    assert result.exit_code == 3 and result.stderr == "drystone: the solver died\n"


def test_a_fault_of_the_program_is_not_hidden(here, analysis, reads):
    analysis(failing(ZeroDivisionError()))
    assert isinstance(drystone("run", "wall.toml").exception, ZeroDivisionError)


def test_interruption_before_the_first_point_leaves_nothing(here, analysis, reads):
    for function in (
        failing(KeyboardInterrupt()),
        lambda model, **_: replace(synthetic.curve(status="interrupted"), points=()),
    ):
        analysis(function)
        result = drystone("run", "wall.toml")
        assert result.exit_code == 130 and "nothing was written" in result.stderr
        assert list(here.iterdir()) == []


@pytest.mark.parametrize("writes", [True, False])
def test_interrupted_directions_say_whether_any_is_kept(here, reads, monkeypatch, writes):
    """Also where a run before has left its table."""
    table = here / "wall-results" / "directions.csv"
    table.parent.mkdir()
    table.write_text("of before")

    def traces(model, number, folder, asked, **options):
        if writes:
            (folder / table.name).unlink()
            (folder / table.name).write_text("of now")
        raise KeyboardInterrupt

    monkeypatch.setattr("drystone.cli.run.run_directions", traces)
    result = drystone("run", "wall.toml", "--directions", "both")
    assert result.exit_code == 130
    assert ("what was reached is kept" in result.stderr) == writes
    assert ("nothing was written" in result.stderr) != writes


def test_control_c_leaves_a_valid_folder(tmp_path):
    """In a process of its own, by the signal that the keys send."""
    code = (
        "import signal, sys, time, types, synthetic\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "def pushover(model, *, progress, **options):\n"
        "    def slowly(point):\n"
        "        progress(point)\n"
        "        if point.step == 20: open(sys.argv[1] + '/ready', 'w').close()\n"
        "        time.sleep(0.0 if point.step < 20 else 0.1)\n"
        "    return synthetic.pushover(model, progress=slowly, **options)\n"
        "sys.modules['drystone.analysis.driver'] = types.SimpleNamespace(pushover=pushover)\n"
        "import drystone.io.modelfile as m; m.read_model = lambda p, **_: synthetic.wall_model()\n"
        "from drystone.cli import app\n"
        "app(['run', 'wall.toml', '--json', '--out', sys.argv[1] + '/out'])\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=synthetic.environment(),
    ) as child:
        deadline = time.monotonic() + 60
        while not (tmp_path / "ready").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=60)
    assert child.returncode == 130, err.decode()
    assert json.loads(out)["status"] == "interrupted"
    assert 20 <= json.loads(out)["n_steps"] < 59
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        *("summary.json", "curve.csv", "curve.png", "mechanism.png", "results.h5", "paraview")
    }
    assert b"Traceback" not in err


def test_nothing_is_loaded_before_control_c_is_seen_to():
    """Each millisecond before is one in which Python answers it, with a traceback."""
    code = (
        "import sys; before = set(sys.modules); import drystone.cli\n"
        "print(sorted(set(sys.modules) - before))"
    )
    ended = subprocess.run(
        [sys.executable, "-I", "-S", "-c", f"import sys; sys.path.insert(0, {SOURCE!r}); {code}"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert ended.stdout.strip() == "['drystone', 'drystone.cli']", ended.stderr


@pytest.mark.parametrize("milliseconds", [0, 5, 20, 40, 60, 100, 300, 600])
def test_control_c_while_the_program_is_loaded(tmp_path, milliseconds):
    """Without a traceback, whatever module is being loaded when it comes."""
    code = (
        "import os, signal, sys, threading, time\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "after = float(sys.argv.pop()) / 1e3\n"
        "def press():\n"
        "    time.sleep(after)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "class Finder:  # the first that is loaded of others\n"
        "    def find_spec(name, *_):\n"
        "        if name == 'typer': threading.Thread(target=press).start()\n"
        "sys.meta_path.insert(0, Finder)\n"
        "from drystone.cli import main\n"
        "main()\n"
    )
    (tmp_path / "wall.toml").write_text("[wall]\nnumber = 1\n")
    ended = subprocess.run(
        [sys.executable, "-c", code, "check", "wall.toml", str(milliseconds)],
        capture_output=True,
        cwd=tmp_path,
        env=synthetic.environment(),
        timeout=60,
    )
    said = ended.stderr.decode()
    if milliseconds >= 300 and said.startswith("drystone: wall") and "Traceback" not in said:
        # It had said what is wrong: it had ended by itself, or was about to.
        assert ended.returncode in (2, -signal.SIGINT, 130)
        return
    assert said in ("", "drystone: interrupted: nothing was written\n")
    assert ended.returncode in (-signal.SIGINT, 130)


def test_control_c_while_a_module_is_loaded_waits_for_it(tmp_path, monkeypatch, capsys):
    """A module may swallow an interrupt, make another error of it, or print a traceback."""
    (tmp_path / "swallows.py").write_text(
        "import os, signal, time\n"
        "try:\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    time.sleep(0.1)\n"
        "    complete = True\n"
        "except KeyboardInterrupt:\n"
        "    raise ImportError('this module cannot be loaded')\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    reached = []
    with pytest.raises(typer.Exit) as ended, outcome(as_json=False):
        import swallows

        reached.append(swallows.complete)
        time.sleep(10.0)
    assert (reached, ended.value.exit_code) == ([True], 130)
    assert capsys.readouterr().err == "drystone: interrupted: nothing was written\n"


ODD_TITLES = ["$a_$", "costs $5 and $x_2$", "a\0b \x1b[31mred\x07", "\u5899 \\$", "x" * 5000]


@pytest.mark.parametrize("title", ODD_TITLES)
def test_any_title_is_drawn_and_printed_as_it_stands(here, analysis, reads, title):
    """It is no formula, and does not steer the terminal; missing letters are no warning."""
    reads(lambda path, **_: replace(synthetic.wall_model(), title=title))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = drystone("run", "wall.toml")
    assert result.exit_code == 0, result.exception
    files = {"summary.json", "curve.csv", "curve.png", "mechanism.png", "results.h5"}
    assert files <= {path.name for path in (here / "wall-results").iterdir()}
    assert all(c.isprintable() for c in result.stdout.replace("\n", ""))
    assert json.loads((here / "wall-results/summary.json").read_text())["title"] == title


def test_odd_names_do_not_steer_the_terminal(here, analysis, reads):
    analysis(failing(EngineError("block \x1b[2Jb1 falls")))
    assert drystone("run", "wall.toml").stderr == "drystone: block \\x1b[2Jb1 falls\n"


def test_odd_block_names_are_kept(tmp_path):
    model = synthetic.wall_model()
    blocks = [replace(block, id=f"$_{i}\0\x1b$") for i, block in enumerate(model.assembly.blocks)]
    model = replace(model, assembly=replace(model.assembly, blocks=tuple(blocks)))
    synthetic.record(ResultsDirectory(tmp_path / "out"), model, synthetic.curve())
    assert (tmp_path / "out/mechanism.png").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="no such signal")
def test_sigterm_ends_like_control_c(tmp_path):
    """The curve is kept, and no second signal stops its writing."""
    code = (
        "import os, signal, sys, types, synthetic\n"
        "def pushover(model, *, progress, **options):\n"
        "    def end(point):\n"
        "        if point.step == 20: os.kill(os.getpid(), signal.SIGTERM)\n"
        "    curve = synthetic.pushover(model, progress=end, **options)\n"
        "    os.kill(os.getpid(), signal.SIGTERM)\n"
        "    return curve\n"
        "sys.modules['drystone.analysis.driver'] = types.SimpleNamespace(pushover=pushover)\n"
        "import drystone.io.modelfile as m; m.read_model = lambda p, **_: synthetic.wall_model()\n"
        "from drystone.cli import app\n"
        "app(['run', 'wall.toml', '--json', '--out', sys.argv[1]])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "out")],
        capture_output=True,
        env=synthetic.environment(),
    )
    assert done.returncode == 130, done.stderr.decode()
    assert json.loads(done.stdout)["status"] == "interrupted"
    assert len((tmp_path / "out/curve.csv").read_text().splitlines()) == 1 + 21


def test_kernels_without_a_writable_home(tmp_path):
    """Neither the package's folder nor home takes compiled kernels: a temporary folder does.

    A file in the way stops whoever runs this, root included.
    """
    package = Path(drystone_package.__file__).parent
    copy = tmp_path / "drystone"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "law/__pycache__").write_text("")
    (tmp_path / "tmp").mkdir()
    home = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null/cache"}
    environment = {
        **os.environ,
        **home,
        "PYTHONPATH": str(tmp_path),
        "TMPDIR": str(tmp_path / "tmp"),
    }
    environment.pop("NUMBA_CACHE_DIR", None)
    code = (
        "import sys; sys.dont_write_bytecode = True\n"
        "from drystone.cli.outcome import outcome\n"
        "with outcome(as_json=False):\n"
        "    from drystone.law import residual\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("compiled kernels are kept in") == 1
    (folder,) = (tmp_path / "tmp").iterdir()
    assert str(folder) in done.stderr and not folder.stat().st_mode & 0o077


# check


def test_check_counts(here, reads):
    result = drystone("check", "wall.toml", "--json")
    found = json.loads(result.stdout)
    assert result.exit_code == 0 and found["problems"] == []
    # Twelve blocks; 3 pairs with the base, 5 between two courses, 2 in each course.
    assert (found["n_blocks"], found["n_supports"], found["n_joints"]) == (12, 1, 3 + 15 + 8)
    assert found["n_contacts"] == 2 * found["n_joints"]
    assert found["weight"] == pytest.approx(1.0 * 0.7 * 10e3)  # 1 m x 0.7 m x 1 m of 10 kN/m3
    text = drystone("check", "wall.toml").stdout
    assert "7 kN" in text and "A made-up wall" in text


def test_check_lists_what_is_wrong(here, reads):
    problems = [f"wall.toml: block {i}: wrong" for i in range(30)]
    reads(failing(ModelError(problems)))
    result = drystone("check", "wall.toml", "--json")
    found = json.loads(result.stdout)
    assert result.exit_code == 2 and found["problems"] == problems
    assert found["n_blocks"] is None and found["weight"] is None
    assert len(result.stderr.splitlines()) == 21 and "and 10 more" in result.stderr


def test_check_of_a_file_that_is_not_there(here):
    result = drystone("check", "nowhere.toml")
    assert result.exit_code == 2 and "nowhere.toml" in result.stderr


# benchmark


def test_benchmark_sets_ours_beside_the_published(here, analysis):
    result = drystone("benchmark", "--engine", "nscd", "--engine", "distinct", "--out", "b")
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    assert len(lines) == 2 + 6 + 2 + 1  # heads, rows, note, folder
    first = lines[2].split()
    # Table 1 of the paper, and what synthetic.pushover has.
    assert first[:5] == ["1", "0.643", "0.579", "0.574", "+0.86"]
    # Limit analysis of the rounded wall is that of tests/validation/test_limit_published.py.
    assert first[5:12] == ["nscd", "0.599", "0.586", "0.500", "0.00", "0.449", "0.392"]
    names = {path.name for path in (here / "b").iterdir()}
    assert {"benchmark.json", "benchmark.csv", "wall1.png", "wall2.png", "wall3.png"} <= names
    assert (here / "b/wall2-distinct/curve.csv").is_file()


def test_benchmark_as_json(here, analysis):
    result = drystone("benchmark", "--wall", "3", "--json", "--quiet")
    (row,) = json.loads(result.stdout)["rows"]
    assert "spread" not in drystone("benchmark", "--wall", "3").stdout  # nor in the legend
    assert row["wall"] == 3 and row["spread"] is None and row["n_blocks"] == 46
    assert row["ultimate_displacement_lmgc90"] == 0.591


def test_benchmark_goes_on_without_an_engine_that_fails(here, analysis):
    def some(model, *, engine, **options):
        if engine == "lmgc90":
            raise EngineError("lmgc90 is not installed")
        return synthetic.pushover(model, engine=engine, **options)

    analysis(some)
    result = drystone("benchmark", "--wall", 1, "--engine", "lmgc90", "--engine", "nscd")
    assert result.exit_code == 3
    assert result.stderr == "drystone: wall 1, lmgc90: lmgc90 is not installed\n"
    assert "0.500" in result.stdout

    result = drystone("benchmark", "--wall", 1, "--engine", "lmgc90", "--out", "none")
    assert result.exit_code == 2 and not (here / "none").exists()


def test_benchmark_interrupted_keeps_what_it_has(here, analysis):
    analysis(lambda model, **options: synthetic.pushover(model, status="interrupted", **options))
    result = drystone("benchmark", "--json")
    assert result.exit_code == 130
    assert len(json.loads(result.stdout)["rows"]) == 1


def test_spread_of_engines(analysis):
    def scaled(model, *, engine, **options):
        curve = synthetic.pushover(model, engine=engine, **options)
        factor = {"a": 0.98, "b": 1.02}[engine]
        points = [replace(p, load_multiplier=p.load_multiplier * factor) for p in curve.points]
        return replace(curve, points=tuple(points))

    analysis(scaled)
    rows = benchmark(walls=[1], engines=["a", "b"]).rows
    assert [row.spread for row in rows] == [pytest.approx(4.0)] * 2  # (1.02 - 0.98) / 1


def test_recorded_curves(here, analysis):
    (here / "wall1_udec.csv").write_text(
        "control_displacement_m,applied_multiplier,carried_multiplier\n0,0,0\n0.1,0.4,0.3\n"
    )
    (here / "wall2_udec.csv").write_text("x,y\n0,0\n")
    ((label, x, y),) = recorded_curves(here, 1)
    assert label == "UDEC, recorded (carried)"
    np.testing.assert_array_equal((x, y), ([0.0, 0.1], [0.0, 0.3]))
    assert drystone("benchmark", "--wall", 1, "--reference", here).exit_code == 0
    result = drystone("benchmark", "--wall", 2, "--reference", here)
    assert result.exit_code == 2 and "wall2_udec.csv is not a recorded curve" in result.stderr


# progress


def test_forecast_of_a_straight_descent():
    now = 0.0
    forecast = Forecast(0.01, clock=lambda: now)
    for step, multiplier in enumerate([0.0, 0.3, 0.51]):
        forecast.update(synthetic.point(step, 0.001 * step, multiplier))
        assert forecast.seconds_left is None  # the peak is not known yet
    now = 2.0
    forecast.update(synthetic.point(3, 0.1, 0.41))  # a fifth of the way from 0.51 to 0.01 in 2 s
    assert forecast.share == pytest.approx(0.2)
    assert forecast.seconds_left == pytest.approx(8.0)
    forecast.update(synthetic.point(4, 0.1, 0.45))  # a local rise does not go back
    assert forecast.share == pytest.approx(0.2)
    now = 10.0
    forecast.update(synthetic.point(5, 0.4, 0.005))
    assert forecast.seconds_left == 0.0


def test_lines_come_now_and_then(monkeypatch, capsys):
    now = 0.0
    monkeypatch.setattr("drystone.common.progress.points.time.monotonic", lambda: now)
    progress = progress_for("wall", 0.01, quiet=False)
    assert isinstance(progress, Lines)  # what pytest captures is no terminal
    for p in synthetic.points():
        now += 1.0
        progress(p)
    captured = capsys.readouterr()
    assert captured.out == "" and len(captured.err.splitlines()) == 6  # 60 points, one a second
    assert "10 points" in captured.err.splitlines()[0]
    assert "left" in captured.err.splitlines()[-1]


def test_bar_stays_on_standard_error(monkeypatch, capsys):
    with Bar("wall", Forecast(0.01)) as progress:
        for p in synthetic.points():
            progress(p)
    assert capsys.readouterr().out == ""


def test_quiet_shows_nothing(capsys):
    with progress_for("wall", 0.01, quiet=True) as progress:
        progress(synthetic.point(0, 0.0, 0.0))
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(("seconds", "text"), [(5, "0:05"), (3599.6, "1:00:00"), (61, "1:01")])
def test_clock_time(seconds, text):
    assert clock_time(seconds) == text


# start


def test_help_and_version_load_nothing_heavy():
    code = (
        "import sys\nfrom drystone.cli import app\n"
        "try: app(sys.argv[1:])\nexcept SystemExit as end: assert not end.code\n"
        f"loaded = [name for name in {HEAVY!r} if name in sys.modules]; assert not loaded, loaded\n"
    )
    for arguments in (["--help"], ["run", "--help"], ["benchmark", "--help"], ["--version"]):
        assert synthetic.python(code, *arguments).stdout


def test_help_loads_nothing_that_only_an_analysis_needs():
    """That is what makes it answer at once."""
    heavy = "numba", "scipy", "matplotlib", "h5py", "pandas"
    code = f"""
import sys
from drystone.cli import app
from drystone.cli.outcome import outcome
try:
    app(['--help'])
except SystemExit:
    pass
print([name for name in {heavy} if name in sys.modules], file=sys.stderr)
"""
    assert synthetic.python(code).stderr.strip() == "[]"


def test_help_names_every_command():
    result = drystone("--help")
    assert result.exit_code == 0
    for command in ("run", "check", "benchmark"):
        assert f"  {command} " in result.stdout


def test_published_error_is_the_paper_s(analysis):
    rows = benchmark(engines=["nscd"]).rows
    # Table 1 of the paper, two digits.
    assert [round(row.published_error, 2) for row in rows] == [0.86, 2.93, 2.42]
