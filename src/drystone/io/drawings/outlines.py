"""Outlines of the plane as drawn, made outlines of blocks whose joints are closed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import ONE_FACE, ROUNDING, SAME_POINT, WELDED
from drystone.geometry import GeometryError
from drystone.geometry.mended import Mended
from drystone.geometry.plane import polygon
from drystone.geometry.plane.closing import closed
from drystone.geometry.plane.trim import trimmed
from drystone.io.drawings.drawing import Shape
from drystone.model.assembly import Block


def mended_outlines(
    shapes: Sequence[Shape], tolerance: float, overlap: float = 0.0
) -> tuple[list[Block], list[Mended]]:
    """Blocks of closed polylines, and what was done to them; raises `GeometryError`.

    Parameters
    ----------
    tolerance
        Largest distance by which vertices are moved, over the width of their outline, see
        `measure_of`.
    overlap
        Distance [m] by which they may be moved in any case.
    """
    records: list[Mended] = []
    outlines = []
    for shape in shapes:
        try:
            outlines.append(_outline(shape, tolerance, overlap, records))
        except GeometryError as error:
            raise GeometryError(f'"{shape.name}": {error}') from None
    reach = np.array([max(tolerance * measure_of(o, tolerance), overlap) for o in outlines])
    bends = np.array([ONE_FACE * tolerance * _edges(o).min() for o in outlines])
    fixed = np.array([shape.support for shape in shapes], bool)
    found = closed(outlines, reach, bends, fixed)
    size = np.array([float(np.ptp(o, axis=0).max()) for o in outlines])
    parts, cut = trimmed(found.outlines, reach, fixed)
    blocks = []
    for i, shape in enumerate(shapes):
        own = parts.get(i, ())
        blocks.append(
            Block(
                id=shape.name,
                vertices=np.vstack([p.vertices for p in own]) if own else found.outlines[i],
                parts=tuple(own) if len(own) > 1 else (),
                unit_weight=1.0,
                material=shape.layer,
                support=shape.support,
                held=shape.held,
                groups=tuple(dict.fromkeys(n for n in (shape.layer, *shape.groups) if n)),
            )
        )
        changes = (
            ("had vertices within edges or faces, which were left out", 0.0, found.straight[i]),
            ("had vertices moved to close joints", found.way[i], 0),
            ("had edges bent to meet corners of neighbours", 0.0, found.bent[i]),
            ("had joints that could not be closed and stayed as drawn", 0.0, i in found.given_up),
            ("had overlaps with neighbours that were cut off", cut.get(i, 0.0), 0),
        )
        for what, how_much, count in changes:
            if count or how_much > ROUNDING * size[i]:
                records.append(
                    Mended(block=shape.name, what=what, how_much=how_much, count=int(count))
                )
    return blocks, records


def measure_of(vertices: Array, tolerance: float) -> float:
    """What the tolerance of an outline is a share of [m]: its least width.

    Short edges say nothing of how well a stone was drawn, its width does.  A concave outline may
    be much thinner somewhere than it is as a whole: of one with dents deeper than the tolerance it
    is the shortest edge.
    """
    width = polygon.least_width(vertices)
    if polygon.dent(vertices) <= tolerance * width:
        return width
    return float(_edges(vertices).min())


def _edges(vertices: Array) -> Array:
    """Lengths of an outline's edges [m]."""
    edges = np.roll(vertices, -1, axis=0) - vertices
    return np.asarray(np.hypot(edges[:, 0], edges[:, 1]))


def _outline(shape: Shape, tolerance: float, overlap: float, records: list[Mended]) -> Array:
    """One outline without points that say nothing, counter-clockwise."""
    vertices = shape.vertices
    size = float(np.ptp(vertices, axis=0).max()) if len(vertices) else 0.0
    vertices, doubles = _without(vertices, max(SAME_POINT, WELDED * tolerance) * size, _gaps)
    if len(vertices) < 3:
        raise GeometryError("less than three points are left of it: draw a closed outline")
    vertices, straight = _without(vertices, ROUNDING * size, polygon.bends)
    turned = polygon.is_clockwise(vertices)
    if turned:
        vertices = vertices[::-1].copy()
    vertices, crossed = _uncrossed(vertices, tolerance, overlap)
    for count, what in (
        (doubles + crossed, "had vertices so near to each other that they were made one"),
        (straight, "had vertices within edges or faces, which were left out"),
        (turned, "had faces that ran clockwise and were turned round"),
    ):
        if count:
            records.append(Mended(block=shape.name, what=what, count=int(count)))
    polygon.check_outline(vertices)
    return vertices


def _uncrossed(vertices: Array, tolerance: float, overlap: float) -> tuple[Array, int]:
    """An outline that crosses itself without the edges so short that they cross by the error of
    the drawing: their ends become one; and how many these are."""
    count = 0
    while len(vertices) > 3:
        try:
            polygon.check_outline(vertices)
        except GeometryError:
            edges = _edges(vertices)
            k = int(np.argmin(edges))
            if edges[k] > max(tolerance * polygon.least_width(vertices), overlap):
                break
            after = (k + 1) % len(vertices)
            vertices = vertices.copy()
            vertices[k] = 0.5 * (vertices[k] + vertices[after])
            vertices = np.delete(vertices, after, axis=0)
            count += 1
        else:
            break
    return vertices, count


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
