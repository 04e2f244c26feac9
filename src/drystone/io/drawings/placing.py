"""Where a drawing is put: axes turned up, rotations, the origin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.model.builders.placing import turn_of


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
    if rotation:
        vertices = vertices @ turn_of(rotation, vertices.shape[1]).T
    if any(origin):
        vertices = vertices + np.asarray(origin, dtype=np.float64)
    return vertices
