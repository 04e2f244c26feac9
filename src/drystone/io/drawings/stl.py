"""STL, text and binary: one block for each named solid, or each connected surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.geometry.space.flatness import triangles
from drystone.io.drawings.drawing import (
    Drawing,
    Shape,
    check_counts,
    number,
    shapes_of_mesh,
    text_of,
    tidy_name,
)
from drystone.io.drawings.format import LOST, Format
from drystone.model.construction.errors import ModelError


def read(contents: bytes) -> Drawing:
    """The blocks of a file; raises `ModelError`."""
    count = int.from_bytes(contents[80:84], "little") if len(contents) >= 84 else -1
    if count >= 0 and len(contents) == 84 + 50 * count:
        check_counts(0, count)
        return _binary(contents, count)
    if contents.lstrip()[:5].lower() == b"solid":
        words = contents.lower()
        check_counts(0, max(words.count(b"endfacet"), words.count(b"vertex") // 3))
        return _text(text_of(contents))
    if count < 0:
        raise ModelError(["is too short for an STL file: export it anew"])
    raise ModelError(
        [
            f"says {count} triangles, which are {84 + 50 * count} bytes, and has {len(contents)}: "
            "it is torn, or no STL file"
        ]
    )


def _binary(contents: bytes, count: int) -> Drawing:
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    corners = np.frombuffer(contents, row, count, 84)["corners"].astype(np.float64)
    if not np.isfinite(corners).all():
        raise ModelError(["every coordinate must be a finite number: the file is torn"])
    return Drawing(shapes=tuple(_shapes("", corners.reshape(-1, 3))))


def _text(text: str) -> Drawing:
    solids: list[tuple[str, list[tuple[float, ...]]]] = []
    for row, line in enumerate(text.splitlines(), 1):
        key, *words = line.split() or [""]
        place = f"line {row}"
        if key.lower() == "solid":
            solids.append((tidy_name(" ".join(words)), []))
        elif key.lower() == "vertex":
            if not solids or len(words) != 3:
                raise ModelError([f"{place}: a vertex needs three numbers inside of a solid"])
            solids[-1][1].append(tuple(number(word, place) for word in words))
        elif key.lower() == "endfacet" and solids and len(solids[-1][1]) % 3:
            raise ModelError([f"{place}: a facet needs three vertices"])
    shapes = []
    for name, corners in solids:
        if len(corners) % 3:
            raise ModelError(["a facet needs three vertices: the file is torn"])
        if corners:
            shapes += _shapes(name if len(solids) > 1 else "", np.array(corners))
    if not shapes:
        raise ModelError(["holds no triangles: export the blocks as closed surfaces"])
    return Drawing(shapes=tuple(shapes))


def _shapes(name: str, corners: np.ndarray) -> list[Shape]:
    faces = [tuple(face) for face in np.arange(len(corners)).reshape(-1, 3).tolist()]
    if name:
        return [Shape(name=name, vertices=corners, faces=tuple(faces))]
    return shapes_of_mesh(corners, faces)


def write(shapes: Sequence[Shape], title: str) -> str:
    """The text of a file: a solid for each shape, its faces in triangles."""
    lines = []
    for shape in shapes:
        name = tidy_name(shape.name)
        lines.append(f"solid {name}")
        for face in shape.faces:
            for a, b, c in triangles(shape.vertices, face):
                p = shape.vertices[[a, b, c]]
                normal = np.cross(p[1] - p[0], p[2] - p[0])
                length = float(np.sqrt(normal @ normal))
                normal = normal / length if length > 0.0 else normal
                lines += [f" facet normal {_numbers(normal)}", "  outer loop"]
                lines += [f"   vertex {_numbers(row)}" for row in p]
                lines += ["  endloop", " endfacet"]
        lines.append(f"endsolid {name}")
    return "\n".join(lines) + "\n"


def _numbers(row: np.ndarray) -> str:
    return " ".join(map(repr, row.tolist()))


FORMAT = Format(
    name="stl",
    endings=(".stl",),
    read=lambda data, *_: read(data),
    write=lambda shapes, title, _: write(shapes, title),
    supports=LOST,
)
