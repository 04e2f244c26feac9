"""A Dask cluster that computes the samples of a study.

Dask schedules, moves and repeats; here chunks are handed over, and their results taken.
"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from queue import Empty, SimpleQueue
from typing import Any

from drystone.common.workers import Call, WorkerError
from drystone.studies.errors import StudyError, needed

#: Chunks given out for each thread of the cluster: one waits while another is computed.
AHEAD = 2
#: s, until a scheduler answers.
PATIENCE = 20.0


def call(place: str, arguments: tuple[Any, ...]) -> Any:
    """What a function "module:name" returns; called where Dask likes."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)(*arguments)


class ClusterWorkers:
    """Workers of a Dask cluster, as many as it has at the moment.

    Parameters
    ----------
    address
        Of the scheduler: "tcp://host:8786".

    Raises
    ------
    StudyError
        Nobody answers there.
    """

    def __init__(self, address: str) -> None:
        distributed = needed("distributed")
        try:
            self._client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise StudyError(
                [f"--scheduler {address}: no scheduler answers there ({error}): start one by "
                 "dask scheduler, and workers by dask worker ADDRESS"]
            ) from None  # fmt: skip
        self._came: SimpleQueue[int] = SimpleQueue()
        self._out: dict[int, Any] = {}

    def count(self) -> int:
        """Threads of all workers, at least one: others may come."""
        return max(1, sum(self._client.nthreads().values()))

    def wanted(self) -> int:
        """Chunks to give out now."""
        return max(0, AHEAD * self.count() - len(self._out))

    def begin(self, number: int, call_: Call) -> None:
        """Hand a call over."""
        future = self._client.submit(call, *call_, pure=False, key=f"drystone-{id(self)}-{number}")
        self._out[number] = future
        future.add_done_callback(lambda _: self._came.put(number))

    def next(self, timeout: float) -> tuple[int, str, Any] | None:
        """What came of a call."""
        try:
            number = self._came.get(timeout=timeout)
        except Empty:
            return None
        future = self._out.pop(number)
        lost = (needed("distributed").KilledWorker, needed("distributed").CancelledError)
        try:
            return number, "done", future.result()
        except lost as error:
            return number, "lost", WorkerError(f"the workers that computed it ended: {error}")
        except Exception as error:
            return number, "raised", error

    def end(self) -> None:
        """Take back what is not wanted any more."""
        with suppress(Exception):  # the cluster may have ended
            for future in self._out.values():
                future.cancel()
            self._client.close(timeout=5)
