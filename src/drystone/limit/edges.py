"""Where blocks touch in less than a face: edges and corners on faces, edges that cross.

The contacts are those that the engines find in the designed shape, with the gap up to which faces
touch.  A block that rests on an edge, or hangs in a notch, has no other joints.

If only one face separates two parts, they can only move apart along its normal, and the contact is
a joint like any other.  Other parts are separated equally well by faces of several directions.
Examples are blocks with a common edge, where joints that run through cross, and blocks corner to
corner.  Such parts *meet at a corner*, and may move apart along any one of these normals.  The
possible velocities are not a convex set.  With a contact along one normal, a course could not slide
past the one below if head joints run through.  Without a contact, no force acts across the edge.
Limit analysis has no contact here, because edges are never quite sharp.  Any force across the edge
lies between the normals, in the sum of the cones around all of them, which gives a bound.

An edge in a notch is no such corner.  The part on either side of the notch's root allows motion
along several normals, but both parts together only along those of the notch.  If two blocks touch
in one place by several parts, each choice of one normal for each part allows a cone of velocities.
If the cone of one choice contains those of all others, the blocks are free along this choice, and
the contacts are joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import TOUCHING
from drystone.contact.contacts import PART_A, PART_B
from drystone.contact.detection import Detector
from drystone.contact.forces import ContactForces
from drystone.geometry.patches import is_on
from drystone.model.assembly import Assembly

#: Normals of faces that enclose less than this angle [rad] are one direction: blocks as long as
#: wide that turn by it open or close by what touches.
ALIKE = TOUCHING
#: Choices of normals in one place that are looked at; beyond, it stays a corner.
MOST_CHOICES = 64


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
    corner: BoolArray  # (n,) whether the parts meet at a corner

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
        options = []
        for i, pair in enumerate(zip(part_a.tolist(), part_b.tolist(), strict=True)):
            if pair not in known:
                known[pair] = _directions(assembly, seam, *pair, near[i])
            options.append(known[pair] if len(known[pair]) > 1 else [found.normal[i]])
        options = _in_notches(assembly, found, near, options)
        for i, own in enumerate(options):
            several = len(own) > 1
            for normal in own:
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
    detector, pose, packed = Detector(assembly), assembly.design_pose(), assembly.packed
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
    return np.repeat(np.arange(len(packed.body)), np.diff(packed.first_faces))


def _directions(assembly: Assembly, seam: BoolArray, a: int, b: int, near: float) -> list[Array]:
    """Normals from part a to part b of the faces that separate them, each once.

    Seams of a block are no faces to come apart at: behind them it goes on.
    """
    found: list[Array] = []
    packed = assembly.packed
    for p, q, sign in ((a, b, 1.0), (b, a, -1.0)):
        others = packed.vertices[packed.offset[q] : packed.offset[q + 1]]
        place, normals, faces = packed.faces_of_part(p)
        least = np.min((others[None] - place[:, None]) @ normals[:, :, None], axis=(1, 2))
        for k in np.flatnonzero((least >= -near) & ~seam[faces]):
            normal = sign * normals[k]
            if all(np.linalg.norm(normal - other) > ALIKE for other in found):
                found.append(normal)
    return found


def _in_notches(
    assembly: Assembly, found: ContactForces, near: Array, options: Sequence[list[Array]]
) -> list[list[Array]]:
    """The normals of each contact, only one of them where those of the other parts of its two
    blocks that touch in the same place leave no choice; see the module."""
    chosen = list(options)
    joints = assembly.interfaces
    for i in [k for k, own in enumerate(options) if len(own) > 1]:
        a, b, place = found.block_a[i], found.block_b[i], found.position[i]
        # Blocks of one part each have no notch.
        if max(len(assembly.figures[k].parts) for k in (a, b)) == 1:
            continue
        same = (found.block_a == a) & (found.block_b == b)
        same &= np.linalg.norm(found.position - place, axis=1) <= near[i]
        same[i] = False
        low, high = min(a, b), max(a, b)
        sense = 1.0 if a == low else -1.0
        faces = [
            sense * joints.normal[j]
            for j in np.flatnonzero((joints.block_a == low) & (joints.block_b == high))
            if is_on(joints.corners[joints.offset[j] : joints.offset[j + 1]], place, near[i])
        ]
        others = [options[k] for k in np.flatnonzero(same).tolist()]
        normal = _widest([options[i], *others], faces)
        if normal is not None:
            chosen[i] = [normal]
    return chosen


def _widest(options: Sequence[Sequence[Array]], always: Sequence[Array]) -> Array | None:
    """The first of the normals chosen where one choice, of one of each of the ``options``, leaves
    all the velocities that any does; None where none does.  Those ``always`` there go with each.

    One leaves all that another does if its normals are sums of the other's (Farkas).
    """
    if np.prod([len(own) for own in options]) > MOST_CHOICES:
        return None
    choices = [[*choice, *always] for choice in product(*options)]
    for choice in choices:
        own = choice[: len(options)]
        if all(_is_sum(normal, other) for other in choices for normal in own):
            return own[0]
    return None


def _is_sum(normal: Array, of: Sequence[Array]) -> bool:
    """Whether a unit vector is a sum of multiples of others, none of them negative."""
    from scipy.optimize import nnls  # takes long to import; parts that share faces do without

    return bool(nnls(np.array(of).T, normal)[1] <= ALIKE)
