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
from drystone.builders.neighbours import Outlines

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
    outlines = Outlines.of(assembly)
    a, b = outlines.near_pairs()
    keep = ~(assembly.fixed[a] & assembly.fixed[b])
    a, b = a[keep], b[keep]
    shared = outlines.shared_edges(a, b)
    setback = outline_setbacks(assembly)
    back_a, back_b = setback[shared.edge_a], setback[shared.edge_b]

    following = np.arange(1, len(outlines.vertices) + 1)
    following[outlines.offset[1:] - 1] = outlines.offset[:-1]
    start = outlines.vertices[shared.edge_a]
    tangent = outlines.vertices[following[shared.edge_a]] - start
    length = np.linalg.norm(tangent, axis=1)
    tangent = tangent / length[:, None]
    # The edge of b runs backwards: it ends, with its own second setback, where the part begins.
    low = np.maximum(back_a[:, 0], shared.extent_b[:, 0] + back_b[:, 1])
    high = np.minimum(length - back_a[:, 1], shared.extent_b[:, 1] - back_b[:, 0])
    joint = np.flatnonzero(high > low)

    two = np.repeat(joint, 2)
    along = np.column_stack((low[joint], high[joint])).ravel()
    pair = shared.pair[two]
    normal = np.column_stack((tangent[two, 1], -tangent[two, 0]))
    area = 0.5 * assembly.thickness * (shared.extent[two, 1] - shared.extent[two, 0])
    laws = [
        (
            law.friction_coefficient,
            np.tan(np.radians(law.dilatancy_angle)),
            law.cohesion,
            law.tensile_strength,
        )
        for law in assembly.laws
    ]
    friction, dilatancy, cohesion, tension = np.array(laws)[assembly.law_index(a, b)[pair]].T
    return ContactPoints(
        block_a=a[pair],
        block_b=b[pair],
        position=start[two] + along[:, None] * tangent[two],
        frame=np.stack((normal, -tangent[two]), axis=1),
        area=area,
        friction=friction,
        dilatancy=np.minimum(dilatancy, friction),
        cohesion=cohesion * area,
        tension=tension * area,
    )


def outline_setbacks(assembly: Assembly) -> Array:
    """By how much the contact shape is shorter than each edge of the outlines at its two ends.

    (n_vertices, 2) [m], in the order of `Outlines.vertices`; a chamfer puts an edge of its own
    after each edge of the outline, which is left out.
    """
    shapes = assembly.shapes
    corners = np.array([len(block.vertices) for block in assembly.blocks])
    per_corner = np.diff(shapes.offset) // corners
    offset = np.cumsum(corners) - corners
    edge = np.arange(corners.sum()) - np.repeat(offset, corners)
    row = np.repeat(shapes.offset[:-1], corners) + np.repeat(per_corner, corners) * edge
    return shapes.setback[row]
