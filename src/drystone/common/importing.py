"""Imports of much at once, by a command that is to answer soon."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def importing() -> Iterator[None]:
    """Leave garbage alone while modules are imported, and these alone afterwards.

    What modules make stays: the collector would look through it again and again, for a tenth of the
    time that importing takes.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if collecting:
            gc.enable()
