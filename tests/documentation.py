"""Pages of the documentation as tests read them: blocks of code, what is said about each, prose.

A comment before a block says what becomes of it, and is not seen on the page:

- ``<!-- not run: REASON -->`` it is not run;
- ``<!-- run: COMMAND -->`` is run before it;
- ``<!-- file: NAME -->`` its text becomes that file, ``<!-- file: NAME = PATH -->`` which is also
  that file of the repository; ``<!-- append: NAME -->`` its text is added to the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]

_FENCE = re.compile(r"^```(.*)$")
_REMARK = re.compile(r"^<!-- (not run|run|file|append): (.*) -->$")
_NUMBER = re.compile(r"[-+]?(?:\d[\d,]*\.?\d*|\.\d+)(?:e[-+]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True, kw_only=True)
class CodeBlock:
    """One fenced block."""

    language: str
    text: str
    line: int  # of the page, counted from 1
    remarks: tuple[tuple[str, str], ...] = ()  # what comments before it say

    def remark(self, name: str) -> str | None:
        """What the comment of that name says."""
        return dict(self.remarks).get(name)


def code_blocks(text: str) -> list[CodeBlock]:
    """All fenced blocks of a page."""
    found: list[CodeBlock] = []
    remarks: list[tuple[str, str]] = []
    inside: list[str] | None = None
    language, begun = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        fence, remark = _FENCE.match(line), _REMARK.match(line)
        if inside is None and fence:
            inside, language, begun = [], fence.group(1).strip(), number
        elif inside is not None and fence:
            code = "".join(f"{one}\n" for one in inside)
            found.append(
                CodeBlock(language=language, text=code, line=begun, remarks=tuple(remarks))
            )
            inside, remarks = None, []
        elif inside is not None:
            inside.append(line)
        elif remark:
            remarks.append((remark.group(1), remark.group(2)))
        elif line.strip():
            remarks = []
    assert inside is None, f"the block that begins in line {begun} does not end"
    return found


def agrees(shown: str, printed: str, tolerance: float = 0.02) -> bool:
    """Whether a printed line is the one shown: words alike, numbers within a share of themselves.

    Three dots stand for anything.
    """
    shown, printed = " ".join(shown.split()), " ".join(printed.split())
    pattern = re.escape(_NUMBER.sub("\0", shown)).replace("\0", "(" + _NUMBER.pattern + ")")
    match = re.fullmatch(pattern.replace(r"\.\.\.", ".*"), printed, re.IGNORECASE)
    if match is None:
        return False
    for wanted, found in zip(_NUMBER.findall(shown), match.groups(), strict=True):
        a, b = (float(number.replace(",", "")) for number in (wanted, found))
        small = max(abs(a), abs(b)) < 1e-6  # rounding: only its size is shown
        if not small and abs(a - b) > tolerance * max(abs(a), abs(b)):
            return False
    return True


def missing(shown: list[str], printed: list[str]) -> list[str]:
    """Shown lines that are not printed, in this order."""
    at, lost = 0, []
    for line in shown:
        places = [i for i in range(at, len(printed)) if agrees(line, printed[i])]
        if places:
            at = places[0] + 1
        else:
            lost.append(line)
    return lost


def shown_by_prints(code: str) -> list[str]:
    """Comments right after a call of print: what it prints."""
    shown, after = [], False
    for line in code.splitlines():
        if line.startswith("# ") and after:
            shown.append(line[2:])
        else:
            after = line.startswith("print(")
    return shown
