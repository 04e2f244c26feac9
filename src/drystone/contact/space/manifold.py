"""Narrow phase in space: the contact points of every pair of nearby convex parts.

What a contact point is, and how its gap follows from the poses: see `contact.space.points`.

Faces
-----
The *reference* face is the face of either part that separates the parts most.  The *incident* face
is the face of the other part that is most opposed to it.  Both are kept as long as they are nearly
as good as others (KEPT_FACE), so that a block at rest does not change them with every rounding
error.  `facing` chooses among faces that are equally good at first.

The overlap of the two faces, seen along the reference normal (see `overlap`), gives the points and
the area.  The area that treated edges take off the faces is added again.  The points are

    a vertex of the incident face              on the plane of the reference face
    a vertex of the reference face alone       on the plane of the incident face
    sides that cross, and points in between    of the incident face, on the reference plane

A face that tilts on an edge or on a vertex keeps its points, and points that open keep their area:
the area is that of the overlap, as in the plane.  An overlap that is nearly a line or a point has
LEAST_AREA of the smaller face.

Edges
-----
If no point of the overlap is as near as the separation, the parts do not touch by these faces.
Crossing edges make one point if they separate the parts more by EDGES_MARGIN, or if they touch
while the points of the faces are open by more.  Body a carries the normal of this point along.  Of
rounded parts, the nearest points of all edges are considered too.  The area of the point is
LEAST_FACE of the smaller of the two faces.

Rounded edges that are nearly parallel (EDGE_FLAT) meet along a line instead.  They make a point at
each end of it, with half of this area and a normal of its own.  The nearest point alone would lie
at one end.  A block would turn to it, and touch at the other end in the next step.

If parts overlap by more than EDGES_MARGIN, a near point of the faces is no proof that they touch by
these faces.  For example, an edge on the rim of a face overlaps it by little, but by much if seen
along the face beside.  So edges are considered there too, if they separate the parts more by
EDGES_MARGIN.

If two edges cross and one lies nearly flat (EDGE_FLAT) on a face beside the other, they touch along
a line, not in a point.  With one point, a block on the rim of a long support, turned a little,
would rock from one end of the line to the other.  So this face is then the reference face, and the
face behind the flat edge is the incident one.  The condition is that their deepest point is as deep
as the edges, within EDGES_MARGIN, because the faces may also overlap elsewhere.

Persistence
-----------
A point has the name of a vertex up to CLIP widths from it, and a short side keeps both ends (see
`overlap`).  Otherwise a point whose force opens it would exist in every second step.

Features are numbers: vertices of all parts, then edges, then faces, then points in between.
"""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import IntArray
from drystone.common.compiled import njit
from drystone.common.tolerances import EDGES_MARGIN, KEPT_FACE
from drystone.contact.contacts import (
    EDGE_A,
    EDGE_B,
    FEATURE_A,
    FEATURE_B,
    FIRST,
    GAP,
    KIND,
    NONE,
    PART_A,
    PART_B,
)
from drystone.contact.space.edges import edge_on_edge, edges_that_meet
from drystone.contact.space.faces import face_points
from drystone.contact.space.facing import faces_that_meet
from drystone.contact.space.points import empty
from drystone.contact.space.separation import best_face
from drystone.contact.space.shapes import Shapes, place, scene_of, scratch_for


def slots_of(shapes: Shapes, points: int, part_a: IntArray, part_b: IntArray) -> IntArray:
    """Largest number of contact points of each pair of parts, (n_pairs,).

    An overlap has at most as many corners as both faces together.  With 9 ``points`` per
    quadrilateral, there are slots enough for any overlap.  With more than 9, the number of slots is
    the same or ``points``, so that an overlap with many corners gets fewer points.
    """
    corners = np.maximum.reduceat(np.diff(shapes.ring), shapes.first[:-1, 1])
    most = corners[part_a] + corners[part_b]
    if points == 4:
        return np.asarray(most, np.int64)
    return np.asarray(np.maximum(2 * most + 1, points), np.int64)


@njit(cache=True)
def _remember(which, begin, end, known):
    """Copy the features of the points of a pair into ``known``."""
    n = 0
    for k in range(begin, end):
        if which[k, KIND] != NONE:
            known[n, 0], known[n, 1] = which[k, FEATURE_A], which[k, FEATURE_B]
            n += 1
    known[n, 0] = -1


@njit(cache=True)
def find(shapes, pose, world, pairs, reach, n_most, slots):
    """Fill the slots of all pairs in poses (n, 7); ``reach`` [m] is the largest gap listed.

    ``n_most`` points are made of a quadrilateral overlap: 4, 16 or the square of an odd number.
    The former contents of the slots only say which faces and corners were used last.
    """
    place(shapes, pose, world)
    # Fields are read before the loop: within it, each reading would count references.
    (which, value), of_pair, radius, first = slots, pairs.which, shapes.radius, shapes.first
    ring, corner, size = shapes.ring, shapes.corner, shapes.size
    vertex, normal, middle = world.vertex, world.normal, world.middle
    scene, scratch = scene_of(shapes, pose, world), scratch_for(ring, n_most)
    n_pairs = of_pair.shape[0]
    for i in range(n_pairs):
        begin = of_pair[i, FIRST]
        end = of_pair[i + 1, FIRST] if i + 1 < n_pairs else which.shape[0]
        if begin == end:
            continue
        p, q = of_pair[i, PART_A], of_pair[i, PART_B]
        kept_a, kept_b = which[begin, EDGE_A], which[begin, EDGE_B]
        _remember(which, begin, end, scratch.known)
        empty(which, value, begin, end)  # all slots of the pair; their values are of other poses
        limit = reach + (radius[p] + radius[q])
        face_a, apart_a, former_a = best_face(
            first, ring, corner, vertex, normal, middle, p, q, kept_a, limit
        )
        if apart_a > limit:
            continue
        face_b, apart_b, former_b = best_face(
            first, ring, corner, vertex, normal, middle, q, p, kept_b, limit
        )
        if apart_b > limit:
            continue
        pair, best = (p, q, begin, end), max(apart_a, apart_b)
        on_a, on_b = (face_a, apart_a, former_a, kept_a), (face_b, apart_b, former_b, kept_b)
        stop, least, tried = begin, np.inf, -1
        p_is_a, face_p, face_q, cosine = True, face_a, face_b, 0.0
        for attempt in range(2):
            p_is_a, face_p, face_q, cosine = faces_that_meet(
                scene, scratch, p, q, on_a, on_b, attempt > 0
            )
            if face_p == tried:
                break
            tried = face_p
            stop, least = face_points(
                scene, scratch, face_p, face_q, p_is_a, pair, n_most, which, value
            )
            if stop > begin:
                break
        smaller, radii = min(size[p], size[q]), radius[p] + radius[q]
        margin, near = EDGES_MARGIN * smaller, least <= best - radii + KEPT_FACE * smaller
        flush = radii == 0.0 and cosine <= -1.0 + KEPT_FACE * KEPT_FACE
        if not (flush or (near and best >= -margin)):
            faces = (face_p, face_q) if p_is_a else (face_q, face_p)
            found, across, edges, p_is_a, face_p, face_q = edges_that_meet(
                scene, scratch.crossing, p, q, best, least, near, limit
            )
            if found:
                empty(which, value, begin, stop)
                stop = begin
                if face_p >= 0:
                    stop, least = face_points(
                        scene, scratch, face_p, face_q, p_is_a, pair, n_most, which, value
                    )
                    if abs(least + radii - across) > margin:  # the faces overlap elsewhere
                        empty(which, value, begin, stop)
                        stop = begin
                if stop == begin:
                    stop = edge_on_edge(
                        scene, scratch.crossing, pair, edges, faces, across, which, value
                    )
        for k in range(begin, stop):
            if value[k, GAP] > reach:
                which[k, KIND], value[k, GAP] = NONE, np.inf
