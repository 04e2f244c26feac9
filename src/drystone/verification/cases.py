"""All cases, and the quick set."""

from __future__ import annotations

from drystone.verification import bias, cycles, plane, published, space, walls
from drystone.verification.case import Case

#: Where cases are from, in the order of the page.
PARTS = (plane, cycles, space, published, bias, walls)


def cases(*, everything: bool = False) -> list[Case]:
    """The quick set, or all cases."""
    return [case for part in PARTS for case in part.cases() if everything or case.quick]


def introductions() -> dict[str, str]:
    """What the page says over each section, by its title."""
    return {title: text for part in PARTS for title, text in part.SECTIONS.items()}
