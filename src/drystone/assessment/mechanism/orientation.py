"""Whether a mechanism moves walls in their plane or out of it.

A wall that moves in its plane goes on along its motion further than across it; one that falls out
of its plane is thin along its motion.  Both lengths are measured through each moving block, over
the moving blocks that follow each other without a gap.  In the plane the length across is the
model's thickness.
"""

from __future__ import annotations

import numpy as np

from drystone.assessment.mechanism.shapes import MechanismShape
from drystone.common.arrays import Array, IntArray
from drystone.geometry.motion import across_both
from drystone.model.assembly import Assembly

#: Gap, over a block's own length, up to which the next one goes on with the same wall.
GAP = 0.01
#: Excess of the length along the motion over that across it that counts as none.
ALIKE = 0.01


def share_out_of_plane(assembly: Assembly, shape: MechanismShape, direction: Array) -> float:
    """Share of the momentum of blocks that are no longer along the motion than across it.

    Parameters
    ----------
    direction
        Of the load, (dim,): that of the motion where its horizontal momentum is zero.
    """
    moving = np.flatnonzero(shape.labels >= 0)
    up = assembly.up
    velocity = shape.field.velocity[moving]
    level = velocity - np.outer(velocity @ up, up)
    momentum = shape.mass[moving] @ level
    length = float(np.linalg.norm(momentum))
    along = momentum / length if length > 0.0 else direction
    weight = shape.mass[moving] * np.abs(level @ along)
    if not weight.sum() > 0.0:
        return 0.0
    boxes = {"along": _reach(assembly, along), "up": _reach(assembly, up)}
    for across in across_both(up, along):
        boxes["across"] = _reach(assembly, across)
    thin = np.zeros(len(moving), np.bool_)
    for k, i in enumerate(moving.tolist()):
        own = _length(boxes, "along", i, moving)
        other = _length(boxes, "across", i, moving) if "across" in boxes else assembly.thickness
        thin[k] = own <= (1.0 + ALIKE) * other
    return float(weight[thin].sum() / weight.sum())


def _reach(assembly: Assembly, direction: Array) -> Array:
    """From where to where each block reaches along a direction, (n, 2) [m]."""
    shapes = assembly.packed
    owner = np.repeat(shapes.body, np.diff(shapes.offset))
    place = shapes.vertices @ direction
    found = np.column_stack(
        (np.full(assembly.n_bodies, np.inf), np.full(assembly.n_bodies, -np.inf))
    )
    np.minimum.at(found[:, 0], owner, place)
    np.maximum.at(found[:, 1], owner, place)
    return found


def _length(boxes: dict[str, Array], way: str, i: int, moving: IntArray) -> float:
    """Length [m] of what follows block ``i`` without a gap on the line through its middle."""
    on = np.ones(len(moving), np.bool_)
    for name, box in boxes.items():
        if name != way:
            middle = box[i].mean()
            on &= (box[moving, 0] < middle) & (middle < box[moving, 1])
    ranges = boxes[way][moving[on]]
    low, high = boxes[way][i]
    gap = GAP * (high - low)
    while True:
        met = (ranges[:, 0] <= high + gap) & (ranges[:, 1] >= low - gap)
        lower, upper = ranges[met, 0].min(initial=low), ranges[met, 1].max(initial=high)
        if lower >= low and upper <= high:
            return float(high - low)
        low, high = min(low, lower), max(high, upper)
