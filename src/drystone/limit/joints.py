"""Joints of an assembly as designed, each reduced to contact points at its ends.

Limit analysis works in the designed shape: a joint is where edges of two blocks lie on each other,
and all it can carry is carried by a force at either end.  Where corners are rounded or cut off the
ends lie back from the corners, as far as the contact shapes reach.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class ContactPoints:
    """The points where blocks can push on each other, one row each; arrays of any dimension."""

    block_a: IntArray  # (n_contacts,) row in the assembly
    block_b: IntArray  # (n_contacts,)
    position: Array  # (n_contacts, dim) m
    frame: Array  # (n_contacts, dim, dim) rows: normal from a to b, then the tangents
    area: Array  # (n_contacts,) m2, the point's share of its joint
    friction: Array  # (n_contacts,) tangent of the friction angle
    dilatancy: Array  # (n_contacts,) tangent of the dilatancy angle
    cohesion: Array  # (n_contacts,) N, of the point's share
    tension: Array  # (n_contacts,) N, likewise

    @property
    def n_contacts(self) -> int:
        """Number of points."""
        return len(self.block_a)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.position.shape[1]


def contact_points(assembly: Assembly) -> ContactPoints:
    """The contact points of a plane assembly: two to a joint.

    A joint so short that the treated corners leave nothing of it has none.
    """
    joints = assembly.interfaces
    ends, left = joints.between_corners(assembly.outlines, outline_setbacks(assembly))
    still = assembly.fixed[joints.block_a] & assembly.fixed[joints.block_b]
    two = np.repeat(np.flatnonzero(~still & (left > 0.0)), 2)
    a, b, normal = joints.block_a[two], joints.block_b[two], joints.normal[two]
    tangent = np.column_stack((normal[:, 1], -normal[:, 0]))
    area = 0.5 * assembly.thickness * joints.size[two]
    laws = [
        (
            law.friction_coefficient,
            np.tan(np.radians(law.dilatancy_angle)),
            law.cohesion,
            law.tensile_strength,
        )
        for law in assembly.laws
    ]
    friction, dilatancy, cohesion, tension = np.array(laws)[assembly.law_index(a, b)].T
    return ContactPoints(
        block_a=a,
        block_b=b,
        position=ends[two[::2]].reshape(-1, 2),
        frame=np.stack((normal, tangent), axis=1),
        area=area,
        friction=friction,
        dilatancy=np.minimum(dilatancy, friction),
        cohesion=cohesion * area,
        tension=tension * area,
    )


def outline_setbacks(assembly: Assembly) -> Array:
    """By how much the contact shape is shorter than each edge of the outlines at its two ends.

    (n_vertices, 2) [m], in the order of the outlines' vertices; a chamfer puts an edge of its own
    after each edge of the outline, which is left out.
    """
    shapes = assembly.shapes
    corners = np.array([len(block.vertices) for block in assembly.blocks])
    per_corner = np.diff(shapes.offset) // corners
    offset = np.cumsum(corners) - corners
    edge = np.arange(corners.sum()) - np.repeat(offset, corners)
    row = np.repeat(shapes.offset[:-1], corners) + np.repeat(per_corner, corners) * edge
    return shapes.setback[row]
