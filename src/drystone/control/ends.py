"""When a curve is over, and why, whatever the strategy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from drystone.common.language import say

#: Share of a peak below the stop value to which the curve is followed: blocks that come loose let
#: a multiplier drop and rise again, though not from next to nothing.
FALLEN = 0.01
#: Steps in which whatever carries anything carries more than `FALLEN` of the stop value.
EARLY = 100
#: Likewise of a multiplier that does not rise at all, but for steps that move next to nothing.
AT_ONCE = 3

#: Beginning of why a curve ends in motion.
COLLAPSED = say("end.collapsed", how="").removesuffix(": ")


class EndSettings(Protocol):
    """What every strategy's settings say about the end."""

    @property
    def stop_multiplier(self) -> float:
        """Under which the curve ends, after the peak."""
        ...

    @property
    def max_displacement(self) -> float:
        """Of the control point [m], at which the curve ends."""
        ...

    @property
    def max_steps(self) -> int:
        """After which the analysis stops."""
        ...


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a curve has come."""

    multiplier: float  # static, of the last point
    highest: float  # so far, the last point included; 0 at the start
    displacement: float  # m, of the control point
    n_steps: int
    static: bool = True  # whether the last point is at rest
    highest_at: float = float("-inf")  # m, control displacement of the highest multiplier


@dataclass(frozen=True, kw_only=True)
class End:
    """Why the analysis is over; `finished` where the curve is complete."""

    reason: str
    finished: bool = False


def fallen_freely(highest: float, stop_multiplier: float) -> End:
    """The end of what has fallen for long without load: of a complete curve, if ever it carried."""
    return collapsed(say("end.no_load"), highest, stop_multiplier)


def collapsed(how: str, highest: float, stop_multiplier: float) -> End:
    """The end in motion: of a complete curve, if ever it carried."""
    return End(reason=say("end.collapsed", how=how), finished=highest > stop_multiplier)


def end_of_curve(settings: EndSettings, progress: Progress) -> End | None:
    """The end of a curve that has come so far, or None.

    A multiplier passed in motion ends nothing: what moves may come to rest and carry again.  Nor
    does one where the control point has gone back behind the peak: a block comes loose, and the
    rest, relieved of the load, still stands as it stood.
    """
    s, p = settings, progress
    onwards = p.static and p.displacement >= p.highest_at
    if p.displacement >= s.max_displacement:
        key = "end.reached" if p.static else "end.reached_moving"
        return End(reason=say(key, most=s.max_displacement), finished=p.static)
    if onwards and p.multiplier < s.stop_multiplier < p.highest:
        return End(reason=say("end.fell_below", stop=s.stop_multiplier), finished=True)
    nothing = carries_nothing(s, p.highest)
    down = onwards and p.multiplier < FALLEN * p.highest <= FALLEN * s.stop_multiplier
    if down and not nothing:
        return End(reason=say("end.low_peak", peak=p.highest, stop=s.stop_multiplier))
    if nothing and p.n_steps >= (AT_ONCE if down else EARLY):
        return nothing_carried(s, p.n_steps)
    if p.n_steps >= s.max_steps:
        return End(reason=say("end.steps", n=s.max_steps))
    return None


def carries_nothing(settings: EndSettings, highest: float) -> bool:
    """Whether the highest multiplier so far is none to speak of."""
    return highest < FALLEN * settings.stop_multiplier


def nothing_carried(settings: EndSettings, n_steps: int) -> End:
    """The end of a structure that carries nothing."""
    least = FALLEN * settings.stop_multiplier
    return End(reason=say("end.carries_nothing", n=n_steps, least=least))
