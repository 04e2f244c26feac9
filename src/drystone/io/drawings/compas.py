"""COMPAS JSON: assemblies and models of compas_assembly, compas_cra, compas_dem and compas_rbe.

Their layouts have changed with every version.  What has not is that a mesh is a table of "vertex"
and "face", or of "vertices" and "faces" for polyhedra, and that a support says "is_support" beside
it.  Meshes are therefore looked for wherever they are, and what holds them tells their names.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from drystone.io.drawings.drawing import Drawing, Shape, check_faces, tidy_name
from drystone.io.drawings.format import Format
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import printable

#: Keys on the way to a mesh that are no names of blocks.
_HOLDERS = {
    "blocks", "block", "data", "geometry", "mesh", "node", "nodes", "graph", "elements", "element",
    "value", "modelgeometry", "_geometry", "shape", "tree", "children", "root", "assembly", "items",
}  # fmt: skip
#: Depth of tables inside each other that no file of theirs has.
DEEPEST = 40

Path = tuple[tuple[Any, Any], ...]  # what holds what, from outside: each holder and its key


def read(contents: bytes) -> Drawing:
    """The blocks of a file; raises `ModelError`."""
    try:
        data = json.loads(contents.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise ModelError(["is not text: save it as JSON in UTF-8"]) from None
    except json.JSONDecodeError as error:
        raise ModelError(
            [f"line {error.lineno}, column {error.colno}: not valid JSON: {error.msg}"]
        ) from None
    except (RecursionError, ValueError):
        raise ModelError(["is no JSON that an assembly has: save it anew"]) from None
    marked = _supports_beside(data)
    shapes: list[Shape] = []
    for path, mesh in _meshes(data, ()):
        name = _name(path, len(shapes))
        place = f'block "{name}": '
        vertices, faces = _vertices_and_faces(mesh, place)
        vertices = _transformed(vertices, path, place)
        shapes.append(
            Shape(
                name=name,
                vertices=vertices,
                faces=faces,
                support=name in marked or any(_says_support(holder) for holder, _ in path),
            )
        )
    if not shapes:
        raise ModelError(["holds no meshes: save the assembly with its blocks"])
    return Drawing(shapes=tuple(shapes), up="z")


def _meshes(data: Any, path: Path) -> Iterator[tuple[Path, Mapping[str, Any]]]:
    """Meshes and polyhedra, each with what holds it."""
    if len(path) > DEEPEST:
        return
    if isinstance(data, dict):
        if _is_mesh(data):
            yield (*path, (data, None)), data
            return
        for key, value in data.items():
            if isinstance(value, dict | list):
                yield from _meshes(value, (*path, (data, key)))
    elif isinstance(data, list) and data and isinstance(data[0], dict | list):
        for k, value in enumerate(data):
            if isinstance(value, dict | list):
                yield from _meshes(value, (*path, (data, k)))


def _is_mesh(data: Mapping[str, Any]) -> bool:
    halfedges = isinstance(data.get("vertex"), dict) and isinstance(data.get("face"), dict)
    listed = isinstance(data.get("vertices"), list) and isinstance(data.get("faces"), list)
    return bool((halfedges and data["face"]) or (listed and data["faces"]))


def _vertices_and_faces(
    mesh: Mapping[str, Any], place: str
) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    """Vertices (n, 3) and faces of a mesh in either layout."""
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
        vertices = [
            [_finite(x, place) for x in (own if isinstance(own, list) else [None])]
            for own in mesh["vertices"]
        ]
        if any(len(own) != 3 for own in vertices):
            raise ModelError([f"{place}a vertex needs three numbers: the file is torn"])
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
    return _finite(value, place)


def _finite(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e12:
        raise ModelError([f"{place}a vertex has no finite x, y and z: the file is torn"])
    return float(value)


def _name(path: Path, count: int) -> str:
    """The nearest key that is a name; of lists the element's own name, or its number."""
    for holder, key in reversed(path):
        if key is None or (isinstance(key, str) and key in _HOLDERS):
            continue
        if isinstance(key, int):
            element = holder[key]
            return tidy_name(_own_name(element) or f"b{key + 1}")
        return tidy_name(key) or f"b{count + 1}"
    return f"b{count + 1}"


def _own_name(element: Any) -> str:
    """What an element calls itself."""
    for table in _with_data(element):
        for key in ("name", "graphnode"):
            value = table.get(key)
            if isinstance(value, str | int) and not isinstance(value, bool) and str(value).strip():
                return str(value)
    return ""


def _with_data(table: Any) -> Iterator[Mapping[str, Any]]:
    """A table, its data and its attributes, as far as it has them."""
    if isinstance(table, dict):
        yield table
        for key in ("data", "attributes"):
            if isinstance(table.get(key), dict):
                yield from _with_data(table[key])


def _says_support(holder: Any) -> bool:
    if not isinstance(holder, dict):
        return False
    attributes = holder.get("attributes")
    own = (holder, attributes if isinstance(attributes, dict) else {})
    return any(table.get("is_support") is True for table in own)


def _supports_beside(data: Any) -> set[str]:
    """Names of supports where a table beside the blocks says them, as compas_rbe does."""
    found = set()
    assembly = data.get("assembly") if isinstance(data, dict) else None
    vertices = assembly.get("vertex") if isinstance(assembly, dict) else None
    for key, own in vertices.items() if isinstance(vertices, dict) else ():
        if isinstance(own, dict) and own.get("is_support") is True:
            found.add(tidy_name(key))
    return found


def _transformed(vertices: np.ndarray, path: Path, place: str) -> np.ndarray:
    """Vertices where the transformations of what holds them put them."""
    for holder, _ in reversed(path):
        own = holder.get("transformation") if isinstance(holder, dict) else None
        inner = own.get("data", own) if isinstance(own, dict) else None
        matrix = inner.get("matrix") if isinstance(inner, dict) else None
        if matrix is None:
            continue
        try:
            rotation = np.array(matrix, dtype=np.float64)
        except (TypeError, ValueError):
            rotation = np.zeros(0)
        if rotation.shape != (4, 4) or not np.isfinite(rotation).all():
            raise ModelError(
                [f"{place}its transformation is no matrix of 4 by 4: the file is torn"]
            )
        vertices = vertices @ rotation[:3, :3].T + rotation[:3, 3]
    return vertices


def write(shapes: Sequence[Shape], title: str) -> str:
    """The text of a file in the layout of compas_assembly 0.4 and later."""
    nodes = {
        tidy_name(shape.name): {
            "block": {
                "dtype": "compas_assembly.datastructures/Block",
                "data": {
                    "attributes": {"name": tidy_name(shape.name)},
                    "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0},
                    "default_edge_attributes": {},
                    "default_face_attributes": {},
                    "vertex": {
                        str(k): dict(zip("xyz", row, strict=True))
                        for k, row in enumerate(shape.vertices.tolist())
                    },
                    "face": {str(k): list(face) for k, face in enumerate(shape.faces)},
                    "facedata": {},
                    "edgedata": {},
                    "max_vertex": len(shape.vertices) - 1,
                    "max_face": len(shape.faces) - 1,
                },
            },
            "is_support": bool(shape.support),
        }
        for shape in shapes
    }
    graph = {
        "attributes": {"name": "Graph"},
        "default_node_attributes": {"block": None, "is_support": False},
        "default_edge_attributes": {"interfaces": None},
        "node": nodes,
        "edge": {name: {} for name in nodes},
        "adjacency": {name: {} for name in nodes},
        "max_node": len(nodes) - 1,
    }
    data = {
        "dtype": "compas_assembly.datastructures/Assembly",
        "data": {
            "attributes": {"name": tidy_name(title) or "Assembly"},
            "graph": {"dtype": "compas.datastructures/Graph", "data": graph},
        },
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


FORMAT = Format(
    name="compas",
    endings=(".json",),
    read=lambda data, *_: read(data),
    write=lambda shapes, title, _: write(shapes, title),
)
