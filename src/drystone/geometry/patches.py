"""Faces of blocks one by one, by their corners: edges of outlines, polygons of solids."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.space.solid import Faces, Part

#: Places along a segment, and in a triangle, of which the mean of a square is exact.
_ON_SEGMENT = np.array([[0.5 + s / math.sqrt(12.0), 0.5 - s / math.sqrt(12.0)] for s in (-1, 1)])
_IN_TRIANGLE = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])

#: Points of a joint of the plane that may be crushed: its resultant is known to length^2 / 8192 a.
POINTS = 33
#: Points along the side of a rectangle in space, two to a corner and one in the middle: the
#: resultant is known to 1/208 of the side.
ALONG = 17

#: Of bilinear functions on a square, by its corners: integrals of the product of two.
PRODUCTS = np.array([[4, 2, 1, 2], [2, 4, 2, 1], [1, 2, 4, 2], [2, 1, 2, 4]]) / 36.0


def faces_known(vertices: Array, faces: Faces, parts: Sequence[Part]) -> bool:
    """Whether the faces of a block are known apart from those between its convex ``parts``."""
    return vertices.shape[1] == 2 or bool(faces) or len(parts) == 1


def faces_of(vertices: Array, faces: Faces, parts: Sequence[Part]) -> list[Array]:
    """Corners of every face of a block, (m, dim)."""
    if vertices.shape[1] == 2:
        return list(np.stack((vertices, np.roll(vertices, -1, axis=0)), axis=1))
    if faces:
        return [vertices[list(face)] for face in faces]
    return [parts[0].vertices[list(face)] for face in parts[0].faces]


def normal_of(corners: Array) -> Array:
    """Outward: to the right of an edge; of a polygon that runs counter-clockwise from outside."""
    if corners.shape[1] == 2:
        x, y = corners[1] - corners[0]
        normal = np.array([y, -x])
    else:
        normal = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(0)
    return np.asarray(normal / np.linalg.norm(normal))


def below(corners: Array, up: Array, level: float) -> Array:
    """What of a polygon, or a segment, lies below a level."""
    height = corners @ up - level
    if (height <= 0.0).all():
        return corners
    kept: list[Array] = []
    n = len(corners)
    edges = [(0, 1)] if corners.shape[1] == 2 else [(k, (k + 1) % n) for k in range(n)]
    for k, following in edges:
        if height[k] <= 0.0:
            kept.append(corners[k])
        if height[k] * height[following] < 0.0:
            share = height[k] / (height[k] - height[following])
            kept.append(corners[k] + share * (corners[following] - corners[k]))
    if corners.shape[1] == 2 and height[1] <= 0.0:
        kept.append(corners[1])
    return np.array(kept).reshape(-1, corners.shape[1])


def places_on(corners: Array) -> tuple[Array, Array]:
    """Places (k, q, dim) whose mean stands for each part of a polygon, and the parts' sizes (k,);
    sizes of parts that a polygon does not have count less."""
    if corners.shape[1] == 2:
        return (_ON_SEGMENT @ corners)[None], sizes_of(corners)
    fan = np.stack((np.broadcast_to(corners[0], corners[2:].shape), corners[1:-1], corners[2:]), 1)
    return np.einsum("qc,kcd->kqd", _IN_TRIANGLE, fan), sizes_of(corners)


def sizes_of(corners: Array) -> Array:
    """Length of a segment, (1,) [m]; areas of the fan of a polygon, (m - 2,) [m2]."""
    if corners.shape[1] == 2:
        return np.array([float(np.linalg.norm(corners[1] - corners[0]))])
    cross = 0.5 * np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0])
    return np.asarray(cross @ normal_of(corners))


def is_on(corners: Array, place: Array, near: float) -> bool:
    """Whether a place lies on a joint, a segment or a convex polygon by its corners (n, dim)."""
    edge = np.roll(corners, -1, axis=0) - corners
    arm = place - corners
    if corners.shape[1] == 2:
        along = float(arm[0] @ edge[0]) / float(edge[0] @ edge[0])
        return bool(np.linalg.norm(arm[0] - np.clip(along, 0.0, 1.0) * edge[0]) <= near)
    normal = np.cross(edge, np.roll(edge, -1, axis=0)).sum(axis=0)
    normal /= np.linalg.norm(normal)
    inwards = np.cross(normal, edge)
    inwards /= np.linalg.norm(inwards, axis=1)[:, None]
    inside = np.sum(arm * inwards, axis=1).min() >= -near
    return bool(inside and abs(arm[0] @ normal) <= near)


def spread_over(corners: Array) -> tuple[Array, Array]:
    """Many points on a joint by its corners (n, dim), and their shares of its size."""
    return _row(corners) if corners.shape[1] == 2 else _grid(corners)


def _row(ends: Array) -> tuple[Array, Array]:
    """Points between two ends, and their shares of the length."""
    begin, end = ends
    place = begin + np.linspace(0.0, 1.0, POINTS)[:, None] * (end - begin)
    share = np.full(POINTS, 1.0 / (POINTS - 1))
    share[[0, -1]] *= 0.5
    return place, share


def _grid(corners: Array) -> tuple[Array, Array]:
    """Points on a convex polygon with corners (n, 3), and their shares of its area."""
    n, m = len(corners), ALONG // 2
    along = 1.0 - np.cos(0.5 * np.pi * np.arange(m + 1) / m)
    u, w = along[:, None, None], along[None, :, None]
    after = 0.5 * (corners + np.roll(corners, -1, axis=0))
    before, middle = np.roll(after, 1, axis=0), corners.mean(axis=0)
    place = np.zeros((n * m * (m + 1) + 1, 3))
    area = np.zeros(len(place))
    i, j = np.meshgrid(np.arange(m + 1), np.arange(m + 1), indexing="ij")
    for k in range(n):
        # What lies on the line to the middle of the next side belongs to the next corner.
        name = np.where(i < m, (k * m + i) * (m + 1) + j, (((k + 1) % n) * m + j) * (m + 1) + m)
        name[m, m] = len(place) - 1
        here = (1.0 - u) * (1.0 - w) * corners[k] + u * (1.0 - w) * after[k]
        here = here + u * w * middle + (1.0 - u) * w * before[k]
        place[name] = here
        cell = [(slice(None, -1), slice(None, -1)), (slice(1, None), slice(None, -1))]
        cell += [(slice(1, None), slice(1, None)), (slice(None, -1), slice(1, None))]
        at = np.stack([here[part] for part in cell])
        sides = np.roll(at, -1, axis=0) - at, np.roll(at, 1, axis=0) - at
        size = np.linalg.norm(np.cross(*sides), axis=-1)
        for part, value in zip(cell, np.einsum("ab,bij->aij", PRODUCTS, size), strict=True):
            np.add.at(area, name[part], value)
    return place, area / area.sum()
