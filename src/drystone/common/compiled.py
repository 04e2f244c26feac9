"""The compiler of kernels, with a place where compiled kernels are kept.

A kernel takes arrays and floats only, no objects, and allocates nothing that its caller could.  It
stands in the file of its subject, and kernels of other files call it: `common.kernel_cache`
discards what was compiled from sources that have changed since.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

from drystone.common import kernel_cache
from drystone.common.kept_code import KernelCache

kernel_cache.provide()

__all__ = ["njit"]


def njit(*, cache: bool, **options: Any) -> Callable[[Any], Any]:
    """`numba.njit`; kernels to ``cache`` are kept, and found again, as `kept_code` says.

    Nothing calls kernels as C does, so that what would let it is not compiled: a twentieth of all.
    """
    compiler = numba.njit(no_cfunc_wrapper=True, **options)

    def kernel(function: Any) -> Any:
        made = compiler(function)
        if cache and made is not function:  # which it is where the compiler is switched off
            made._cache = KernelCache(function)
        return made

    return kernel
