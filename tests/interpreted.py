"""How much is tried where kernels are interpreted, which takes a hundred times as long.

Numbers are for the compiled kernels; interpreted, an index out of range is looked for.
"""

from __future__ import annotations

import os

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


def fewer(number: int, interpreted: int) -> int:
    """A number of examples, or that of interpreted kernels."""
    return interpreted if INTERPRETED else number
