"""From a model to a model file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from drystone.model.construction.describe import model_to_dict
from drystone.model.model import Model
from drystone.model.site import FILE

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def write_model(model: Model, path: str | PathLike[str]) -> None:
    """Write a model to ``path``, as JSON if it ends in .json and as TOML otherwise.

    Walls are written block by block.  Reading the file again gives an equal assembly.  Spectra and
    records that the model names are copied into the folder of the file, because a model file may
    only name files in its own folder.
    """
    path = Path(path)
    data = model_to_dict(model)
    for key in ("site", "assessment"):
        if key in data:
            data[key] = _with_own_files(data[key], path.parent, getattr(model, key).files or {})
    if path.suffix.lower() == ".json":
        text = json.dumps(data, indent=2, ensure_ascii=False) + "\n"
    else:
        text = to_toml(data)
    path.write_text(text, encoding="utf-8", newline="\n")


def _with_own_files(value: Any, folder: Path, held: Mapping[str, str]) -> Any:
    """Tables whose files are named from a folder, into which they, or texts held, are copied."""
    if isinstance(value, list):
        return [_with_own_files(entry, folder, held) for entry in value]
    if not isinstance(value, dict):
        return value
    return {
        key: _own_file(Path(entry), folder, held.get(entry))
        if key == FILE
        else _with_own_files(entry, folder, held)
        for key, entry in value.items()
    }


def _own_file(path: Path, folder: Path, held: str | None) -> str:
    """The name of a file from a folder; a copy, numbered where another file has its name."""
    if held is None:
        if path.is_relative_to(folder.resolve()):
            return path.relative_to(folder.resolve()).as_posix()
        if not path.is_file():
            return path.name
    contents = path.read_bytes() if held is None else held.encode()
    name, k = path.name, 1
    while (folder / name).exists() and (folder / name).read_bytes() != contents:
        k += 1
        name = f"{path.stem}-{k}{path.suffix}"
    (folder / name).write_bytes(contents)
    return name


def to_toml(data: dict[str, Any]) -> str:
    """Nested dicts, lists of dicts, and values as a TOML document."""
    return "\n".join(_table(data, ())).strip() + "\n"


def _table(table: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    """Lines of a table: its values first, then the tables inside it with their headings."""
    lines = [
        f"{_key(key)} = {_value(value)}" for key, value in table.items() if not _is_table(value)
    ]
    for key, value in table.items():
        if not _is_table(value):
            continue
        inner = (*path, key)
        name = ".".join(map(_key, inner))
        if isinstance(value, list):
            for entry in value:
                lines += ["", f"[[{name}]]", *_table(entry, inner)]
        else:
            lines += ["", f"[{name}]", *_table(value, inner)]
    return lines


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], dict)
    )


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _text(key)


def _value(value: bool | int | float | str | list[Any]) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return repr(value)


def _text(text: str) -> str:
    """A basic string: JSON's escapes are TOML's, but for one control character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
