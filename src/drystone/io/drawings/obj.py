"""Wavefront OBJ: one block for each object, or each group, or each connected surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from drystone.common.ranges import too_many
from drystone.io.drawings.drawing import (
    Drawing,
    Shape,
    check_counts,
    number,
    shapes_of_mesh,
    tidy_name,
    whole,
)
from drystone.io.drawings.format import LAYER, Format
from drystone.model.construction.errors import ModelError


@dataclass
class _Own:
    """Faces under one heading."""

    name: str
    groups: list[str] = field(default_factory=list)
    material: str = ""
    faces: list[tuple[int, ...]] = field(default_factory=list)


def read(contents: bytes) -> Drawing:
    """The blocks of a file; raises `ModelError`."""
    text = contents.decode("utf-8", errors="replace").replace("\\\r\n", " ").replace("\\\n", " ")
    lines = text.splitlines()
    check_counts(*(sum(line.startswith(key) for line in lines) for key in ("v ", "f ")))
    heading = "o" if any(line.split()[:1] == ["o"] for line in lines) else "g"
    vertices: list[tuple[float, ...]] = []
    found = [_Own("")]
    group, material, ignored, n_corners = "", "", set(), 0
    for row, line in enumerate(lines, 1):
        key, *words = line.split("#", 1)[0].split() or [""]
        place = f"line {row}"
        if key == "v":
            if len(words) < 3:
                raise ModelError([f"{place}: a vertex needs three numbers"])
            vertices.append(tuple(number(word, place) for word in words[:3]))
        elif key == "f":
            n_corners += len(words)
            if wrong := too_many("corners of faces", n_corners):
                raise ModelError([wrong])
            face = tuple(_row(word, len(vertices), place) for word in words)
            if len(face) < 3:
                raise ModelError([f"{place}: a face needs three vertices"])
            own = found[-1]
            own.faces.append(face)
            own.material = own.material or material
            if group and group not in own.groups:
                own.groups.append(group)
        elif key == heading:
            found.append(_Own(tidy_name(" ".join(words))))
            group = "" if key == "o" else group
        elif key == "g":
            group = tidy_name(" ".join(words))
            group = "" if group == "default" else group
        elif key == "usemtl":
            material = tidy_name(" ".join(words))
            material = "" if material == "default" else material
        elif key in ("curv", "curv2", "surf", "cstype"):
            ignored.add("free curves and surfaces")
    notes = tuple(f"{what} were left out: export meshes" for what in sorted(ignored))
    place_of = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    filled = [one for one in found if one.faces]
    if not filled:
        raise ModelError(["holds no faces: export the blocks as closed surfaces"])
    if len(filled) == 1 and not filled[0].name:
        shapes = shapes_of_mesh(place_of, filled[0].faces, layer=filled[0].material)
    else:
        shapes = [_shape(one, k, place_of) for k, one in enumerate(_together(filled), 1)]
    return Drawing(shapes=tuple(shapes), notes=notes)


def _together(found: Sequence[_Own]) -> list[_Own]:
    """Headings that come again under the same name go on where they were."""
    by_name: dict[str, _Own] = {}
    for own in found:
        if own.name in by_name and own.name:
            first = by_name[own.name]
            first.faces += own.faces
            first.groups += [name for name in own.groups if name not in first.groups]
        else:
            by_name[own.name or f"\0{len(by_name)}"] = own
    return list(by_name.values())


def _shape(own: _Own, k: int, vertices: np.ndarray) -> Shape:
    used = sorted({i for face in own.faces for i in face})
    row = {i: n for n, i in enumerate(used)}
    return Shape(
        name=own.name or f"b{k}",
        vertices=vertices[used],
        faces=tuple(tuple(row[i] for i in face) for face in own.faces),
        layer=own.material,
        groups=tuple(own.groups),
    )


def _row(word: str, n: int, place: str) -> int:
    """Row of a vertex that a face names, from 1 on or from the last backwards."""
    k = whole(word.split("/", 1)[0], place)
    row = k - 1 if k > 0 else n + k
    if k == 0 or not 0 <= row < n:
        raise ModelError(
            [f"{place}: there is no vertex {k} up to here, only {n}: the file is torn or mixed up"]
        )
    return row


def write(shapes: Sequence[Shape], title: str) -> str:
    """The text of a file: an object and a material for each shape."""
    lines = [f"# {tidy_name(title)}", "# in metres, z up"]
    first = 1
    layered = any(shape.layer for shape in shapes)
    for shape in shapes:
        lines += [f"o {tidy_name(shape.name)}"]
        lines += [f"usemtl {tidy_name(shape.layer) or 'default'}"] * layered
        lines += ["v " + " ".join(map(repr, row)) for row in shape.vertices.tolist()]
        lines += ["f " + " ".join(str(first + i) for i in face) for face in shape.faces]
        first += len(shape.vertices)
    return "\n".join(lines) + "\n"


FORMAT = Format(
    name="obj",
    endings=(".obj",),
    read=lambda data, *_: read(data),
    write=lambda shapes, title, _: write(shapes, title),
    supports=LAYER,  # of the material "support", as OBJ has no other mark
)
