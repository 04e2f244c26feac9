"""Everything compiled: arrays and floats only, no objects, nothing allocated that a caller could.

A function stands in the file of its subject and is called from the others: `cache` sees to it that
nothing compiled outlives a change of what it calls.
"""

from drystone.kernels import cache

cache.provide()
