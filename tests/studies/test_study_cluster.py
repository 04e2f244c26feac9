"""A Dask scheduler with two workers on this machine: the same rows, and none lost with a worker."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

import drystone as ds
from drystone.studies.errors import StudyError
from studied import assert_same, written

STUDY = """
    function = "FUNCTIONS:wave"
    design = "random"
    samples = 300
    seed = 11
    [[parameter]]
    path = "a"
    range = [0.0, 1.0]
"""


def started(*arguments, folder):
    """A process of Dask; what it prints goes to a file."""
    log = (folder / f"{arguments[0]}-{time.monotonic_ns()}.log").open("w")
    process = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]],
        stdout=log,
        stderr=subprocess.STDOUT,
        env={**os.environ, "WAVE_SECONDS": "0.02"},
        cwd=folder,
    )
    return process, log.name


@contextmanager
def cluster(folder):
    """Address of a scheduler on a free port, and the processes of its two workers."""
    scheduler, log = started(
        "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", folder=folder
    )
    workers = []
    try:
        for _ in range(200):
            time.sleep(0.1)
            found = re.search(r"tcp://127\.0\.0\.1:\d+", Path(log).read_text())
            if found:
                break
        assert found, Path(log).read_text()
        for _ in range(2):
            workers.append(
                started("worker", found[0], "--nthreads", "1", "--no-dashboard", "--no-nanny",
                        folder=folder)[0]
            )  # fmt: skip
        yield found[0], workers
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def test_a_cluster_gives_the_same_rows_and_loses_none_with_a_worker(tmp_path):
    file = written(tmp_path, STUDY)
    ds.study(file, out=tmp_path / "here", workers=2, figures=False)
    with cluster(tmp_path) as (address, workers):
        ds.study(file, out=tmp_path / "cluster", scheduler=address, figures=False)
        assert_same(tmp_path / "here", tmp_path / "cluster")

        done = []

        def told(progress):
            done.append(progress.done)
            if not killed.is_set() and 50 < progress.done < 250:
                killed.set()
                workers[0].kill()

        killed = threading.Event()
        ds.study(file, out=tmp_path / "killed", scheduler=address, figures=False, progress=told)
        assert killed.is_set() and workers[0].wait() != 0
        assert_same(tmp_path / "here", tmp_path / "killed")


def test_where_no_scheduler_answers_it_is_said(tmp_path, monkeypatch):
    from drystone.studies import cluster as module

    monkeypatch.setattr(module, "PATIENCE", 1.0)
    with pytest.raises(StudyError, match="no scheduler answers there"):
        ds.study(written(tmp_path, STUDY), out=tmp_path / "out", scheduler="tcp://127.0.0.1:9")
