"""``max_displacement``: the curve ends if the control displacement reaches this value."""

from __future__ import annotations

from drystone.common.keys import Key, Number
from drystone.common.language import say
from drystone.common.ranges import RANGES
from drystone.common.tolerances import AT_TARGET
from drystone.control.progress import End, Progress
from drystone.control.stops import Stop


def _end(most: float, progress: Progress) -> End | None:
    if progress.displacement < most * (1.0 - AT_TARGET):
        return None
    key = "end.reached" if progress.static else "end.reached_moving"
    return End(reason=say(key, most=most), finished=progress.static)


STOP = Stop(
    key=Key(name="max_displacement", type=Number(RANGES["max_displacement"]), default=None),  # m
    end=_end,
    first=True,
    is_displacement=True,
)
