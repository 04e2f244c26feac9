"""When a curve is over, and why.  The strategies share these rules."""

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
    "StepSettings",
    "carries_nothing",
    "collapsed",
    "end_of_curve",
    "fallen_freely",
    "nothing_carried",
    "stop_after",
]

#: Steps after which a structure that still carries less than `NEXT_TO_NOTHING` of the stop value
#: carries nothing.
EARLY = 100
#: The same number of steps if the multiplier falls at once to less than minus the stop value.
AT_ONCE = 3

#: Beginning of the reason of a curve that ends in motion.
COLLAPSED = say("end.collapsed", how="").removesuffix(": ")


@dataclass(frozen=True, kw_only=True)
class EndSettings:
    """Settings of the end of a curve, which all strategies have."""

    stop_multiplier: float = (
        tolerances.STOP_MULTIPLIER
    )  # under which the curve ends, after the peak
    stops: Stops = field(default_factory=lambda: stops_of({}))  # see `drystone.control.stops`
    farthest: float = math.inf  # m, of the control point: a block that is lifted moves for ever
    # Multiplier of a load that turns the ground, above which the ground stands upright.
    upright: float = math.inf

    def stop_after(self, highest: float) -> float:
        """The multiplier below which a curve whose peak is ``highest`` ends."""
        return stop_after(highest, self.stop_multiplier)

    @property
    def last_displacement(self) -> float:
        """The control displacement [m] at which the curve ends; infinite if none is given."""
        return min((value for stop, value in self.stops if stop.is_displacement), default=math.inf)


@dataclass(frozen=True, kw_only=True)
class StepSettings(EndSettings):
    """Settings of strategies whose steps have a length."""

    displacement_step: float  # m, of a step: each strategy says of what
    # m, the displacement step that suits the structure; None: the one that is taken
    suited_step: float | None = None

    @property
    def motion_length(self) -> float:
        """The length [m] by which motions of blocks are measured.

        It does not depend on the displacement step that somebody asks for, nor on the targets of a
        cyclic analysis: whether a structure has collapsed, or how far it moves in a step of a jump,
        is a matter of its size.
        """
        return self.displacement_step if self.suited_step is None else self.suited_step


def stop_after(highest: float, stop_multiplier: float) -> float:
    """The multiplier below which a curve whose peak is ``highest`` ends.

    It is the stop value.  If the stop value is the default, it is a share of the peak, if that is
    less; but not for peaks below the least load, which are not followed.
    """
    if stop_multiplier != tolerances.STOP_MULTIPLIER or highest <= tolerances.LEAST_LOAD:
        return stop_multiplier
    return min(stop_multiplier, tolerances.STOP_SHARE * highest)


def fallen_freely(highest: float, stop_multiplier: float) -> End:
    """The end of a structure that has fallen for long without load; see `collapsed`."""
    return collapsed(say("end.no_load"), highest, stop_multiplier)


def collapsed(how: str, highest: float, stop_multiplier: float) -> End:
    """The end in motion.  The curve is complete if its peak ``highest`` exceeds the stop value."""
    carried = highest > stop_after(highest, stop_multiplier)
    return End(reason=say("end.collapsed", how=how), finished=carried)


def end_of_curve(settings: EndSettings, progress: Progress) -> End | None:
    """The end of a curve at this point, or None if it goes on.

    A low multiplier does not end the curve in three cases.  In motion, blocks may come to rest and
    carry again.  If the control point has moved back behind the peak, a block has come loose, and
    the rest, relieved of the load, still stands as before.  If the multiplier has dropped as a bond
    broke, or rises again, the rest of the joint takes up the load.
    """
    s, p = settings, progress
    onwards = p.may_end(p.highest_at)
    for stop, value in s.stops:
        if stop.first and (end := stop.end(value, p)):
            return end
    if p.static and p.multiplier > s.upright:
        return End(reason=say("end.upright", multiplier=p.multiplier))
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
    """Whether the highest multiplier so far is negligible."""
    return highest < tolerances.NEXT_TO_NOTHING * settings.stop_multiplier


def nothing_carried(settings: EndSettings, n_steps: int) -> End:
    """The end of a structure that carries nothing."""
    least = tolerances.NEXT_TO_NOTHING * settings.stop_multiplier
    return End(reason=say("end.carries_nothing", n=n_steps, least=least))
