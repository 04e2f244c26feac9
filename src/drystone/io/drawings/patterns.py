"""Names with letters left open."""

from __future__ import annotations

import re


def expression(pattern: str) -> re.Pattern[str]:
    """What fits a pattern in which * stands for any letters and ? for one."""
    text = "".join({"*": ".*", "?": "."}.get(letter, re.escape(letter)) for letter in pattern)
    return re.compile(text, re.DOTALL)
