"""Where one rigid body that turns about a fixed axis bears nothing any more.

Under no load but its weight a body is in balance on an axis where its centre of mass stands above
it.  That place follows from geometry: no point of the curve is needed there.
"""

from __future__ import annotations

import numpy as np

from drystone.assessment.errors import AssessmentError
from drystone.assessment.mechanism.bodies import SAME
from drystone.assessment.mechanism.shapes import tangent_shape
from drystone.geometry import motion
from drystone.model.model import Model
from drystone.results.curve import STATIC, CapacityCurve


def stands_on_its_axis(curve: CapacityCurve, model: Model) -> float | None:
    """Control displacement [m] at which the one body that moves at the end stands on its axis.

    None where several bodies move, where the body slides along its axis or the axis is not
    horizontal, and where other things than weight act when the load is zero.
    """
    if model.ties or model.dead_loads:
        return None
    row = max(k for k, point in enumerate(curve.points) if point.status == STATIC)
    try:
        shape = tangent_shape(curve, model, row)
    except AssessmentError:
        return None
    if shape.n_bodies != 1:
        return None
    moving = shape.labels >= 0
    share = shape.mass[moving] / shape.mass[moving].sum()
    field, control, up = shape.field, model.control_point, motion.in_space(model.assembly.up)
    velocity = motion.in_space(share @ field.velocity[moving])
    spin = motion.spin_in_space(share @ field.spin[moving])
    turning, speed = float(np.linalg.norm(spin)), float(np.linalg.norm(velocity))
    if not turning > 0.0 or not speed > 0.0:
        return None
    axis = spin / turning
    if abs(axis @ up) > SAME or abs(velocity @ axis) > SAME * speed:
        return None
    # The chord of the last points is a turn about the axis, read off halfway: see `field`.
    on_axis = motion.in_space(share @ field.place[moving]) + np.cross(spin, velocity) / turning**2
    assert curve.poses is not None  # or there were no tangent
    pose = curve.poses[row]
    centre = share @ (model.assembly.centroid + motion.translations(pose))[moving]
    arm = motion.in_space(centre) - on_axis
    upright = up - (up @ axis) * axis
    angle = float(np.arctan2(np.cross(arm, upright) @ axis, arm @ upright))
    if not 0.0 < angle < 0.5 * np.pi:
        return None
    moved = model.assembly.displacement_at(control.block, control.point, pose)
    lever = motion.in_space(control.point + moved) - on_axis
    across = np.cross(axis, lever)
    turned = np.sin(angle) * across + (1.0 - np.cos(angle)) * np.cross(axis, across)
    along = control.direction @ moved - curve.settlement
    return float(along + turned @ motion.in_space(control.direction))
