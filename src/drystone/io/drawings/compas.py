"""COMPAS JSON: assemblies and models of compas_assembly, compas_cra, compas_dem and compas_rbe.

Their layouts have changed with every version.  What has not is that a mesh is a table of "vertex"
and "face", or of "vertices" and "faces" for polyhedra, and that a support says "is_support" beside
it.  Meshes are therefore looked for wherever they are but between two blocks, and what holds them
tells their names.
"""

from __future__ import annotations

import ast
import json
import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from drystone.common.arrays import Array
from drystone.io.drawings.compas_meshes import vertices_and_faces
from drystone.io.drawings.compas_search import Path, matrix_of, search
from drystone.io.drawings.drawing import Drawing, Shape, tidy_name
from drystone.io.drawings.format import Format
from drystone.model.construction.errors import ModelError

#: Keys on the way to a mesh that are no names of blocks.
_HOLDERS = {
    "blocks", "block", "data", "geometry", "mesh", "node", "nodes", "graph", "elements", "element",
    "value", "modelgeometry", "_geometry", "shape", "tree", "children", "root", "assembly", "items",
}  # fmt: skip


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
    found, others = search(data)
    left_out = [f"{n} left out: {what}" for what, n in sorted(others.items())]
    if not found:
        only = f" ({'; '.join(left_out[:3])})" if left_out else ""
        raise ModelError([f"holds no meshes{only}: save the assembly with its blocks as meshes"])
    marked = _supports_beside(data)
    shapes: list[Shape] = []
    for path, table, given in found:
        name = given or _name(path, len(shapes))
        place = f'block "{name}": '
        vertices, faces = vertices_and_faces(table, place)
        shapes.append(
            Shape(
                name=name,
                vertices=_transformed(vertices, path, place),
                faces=faces,
                support=name in marked or any(_says_support(holder) for holder, _ in path),
            )
        )
    return Drawing(shapes=tuple(shapes), up="z", notes=tuple(left_out))


def _name(path: Path, count: int) -> str:
    """The nearest key that is a name; of lists the element's own name, or its number."""
    for k in range(len(path) - 1, -1, -1):
        holder, key = path[k]
        if k and path[k - 1][1] == "node" and isinstance(key, str):
            return tidy_name(_name_of_node(key)) or f"b{count + 1}"
        if key is None or (isinstance(key, str) and key in _HOLDERS):
            continue
        if isinstance(key, int):
            element = holder[key]
            return tidy_name(_own_name(element) or f"b{key + 1}")
        return tidy_name(key) or f"b{count + 1}"
    return f"b{count + 1}"


def _name_of_node(key: str) -> str:
    """The key of a node of a graph, without the quotes that COMPAS writes around text."""
    if key[:1] not in ("'", '"') or key[-1] != key[0]:
        return key  # a number, or text of a file that has none around it
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a backslash that means nothing
            value = ast.literal_eval(key)
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return key
    return value if isinstance(value, str) else key


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


def _transformed(vertices: Array, path: Path, place: str) -> Array:
    """Vertices where the transformations of what holds them put them."""
    for holder, _ in reversed(path):
        matrix = matrix_of(holder, place)
        if matrix is not None:
            vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    return vertices


def write(shapes: Sequence[Shape], title: str) -> str:
    """The text of a file in the layout of compas_assembly 0.4 and later.

    Keys of nodes are literals of Python, as COMPAS writes and reads them.
    """
    nodes = {
        _literal(tidy_name(shape.name)): {
            "block": {
                "dtype": "compas_assembly.datastructures/Block",
                "inheritance": ["compas.datastructures/Mesh"],
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
        "edge": {key: {} for key in nodes},
        "adjacency": {key: {} for key in nodes},
        "max_node": max((int(key) for key in nodes if key.isdecimal()), default=-1),
    }
    data = {
        "dtype": "compas_assembly.datastructures/Assembly",
        "data": {
            "attributes": {"name": tidy_name(title) or "Assembly"},
            "graph": {"dtype": "compas.datastructures/Graph", "data": graph},
        },
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _literal(name: str) -> str:
    """The key of a node: a number where the name is one, as in most files of COMPAS, else text."""
    return name if name.isdecimal() and str(int(name)) == name else repr(name)


FORMAT = Format(
    name="compas",
    endings=(".json",),
    read=lambda data, *_: read(data),
    write=lambda shapes, title, _: write(shapes, title),
)
