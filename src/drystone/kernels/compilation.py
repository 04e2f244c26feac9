"""Notice of compilation: kernels are compiled once on a machine, when they are first needed."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from numba.core import event

COMPILE = "numba:compile"  # what is loaded from the cache on disk is no such event


class Compilation(event.Listener):
    """Times what is compiled inside a ``with`` statement, and tells when it begins.

    Parameters
    ----------
    begun
        Called once, before the first kernel is compiled; never where all are in the cache.
    """

    def __init__(self, begun: Callable[[], None] | None = None) -> None:
        self._begun = begun
        self._depth = 0  # a kernel is compiled inside the one that calls it
        self._start = 0.0
        self.seconds = 0.0
        self.n_kernels = 0

    def on_start(self, event: Any) -> None:
        """A kernel begins to be compiled."""
        if not self.n_kernels and not self._depth and self._begun is not None:
            self._begun()
        if not self._depth:
            self._start = time.perf_counter()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """It is compiled, or could not be."""
        self._depth -= 1
        self.n_kernels += 1
        if not self._depth:
            self.seconds += time.perf_counter() - self._start

    def __enter__(self) -> Self:
        event.register(COMPILE, self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        event.unregister(COMPILE, self)
