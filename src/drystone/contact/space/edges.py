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
from drystone.contact.space.separation import best_edges, distance, nearest_edges, toward


@njit(cache=True)
def _flat_face(edge, normal, edge_p, edge_q, work):
    """The face of one part on which the edge of the other lies nearly flat at their crossing.

    ``work`` is that of `best_edges`, from p to q.  Returns whether the face is one of p; the face,
    or -1 if the edges cross at a larger angle; and the face of the other part, beside its edge,
    that is more opposed to the first.
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
    """Component c of a direction from which a tangent may be made: an edge, the tangent of a face,
    or its normal."""
    if trial == 0:
        return local[a1, c] - local[a0, c]
    return plane[face, 3 + c] if trial == 1 else plane[face, c]


@njit(cache=True)
def _write_point(scene, pair, edges, face, k, axis, shares, value):
    """Write place, normal and tangent of a contact point of two edges into slot k.

    ``shares`` (2,) are the places along both edges, ``axis`` (3,) is the normal from a to b.
    """
    local, edge, plane, rotation = scene.local, scene.edge, scene.plane, scene.rotation
    a0, a1, b0, b1 = edge[edges[0], 0], edge[edges[0], 1], edge[edges[1], 0], edge[edges[1], 1]
    a = scene.of_part[pair[0]]
    for c in range(3):
        value[k, PLACE_3 + c] = local[a0, c] + shares[0] * (local[a1, c] - local[a0, c])
        value[k, POINT_3 + c] = local[b0, c] + shares[1] * (local[b1, c] - local[b0, c])
        back = axis[c]
        for i in range(3):
            back += rotation[a, i, c] * axis[i]
        value[k, PLANE_NORMAL_3 + c] = back
    # The tangent is made from the edge of a or the first tangent of its face, whichever is farther
    # off the normal.  If corners meet, both may lie along the normal; the face's normal does not.
    best, chosen, aside, square = -1.0, 0, 0.0, 1.0
    for trial in range(3):
        along, size = 0.0, 0.0
        for c in range(3):
            t = _candidate(local, plane, a0, a1, face, trial, c)
            along += t * value[k, PLANE_NORMAL_3 + c]
            size += t * t
        off = 1.0 - along * along / size
        if off > best and (trial < 2 or best < 0.25):
            best, chosen, aside, square = off, trial, along, size * off
    for c in range(3):
        t = _candidate(local, plane, a0, a1, face, chosen, c)
        t -= aside * value[k, PLANE_NORMAL_3 + c]
        value[k, PLANE_TANGENT_3 + c] = t / np.sqrt(square)


@njit(cache=True)
def _ends(scene, edge_a, edge_b, first, second):
    """The ends of the line along which two nearly parallel edges (EDGE_FLAT) face each other.

    The shares of both edges at its ends go to ``first`` and ``second`` (2,).  Returns the length of
    the line [m], zero if there is none.
    """
    vertex, edge = scene.vertex, scene.edge
    a0, a1, b0, b1 = edge[edge_a, 0], edge[edge_a, 1], edge[edge_b, 0], edge[edge_b, 1]
    uu, uv, vv, to_b0, from_b0 = 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(3):
        u, v = vertex[a1, c] - vertex[a0, c], vertex[b1, c] - vertex[b0, c]
        w = vertex[b0, c] - vertex[a0, c]
        uu, uv, vv = uu + u * u, uv + u * v, vv + v * v
        to_b0, from_b0 = to_b0 + u * w, from_b0 - v * w
    if uv * uv < (1.0 - EDGE_FLAT * EDGE_FLAT) * uu * vv:
        return 0.0
    sense, at_b0, at_b1 = uv > 0.0, to_b0 / uu, (to_b0 + uv) / uu  # ends of b along a
    low, high = min(at_b0, at_b1), max(at_b0, at_b1)
    first[0], second[0] = max(low, 0.0), min(high, 1.0)
    first[1], second[1] = 0.0 if sense else 1.0, 1.0 if sense else 0.0
    if low <= 0.0:
        first[1] = min(max(from_b0 / vv, 0.0), 1.0)
    if high >= 1.0:
        second[1] = min(max((from_b0 + uv) / vv, 0.0), 1.0)
    return max(second[0] - first[0], 0.0) * np.sqrt(uu)


@njit(cache=True)
def _line(scene, work, pair, across):
    """Edges of a and b that meet along a line; -1 for both if there is no line.

    The nearest edges are ``across`` [m] apart; near a corner there are several such edges.  A line
    must have an end that is equally near, but for KEPT_FACE.  The longest line is taken.  Its ends
    go to the third and fourth row of ``work``, see `_ends`.
    """
    (p, q, _, _), vertex, edge, first = pair, scene.vertex, scene.edge, scene.first
    slack, longest, edge_a, edge_b = KEPT_FACE * min(scene.size[p], scene.size[q]), 0.0, -1, -1
    if scene.radius[p] + scene.radius[q] == 0.0 or across <= slack:
        return edge_a, edge_b
    for i in range(first[p, 2], first[p + 1, 2]):
        for j in range(first[q, 2], first[q + 1, 2]):
            length = _ends(scene, i, j, work[2], work[3])
            if length <= longest:
                continue
            a0, a1, b0, b1 = edge[i, 0], edge[i, 1], edge[j, 0], edge[j, 1]
            at_first = distance(vertex, a0, a1, b0, b1, work[2])
            at_second = distance(vertex, a0, a1, b0, b1, work[3])
            if min(at_first, at_second) <= across + slack:
                longest, edge_a, edge_b = length, i, j
    if edge_a >= 0:
        _ends(scene, edge_a, edge_b, work[2], work[3])
    return edge_a, edge_b


@njit(cache=True)
def _name_end(edge, edge_a, edge_b, shares, which, k):
    """If an edge ends at ``shares`` (2,), make its end vertex the feature of slot k."""
    if shares[0] == 0.0 or shares[0] == 1.0:
        which[k, FEATURE_A] = edge[edge_a, 1 if shares[0] == 1.0 else 0]
    elif shares[1] == 0.0 or shares[1] == 1.0:
        which[k, FEATURE_B] = edge[edge_b, 1 if shares[1] == 1.0 else 0]


@njit(cache=True)
def edge_on_edge(scene, work, pair, edges, faces, across, which, value):
    """Write the points where edges of a and b meet into the first slots of their pair, and evaluate
    them.

    ``work`` is that of `best_edges`.  The edges are ``across`` [m] apart.  Returns the slot behind
    the points.
    """
    edge, extent, n_vertices = scene.edge, scene.extent, scene.local.shape[0]
    (edge_a, edge_b), (face_a, face_b), (p, q, begin, _), n = edges, faces, pair, 1
    a, b, radii = scene.of_part[p], scene.of_part[q], scene.radius[p] + scene.radius[q]
    along_a, along_b = _line(scene, work, pair, across)
    if along_a >= 0:
        edge_a, edge_b, n = along_a, along_b, 2
    a0, a1, b0, b1 = edge[edge_a, 0], edge[edge_a, 1], edge[edge_b, 0], edge[edge_b, 1]
    for k in range(begin, begin + n):
        shares = work[1]
        which[k, KIND], which[k, EDGE_A], which[k, EDGE_B] = VERTEX_B, face_a, face_b
        which[k, FEATURE_A], which[k, FEATURE_B] = n_vertices + edge_a, n_vertices + edge_b
        if n == 2:
            shares = work[2 + k - begin]
            toward(scene.vertex, a0, a1, b0, b1, shares, work[0])
            _name_end(edge, edge_a, edge_b, shares, which, k)
        value[k, SIZE] = LEAST_FACE * min(extent[face_a, 0], extent[face_b, 0]) / n
        value[k, BALL_3] = scene.radius[q]
        _write_point(scene, pair, (edge_a, edge_b), face_a, k, work[0], shares, value)
        evaluate(scene.centroid, radii, scene.rotation, scene.pose, which, value, k, a, b)
    return begin + n


@njit(cache=True)
def edges_that_meet(scene, work, p, q, best, least, near, limit):
    """Edges of p and q that touch instead of their faces.

    The faces separate the parts by ``best`` [m].  Their points have the smallest gap ``least`` [m];
    ``near`` says whether this gap is as small as the separation.  Edges must separate the parts
    more than the faces, and by no more than ``limit`` [m].

    Returns whether there are such edges; their separation [m]; the two edges; and the result of
    `_flat_face` if one of them lies nearly flat on a face, else -1 for the face.
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
