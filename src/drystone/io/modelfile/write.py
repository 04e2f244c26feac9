"""From a model to a model file."""

from __future__ import annotations

import json
import re
from os import PathLike
from pathlib import Path
from typing import Any

from drystone.model.construction.describe import model_to_dict
from drystone.model.model import Model

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def write_model(model: Model, path: str | PathLike[str]) -> None:
    """Write a model to ``path``, as JSON if it ends in .json and as TOML otherwise.

    Walls are written block by block.  Reading the file again gives an equal assembly.
    """
    path = Path(path)
    data = model_to_dict(model)
    if path.suffix.lower() == ".json":
        text = json.dumps(data, indent=2, ensure_ascii=False) + "\n"
    else:
        text = to_toml(data)
    path.write_text(text, encoding="utf-8", newline="\n")


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
