"""Meshes, polyhedra and boxes of COMPAS as vertices and faces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry import GeometryError
from drystone.geometry.space.solid import Faces, box
from drystone.io.drawings.drawing import check_faces
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable

#: Sides of a box along the axes of its frame.
_SIDES = ("xsize", "ysize", "zsize")


def is_shape(table: Mapping[str, Any]) -> bool:
    """Whether a table has vertices and faces, or is a box."""
    halfedges = isinstance(table.get("vertex"), dict) and isinstance(table.get("face"), dict)
    listed = isinstance(table.get("vertices"), list) and isinstance(table.get("faces"), list)
    return bool((halfedges and table["face"]) or (listed and table["faces"]) or _is_box(table))


def _is_box(table: Mapping[str, Any]) -> bool:
    return all(side in table for side in _SIDES) and isinstance(table.get("frame"), dict)


def vertices_and_faces(table: Mapping[str, Any], place: str) -> tuple[Array, Faces]:
    """Vertices (n, 3), in units of the file, and faces of what `is_shape`.

    Raises `ModelError`, with ``place`` before the sentence.
    """
    return _box(table, place) if _is_box(table) else _mesh(table, place)


def _mesh(mesh: Mapping[str, Any], place: str) -> tuple[Array, Faces]:
    """Of a mesh in either layout."""
    if isinstance(mesh.get("vertex"), dict):
        defaults = mesh.get("default_vertex_attributes") or mesh.get("dva") or {}
        row = {str(key): k for k, key in enumerate(mesh["vertex"])}
        vertices = [
            [_coordinate(own, axis, defaults, place) for axis in "xyz"]
            for own in mesh["vertex"].values()
        ]
        loops = list(mesh["face"].values())
    else:
        row = {str(k): k for k in range(len(mesh["vertices"]))}
        vertices = [_point(own, "a vertex", place) for own in mesh["vertices"]]
        loops = mesh["faces"]
    faces = []
    for loop in loops:
        if isinstance(loop, dict):  # half-edges of the oldest versions: each vertex's next one
            loop = _around(loop)
        if not isinstance(loop, list):
            raise ModelError([f"{place}a face is no list of vertices: the file is torn"])
        unknown = [key for key in loop if str(key) not in row]
        if unknown:
            name = printable(str(unknown[0])[:20])
            raise ModelError([f"{place}a face names vertex {name}, which is not there"])
        face = tuple(row[str(key)] for key in loop)
        if len(face) > 1 and face[0] == face[-1]:
            face = face[:-1]
        if len(face) > 2:
            faces.append(face)
    check_faces(len(vertices), faces, place)
    return np.array(vertices, dtype=np.float64).reshape(-1, 3), tuple(faces)


def _around(following: Mapping[str, Any]) -> list[Any]:
    start = next(iter(following), None)
    loop, at = [start], following.get(start) if start is not None else None
    while at is not None and str(at) != str(start) and len(loop) <= len(following):
        loop.append(at)
        at = following.get(str(at))
    return loop


def _coordinate(vertex: Any, axis: str, defaults: Any, place: str) -> float:
    value = vertex.get(axis) if isinstance(vertex, dict) else None
    if value is None and isinstance(defaults, dict):
        value = defaults.get(axis)
    return _finite(value, f"{place}a vertex has no finite x, y and z")


def _point(given: Any, what: str, place: str) -> list[float]:
    """Three numbers in a row."""
    numbers = given if isinstance(given, list) else [None]
    found = [_finite(x, f"{place}{what} has no finite x, y and z") for x in numbers]
    if len(found) != 3:
        raise ModelError([f"{place}{what} needs three numbers: the file is torn"])
    return found


def _finite(value: Any, wrong: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e12:
        raise ModelError([f"{wrong}: the file is torn"])
    return float(value)


def _box(table: Mapping[str, Any], place: str) -> tuple[Array, Faces]:
    """Of a box about the origin of its frame."""
    half = 0.5 * np.array(
        [_finite(table[side], f"{place}a side of its box is no finite number") for side in _SIDES]
    )
    try:
        vertices, faces = box(np.array([-half, half]))
    except GeometryError:
        raise ModelError([f"{place}its box has a side that is not above zero: mend it"]) from None
    frame = table["frame"].get("data", table["frame"])
    origin, x, y = (
        np.array(_point(_told(frame, key), f"the {key} of its frame", place))
        for key in ("point", "xaxis", "yaxis")
    )
    normal = np.cross(x, y)
    if not normal.any():
        raise ModelError([f"{place}the axes of its frame are in one line: the file is torn"])
    # As COMPAS makes a frame of two directions: the first, and the second square to it.
    axes = np.array([x, np.cross(normal, x), normal])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return vertices @ axes + origin, faces


def _told(frame: Any, key: str) -> Any:
    """A point or direction of a frame, which some versions wrap."""
    value = frame.get(key) if isinstance(frame, dict) else None
    return value.get("data") if isinstance(value, dict) else value
