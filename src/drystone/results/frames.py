"""Which points of a curve are shown, where not all are."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from drystone.common.arrays import Array


def rows_along(control_displacement: Array, count: int, keep: Iterable[int] = ()) -> list[int]:
    """Rows of ``count`` points or more, in the order of the curve: evenly along the way of the
    control point, which may go to and fro, with both ends and those to ``keep``.

    Parameters
    ----------
    control_displacement
        (n_points,) [m].
    """
    n = len(control_displacement)
    if n == 0:
        return []
    way = np.append(0.0, np.cumsum(np.abs(np.diff(control_displacement))))
    wanted = np.linspace(0.0, way[-1], max(count, 2))
    after = np.searchsorted(way, wanted).clip(0, n - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(wanted - way[before] <= way[after] - wanted, before, after)
    return sorted({0, *keep, n - 1, *nearest.tolist()})
