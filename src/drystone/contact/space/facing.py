"""Which faces of two convex parts meet: the reference face and the incident one.

The face that separates the parts most is the reference face, the face of the other part that is
most opposed to it the incident one.  Solids that meet in less than a face, along an edge or in a
point, are separated as well by faces of several directions, but for rounding: a block that is edge
on edge with the one below and beside it by a bed face and by a head face.  What would then change
with every turn of the axes is decided by what the solids are.  Of faces that separate alike (TIED)
the reference face is

1. the one whose overlap with its incident face is largest, seen along its normal;
2. where all overlaps are a line or a point, the one whose interface is the smallest;
3. the first one of the part as designed.

The second is so because solids that only touch have no joint to press on: the LEAST_SHARE that they
are given keeps them from passing through each other, and stiffens a structure falsely, the less the
smaller it is.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.space.overlap import CLIP, ROUNDING, clip, measure
from drystone.contact.space.separation import most_opposed, most_opposed_near, separation

#: The area of an interface is at least this share of its smaller face.
LEAST_SHARE = 0.01

#: Faces are kept while others separate the parts by no more than this share of their size more, or
#: are more opposed by no more than this.
HELD = 1e-3

#: Faces that separate the parts by this share of their size less do so alike: more than the
#: rounding of places, and less than a gap that a drawing means.
TIED = 1e-6

#: Where parts meet in an edge or a point alone, another face separates them as soon as it does so
#: by this share of their size more than the present one: a rounding.  Such parts may come apart
#: along each of these faces' normals.  If the face were kept as flush ones are (HELD), it would
#: hold parts that slide past each other: two stones on two, head joints in line, carried a tenth to
#: a half more.
EDGED = 1e-9

#: An edge that lies on a face but for less than this angle [rad] rests on it at both of its ends.
FLAT = 0.05


@njit(cache=True)
def incident_face(first, ring, corner, vertex, normal, face, q, kept, deepest):
    """Face of part q that meets a reference face, and their cosine; see `most_opposed`.

    ``deepest`` [m] is how far above the reference face the part may be and touch.
    """
    found, cosine = most_opposed(first, normal, face, q, kept, HELD)
    if cosine > -1.0 + HELD:  # on a vertex or an edge: of a face that has it
        trial, better = most_opposed_near(first, ring, corner, vertex, normal, face, q, deepest)
        if better > cosine + 2.0 * HELD:
            return trial, better
    return found, cosine


@njit(cache=True)
def edge_on_face(edge, normal, edge_p, edge_q, axis):
    """Whether an edge of p or q lies nearly flat on a face of the other at their crossing, and how.

    ``axis`` (3,) is the one that the edges cross on, from p to q.  Returned is whether the face is
    one of p, the face, or -1 where both edges cross in earnest, and the face of the other part
    behind that edge which is more opposed to it.
    """
    least, of_p, face = 1.0 - 0.5 * FLAT * FLAT, True, -1
    for side in range(2):
        chosen, sign = (edge_p, 1.0) if side == 0 else (edge_q, -1.0)
        for c in range(2, 4):
            f = edge[chosen, c]
            along = axis[0] * normal[f, 0] + axis[1] * normal[f, 1] + axis[2] * normal[f, 2]
            if sign * along > least:
                least, of_p, face = sign * along, side == 0, f
    if face < 0:
        return True, -1, -1
    other, found, most = edge_q if of_p else edge_p, -1, np.inf
    for c in range(2, 4):
        f, along = edge[other, c], 0.0
        for i in range(3):
            along += normal[face, i] * normal[f, i]
        if along < most:
            most, found = along, f
    return of_p, face, found


@njit(cache=True)
def project(ring, corner, vertex, face, origin, t1, t2, backwards, out):
    """Corners of a face in the coordinates of a plane, (m, 2); returns m."""
    begin, m = ring[face], ring[face + 1] - ring[face]
    for j in range(m):
        v = corner[begin + (m - 1 - j if backwards else j), 0]
        x, y = 0.0, 0.0
        for i in range(3):
            d = vertex[v, i] - vertex[origin, i]
            x += t1[i] * d
            y += t2[i] * d
        out[j, 0], out[j, 1] = x, y
    return m


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def project_both(
    ring, corner, vertex, normal, plane, turn, body, face_p, face_q, t1, t2, reference, incident
):
    """Corners of both faces, seen along the normal of p, which ``body`` carries; their numbers."""
    for i in range(3):
        t1[i] = plane[face_p, 3 + i]
        for k in range(3):
            t1[i] += turn[body, i, k] * plane[face_p, 3 + k]
    nx, ny, nz = normal[face_p, 0], normal[face_p, 1], normal[face_p, 2]
    t2[0], t2[1], t2[2] = ny * t1[2] - nz * t1[1], nz * t1[0] - nx * t1[2], nx * t1[1] - ny * t1[0]
    origin = corner[ring[face_p], 0]
    n = project(ring, corner, vertex, face_p, origin, t1, t2, False, reference)
    m = project(ring, corner, vertex, face_q, origin, t1, t2, True, incident)
    return n, m


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def _worth(
    ring, corner, vertex, normal, plane, extent, turn, body, face_p, face_q, cosine, t1, t2,
    reference, incident, polygon, name,
):  # fmt: skip
    """Overlap of two faces [m2]; of a line or a point less than nothing, of none the least."""
    n, m = project_both(
        ring, corner, vertex, normal, plane, turn, body, face_p, face_q, t1, t2, reference, incident
    )
    near = CLIP * min(extent[face_p, 1], extent[face_q, 1])
    half, count = clip(incident, m, reference, n, ROUNDING * near / CLIP, polygon, name)
    area, _, _, _ = measure(polygon, half, count)
    least = LEAST_SHARE * min(extent[face_p, 0], extent[face_q, 0])
    if -cosine * area > least:  # faces that lie on each other before those that only are seen to
        return -cosine * area
    if area == 0.0:
        _, count = clip(incident, m, reference, n, near, polygon, name)
    return -least if count > 0 else -np.inf


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def untied(
    first, ring, corner, vertex, normal, plane, extent, turn, body, p, q, face, apart, tie, slack,
    kept, t1, t2, reference, incident, polygon, name,
):  # fmt: skip
    """The reference face of part p among those that separate it from part q as well as ``face``.

    That one does so by ``apart`` [m], the most; those that do by no less than ``tie`` [m] of it
    are as good.  ``kept`` and ``slack`` [m] are for the incident faces.  Returned is by how much
    the face separates them as well.
    """
    alone = True
    for f in range(first[p, 1], first[p + 1, 1]):
        by = separation(first, ring, corner, vertex, normal, f, q)
        alone = alone and (f == face or by < apart - tie)
    if alone:
        return face, apart
    found, best, apart_found = -1, -np.inf, apart
    for f in range(first[p, 1], first[p + 1, 1]):
        by = separation(first, ring, corner, vertex, normal, f, q)
        if by < apart - tie:
            continue
        face_q, cosine = incident_face(first, ring, corner, vertex, normal, f, q, kept, by + slack)
        worth = _worth(
            ring, corner, vertex, normal, plane, extent, turn, body, f, face_q, cosine, t1, t2,
            reference, incident, polygon, name,
        )  # fmt: skip
        if found < 0 or worth - best > HELD * abs(worth):
            found, best, apart_found = f, worth, by
    return found, apart_found


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def lies_on(
    first, ring, corner, vertex, normal, plane, extent, turn, body, face, q, kept, deepest, t1, t2,
    reference, incident, polygon, name,
):  # fmt: skip
    """Whether part q lies on a face by more than an edge or a point."""
    face_q, cosine = incident_face(first, ring, corner, vertex, normal, face, q, kept, deepest)
    worth = _worth(
        ring, corner, vertex, normal, plane, extent, turn, body, face, face_q, cosine, t1, t2,
        reference, incident, polygon, name,
    )  # fmt: skip
    return worth > 0.0
