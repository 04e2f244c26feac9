"""The compiler of kernels, with a place where compiled kernels are kept.

A kernel takes arrays and floats only, no objects, and allocates nothing that its caller could.  It
stands in the file of its subject, and kernels of other files call it: `common.kernel_cache`
discards what was compiled from sources that have changed since.
"""

from numba import njit

from drystone.common import kernel_cache

kernel_cache.provide()

__all__ = ["njit"]
