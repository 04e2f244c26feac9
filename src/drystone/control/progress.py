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
    #: Whether the multiplier fell, or stayed, while the control point went on.  If a bond or a tie
    #: breaks, the multiplier drops while the control point stays, and rises again afterwards.
    multiplier_falls: bool = True

    def may_end(self, least: float) -> bool:
        """Whether a low multiplier may end the curve here: at rest, not as a bond breaks, and at a
        control displacement of at least ``least`` [m]."""
        return self.static and self.multiplier_falls and self.displacement >= least


@dataclass(frozen=True, kw_only=True)
class End:
    """Why the analysis is over; `finished` if the curve is complete."""

    reason: str
    finished: bool = False
