"""Where to read a displacement: where the mechanism of limit analysis moves fastest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drystone.geometry.motion import moved_points
from drystone.limit.collapse import ASSOCIATIVE, collapse_load
from drystone.model.model import Model
from drystone.model.monitor import ControlPoint

Array = NDArray[np.float64]

#: A control point that the mechanism moves by less than this share of its fastest block is still.
STILL = 1e-3


def watched(model: Model) -> Model:
    """The model with its control point where its mechanism moves fastest along that direction.

    Where one part falls beside another, a control point on the latter would not show the fall.  Of
    points that are equally fast the first is taken; where nothing moves along the direction, or no
    mechanism is found, the control point stays."""
    velocities = collapse_load(model, flow=ASSOCIATIVE).velocities
    return replace(model, control_point=fastest_point(model, velocities))


def fastest_point(model: Model, velocities: Array) -> ControlPoint:
    """The control point where a mechanism (n, n_dof) moves fastest along the control direction."""
    assembly, control = model.assembly, model.control_point
    fastest = 0.0
    for row, block in enumerate(assembly.blocks):
        points = np.asarray(block.vertices, float)
        owner = np.full(len(points), row)
        there = moved_points(points, owner, assembly.centroid, velocities, linear=True)
        speed = (there - points) @ control.direction
        k = int(np.argmax(speed))
        if speed[k] > fastest + 1e-6:  # of equal ones the first, whatever the rounding
            fastest = float(speed[k])
            control = replace(control, block=row, point=block.vertices[k])
    return control


def leaves_still(model: Model, velocities: Array) -> bool:
    """Whether a mechanism (n, n_dof) does not move the control point along its direction."""
    assembly, control = model.assembly, model.control_point
    there = moved_points(
        control.point[None], np.array([control.block]), assembly.centroid, velocities, linear=True
    )
    fastest = float(np.abs(velocities).max(initial=0.0))
    return bool(abs((there[0] - control.point) @ control.direction) < STILL * fastest)
