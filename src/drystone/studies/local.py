"""Processes of this machine that compute the samples of a study."""

from __future__ import annotations

from typing import Any

from drystone.common.workers import Call, Pool
from drystone.studies.study import Task

_PREPARE = "drystone.studies.sample:prepare"


class LocalWorkers:
    """So many processes, which load what they need while the first sample is computed.

    Parameters
    ----------
    processes
        How many.
    task
        Of the study.
    """

    def __init__(self, processes: int, task: Task) -> None:
        self._pool = Pool(processes)
        self._processes = processes
        for k in range(1, processes):
            self._pool.begin(-k, (_PREPARE, (task,)))

    def wanted(self) -> int:
        """Processes that wait."""
        return self._pool.n_idle

    def count(self) -> int:
        """How many processes there are."""
        return self._processes

    def begin(self, number: int, call: Call) -> None:
        """Give a call to a process that waits."""
        self._pool.begin(number, call)

    def next(self, timeout: float) -> tuple[int, str, Any] | None:
        """What came of a call; that a process is prepared is no such thing."""
        came = self._pool.next(timeout)
        return came if came is None or came[0] > 0 else None

    def end(self) -> None:
        """End all processes."""
        self._pool.end()
