"""Broad phase: which blocks are near enough to be looked at, in near-linear time."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.errors import ModelError
from drystone.common.ranges import CROWD, CROWDED
from drystone.geometry import boxes as kernels

#: Up to as many boxes each is compared with each: that is done before compiled code is loaded.
FEW = 64


def candidate_pairs(lower: Array, upper: Array) -> tuple[IntArray, IntArray]:
    """Pairs of boxes that intersect, touching ones included.

    Parameters
    ----------
    lower, upper
        Corners of the boxes, (n, dim) [m].

    Returns
    -------
    a, b
        (n_pairs,) each, ``a < b``, sorted by ``a`` and then ``b``.

    Raises
    ------
    ModelError
        Nearly all boxes meet nearly all others; they are counted before they are kept.
    """
    lower = np.ascontiguousarray(lower, dtype=np.float64)
    upper = np.ascontiguousarray(upper, dtype=np.float64)
    if len(lower) < 2:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    if len(lower) <= FEW:
        overlap = np.all(lower[:, None] <= upper[None], axis=2)
        a, b = np.nonzero(np.triu(overlap & overlap.T, k=1))
        return a, b
    origin, size, counts = kernels.grid_of(lower, upper)
    cells = np.zeros((len(lower), 6), np.int64)
    entries = np.zeros(kernels.cells_of(lower, upper, origin, size, counts, cells), np.int64)
    start = np.zeros(int(counts.prod()) + 2, np.int64)
    kernels.fill_cells(cells, counts, start, entries)
    out = np.zeros((8 * len(lower), 2), np.int64)
    most = max(CROWD, CROWDED * len(lower))
    found = kernels.pairs_in_cells(lower, upper, cells, counts, start, entries, out, most)
    if found > most:
        raise ModelError(
            [
                f"block: more than {most:,} pairs of {len(lower):,} blocks, or of their parts, "
                "stand on the same place: move them apart"
            ]
        )
    if found > len(out):
        out = np.zeros((found, 2), np.int64)
        kernels.pairs_in_cells(lower, upper, cells, counts, start, entries, out, most)
    pairs = out[:found]
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    return np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])
