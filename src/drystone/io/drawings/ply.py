"""PLY, text and binary: one block for each connected surface."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from drystone.common.ranges import too_many
from drystone.io.drawings.drawing import (
    MOST,
    Drawing,
    Shape,
    check_counts,
    check_faces,
    number,
    shapes_of_mesh,
    text_of,
    tidy_name,
    whole,
)
from drystone.io.drawings.format import LOST, Format
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass
class _Element:
    """Rows of one kind, with their columns: a name, a type, and that of the length of a list."""

    name: str
    count: int
    columns: list[tuple[str, str, str | None]] = field(default_factory=list)


def read(contents: bytes) -> Drawing:
    """The blocks of a file; raises `ModelError`."""
    end = re.search(rb"^end_header[ \t\r]*(\n|\Z)", contents, re.MULTILINE)
    if not contents.startswith(b"ply") or not end:
        raise ModelError(["is no PLY file: its first line is not ply, or its header has no end"])
    head, body = contents[: end.start()], contents[end.end() :]
    order, elements = _header(head.decode("ascii", errors="replace"))
    rows = _text_rows(body, elements) if not order else _binary_rows(body, elements, order)
    vertices: list[list[float]] = []
    faces: list[tuple[int, ...]] = []
    blocks: list[int] = []
    for element, values in rows:
        if element.name == "vertex":
            try:
                vertices.append([float(values[axis]) for axis in "xyz"])  # type: ignore[arg-type]
            except KeyError:
                raise ModelError(["its vertices have no x, y and z"]) from None
        elif element.name == "face":
            loop = values.get("vertex_indices", values.get("vertex_index"))
            if not isinstance(loop, list):
                raise ModelError(["its faces have no vertex_indices"])
            if len(loop) > 2:
                faces.append(tuple(map(int, loop)))
                block = values.get("block", -1)
                blocks.append(int(block) if isinstance(block, int | float) else -1)
    place = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    if not np.isfinite(place).all():
        raise ModelError(["every coordinate must be a finite number: the file is torn"])
    check_faces(len(place), faces)
    if blocks and min(blocks) >= 0:
        return Drawing(shapes=tuple(_by_block(place, faces, blocks, _names(head))))
    return Drawing(shapes=tuple(shapes_of_mesh(place, faces)))


def _names(head: bytes) -> list[str]:
    """Names of blocks, from comments that `write` makes."""
    lines = text_of(head).splitlines()
    return [tidy_name(line[14:]) for line in lines if line.startswith("comment block ")]


def _by_block(
    vertices: np.ndarray, faces: list[tuple[int, ...]], blocks: list[int], names: list[str]
) -> list[Shape]:
    own: dict[int, list[tuple[int, ...]]] = {}
    for k, face in zip(blocks, faces, strict=True):
        own.setdefault(k, []).append(face)
    return [
        Shape(
            name=names[k] if k < len(names) and names[k] else f"b{k + 1}",
            vertices=vertices,
            faces=tuple(loops),
        )
        for k, loops in own.items()
    ]


def _header(text: str) -> tuple[str, list[_Element]]:
    order, elements = None, []
    for line in text.splitlines()[1:]:
        key, *words = line.split() or [""]
        if key == "format" and words:
            if words[0] not in _ORDERS:
                raise ModelError([f"its format {quoted(words[0])} is none of PLY"])
            order = _ORDERS[words[0]]
        elif key == "element" and len(words) == 2:
            count = whole(words[1], "header")
            check_counts(*(count if words[0] == what else 0 for what in ("vertex", "face")))
            if not 0 <= count <= MOST:
                raise ModelError([f"says {count} rows of {quoted(words[0])}: the file is torn"])
            elements.append(_Element(words[0], count))
        elif key == "property" and elements:
            kinds = words[1:3] if words[:1] == ["list"] else words[:1]
            if not kinds or any(kind not in _TYPES for kind in kinds) or len(words) < 2:
                raise ModelError([f"header: {quoted(line)} is no property that PLY has"])
            size = _TYPES[kinds[0]] if len(kinds) == 2 else None
            elements[-1].columns.append((words[-1], _TYPES[kinds[-1]], size))
    if wrong := too_many("rows of elements", sum(element.count for element in elements)):
        raise ModelError([wrong])
    if order is None:
        raise ModelError(["its header says no format"])
    return order, elements


_Row = tuple[_Element, dict[str, float | list[float]]]


def _text_rows(body: bytes, elements: Sequence[_Element]) -> Iterator[_Row]:
    words = iter(body.decode("ascii", errors="replace").split())

    def following(place: str) -> float:
        word = next(words, None)
        if word is None:
            raise ModelError([f"ends in {place}: the file is torn"])
        return number(word, place)

    for element in elements:
        for k in range(element.count):
            place = f"{element.name} {k + 1}"
            values: dict[str, float | list[float]] = {}
            for name, _, size in element.columns:
                if size is None:
                    values[name] = following(place)
                else:
                    n = following(place)
                    if not 0 <= n <= MOST:
                        raise ModelError([f"{place}: a list of {n:g} entries: the file is torn"])
                    values[name] = [following(place) for _ in range(int(n))]
            yield element, values


def _binary_rows(body: bytes, elements: Sequence[_Element], order: str) -> Iterator[_Row]:
    at = 0

    def take(kind: str, n: int, place: str) -> list[float]:
        nonlocal at
        dtype = np.dtype(order + kind)
        if n < 0 or at + n * dtype.itemsize > len(body):
            raise ModelError([f"ends in {place}: the file is torn"])
        values = np.frombuffer(body, dtype, n, at).tolist()
        at += n * dtype.itemsize
        return list(values)

    for element in elements:
        for k in range(element.count):
            place = f"{element.name} {k + 1}"
            values: dict[str, float | list[float]] = {}
            for name, kind, size in element.columns:
                if size is None:
                    (values[name],) = take(kind, 1, place)
                else:
                    (n,) = take(size, 1, place)
                    values[name] = take(kind, int(n), place)
            yield element, values


def write(shapes: Sequence[Shape], title: str) -> str:
    """The text of a file; each face says which block it is of."""
    vertices = [row for shape in shapes for row in shape.vertices.tolist()]
    first = np.cumsum([0, *(len(shape.vertices) for shape in shapes)]).tolist()
    faces = [
        f"{len(face)} {' '.join(str(first[k] + i) for i in face)} {k}"
        for k, shape in enumerate(shapes)
        for face in shape.faces
    ]
    return "\n".join(
        [
            "ply",
            "format ascii 1.0",
            f"comment {tidy_name(title)}",
            "comment in metres, z up",
            *(f"comment block {tidy_name(shape.name)}" for shape in shapes),
            f"element vertex {len(vertices)}",
            *(f"property double {axis}" for axis in "xyz"),
            f"element face {len(faces)}",
            "property list int int vertex_indices",
            "property int block",
            "end_header",
            *(" ".join(map(repr, row)) for row in vertices),
            *faces,
            "",
        ]
    )


FORMAT = Format(
    name="ply",
    endings=(".ply",),
    read=lambda data, *_: read(data),
    write=lambda shapes, title, _: write(shapes, title),
    supports=LOST,
)
