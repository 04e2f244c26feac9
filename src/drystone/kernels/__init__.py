"""Everything compiled: arrays and floats only, no objects, nothing allocated that a caller could.

Functions that call each other stay in one file, because the compiler's on-disk cache does not
notice when a function in another file changes.  The one exception is `path`, which solves with the
factors of `block_lu` at every change: who edits `block_lu` deletes the cache, `__pycache__`.
"""

from drystone.kernels import cache

cache.provide()
