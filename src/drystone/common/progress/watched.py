"""Progress in Python: shown by default where somebody watches, on a terminal or in a notebook."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING, Any

from drystone.common.progress.forecast import Forecast
from drystone.common.progress.points import Bar, Lines

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from drystone.results.curve import CurvePoint

#: Seconds of work before anything is shown.
SHORT = 2.0


def somebody_watches() -> bool:
    """Whether standard error is a terminal, or code runs in a notebook."""
    return sys.stderr.isatty() or _in_notebook()


def _in_notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return type(shell).__name__ == "ZMQInteractiveShell"


def points_shown(
    title: str, stop_multiplier: float, wanted: bool | None
) -> AbstractContextManager[Callable[[CurvePoint], None] | None]:
    """What is told the points of an analysis, None where nothing is shown.

    Parameters
    ----------
    wanted
        None: where somebody watches.
    """
    if not (somebody_watches() if wanted is None else wanted):
        return nullcontext()
    forecast = Forecast(stop_multiplier)
    if not _bars():
        return Lines(title, forecast)
    return _later(Bar(title, forecast))


@contextmanager
def counted(title: str, total: int, wanted: bool | None) -> Iterator[Callable[..., None]]:
    """What is called as each of several analyses ends; ``wanted`` as of `points_shown`."""
    if not (somebody_watches() if wanted is None else wanted) or not _bars():
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    bar = Progress(
        TextColumn("{task.description}", markup=False), BarColumn(bar_width=12),
        MofNCompleteColumn(), TimeElapsedColumn(),
        console=Console(stderr=True), refresh_per_second=5, transient=True,
    )  # fmt: skip
    task = bar.add_task(title, total=total)
    with bar:
        yield lambda *_: bar.advance(task)


def _bars() -> bool:
    """Whether bars can be drawn: in notebooks they are widgets."""
    if not _in_notebook():
        return True
    from importlib.util import find_spec

    return find_spec("ipywidgets") is not None


@contextmanager
def _later(bar: Any) -> Iterator[Callable[[CurvePoint], None]]:
    """A bar that comes up once the work has taken a while, so that short work shows none."""
    lock, ended, shown = threading.Lock(), False, False

    def show() -> None:
        nonlocal shown
        with lock:
            if not ended:
                bar.__enter__()
                shown = True

    timer = threading.Timer(SHORT, show)
    timer.daemon = True
    timer.start()
    try:
        yield bar
    finally:
        timer.cancel()
        with lock:
            ended = True
        if shown:
            bar.__exit__(None, None, None)
