"""Which faces of two convex parts meet: the reference face and the incident face.

The reference face is the face that separates the parts most.  The incident face is the face of the
other part that is most opposed to the reference face.

Solids may meet along an edge or in a point only.  Then faces of several directions separate them
equally well, but for rounding.  An example is a block whose edge touches the edge of another block
below and beside it: a bed face and a head face separate the two.  The choice among such faces must
not depend on rounding, nor on the axes of the model.  Of faces that separate equally well (TIED),
the reference face is

1. the one whose overlap with its incident face is largest, seen along its normal;
2. if all overlaps are a line or a point, the one whose interface is the smallest;
3. the first one of the part as designed.

The reason for the second rule: solids that only touch have no joint to press on.  They are given
LEAST_AREA, so that they do not pass through each other.  This area stiffens a structure falsely,
and the smaller it is, the less.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import CLIP, EDGED, KEPT_FACE, LEAST_FACE, SUMS, TIED
from drystone.contact.space.overlap import clip, measure
from drystone.contact.space.separation import most_opposed, most_opposed_near, separation


@njit(cache=True)
def _incident_face(first, ring, corner, vertex, normal, face, q, kept, deepest):
    """Face of part q that meets a reference ``face``, and the cosine between their normals; see
    `most_opposed`.

    ``deepest`` [m] is the height above the reference face up to which part q counts as touching.
    """
    found, cosine = most_opposed(first, normal, face, q, kept, KEPT_FACE)
    if cosine > -1.0 + KEPT_FACE:  # q touches by a vertex or an edge; take a face that has it
        trial, better = most_opposed_near(first, ring, corner, vertex, normal, face, q, deepest)
        if better > cosine + 2.0 * KEPT_FACE:
            return trial, better
    return found, cosine


@njit(cache=True)
def _project(ring, corner, vertex, face, origin, work, backwards, out):
    """Fill ``out`` with the corners of a face in the coordinates of a plane, (m, 2) [m]; returns m.

    The plane has its origin at the vertex ``origin`` and the axes ``work[:2]``.
    """
    begin, m = ring[face], ring[face + 1] - ring[face]
    for j in range(m):
        v = corner[begin + (m - 1 - j if backwards else j), 0]
        x, y = 0.0, 0.0
        for i in range(3):
            d = vertex[v, i] - vertex[origin, i]
            x += work[0, i] * d
            y += work[1, i] * d
        out[j, 0], out[j, 1] = x, y
    return m


@njit(cache=True)
def project_both(
    ring, corner, vertex, normal, plane, rotation, body, face_p, face_q, work, reference, incident
):
    """Project both faces on the plane of face p; returns their numbers of corners.

    The corners go to ``reference`` and ``incident``, the tangents of the plane to the first two
    rows of ``work``.  ``body`` is the body of face p.
    """
    for i in range(3):
        work[0, i] = plane[face_p, 3 + i]
        for k in range(3):
            work[0, i] += rotation[body, i, k] * plane[face_p, 3 + k]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        work[1, i] = normal[face_p, j] * work[0, k] - normal[face_p, k] * work[0, j]
    origin = corner[ring[face_p], 0]
    n = _project(ring, corner, vertex, face_p, origin, work, False, reference)
    m = _project(ring, corner, vertex, face_q, origin, work, True, incident)
    return n, m


@njit(cache=True)
def _worth(scene, scratch, body, face_p, face_q, cosine):
    """Overlap of two faces [m2], for comparison: negative if it is a line or a point, minus
    infinity if there is none."""
    reference, incident = scratch.reference, scratch.incident
    polygon, name, extent = scratch.polygon, scratch.name, scene.extent
    n, m = project_both(
        scene.ring, scene.corner, scene.vertex, scene.normal, scene.plane, scene.rotation, body,
        face_p, face_q, scratch.work, reference, incident,
    )  # fmt: skip
    near = CLIP * min(extent[face_p, 1], extent[face_q, 1])
    half, count = clip(incident, m, reference, n, SUMS * near / CLIP, polygon, name)
    area, _, _, _ = measure(polygon, half, count)
    least = LEAST_FACE * min(extent[face_p, 0], extent[face_q, 0])
    if -cosine * area > least:  # the cosine prefers faces that lie on each other
        return -cosine * area
    if area == 0.0:
        _, count = clip(incident, m, reference, n, near, polygon, name)
    return -least if count > 0 else -np.inf


@njit(cache=True)
def _untied(scene, scratch, p, q, face, apart, kept):
    """The reference face of part p among those that separate it from part q as well as ``face``,
    and its separation [m].

    ``face`` separates the parts most, by ``apart`` [m].  Faces whose separation is less by no more
    than TIED of the smaller part's size are equally good.  ``kept`` is the incident face to keep.
    """
    first, ring, corner = scene.first, scene.ring, scene.corner
    vertex, normal, body = scene.vertex, scene.normal, scene.of_part[p]
    smaller = min(scene.size[p], scene.size[q])
    slack, tie = KEPT_FACE * smaller, TIED * smaller
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
        face_q, cosine = _incident_face(first, ring, corner, vertex, normal, f, q, kept, by + slack)
        worth = _worth(scene, scratch, body, f, face_q, cosine)
        if found < 0 or worth - best > KEPT_FACE * abs(worth):
            found, best, apart_found = f, worth, by
    return found, apart_found


@njit(cache=True)
def _lies_on(scene, scratch, p, face, q, kept, deepest):
    """Whether part q touches a face of part p with more than an edge or a point."""
    face_q, cosine = _incident_face(
        scene.first, scene.ring, scene.corner, scene.vertex, scene.normal, face, q, kept, deepest
    )
    return _worth(scene, scratch, scene.of_part[p], face, face_q, cosine) > 0.0


@njit(cache=True)
def faces_that_meet(scene, scratch, p, q, on_a, on_b, anew):
    """Choose the faces of parts p and q that meet.

    ``on_a`` and ``on_b`` hold, for p and for q: the face that separates most; its separation [m];
    the separation of the face to be kept [m]; and this face.  With ``anew``, no face is kept.

    Returns whether the reference face is one of part p; the reference face; the incident face; and
    the cosine between their normals.
    """
    face_a, apart_a, former_a, kept_a = on_a
    face_b, apart_b, former_b, kept_b = on_b
    smaller, best = min(scene.size[p], scene.size[q]), max(apart_a, apart_b)
    slack, good = KEPT_FACE * smaller, False
    p_is_a, face, apart, to = True, face_a, apart_a, apart_b
    for trial in range(2 if anew else 0, 3):  # the kept face of a; that of b; the best, a first
        if trial == 0:
            p_is_a, face, apart, to = True, kept_a, former_a, best
        elif trial == 1:
            p_is_a, face, apart, to = False, kept_b, former_b, best
        else:
            p_is_a, face, apart, to = True, face_a, apart_a, apart_b
        good = apart >= to - EDGED * smaller
        if not good and apart >= to - slack:
            part, other, kept = (p, q, kept_b) if p_is_a else (q, p, kept_a)
            good = _lies_on(scene, scratch, part, face, other, kept, apart + slack)
        if good and trial < 2:
            break
    else:
        if not good:
            p_is_a, face, apart = False, face_b, apart_b
        part, other, kept = (p, q, kept_b) if p_is_a else (q, p, kept_a)
        face, apart = _untied(scene, scratch, part, other, face, apart, kept)
    other, kept = (q, kept_b) if p_is_a else (p, kept_a)
    found, cosine = _incident_face(
        scene.first, scene.ring, scene.corner, scene.vertex, scene.normal, face, other, kept,
        apart + slack,
    )  # fmt: skip
    return p_is_a, face, found, cosine
