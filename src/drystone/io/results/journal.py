"""A file that is changed in place and readable at every moment: a journal beside it.

What a change makes the file longer by is written first; without what points to it, nobody reads
it.  What is written over is written into the journal before, and the journal goes when it is done.
A process that is killed in between leaves a journal that is whole, by its sum, or was not needed:
readers lay it over the file, and the next writer into it.
"""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

from drystone.io.results.laidover import LaidOver, Pieces, put_all

_MARK = b"drystone journal 1\n"
_HEAD = struct.Struct("<qq")  # length of the file, number of pieces
_PIECE = struct.Struct("<qq")  # place, number of bytes
_SUM = struct.Struct("<I")


def journal_of(path: Path) -> Path:
    """Where the journal of a file is."""
    return path.with_name(f".{path.name}.journal")


def written(
    path: Path, length: int, pieces: Pieces, sync: Callable[[int], None] = os.fsync
) -> Path:
    """Write the journal of a file that is to be so long; raises `OSError`, and leaves none then."""
    journal = journal_of(path)
    parts = [_MARK, _HEAD.pack(length, len(pieces))]
    for place, data in pieces:
        parts += [_PIECE.pack(place, len(data)), data]
    content = b"".join(parts)
    try:
        with journal.open("wb", buffering=0) as file:
            put_all(file, content + _SUM.pack(zlib.crc32(content)))
            sync(file.fileno())
    except OSError:
        journal.unlink(missing_ok=True)
        raise
    return journal


def pending(path: Path) -> tuple[int, Pieces] | None:
    """Length and pieces of a file's journal; None where there is none that is whole."""
    try:
        content = journal_of(path).read_bytes()
    except OSError:
        return None
    whole = len(content) >= len(_MARK) + _HEAD.size + _SUM.size and content.startswith(_MARK)
    if not whole or zlib.crc32(content[: -_SUM.size]) != _SUM.unpack(content[-_SUM.size :])[0]:
        return None
    at = len(_MARK)
    length, n = _HEAD.unpack_from(content, at)
    at += _HEAD.size
    pieces = []
    for _ in range(n):
        place, size = _PIECE.unpack_from(content, at)
        at += _PIECE.size
        pieces.append((place, content[at : at + size]))
        at += size
    return length, pieces


def recover(path: Path) -> None:
    """Lay the journal that a killed writer has left into its file."""
    found = pending(path)
    if found is not None:
        length, pieces = found
        with path.open("r+b") as file:
            for place, data in pieces:
                file.seek(place)
                file.write(data)
            file.truncate(length)
            file.flush()
            os.fsync(file.fileno())
    journal_of(path).unlink(missing_ok=True)


def overlaid(path: Path, length: int, pieces: Pieces) -> LaidOver:
    """A file to read, with a journal laid over it."""
    disk = io.FileIO(path, "r")
    return LaidOver(disk, min(os.fstat(disk.fileno()).st_size, length), length, pieces)
