"""When a curve is over, and why, whatever the strategy."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from drystone.common import tolerances
from drystone.common.language import say
from drystone.control.progress import End, Progress
from drystone.control.stops import Stops, stops_of

__all__ = [
    "AT_ONCE",
    "COLLAPSED",
    "EARLY",
    "End",
    "EndSettings",
    "Progress",
    "carries_nothing",
    "collapsed",
    "end_of_curve",
    "fallen_freely",
    "nothing_carried",
    "stop_after",
]

#: Steps in which whatever carries anything carries more than `NEXT_TO_NOTHING` of the stop value.
EARLY = 100
#: The same where the multiplier falls at once, by more than the stop value.
AT_ONCE = 3

#: Beginning of why a curve ends in motion.
COLLAPSED = say("end.collapsed", how="").removesuffix(": ")


@dataclass(frozen=True, kw_only=True)
class EndSettings:
    """What every strategy's settings say about the end."""

    stop_multiplier: float = (
        tolerances.STOP_MULTIPLIER
    )  # under which the curve ends, after the peak
    stops: Stops = field(default_factory=lambda: stops_of({}))  # see `drystone.control.stops`
    farthest: float = math.inf  # m, that the control point moves: what is lifted has no end

    def stop_after(self, highest: float) -> float:
        """The multiplier under which a curve with such a peak ends."""
        return stop_after(highest, self.stop_multiplier)


def stop_after(highest: float, stop_multiplier: float) -> float:
    """The multiplier under which a curve with a peak ends: the stop value, or, where that is the
    default, a share of the peak that is less; of a peak that is followed at all."""
    if stop_multiplier != tolerances.STOP_MULTIPLIER or highest <= tolerances.LEAST_LOAD:
        return stop_multiplier
    return min(stop_multiplier, tolerances.STOP_SHARE * highest)


def fallen_freely(highest: float, stop_multiplier: float) -> End:
    """The end of what has fallen for long without load: of a complete curve, if ever it carried."""
    return collapsed(say("end.no_load"), highest, stop_multiplier)


def collapsed(how: str, highest: float, stop_multiplier: float) -> End:
    """The end in motion: of a complete curve, if ever it carried."""
    carried = highest > stop_after(highest, stop_multiplier)
    return End(reason=say("end.collapsed", how=how), finished=carried)


def end_of_curve(settings: EndSettings, progress: Progress) -> End | None:
    """The end of a curve that has come so far, or None.

    A multiplier passed in motion ends nothing: what moves may come to rest and carry again.  Nor
    does one where the control point has moved back behind the peak: a block comes loose, and the
    rest, relieved of the load, still stands as it stood.  Nor one to which the multiplier has
    dropped where a bond broke, or from which it rises: the rest of the joint takes the load up.
    """
    s, p = settings, progress
    onwards = p.may_end(p.highest_at)
    for stop, value in s.stops:
        if stop.first and (end := stop.end(value, p)):
            return end
    stop_value = s.stop_after(p.highest)
    if onwards and p.multiplier < stop_value < p.highest:
        return End(reason=say("end.fell_below", stop=stop_value), finished=True)
    nothing = carries_nothing(s, p.highest)
    share = tolerances.NEXT_TO_NOTHING
    down = onwards and p.multiplier < share * p.highest <= share * s.stop_multiplier
    if down and not nothing:
        return End(reason=say("end.low_peak", peak=p.highest, stop=s.stop_multiplier))
    falls = down and p.multiplier < -s.stop_multiplier
    if nothing and p.n_steps >= (AT_ONCE if falls else EARLY):
        return nothing_carried(s, p.n_steps)
    for stop, value in s.stops:
        if not stop.first and (end := stop.end(value, p)):
            return end
    if p.static and abs(p.displacement) > s.farthest * (1.0 + tolerances.ROUNDING):
        return End(reason=say("end.farthest", most=s.farthest))
    return None


def carries_nothing(settings: EndSettings, highest: float) -> bool:
    """Whether the highest multiplier so far is none to speak of."""
    return highest < tolerances.NEXT_TO_NOTHING * settings.stop_multiplier


def nothing_carried(settings: EndSettings, n_steps: int) -> End:
    """The end of a structure that carries nothing."""
    least = tolerances.NEXT_TO_NOTHING * settings.stop_multiplier
    return End(reason=say("end.carries_nothing", n=n_steps, least=least))
