"""Where to read a displacement: where the mechanism of limit analysis moves fastest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry.motion import moved_points
from drystone.limit.collapse import ASSOCIATIVE, collapse_load
from drystone.model.model import Model
from drystone.model.monitor import ControlPoint

#: A control point that the mechanism moves by less than this share of its fastest point is still,
#: or goes backwards.  Range: of 272 random structures and the examples it moves the top by less
#: than 1e-6, backwards, or by more than 0.24; a top that rollers hold by 0.045.
STILL = 0.1
#: Speed, over that of the mechanism's fastest block, up to which nothing moves along a direction.
STILL_SPEED = 1e-6
#: Speeds, over the fastest, and heights, over the smallest block, that differ by less are equal:
#: linear programs are solved to 1e-7.
EQUAL = 1e-6


def watched(model: Model) -> Model:
    """The model with its control point where its mechanism moves fastest along that direction.

    Where one part falls beside another, a control point on the latter would not show the fall.
    Where nothing moves along the direction, or no mechanism is found, the control point stays."""
    velocities = collapse_load(model, flow=ASSOCIATIVE).velocities
    return replace(model, control_point=fastest_point(model, velocities))


def fastest_point(model: Model, velocities: Array) -> ControlPoint:
    """The control point where a mechanism (n, n_dof) moves fastest along the control direction.

    Of points that are equally fast, as those of a block that slides, the highest is taken: where
    the block topples later, that one goes on, and one below turns back.  Of these it is the
    farthest along the direction, as where no one names a control point: structures that mirror each
    other are then watched at points that do.
    """
    assembly, control = model.assembly, model.control_point
    owner, points, speed = _vertices(model, velocities)
    fastest = float(speed.max())
    if fastest <= STILL_SPEED:
        return control
    chosen, same = speed >= (1.0 - EQUAL) * fastest, EQUAL * assembly.smallest_extent
    for along in (assembly.up, control.direction):
        place = np.where(chosen, points @ along, -np.inf)
        chosen = place >= place.max() - same
    k = int(np.argmax(chosen))  # the first
    return replace(control, block=int(owner[k]), point=points[k])


def leaves_still(model: Model, velocities: Array) -> bool:
    """Whether a mechanism (n, n_dof) hardly moves the control point along its direction, or moves
    it backwards."""
    control = model.control_point
    fastest = float(_vertices(model, velocities)[2].max())
    own = _along(model, np.array([control.block]), control.point[None], velocities)
    return float(own[0]) < STILL * max(fastest, STILL_SPEED)


def _vertices(model: Model, velocities: Array) -> tuple[IntArray, Array, Array]:
    """All vertices with their blocks, and how fast they move along the control direction."""
    outlines = [np.asarray(block.vertices, float) for block in model.assembly.blocks]
    owner, points = np.repeat(range(len(outlines)), [*map(len, outlines)]), np.concatenate(outlines)
    return owner, points, _along(model, owner, points, velocities)


def _along(model: Model, owner: IntArray, points: Array, velocities: Array) -> Array:
    """Speeds (k,) of points (k, dim) of blocks ``owner`` (k,) along the control direction."""
    there = moved_points(points, owner, model.assembly.centroid, velocities, linear=True)
    return np.asarray((there - points) @ model.control_point.direction)
