"""Words that sentences about a model share, with those on names."""

from __future__ import annotations

from drystone.common.names import FEW, LONGEST, MOST, listed, printable, quoted, suggestion

__all__ = [
    "FEW",
    "LONGEST",
    "MOST",
    "in_a_cell",
    "listed",
    "millimetres",
    "printable",
    "quoted",
    "suggestion",
]

#: With these a cell of a spreadsheet begins that is calculated, not shown; the last four
#: are the first ones in full width.
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20")


def in_a_cell(text: str) -> str:
    """Text for a table that spreadsheets open: an apostrophe before what would be a formula."""
    return "'" + text if text.startswith(FORMULA) else text


def millimetres(length: float) -> str:
    """A length [m] in mm, to three digits or to the millimetre."""
    mm = 1e3 * length
    return f"{mm:.3g} mm" if mm < 1e3 else f"{mm:.0f} mm"
