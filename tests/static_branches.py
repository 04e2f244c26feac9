"""Static branches of curves, and how far apart two of them lie."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array
from drystone.results.curve import STATIC, CapacityCurve


def static_branch(curve: CapacityCurve) -> Array:
    """Control displacement and multiplier of the static points, (n, 2)."""
    static = curve.column("status") == STATIC
    return np.column_stack((curve.control_displacement, curve.load_multiplier))[static]


def apart(points: Array, line: Array) -> Array:
    """Distance of points from a polyline, the larger of both coordinates."""
    if len(line) == 1:
        return np.asarray(np.abs(points - line).max(axis=1))
    start, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    share = ((points[:, None] - start) * along).sum(axis=2) / square
    nearest = start + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.asarray(np.abs(points[:, None] - nearest).max(axis=2).min(axis=1))
