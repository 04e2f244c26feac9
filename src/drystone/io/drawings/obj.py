"""Wavefront OBJ: one block for each object, or each group, or each connected surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from drystone.common.ranges import too_many
from drystone.common.tolerances import SAME_POINT
from drystone.geometry.links import components
from drystone.geometry.space.meshes import at_one_place, edges_of, faces_at_edges
from drystone.geometry.space.solid import size_of
from drystone.io.drawings.drawing import (
    Drawing,
    Shape,
    check_counts,
    number,
    shapes_of_mesh,
    text_of,
    tidy_name,
    whole,
)
from drystone.io.drawings.format import LAYER, Format
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import listed


@dataclass
class _Own:
    """Faces under one heading."""

    name: str
    groups: list[str] = field(default_factory=list)
    faces: list[tuple[int, ...]] = field(default_factory=list)
    materials: list[str] = field(default_factory=list)  # of each face

    @property
    def named(self) -> list[str]:
        """Its materials, once each, in the order of its faces."""
        return [name for name in dict.fromkeys(self.materials) if name]


def read(contents: bytes) -> Drawing:
    """The blocks of a file; raises `ModelError`."""
    text = text_of(contents).replace("\\\r\n", " ").replace("\\\n", " ")
    lines = text.splitlines()
    check_counts(*(sum(line.startswith(key) for line in lines) for key in ("v ", "f ")))
    heading = "o" if any(line.split()[:1] == ["o"] for line in lines) else "g"
    vertices: list[tuple[float, ...]] = []
    found = [_Own("")]
    group, material, ignored, n_corners = "", "", set(), 0
    for row, line in enumerate(lines, 1):
        key, *words = _without_comment(line).split() or [""]
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
            own.materials.append(material)
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
    headed = len(filled) > 1 or bool(filled[0].name)
    filled = [piece for own in _together(filled) for piece in _by_material(own, place_of)]
    if mixed := [own.name for own in filled if len(own.named) > 1]:
        notes += (
            f"of several materials are faces of {listed(mixed) if headed else 'a surface'}, taken "
            "to be of that of its first face: give each block one",
        )
    if len(filled) == 1 and not headed:
        shapes = shapes_of_mesh(place_of, filled[0].faces, layer=_material(filled[0]))
    else:
        shapes = [_shape(one, k, place_of) for k, one in enumerate(filled, 1)]
    return Drawing(shapes=tuple(shapes), notes=notes)


def _without_comment(line: str) -> str:
    """A line without the comment at its end; in a name # is a letter."""
    named = line.split()[:1] in (["o"], ["g"], ["usemtl"])
    return line if named else line.split("#", 1)[0]


def _together(found: Sequence[_Own]) -> list[_Own]:
    """Headings that come again under the same name go on where they were."""
    by_name: dict[str, _Own] = {}
    for own in found:
        if own.name in by_name and own.name:
            first = by_name[own.name]
            first.faces += own.faces
            first.materials += own.materials
            first.groups += [name for name in own.groups if name not in first.groups]
        else:
            by_name[own.name or f"\0{len(by_name)}"] = own
    return list(by_name.values())


def _by_material(own: _Own, vertices: np.ndarray) -> list[_Own]:
    """An object of several materials as its closed surfaces; those that share edges part where
    the faces of each material close.

    By the numbers of vertices where these make closed surfaces, else by their places; as it is
    where neither does.
    """
    if len(set(own.materials)) == 1:
        return [own]
    places = at_one_place(vertices, SAME_POINT * size_of(vertices))
    for row in (np.arange(len(vertices)), places):
        faces = [tuple(row[list(face)].tolist()) for face in own.faces]
        edges = np.array([edge for face in faces for edge in edges_of(face)])
        part = components(len(vertices), edges[:, 0], edges[:, 1])
        surfaces: dict[int, list[int]] = {}
        for k, face in enumerate(faces):
            surfaces.setdefault(int(part[face[0]]), []).append(k)
        if all(_closed([faces[k] for k in members]) for members in surfaces.values()):
            break
    else:
        return [own]
    found = []
    for members in surfaces.values():
        by: dict[str, list[int]] = {}
        for k in members:
            by.setdefault(own.materials[k], []).append(k)
        alone = all(_closed([faces[k] for k in rows]) for rows in by.values())
        found += list(by.values()) if alone else [members]
    return [
        _Own(
            name=f"{own.name}/{n}" if own.name and len(found) > 1 else own.name,
            groups=own.groups,
            faces=[own.faces[k] for k in rows],
            materials=[own.materials[k] for k in rows],
        )
        for n, rows in enumerate(found, 1)
    ]


def _closed(faces: Sequence[tuple[int, ...]]) -> bool:
    """Whether every edge has an even number of faces."""
    return all(n % 2 == 0 for n in faces_at_edges(faces).values())


def _material(own: _Own) -> str:
    return own.named[0] if own.named else ""


def _shape(own: _Own, k: int, vertices: np.ndarray) -> Shape:
    used = sorted({i for face in own.faces for i in face})
    row = {i: n for n, i in enumerate(used)}
    return Shape(
        name=own.name or f"b{k}",
        vertices=vertices[used],
        faces=tuple(tuple(row[i] for i in face) for face in own.faces),
        layer=_material(own),
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
