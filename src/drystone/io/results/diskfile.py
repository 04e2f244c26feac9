"""The file that HDF5 writes to: what is on the disk is whole, whatever becomes of a write.

HDF5 does not survive a write that fails: it fails again as the file is closed, and ends the process
as Python leaves.  Here its writes wait in memory, where none can fail, until `commit` brings them
to the disk.  What makes the file longer goes first; where the disk is full the file is cut
back to what it was, which is a readable file with everything up to the commit before.  What is
written over goes through a journal (`journal`): a process that is killed meanwhile leaves a file
that can be read, too.
"""

from __future__ import annotations

import io
import math
import os
import time
from pathlib import Path
from typing import Any

from drystone.io.results import journal
from drystone.io.results.laidover import LaidOver, lay, put_all

#: Seconds after which a new file is brought to the disk for good at each commit: what a power cut
#: takes of a younger one is soon computed again.  Waiting for a disk would be a tenth of a run of a
#: second.
YOUNG = 10.0


class DiskFile(LaidOver):
    """A file object for h5py.  Replaces a file of that name, unless it goes ``on`` with it."""

    def __init__(self, path: Path | str, *, on: bool = False) -> None:
        self._path = Path(path)
        if on:
            journal.recover(self._path)
        else:
            journal.journal_of(self._path).unlink(missing_ok=True)
        disk = io.FileIO(path, "r+" if on else "w+")
        length = os.fstat(disk.fileno()).st_size
        self._waiting: list[tuple[int, bytes]] = []  # in the order in which they came
        super().__init__(disk, length, length, self._waiting)
        self._grown_up = -math.inf if on else time.monotonic() + YOUNG

    def write(self, data: Any) -> int:
        """Take note of bytes for the place."""
        taken = bytes(data)
        self._waiting.append((self._place, taken))
        self._place += len(taken)
        self._end = max(self._end, self._place)
        return len(taken)

    def truncate(self, size: int | None = None) -> int:
        """Let the file end at ``size``."""
        self._end = self._place if size is None else size
        return self._end

    def flush(self) -> None:
        """Nothing: see `commit`."""

    @property
    def syncs(self) -> bool:
        """Whether what is committed outlasts a power cut."""
        return time.monotonic() >= self._grown_up

    def commit(self) -> None:
        """Bring everything to the disk; raises `OSError` where it does not take it all."""
        old, end, handle = self._length, self._end, self._disk.fileno()
        tail = bytearray(max(end - old, 0))
        for offset, data in self._waiting:
            lay(tail, old, offset, data)
        over = [(offset, data[: old - offset]) for offset, data in self._waiting if offset < old]
        if not tail and not over and end == old:
            return
        sync = os.fsync if self.syncs else _no_wait
        try:
            self._put(old, tail)
            sync(handle)
            kept = journal.written(self._path, end, over, sync) if old else None
        except OSError:
            os.ftruncate(handle, old)
            raise
        for offset, data in over:
            self._put(offset, data)
        os.ftruncate(handle, end)
        sync(handle)
        if kept is not None:
            kept.unlink(missing_ok=True)
        self._length = end
        self._waiting.clear()

    def move(self, path: Path) -> None:
        """Give the file another name, in place of a file that has it; raises `OSError`."""
        self._disk.close()  # an open file keeps its name on some systems
        try:
            os.replace(self._path, path)
            self._path = path
        finally:
            self._disk = io.FileIO(self._path, "r+")

    def close(self) -> None:
        """Close the file; what was not committed is dropped."""
        self._waiting.clear()
        super().close()

    def _put(self, offset: int, data: bytes | bytearray) -> None:
        self._disk.seek(offset)
        put_all(self._disk, data)


def _no_wait(handle: int) -> None:
    """What is written outlasts the process, as it is with the operating system."""
