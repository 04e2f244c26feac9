"""Plane blocks in a simulation of solids: as prisms that keep to their plane, and folded back.

The folding is all that the plane has of its own: points at front and back of the prisms are one,
and of motions and forces what is across the plane is left out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry.space.solid import Part
from drystone_lmgc90 import wheel
from drystone_lmgc90.messages import Outcome, Setup, Step

#: Depths of the prisms that are tried, over the thickness: where a block is as deep as it is long,
#: its axes of inertia are undetermined and need not lie in the plane.
DEPTHS = (1.0, 1.37, 0.73)
#: What of motions and forces in space is in the plane.
IN_PLANE = [0, 1, 5]


class Simulation:
    """The one simulation of this process: prisms."""

    def __init__(self, setup: Setup) -> None:
        for depth in DEPTHS:
            try:
                self.solids = wheel.Simulation(extruded(setup, depth * setup.thickness))
                break
            except wheel.NoUprightAxisError as error:
                missing = error
        else:
            raise missing
        #: Points of the plane are at least so far apart [m].
        self.apart = 0.02 * min(float(np.ptp(s.vertices, axis=0).min()) for s in setup.shapes)
        self.turn = self.pending = np.zeros(len(setup.shapes))  # rad, at the end of the last step
        self.ready = self.solids.ready

    def step(self, request: Step) -> Outcome:
        """See `wheel.Simulation.step`."""
        if request.accept:
            self.turn = self.pending
        force = np.zeros((len(self.turn), wheel.N_DOF))
        force[:, IN_PLANE] = request.force
        outcome = self.solids.step(replace(request, force=force))
        # Half the angle is the quaternion's; whole turns are those of the last step.
        angle = 2.0 * np.arctan2(outcome.pose[:, 6], outcome.pose[:, 3])
        self.pending = self.turn + np.remainder(angle - self.turn + np.pi, 2.0 * np.pi) - np.pi
        return replace(
            folded(outcome, self.apart),
            pose=np.column_stack((outcome.pose[:, :2], self.pending)),
            velocity=outcome.velocity[:, IN_PLANE],
            contact_force=outcome.contact_force[:, IN_PLANE],
        )


def extruded(setup: Setup, depth: float) -> Setup:
    """Prisms of another ``depth`` [m], and as heavy, that keep to their plane."""
    return replace(
        setup,
        shapes=tuple(extrude(shape.vertices, depth) for shape in setup.shapes),
        axes=np.broadcast_to(np.eye(3), (len(setup.shapes), 3, 3)),
        density=setup.density * setup.thickness / depth,
        thickness=1.0,
        upright=True,
    )


def extrude(polygon: Array, thickness: float) -> Part:
    """Prism over a convex polygon in the plane z = 0, which it lies on both sides of.

    Parameters
    ----------
    polygon
        (m, 2) [m], counter-clockwise.

    Returns
    -------
    Part
        Its vertices (2 m, 3) [m] are first those at the back, z = -thickness / 2, then those at the
        front; its faces are triangles, (4 m - 4) of them.
    """
    m = len(polygon)
    back = np.column_stack((polygon, np.full(m, -0.5 * thickness)))
    front = back + (0.0, 0.0, thickness)
    faces = []
    for i in range(1, m - 1):
        faces += [(0, i + 1, i), (m, m + i, m + i + 1)]
    for i in range(m):
        j = (i + 1) % m
        faces += [(i, j, m + j), (i, m + j, m + i)]
    return Part(np.vstack((back, front)), tuple(faces))


def folded(outcome: Outcome, apart: float) -> Outcome:
    """Contacts of the plane: points of prisms at front and back added up; see `same_place`."""
    body_a, body_b = outcome.body_a, outcome.body_b
    point = same_place(body_a, body_b, outcome.position[:, :2], apart)
    count = np.bincount(point)[:, None].astype(float)

    def total(values: Array) -> Array:
        sums = np.zeros((len(count), *values.shape[1:]))
        np.add.at(sums, point, values)
        return sums

    second = np.cross(outcome.normal, outcome.tangent)
    axes = np.stack((outcome.normal, outcome.tangent, second), axis=1)
    force = total(np.einsum("ki,kij->kj", outcome.reaction, axes)[:, :2])
    normal = total(outcome.normal[:, :2])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    across = force[:, 0] * normal[:, 1] - force[:, 1] * normal[:, 0]
    one = np.unique(point, return_index=True)[1]
    return replace(
        outcome,
        body_a=body_a[one],
        body_b=body_b[one],
        position=total(outcome.position[:, :2]) / count,
        normal=normal,
        tangent=np.zeros((len(one), 0)),
        gap=total(outcome.gap) / count[:, 0],
        reaction=np.column_stack((np.sum(force * normal, axis=1), across)),
        stiffness=total(outcome.stiffness),
    )


def same_place(body_a: IntArray, body_b: IntArray, position: Array, apart: float) -> IntArray:
    """Number of the plane point that each point of a prism belongs to, (n_contacts,).

    Points of the same two bodies that are nearer to each other than ``apart`` [m] in the plane
    are one; numbers count from 0 in the order in which the plane points are first met.
    """
    number = np.full(len(body_a), -1, dtype=np.int64)
    first: dict[tuple[int, int], list[int]] = {}
    count = 0
    for k, pair in enumerate(zip(body_a.tolist(), body_b.tolist(), strict=True)):
        for other in first.setdefault(pair, []):
            if np.hypot(*(position[k] - position[other])) < apart:
                number[k] = number[other]
                break
        else:
            number[k] = count
            count += 1
            first[pair].append(k)
    return number
