"""Joints of an assembly as designed, each reduced to contact points at its corners.

Limit analysis works in the designed shape.  A joint is the area in which faces of two blocks lie on
each other.  Any stress in it can be replaced by forces at its corners, in the plane at its two
ends.  If edges are rounded or cut off, the corners are set back to the end of the contact shapes.
Blocks that touch in less than a face have the contacts of the engines, see `edges`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.geometry.interfaces import corner_shares
from drystone.geometry.motion import any_tangent, tangents
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.space.parts import touched_edges
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.limit.edges import Edges
from drystone.model.assembly import Assembly


@dataclass(frozen=True, kw_only=True)
class ContactPoints:
    """The points at which blocks can exert forces on each other, one row each; in the plane and in
    space."""

    block_a: IntArray  # (n_contacts,) row in the assembly
    block_b: IntArray  # (n_contacts,)
    position: Array  # (n_contacts, dim) m
    frame: Array  # (n_contacts, dim, dim) rows: normal from a to b, then the tangents
    area: Array  # (n_contacts,) m2, the point's share of its joint
    friction: Array  # (n_contacts,) tangent of the friction angle
    dilatancy: Array  # (n_contacts,) tangent of the dilatancy angle
    cohesion: Array  # (n_contacts,) N, of the point's share
    tension: Array  # (n_contacts,) N, of the point's share
    crushing: Array  # (n_contacts,) N, of the point's share; infinite if joints are not crushed
    joint: IntArray  # (n_contacts,) row of the joint, whose corners follow each other; -1: none

    @property
    def n_contacts(self) -> int:
        """Number of points."""
        return len(self.block_a)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.position.shape[1]


def contact_points(
    assembly: Assembly,
    *,
    set_back: float | None = None,
    edges: Edges | None = None,
    corners: bool = False,
) -> ContactPoints:
    """The contact points of an assembly: the corners of its joints, in the plane two to a joint,
    and where blocks touch in less than a face.

    A joint so small that the treated corners leave nothing of it has none.

    Parameters
    ----------
    set_back
        Distance of the points from the edges of the faces [m], instead of that which follows from
        the treated corners of the blocks.  Edges on faces then have no contacts.
    edges
        Where blocks touch in less than a face, if this is known already.
    corners
        Whether blocks that meet at a corner also have contacts, in all possible directions.  These
        contacts bound the forces that such blocks exert on each other.
    """
    joints = assembly.interfaces
    shapes, setback = _setbacks(assembly, set_back)
    places, offset = joints.between_edges(shapes, setback)
    joint = np.repeat(np.arange(len(offset) - 1), np.diff(offset))
    still = assembly.fixed[joints.block_a] & assembly.fixed[joints.block_b]
    kept = np.flatnonzero(~still[joint])
    row = joint[kept]
    of_faces = points_at(
        assembly,
        blocks=(joints.block_a[row], joints.block_b[row]),
        position=places[kept],
        normal=joints.normal[row],
        tangent=joints.tangent[row],
        area=assembly.thickness * joints.size[row] * corner_shares(places, offset)[kept],
        joint=row,
    )
    if set_back:
        return of_faces
    return joined(of_faces, _of_edges(assembly, edges or Edges.of(assembly), corners))


def points_at(
    assembly: Assembly,
    *,
    blocks: tuple[IntArray, IntArray],
    position: Array,
    normal: Array,
    tangent: Array,
    area: Array,
    joint: IntArray,
) -> ContactPoints:
    """Contact points with the laws of their blocks' joints; the arrays are those of the record.

    Those of no ``joint``, -1, are not crushed: engines do not crush edges either.
    """
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
    of_joint = np.array(laws)[assembly.law_index(*blocks)].T
    friction, dilatancy, cohesion, tension, crushing = of_joint
    return ContactPoints(
        block_a=blocks[0],
        block_b=blocks[1],
        position=position,
        frame=np.concatenate((normal[:, None], tangents(normal, tangent)), axis=1),
        area=area,
        friction=friction,
        dilatancy=np.minimum(dilatancy, friction),
        cohesion=cohesion * area,
        tension=tension * area,
        crushing=np.where(joint >= 0, crushing * area, np.inf),
        joint=joint,
    )


def joined(*parts: ContactPoints) -> ContactPoints:
    """The points of several records, one after the other."""
    return ContactPoints(
        **{
            key.name: np.concatenate([getattr(part, key.name) for part in parts])
            for key in fields(ContactPoints)
        }
    )


def _of_edges(assembly: Assembly, edges: Edges, corners: bool) -> ContactPoints:
    """Contact points of blocks that touch in less than a face."""
    rows = np.flatnonzero(~edges.corner | corners)
    normal = edges.normal[rows]
    return points_at(
        assembly,
        blocks=(edges.block_a[rows], edges.block_b[rows]),
        position=edges.position[rows],
        normal=normal,
        tangent=any_tangent(normal),
        area=edges.area[rows],
        joint=np.full(len(rows), -1),
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
