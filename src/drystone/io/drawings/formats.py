"""Which formats there are, by name and ending, and how a file of each is read."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from drystone.common.ranges import too_many
from drystone.io.drawings import bodies, compas, dxf, ifc, obj, ply, stl
from drystone.io.drawings.drawing import Drawing, check_counts, check_places
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable, quoted, suggestion

#: Reads a file: its contents, its path, and the dimension of the model, if it is known.
Read = Callable[[bytes, Path, int | None], Drawing]


@dataclass(frozen=True, kw_only=True)
class Format:
    """A kind of file."""

    name: str
    endings: tuple[str, ...]
    read: Read
    beside: tuple[str, ...] = ()  # names of files that are read with it where they are there


FORMATS = {
    one.name: one
    for one in (
        Format(name="obj", endings=(".obj",), read=lambda data, *_: obj.read(data)),
        Format(name="ply", endings=(".ply",), read=lambda data, *_: ply.read(data)),
        Format(name="stl", endings=(".stl",), read=lambda data, *_: stl.read(data)),
        Format(name="compas", endings=(".json",), read=lambda data, *_: compas.read(data)),
        Format(name="dxf", endings=(".dxf",), read=lambda data, _, n: dxf.read(data, n)),
        Format(
            name="bodies",
            endings=(".dat",),
            read=lambda data, path, _: bodies.read(data, path),
            beside=(bodies.DRIVEN, bodies.STATE),
        ),
        Format(name="ifc", endings=(".ifc",), read=lambda data, *_: ifc.read(data)),
    )
}


def format_of(path: Path, name: str | None = None) -> Format:
    """The format of that name, or else the one that a file's ending means; raises `ModelError`."""
    if name is not None:
        if name not in FORMATS:
            raise ModelError(
                [f"there is no format {quoted(name)}: {suggestion(name, list(FORMATS))}"]
            )
        return FORMATS[name]
    for one in FORMATS.values():
        if path.suffix.lower() in one.endings:
            return one
    known = ", ".join(f"{one.endings[0]} ({one.name})" for one in FORMATS.values())
    raise ModelError(
        [f"the ending {quoted(path.suffix)} means no format: give one, or end it in {known}"]
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


def _digest(contents: bytes, path: Path, beside: tuple[str, ...]) -> str:
    """Of all that was read, as 64 hexadecimal digits; of one file that of its bytes."""
    others = [path.with_name(name) for name in beside if path.with_name(name).is_file()]
    found = hashlib.sha256(contents).hexdigest()
    for other in others:
        found = hashlib.sha256(
            (found + _digest(read_bytes(other, "the file"), other, ())).encode()
        ).hexdigest()
    return found
