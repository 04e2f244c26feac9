"""What a file of another program holds: shapes as they were drawn, and what it says about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from drystone.common.arrays import Array
from drystone.common.ranges import LARGEST, too_many
from drystone.common.tolerances import SAME_POINT
from drystone.geometry.space.meshes import Mesh, faces_at_edges, once, shells
from drystone.geometry.space.solid import Faces
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted

#: Metres of each unit that a file may be drawn in.
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}

#: Layers whose names say what is on them, small letters.
SUPPORT_LAYERS = ("support", "supports")
CONTROL_LAYERS = ("control", "control point")

#: Coordinates beyond which nothing is drawn.
FARTHEST = 1e12
#: Vertices or faces that a drawing has at most.
MOST = LARGEST["vertices"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Shape:
    """One thing drawn, in units of the drawing."""

    name: str
    vertices: Array  # (n, dim)
    faces: Faces = ()  # of space
    layer: str = ""  # or material, where a program has those
    groups: tuple[str, ...] = ()
    support: bool = False  # marked as one in the file
    held: tuple[str, ...] = ()  # along axes of the drawing: what of its motion rollers hold


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawing:
    """All shapes of a file."""

    shapes: tuple[Shape, ...]
    unit: str | None = None  # that the file says or its format has
    up: str | None = None  # "z" or "y" where the format has a convention, "" in the plane
    control: tuple[float, ...] | None = None  # the control point, in units of the drawing
    notes: tuple[str, ...] = ()  # sentences on what was left out
    extra: dict[str, str] = field(default_factory=dict)
    sha256: str = ""  # of what was read

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self.shapes[0].vertices.shape[1]) if self.shapes else 3

    def renamed(self) -> Drawing:
        """The drawing with names that occur twice numbered."""
        taken: set[str] = {shape.name for shape in self.shapes}
        seen: set[str] = set()
        shapes = []
        for shape in self.shapes:
            name, k = shape.name, 1
            while name in seen:
                k += 1
                name = f"{shape.name} ({k})"
                if name in taken and name not in seen:
                    continue
            seen.add(name)
            shapes.append(shape if name == shape.name else replace(shape, name=name))
        return replace(self, shapes=tuple(shapes))


def shapes_of_mesh(
    vertices: Array, faces: Sequence[Sequence[int]], *, layer: str = ""
) -> list[Shape]:
    """A shape for each connected surface of a mesh, "b1", "b2", ...

    By the numbers of its vertices where these make closed surfaces, else by their places.
    """
    from drystone.geometry.space.meshes import welded
    from drystone.geometry.space.solid import size_of

    check_faces(len(vertices), faces)
    mesh = Mesh.of_used(vertices, [tuple(face) for face in faces])
    if not mesh.faces:
        raise ModelError(["holds no faces: export the blocks as closed surfaces"])
    found = shells(mesh)
    if any(n != 2 for own in found for n in faces_at_edges(once(own)[0].faces).values()):
        if not np.isfinite(mesh.vertices).all():
            raise ModelError(["every coordinate must be a finite number"])
        mesh, _ = welded(mesh, SAME_POINT * size_of(mesh.vertices))
        if not mesh.faces:
            raise ModelError(["all its faces are points or lines: export closed surfaces"])
        found = shells(mesh)
    return [
        Shape(name=f"b{k}", vertices=own.vertices, faces=own.faces, layer=layer)
        for k, own in enumerate(found, 1)
    ]


def check_faces(n: int, faces: Sequence[Sequence[int]], place: str = "") -> None:
    """Raise `ModelError` where a face names a vertex that is not among ``n``, or faces have more
    corners in all than are read."""
    if wrong := too_many("corners of faces", sum(map(len, faces))):
        raise ModelError([place + wrong])
    for k, face in enumerate(faces, 1):
        for i in face:
            if not 0 <= i < n:
                raise ModelError(
                    [f"{place}face {k} names vertex {i + 1}, and there are {n}: the file is torn"]
                )


def check_counts(vertices: int, faces: int) -> None:
    """Raise `ModelError` where a drawing has more of them than are read; before they are."""
    for what, count in (("vertices", vertices), ("faces", faces)):
        if wrong := too_many(what, count):
            raise ModelError([wrong])


def check_places(shapes: Sequence[Shape]) -> None:
    """Raise `ModelError` where a coordinate is no place in a drawing, but was read."""
    for shape in shapes:
        if not np.all(np.abs(shape.vertices) <= FARTHEST):
            raise ModelError(
                [f"{quoted(shape.name)}: has a coordinate that is no place in a drawing: mend it"]
            )


def number(text: str, place: str) -> float:
    """A finite number of a text file; raises `ModelError`."""
    try:
        value = float(text.replace("D", "E").replace("d", "e"))
    except ValueError:
        raise ModelError([f"{place}: {quoted(text)} is no number: mend the file"]) from None
    if not np.isfinite(value) or abs(value) > FARTHEST:
        raise ModelError([f"{place}: {quoted(text)} is no place in a drawing: mend the file"])
    return value


def whole(text: str, place: str) -> int:
    """A whole number of a text file; raises `ModelError`."""
    try:
        return int(text)
    except ValueError:
        raise ModelError([f"{place}: {quoted(text)} is no whole number: mend the file"]) from None


def text_of(contents: bytes) -> str:
    """The text of a file in UTF-8, or of one that older programs wrote in Latin-1."""
    try:
        return contents.decode("utf-8-sig")
    except UnicodeDecodeError:
        return contents.decode("latin-1")


def tidy_name(text: object) -> str:
    """A name of printable letters on one line, at most 80."""
    return "".join(c if c.isprintable() else " " for c in str(text)).strip()[:80].strip()
