"""A file on the disk with bytes laid over it, as whoever reads it is to see it."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

#: What a file is to hold: places and bytes, in the order in which they are laid down.
Pieces = Sequence[tuple[int, bytes]]


class LaidOver(io.RawIOBase):
    """A file object that reads a file with pieces over it; for h5py.

    Parameters
    ----------
    disk
        The file, which is closed with this one.
    on_disk
        Bytes of it that count.
    end
        Bytes of the whole, with the pieces.
    pieces
        What lies over it; may grow.
    """

    def __init__(self, disk: io.FileIO, on_disk: int, end: int, pieces: Pieces) -> None:
        super().__init__()
        self._disk, self._length, self._end, self._pieces = disk, on_disk, end, pieces
        self._place = 0

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        start = {io.SEEK_SET: 0, io.SEEK_CUR: self._place, io.SEEK_END: self._end}[whence]
        self._place = start + offset
        return self._place

    def tell(self) -> int:
        """The place."""
        return self._place

    def readinto(self, buffer: Any) -> int:
        """Read from the place on, what is laid over it included."""
        start, length = self._place, max(min(len(buffer), self._end - self._place), 0)
        content = bytearray(length)
        self._disk.seek(start)
        found = self._disk.read(max(min(length, self._length - start), 0)) or b""
        content[: len(found)] = found
        for place, data in self._pieces:
            lay(content, start, place, data)
        buffer[:length] = content
        self._place += length
        return length

    def close(self) -> None:
        """Close the file."""
        self._disk.close()
        super().close()


def lay(content: bytearray, start: int, place: int, data: bytes) -> None:
    """Put ``data``, which is for ``place``, into ``content``, which begins at ``start``."""
    first, last = max(place, start), min(place + len(data), start + len(content))
    if first < last:
        content[first - start : last - start] = data[first - place : last - place]


def put_all(file: io.FileIO, data: bytes | bytearray | memoryview) -> None:
    """Write all of some bytes where the file is; the system may take them in pieces."""
    view = memoryview(data)
    while view:
        view = view[file.write(view) or 0 :]
