"""What hangs together: components of a graph of rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drystone.common.arrays import IntArray

#: Links up to which they are followed one by one: that is done before scipy is imported.
FEW = 5000


def components(n: int, first: ArrayLike, second: ArrayLike) -> IntArray:
    """Component of each of ``n`` rows, (n,): counted from 0 in the order of their first rows.

    Parameters
    ----------
    first, second
        Rows that are linked, (n_links,) each.
    """
    a, b = np.asarray(first, np.int64), np.asarray(second, np.int64)
    if len(a) > FEW:
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        links = coo_array((np.ones(len(a)), (a, b)), shape=(n, n))
        return np.asarray(connected_components(links, directed=False)[1], np.int64)
    root = list(range(n))

    def first_of(i: int) -> int:
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    for i, j in zip(a.tolist(), b.tolist(), strict=True):
        i, j = sorted((first_of(i), first_of(j)))
        root[j] = i
    firsts = np.array([first_of(i) for i in range(n)], dtype=np.int64)
    return np.asarray(np.unique(firsts, return_inverse=True)[1], np.int64)
