"""A process beside this one that does one thing after another, while this one does its own.

What it is asked for is a function by its name with arguments that can be pickled, as of `workers`;
what it returns comes back.  It is only a help: where it cannot be had, cannot be sent something, or
ends by itself, the answer is a `WorkerError` and whoever asked does the thing here.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import Future, wait
from contextlib import suppress
from queue import SimpleQueue
from threading import Thread
from typing import Any, Self, TypeVar

from drystone.common.workers import Call, WorkerError, server

T = TypeVar("T")

#: Seconds that a process has to leave what it does when it is interrupted.
PATIENCE = 2.0


class Aside:
    """The process; it ends with the ``with`` statement, whatever it does then.

    Raises
    ------
    OSError
        It cannot be started.
    """

    def __init__(self) -> None:
        alone: dict[str, Any] = {"process_group": 0}  # Ctrl-C is for this process alone to hear
        if sys.platform == "win32":
            alone = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
        self._process = server(**alone)
        self._todo: SimpleQueue[tuple[Call, Future[Any]]] = SimpleQueue()
        self._asked: Future[Any] | None = None  # what it does now
        Thread(target=self._talk, daemon=True).start()

    @classmethod
    def where_it_helps(cls) -> Self | None:
        """A process, where another processor has nothing to do; None where none can be had."""
        from drystone.common.threads import available

        if available() < 2:
            return None
        with suppress(OSError):
            return cls()
        return None

    def begin(self, place: str, *arguments: Any) -> Future[Any]:
        """Ask for a function "module:name"; what it returns will be in the future."""
        future: Future[Any] = Future()
        self._todo.put(((place, arguments), future))
        return future

    def _talk(self) -> None:
        """Send one call after another, and read what comes back; in a thread of its own, as a pipe
        takes only so much before it is read."""
        todo, answers = self._process.stdin, self._process.stdout
        assert todo is not None and answers is not None
        while True:
            call, future = self._todo.get()
            self._asked = future
            try:
                todo.write(pickle.dumps(call))
                todo.flush()
                how, value = pickle.load(answers)
            except Exception as error:  # of arguments that cannot be pickled, or of a pipe
                how, value = "raised", WorkerError(f"a process beside this one failed: {error!r}")
            if how == "raised":
                future.set_exception(value)
            else:
                future.set_result(value)

    def interrupt(self) -> None:
        """Interrupt what it does; it removes the files that it has not finished."""
        if self._asked is not None and not self._asked.done():
            self._process.terminate()
            wait([self._asked], PATIENCE)

    def end(self) -> None:
        """End it, with what it does."""
        self._process.kill()
        self._process.wait()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()


def answer(future: Future[T] | None, here: Callable[[], T]) -> T:
    """What a process has found, or what is found ``here`` where there is none or it has failed.

    Raises whatever either has raised.
    """
    if future is None:
        return here()
    while not future.done():
        wait([future], timeout=0.2)  # in pieces, so that signals are heard on every system
    try:
        return future.result()
    except WorkerError:
        return here()
