"""Where a file of COMPAS holds shapes: all that is around each of them, and what is left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.io.drawings.compas_meshes import is_shape
from drystone.io.drawings.drawing import tidy_name
from drystone.model.construction.errors import ModelError

#: Depth of tables inside each other that no file of theirs has.
DEEPEST = 40
#: Tables whose keys are names of blocks, whatever word these are.
NAMING = ("blocks", "node")
#: Keys of what lies between two blocks: meshes of joints are no blocks.
_BETWEEN = {
    "edge", "edges", "interface", "interfaces", "contact", "contacts", "interaction",
    "interactions",
}  # fmt: skip
#: Ends of the names of classes that lie between two blocks.
_CLASSES_BETWEEN = ("Interface", "Contact")
#: Classes that are read, if they hold faces.
_READ = {"Block", "Box", "Mesh", "Polyhedron"}
#: Solids that are not, by the ends of their names.
_NOT_READ = (
    "Brep", "Capsule", "CellNetwork", "Cone", "Cylinder", "Sphere", "Torus", "VolMesh",
)  # fmt: skip
#: Elements that only order others.
_WITHOUT_SHAPE = "Group"

#: What holds what, from outside: each holder and its key.
Path = tuple[tuple[Any, Any], ...]


class Held(NamedTuple):
    """A shape, and what holds it."""

    path: Path
    table: Mapping[str, Any]
    name: str = ""  # that its element was given, if no other has the same


def search(data: Any) -> tuple[list[Held], Counter[str]]:
    """Shapes in a file, and by class how many solids and elements are no shapes that are read."""
    others: Counter[str] = Counter()
    return list(_walk(data, (), others)), others


def _walk(data: Any, path: Path, others: Counter[str]) -> Iterator[Held]:
    if len(path) > DEEPEST:
        return
    if isinstance(data, list):
        if data and isinstance(data[0], dict | list):
            for k, value in enumerate(data):
                yield from _walk(value, (*path, (data, k)), others)
        return
    if not isinstance(data, dict):
        return
    kind = class_of(data)
    if is_shape(data):
        yield Held((*path, (data, None)), data)
    elif kind.endswith(_NOT_READ):
        others[kind] += 1
    elif not kind.endswith(_CLASSES_BETWEEN):
        yield from _counted(_inside(data, path, others), kind if kind in _READ else "", others)


def _inside(data: dict[str, Any], path: Path, others: Counter[str]) -> Iterator[Held]:
    """Shapes in what a table holds."""
    naming = bool(path) and path[-1][1] in NAMING
    for key, value in data.items():
        if not isinstance(value, dict | list):
            continue
        if key == "elements":
            yield from _elements(data, path, others)
        elif key == "features" and isinstance(value, list):
            others.update(f"{kind}, a feature" for one in value if (kind := class_of(one)))
        elif naming or not _is_between(key, value):
            yield from _walk(value, (*path, (data, key)), others)


def _counted(found: Iterator[Held], kind: str, others: Counter[str]) -> Iterator[Held]:
    """What was found; where that is nothing, not even left out, one more of a kind is left out."""
    before = others.total()
    first = next(found, None)
    if first is not None:
        yield first
        yield from found
    elif kind and others.total() == before:
        others[kind] += 1


def _is_between(key: str, value: Any) -> bool:
    block = isinstance(value, dict) and (is_shape(value) or class_of(value))
    return key in _BETWEEN and not block


def class_of(table: Any) -> str:
    """The name of the class that wrote a table, without its package."""
    kind = table.get("dtype") if isinstance(table, dict) else None
    return tidy_name(kind.rpartition("/")[2]) if isinstance(kind, str) else ""


# --- elements of models -----------------------------------------------------------------------


def _elements(data: Mapping[str, Any], path: Path, others: Counter[str]) -> Iterator[Held]:
    """Shapes of the elements of a model, which lie side by side: its tree tells their groups."""
    table = data["elements"]
    entries = list(table.items() if isinstance(table, dict) else enumerate(table))
    by_id = {
        key if isinstance(table, dict) else one.get("guid"): one
        for key, one in entries
        if isinstance(one, dict) and isinstance(one.get("guid", key), str | int)
    }
    motions = _motions_of_groups(data.get("tree"), by_id)
    names = {key: _given_name(one) for key, one in entries}
    occurs = Counter(names.values())
    for key, one in entries:
        own = key if isinstance(table, dict) or not isinstance(one, dict) else one.get("guid")
        around: Path = (*path, (data, "elements"), (table, key))
        if own in motions:
            around = (*around, ({"transformation": {"matrix": motions[own]}}, None))
        kind = class_of(one)
        expected = "" if kind == _WITHOUT_SHAPE else kind
        for held in _counted(_walk(one, around, others), expected, others):
            unique = occurs[names[key]] == 1
            yield held if held.name or not unique else held._replace(name=names[key])


def _given_name(element: Any) -> str:
    """The name that an element was given; that of its class is none."""
    inner = element.get("data") if isinstance(element, dict) else None
    for table in (element, inner):
        name = table.get("name") if isinstance(table, dict) else None
        if isinstance(name, str) and tidy_name(name) and name != class_of(element):
            return tidy_name(name)
    return ""


def _motions_of_groups(tree: Any, elements: Mapping[Any, Any]) -> dict[str, list[list[float]]]:
    """By element, the matrix (4, 4) of all the elements that it is a part of."""
    found: dict[str, list[list[float]]] = {}
    waiting: list[tuple[Any, Array | None]] = [(tree, None)]
    while waiting:
        node, motion = waiting.pop()
        if not isinstance(node, dict):
            continue
        own = node.get("element")
        if isinstance(own, str) and own in elements:
            if motion is not None:
                found[own] = motion.tolist()
            for matrix in _matrices_of_element(elements[own]):
                motion = matrix if motion is None else motion @ matrix
        children = node.get("children")
        inner = [
            node.get("root"),
            node.get("data"),
            *(children if isinstance(children, list) else ()),
        ]
        waiting += [(one, motion) for one in inner]
    return found


def _matrices_of_element(element: Mapping[str, Any]) -> Iterator[Array]:
    place = f'element "{_given_name(element) or class_of(element)}": '
    for table in (element, element.get("data")):
        matrix = matrix_of(table, place)
        if matrix is not None:
            yield matrix


def matrix_of(holder: Any, place: str) -> Array | None:
    """The transformation (4, 4) that a table says, if it says one.

    Raises `ModelError`, with ``place`` before the sentence.
    """
    own = holder.get("transformation") if isinstance(holder, dict) else None
    inner = own.get("data", own) if isinstance(own, dict) else None
    rows = inner.get("matrix") if isinstance(inner, dict) else None
    if rows is None:
        return None
    try:
        matrix = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.zeros(0)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise ModelError([f"{place}its transformation is no matrix of 4 by 4: the file is torn"])
    return matrix
