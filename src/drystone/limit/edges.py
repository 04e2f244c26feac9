"""Where blocks touch in less than a face: edges and corners on faces, edges that cross.

The contacts are those that the engines find in the designed shape, with the gap up to which faces
touch.  A block that rests on an edge, or hangs in a notch, has no other joints.

Parts that a face of one alone separates can only move apart along its normal, and the contact is a
joint like any other.  Others are separated as well by faces of several directions: blocks at a
crossing of joints that run through, which have an edge in common, or blocks corner to corner.  They
*meet at a corner*, and are free to move apart along any one of those normals.  Such velocities are
no convex set.  With the contact along one normal a course could not slide past the one below,
where head joints run through; with none nothing is carried across the edge.  The latter is what
joints of limit analysis are, as edges are never quite sharp.  What is carried across lies between
normals, in the sum of the cones around all of them, which bounds it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drystone.assembly import Assembly
from drystone.contact.detection import Detector
from drystone.contact.forces import ContactForces
from drystone.geometry.outlines import TOUCHING
from drystone.kernels.contacts import PART_A, PART_B

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Normals of faces that enclose less than this angle [rad] are one direction: blocks as long as
#: wide that turn by it open or close by what touches.
ALIKE = TOUCHING


@dataclass(frozen=True, kw_only=True)
class Edges:
    """Contacts of an assembly, as designed, of parts that share no face; see the module.

    Row by row; a contact at a corner has a row for each direction in which its parts come apart.
    """

    block_a: IntArray  # (n,) row in the assembly
    block_b: IntArray  # (n,)
    position: Array  # (n, dim) m
    normal: Array  # (n, dim) from a to b
    area: Array  # (n,) m2, tributary, as in the engines
    corner: NDArray[np.bool_]  # (n,) whether the parts meet at a corner

    @classmethod
    def of(cls, assembly: Assembly) -> Edges:
        """Find them."""
        found, part_a, part_b = _touching(assembly)
        packed, seam = (
            assembly.packed,
            np.concatenate([s for f in assembly.figures for s in f.seams]),
        )
        near = TOUCHING * packed.pair_size(part_a, part_b)
        rows, normals, corner = [], [], []
        known: dict[tuple[int, int], list[Array]] = {}
        for i, pair in enumerate(zip(part_a.tolist(), part_b.tolist(), strict=True)):
            if pair not in known:
                known[pair] = _directions(assembly, seam, *pair, near[i])
            several = len(known[pair]) > 1
            for normal in known[pair] if several else [found.normal[i]]:
                rows.append(i)
                normals.append(normal)
                corner.append(several)
        row = np.array(rows, np.int64)
        return cls(
            block_a=found.block_a[row],
            block_b=found.block_b[row],
            position=found.position[row],
            normal=np.array(normals).reshape(-1, assembly.dimension),
            area=found.area[row],
            corner=np.array(corner, np.bool_),
        )


def _touching(assembly: Assembly) -> tuple[ContactForces, IntArray, IntArray]:
    """Contacts of parts that touch and share no face, and their parts."""
    detector, pose, packed = Detector(assembly), assembly.rest_pose(), assembly.packed
    pairs = detector.pairs(pose)
    slots = detector.find(pairs, pose)
    which = pairs.which[pairs.of_slot]
    part_a, part_b = which[:, PART_A], which[:, PART_B]
    joints, n = assembly.interfaces, len(packed.body)
    of_face = _parts_of_faces(assembly)
    p, q = of_face[joints.face_a], of_face[joints.face_b]
    joined = np.isin(
        np.minimum(part_a, part_b) * n + np.maximum(part_a, part_b),
        np.minimum(p, q) * n + np.maximum(p, q),
    )
    near = slots.gap <= TOUCHING * packed.pair_size(part_a, part_b)
    slots.kind[joined | ~near] = 0
    used = np.flatnonzero(slots.kind)
    nothing = np.zeros((len(slots.kind), assembly.dimension))
    found = detector.forces(pairs, pose, slots, nothing, np.zeros(len(nothing), np.int64))
    return found, part_a[used], part_b[used]


def _parts_of_faces(assembly: Assembly) -> IntArray:
    """Part that each face belongs to; faces of the plane are edges, by their first vertex."""
    packed = assembly.packed
    first = assembly.outlines.offset if assembly.dimension == 2 else assembly.polyhedra.part_faces
    return np.repeat(np.arange(len(packed.body)), np.diff(first))


def _directions(
    assembly: Assembly, seam: NDArray[np.bool_], a: int, b: int, near: float
) -> list[Array]:
    """Normals from part a to part b of the faces that separate them, each once.

    Seams of a block are no faces to come apart at: behind them it goes on.
    """
    found: list[Array] = []
    packed = assembly.packed
    for p, q, sign in ((a, b, 1.0), (b, a, -1.0)):
        others = packed.vertices[packed.offset[q] : packed.offset[q + 1]]
        place, normals, faces = _faces(assembly, p)
        least = np.min((others[None] - place[:, None]) @ normals[:, :, None], axis=(1, 2))
        for k in np.flatnonzero((least >= -near) & ~seam[faces]):
            normal = sign * normals[k]
            if all(np.linalg.norm(normal - other) > ALIKE for other in found):
                found.append(normal)
    return found


def _faces(assembly: Assembly, part: int) -> tuple[Array, Array, slice]:
    """A place on each face of a part, the normals outwards, and the faces' rows."""
    if assembly.dimension == 2:
        outlines = assembly.outlines
        rows = slice(outlines.offset[part], outlines.offset[part + 1])
        tangent = outlines.edges[0][rows]
        return outlines.vertices[rows], np.column_stack((tangent[:, 1], -tangent[:, 0])), rows
    solids = assembly.polyhedra
    rows = slice(solids.part_faces[part], solids.part_faces[part + 1])
    first = solids.rows[solids.face_offset[:-1][rows]]
    return solids.vertices[first], solids.normals[rows], rows
