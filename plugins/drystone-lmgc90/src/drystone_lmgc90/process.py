"""A process of LMGC90's own, and the two pipes to it.

Messages are pickles behind their length.  They have pipes to themselves because Fortran prints on
standard output whatever it likes; that and standard error go to a file, whose end is the only
thing LMGC90 leaves behind when it stops.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import weakref
from pathlib import Path
from typing import Any, BinaryIO

import drystone
from drystone.engines.base import EngineError

#: Lines of its output that an error quotes.
LAST_LINES = 4
LENGTH = struct.Struct("=Q")


class RemoteError(Exception):
    """What went wrong on the other side, as a sentence."""


def send(pipe: BinaryIO, message: Any) -> None:
    """Write one message."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    pipe.write(LENGTH.pack(len(body)) + body)
    pipe.flush()


def receive(pipe: BinaryIO) -> Any:
    """Read one message; raises `EOFError` where the other side has ended."""
    head = pipe.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError
    (length,) = LENGTH.unpack(head)
    body = pipe.read(length)
    if len(body) < length:
        raise EOFError
    return pickle.loads(body)


def _end(process: subprocess.Popen[bytes], folder: Path) -> None:
    """Nothing is left of a worker: neither the process nor its files."""
    if process.poll() is None:
        process.kill()
        process.wait()
    shutil.rmtree(folder, ignore_errors=True)


class Process:
    """The worker process.

    Parameters
    ----------
    driver
        Name of the module of this package that drives LMGC90 there.
    """

    def __init__(self, driver: str) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="drystone-lmgc90-"))
        self._said = self._folder / "said.txt"
        in_child, self_out = os.pipe()
        self_in, out_child = os.pipe()
        own = [str(Path(one).resolve().parents[1]) for one in (__file__, drystone.__file__)]
        path = os.environ.get("PYTHONPATH")
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([*own, *([path] if path else [])]),
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
        }
        try:
            with self._said.open("wb") as said:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "drystone_lmgc90.worker",
                     driver, str(in_child), str(out_child)],
                    stdin=subprocess.DEVNULL,
                    stdout=said,
                    stderr=subprocess.STDOUT,
                    cwd=self._folder,  # LMGC90 writes files where it stands
                    env=environment,
                    pass_fds=(in_child, out_child),
                    start_new_session=True,  # Ctrl-C is for the parent to deal with
                )  # fmt: skip
        finally:
            os.close(in_child)
            os.close(out_child)
        self._out = os.fdopen(self_out, "wb")
        self._in = os.fdopen(self_in, "rb")
        # Also where an engine is dropped without having been closed.
        self._end = weakref.finalize(self, _end, self._process, self._folder)

    @property
    def pid(self) -> int:
        """Id of the process."""
        return self._process.pid

    def ask(self, message: Any) -> Any:
        """Send a message and wait for the answer.

        Raises
        ------
        EngineError
            The process ended, with how and what it said last; or it answered with an error.
        """
        try:
            send(self._out, message)
            answer = receive(self._in)
        except (EOFError, BrokenPipeError, ConnectionError):
            raise EngineError(self._obituary()) from None
        if isinstance(answer, RemoteError):
            raise EngineError(str(answer))
        return answer

    def close(self) -> None:
        """End the process, whatever it is doing, and remove its files."""
        with contextlib.suppress(OSError):
            self._out.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=2.0)  # it leaves when its pipe is closed
        self._in.close()
        self._end()

    def _obituary(self) -> str:
        try:
            code = self._process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            code = self._process.wait()
        if code < 0:
            try:
                how = f"was ended by {signal.Signals(-code).name}"
            except ValueError:
                how = f"was ended by signal {-code}"
        else:
            how = f"stopped with status {code}"
        said = self._said.read_text(encoding="utf-8", errors="replace")
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        last = " / ".join(lines[-LAST_LINES:])
        return f"LMGC90 {how}; " + (f"it said: {last}" if last else "it said nothing")
