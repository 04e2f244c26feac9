"""Pairs of boxes that intersect, through a uniform grid of cells; in the plane it has one layer."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import ROUNDING, TINY

#: Cells at most: this many a box, and some more, so that scattered blocks do not make empty grids.
CELLS_PER_BOX, CELLS_MORE = 16, 1000


def grid_of(lower, upper):
    """Origin, cell size and cell counts (3,) of a grid with about one box a cell."""
    dim = lower.shape[1]
    origin = lower.min(axis=0)
    extent = np.maximum(upper.max(axis=0) - origin, TINY)
    size = np.maximum(np.median(upper - lower, axis=0), ROUNDING * extent.max())
    most = CELLS_PER_BOX * len(lower) + CELLS_MORE
    along = np.floor(extent / size) + 1.0
    while along.prod() > most:
        widest = along.argmax()
        size[widest] *= 2.0
        along[widest] = np.floor(extent[widest] / size[widest]) + 1.0
    counts = np.ones(3, np.int64)
    counts[:dim] = along
    return origin, size, counts


@njit(cache=True)
def cells_of(lower, upper, origin, size, counts, cells):
    """First and last cell of each box along each axis, into ``cells`` (n, 6).

    Returns how many cells there are that a box covers, of all boxes together.
    """
    total = 0
    for box in range(lower.shape[0]):
        covered = 1
        for axis in range(lower.shape[1]):
            first = int((lower[box, axis] - origin[axis]) / size[axis])
            last = int((upper[box, axis] - origin[axis]) / size[axis])
            cells[box, 2 * axis] = min(max(first, 0), counts[axis] - 1)
            cells[box, 2 * axis + 1] = min(last, counts[axis] - 1)
            covered *= cells[box, 2 * axis + 1] - cells[box, 2 * axis] + 1
        total += covered
    return total


@njit(cache=True)
def fill_cells(cells, counts, start, entries):
    """Counting sort of boxes into the cells they cover.

    ``start`` (n_cells + 2,) is filled with the offsets of each cell's list in ``entries``: that of
    cell c is ``entries[start[c]:start[c + 1]]``.
    """
    start[:] = 0
    n = cells.shape[0]
    for box in range(n):
        for i in range(cells[box, 0], cells[box, 1] + 1):
            for j in range(cells[box, 2], cells[box, 3] + 1):
                row = (i * counts[1] + j) * counts[2]
                for cell in range(row + cells[box, 4], row + cells[box, 5] + 1):
                    start[cell + 2] += 1
    for cell in range(2, start.size):
        start[cell] += start[cell - 1]
    for box in range(n):
        for i in range(cells[box, 0], cells[box, 1] + 1):
            for j in range(cells[box, 2], cells[box, 3] + 1):
                row = (i * counts[1] + j) * counts[2]
                for cell in range(row + cells[box, 4], row + cells[box, 5] + 1):
                    entries[start[cell + 1]] = box
                    start[cell + 1] += 1


@njit(cache=True)
def pairs_in_cells(lower, upper, cells, counts, start, entries, out, most):
    """Write intersecting pairs (a < b) into ``out`` (m, 2) and return how many there are.

    A pair that shares several cells is taken in the one that holds the lower corner of the
    boxes' intersection.  With too small an ``out`` the pairs are only counted, up to one more
    than ``most``.
    """
    dim = lower.shape[1]
    found = 0
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                cell = (i * counts[1] + j) * counts[2] + k
                last = start[cell + 1]
                for p in range(start[cell], last):
                    a = entries[p]
                    for q in range(p + 1, last):
                        b = entries[q]
                        overlap = max(cells[a, 0], cells[b, 0]) == i
                        overlap = overlap and max(cells[a, 2], cells[b, 2]) == j
                        overlap = overlap and max(cells[a, 4], cells[b, 4]) == k
                        for axis in range(dim):
                            overlap = overlap and lower[a, axis] <= upper[b, axis]
                            overlap = overlap and lower[b, axis] <= upper[a, axis]
                        if not overlap:
                            continue
                        if found < out.shape[0]:
                            out[found, 0] = min(a, b)
                            out[found, 1] = max(a, b)
                        found += 1
                        if found > most:
                            return found
    return found
