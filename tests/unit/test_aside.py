"""A process beside a run: what it finds and draws is what would have been found and drawn here."""

from __future__ import annotations

import json
import os
import signal
import time
from concurrent.futures import Future, wait

import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from builders import stack
from drystone.cli import app
from drystone.cli.limits import INTERRUPTED, Limits
from drystone.common import threads
from drystone.common.aside import Aside, answer
from drystone.common.workers import WorkerError
from drystone.report.folder import ending

#: Seconds within which a process that is asked for nothing heavy answers, on a busy machine.
SOON = 60.0


def test_one_thing_after_another():
    with Aside() as aside:
        asked = [aside.begin("builtins:pow", 2, k) for k in range(5)]
        assert [answer(each, lambda: None) for each in asked] == [1, 2, 4, 8, 16]


def test_an_error_comes_as_it_was_raised():
    with Aside() as aside:
        asked = aside.begin("builtins:divmod", 1, 0)
        with pytest.raises(ZeroDivisionError):
            answer(asked, lambda: "here")


def test_more_than_a_pipe_holds_goes_both_ways():
    """While it is sent this process goes on: a pipe takes some 64 kB."""
    many = np.arange(1e6)
    with Aside() as aside:
        aside.begin("time:sleep", 0.1)
        asked = [aside.begin("numpy:negative", many) for _ in range(3)]
        assert all((answer(each, list) == -many).all() for each in asked)


@pytest.mark.parametrize("arguments", [("os:_exit", 7), ("builtins:len", lambda: 0)])
def test_what_it_cannot_do_is_done_here(arguments):
    """It has ended, or is sent what cannot be sent."""
    with Aside() as aside:
        assert answer(aside.begin(*arguments), lambda: "here") == "here"
    assert answer(None, lambda: "here") == "here"


def test_it_ends_whatever_it_does():
    with Aside() as aside:
        asked = aside.begin("time:sleep", 1e3)
    wait([asked], SOON)
    assert isinstance(asked.exception(), WorkerError)


def test_interrupted_it_leaves_what_it_does():
    with Aside() as aside:
        assert answer(aside.begin("builtins:len", ""), lambda: None) == 0  # it is there
        asked = aside.begin("time:sleep", 1e3)
        time.sleep(0.5)  # on its way
        aside.interrupt()
        assert isinstance(asked.exception(SOON), KeyboardInterrupt)


def test_alone_on_a_processor_there_is_none(monkeypatch):
    monkeypatch.setattr(threads, "available", lambda: 1)
    assert Aside.where_it_helps() is None


@pytest.fixture
def model_file(tmp_path):
    path = tmp_path / "stack.toml"
    ds.write_model(stack((0.4, 0.9)).with_analysis(engine="equilibrium"), path)
    return path


def run(model_file, folder, monkeypatch, processors):
    monkeypatch.setattr(threads, "available", lambda: processors)
    result = CliRunner().invoke(app, ["run", str(model_file), "--out", str(folder), "--quiet"])
    assert result.exit_code == 0, result.output
    summary = json.loads((folder / "summary.json").read_text())
    del summary["wall_time"], summary["compile_time"]
    return summary


def test_a_run_with_a_process_beside_it_writes_the_same(model_file, tmp_path, monkeypatch):
    """To the byte, but for what is of the time it took."""
    one = run(model_file, tmp_path / "one", monkeypatch, 1)
    two = run(model_file, tmp_path / "two", monkeypatch, 2)
    assert one == two and one["associative_multiplier"] is not None
    names = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*.*"))
    assert sorted(p.relative_to(tmp_path / "two") for p in (tmp_path / "two").rglob("*.*")) == names
    written = {"curve.csv", "curve.png", "mechanism.png"}
    assert written <= {name.name for name in names}
    for name in names:
        if name.suffix in (".csv", ".png", ".vtu", ".pvd"):
            same = (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
            assert same, name


def test_a_process_that_is_killed_costs_nothing(model_file, tmp_path, monkeypatch):
    """Killed before it has found or drawn anything: that is done by the run itself."""

    class Killed(Aside):
        def begin(self, place, *arguments):
            os.kill(self._process.pid, signal.SIGKILL)
            return super().begin(place, *arguments)

    one = run(model_file, tmp_path / "one", monkeypatch, 1)
    monkeypatch.setattr("drystone.common.aside.Aside", Killed)
    assert run(model_file, tmp_path / "two", monkeypatch, 2) == one
    for name in ("curve.png", "mechanism.png"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


@pytest.mark.parametrize(
    "arguments", [["--resume", "nowhere"], ["nothing.toml", "--directions", "both"]]
)
def test_a_run_that_has_no_use_for_the_process_ends_it(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    begun = Limits(Aside())
    result = CliRunner().invoke(app, ["run", *arguments], obj=begun)
    assert result.exit_code == 2  # there is no such folder, and no such file
    assert begun.aside._process.poll() is not None


def test_who_does_not_wait_for_limit_analysis_keeps_the_curve(monkeypatch):
    """Ctrl-C while the curve is traced and the process still looks for multipliers."""
    limits = Limits(None)
    limits._model, limits._going = stack((0.4, 0.9)), Future()

    def interrupted(*futures, timeout):
        raise KeyboardInterrupt

    monkeypatch.setattr("drystone.common.aside.wait", interrupted)
    assert limits.found().note == INTERRUPTED


def test_an_interrupt_while_it_draws_leaves_no_half_picture(model_file, tmp_path, monkeypatch):
    def interrupted(future, here):
        if future is not None and not future.done():
            raise KeyboardInterrupt
        return future.result()

    monkeypatch.setattr(ending, "answer", interrupted)
    monkeypatch.setattr(threads, "available", lambda: 2)
    folder = tmp_path / "out"
    result = CliRunner().invoke(app, ["run", str(model_file), "--out", str(folder), "--quiet"])
    assert result.exit_code in (0, 130)  # it may have been done
    assert not list(folder.rglob("*.part"))
    assert (folder / "curve.csv").is_file()
