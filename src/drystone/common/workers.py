"""Processes that share work which is many calls of one function, each in a process of its own.

A call is a pickled name of a function with its arguments; what it returns is sent back.  Workers
are interrupted by their parent alone, once: Ctrl-C on a terminal, which reaches all processes, is
for the parent to pass on, so that what a worker writes is not cut in two.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from importlib import import_module
from queue import Empty, SimpleQueue
from threading import Event, Thread
from typing import Any, BinaryIO

#: A function as "module:name", and its arguments.
Call = tuple[str, tuple[Any, ...]]

#: One thread each: numerical libraries would take all processors, in every process.
_ONE_EACH = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def in_processes(
    calls: Sequence[Call], processes: int, told: Callable[[int, Any], None] | None = None
) -> list[Any]:
    """What the calls return, in their order; at most so many processes at a time.

    Interrupted, calls that run are interrupted and end as they do, those that wait are left out:
    None.  Then `KeyboardInterrupt` is raised by whoever looks: here nothing is lost.

    Parameters
    ----------
    told
        Is called with the number of a call and what it returned as it comes.

    Raises
    ------
    Exception
        Whatever a call raised, of several the first in time.
    WorkerError
        A process ended by itself, or what a call gave cannot be sent.
    """
    results: list[Any] = [None] * len(calls)
    todo = iter(range(len(calls)))
    came: SimpleQueue[tuple[_Worker, int, str, Any]] = SimpleQueue()
    workers: list[_Worker] = []
    failure: BaseException | None = None
    try:
        busy = 0
        for number in _first(todo, processes):
            workers.append(_Worker(came))
            workers[-1].begin(number, calls[number])
            busy += 1
        while busy:
            try:
                worker, number, how, value = _next(came)
            except KeyboardInterrupt:
                todo = iter(())
                for worker in workers:
                    worker.interrupt()
                continue
            busy -= 1
            if how == "raised":
                failure, todo = failure or value, iter(())
                for other in workers:
                    other.interrupt()
                continue
            results[number] = value
            if told is not None:
                told(number, value)
            following = next(todo, None)
            if following is not None:
                worker.begin(following, calls[following])
                busy += 1
    finally:
        for worker in workers:
            worker.end()
    if failure is not None:
        raise failure
    return results


class Pool:
    """Processes that take calls as they come; one that ends by itself is replaced.

    Parameters
    ----------
    processes
        How many.
    """

    def __init__(self, processes: int) -> None:
        self._came: SimpleQueue[tuple[_Worker, int, str, Any]] = SimpleQueue()
        self._workers = [_Worker(self._came) for _ in range(processes)]
        self._idle = list(self._workers)

    @property
    def n_idle(self) -> int:
        """Processes that wait for a call."""
        return len(self._idle)

    def begin(self, number: int, call: Call) -> None:
        """Give a call, by a number of the caller's, to a process that waits."""
        self._idle.pop(0).begin(number, call)

    def next(self, timeout: float) -> tuple[int, str, Any] | None:
        """What came of a call: its number, "done" with what it returned, "raised" with the error,
        or "lost" with a `WorkerError` where its process ended; None where nothing came in time.

        Parameters
        ----------
        timeout
            s.
        """
        try:
            worker, number, how, value = self._came.get(timeout=timeout)
        except Empty:
            return None
        if how == "raised" and worker.ended:
            self._workers.remove(worker)
            worker.end()
            worker, how = _Worker(self._came), "lost"
            self._workers.append(worker)
        self._idle.append(worker)
        return number, how, value

    def end(self) -> None:
        """End all processes, with what they do."""
        for worker in self._workers:
            worker.end()


def _first(todo: Iterator[int], most: int) -> Iterator[int]:
    for _ in range(most):
        number = next(todo, None)
        if number is not None:
            yield number


def _next(came: SimpleQueue[Any]) -> Any:
    """What comes next; waits in pieces, so that signals are heard on every system."""
    while True:
        with suppress(Empty):
            return came.get(timeout=0.2)


class WorkerError(Exception):
    """A process ended by itself, or what it has to say cannot be sent; the message says which."""


def _ended(code: int) -> WorkerError:
    return WorkerError(
        f"a process that shared the work ended with status {code}: see what it wrote; where memory "
        "was short, take fewer at a time"
    )


def server(**options: Any) -> subprocess.Popen[bytes]:
    """A new process that does what is sent to it; ``options`` of `subprocess.Popen`."""
    return subprocess.Popen(
        [sys.executable, "-m", "drystone.common.workers"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, **dict.fromkeys(_ONE_EACH, "1")},
        **options,
    )


class _Worker:
    """A process, and the thread that waits for what it returns."""

    def __init__(self, came: SimpleQueue[Any]) -> None:
        self._came, self._busy = came, False
        self._process = server()

    def begin(self, number: int, call: Call) -> None:
        """Send a call; what comes of it goes to the queue."""
        self._busy = True
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # the thread tells that it has ended
            pickle.dump(call, self._process.stdin)
            self._process.stdin.flush()
        Thread(target=self._wait, args=(number,), daemon=True).start()

    def _wait(self, number: int) -> None:
        assert self._process.stdout is not None
        try:
            how, value = pickle.load(self._process.stdout)
        except (EOFError, pickle.UnpicklingError):
            how, value = "raised", _ended(self._process.wait())
        except Exception as error:  # or the parent would wait for ever
            how, value = "raised", WorkerError(f"what a process gave cannot be read: {error!r}")
        self._busy = False
        self._came.put((self, number, how, value))

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def interrupt(self) -> None:
        """Interrupt what runs, once."""
        if self._busy:
            self._process.terminate()

    def end(self) -> None:
        """Let the process end."""
        assert self._process.stdin is not None and self._process.stdout is not None
        if self._busy:
            self._process.kill()
        with suppress(BrokenPipeError):
            self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


def _serve(requests: BinaryIO, replies: BinaryIO) -> None:
    """Do what is asked for until there is no more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asked: SimpleQueue[Call | None] = SimpleQueue()
    busy = Event()
    Thread(target=_listen, args=(requests, asked, busy), daemon=True).start()
    while True:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        call = asked.get()
        if call is None:
            return
        try:
            signal.signal(signal.SIGTERM, _interrupt)
            module, _, name = call[0].partition(":")
            reply = "done", getattr(import_module(module), name)(*call[1])
        except BaseException as error:
            reply = "raised", error
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        busy.clear()
        with suppress(BrokenPipeError):  # the parent has ended meanwhile
            replies.write(_message(reply))
            replies.flush()


def _listen(requests: BinaryIO, asked: SimpleQueue[Call | None], busy: Event) -> None:
    """Hand on calls as they come.

    A parent that was killed ends them all.  A call that runs ends with it, or it would go on
    writing into its folder, where whoever resumes the work is to write.
    """
    while True:
        try:
            call = pickle.load(requests)
        except EOFError:
            if busy.is_set():
                os._exit(1)
            asked.put(None)
            return
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        busy.set()
        asked.put(call)


def _message(reply: tuple[str, Any]) -> bytes:
    """A reply as bytes that its reader understands; what cannot be sent becomes an error."""
    try:
        message = pickle.dumps(reply)
        if reply[0] == "raised":
            pickle.loads(message)  # an exception may not be made again of its arguments
    except Exception as error:
        text = f"{type(reply[1]).__name__}: {reply[1]}"
        return pickle.dumps(("raised", WorkerError(f"{text} (not sent as it is: {error})")))
    return message


def _interrupt(number: int, frame: object) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt


if __name__ == "__main__":
    from drystone.common import workers  # its classes are those that the parent knows

    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what is printed by accident is no reply
    # Of its own: a thread waits in it, and as Python ends nobody may wait in `sys.stdin`.
    workers._serve(os.fdopen(os.dup(0), "rb"), replies)
