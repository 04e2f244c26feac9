"""Rounded edges that face each other, past the ends of both faces.

Where two blocks end alike, as at the face of a wall, and tilt against each other, the rim of either
core may lie past the end of the other one's face: then neither vertex is above the other's face,
and what touches are the rounded edges themselves.  `overlap` takes corners that all but coincide
for one, as a vertex of the incident face or of the reference face.  Of rounded parts the normal
there is

1. that of the face which the vertex of the other part lies above;
2. else that of the other face, if the nearest point of the rim lies above it;
3. else the direction from one rim to the other.

So it turns steadily from that of the one face to that of the other.  In the third case bodies touch
midway between both surfaces, in the others at the one that has the vertex, as in the plane.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import DEEP, ROUNDING
from drystone.contact.contacts import (
    BALL_3,
    EDGE_A,
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
    """Where the outline of a face is nearest to a point past its end, seen along its normal.

    Returned are two vertices and the share of the way from the first to the second, or -1 where the
    point is past no side by more than ``past`` [m].
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
def meet_rims(scene, work, p, q, begin, stop, which, value):
    """Give slots from ``begin`` to ``stop``, of parts p and q, their balls, and at a rim the normal
    that rounded edges have there.

    ``work`` (5, 3) is scratch.
    """
    radius_a, radius_b = scene.radius[p], scene.radius[q]
    for k in range(begin, stop):
        value[k, BALL_3] = radius_b if which[k, KIND] == VERTEX_B else radius_a
    if radius_a + radius_b == 0.0:
        return
    ring, corner, local, plane = scene.ring, scene.corner, scene.local, scene.plane
    rotation, vertex, normal = scene.rotation, scene.vertex, scene.normal
    n_vertices, n_faces = local.shape[0], local.shape[0] + scene.edge.shape[0]
    past, rim, apart = ROUNDING * (radius_a + radius_b), work[0], work[1]
    for k in range(begin, stop):
        on_b = which[k, KIND] == VERTEX_B
        of_v, of_f = (FEATURE_B, FEATURE_A) if on_b else (FEATURE_A, FEATURE_B)
        point, face = which[k, of_v], which[k, of_f] - n_faces
        if point >= n_vertices or face != which[k, of_f - FEATURE_A + EDGE_A]:
            continue
        beyond = which[k, of_v - FEATURE_A + EDGE_A]
        i, j, share = _rim(ring, corner, vertex, normal, face, vertex[point], past)
        if i < 0:
            continue
        size = 0.0
        for c in range(3):
            rim[c] = vertex[i, c] + share * (vertex[j, c] - vertex[i, c])
            apart[c] = vertex[point, c] - rim[c]
            size += apart[c] * apart[c]
        size = np.sqrt(size)
        above, _, _ = _rim(ring, corner, vertex, normal, beyond, rim, past)
        if above < 0:
            which[k, KIND] = VERTEX_A if on_b else VERTEX_B
            value[k, BALL_3] = radius_a if on_b else radius_b
            origin = corner[ring[beyond], 0]
            for c in range(3):
                value[k, POINT_3 + c] = local[i, c] + share * (local[j, c] - local[i, c])
                value[k, PLACE_3 + c] = local[origin, c]
                value[k, PLANE_NORMAL_3 + c] = plane[beyond, c]
                value[k, PLANE_TANGENT_3 + c] = plane[beyond, 3 + c]
        elif size > DEEP * (radius_a + radius_b):
            value[k, BALL_3] *= size / (radius_a + radius_b)
            carrier, along, length = scene.of_part[p if on_b else q], 0.0, 0.0
            for c in range(3):
                value[k, PLACE_3 + c] = local[i, c] + share * (local[j, c] - local[i, c])
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
