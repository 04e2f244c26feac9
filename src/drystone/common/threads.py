"""Threads that share the work of one analysis.

Results are the same to the last bit whatever the number of threads: each thread does parts that do
not depend on each other, and what the parts yield is put together in an order of its own.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from typing import TypeVar

T = TypeVar("T")

_chosen: ContextVar[int | None] = ContextVar("threads", default=None)


def available() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def limited(number: int | None) -> Iterator[None]:
    """Within it, analyses take up to so many threads; None is as many as there are processors.

    Raises
    ------
    ValueError
        Fewer than one.
    """
    if number is not None and number < 1:
        raise ValueError(f"threads is {number}: it must be at least 1")
    token = _chosen.set(number)
    try:
        yield
    finally:
        _chosen.reset(token)


class Team:
    """So many threads, the caller's own among them."""

    def __init__(self, number: int) -> None:
        self.number = number
        self._others = ThreadPoolExecutor(number - 1, "drystone") if number > 1 else None

    def run(self, tasks: Sequence[Callable[[], T]]) -> list[T]:
        """What tasks return that can be done at the same time, the first by the caller's thread."""
        if self._others is None:
            return [task() for task in tasks]
        waiting = [self._others.submit(task) for task in tasks[1:]]
        try:
            first = tasks[0]()
        finally:  # what they write to must be left alone when this is over
            for future in waiting:
                future.exception()
        return [first, *(future.result() for future in waiting)]


def team() -> Team:
    """The threads that the present analysis may take."""
    return _team(_chosen.get() or available())


@cache
def _team(number: int) -> Team:
    return Team(number)
