"""What a format of drawings is: the record that its file declares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from drystone.io.drawings.drawing import Drawing, Shape

#: Reads a file: its contents, its path, and the dimension of the model, if it is known.
Read = Callable[[bytes, Path, int | None], Drawing]
#: The text of a file: shapes, a title, and the place of the control point [m].
Write = Callable[[Sequence[Shape], str, Sequence[float]], str]

#: What becomes of supports where a format is written: they are marked as such, or lie on a layer of
#: that name, or nothing tells them.
MARKED, LAYER, LOST = "marked", "layer", "lost"


@dataclass(frozen=True, kw_only=True)
class Format:
    """A kind of file."""

    name: str
    endings: tuple[str, ...]
    read: Read
    beside: tuple[str, ...] = ()  # names of files that are read with it where they are there
    write: Write | None = None
    in_plane: bool = False  # whether outlines are written as such; else as solids
    supports: str = MARKED
