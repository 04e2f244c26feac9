"""Everything compiled: arrays and floats only, no objects, nothing allocated that a caller could.

Functions that call each other stay in one file, because the compiler's on-disk cache does not
notice when a function in another file changes.
"""
