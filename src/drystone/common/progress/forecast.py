"""How far an analysis has come, judged by its curve."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drystone.results.curve import CurvePoint

#: The peak counts as passed when the multiplier has lost this share of it.
PASSED = 0.02


class Forecast:
    """Share done and time left, from the descent of the multiplier towards its stop value.

    Before the peak nothing can be said: nobody knows yet how high it is.

    Parameters
    ----------
    stop_multiplier
        Multiplier at which the curve ends.
    clock
        Gives the time [s].
    """

    def __init__(self, stop_multiplier: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._stop = stop_multiplier
        self._clock = clock
        self._peak = 0.0
        self._peak_time = clock()
        self._now = self._peak_time
        self.share = 0.0  # of the descent, never going back

    def update(self, point: CurvePoint) -> None:
        """Take the next point."""
        self._now = self._clock()
        multiplier = point.load_multiplier
        if multiplier > self._peak:
            self._peak, self._peak_time, self.share = multiplier, self._now, 0.0
        elif multiplier < (1.0 - PASSED) * self._peak and self._peak > self._stop:
            share = (self._peak - multiplier) / (self._peak - self._stop)
            self.share = min(max(self.share, share), 1.0)

    @property
    def seconds_left(self) -> float | None:
        """Time left [s]; None before the descent has begun."""
        if self.share == 0.0:
            return None
        return (self._now - self._peak_time) * (1.0 - self.share) / self.share
