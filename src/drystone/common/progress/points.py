"""Progress on standard error: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, Protocol, Self

from drystone.common.names import number_of, printable
from drystone.common.progress.forecast import Forecast

if TYPE_CHECKING:
    from drystone.results.curve import CurvePoint

#: Seconds between two lines where there is no terminal.
SECONDS_BETWEEN_LINES = 10.0


class Progress(AbstractContextManager["Progress"], Protocol):
    """Shows the points of one analysis as they come; used in a ``with`` statement."""

    def __call__(self, point: CurvePoint) -> None: ...


def progress_for(title: str, stop_multiplier: float, *, quiet: bool) -> Progress:
    """The kind of progress that suits standard error."""
    if quiet:
        return Silent()
    title = printable(title)
    forecast = Forecast(stop_multiplier)
    return Bar(title, forecast) if sys.stderr.isatty() else Lines(title, forecast)


class Silent:
    """Shows nothing."""

    def __call__(self, point: CurvePoint) -> None:
        """Nothing to do."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        """Nothing to do."""


class Lines(Silent):
    """A line at most every ten seconds."""

    def __init__(self, title: str, forecast: Forecast) -> None:
        self._title, self._forecast = title, forecast
        self._next = time.monotonic() + SECONDS_BETWEEN_LINES
        self._n_points = 0

    def __call__(self, point: CurvePoint) -> None:
        """Write a line if it is time."""
        self._n_points += 1
        self._forecast.update(point)
        now = time.monotonic()
        if now >= self._next:
            self._next = now + SECONDS_BETWEEN_LINES
            left = self._forecast.seconds_left
            tail = "" if left is None else f", about {clock_time(left)} left"
            print(
                f"{self._title}: {state_of(point)}, {number_of(self._n_points, 'point')}{tail}",
                file=sys.stderr,
                flush=True,
            )


class Bar(Silent):
    """A bar that fills with the descent of the multiplier."""

    def __init__(self, title: str, forecast: Forecast) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        self._forecast = forecast
        self._n_points = 0
        self._next = 0.0
        self._bar: Any = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=12),
            TextColumn("{task.fields[state]}"),
            TextColumn("{task.fields[count]}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            console=Console(stderr=True),
            refresh_per_second=5,
            transient=True,
        )
        self._task = self._bar.add_task(title, total=None, state="dead load", count="", left="")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._bar.stop()

    def __call__(self, point: CurvePoint) -> None:
        """Move the bar, a few times a second."""
        self._n_points += 1
        self._forecast.update(point)
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + 0.1
        left = self._forecast.seconds_left
        self._bar.update(
            self._task,
            total=None if left is None else 1.0,  # a bar without an end until the peak is passed
            completed=self._forecast.share,
            state=f"{point.control_displacement:.4f} m, λ {point.load_multiplier:.3f}",
            count=number_of(self._n_points, "point"),
            left="" if left is None else f"{clock_time(left)} left",
        )


def state_of(point: CurvePoint) -> str:
    """Where the curve is, in a few words."""
    return f"at {point.control_displacement:.4f} m, multiplier {point.load_multiplier:.3f}"


def clock_time(seconds: float) -> str:
    """``m:ss``, or ``h:mm:ss`` from an hour on."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
