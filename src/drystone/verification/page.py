"""The table of cases as text for a terminal, and as a page in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from drystone.verification.case import FAILS, KNOWN, OK, Checked

HEADS = ("case", "compared with", "expected", "got", "error", "bound", "outcome", "s")
WIDTHS = (66, 46, 10, 10, 9, 8, 10, 6)
#: Columns that stand to the left.
LEFT = (0, 1)

#: Errors that rounding makes of none.
ROUNDED = 1e-12


def head() -> str:
    """The first line of the table on a terminal."""
    return _line(HEADS)


def line(row: Checked) -> str:
    """A case on a terminal."""
    return _line(
        (row.case.name, f"{row.case.kind}: {row.case.source}", *numbers(row), _seconds(row))
    )


def numbers(row: Checked) -> tuple[str, str, str, str, str]:
    """Expected, got, error, bound and outcome of a case."""
    case = row.case
    return (
        f"{case.expected:.5g}",
        f"{row.got:.5g}",
        "0" if abs(row.error) < ROUNDED else f"{row.error:+.1e}",
        f"{case.bound:.1e}",
        row.outcome,
    )


def summary(rows: Sequence[Checked]) -> str:
    """How many cases there are of each outcome."""
    n = {outcome: sum(row.outcome == outcome for row in rows) for outcome in (OK, KNOWN, FAILS)}
    known = f", {n[KNOWN]} known to be beyond it, with the cause," if n[KNOWN] else ""
    return f"{len(rows)} cases: {n[OK]} within their bound{known} {n[FAILS]} beyond it"


def markdown(rows: Sequence[Checked], introductions: dict[str, str], version: str) -> str:
    """The page of these cases."""
    total = sum(row.seconds for row in rows)
    parts = [
        "# Verification",
        f"This page is written by `drystone verify --all --out docs/reference/verification.md` "
        f"(version {version}). Each case computes one number. Its error is relative. If the "
        "expected number is zero, the error is the number itself. The reason of each bound stands "
        "below its table. `drystone verify` computes the cases marked with a dot, in two minutes. "
        "Its exit status is 1 if a case exceeds its bound.",
        f"{summary(rows)}. They took {total:.0f} s.",
    ]
    for title in dict.fromkeys(row.case.section for row in rows):
        chosen = [row for row in rows if row.case.section == title]
        parts += [f"## {title}", introductions[title], *_table(chosen)]
    return "\n\n".join(parts) + "\n"


def _table(rows: Sequence[Checked]) -> tuple[str, str]:
    """Table, and the reasons that its last column names."""
    reasons = list(dict.fromkeys(row.case.reason for row in rows))
    known = list(dict.fromkeys(row.case.known for row in rows if row.outcome == KNOWN))
    heads = ("case", "compared with", "expected", "got", "error", "bound", "outcome", "s", "quick")
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    for row in rows:
        expected, got, error, bound, outcome = numbers(row)
        letter = _letter(reasons.index(row.case.reason))
        why = f" ({known.index(row.case.known) + 1})" if outcome == KNOWN else ""
        cells = (
            row.case.name,
            row.case.source,
            *(expected, got, error, f"{bound} {letter}", f"{outcome}{why}"),
            _seconds(row),
            "•" if row.case.quick else "",
        )
        lines.append("| " + " | ".join(cells) + " |")
    notes = [f"- Bound {_letter(k)}: {reason}." for k, reason in enumerate(reasons)]
    notes += [f"- Known miss ({k}): {why}." for k, why in enumerate(known, 1)]
    return "\n".join(lines), "\n".join(notes)


def _letter(k: int) -> str:
    return "abcdefghijklmnopqrstuvwxyz"[k]


def _seconds(row: Checked) -> str:
    return f"{row.seconds:.1f}"


def _line(cells: Iterable[str]) -> str:
    return " ".join(
        cell.ljust(width) if k in LEFT else cell.rjust(width)
        for k, (cell, width) in enumerate(zip(cells, WIDTHS, strict=True))
    )
