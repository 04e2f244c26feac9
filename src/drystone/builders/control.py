"""Where the control point is when it is named, and when nothing is said about it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.builders.errors import ModelError
from drystone.builders.words import suggestion
from drystone.monitor import ControlPoint

Array = NDArray[np.float64]

#: Relative size under which two heights are the same, or a point is on an outline.
SAME = 1e-6

#: Named points, as fractions of the block's bounding box.
NAMED_POINTS = {
    "top right": (1.0, 1.0),
    "top left": (0.0, 1.0),
    "bottom right": (1.0, 0.0),
    "bottom left": (0.0, 0.0),
    "centre": None,
}


def unit_vector(direction: Sequence[float], key: str) -> Array:
    """Direction scaled to length one; ``key`` names it in the error if it has none."""
    vector = np.array(direction, dtype=np.float64)
    if vector.shape != (2,) or not np.all(np.isfinite(vector)):
        raise ModelError([f"{key}: must be two finite numbers, as in [1.0, 0.0]"])
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise ModelError([f"{key}: has no length: give a direction, as in [1.0, 0.0]"])
    length = largest * np.linalg.norm(vector / largest)  # neither overflows nor vanishes
    if abs(length - 1.0) < 4.0 * np.finfo(float).eps:
        return vector  # so that what was written comes back bit by bit
    return vector / length


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
        (2,) unit vector of the load pattern.
    block
        Id of a movable block.  Default: the one whose top is highest; of those, the one that
        reaches furthest along the load.
    point
        A name of `NAMED_POINTS`, or ``[x, y]`` [m] on the block as designed.  Default: the
        block's highest vertex; of those, the furthest along the load.
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
    if point is None:
        place = vertices[_highest_furthest(vertices[:, 1], vertices @ load_direction, vertices)]
    elif isinstance(point, str):
        place = _named_point(point, vertices, assembly.centroid[row])
    else:
        place = _given_point(point, vertices, assembly.blocks[row].id)
    if direction is None:
        read_along = load_direction
    else:
        read_along = unit_vector(direction, "control.direction")
    return ControlPoint(block=row, point=np.array(place), direction=read_along)


def _named_block(assembly: Assembly, block: str) -> int:
    try:
        row = assembly.index(block)
    except KeyError:
        mend = suggestion(block, assembly.ids)
        raise ModelError([f'control.block: there is no block "{block}": {mend}']) from None
    if assembly.fixed[row]:
        raise ModelError(
            [f'control.block: "{block}" is a support and never moves: name a movable block']
        )
    return row


def _default_block(assembly: Assembly, load_direction: Array) -> int:
    movable = np.flatnonzero(~assembly.fixed)
    outlines = [assembly.blocks[i].vertices for i in movable]
    top = np.array([outline[:, 1].max() for outline in outlines])
    reach = np.array([(outline @ load_direction).max() for outline in outlines])
    return int(movable[_highest_furthest(top, reach, np.vstack(outlines))])


def _highest_furthest(height: Array, reach: Array, extent: Array) -> int:
    """Index of the highest, of those the furthest; equal within a part of the extent (n, 2)."""
    tolerance = SAME * np.ptp(extent, axis=0).max()
    high = np.flatnonzero(height >= height.max() - tolerance)
    far = high[reach[high] >= reach[high].max() - tolerance]
    return int(far[0])


def _named_point(name: str, vertices: Array, centroid: Array) -> Array:
    """Centroid, or the vertex nearest to that corner of the bounding box."""
    if name not in NAMED_POINTS:
        raise ModelError(
            [f'control.point: there is no point "{name}": {suggestion(name, list(NAMED_POINTS))}']
        )
    fraction = NAMED_POINTS[name]
    if fraction is None:
        return centroid
    corner = vertices.min(axis=0) + np.array(fraction) * np.ptp(vertices, axis=0)
    return vertices[int(np.argmin(np.hypot(*(vertices - corner).T)))]


def _given_point(point: Sequence[float], vertices: Array, block_id: str) -> Array:
    place = np.array(point, dtype=np.float64)
    edges = np.roll(vertices, -1, axis=0) - vertices
    arm = place - vertices
    length = np.hypot(edges[:, 0], edges[:, 1])
    inside = (edges[:, 0] * arm[:, 1] - edges[:, 1] * arm[:, 0]) / length
    if not np.all(inside >= -SAME * np.ptp(vertices, axis=0).max()):
        (x0, y0), (x1, y1) = vertices.min(axis=0), vertices.max(axis=0)
        raise ModelError(
            [
                f'control.point: ({place[0]:g}, {place[1]:g}) is not on block "{block_id}", which '
                f"spans x from {x0:g} to {x1:g} and y from {y0:g} to {y1:g} m: "
                "move the point onto it"
            ]
        )
    return place
