"""Hidden surfaces by a depth buffer: for every pixel the face of convex polyhedra that is seen.

It is right also where blocks overlap a little, which no order of painting is, and takes a time in
proportion to the faces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.common.arrays import Array, BoolArray, IntArray

#: What is seen where there is nothing.
NOTHING = -1
#: A face whose normal has no more than this share towards the viewer is seen edge on: not at all.
EDGE_ON = 1e-9


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Pixels of a picture: row 0 is the lowest."""

    low: Array  # (2,) m, lower left corner
    pixel: float  # m, its side
    shape: tuple[int, int]  # rows, columns

    def at(self, places: Array) -> Array:
        """Places in pixels of points (k, 3) [m], (k, 2): column and row, whole in pixel centres."""
        return np.asarray((places[:, :2] - self.low) / self.pixel - 0.5)


@dataclass(frozen=True, kw_only=True)
class Seen:
    """What is seen in every pixel."""

    frame: Frame
    face: NDArray[np.int32]  # (rows, columns), NOTHING where there is none
    nearness: NDArray[np.float32]  # (rows, columns) m, towards the viewer

    def before(self, places: Array, slack: float) -> BoolArray:
        """Which points (k, 3) [m] no face covers, (k,).

        One on the rim of a face counts as seen: of the pixels around it one is enough.  ``slack``
        [m] is by how much a face must be nearer to cover.  Points outside are not seen.
        """
        rows, columns = self.frame.shape
        place = np.rint(self.frame.at(places)).astype(np.int64)
        seen = np.zeros(len(places), np.bool_)
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                x, y = place[:, 0] + dx, place[:, 1] + dy
                inside = (x >= 0) & (x < columns) & (y >= 0) & (y < rows)
                x, y = x.clip(0, columns - 1), y.clip(0, rows - 1)
                seen |= inside & (self.nearness[y, x] <= places[:, 2] + slack)
        return seen


def look(
    places: Array, rows: IntArray, face_offset: IntArray, frame: Frame, faces: IntArray
) -> Seen:
    """Draw faces into the depth buffer.

    Parameters
    ----------
    places
        Vertices as the camera sees them, (n, 3) [m].
    rows, face_offset
        Faces, as in `Polyhedra`; each is convex.
    faces
        Those that are drawn; of them those that face away from the viewer are not.
    """
    face = np.full(frame.shape, NOTHING, np.int32)
    nearness = np.full(frame.shape, -np.inf, np.float32)
    pixels = np.column_stack((frame.at(places), places[:, 2]))
    plane, facing = _planes(pixels, rows, face_offset)
    across = np.arange(frame.shape[1], dtype=np.float64)
    up = np.arange(frame.shape[0], dtype=np.float64)
    for k in faces[facing[faces]].tolist():
        corners = pixels[rows[face_offset[k] : face_offset[k + 1]], :2].tolist()
        left, right = _range([x for x, _ in corners], frame.shape[1])
        low, high = _range([y for _, y in corners], frame.shape[0])
        if left >= right or low >= high:
            continue
        x, y = across[left:right], up[low:high]
        first, last = _span(corners, y)
        covered = (x >= first[:, None]) & (x <= last[:, None])
        a, b, c = plane[k].tolist()
        depth = ((b * y + c)[:, None] + a * x).astype(np.float32)
        window = nearness[low:high, left:right]
        covered &= depth > window
        np.copyto(window, depth, where=covered)
        np.copyto(face[low:high, left:right], np.int32(k), where=covered)
    return Seen(frame=frame, face=face, nearness=nearness)


def _planes(pixels: Array, rows: IntArray, face_offset: IntArray) -> tuple[Array, BoolArray]:
    """Nearness of each face over the picture, a x + b y + c, as (n_faces, 3), and whether it is
    turned to the viewer, (n_faces,)."""
    first = face_offset[:-1]
    owner = np.repeat(np.arange(len(first)), np.diff(face_offset))
    after = np.arange(1, len(rows) + 1)
    after[face_offset[1:] - 1] = first
    near = pixels[rows[first]]  # a near origin keeps the sums from cancelling
    arm = pixels[rows] - near[owner]
    normal = np.add.reduceat(np.cross(arm, arm[after]), first)
    facing = normal[:, 2] > EDGE_ON * np.abs(normal).sum(axis=1)
    slope = -normal[:, :2] / np.where(facing, normal[:, 2], 1.0)[:, None]
    return np.column_stack((slope, near[:, 2] - np.sum(slope * near[:, :2], axis=1))), facing


def _range(values: list[float], size: int) -> tuple[int, int]:
    """From which pixel on, and before which, whole places lie between values."""
    return max(math.ceil(min(values)), 0), min(math.floor(max(values)) + 1, size)


def _span(corners: list[list[float]], y: Array) -> tuple[Array, Array]:
    """Where rows ``y`` (k,) of pixels enter and leave a convex outline, two (k,)."""
    first, last = np.full(len(y), -np.inf), np.full(len(y), np.inf)
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        if y0 == y1:
            continue
        crossing = x0 + (y - y0) * ((x1 - x0) / (y1 - y0))
        if y1 < y0:  # downwards: inside is to the right
            np.maximum(first, crossing, out=first)
        else:
            np.minimum(last, crossing, out=last)
    return first, last


def rims(values: IntArray) -> tuple[BoolArray, BoolArray]:
    """Pixels whose neighbour to the right, or below, shows another value: two (rows, columns)."""
    right, below = np.zeros(values.shape, np.bool_), np.zeros(values.shape, np.bool_)
    right[:, :-1] = values[:, 1:] != values[:, :-1]
    below[1:] = values[1:] != values[:-1]
    return right, below


def reduced(colours: NDArray[np.float32], factor: int) -> NDArray[np.float32]:
    """A picture (rows, columns, 3) made smaller by a whole factor: the mean of each square."""
    total = np.zeros_like(colours[::factor, ::factor])
    for i in range(factor):
        for j in range(factor):
            total += colours[i::factor, j::factor]
    return total / np.float32(factor * factor)
