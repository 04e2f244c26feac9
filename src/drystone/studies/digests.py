"""Digests of what the samples of a study follow from: its keys, its model, the files of both."""

from __future__ import annotations

import ast
import hashlib
import importlib
import json
import sys
from collections.abc import Iterator, Mapping
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from drystone.common.names import quoted
from drystone.io.modelfile.named import digests_named
from drystone.model.construction.errors import ModelError
from drystone.studies import designs
from drystone.studies.distributions import Choices
from drystone.studies.sample import document_of
from drystone.studies.study import Study, Task

#: Keys of a study file that no sample follows from.  The model counts by what it holds.
LEFT_OUT = ("title", "fragility", "model", "timeout")

#: Keys of [target] that only say when the search is over.
OVER = ("most_runs", "tolerance")


def digests_of(asked: Study) -> dict[str, str]:
    """SHA-256 of all that the samples of a study follow from, by what it is.

    Files count by their names and contents, wherever their folder is.
    """
    task = asked.task
    left_out = {*LEFT_OUT, *(["samples"] if asked.design in designs.GROWING else [])}
    given = {key: value for key, value in asked.given.items() if key not in left_out}
    if isinstance(target := given.get("target"), Mapping):
        given["target"] = {key: value for key, value in target.items() if key not in OVER}
    found = {
        "the study file": _of_keys([given, task.shared]),
        "the model": _of_keys(task.model),
    }
    files = _of_modules(task)
    for document in documents(asked):
        files |= digests_named(document, Path(task.source or "").parent, task.files)
    return found | {quoted(name): digest for name, digest in sorted(files.items())}


def documents(asked: Study) -> Iterator[Mapping[str, Any]]:
    """The model file, and again with each value of a list in its place: values may name files."""
    task = asked.task
    if task.model is None:
        return
    yield task.model
    for parameter, law in zip(task.parameters, asked.laws, strict=False):
        for value in law.values if isinstance(law, Choices) else ():
            if isinstance(value, bool | int | float):
                continue
            try:
                yield document_of(task.varying(parameter), [value])
            except ModelError:  # samples say so
                continue


def _of_keys(keys: Any) -> str:
    return _of_bytes(json.dumps(keys, sort_keys=True, default=str).encode())


def _of_bytes(contents: bytes) -> str:
    return hashlib.sha256(contents).hexdigest()


def _of_modules(task: Task) -> dict[str, str]:
    """Of the function's module and of those of the study's folder that it imports, by their names.

    What cannot be read is left out: samples say so.
    """
    if task.function is None:
        return {}
    name = task.function.partition(":")[0]
    path = Path(task.module) if task.module is not None else _place_of(name, task.folder)
    if path is None:
        return {}
    found: dict[str, str] = {}
    waiting = [(name, path)]
    while waiting:
        name, path = waiting.pop()
        told = name.replace(".", "/") + ("/__init__.py" if path.name == "__init__.py" else ".py")
        if told in found:
            continue
        try:
            contents = path.read_bytes()
        except OSError:
            continue
        found[told] = _of_bytes(contents)
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for other in _imported(contents, package):
            waiting += _in_folder(other, Path(task.folder))
    return found


def _place_of(name: str, folder: str) -> Path | None:
    """The file of a module, where Python looks and in a folder; nothing is imported."""
    importlib.invalidate_caches()
    places, whole, origin = [*sys.path, folder], "", None
    for part in name.split("."):
        whole = f"{whole}.{part}" if whole else part
        spec = PathFinder.find_spec(whole, places)
        if spec is None:
            return None
        origin, places = spec.origin, list(spec.submodule_search_locations or [])
    return Path(origin) if origin is not None and Path(origin).is_file() else None


def _imported(contents: bytes, package: str) -> Iterator[str]:
    """Names of modules that a module's text imports, and of what may be modules in them."""
    try:
        tree = ast.parse(contents)
    except (SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: 1 - node.level or None] if node.level else []
            base = ".".join(filter(None, (*above, node.module)))
            yield from (f"{base}.{alias.name}".lstrip(".") for alias in node.names)
            yield base


def _in_folder(name: str, folder: Path) -> Iterator[tuple[str, Path]]:
    """A module and the packages that it stands in, those of them that a folder holds."""
    parts = [part for part in name.split(".") if part]
    for k in range(1, len(parts) + 1):
        place = folder.joinpath(*parts[:k])
        for path in (place / "__init__.py", place.with_name(f"{place.name}.py")):
            if path.is_file():
                yield ".".join(parts[:k]), path
                break
