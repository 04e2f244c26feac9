"""Shapes of blocks in a file: which keys go together, and which solids and outlines they mean."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry import GeometryError
from drystone.geometry.plane import polygon
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Faces, Part
from drystone.io.modelfile.schema import BlockSection, ShapeSection
from drystone.io.modelfile.sentences import place_of

#: Keys that say what shape a block has: one of them each.
SHAPES = {2: ("vertices", "parts"), 3: ("vertices", "box", "outline", "parts")}
#: Keys that only make sense beside another one.
BESIDE = {"faces": "vertices", "depth": "outline"}
_MISSING = {
    2: "[x, y] pairs in metres around the block",
    3: "[x, y, z] in metres of its corners; or give a box, an outline with its depth, or parts",
}


class ShapeError(ValueError):
    """A shape that cannot be; `key` is what gives it, and what of it the problem is about."""

    def __init__(self, key: str, problem: str) -> None:
        super().__init__(problem)
        self.key = key


def shape_problems(data: dict[str, Any], dimension: int | None) -> list[str]:
    """Sentences on blocks of a file that give no shape, or two, or half of one.

    None where the file gives no ``dimension`` that there is.
    """
    blocks = data.get("block")
    if dimension is None or not isinstance(blocks, list):
        return []
    found, known = [], SHAPES[dimension]
    for i, block in enumerate(blocks):
        if not isinstance(block, dict):
            continue
        found += _problems(block, ("block", i), data, known)
        parts = block.get("parts")
        for k, part in enumerate(parts if isinstance(parts, list) else ()):
            if isinstance(part, dict):
                found += _problems(part, ("block", i, "parts", k), data, known[:-1])
    return found


def _problems(
    table: dict[str, Any], keys: tuple[str | int, ...], data: dict[str, Any], known: Sequence[str]
) -> list[str]:
    place = place_of(keys, data)
    given = [key for key in known if key in table]
    found = []
    if not given:
        found.append(f"{place}: vertices is missing: add it ({_MISSING[data['dimension']]})")
    if len(given) > 1:
        found.append(f"{place}: has both {given[0]} and {given[1]}: leave one of them out")
    for key, other in BESIDE.items():
        if key in table and other not in table and other in known:
            found.append(f"{place}: has {key}, but no {other}: give both, or neither")
    if "outline" in given and "depth" not in table:
        found.append(f"{place}: depth is missing: add it ([y0, y1] in metres, beside the outline)")
    return found


def shape_of(section: BlockSection) -> dict[str, Any]:
    """Vertices, faces and parts of a block, as `Block` takes them; raises `ShapeError`."""
    if section.parts is None:
        vertices, faces = _solid_of(section, "")
        return {"vertices": vertices, "faces": faces}
    parts = []
    for k, part in enumerate(section.parts):
        parts.append(Part(*_solid_of(part, f"parts[{k + 1}].")))
    return {"vertices": np.vstack([part.vertices for part in parts]), "parts": tuple(parts)}


def _solid_of(section: ShapeSection, place: str) -> tuple[Array, Faces]:
    """Vertices and faces of one shape; no faces in the plane, and where it is a hull."""
    if section.box is not None:
        try:
            return solid.box(section.box)
        except GeometryError as error:
            raise ShapeError(f"{place}box", str(error)) from None
    if section.outline is not None and section.depth is not None:
        outline = np.array(section.outline, dtype=np.float64).reshape(-1, 2)
        try:
            if not polygon.is_clockwise(outline):
                return solid.extruded(outline, section.depth)
            # As drawn, inside out: whoever puts the model together turns it round, and says so.
            vertices, faces = solid.extruded(outline[::-1], section.depth)
            return vertices, tuple(face[::-1] for face in faces)
        except GeometryError as error:
            raise ShapeError(f"{place}outline", str(error)) from None
    given = section.vertices or []
    width = len(given[0]) if given else 2
    vertices = np.array(given, dtype=np.float64).reshape(-1, width)
    return vertices, tuple(tuple(face) for face in section.faces or ())
