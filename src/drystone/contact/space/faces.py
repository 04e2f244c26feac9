"""Where two parts meet face on face: the points of their overlap, see `contact.space.manifold`."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import CLIP, EDGE_FLAT, LEAST_AREA, MERGE, SUMS
from drystone.contact.contacts import (
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
    VERTEX_A,
    VERTEX_B,
)
from drystone.contact.space.facing import project_both
from drystone.contact.space.overlap import (
    CROSSING,
    INNER,
    KEPT,
    LEAVES,
    OF_P,
    OF_Q,
    ON_SIDE,
    TYPE,
    VERTEX_P,
    VERTEX_Q,
    clip,
    measure,
    merge_corners,
    n_spread,
    name_corners,
    scale,
    sort_corners,
    spread,
    widened,
    width_of,
)
from drystone.contact.space.points import evaluate_all
from drystone.contact.space.rims import meet_rims

#: Upper bound of the numbers of points between the ends of a side.
ON_SIDES = 64


@njit(cache=True)
def _side(ring, corner, face, j, backwards):
    """Edge that leaves corner j of a face, listed forwards or backwards."""
    begin, m = ring[face], ring[face + 1] - ring[face]
    return corner[begin + ((m - 2 - j) % m if backwards else j), 1]


@njit(cache=True)
def _vertex(ring, corner, face, j, backwards):
    """Vertex of corner j of a face, listed forwards or backwards."""
    begin, m = ring[face], ring[face + 1] - ring[face]
    return corner[begin + (m - 1 - j if backwards else j), 0]


@njit(cache=True)
def _mark_kept(scene, scratch, faces, p_is_a, corners, n, m):
    """Mark those corners that were contact points before.

    ``corners`` are the half of ``scratch.name`` with the corners and their number.
    """
    (half, count), (face_p, face_q) = corners, faces
    name, known = scratch.name[half], scratch.known
    n_vertices, n_edges = scene.local.shape[0], scene.edge.shape[0]
    for i in range(count):
        on_p, on_q = _features(
            scene.ring, scene.corner, face_p, face_q, name, i, m, n_vertices, n_edges
        )
        on_a, on_b = (on_p, on_q) if p_is_a else (on_q, on_p)
        name[i, KEPT], k = 0, 0
        while known[k, 0] >= 0 and name[i, KEPT] == 0:
            name[i, KEPT] = known[k, 0] == on_a and known[k, 1] == on_b
            k += 1


@njit(cache=True)
def _cut(scratch, m, n, near, slack):
    """Cut the faces, and name the corners of the overlap that are ``near`` [m] to a vertex.

    Points up to ``slack`` [m] outside count as inside, and corners as near to a vertex as that are
    the vertex; see `overlap.clip` and `overlap.name_corners`.

    Returns the corners (half of the arrays, number), and area, centroid and perimeter.
    """
    reference, incident, polygon = scratch.reference, scratch.incident, scratch.polygon
    half, count = clip(incident, m, reference, n, slack, polygon, scratch.name)
    measures = measure(polygon, half, count)
    name_corners(polygon, scratch.name, half, count, incident, m, reference, n, near, slack)
    return (half, count), measures


@njit(cache=True)
def _slope(normal, faces, work):
    """Slope (2,) of the incident face over the reference face, along the tangents in ``work``.

    It is zero for faces that tilt by more than EDGE_FLAT, because they meet by their edges.
    """
    x, y, cosine = 0.0, 0.0, 0.0
    for c in range(3):
        of_q = normal[faces[1], c]
        x += of_q * work[0, c]
        y += of_q * work[1, c]
        cosine -= of_q * normal[faces[0], c]
    flat = x * x + y * y <= EDGE_FLAT * EDGE_FLAT * cosine * cosine
    return (x / cosine, y / cosine) if flat else (0.0, 0.0)


@njit(cache=True)
def _overlap(scene, scratch, faces, p_is_a, m, n, near):
    """Named corners of the overlap: half of the arrays, number, area [m2] and centroid (x, y)
    [m]."""
    polygon, name, slack = scratch.polygon, scratch.name, SUMS * near / CLIP
    corners, measures = _cut(scratch, m, n, near, slack)
    if measures[0] == 0.0:  # a line or a point, which may lie beyond the rim
        corners, measures = _cut(scratch, m, n, near, near)
    (half, count), (area, cx, cy, perimeter) = corners, measures
    if count > 0:
        short = max(MERGE * width_of(area, perimeter), near)
        _mark_kept(scene, scratch, faces, p_is_a, corners, n, m)
        slope = _slope(scene.normal, faces, scratch.work)
        count = merge_corners(polygon, name, half, count, short, near, slope)
        half = sort_corners(polygon, name, half, count)
    return half, count, area, cx, cy


@njit(cache=True)
def _on_face(ring, corner, local, face, backwards, polygon, m, x, y, value, k):
    """Write the material point of a face that is projected to (x, y) into slot k.

    The face is projected to a polygon of m corners, listed forwards or ``backwards``.
    """
    i, j, far, widest = 1, 2, 0.0, 0.0  # corners i and j span the face best with corner 0
    for c in range(1, m):
        ux, uy = polygon[c, 0] - polygon[0, 0], polygon[c, 1] - polygon[0, 1]
        if ux * ux + uy * uy > far:
            i, far = c, ux * ux + uy * uy
    for c in range(1, m):
        ux, uy = polygon[i, 0] - polygon[0, 0], polygon[i, 1] - polygon[0, 1]
        vx, vy = polygon[c, 0] - polygon[0, 0], polygon[c, 1] - polygon[0, 1]
        if abs(ux * vy - uy * vx) > widest:
            j, widest = c, abs(ux * vy - uy * vx)
    ux, uy = polygon[i, 0] - polygon[0, 0], polygon[i, 1] - polygon[0, 1]
    vx, vy = polygon[j, 0] - polygon[0, 0], polygon[j, 1] - polygon[0, 1]
    dx, dy = x - polygon[0, 0], y - polygon[0, 1]
    det = ux * vy - uy * vx
    s, t = (dx * vy - dy * vx) / det, (ux * dy - uy * dx) / det
    v0 = _vertex(ring, corner, face, 0, backwards)
    v1 = _vertex(ring, corner, face, i, backwards)
    v2 = _vertex(ring, corner, face, j, backwards)
    for c in range(3):
        along = s * (local[v1, c] - local[v0, c]) + t * (local[v2, c] - local[v0, c])
        value[k, POINT_3 + c] = local[v0, c] + along


@njit(cache=True)
def _is_vertex(mark, point, i, reference, incident):
    """Whether point i is at the vertex whose name it has."""
    x, y, on_p, on_q = point[i, 0], point[i, 1], mark[i, OF_P], mark[i, OF_Q]
    if mark[i, TYPE] == VERTEX_P:
        return x == reference[on_p, 0] and y == reference[on_p, 1]
    return mark[i, TYPE] == VERTEX_Q and x == incident[on_q, 0] and y == incident[on_q, 1]


@njit(cache=True)
def _features(ring, corner, face_p, face_q, mark, i, m, n_vertices, n_edges):
    """Features of point i on the reference body and on the incident one; see the module."""
    faces = n_vertices + n_edges
    between = faces + ring.shape[0] - 1
    type_, of_p, of_q, number = mark[i, TYPE], mark[i, OF_P], mark[i, OF_Q], mark[i, LEAVES]
    if type_ == ON_SIDE:
        if of_p < m:
            edge = n_vertices + _side(ring, corner, face_q, of_p, True)
            return between + number, edge
        edge = n_vertices + _side(ring, corner, face_p, of_p - m, False)
        return edge, between + number
    plus = 0
    if type_ == INNER:
        if number == 0:
            return faces + face_p, faces + face_q
        type_, plus = (number - 1) % 3, (1 + (number - 1) // 3) * (between + ON_SIDES)
    if type_ == VERTEX_Q:
        return plus + faces + face_p, _vertex(ring, corner, face_q, of_q, True)
    if type_ == VERTEX_P:
        return plus + _vertex(ring, corner, face_p, of_p, False), faces + face_q
    edge_p = n_vertices + _side(ring, corner, face_p, of_p, False)
    return plus + edge_p, n_vertices + _side(ring, corner, face_q, of_q, True)


@njit(cache=True)
def _write_points(scene, scratch, face_p, face_q, p_is_a, n, m, n_points, first, end, which, value):
    """Write the points of an overlap into slots from ``first`` on, without the values that
    `points.evaluate` adds."""
    ring, corner, local, plane = scene.ring, scene.corner, scene.local, scene.plane
    reference, incident = scratch.reference, scratch.incident
    point, mark, weight = scratch.point, scratch.mark, scratch.weight
    n_vertices, n_edges = local.shape[0], scene.edge.shape[0]
    k = first
    for i in range(n_points):
        if k >= end:
            break
        if weight[i] == 0.0:  # no tributary area
            continue
        type_ = mark[i, TYPE]
        swapped = type_ == VERTEX_P
        carrier = face_q if swapped else face_p
        on_p, on_q = _features(ring, corner, face_p, face_q, mark, i, m, n_vertices, n_edges)
        which[k, KIND] = VERTEX_B if p_is_a != swapped else VERTEX_A
        which[k, FEATURE_A], which[k, FEATURE_B] = (on_p, on_q) if p_is_a else (on_q, on_p)
        which[k, EDGE_A], which[k, EDGE_B] = (face_p, face_q) if p_is_a else (face_q, face_p)
        value[k, SIZE] = weight[i]
        origin = corner[ring[carrier], 0]
        for c in range(3):
            value[k, PLACE_3 + c] = local[origin, c]
            value[k, PLANE_NORMAL_3 + c] = plane[carrier, c]
            value[k, PLANE_TANGENT_3 + c] = plane[carrier, 3 + c]
        x, y = point[i, 0], point[i, 1]
        if _is_vertex(mark, point, i, reference, incident):
            v = on_p if swapped else on_q
            for c in range(3):
                value[k, POINT_3 + c] = local[v, c]
        elif type_ == CROSSING:
            j = mark[i, OF_Q]
            after = j + 1 if j + 1 < m else 0
            ex, ey = incident[after, 0] - incident[j, 0], incident[after, 1] - incident[j, 1]
            share = (x - incident[j, 0]) * ex + (y - incident[j, 1]) * ey
            share = min(max(share / (ex * ex + ey * ey), 0.0), 1.0)
            v = _vertex(ring, corner, face_q, j, True)
            w = _vertex(ring, corner, face_q, after, True)
            for c in range(3):
                value[k, POINT_3 + c] = local[v, c] + share * (local[w, c] - local[v, c])
        elif swapped:
            _on_face(ring, corner, local, face_p, False, reference, n, x, y, value, k)
        else:
            _on_face(ring, corner, local, face_q, True, incident, m, x, y, value, k)
        k += 1
    return k


@njit(cache=True)
def face_points(scene, scratch, face_p, face_q, p_is_a, pair, n_most, which, value):
    """Write the points of the overlap of a reference face p and an incident face q into the slots
    of their pair.

    ``pair`` are parts a and b, their first slot and the slot behind the last.  ``p_is_a`` says
    whether the reference face is of part a.  Returns the slot behind the points and the smallest
    gap [m].
    """
    ring, extent, normal, of_part = scene.ring, scene.extent, scene.normal, scene.of_part
    reference, incident, polygon = scratch.reference, scratch.incident, scratch.polygon
    name, point, weight = scratch.name, scratch.point, scratch.weight
    part_a, part_b, begin, end = pair
    n, m = project_both(
        ring, scene.corner, scene.vertex, normal, scene.plane, scene.rotation,
        of_part[part_a if p_is_a else part_b], face_p, face_q, scratch.work, reference, incident,
    )  # fmt: skip
    near = CLIP * min(extent[face_p, 1], extent[face_q, 1])
    half, count, area, cx, cy = _overlap(scene, scratch, (face_p, face_q), p_is_a, m, n, near)
    if count == 0:
        return begin, np.inf
    if area > 0.0:
        for i in range(count):
            j = name[half, i, LEAVES]
            at = ring[face_q] + (m - 2 - j) % m if j < m else ring[face_p] + j - m
            weight[i] = scene.setback[at]
        area += widened(polygon, half, count, weight)
    n_points = n_spread(count, n_most if area > 0.0 else 4, end - begin)
    spread(polygon, name, half, count, cx, cy, n_points, point, scratch.mark, weight)
    least = LEAST_AREA * min(extent[face_p, 0], extent[face_q, 0])
    scale(point, n_points, cx, cy, max(area, least), weight)
    stop = _write_points(
        scene, scratch, face_p, face_q, p_is_a, n, m, n_points, begin, end, which, value
    )
    meet_rims(scene, scratch.work, part_a, part_b, begin, stop, which, value)
    return stop, evaluate_all(
        scene.centroid, scene.radius[part_a] + scene.radius[part_b], scene.rotation, scene.pose,
        which, value, begin, stop, of_part[part_a], of_part[part_b],
    )  # fmt: skip
