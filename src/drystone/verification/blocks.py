"""Models of closed forms: one block on a fixed base, two on each other, one in space."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from drystone.common.arrays import Array
from drystone.geometry.space import solid
from drystone.model.assembly import Block, Corner
from drystone.model.builders.stones import rectangle
from drystone.model.construction.model import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Model

UNIT_WEIGHT = 10e3  # N/m3, of all blocks here


def on_base(
    width: float,
    heights: tuple[float, ...],
    *,
    friction: float,
    stiffness: float,
    radius: float | None = None,
    slope: float = 0.0,
    point: str = "top right",
) -> Model:
    """Blocks of one width on each other, on a long fixed base, pushed to the right.

    Parameters
    ----------
    width, heights
        Of the blocks, from below [m].
    stiffness
        Of joints, normal and in shear [Pa/m].
    radius
        Of corners [m]; None of sharp ones.
    slope
        By which the base falls to the right [rad].
    point
        Of the highest block, which is controlled.
    """
    c, s = np.cos(slope), np.sin(slope)
    turn = np.array([[c, s], [-s, c]])

    def block(name: str, low: float, high: float, half: float, **more: Any) -> Block:
        corners = np.asarray(rectangle(-half, low, half, high)) @ turn.T
        return Block(id=name, vertices=corners, unit_weight=UNIT_WEIGHT, **more)

    tops = np.cumsum((0.0, *heights))
    return make_model(
        [
            block("base", -0.2, 0.0, 2.0, support=True),
            *(
                block(f"b{k}", low, high, 0.5 * width)
                for k, (low, high) in enumerate(pairwise(tops), 1)
            ),
        ],
        joint=JointLaw(
            friction_coefficient=friction, normal_stiffness=stiffness, shear_stiffness=stiffness
        ),
        corner=Corner(radius=radius),
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block=f"b{len(heights)}",
        control_point=point,
    )


def solid_on_base(
    sizes: tuple[float, float, float], angle: float, *, friction: float, stiffness: float
) -> Model:
    """A solid block [m] on a wide base, pushed at an angle [rad] to its width."""
    boxes = {
        "base": solid.box([[-1.0, -1.0, -0.2], [1.5, 1.5, 0.0]]),
        "block": solid.box([[0.0, 0.0, 0.0], sizes]),
    }
    return make_model(
        [
            Block(
                id=name,
                vertices=vertices,
                faces=faces,
                unit_weight=UNIT_WEIGHT,
                support=name == "base",
            )
            for name, (vertices, faces) in boxes.items()
        ],
        joint=JointLaw(
            friction_coefficient=friction, normal_stiffness=stiffness, shear_stiffness=stiffness
        ),
        load_direction=(float(np.cos(angle)), float(np.sin(angle)), 0.0),
    )


def rocking_branch(width: float, height: float, radius: float) -> tuple[Array, Array, Array]:
    """Control displacement [m], multiplier and rotation [rad] of a rigid block on its toe.

    The disc of the corner rolls; its centre is (b / 2 - r, r) from the middle of the foot.  The
    load acts at the centroid, so that the multiplier is the weight's arm about the contact over
    the centroid's height.  The control point is the top of the block over the toe.
    """
    theta = np.linspace(0.0, np.arctan(width / height), 20001)
    c, s = np.cos(theta), np.sin(theta)
    arm_x, arm_y = 0.5 * width - radius, 0.5 * height - radius
    multiplier = (arm_x * c - arm_y * s) / (radius + arm_y * c + arm_x * s)
    displacement = radius * theta + radius * (c - 1.0) + (height - radius) * s
    return displacement, multiplier, theta


def exact_rocking(angle: Array, width: float, height: float) -> Array:
    """Multiplier under which a rigid block stands on a sharp corner, tilted by angles (n,)."""
    c, s = np.cos(np.abs(angle)), np.sin(np.abs(angle))
    return np.asarray((width * c - height * s) / (height * c + width * s))


def exact_stack(angle: Array, width: float, height: float, stiffness: float) -> Array:
    """As `exact_rocking`, of two equal blocks on each other, the lower one tilted by angles (n,).

    The upper block tilts by more, as the two contacts of the joint between them, at both ends of
    its length b, give way: the load T along the joint, at the height h / 2 over it, makes a couple
    of T h / (2 b) more and less in the contacts, whose stiffness is k b / 2.  The multiplier is the
    lever of both weights over the height of both centroids.
    """
    weight = width * height * UNIT_WEIGHT
    tilt = np.abs(angle)
    load = exact_rocking(tilt, width, 2.0 * height)
    for _ in range(5):  # the joint's tilt, 1e-6, changes the load by as much
        along = weight * (load * np.cos(tilt) + np.sin(tilt))
        couple = 0.5 * along * height / width
        upper = tilt + 2.0 * couple / (0.5 * stiffness * width) / width
        lever = 0.5 * width * np.cos(tilt) - 0.5 * height * np.sin(tilt)
        above = 0.5 * height * np.cos(tilt) + 0.5 * width * np.sin(tilt)
        upper_lever = lever - 0.5 * height * (np.sin(tilt) + np.sin(upper))
        upper_above = above + 0.5 * height * (np.cos(tilt) + np.cos(upper))
        load = (lever + upper_lever) / (above + upper_above)
    return load
