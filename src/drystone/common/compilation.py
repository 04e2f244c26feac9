"""Notice of compilation: kernels are compiled once on a machine, when they are first needed."""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Callable
from importlib import import_module
from types import TracebackType
from typing import Any, Self

from numba import typeof
from numba.core import event
from numba.core.dispatcher import Dispatcher

from drystone.common import kernel_cache

COMPILE = "numba:compile"  # what is loaded from the cache on disk is no such event


class Compilation(event.Listener):
    """Times what is compiled inside a ``with`` statement, and tells when it begins.

    No garbage is looked for while a kernel is compiled: the compiler makes millions of objects, and
    looking through them takes a tenth of the time.

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
            _Garbage.leave()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """It is compiled, or could not be."""
        self._depth -= 1
        self.n_kernels += 1
        if not self._depth:
            self.seconds += time.perf_counter() - self._start
            _Garbage.look_for()

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


class _Garbage:
    """Left alone from the first of those that are told of a kernel to the last."""

    told = 0  # those that have been told that one is compiled, and not yet that it is done
    looked_for = True  # before

    @classmethod
    def leave(cls) -> None:
        if not cls.told:
            cls.looked_for = gc.isenabled()
            gc.disable()
        cls.told += 1

    @classmethod
    def look_for(cls) -> None:
        cls.told -= 1
        if not cls.told and cls.looked_for:
            gc.enable()


def rehearse(run: Callable[[], object]) -> list[tuple[Any, tuple[Any, ...]]]:
    """Kernels that ``run`` calls and the types it calls them with, without compiling any.

    They are interpreted, which is fast enough for a very small structure.  To be called in a
    process of its own, before anything keeps a kernel elsewhere than under a name of its module.
    """
    for name in kernel_cache.modules():
        import_module(name)
    own = __name__.partition(".")[0]
    # Also of modules that have taken kernels over by their names.
    found = [
        (module, name, value)
        for module_name, module in list(sys.modules.items())
        if module_name.partition(".")[0] == own
        for name, value in vars(module).items()
        if isinstance(value, Dispatcher)
    ]
    calls: dict[tuple[Any, tuple[Any, ...]], None] = {}  # as a set in order
    depth = 0

    def interpreted(kernel: Any) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            nonlocal depth
            if not depth:  # the compiler finds by itself what a kernel calls
                calls[kernel, tuple(map(typeof, arguments))] = None
            depth += 1
            try:
                return kernel.py_func(*arguments)
            finally:
                depth -= 1

        return call

    for module, name, kernel in found:
        setattr(module, name, interpreted(kernel))
    try:
        run()
    finally:
        for module, name, kernel in found:
            setattr(module, name, kernel)
    return list(calls)
