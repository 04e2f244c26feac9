"""Places in a model file: ``joint.friction_coefficient``, ``block."b1".vertices[1][2]``.

A place is written with the keys of the file, dots between them.  Entries of lists count from 1, as
in the messages on model files, or go by their id, name or group; ``*`` and ``?`` stand for letters.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from typing import Any, get_args, get_origin

from drystone.common.names import quoted, suggestion
from drystone.io.modelfile.declared import Extended
from drystone.io.modelfile.keys import Section
from drystone.io.modelfile.schema import ModelSection
from drystone.io.modelfile.sentences import place_of

#: A key, bare or in quotes, or the number of an entry in brackets.
_STEP = re.compile(r'\.(?:(?P<bare>[A-Za-z0-9_-]+)|"(?P<quoted>[^"]+)")|\[(?P<number>\d+)\]')
#: Entries of a list that are offered by their number where a path is unknown.
_MOST_OFFERED = 40

Keys = tuple[str | int, ...]


class PathError(ValueError):
    """There is no such place; the message is the end of a sentence."""


def keys_of(text: str) -> Keys:
    """Keys of a place, numbers of entries counted from 0; raises `PathError`."""
    keys: list[str | int] = []
    at = 0
    whole = f".{text}"
    while at < len(whole):
        found = _STEP.match(whole, at)
        if not found:
            raise PathError('is no place of a model file: write it as in "joint.cohesion"')
        if found["number"] is not None:
            number = int(found["number"])
            if number < 1:
                raise PathError("counts entries from 1: there is no [0]")
            keys.append(number - 1)
        else:
            keys.append(found["bare"] or found["quoted"])
        at = found.end()
    return tuple(keys)


def check(text: str, document: Mapping[str, Any]) -> Keys:
    """Keys of a place that the model file may have; raises `PathError`, which says the nearest.

    Parameters
    ----------
    document
        The model file, as nested dicts and lists.
    """
    keys = keys_of(text)
    if not _known(ModelSection, document, keys):
        known = list(dict.fromkeys(places(document)))
        longer = [place for place in known if place.startswith(text)]
        mend = f"did you mean {quoted(longer[0])}?" if longer else suggestion(text, known)
        raise PathError(f"is no place of the model file: {mend}")
    return keys


def value_at(document: Mapping[str, Any], keys: Keys) -> Any:
    """What stands at the first place that the keys lead to; None where there is nothing."""
    for holder, key in _targets(document, keys, make=False):
        return holder[key] if isinstance(holder, list) else holder.get(key)
    return None


def put(document: dict[str, Any], keys: Keys, change: Any) -> None:
    """Put ``change(old)`` where the keys lead to, at every place where they fit several.

    Tables that are missing on the way are made; raises `PathError` where a list has no such entry.
    """
    found = False
    for holder, key in list(_targets(document, keys, make=True)):
        old = holder[key] if isinstance(holder, list) else holder.get(key)
        holder[key] = change(old)
        found = True
    if not found:
        raise PathError("leads to nothing in this model: check ids and numbers of entries")


def _targets(document: Any, keys: Keys, *, make: bool) -> Iterator[tuple[Any, Any]]:
    """Tables or lists with the last key in them."""
    holders = [document]
    for key in keys[:-1]:
        holders = [inner for holder in holders for inner in _inner(holder, key, document, make)]
    for holder in holders:
        if isinstance(holder, list):
            for row in _rows(holder, keys[-1], document):
                yield holder, row
        elif isinstance(holder, dict) and isinstance(keys[-1], str):
            yield holder, keys[-1]


def _inner(holder: Any, key: str | int, document: Any, make: bool) -> list[Any]:
    if isinstance(holder, list):
        return [holder[row] for row in _rows(holder, key, document)]
    if not isinstance(holder, dict) or isinstance(key, int):
        return []
    if key not in holder and make:
        holder[key] = {}
    return [holder[key]] if key in holder else []


def _rows(entries: list[Any], key: str | int, document: Any) -> list[int]:
    """Rows of a list that a number, or an id, a name or a group with wildcards means."""
    if isinstance(key, int):
        return [key] if key < len(entries) else []
    named = [(row, _name(entry)) for row, entry in enumerate(entries)]
    rows = [row for row, name in named if name is not None and fnmatchcase(name, key)]
    return rows or [row for row, name in named if _in_group(entries[row], name, key, document)]


def _name(entry: Any) -> str | None:
    if not isinstance(entry, dict):
        return None
    name = entry.get("id", entry.get("name", entry.get("kind")))
    return name if isinstance(name, str) else None


def _in_group(entry: Any, name: str | None, group: str, document: Any) -> bool:
    """Whether a block is one of a group, by its own key or by [group.NAME]."""
    if not isinstance(entry, dict) or name is None:
        return False
    if group in entry.get("groups", []):
        return True
    patterns = document.get("group", {}).get(group, {}).get("blocks", [])
    return any(fnmatchcase(name, pattern) for pattern in patterns)


def _known(section: type[Section], table: Any, keys: Keys) -> bool:
    """Whether the schema has a place; entries of lists are those of the document."""
    key, rest = keys[0], keys[1:]
    field = _extended(section, table).keys().get(str(key)) if isinstance(key, str) else None
    if field is None:
        return False
    value = table.get(key) if isinstance(table, dict) else None
    inner, kind = _section_in(field.annotation)
    if inner is None:
        return all(isinstance(step, int) for step in rest) and (not rest or _has(value, rest))
    if not rest:
        return True
    if kind is list:
        entries = value if isinstance(value, list) else []
        rows = _rows(entries, rest[0], table)
        return bool(rows) and (len(rest) == 1 or _known(inner, entries[rows[0]], rest[1:]))
    if kind is dict:
        entry = value.get(rest[0]) if isinstance(value, dict) else None
        return isinstance(rest[0], str) and (len(rest) == 1 or _known(inner, entry, rest[1:]))
    return _known(inner, value, rest)


def _has(value: Any, rest: Keys) -> bool:
    """Whether lists hold an entry."""
    for row in rest:
        if not isinstance(value, list) or not isinstance(row, int) or row >= len(value):
            return False
        value = value[row]
    return True


def places(document: Mapping[str, Any]) -> Iterator[str]:
    """All places of a model file that hold a value, or may hold one."""
    for keys in _places(ModelSection, document, ()):
        yield _text(keys, document)


def _places(section: type[Section], table: Any, before: Keys) -> Iterator[Keys]:
    for key, field in _extended(section, table).keys().items():
        value = table.get(key) if isinstance(table, dict) else None
        here = (*before, key)
        inner, kind = _section_in(field.annotation)
        if inner is None:
            yield here
            yield from _entries(value, here)
        elif kind is list:
            for row, entry in enumerate((value or [])[:_MOST_OFFERED]):
                yield from _places(inner, entry, (*here, row))
        elif kind is dict:
            for name, entry in (value or {}).items():
                yield from _places(inner, entry, (*here, name))
        else:
            yield from _places(inner, value or {}, here)


def _entries(value: Any, before: Keys) -> Iterator[Keys]:
    """Numbers in lists, and lists in these."""
    if isinstance(value, list):
        for row, entry in enumerate(value[:_MOST_OFFERED]):
            if isinstance(entry, int | float | list):
                yield (*before, row)
                yield from _entries(entry, (*before, row))


def _text(keys: Keys, document: Any) -> str:
    """A place as a study file writes it: entries with a name go by it."""
    text, holder = "", document
    for key in keys:
        holder = holder[key] if _in(holder, key) else None
        if isinstance(key, int):
            name = _name(holder)
            text += f'."{name}"' if name is not None else f"[{key + 1}]"
        else:
            text += ("." if text else "") + place_of((key,), None)
    return text


def _in(holder: Any, key: str | int) -> bool:
    if isinstance(key, int):
        return isinstance(holder, list) and key < len(holder)
    return isinstance(holder, dict) and key in holder


def _extended(section: type[Section], table: Any) -> type[Section]:
    """The section with the keys that others declare."""
    if issubclass(section, Extended) and not section.extended:
        return section.of(table if isinstance(table, dict) else {})
    return section


def _section_in(annotation: Any) -> tuple[type[Section] | None, Any]:
    """The section that a key holds, and whether in a list or a dict of them."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation, None
    kind = get_origin(annotation)
    for argument in get_args(annotation):
        section, inner = _section_in(argument)
        if section is not None:
            return section, kind if kind in (list, dict) else inner
    return None, None


def is_numeric(value: Any) -> bool:
    """Whether a value is a number, or a list of numbers and of such lists."""
    if isinstance(value, list):
        return bool(value) and all(map(is_numeric, value))
    return isinstance(value, int | float) and not isinstance(value, bool)


def changed(old: Any, apply: str, value: Any) -> Any:
    """What stands where a value was put: itself, or times or plus what was there, entry by entry.

    Raises
    ------
    PathError
        There is no number to change.
    """
    if apply == "set":
        return value
    if isinstance(old, list) and is_numeric(old):
        return [changed(entry, apply, value) for entry in old]
    if not is_numeric(old):
        raise PathError(f'holds no number that apply = "{apply}" could change')
    return old * value if apply == "multiply" else old + value
