"""Work shared by processes: results in their order, errors as they were raised."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import synthetic

from drystone.common.workers import WorkerError, in_processes
from drystone.model.builders import ModelError

#: Sends an exception that takes other arguments than it keeps.
SENDS = """
import sys
import numpy as np
from drystone.common.workers import _message
from drystone.dynamics.distinct.state import RunAwayError
sys.stdout.buffer.write(_message(("raised", RunAwayError("high", np.zeros(2)))))
"""


def test_results_come_in_the_order_of_the_calls():
    told = []
    calls = [("builtins:pow", (2, k)) for k in range(5)]
    assert in_processes(calls, 2, lambda k, value: told.append((k, value))) == [1, 2, 4, 8, 16]
    assert sorted(told) == [(k, 2**k) for k in range(5)]


def test_an_error_comes_as_it_was_raised():
    with pytest.raises(ZeroDivisionError):
        in_processes([("builtins:divmod", (1, 0)), ("builtins:pow", (2, 3))], 2)


def test_a_process_that_ends_is_told():
    """Its status, and no wait for what will never come."""
    with pytest.raises(WorkerError, match="status 7"):
        in_processes([("os:_exit", (7,))], 1)


PARENT = """
import sys
from drystone.common.workers import in_processes
in_processes([("test_workers:tells_and_waits", (sys.argv[1],))], 1)
"""


def tells_and_waits(path: str) -> None:
    """Write the number of this process into a file, and go on for a minute."""
    Path(path).write_text(str(os.getpid()))
    time.sleep(60.0)


def test_a_parent_that_is_killed_takes_its_workers_along(tmp_path):
    """Whoever resumes its work finds nobody that still writes."""
    told = tmp_path / "pid"
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, str(told)], env=synthetic.environment()
    )
    within(lambda: told.exists() and told.read_text())
    parent.kill()
    parent.wait()
    within(lambda: not runs(int(told.read_text())))


def runs(pid: int) -> bool:
    """Whether a process of this user runs."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    status = Path(f"/proc/{pid}/stat")  # one that has ended, and for which nobody waits
    return not (status.exists() and status.read_text().rpartition(")")[2].split()[0] == "Z")


def within(happens: Callable[[], object], seconds: float = 20.0) -> None:
    """Wait until something happens."""
    until = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < until
        time.sleep(0.02)


@pytest.mark.parametrize("problems", [["one"], ["block a: wrong", "block b: wrong"]])
def test_problems_of_a_model_stay_sentences(problems):
    """They cross from one process to another, one or several."""
    error = pickle.loads(pickle.dumps(ModelError(problems)))
    assert type(error) is ModelError
    assert error.problems == problems
    assert str(error) == "\n".join(problems)


def test_what_cannot_be_sent_is_told():
    """A result that is no data, and an exception that is not made again of its arguments."""
    with pytest.raises(WorkerError, match="TextIOWrapper"):
        in_processes([("os:fdopen", (0,))], 1)
    # In a process of its own: libraries of clusters teach all exceptions to be made again.
    sent = subprocess.run([sys.executable, "-c", SENDS], capture_output=True, check=True)
    how, error = pickle.loads(sent.stdout)
    assert how == "raised"
    with pytest.raises(WorkerError, match='RunAwayError: the block "high" runs away'):
        raise error
