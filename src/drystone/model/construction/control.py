"""Where the control point is when it is named, and when nothing is said about it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.names import there_is_no
from drystone.common.vectors import unit_vector
from drystone.model.assembly import Assembly
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import suggestion
from drystone.model.monitor import ControlPoint

#: Relative size under which two heights are the same, or a point is on an outline.
SAME = 1e-6

#: Corners of the plane that have names, as fractions of the block's bounding box.
CORNERS = {
    "top right": (1.0, 1.0),
    "top left": (0.0, 1.0),
    "bottom right": (1.0, 0.0),
    "bottom left": (0.0, 0.0),
}
#: Named points by dimension: the top is the middle of the highest vertices.
NAMED_POINTS = {2: (*CORNERS, "centre"), 3: ("top", "centre")}


def named_points(dimension: int) -> tuple[str, ...]:
    """See `NAMED_POINTS`."""
    return NAMED_POINTS[dimension]


def choose_control_point(
    assembly: Assembly,
    load_direction: Array,
    *,
    block: str | None = None,
    point: str | Sequence[float] | None = None,
    direction: Sequence[float] | None = None,
) -> ControlPoint:
    """The control point as asked for.

    Parameters
    ----------
    load_direction
        (dim,) unit vector of the load pattern.
    block
        Id of a movable block.  Default: the one whose top is highest; of those, the one that
        reaches furthest along the load.
    point
        A name of `NAMED_POINTS`, or ``[x, y]``, in space ``[x, y, z]`` [m], on the block as
        designed.  Default: the block's highest vertex; of those, the furthest along the load.
    direction
        In which the displacement is read.  Default: that of the load.

    Raises
    ------
    ModelError
        There is no such block or point, or the block is a support.
    """
    if block is None:
        row = _default_block(assembly, load_direction)
    else:
        row = _named_block(assembly, block)
    vertices = assembly.blocks[row].vertices
    height = vertices @ assembly.up
    if point is None:
        equal = _highest_furthest(height, vertices @ load_direction, vertices)
        place = vertices[min(equal, key=lambda i: tuple(vertices[i]))]  # not the first in a file
    elif isinstance(point, str):
        place = _named_point(point, vertices, height, assembly.centroid[row])
    else:
        place = _given_point(point, assembly, row)
    if direction is None:
        read_along = load_direction
    else:
        read_along = unit_vector(direction, "control.direction", assembly.dimension)
    default = block is None and point is None
    return ControlPoint(block=row, point=np.array(place), direction=read_along, default=default)


def _named_block(assembly: Assembly, block: str) -> int:
    try:
        row = assembly.index(block)
    except KeyError:
        raise ModelError([f"control.block: {there_is_no('block', block, assembly.ids)}"]) from None
    if assembly.fixed[row]:
        raise ModelError(
            [f'control.block: "{block}" is a support and never moves: name a movable block']
        )
    return row


def _default_block(assembly: Assembly, load_direction: Array) -> int:
    movable = np.flatnonzero(~assembly.fixed)
    outlines = [assembly.blocks[i].vertices for i in movable]
    top = np.array([(outline @ assembly.up).max() for outline in outlines])
    reach = np.array([(outline @ load_direction).max() for outline in outlines])
    equal = _highest_furthest(top, reach, np.vstack(outlines))
    # Not the first in the drawing: results do not depend on its order.
    return int(min(movable[equal], key=lambda row: tuple(assembly.centroid[row])))


def _highest_furthest(height: Array, reach: Array, extent: Array) -> IntArray:
    """Indices of the highest, of those the furthest; equal within a part of the extent (n, dim)."""
    tolerance = SAME * np.ptp(extent, axis=0).max()
    high = np.flatnonzero(height >= height.max() - tolerance)
    return high[reach[high] >= reach[high].max() - tolerance]


def _named_point(name: str, vertices: Array, height: Array, centroid: Array) -> Array:
    """Centroid, middle of the top, or the vertex nearest to that corner of the bounding box."""
    known = named_points(vertices.shape[1])
    if name not in known:
        raise ModelError(
            [f'control.point: there is no point "{name}": {suggestion(name, list(known))}']
        )
    if name == "centre":
        return centroid
    extent = np.ptp(vertices, axis=0)
    if name == "top":
        return np.asarray(vertices[height >= height.max() - SAME * extent.max()].mean(axis=0))
    corner = vertices.min(axis=0) + np.array(CORNERS[name]) * extent
    return vertices[int(np.argmin(np.hypot(*(vertices - corner).T)))]


def _given_point(point: Sequence[float], assembly: Assembly, row: int) -> Array:
    place = np.array(point, dtype=np.float64)
    block = assembly.blocks[row]
    if place.shape != (assembly.dimension,):
        raise ModelError(
            [f"control.point: must be {assembly.dimension} numbers, one for each coordinate"]
        )
    low, high = block.vertices.min(axis=0), block.vertices.max(axis=0)
    if not assembly.figures[row].distance(place) <= SAME * float((high - low).max()):
        names, given = "xyz"[: len(place)], ", ".join(f"{x:g}" for x in place)
        spans = [f"{name} from {a:g} to {b:g}" for name, a, b in zip(names, low, high, strict=True)]
        raise ModelError(
            [
                f'control.point: ({given}) is not on block "{block.id}", which spans '
                f"{', '.join(spans[:-1])} and {spans[-1]} m: move the point onto it"
            ]
        )
    return place
