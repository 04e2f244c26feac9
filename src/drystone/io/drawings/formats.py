"""Which format a file has, by name or ending, and how it is read."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from drystone.common.ranges import too_many
from drystone.common.registry import RegistryError
from drystone.io.drawings.drawing import Drawing, check_counts, check_places
from drystone.io.drawings.format import Format
from drystone.io.drawings.registry import FORMATS
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable, quoted, suggestion


def format_of(path: Path, name: str | None = None) -> Format:
    """The format of that name, or else the one that a file's ending means; raises `ModelError`."""
    if name is not None:
        if name not in FORMATS:
            mend = suggestion(name, list(FORMATS.names()))
            raise ModelError([f"there is no format {quoted(name)}: {mend}"])
        try:
            return FORMATS[name]
        except RegistryError as error:
            raise ModelError([str(error)]) from None
    formats = [one for _, one in FORMATS.loaded()]
    for one in formats:
        if path.suffix.lower() in one.endings:
            return one
    known = ", ".join(f"{one.endings[0]} ({one.name})" for one in formats)
    raise ModelError(
        [f"the ending {quoted(path.suffix)} belongs to no format: give one, or end it in {known}"]
    )


def read_drawing(path: Path, name: str | None = None, dimension: int | None = None) -> Drawing:
    """What a file holds, names made unique; raises `ModelError` without the file's name in it."""
    kind = format_of(path, name)
    contents = read_bytes(path, "the file")
    if not contents.strip():
        raise ModelError(["is empty: export it anew"])
    try:
        drawing = kind.read(contents, path, dimension).renamed()
    except (ArithmeticError, LookupError, TypeError, ValueError, AttributeError) as error:
        # Readers know what files should hold; what a torn one holds nobody foresees.
        what = printable(" ".join(str(error).split())[:120])
        raise ModelError(
            [f"is no {kind.name} file that can be read ({what}): export it anew"]
        ) from None
    except (MemoryError, RecursionError):
        raise ModelError(["is too large, or nested too deeply, to be read"]) from None
    check_counts(
        sum(len(shape.vertices) for shape in drawing.shapes if not shape.faces),
        sum(len(shape.faces) for shape in drawing.shapes),
    )
    for shape in drawing.shapes:
        if wrong := too_many("faces of one solid", len(shape.faces)):
            raise ModelError([f"{quoted(shape.name)}: {wrong}"])
    if wrong := too_many("blocks", len(drawing.shapes)):
        raise ModelError([wrong])
    check_places(drawing.shapes)
    return replace(drawing, sha256=_digest(contents, path, kind.beside))


def digest_of(path: Path, name: str | None = None) -> str:
    """That of the `Drawing` of a file, which is not taken apart for it; raises `ModelError`."""
    return _digest(read_bytes(path, "the file"), path, format_of(path, name).beside)


def _digest(contents: bytes, path: Path, beside: tuple[str, ...]) -> str:
    """Of all that was read, as 64 hexadecimal digits; of one file that of its bytes."""
    others = [path.with_name(name) for name in beside if path.with_name(name).is_file()]
    found = hashlib.sha256(contents).hexdigest()
    for other in others:
        found = hashlib.sha256(
            (found + _digest(read_bytes(other, "the file"), other, ())).encode()
        ).hexdigest()
    return found
