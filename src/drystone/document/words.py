"""The words of the report: a file for each language, so that others can follow."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Any

#: Languages there are files of.
LANGUAGES = ("en",)


@cache
def words(language: str = "en") -> dict[str, Any]:
    """Words by section and key; raises `ValueError` for a language that there is no file of."""
    if language not in LANGUAGES:
        raise ValueError(f'there are no words in "{language}", but in {", ".join(LANGUAGES)}')
    text = (resources.files("drystone.document") / f"{language}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)
