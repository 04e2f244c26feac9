"""Where two parts meet on their edges: edge on edge, or an edge nearly flat on a face; see
`contact.space.manifold`."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import EDGE_FLAT, EDGES_MARGIN, KEPT_FACE, LEAST_FACE
from drystone.contact.contacts import (
    BALL_3,
    EDGE_A,
    EDGE_B,
    FEATURE_A,
    FEATURE_B,
    KIND,
    PLACE_3,
    PLANE_NORMAL_3,
    PLANE_TANGENT_3,
    POINT_3,
    SIZE,
    VERTEX_B,
)
from drystone.contact.space.points import evaluate
from drystone.contact.space.separation import best_edges, nearest_edges


@njit(cache=True)
def _flat_face(edge, normal, edge_p, edge_q, work):
    """Whether an edge of p or q lies nearly flat on a face of the other at their crossing, and how.

    ``work`` is that of `best_edges`, from p to q.  Returned is whether the face is
    one of p, the face, or -1 where both edges cross in earnest, and the face of the other part
    behind that edge which is more opposed to it.
    """
    least, of_p, face = 1.0 - 0.5 * EDGE_FLAT * EDGE_FLAT, True, -1
    for side in range(2):
        chosen, sign = (edge_p, 1.0) if side == 0 else (edge_q, -1.0)
        for c in range(2, 4):
            f = edge[chosen, c]
            along = (
                work[0, 0] * normal[f, 0] + work[0, 1] * normal[f, 1] + work[0, 2] * normal[f, 2]
            )
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
def _candidate(local, plane, a0, a1, face, trial, c):
    """Component c of what a tangent may be made from: an edge, a face's tangent, or its normal."""
    if trial == 0:
        return local[a1, c] - local[a0, c]
    return plane[face, 3 + c] if trial == 1 else plane[face, c]


@njit(cache=True)
def edge_on_edge(scene, work, pair, edges, faces, which, value):
    """The point where edges of a and b cross, evaluated, into the first slot of their pair.

    ``work`` is that of `best_edges`.  Returned is the slot behind it.
    """
    local, edge, plane, extent = scene.local, scene.edge, scene.plane, scene.extent
    (edge_a, edge_b), (face_a, face_b), (p, q, k, _) = edges, faces, pair
    rotation, a, b, n_vertices = scene.rotation, scene.of_part[p], scene.of_part[q], local.shape[0]
    which[k, KIND] = VERTEX_B
    which[k, FEATURE_A], which[k, FEATURE_B] = n_vertices + edge_a, n_vertices + edge_b
    which[k, EDGE_A], which[k, EDGE_B] = face_a, face_b
    value[k, SIZE] = LEAST_FACE * min(extent[face_a, 0], extent[face_b, 0])
    a0, a1, b0, b1 = edge[edge_a, 0], edge[edge_a, 1], edge[edge_b, 0], edge[edge_b, 1]
    for c in range(3):
        value[k, PLACE_3 + c] = local[a0, c] + work[1, 0] * (local[a1, c] - local[a0, c])
        value[k, POINT_3 + c] = local[b0, c] + work[1, 1] * (local[b1, c] - local[b0, c])
        back = work[0, c]
        for i in range(3):
            back += rotation[a, i, c] * work[0, i]
        value[k, PLANE_NORMAL_3 + c] = back
    # A tangent: of the edge of a and the first tangent of its face, what is farther off the normal.
    # Where corners meet, both may lie along it: then the face's normal does not.
    best, chosen, aside, square = -1.0, 0, 0.0, 1.0
    for trial in range(3):
        along, size = 0.0, 0.0
        for c in range(3):
            t = _candidate(local, plane, a0, a1, face_a, trial, c)
            along += t * value[k, PLANE_NORMAL_3 + c]
            size += t * t
        off = 1.0 - along * along / size
        if off > best and (trial < 2 or best < 0.25):
            best, chosen, aside, square = off, trial, along, size * off
    for c in range(3):
        t = _candidate(local, plane, a0, a1, face_a, chosen, c)
        t -= aside * value[k, PLANE_NORMAL_3 + c]
        value[k, PLANE_TANGENT_3 + c] = t / np.sqrt(square)
    value[k, BALL_3], radii = scene.radius[q], scene.radius[p] + scene.radius[q]
    evaluate(scene.centroid, radii, rotation, scene.pose, which, value, k, a, b)
    return k + 1


@njit(cache=True)
def edges_that_meet(scene, work, p, q, best, least, near, limit):
    """Edges of p and q that separate them more than faces do, by the ``best`` [m], and touch.

    Faces have made points with the ``least`` gap [m], which is as ``near`` as the separation says
    or not.  Edges that are apart by more than ``limit`` [m] are too far.  Returned are whether
    there are such edges, by how much they separate, the edges, and, where one lies nearly flat on a
    face, what `_flat_face` says; else that face is -1.
    """
    first, edge, vertex, normal = scene.first, scene.edge, scene.vertex, scene.normal
    radii, smaller = scene.radius[p] + scene.radius[q], min(scene.size[p], scene.size[q])
    margin, slack = EDGES_MARGIN * smaller, KEPT_FACE * smaller
    edge_a, edge_b, across = best_edges(first, edge, vertex, normal, p, q, work)
    found = across > best + margin or (not near and least + radii > across + margin)
    found = found and edge_a >= 0 and -np.inf < across <= limit
    p_is_a, face_p, face_q = True, -1, -1
    if found:
        p_is_a, face_p, face_q = _flat_face(edge, normal, edge_a, edge_b, work)
    elif radii > 0.0:
        edge_a, edge_b, across = nearest_edges(first, edge, vertex, p, q, work)
        found = slack < across <= limit and across - radii < least - slack
    return found, across, (edge_a, edge_b), p_is_a, face_p, face_q
