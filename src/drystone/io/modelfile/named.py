"""Files that a model file names: spectra, records, histories of displacements; and drawings."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from drystone.model.construction.contents import file_named, read_bytes, within
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


def digests_named(
    data: Mapping[str, Any], folder: Path, files: Mapping[str, str] | None = None
) -> dict[str, str]:
    """SHA-256 of all files that the tables of a model name from a folder, drawings as well.

    Those that cannot be read, or lie outside of the folder, are left out: whoever needs one says
    so.

    Parameters
    ----------
    files
        Texts of files by their names, of a model that results hold: none is read then.
    """
    found = {}
    for name in files_named(data):
        try:
            place = within(folder, name) if files is None else file_named(name, "", files)
            contents = read_bytes(place, "a file of the model")
        except ModelError:
            continue
        found[name] = hashlib.sha256(contents).hexdigest()
    tables = data.get("import") if files is None else None
    for table in tables if isinstance(tables, list | tuple) else ():
        if not isinstance(table, Mapping) or not isinstance(drawing := table.get(FILE), str):
            continue
        from drystone.io.drawings.formats import digest_of  # most models import nothing

        kind = table.get("format")
        try:
            place = within(folder, drawing)
            found[drawing] = digest_of(place, kind if isinstance(kind, str) else None)
        except ModelError:
            continue
    return found


def files_named(data: Mapping[str, Any]) -> set[str]:
    """Names of these files, without drawings."""
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
