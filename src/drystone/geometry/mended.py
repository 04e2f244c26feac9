"""What was done to a block that was drawn by others."""

from __future__ import annotations

from dataclasses import dataclass

#: How bent faces are cut: into fans from their first corners, or along their bends.
FANS, BENDS = "fans", "bends"


@dataclass(frozen=True, kw_only=True)
class Mended:
    """What was done to a block."""

    block: str
    what: str  # as the end of a sentence on blocks
    how_much: float = 0.0  # m, where something was moved
    count: int = 0  # of what was found, where that can be counted
    volume: float = 0.0  # m3, by which it became larger, where that depends on how it is done
    than: str = ""  # what that is against, as the end of a sentence "more than if cut"
