"""The tables of each language, and the language that is spoken just now."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib import resources
from typing import Any

#: Decimal mark by language; there is a folder of tables for each.
DECIMAL_MARKS = {"en": ".", "it": ","}
LANGUAGES = tuple(DECIMAL_MARKS)

#: Files of a language: sentences by section and key; `REPORT` holds the words of the report.
SENTENCES = ("assessment", "methods", "spectra", "curve", "screen", "laboratory", "study")
REPORT = "report"

_POINT = re.compile(r"(?<=\d)\.(?=\d)")
_spoken: ContextVar[str] = ContextVar("language", default="en")


def current() -> str:
    """The language that is spoken just now."""
    return _spoken.get()


@contextmanager
def speaking(language: str) -> Iterator[None]:
    """Speak a language within a block: numbers, words and sentences are written in it.

    Raises
    ------
    ValueError
        There are no tables of that language.
    """
    checked(language)
    token = _spoken.set(language)
    try:
        yield
    finally:
        _spoken.reset(token)


def checked(language: str) -> str:
    """A language there are tables of."""
    if language not in LANGUAGES:
        raise ValueError(f'there are no words in "{language}", but in {", ".join(LANGUAGES)}')
    return language


@cache
def table(language: str, name: str) -> Mapping[str, Any]:
    """A file of a language."""
    path = resources.files("drystone.common.language") / checked(language) / f"{name}.toml"
    return tomllib.loads(path.read_text(encoding="utf-8"))


@cache
def templates(language: str) -> dict[str, str]:
    """Templates of sentences by "section.key"."""
    return {
        f"{section}.{key}": template
        for name in SENTENCES
        for section, keys in table(language, name).items()
        for key, template in keys.items()
    }


def words(language: str | None = None) -> Mapping[str, Any]:
    """Words of the report by section and key, in a language or in the one that is spoken."""
    return table(language or current(), REPORT)


def number(value: float, form: str = ".4g") -> str:
    """A number in a format, with the decimal mark of the language that is spoken."""
    return with_mark(format(value, form), current())


def with_mark(text: str, language: str) -> str:
    """Figures of one number with the decimal mark of a language."""
    return _POINT.sub(DECIMAL_MARKS[language], text)
