"""How long a run goes on at a time, as [analysis] says; another run may go on from there."""

from __future__ import annotations

import time
from collections.abc import Mapping

from drystone.common.language import say

#: Keys of [analysis].
SITTING = ("max_points", "max_time")


class Sitting:
    """Points and seconds before a run pauses; one that goes on has as many again."""

    def __init__(self, options: Mapping[str, float]) -> None:
        self._points, self._seconds = options.get("max_points"), options.get("max_time")
        self._begun, self._first = time.monotonic(), 0

    def begin(self, n_points: int) -> None:
        """Begin after so many points."""
        self._first = n_points

    def over(self, n_points: int) -> str:
        """Why the run pauses after so many points; empty where it goes on."""
        if self._points is not None and n_points - self._first >= self._points:
            return str(say("end.max_points", n=int(self._points)))
        if self._seconds is not None and time.monotonic() - self._begun >= self._seconds:
            return str(say("end.max_time", seconds=self._seconds))
        return ""
