"""Plane blocks as polyhedra, and points at front and back as one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def extrude(polygon: Array, thickness: float) -> tuple[Array, IntArray]:
    """Prism over a convex polygon in the plane z = 0, which it lies on both sides of.

    Parameters
    ----------
    polygon
        (m, 2) [m], counter-clockwise.

    Returns
    -------
    vertices
        (2 m, 3) [m]: first those at the back, z = -thickness / 2, then those at the front.
    faces
        (4 m - 4, 3) triangles with their normals outwards, counted from 0.
    """
    m = len(polygon)
    back = np.column_stack((polygon, np.full(m, -0.5 * thickness)))
    front = back + (0.0, 0.0, thickness)
    faces = []
    for i in range(1, m - 1):
        faces += [(0, i + 1, i), (m, m + i, m + i + 1)]
    for i in range(m):
        j = (i + 1) % m
        faces += [(i, j, m + j), (i, m + j, m + i)]
    return np.vstack((back, front)), np.array(faces, dtype=np.int64)


def same_place(body_a: IntArray, body_b: IntArray, position: Array, apart: float) -> IntArray:
    """Number of the plane point that each point of a prism belongs to, (n_contacts,).

    Points of the same two bodies that are nearer to each other than ``apart`` [m] in the plane
    are one; numbers count from 0 in the order in which the plane points are first met.
    """
    number = np.full(len(body_a), -1, dtype=np.int64)
    first: dict[tuple[int, int], list[int]] = {}
    count = 0
    for k, pair in enumerate(zip(body_a.tolist(), body_b.tolist(), strict=True)):
        for other in first.setdefault(pair, []):
            if np.hypot(*(position[k] - position[other])) < apart:
                number[k] = number[other]
                break
        else:
            number[k] = count
            count += 1
            first[pair].append(k)
    return number
