"""``max_steps``: the analysis stops after this number of steps."""

from __future__ import annotations

from drystone.common.keys import Key, Number
from drystone.common.language import say
from drystone.common.ranges import RANGES
from drystone.control.progress import End, Progress
from drystone.control.stops import Stop


def _end(most: float, progress: Progress) -> End | None:
    return End(reason=say("end.steps", n=int(most))) if progress.n_steps >= most else None


STOP = Stop(
    key=Key(name="max_steps", type=Number(RANGES["max_steps"]), default=100_000),
    end=_end,
)
