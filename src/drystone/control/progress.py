"""How far a curve has come, and that it is over."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a curve has come."""

    multiplier: float  # static, of the last point
    highest: float  # so far, the last point included; 0 at the start
    displacement: float  # m, of the control point
    n_steps: int
    static: bool = True  # whether the last point is at rest
    highest_at: float = float("-inf")  # m, control displacement of the highest multiplier
    #: Whether the multiplier fell to where it is, or stayed, as the control point went on.  Where a
    #: bond or a tie breaks it drops while the control point stays, and rises again from there.
    multiplier_falls: bool = True

    def may_end(self, least: float) -> bool:
        """Whether its multiplier, if low, ends a curve whose control point went on from ``least``
        [m]: at rest, and not as a bond breaks."""
        return self.static and self.multiplier_falls and self.displacement >= least


@dataclass(frozen=True, kw_only=True)
class End:
    """Why the analysis is over; `finished` where the curve is complete."""

    reason: str
    finished: bool = False
