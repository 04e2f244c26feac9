"""What stops an assessment: something is missing, or a method does not apply."""

from __future__ import annotations

import math


class AssessmentError(Exception):
    """No verdict can be given; the message says what is missing and what would mend it."""

    @property
    def said(self) -> str:
        """The message, a `Saying` where the tables of the languages have it."""
        return self.args[0] if self.args and isinstance(self.args[0], str) else str(self)


class MissingError(AssessmentError):
    """A method needs something that was not said; the message names the key."""


class UnfinishedError(AssessmentError):
    """The curve does not go far enough for a verdict; the message says what is missing of it."""


def positive(value: float | None, what: str, mend: str = "give a number above zero") -> float:
    """The value as a float; `AssessmentError` unless it is finite and above zero."""
    if value is None:
        raise AssessmentError(f"{what} is missing: {mend}")
    number = float(value)
    if not math.isfinite(number) or number <= 0.0:
        raise AssessmentError(f"{what} is {number:g}: {mend}")
    return number


def not_negative(value: float | None, what: str, mend: str = "give zero or more") -> float:
    """The value as a float; `AssessmentError` unless it is finite and not below zero."""
    if value is not None and float(value) == 0.0:
        return 0.0
    return positive(value, what, mend)
