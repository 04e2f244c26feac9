"""Names with letters left open."""

from __future__ import annotations

import re


def expression(pattern: str) -> re.Pattern[str]:
    """What fits a pattern in which * stands for any letters and ? for one.

    What stands between two stars is looked for from the left and never again, which takes time in
    proportion to letters and stars, whatever they are.
    """
    first, *others = (
        "".join("." if letter == "?" else re.escape(letter) for letter in piece)
        for piece in re.sub(r"\*+", "*", pattern).split("*")
    )
    if not others:
        return re.compile(first, re.DOTALL)
    *between, last = others
    sought = "".join(f"(?>.*?{piece})" for piece in between)
    return re.compile(f"{first}{sought}.*{last}", re.DOTALL)
