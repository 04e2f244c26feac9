"""The made-up wall of `synthetic` as solids, with the states of the plane: x stays, y becomes z."""

from __future__ import annotations

import numpy as np
import synthetic

from drystone.contact.forces import ContactForces
from drystone.model.builders import extruded
from drystone.model.model import Model


def wall_model() -> tuple[Model, Model]:
    """Of the plane and of space."""
    plane = synthetic.wall_model()
    return plane, extruded(plane)


def vectors(plane: np.ndarray, depth: float = 0.0) -> np.ndarray:
    """Vectors (n, 2) in the plane x-z, (n, 3)."""
    return np.column_stack((plane[:, 0], np.full(len(plane), depth), plane[:, 1]))


def pose_of(plane: np.ndarray) -> np.ndarray:
    """Poses (n, 3) of the plane as those of space, (n, 7).

    From x to z is a turn about -y: the quaternion of theta about it is (cos, 0, -sin, 0) of half.
    """
    half, none = 0.5 * plane[:, 2], np.zeros(len(plane))
    turn = np.column_stack((np.cos(half), none, -np.sin(half), none))
    return np.hstack((vectors(plane[:, :2]), turn))


def contacts_of(plane: ContactForces) -> ContactForces:
    """Contacts of the plane as those of space, with a force across it, too."""
    return ContactForces(
        block_a=plane.block_a,
        block_b=plane.block_b,
        position=vectors(plane.position, 0.5),
        normal=vectors(plane.normal),
        gap=plane.gap,
        area=plane.area,
        normal_reaction=plane.normal_reaction,
        tangential_reaction=np.column_stack((plane.tangential_reaction, plane.normal_reaction / 7)),
        status=plane.status,
        tangent=vectors(plane.tangents[:, 0]),
    )


def states(model: Model, displacement: float) -> tuple[np.ndarray, ContactForces]:
    """Pose and contacts in space at a control displacement [m] of the plane ``model``."""
    pose = synthetic.pose_at(model, displacement)
    return pose_of(pose), contacts_of(synthetic.contacts_at(model, pose))
