"""Pairs of boxes that intersect, through a uniform grid of cells."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def _cell_range(lower, upper, origin, size, counts, box, axis):
    first = int((lower[box, axis] - origin[axis]) / size[axis])
    last = int((upper[box, axis] - origin[axis]) / size[axis])
    return max(first, 0), min(last, counts[axis] - 1)


@njit(cache=True)
def fill_cells(lower, upper, origin, size, counts, start, entries):
    """Counting sort of boxes into the cells they cover.

    ``start`` (n_cells + 1,) is filled with the offsets of each cell's list in ``entries``.  With an
    empty ``entries`` only the offsets are made, so that the caller can allocate it.
    """
    n = lower.shape[0]
    start[:] = 0
    for box in range(n):
        i0, i1 = _cell_range(lower, upper, origin, size, counts, box, 0)
        j0, j1 = _cell_range(lower, upper, origin, size, counts, box, 1)
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                start[i * counts[1] + j + 1] += 1
    for cell in range(start.size - 1):
        start[cell + 1] += start[cell]
    if entries.size == 0:
        return
    cursor = start[:-1].copy()
    for box in range(n):
        i0, i1 = _cell_range(lower, upper, origin, size, counts, box, 0)
        j0, j1 = _cell_range(lower, upper, origin, size, counts, box, 1)
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                cell = i * counts[1] + j
                entries[cursor[cell]] = box
                cursor[cell] += 1


@njit(cache=True)
def pairs_in_cells(lower, upper, origin, size, counts, start, entries, out):
    """Write intersecting pairs (a < b) into ``out`` (m, 2) and return how many there are.

    A pair that shares several cells is taken in the one that holds the lower corner of the
    boxes' intersection.  With too small an ``out`` the pairs are only counted.
    """
    found = 0
    for i in range(counts[0]):
        for j in range(counts[1]):
            cell = i * counts[1] + j
            for p in range(start[cell], start[cell + 1]):
                a = entries[p]
                for q in range(p + 1, start[cell + 1]):
                    b = entries[q]
                    x = max(lower[a, 0], lower[b, 0])
                    y = max(lower[a, 1], lower[b, 1])
                    if x > min(upper[a, 0], upper[b, 0]) or y > min(upper[a, 1], upper[b, 1]):
                        continue
                    home_i = min(max(int((x - origin[0]) / size[0]), 0), counts[0] - 1)
                    home_j = min(max(int((y - origin[1]) / size[1]), 0), counts[1] - 1)
                    if home_i != i or home_j != j:
                        continue
                    if found < out.shape[0]:
                        out[found, 0] = min(a, b)
                        out[found, 1] = max(a, b)
                    found += 1
    return found


def grid_of(lower, upper):
    """Origin, cell size and cell counts of a grid with about one box a cell."""
    origin = lower.min(axis=0)
    extent = np.maximum(upper.max(axis=0) - origin, 1e-12)
    size = np.maximum(np.median(upper - lower, axis=0), 1e-9 * extent.max())
    limit = 4.0 * np.sqrt(len(lower)) + 16.0  # keeps scattered blocks from making empty grids
    size = np.maximum(size, extent / limit)
    counts = np.floor(extent / size).astype(np.int64) + 1
    return origin, size, counts
