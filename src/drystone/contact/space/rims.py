"""Rounded edges that face each other, past the ends of both faces.

Two blocks may end in the same plane, as at the face of a wall, and tilt against each other.  Then
the rim of each core may lie past the end of the other's face: neither vertex is above the other
face, and the rounded edges themselves touch.  `overlap` merges corners that nearly coincide into
one vertex, of the incident face or of the reference face.  Of rounded parts, the normal at this
vertex is

1. the normal of the other part's face, if the vertex lies above it;
2. otherwise the normal of the vertex's own face, if the nearest point of the other rim lies above
   it;
3. otherwise the direction from this nearest point to the nearest point of the own rim.

So the normal turns continuously from that of one face to that of the other.  In the third case the
bodies touch midway between both surfaces, otherwise at the surface that has the vertex, as in the
plane.  The nearest point of the own rim need not be the vertex: beside a corner it lies on the next
side.

If the incident face goes down beyond a side of the reference face, it tilts about this side.  Its
points there (crossings and points in between) become points of the side on the incident face.
Otherwise they would be open by the sum of the radii times half the square of the tilt, while a
vertex at an end of the same side is in contact.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import DEEP, ROUNDING
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
    VERTEX_A,
    VERTEX_B,
)


@njit(cache=True)
def _rim(ring, corner, vertex, normal, face, at, past):
    """The point of the outline of a face that is nearest to a point ``at`` (3,) [m] past its end,
    seen along its normal.

    Returns two vertices and the share of the way from the first to the second.  The vertices are -1
    if the point is not past any side by more than ``past`` [m].
    """
    begin, end = ring[face], ring[face + 1]
    n0, n1, n2 = normal[face, 0], normal[face, 1], normal[face, 2]
    first, second, share, nearest, outside = -1, -1, 0.0, np.inf, False
    for j in range(begin, end):
        a, b = corner[j, 0], corner[j + 1 if j + 1 < end else begin, 0]
        d0, d1, d2 = (
            vertex[b, 0] - vertex[a, 0],
            vertex[b, 1] - vertex[a, 1],
            vertex[b, 2] - vertex[a, 2],
        )
        x, y, z = at[0] - vertex[a, 0], at[1] - vertex[a, 1], at[2] - vertex[a, 2]
        length = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        out = x * (d1 * n2 - d2 * n1) + y * (d2 * n0 - d0 * n2) + z * (d0 * n1 - d1 * n0)
        if out <= past * length:
            continue
        outside = True
        t = min(max((x * d0 + y * d1 + z * d2) / (length * length), 0.0), 1.0)
        x, y, z = x - t * d0, y - t * d1, z - t * d2
        above = x * n0 + y * n1 + z * n2
        off = x * x + y * y + z * z - above * above
        if off < nearest:
            nearest, first, second, share = off, a, b, t
    return (first, second, share) if outside else (-1, -1, 0.0)


@njit(cache=True)
def _between(points, first, second, share, c):
    """Coordinate c of the point at a ``share`` of the way between two of the ``points`` (k, 3)."""
    return points[first, c] + share * (points[second, c] - points[first, c])


@njit(cache=True)
def _tilts_about(scene, edge, face, beyond, at):
    """Whether an incident face ``beyond`` goes down past the side ``edge`` of a ``face``, and its
    point ``at`` (3,) [m] lies above this face."""
    normal, vertex = scene.normal, scene.vertex
    sense = 1.0 if scene.edge[edge, 2] == face else -1.0
    first, second = scene.edge[edge, 0], scene.edge[edge, 1]
    down, square, above = 0.0, 0.0, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        dj, dk = vertex[second, j] - vertex[first, j], vertex[second, k] - vertex[first, k]
        down -= sense * (dj * normal[face, k] - dk * normal[face, j]) * normal[beyond, i]
        square += dj * dj
        above += (at[i] - vertex[first, i]) * normal[face, i]
    return above > 0.0 and down > ROUNDING * np.sqrt(square)


@njit(cache=True)
def _place(scene, v, k, value, at):
    """Fill ``at`` (3,) [m] with the present place of the point of body v in slot k."""
    for c in range(3):
        at[c] = scene.centroid[v, c] + scene.pose[v, c] + value[k, POINT_3 + c]
        for i in range(3):
            at[c] += scene.rotation[v, c, i] * value[k, POINT_3 + i]


@njit(cache=True)
def _to_side(scene, edge, k, value, at):
    """Let slot k have the point of an ``edge`` that is nearest to ``at`` (3,) [m], and move ``at``
    to it."""
    local, vertex = scene.local, scene.vertex
    first, second = scene.edge[edge, 0], scene.edge[edge, 1]
    along, square = 0.0, 0.0
    for c in range(3):
        d = vertex[second, c] - vertex[first, c]
        along += (at[c] - vertex[first, c]) * d
        square += d * d
    share = min(max(along / square, 0.0), 1.0)
    for c in range(3):
        at[c] = _between(vertex, first, second, share, c)
        value[k, POINT_3 + c] = _between(local, first, second, share, c)


@njit(cache=True)
def _lie_on(scene, face, k, value):
    """Let slot k have the plane of a ``face``."""
    origin = scene.corner[scene.ring[face], 0]
    for c in range(3):
        value[k, PLACE_3 + c] = scene.local[origin, c]
        value[k, PLANE_NORMAL_3 + c] = scene.plane[face, c]
        value[k, PLANE_TANGENT_3 + c] = scene.plane[face, 3 + c]


@njit(cache=True)
def _point_past(scene, parts, k, which, value, at):
    """Whether the point of slot k, between two ``parts``, may lie past the end of its face.

    Fills ``at`` (3,) [m] with the place of the point.  Points of a side about which the other part
    tilts become points on the face of the other part.
    """
    n_vertices, n_edges = scene.local.shape[0], scene.edge.shape[0]
    on_b = which[k, KIND] == VERTEX_B
    of_v, of_f = (FEATURE_B, FEATURE_A) if on_b else (FEATURE_A, FEATURE_B)
    face_v, face_f = (EDGE_B, EDGE_A) if on_b else (EDGE_A, EDGE_B)
    point, side = which[k, of_v], which[k, of_f] - n_vertices
    face, beyond = which[k, face_f], which[k, face_v]
    if point < n_vertices and side == n_edges + face:
        for c in range(3):
            at[c] = scene.vertex[point, c]
        return True
    if not 0 <= side < n_edges:
        return False
    _place(scene, scene.of_part[parts[1] if on_b else parts[0]], k, value, at)
    if not _tilts_about(scene, side, face, beyond, at):
        return False
    _to_side(scene, side, k, value, at)
    _lie_on(scene, beyond, k, value)
    which[k, KIND] = VERTEX_A if on_b else VERTEX_B
    return True


@njit(cache=True)
def meet_rims(scene, work, p, q, begin, stop, which, value):
    """Fill the radii of the balls of slots from ``begin`` to before ``stop``, of parts p and q, and
    at a rim the normal of the rounded edges.

    ``work`` (5, 3) is scratch memory.
    """
    radius_a, radius_b = scene.radius[p], scene.radius[q]
    radii = radius_a + radius_b
    if radii == 0.0:
        for k in range(begin, stop):
            value[k, BALL_3] = 0.0
        return
    ring, corner, local, plane = scene.ring, scene.corner, scene.local, scene.plane
    rotation, vertex, normal = scene.rotation, scene.vertex, scene.normal
    past, rim, apart, at = ROUNDING * radii, work[0], work[1], work[2]
    for k in range(begin, stop):
        may_be_past = _point_past(scene, (p, q), k, which, value, at)
        on_b = which[k, KIND] == VERTEX_B
        value[k, BALL_3] = radius_b if on_b else radius_a
        if not may_be_past:
            continue
        face, beyond = which[k, EDGE_A if on_b else EDGE_B], which[k, EDGE_B if on_b else EDGE_A]
        i, j, share = _rim(ring, corner, vertex, normal, face, at, past)
        if i < 0:
            continue
        for c in range(3):
            rim[c] = _between(vertex, i, j, share, c)
        first, second, part = _rim(ring, corner, vertex, normal, beyond, rim, past)
        size = 0.0
        if first >= 0:
            for c in range(3):
                apart[c] = _between(vertex, first, second, part, c) - rim[c]
                size += apart[c] * apart[c]
        size = np.sqrt(size)
        if first < 0:
            which[k, KIND] = VERTEX_A if on_b else VERTEX_B
            value[k, BALL_3] = radius_a if on_b else radius_b
            for c in range(3):
                value[k, POINT_3 + c] = _between(local, i, j, share, c)
            _lie_on(scene, beyond, k, value)
        elif size > DEEP * radii:
            value[k, BALL_3] *= size / radii
            carrier, along, length = scene.of_part[p if on_b else q], 0.0, 0.0
            for c in range(3):
                value[k, POINT_3 + c] = _between(local, first, second, part, c)
                value[k, PLACE_3 + c] = _between(local, i, j, share, c)
                back = apart[c]
                for m in range(3):
                    back += rotation[carrier, m, c] * apart[m]
                value[k, PLANE_NORMAL_3 + c] = back / size
                along += back / size * plane[face, 3 + c]
            for c in range(3):
                value[k, PLANE_TANGENT_3 + c] = (
                    plane[face, 3 + c] - along * value[k, PLANE_NORMAL_3 + c]
                )
                length += value[k, PLANE_TANGENT_3 + c] ** 2
            for c in range(3):
                value[k, PLANE_TANGENT_3 + c] /= np.sqrt(length)
