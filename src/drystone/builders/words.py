"""Words that sentences about a model share."""

from __future__ import annotations

import json
from collections.abc import Sequence
from difflib import get_close_matches

LONGEST = 60  # letters of a text shown in a sentence
MOST = 12  # names listed in one
FEW = 5  # names of what a sentence is about
#: With these a cell of a spreadsheet begins that is calculated, not shown.
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")


def printable(text: str) -> str:
    """Text with escapes in place of what would steer a terminal, as ``\\x1b``."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def in_a_cell(text: str) -> str:
    """Text for a table that spreadsheets open: an apostrophe before what would be a formula."""
    return "'" + text if text.startswith(FORMULA) else text


def quoted(text: str) -> str:
    """Text in double quotes, on one line and not too long."""
    short = text if len(text) <= LONGEST else text[:LONGEST] + "..."
    return printable(json.dumps(short, ensure_ascii=False))


def suggestion(name: str, known: Sequence[str]) -> str:
    """End of a sentence on an unknown name: the nearest known one, or the first few."""
    close = get_close_matches(name, known, n=1, cutoff=0.5)
    if close:
        return f"did you mean {quoted(close[0])}?"
    if len(known) == 1:
        return f"only {quoted(known[0])} is known"
    return "known are " + ", ".join(map(quoted, known[:MOST])) + ", ..." * (len(known) > MOST)


def millimetres(length: float) -> str:
    """A length [m] in mm, to three digits or to the millimetre."""
    mm = 1e3 * length
    return f"{mm:.3g} mm" if mm < 1e3 else f"{mm:.0f} mm"


def listed(names: Sequence[str]) -> str:
    """The first few names in quotes, and how many more there are."""
    shown = ", ".join(map(quoted, names[:FEW]))
    return shown + (f" and {len(names) - FEW} more" if len(names) > FEW else "")
