"""Where a drawing is put: axes turned up, rotations, the origin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def turned_up(vertices: Array, up: str) -> Array:
    """Vertices (n, dim) with z up; where y pointed up, x stays and what came forward goes back."""
    if up != "y":
        return vertices
    return np.column_stack((vertices[:, 0], -vertices[:, 2], vertices[:, 1]))


def placed(vertices: Array, origin: Sequence[float], rotation: Sequence[float]) -> Array:
    """Vertices (n, dim) [m] after a rotation about the origin, which then goes to ``origin`` [m].

    Parameters
    ----------
    rotation
        Degrees, counter-clockwise: one number in the plane, in space one about z, or three about
        x, y and z, one after the other about axes that stay.  Right angles are exact.
    """
    dimension = vertices.shape[1]
    angles = [*rotation]
    if dimension == 3 and len(angles) == 1:
        angles = [0.0, 0.0, *angles]
    for axis, angle in enumerate(angles):
        if angle % 360.0 == 0.0:
            continue
        c, s = _cosine(angle), _cosine(angle - 90.0)
        i, j = (0, 1) if dimension == 2 else ((axis + 1) % 3, (axis + 2) % 3)
        turned = vertices.copy()
        turned[:, i] = c * vertices[:, i] - s * vertices[:, j]
        turned[:, j] = s * vertices[:, i] + c * vertices[:, j]
        vertices = turned
    if any(origin):
        vertices = vertices + np.asarray(origin, dtype=np.float64)
    return vertices


def _cosine(degrees: float) -> float:
    """Cosine of an angle; of right angles without rounding."""
    quarter = degrees % 360.0 / 90.0
    if quarter.is_integer():
        return (1.0, 0.0, -1.0, 0.0)[int(quarter)]
    return float(np.cos(np.radians(degrees)))
