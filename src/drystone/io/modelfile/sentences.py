"""What a schema check found, as sentences that name the place and the mend."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from drystone.common.ranges import found
from drystone.io.modelfile.declared import Extended
from drystone.io.modelfile.keys import Section
from drystone.io.modelfile.schema import ModelSection
from drystone.model.construction.words import quoted, suggestion

#: Sentences on one file: nobody reads more.
MOST = 100

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")

_UNQUOTED = ("float_type", "int_type", "bool_type")
_NUMBER_OR_BOOL = re.compile(r"true|false|[-+]?\d+\.?\d*([eE][-+]?\d+)?")

_KINDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "list_type": "a list in square brackets",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
}

_BOUNDS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}


def sentences(
    error: ValidationError, data: dict[str, Any], schema: type[Section] = ModelSection
) -> list[str]:
    """One sentence for each error of a check of ``data`` against a schema, up to `MOST`."""
    details = error.errors(include_url=False)[:MOST]
    found = [_sentence(one, data, schema) for one in details]
    if (more := error.error_count() - MOST) > 0:
        found.append(f"the file: has {more:,} more faults: mend these first")
    return found


def place_of(keys: Sequence[str | int], data: Any) -> str:
    """A path of keys as its author would look for it: ``block[2] "b1" vertices[1]``.

    Lists count from 1, and what has an id says it.
    """
    text, after_id = "", False
    for key in keys:
        data = _at(data, key)
        if isinstance(key, int):
            text += f"[{key + 1}]"
        else:
            text += (" " if after_id else "." if text else "") + _key(key)
        block_id = data.get("id", data.get("name")) if isinstance(data, dict) else None
        after_id = False
        if isinstance(key, int) and isinstance(block_id, str):
            text += f" {quoted(block_id)}"
            after_id = True
    return text


def _sentence(details: ErrorDetails, data: dict[str, Any], schema: type[Section]) -> str:
    kind, value = details["type"], details["input"]
    section, keys = _section_at(details["loc"][:-1], data, schema), [*details["loc"]]
    if kind == "missing":
        key = str(keys[-1])
        description = section.keys()[key].description
        how = f" ({description})" if description else ""
        return f"{_within(keys[:-1], data)}{key} is missing: add it{how}"
    if kind == "extra_forbidden":
        key = str(keys[-1])
        mend = suggestion(key, list(section.keys()))
        return f"{_within(keys[:-1], data)}unknown key {quoted(key)}: {mend}"
    if keys and keys[-1] == "[key]":
        keys.pop()
    return f"{place_of(keys, data) or 'the file'}: {_complaint(kind, details, value)}"


def _complaint(kind: str, details: ErrorDetails, value: Any) -> str:
    context = details.get("ctx", {})
    if kind == "sentence":
        return details["msg"]
    if kind in _KINDS:
        in_list = isinstance(details["loc"][-1], int)
        mend = "" if in_list else _mend_of_type(kind, value)
        return f"must be {_KINDS[kind]}, it is {found(value)}{mend}"
    if kind == "finite_number":
        return f"must be a finite number, it is {value}"
    if kind in _BOUNDS:
        words, key = _BOUNDS[kind]
        return f"must be {words} {context[key]:g}, it is {found(value)}"
    if kind in ("too_short", "too_long"):
        wanted = context.get("min_length" if kind == "too_short" else "max_length")
        least = "at least " if details["loc"][-1] in ("courses", "material", "blocks") else ""
        noun = "entry" if wanted == 1 else "entries"
        return f"must have {least}{wanted} {noun}, it has {context['actual_length']}"
    if kind == "literal_error":
        known = [word.strip("'") for word in re.split(r", | or ", context["expected"])]
        if isinstance(value, str) and "2" not in known:
            return f"must not be {quoted(value)}: {suggestion(value, known)}"
        return f"must be {context['expected']}, it is {found(value)}".replace("'", '"')
    return f"{details['msg'][:1].lower()}{details['msg'][1:]}"


def _mend_of_type(kind: str, value: Any) -> str:
    if kind == "list_type" and isinstance(value, dict):
        return ": write [[block]] with two brackets on each side"
    if kind in ("dict_type", "model_type") and isinstance(value, list):
        return ": write its name in single brackets, once"
    if kind in _UNQUOTED and isinstance(value, str) and _NUMBER_OR_BOOL.fullmatch(value):
        return ": take the quotes off"
    return ""


def _within(keys: Sequence[str | int], data: Any) -> str:
    place = place_of(keys, data)
    return f"{place}: " if place else ""


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else quoted(key)


def _at(data: Any, key: str | int) -> Any:
    try:
        return data[key]
    except (KeyError, IndexError, TypeError):
        return None


def _section_at(keys: Sequence[str | int], data: Any, schema: type[Section]) -> type[Section]:
    """The schema of the table at a path."""
    section = schema
    for key in keys:
        data = _at(data, key)
        field = section.keys().get(key) if isinstance(key, str) else None
        section = (_section_in(field.annotation) if field else None) or section
        if issubclass(section, Extended) and not section.extended:
            section = section.of(data)
    return section


def _section_in(annotation: Any) -> type[Section] | None:
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation
    inner = (_section_in(argument) for argument in get_args(annotation))
    return next((section for section in inner if section), None)
