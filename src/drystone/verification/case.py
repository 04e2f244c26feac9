"""One number to be computed, with what is expected of it, from where, and how near it has to be."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

#: Engines of the program itself.
ENGINES = ("equilibrium", "nscd", "distinct")

#: What a case is compared with.
CLOSED_FORM, PROGRAM, LABORATORY = "closed form", "program", "laboratory"

#: What comes of a case: within its bound; beyond it, and that is known with its cause; beyond it.
OK, KNOWN, FAILS = "ok", "known miss", "FAILS"


@dataclass(frozen=True, kw_only=True)
class Case:
    """One number to be computed."""

    name: str
    section: str  # of the page
    kind: str  # `CLOSED_FORM`, `PROGRAM` or `LABORATORY`
    source: str  # of what is expected
    expected: float  # zero of what is a difference itself
    compute: Callable[[], float]
    bound: float  # most of the error's size
    reason: str  # of the bound
    known: str = ""  # why the error is beyond the bound, where that is known
    quick: bool = True  # part of the quick set


@dataclass(frozen=True, kw_only=True)
class Checked:
    """What came of a case."""

    case: Case
    got: float
    seconds: float

    @property
    def error(self) -> float:
        """Relative difference from what is expected; the difference itself where that is zero."""
        expected = self.case.expected
        return self.got / expected - 1.0 if expected else self.got

    @property
    def outcome(self) -> str:
        """`OK`, `KNOWN` or `FAILS`; a number that is none fails."""
        if abs(self.error) <= self.case.bound:
            return OK
        return KNOWN if self.case.known and abs(self.error) < float("inf") else FAILS

    def as_dict(self) -> dict[str, str | float]:
        """For JSON."""
        case = self.case
        return {
            "case": case.name,
            "section": case.section,
            "kind": case.kind,
            "source": case.source,
            "expected": case.expected,
            "got": self.got,
            "error": self.error,
            "bound": case.bound,
            "reason": case.reason,
            "known": case.known,
            "outcome": self.outcome,
            "seconds": self.seconds,
        }


def checked(cases: Iterable[Case]) -> Iterator[Checked]:
    """Compute cases one after another."""
    for case in cases:
        begun = time.perf_counter()
        got = float(case.compute())
        yield Checked(case=case, got=got, seconds=time.perf_counter() - begun)
