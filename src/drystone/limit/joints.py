"""Joints of an assembly as designed, each reduced to contact points at its corners.

Limit analysis works in the designed shape: a joint is where faces of two blocks lie on each other,
and all it can carry is carried by forces at its corners, in the plane at its two ends.  Where edges
are rounded or cut off the corners lie back from them, as far as the contact shapes reach.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.geometry.interfaces import corner_shares
from drystone.geometry.outlines import Outlines
from drystone.geometry.polyhedra import Polyhedra
from drystone.geometry.solid_parts import touched_edges

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
    crushing: Array  # (n_contacts,) N, likewise; infinite where joints are not crushed
    joint: IntArray  # (n_contacts,) row of the joint, whose corners go round; -1 of none

    @property
    def n_contacts(self) -> int:
        """Number of points."""
        return len(self.block_a)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.position.shape[1]


def contact_points(assembly: Assembly, *, set_back: float | None = None) -> ContactPoints:
    """The contact points of an assembly: the corners of its joints, in the plane two to a joint.

    A joint so small that the treated corners leave nothing of it has none.

    Parameters
    ----------
    set_back
        How far from the edges of the faces the points lie [m], instead of where the treated corners
        of the blocks leave them.
    """
    joints = assembly.interfaces
    shapes, setback = _setbacks(assembly, set_back)
    corners, offset = joints.between_edges(shapes, setback)
    joint = np.repeat(np.arange(len(offset) - 1), np.diff(offset))
    still = assembly.fixed[joints.block_a] & assembly.fixed[joints.block_b]
    kept = np.flatnonzero(~still[joint])
    row = joint[kept]
    a, b = joints.block_a[row], joints.block_b[row]
    normal, tangent = joints.normal[row], joints.tangent[row]
    area = assembly.thickness * joints.size[row] * corner_shares(corners, offset)[kept]
    laws = [
        (
            law.friction_coefficient,
            np.tan(np.radians(law.dilatancy_angle)),
            law.cohesion,
            law.tensile_strength,
            law.compressive_strength,
        )
        for law in assembly.laws
    ]
    of_joint = np.array(laws)[assembly.law_index(a, b)].T
    friction, dilatancy, cohesion, tension, crushing = of_joint
    across = [np.cross(normal, tangent)] if assembly.dimension == 3 else []
    return ContactPoints(
        block_a=a,
        block_b=b,
        position=corners[kept],
        frame=np.stack((normal, tangent, *across), axis=1),
        area=area,
        friction=friction,
        dilatancy=np.minimum(dilatancy, friction),
        cohesion=cohesion * area,
        tension=tension * area,
        crushing=crushing * area,
        joint=row,
    )


def _setbacks(assembly: Assembly, set_back: float | None) -> tuple[Outlines | Polyhedra, Array]:
    """The designed shapes and how far their faces recede, see `Interfaces.between_edges`."""
    if assembly.dimension == 2:
        outlines = assembly.outlines
        if set_back is not None:
            return outlines, np.full((len(outlines.vertices), 2), set_back)
        return outlines, outline_setbacks(assembly)
    solids, corner = assembly.polyhedra, assembly.corner
    if set_back is not None:
        return solids, np.full(len(solids.rows), set_back)
    if corner.radius:
        seam = np.concatenate([own for figure in assembly.figures for own in figure.seams])
        return solids, solids.setbacks(np.where(seam, 0.0, corner.radius))
    return solids, _cut_back(assembly, corner.chamfer or 0.0)


def _cut_back(assembly: Assembly, leg: float) -> Array:
    """How far faces recede from edges that are cut off, (n_edges,) [m]: nothing at seams."""
    solids = assembly.polyhedra
    setback = np.full(len(solids.rows), leg)
    part = 0
    for figure in assembly.figures:
        several = len(figure.parts) > 1 and leg > 0.0
        for uncut in touched_edges(figure.parts) if several else ():
            edges = slice(*solids.face_offset[solids.part_faces[part : part + 2]])
            first = solids.offset[part]
            ends = np.stack((solids.rows[edges], solids.following[edges])) - first
            named = zip(*np.sort(ends, axis=0).tolist(), strict=True)
            setback[edges][[edge in uncut for edge in named]] = 0.0
            part += 1
        part += 0 if several else len(figure.parts)
    return setback


def outline_setbacks(assembly: Assembly) -> Array:
    """By how much the contact shape is shorter than each edge of the outlines at its two ends.

    (n_vertices, 2) [m], in the order of the outlines' vertices; a chamfer puts an edge of its own
    after an edge of the outline, which is left out.
    """
    shapes, outlines = assembly.shapes, assembly.outlines
    corners, rows = np.diff(outlines.offset), np.diff(shapes.offset)
    per_corner = rows // corners
    edge = np.arange(corners.sum()) - np.repeat(outlines.offset[:-1], corners)
    row = np.repeat(shapes.offset[:-1], corners) + np.repeat(per_corner, corners) * edge
    for part in np.flatnonzero(rows % corners):  # some corners are cut off, others are not
        at = shapes.offset[part]
        for i in range(outlines.offset[part], outlines.offset[part + 1]):
            row[i] = at
            at += 2 if shapes.setback[at, 1] > 0.0 else 1
    return shapes.setback[row]
