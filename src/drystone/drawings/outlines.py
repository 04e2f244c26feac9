"""Outlines of the plane as drawn, made outlines of blocks whose joints are closed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Block
from drystone.builders.fit import fitted
from drystone.drawings.drawing import Shape
from drystone.geometry import GeometryError, polygon
from drystone.geometry.mend import ONE_FACE, ROUNDING, SAME_POINT, WELDED
from drystone.geometry.mended import Mended

Array = NDArray[np.float64]


def mended_outlines(shapes: Sequence[Shape], tolerance: float) -> tuple[list[Block], list[Mended]]:
    """Blocks of closed polylines, and what was done to them; raises `GeometryError`.

    Parameters
    ----------
    tolerance
        Largest distance by which vertices are moved, over the shortest edge.
    """
    records: list[Mended] = []
    blocks = []
    for shape in shapes:
        try:
            vertices = _outline(shape, tolerance, records)
        except GeometryError as error:
            raise GeometryError(f'"{shape.name}": {error}') from None
        blocks.append(
            Block(
                id=shape.name,
                vertices=vertices,
                unit_weight=1.0,
                material=shape.layer,
                support=shape.support,
                groups=tuple(dict.fromkeys(n for n in (shape.layer, *shape.groups) if n)),
            )
        )
    moved, _ = fitted(blocks, tolerance)
    for before, after in zip(blocks, moved, strict=True):
        way = float(np.linalg.norm(after.vertices - before.vertices, axis=1).max())
        if way > ROUNDING * float(np.ptp(before.vertices, axis=0).max()):
            records.append(
                Mended(block=before.id, what="had vertices moved to close joints", how_much=way)
            )
    return moved, records


def _outline(shape: Shape, tolerance: float, records: list[Mended]) -> Array:
    """One outline without points that say nothing, counter-clockwise."""
    vertices = shape.vertices
    size = float(np.ptp(vertices, axis=0).max()) if len(vertices) else 0.0
    vertices, doubles = _without(vertices, max(SAME_POINT, WELDED * tolerance) * size, _gaps)
    if len(vertices) < 3:
        raise GeometryError("less than three points are left of it: draw a closed outline")
    edges = np.roll(vertices, -1, axis=0) - vertices
    near = tolerance * float(np.hypot(edges[:, 0], edges[:, 1]).min())
    vertices, straight = _without(vertices, max(ONE_FACE * near, ROUNDING * size), _bends)
    for count, what in (
        (doubles, "had vertices so near to each other that they were made one"),
        (straight, "had vertices amid edges or faces, which were left out"),
    ):
        if count:
            records.append(Mended(block=shape.name, what=what, count=count))
    if polygon.is_clockwise(vertices):
        vertices = vertices[::-1].copy()
        records.append(
            Mended(
                block=shape.name,
                what="had faces that ran clockwise and were turned round",
                count=1,
            )
        )
    polygon.check_outline(vertices)
    return vertices


def _without(vertices: Array, near: float, measure: object) -> tuple[Array, int]:
    """An outline without vertices of which a measure is ``near`` at most, one after the other."""
    count = len(vertices)
    while len(vertices) > 2:
        value = measure(vertices)  # type: ignore[operator]
        least = int(np.argmin(value))
        if value[least] > near:
            break
        vertices = np.delete(vertices, least, axis=0)
    return vertices, count - len(vertices)


def _gaps(vertices: Array) -> Array:
    """How far each vertex is from the one before it."""
    way = vertices - np.roll(vertices, 1, axis=0)
    return np.hypot(way[:, 0], way[:, 1])


def _bends(vertices: Array) -> Array:
    """How far each vertex is off the line between its neighbours; endless where it turns back."""
    before, after = np.roll(vertices, 1, axis=0), np.roll(vertices, -1, axis=0)
    way, arm = after - before, vertices - before
    length = np.hypot(way[:, 0], way[:, 1])
    along = np.sum(way * arm, axis=1)
    off = np.abs(way[:, 0] * arm[:, 1] - way[:, 1] * arm[:, 0])
    between = (along > 0.0) & (along < length**2)
    return np.where(between, off / np.where(length > 0.0, length, 1.0), np.inf)
