"""The first run: the notice, the time apart, the process that helps."""

import gc
import json
import os
import subprocess
import sys

import pytest
import synthetic
from numba import njit
from typer.testing import CliRunner

import drystone as ds
from builders import stack
from drystone.cli import app, compiler
from drystone.cli.outcome import tell
from drystone.common.importing import importing


@pytest.fixture(autouse=True)
def told(monkeypatch, untold):
    """Unlike in other tests."""
    monkeypatch.setattr(compiler, "tell", tell)


@pytest.fixture
def slow_to_compile(monkeypatch):
    """An engine that compiles something as it starts, as on a machine's first run."""
    from drystone.statics.equilibrium import EquilibriumEngine

    start = EquilibriumEngine.start

    def compiling(self, problem):
        @njit
        def inner(x):
            return x + 1

        @njit
        def outer(x):
            return 2 * inner(x)

        assert outer(1) == 4
        return start(self, problem)

    monkeypatch.setattr(EquilibriumEngine, "start", compiling)
    monkeypatch.setattr(compiler, "_processors", lambda: 1)  # helped by no process


@pytest.fixture
def model_file(tmp_path):
    path = tmp_path / "stack.toml"
    ds.write_model(stack((0.4, 0.9)).with_analysis(max_steps=3, engine="equilibrium"), path)
    return path


def run(*arguments):
    return CliRunner().invoke(app, ["run", *map(str, arguments)])


def test_compilation_is_told_once_and_timed_with_what_is_inside(slow_to_compile):
    told = []
    with ds.Compilation(lambda: told.append("begun")) as compilation:
        curve = ds.pushover(stack((0.4, 0.9)), max_steps=3)
    assert told == ["begun"]
    assert compilation.n_kernels >= 2
    # One after the other is told of each kernel, microseconds apart.
    assert 0.0 < curve.compile_time <= compilation.seconds + 1e-3


def test_garbage_is_left_alone_while_a_kernel_is_compiled():
    """Also where one `Compilation` stands within another, as in a command's analysis."""
    seen = []

    class Watcher(ds.Compilation):
        def on_end(self, event):
            seen.append(gc.isenabled())
            super().on_end(event)

    @njit
    def kernel(x):
        return x + 1

    with ds.Compilation(), Watcher() as inner:
        kernel(1)
    assert inner.n_kernels == 1
    assert seen == [False]
    assert gc.isenabled()


def test_garbage_is_left_alone_while_modules_are_imported():
    with importing():
        assert not gc.isenabled()
    assert gc.isenabled()
    gc.unfreeze()  # for other tests of this process


def test_time_of_compilation_is_not_in_the_wall_time(slow_to_compile, monkeypatch):
    """Both together are the time that passed, on a clock of ours."""
    model = stack((0.4, 0.9))
    ds.pushover(model, max_steps=3)  # everything else is compiled or loaded
    compiled = ds.pushover(model, max_steps=3)
    assert compiled.compile_time > 0.0
    monkeypatch.undo()
    plain = ds.pushover(model, max_steps=3)
    assert plain.compile_time == 0.0
    # Three steps of one block take milliseconds, the compiler a good part of a second.
    assert compiled.wall_time < compiled.compile_time + plain.wall_time


def test_first_run_says_what_it_waits_for(slow_to_compile, model_file, tmp_path):
    result = run(model_file, "--out", tmp_path / "out")
    lines = result.stderr.splitlines()
    # A slow machine shows its progress between the two.
    begun, ended = (line for line in lines if line.startswith("drystone: compil"))
    assert (
        begun
        == "drystone: compiling, once on this machine: half a minute or so where nothing else runs"
    )
    assert ended.startswith("drystone: compiled in ")
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary["compile_time"] > 0.0


def test_run_goes_on_where_no_process_can_help(slow_to_compile, model_file, tmp_path, monkeypatch):
    def refused(engine, dimension):
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(compiler, "_processors", lambda: 2)
    monkeypatch.setattr(compiler, "_helper", refused)
    assert "Resource" not in run(model_file, "--out", tmp_path / "out").stderr
    assert (tmp_path / "out/summary.json").is_file()


@pytest.mark.parametrize("option", ["--quiet", "--json"])
def test_notice_is_left_out_where_nobody_reads_it(slow_to_compile, model_file, tmp_path, option):
    result = run(model_file, "--out", tmp_path / "out", option)
    assert "compil" not in result.stderr


def test_later_runs_say_nothing(model_file, tmp_path):
    run(model_file, "--out", tmp_path / "out")  # all there is to compile
    assert "compil" not in run(model_file, "--out", tmp_path / "out").stderr


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("engine", compiler.REHEARSED)
def test_rehearsal_finds_what_a_run_calls(engine, dimension):
    """In a process of its own; the types are those that the kernels are compiled for in ours."""
    listed = synthetic.python(
        "import sys, json; from drystone.cli import compiler\n"
        "from drystone.common.compilation import rehearse\n"
        "found = rehearse(lambda: compiler._small_run(sys.argv[1], int(sys.argv[2])))\n"
        "print(json.dumps([[k.__module__, k.__name__, str(t)] for k, t in found]))",
        engine,
        str(dimension),
    )
    found = json.loads(listed.stdout)
    assert len(found) > 10
    compiler._small_run(engine, dimension)
    for module, name, types in found:
        kernel = getattr(sys.modules[module], name)
        assert types in [str(signature) for signature in kernel.signatures]


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, 3])
def test_second_process_compiles_all_that_a_run_needs(tmp_path, dimension):
    """Into an empty cache; a minute or so."""
    environment = {**synthetic.environment(), "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run(
        [sys.executable, "-m", "drystone.cli.compiler", "equilibrium", str(dimension)],
        check=True,
        env=environment,
    )
    count = subprocess.run(
        [
            sys.executable,
            "-c",
            "import drystone as ds; from drystone.cli import compiler\n"
            f"with ds.Compilation() as c: compiler._small_run('equilibrium', {dimension})\n"
            "print(c.n_kernels)",
        ],
        check=True,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert count.stdout.strip() == "0"
    assert os.listdir(tmp_path)
