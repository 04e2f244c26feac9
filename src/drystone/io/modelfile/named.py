"""Files that a model file names beside drawings: spectra, records, histories of displacements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model
from drystone.model.site import FILE


def texts_of(model: Model, data: Mapping[str, Any]) -> dict[str, str]:
    """Texts of the files that a model names, whose tables are given; see `texts_named`."""
    for table in (model.site, model.assessment):
        if table is not None and table.files is not None:  # of results: no file is read
            names = files_named(data)
            return {name: text for name, text in table.files.items() if name in names}
    return texts_named(data, Path(model.source or "").parent)


def texts_named(data: Mapping[str, Any], folder: Path) -> dict[str, str]:
    """Texts of the files that the tables of a model name from a folder, by their names.

    Those that cannot be read are left out: whoever needs one says so.
    """
    found = {}
    for name in files_named(data):
        try:
            path = folder / name
            found[name] = read_bytes(path, "a file of the model").decode("utf-8")
        except (ModelError, UnicodeDecodeError):
            continue
    return found


def files_named(data: Mapping[str, Any]) -> set[str]:
    """Names of these files."""
    found = {name for key in ("site", "assessment") for name in _within(data.get(key))}
    control = data.get("control")
    history = control.get("history") if isinstance(control, Mapping) else None
    return found | ({history} if isinstance(history, str) else set())


def _within(value: Any) -> Iterator[str]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key == FILE and isinstance(inner, str):
                yield inner
            else:
                yield from _within(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _within(inner)
