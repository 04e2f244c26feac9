"""Records as plain values and arrays, and back: what a run keeps so that it can go on.

A value is taken apart into a tree, which JSON can hold, and a list of arrays.  A tree holds

- numbers, texts, lists, tuples, dicts, sets and members of enumerations,
- arrays and numbers of numpy, by their row in the list of arrays,
- dataclasses and named tuples, by the name of their class and the values of their fields.

What is one object before is one object after: engines ask whether arrays *are* those of the last
step.  Numbers are the same to the last bit.

Nothing of a tree is run: a class is taken only where it is a dataclass, a named tuple or an
enumeration of this package, or of one that is named and loaded already.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Collection, Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

#: Kinds of arrays that are kept: truth values, numbers, texts.
KINDS = "biufSU"

#: Collections of items, by their names in a tree.
COLLECTIONS: dict[str, Any] = {"list": list, "tuple": tuple, "set": set, "frozenset": frozenset}

#: The package whose classes are known.
OWN = "drystone"


class CodecError(ValueError):
    """A value that cannot be kept, or a tree that is none of ours; the message says where."""


class Derived:
    """Base class of records that follow from the problem, to which states refer.

    They are not kept: whoever reads a state has made them anew, see `unpacked`.
    """


class Packed(NamedTuple):
    """A value taken apart."""

    tree: Any  # for JSON
    arrays: list[NDArray[Any]]


def packed(value: Any) -> Packed:
    """A value taken apart; raises `CodecError` for what cannot be kept."""
    writer = _Writer()
    return Packed(writer.node(value, "it"), writer.arrays)


def unpacked(
    parts: Packed, *, derived: Iterable[Derived] = (), packages: Collection[str] = ()
) -> Any:
    """The value of its parts.

    Parameters
    ----------
    derived
        Records that the value refers to, one of each class.
    packages
        Of others, whose classes the tree may name.

    Raises
    ------
    CodecError
        The tree is damaged, or of classes that have other fields than these.
    """
    known = {_name(type(record)): record for record in derived}
    try:
        return _Reader(parts.arrays, known, frozenset(packages)).value(parts.tree)
    except (LookupError, TypeError, AttributeError, ImportError, RecursionError) as error:
        raise CodecError(f"the tree is damaged ({error!r})") from None


def check_fields(tree: Any) -> None:
    """Raise `CodecError` where a tree has records of this package with other fields than these, or
    of classes that are not there any more: those of another version."""
    nodes = [tree]
    while nodes:
        node = nodes.pop()
        if isinstance(node, list):
            nodes += node
        elif isinstance(node, dict):
            if "record" in node and node["record"].partition(".")[0] == OWN:
                _record_class(node, _Reader([], {}, frozenset()))
            nodes += node.values()


class _Writer:
    """Takes a value apart."""

    def __init__(self) -> None:
        self.arrays: list[NDArray[Any]] = []
        self.seen: dict[int, int] = {}  # numbers of objects, by their identity
        self.objects: list[Any] = []  # these objects, so that no other comes to have it

    def node(self, value: Any, where: str) -> Any:
        if value is None or type(value) in (bool, int, str):
            return value
        if type(value) is float:
            return value if math.isfinite(value) else {"float": repr(value)}
        if isinstance(value, Enum):
            return {"enum": _name(type(value)), "member": value.name}
        if isinstance(value, np.generic):
            return {"scalar": self._kept(np.asarray(value), where)}
        if isinstance(value, Derived):
            return {"derived": _name(type(value))}
        if type(value) is tuple and not value:  # of which there is one
            return {"tuple": []}
        if (number := self.seen.get(id(value))) is not None:
            return {"same": number}
        self.seen[id(value)] = number = len(self.objects)
        self.objects.append(value)
        return {"number": number, **self._whole(value, where)}

    def _whole(self, value: Any, where: str) -> dict[str, Any]:
        """What is met for the first time."""
        if isinstance(value, np.ndarray):
            return {"array": self._kept(value, where)}
        if type(value) in COLLECTIONS.values():
            rows = sorted(value) if isinstance(value, set | frozenset) else value
            nodes = [self.node(item, f"{where}[{k}]") for k, item in enumerate(rows)]
            return {type(value).__name__: nodes}
        if isinstance(value, Mapping):
            pairs = [
                [self.node(key, where), self.node(item, f"{where}[{key!r}]")]
                for key, item in value.items()
            ]
            return {"dict": pairs}
        names = _fields_of(type(value))
        if names is None:
            raise CodecError(f"{where} is of {_name(type(value))}, which cannot be kept")
        values = {name: self.node(getattr(value, name), f"{where}.{name}") for name in names}
        return {"record": _name(type(value)), "fields": values}

    def _kept(self, array: NDArray[Any], where: str) -> int:
        if array.dtype.kind not in KINDS:
            raise CodecError(f"{where} is an array of {array.dtype}, which cannot be kept")
        self.arrays.append(array)
        return len(self.arrays) - 1


class _Reader:
    """Puts a value together."""

    def __init__(
        self,
        arrays: list[NDArray[Any]],
        derived: Mapping[str, Derived],
        packages: frozenset[str],
    ) -> None:
        self.arrays, self.derived, self.packages = arrays, derived, packages
        self.met: dict[int, Any] = {}

    def value(self, node: Any) -> Any:
        if not isinstance(node, dict):
            if isinstance(node, list):
                raise CodecError("the tree is damaged: a list that is no node")
            return node
        if "same" in node:
            return self.met[node["same"]]
        found = self._made(node)
        if "number" in node:
            self.met[node["number"]] = found
        return found

    def _made(self, node: dict[str, Any]) -> Any:
        for name, collection in COLLECTIONS.items():
            if name in node:
                return collection([self.value(item) for item in node[name]])
        if "float" in node:
            return float(node["float"])
        if "array" in node:
            return self.arrays[node["array"]]
        if "scalar" in node:
            return self.arrays[node["scalar"]][()]
        if "dict" in node:
            return {self.value(key): self.value(item) for key, item in node["dict"]}
        if "derived" in node:
            return self.derived[node["derived"]]
        if "enum" in node:
            kind = self.known_class(node["enum"])
            if not issubclass(kind, Enum):
                raise CodecError(f"{node['enum']} is no enumeration")
            return kind[node["member"]]
        return self._record(node)

    def _record(self, node: dict[str, Any]) -> Any:
        kind, names = _record_class(node, self)
        values = node["fields"]
        made = {name: self.value(values[name]) for name in names}
        if issubclass(kind, tuple):
            return kind(**made)
        record = object.__new__(kind)
        for name, value in made.items():
            object.__setattr__(record, name, value)
        return record

    def known_class(self, name: str) -> type[Any]:
        """The class of a name in a tree."""
        module, _, path = name.partition(":")
        root, *inner = module.split(".")
        if root == OWN and not any(part.startswith("_") for part in inner):
            found: Any = import_module(module)
        else:
            found = sys.modules.get(module) if root in self.packages else None
        if found is None:
            raise CodecError(f"{name} is no class that is known here")
        for part in path.split("."):
            found = vars(found).get(part)
        if not isinstance(found, type) or _name(found) != name:
            raise CodecError(f"{name} is no class that is known here")
        return found


def _record_class(node: dict[str, Any], reader: _Reader) -> tuple[type[Any], tuple[str, ...]]:
    """The class of a record and its fields; `CodecError` where these are not those of the node."""
    kind = reader.known_class(node["record"])
    names = _fields_of(kind)
    if names is None or set(names) != set(node["fields"]):
        raise CodecError(f"{node['record']} has other fields in this version")
    return kind, names


def _fields_of(kind: type[Any]) -> tuple[str, ...] | None:
    """Fields of a dataclass or a named tuple; None of other classes."""
    if is_dataclass(kind):
        return tuple(field.name for field in fields(kind))
    if issubclass(kind, tuple) and hasattr(kind, "_fields"):
        return tuple(kind._fields)
    return None


def _name(kind: type[Any]) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"
