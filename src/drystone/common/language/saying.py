"""A sentence that knows its key and its fields, so that it can be said in every language."""

from __future__ import annotations

import re
import string
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, Self

from drystone.common.language.catalogue import DECIMAL_MARKS, current, templates, with_mark

#: Sections of the tables that results hold as text.
HAPPENING = ("end", "event", "named", "refused")

#: Fields of these templates that are clauses, and so sayings of their own.
CLAUSES = ("how", "leg", "reason", "why")

#: A number as formats write it.
_NUMBER = re.compile(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?")


class Saying(str):
    """A sentence or a clause.  As a string it is English, as files and exceptions have it.

    Fields are numbers, words, other sayings or lists of these.
    """

    key: str  # "section.key" in the tables of the languages
    fields: Mapping[str, Any]

    def __new__(cls, key: str, fields: Mapping[str, Any]) -> Self:
        """The saying of a key; `KeyError` where the tables have none or a field is missing."""
        saying = super().__new__(cls, _filled("en", key, fields))
        saying.key, saying.fields = key, dict(fields)
        return saying

    def __reduce__(self) -> tuple[Any, ...]:
        return Saying, (self.key, self.fields)

    def in_language(self, language: str) -> str:
        """The same in a language."""
        return _filled(language, self.key, self.fields)

    @property
    def spoken(self) -> str:
        """The same in the language that is spoken."""
        return self.in_language(current())

    def as_dict(self) -> dict[str, Any]:
        """Key and fields for a file."""
        return {"key": self.key, "fields": {k: _plain(v) for k, v in self.fields.items()}}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """A saying that a file holds; `KeyError` where this version does not know it."""
        return cls(data["key"], {k: _whole(v) for k, v in data["fields"].items()})


def say(key: str, /, **fields: Any) -> Saying:
    """The sentence of a key with its fields."""
    return Saying(key, fields)


def spoken(text: str, known: Mapping[str, Any] | None = None) -> str:
    """A text in the language that is spoken; as it is, where nobody knows its key.

    Parameters
    ----------
    known
        Keys and fields by texts, as files hold them beside what they say.
    """
    if isinstance(text, Saying):
        return text.spoken
    if known and text in known:
        try:
            return Saying.from_dict(known[text]).spoken
        except (KeyError, TypeError, ValueError):  # of another version
            return text
    return text


def said_end(reason: str) -> str:
    """The end of a curve, as results keep it in English, as a saying; else as it is.

    Ends are sentences with semicolons between them; those that have one themselves are tried whole.
    """
    parts = _ends(reason.split("; "))
    said = parts[-1]
    for part in reversed(parts[:-1]):
        said = say("end.and", first=part, rest=said)
    return said


def _ends(parts: Sequence[str]) -> list[str]:
    """The sayings of ends that semicolons have parted; of several parts, where they are one."""
    said: list[str] = []
    while parts:
        tried = (_recognised("; ".join(parts[:n])) for n in range(1, len(parts) + 1))
        n, found = next(
            ((n, found) for n, found in enumerate(tried, 1) if _is_whole(found)),
            (1, _recognised(parts[0])),
        )
        said.append(found)
        parts = parts[n:]
    return said


def _is_whole(text: object) -> bool:
    """Whether a text is a saying, and so are its clauses."""
    return isinstance(text, Saying) and all(
        _is_whole(text.fields[name]) for name in CLAUSES if name in text.fields
    )


def said_status(status: str) -> Saying:
    """The status of a curve, as results keep it in English, as a saying."""
    return say(f"status.{status}")


def _recognised(text: str) -> str:
    """The saying of what happens along a curve that says a text in English; the text itself where
    there is none."""
    for pattern, key in _patterns():
        found = pattern.fullmatch(text)
        if found:
            fields = {
                name: float(value) if _NUMBER.fullmatch(value) else _recognised(value)
                for name, value in found.groupdict().items()
            }
            said = _checked(key, fields)
            if said == text:
                return said
    return text


def _checked(key: str, fields: dict[str, Any]) -> Saying | None:
    """The saying; None where the fields do not fit its formats."""
    try:
        return say(key, **fields)
    except (KeyError, ValueError):
        return None


class _Words(string.Formatter):
    """Fills templates: numbers get a decimal mark, sayings are said in the language."""

    def __init__(self, language: str) -> None:
        self.language = language

    def format_field(self, value: Any, format_spec: str) -> str:
        if isinstance(value, Saying):
            return value.in_language(self.language)
        if isinstance(value, list | tuple):
            commas = DECIMAL_MARKS[self.language] == "," and any(type(x) is float for x in value)
            between = "; " if commas else ", "
            return between.join(self.format_field(item, format_spec) for item in value)
        if isinstance(value, str):
            return value
        if isinstance(value, float) and not format_spec:
            format_spec = "g"
        return with_mark(format(value, format_spec), self.language)


def _filled(language: str, key: str, fields: Mapping[str, Any]) -> str:
    return _Words(language).vformat(templates(language)[key], (), fields)


@cache
def _patterns() -> tuple[tuple[re.Pattern[str], str], ...]:
    """English templates of what happens as patterns, those with most text of their own first."""
    found = []
    for key, template in templates("en").items():
        if key.split(".")[0] not in HAPPENING:
            continue
        pattern, own, seen = "", "", set[str]()
        for text, name, _, _ in string.Formatter().parse(template):
            pattern, own = pattern + re.escape(text), own + text
            if name:
                pattern += f"(?P={name})" if name in seen else f"(?P<{name}>.*?)"
                seen.add(name)
        if any(map(str.isalpha, own)):  # else it says what any text may be
            found.append((len(own), re.compile(pattern, re.DOTALL), key))
    return tuple((pattern, key) for _, pattern, key in sorted(found, key=lambda f: -f[0]))


def _plain(value: Any) -> Any:
    """A field for a file."""
    if isinstance(value, Saying):
        return {"said": value.as_dict()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value if isinstance(value, str | int | float) else float(value)


def _whole(value: Any) -> Any:
    """A field of a file."""
    if isinstance(value, Mapping):
        return Saying.from_dict(value["said"])
    return [_whole(item) for item in value] if isinstance(value, list) else value
