"""Cases one after the other in processes of their own, within limits of time and memory."""

from __future__ import annotations

import os
import resource
import selectors
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from .readers import Case

#: Seconds of a processor that a case may take; the smallest sound models take a tenth of one.
SECONDS = 20.0
#: Times as many by the clock, where the machine is busy.
PATIENCE = 10.0
#: Bytes that a worker may have beside what it begins with.
MEMORY = 2 << 30
#: Cases of one worker: what one leaves behind is no reason for what the next one does.
TURN = 200

HANG, KILLED = "hang", "killed"


@dataclass(frozen=True)
class Ended:
    """A case with what became of it, and the seconds it took."""

    case: Case
    kind: str
    what: str
    seconds: float


def judged(
    cases: Iterable[Case],
    *,
    processes: int = 2,
    seconds: float = SECONDS,
    until: float = float("inf"),
) -> Iterator[Ended]:
    """Cases as they end; none is begun after the time ``until`` (`time.monotonic`)."""
    waiting = iter(cases)
    with selectors.DefaultSelector() as selector:
        workers = [_Worker(seconds) for _ in range(processes)]
        try:
            for worker in workers:
                worker.next(waiting, until, selector)
            while any(worker.case for worker in workers):
                selector.select(timeout=0.5)
                for worker in workers:
                    if worker.case and (ended := worker.look(selector)):
                        yield ended
                        worker.next(waiting, until, selector)
        finally:
            for worker in workers:
                worker.end(selector)


@dataclass
class _Worker:
    """A process that looks at one case after the other, and is replaced where it does not end."""

    seconds: float
    case: Case | None = None
    pid: int = 0
    turns: int = 0
    begun: float = 0.0
    used: float = 0.0
    _to: int = -1
    _from: int = -1
    _told: bytes = field(default=b"")

    def next(self, waiting: Iterator[Case], until: float, selector: selectors.BaseSelector) -> None:
        """Begin with the next case."""
        self.case = next(waiting, None) if time.monotonic() < until else None
        if self.case is None:
            return
        if self.turns >= TURN:
            self.end(selector)
        if not self.pid:
            self._fork(selector)
        self.turns += 1
        self.begun, self.used, self._told = time.monotonic(), _processor_time(self.pid), b""
        case = self.case
        os.write(self._to, f"{case.reader} {case.seed} {case.number}\n".encode())

    def look(self, selector: selectors.BaseSelector) -> Ended | None:
        """What became of the case, if it has ended."""
        assert self.case is not None
        taken = time.monotonic() - self.begun
        ready, _, _ = _readable(self._from)
        if ready:
            part = os.read(self._from, 1 << 16)
            self._told += part
            if not part:
                status = self.end(selector)
                return Ended(self.case, KILLED, f"the process ended with {status}", taken)
            if self._told.endswith(b"\n"):
                kind, _, what = self._told.decode("utf-8", "replace").strip().partition("\t")
                return Ended(self.case, kind, what, taken)
            return None
        used = _processor_time(self.pid) - self.used
        if used > self.seconds or taken > PATIENCE * self.seconds:
            self.end(selector)
            return Ended(self.case, HANG, f"{used:.0f} s of a processor, {taken:.0f} s", taken)
        return None

    def end(self, selector: selectors.BaseSelector) -> str:
        """End the process, whatever it does; how it ended by itself, if it did."""
        if not self.pid:
            return ""
        selector.unregister(self._from)
        os.kill(self.pid, signal.SIGKILL)
        _, status = os.waitpid(self.pid, 0)
        os.close(self._to)
        os.close(self._from)
        self.pid = self.turns = 0
        code = os.waitstatus_to_exitcode(status)
        return signal.Signals(-code).name if code < 0 else f"status {code}"

    def _fork(self, selector: selectors.BaseSelector) -> None:
        inward, self._to = os.pipe()
        self._from, outward = os.pipe()
        sys.stdout.flush()
        self.pid = os.fork()
        if self.pid == 0:
            os.close(self._to)
            os.close(self._from)
            _serve(inward, outward)
        os.close(inward)
        os.close(outward)
        selector.register(self._from, selectors.EVENT_READ)


def _serve(inward: int, outward: int) -> None:
    """What a worker does until nobody asks any more."""
    status = 1
    folder = Path(tempfile.mkdtemp(prefix="drystone-fuzz-"))
    try:
        most = _size() + MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        with open(inward, encoding="ascii") as asked:
            for line in asked:
                reader, seed, number = line.split()
                kind, what = one(Case(reader, int(seed), int(number)), folder)
                text = f"{kind}\t{' '.join(what.split())}\n"
                os.write(outward, text.encode("utf-8", "replace"))
        status = 0
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(status)


def one(case: Case, folder: Path) -> tuple[str, str]:
    """What becomes of a case, whose files are written into a folder."""
    for old in folder.iterdir():
        old.unlink()
    return case.looked_at(case.written(folder))


def _readable(descriptor: int) -> tuple[list[int], list[int], list[int]]:
    import select

    return select.select([descriptor], [], [], 0)


def _processor_time(pid: int) -> float:
    """Seconds of a processor that a process has taken; those of the clock where nobody tells."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError):
        return time.monotonic()


def _size() -> int:
    """Bytes of addresses that this process has."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        return 8 << 30


Told = Callable[[Ended], None]
