"""Narrow phase in space: the contact points of every pair of nearby convex parts.

Every contact point is a material point of one body, v, on a plane that another body, f, carries
along (`contacts.VERTEX_B`: v is b and f is a; `VERTEX_A`: the reverse):

    p      the point, relative to v's centroid        POINT_3
    o, n   a place on the plane and its normal,       PLACE_3, PLANE_NORMAL_3
           from f to v
    t      unit vector in the plane                   PLANE_TANGENT_3

each in the axes of the design.  With R the rotation and u the displacement of a body,

    d_0 = c_v - c_f + p - o,     D = u_v - u_f + (R_v - I) p - (R_f - I) o
    gap = n . d_0 + (R_f - I) n . d_0 + R_f n . D - radii

so that a gap is what it is as designed and the change since, each for itself, and as precise as the
displacements: a stiff joint closes by less than the rounding of its place.  Bodies touch at the
point, or where the ball around it (BALL_3, the radius of a rounded part) meets the plane: both arms
lead there, from the centroids.  With unit normal n, now from a to b, tangents t_1 = R_f t and
t_2 = n x t_1, and motions (u_a, w_a, u_b, w_b),

    d gap    = n . (du_b + dw_b x arm_b - du_a - dw_a x arm_a),      slips likewise with t_1, t_2

are exact, and reactions along them balance in force and in moment.

Which points there are
----------------------
The *reference* face is the one, of both parts, that separates them most; the face of the other part
that is most opposed to it is the *incident* one.  Both are kept as long as they are nearly as good
(HELD), so that a block that rests does not change them with every rounding error; of faces that are
as good at first, `facing` says which it is.  Their overlap, seen along the reference normal (see
`overlap`), gives the points, and its area, to which what treated edges take off the faces is added
again:

    a vertex of the incident face              on the plane of the reference face
    a vertex of the reference face alone       on the plane of the incident face
    sides that cross, and points in between    of the incident face, on the reference plane

A face that tilts on an edge or on a vertex keeps its points, and those that open their area: it is
that of the overlap, as in the plane.  An overlap that is only a line or a point, or next to it,
has LEAST_SHARE of the smaller face.

Where no point of the overlap is as near as the separation says, the faces are not what touches.
Then edges that cross and separate the parts more by MARGIN, or touch where those points are open
by as much, make one point, on a normal that a carries along; of rounded parts, likewise the nearest
points of all edges.  Its area is LEAST_SHARE of the smaller of the two faces.  Points that are as
near are no proof where parts overlap by more than MARGIN: an edge that lies on the rim of a face
overlaps it by little, and by much as seen along the face beside.  Edges that separate the parts
more by MARGIN touch there, too.

Edges that cross where one lies nearly flat (FLAT) on a face beside the other are no point but a
line: a block on the rim of a long support, and turned a little, would rock from one end of it to
the other.  So that face, be it cut by what is far off, is the reference face then, and the one
behind the edge the incident one, if their deepest point is as deep as the edges say, within MARGIN.

Features are numbers: vertices of all parts, then edges, then faces, then points between.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ARM_A_3,
    ARM_B_3,
    BALL_3,
    EDGE_A,
    EDGE_B,
    FEATURE_A,
    FEATURE_B,
    FIRST,
    GAP,
    KIND,
    NONE,
    NORMAL_3,
    PART_A,
    PART_B,
    PLACE_3,
    PLANE_NORMAL_3,
    PLANE_TANGENT_3,
    POINT_3,
    SIZE,
    TANGENT_3,
    VERTEX_A,
    VERTEX_B,
    A,
    B,
)
from drystone.contact.space.facing import (
    EDGED,
    HELD,
    LEAST_SHARE,
    TIED,
    edge_on_face,
    incident_face,
    lies_on,
    project_both,
    untied,
)
from drystone.contact.space.overlap import (
    CLIP,
    CROSSING,
    INNER,
    LEAVES,
    MERGE,
    OF_P,
    OF_Q,
    ON_SIDE,
    ROUNDING,
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
from drystone.contact.space.rims import meet_rims
from drystone.contact.space.separation import best_edges, best_face, nearest_edges
from drystone.geometry.rotation import place_axes

#: Edges count where they separate the parts by this share of their size more than faces do.
MARGIN = 1e-2

#: Numbers of points between the ends of a side are less.
ON_SIDES = 64

#: An incident face with a cosine below this to the reference face is seen edge on.
EDGE_ON = 0.05

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Shapes(NamedTuple):
    """Contact shapes of all convex parts; vertices, faces and edges of a part follow each other.

    Faces run counter-clockwise seen from outside.  An edge leads from its first vertex to its
    second one around its first face, and against the sense of its second face.
    """

    centroid: Array  # (n, 3) m, as designed
    axes: Array  # (n, 3, 3) columns are the bodies' principal axes as designed
    of_part: IntArray  # (n_parts,) body of each part
    radius: Array  # (n_parts,) m, by which the surface lies outside the faces
    size: Array  # (n_parts,) m, six times volume over surface: the edge of a cube
    first: IntArray  # (n_parts + 1, 3) first vertex, face and edge of each part
    local: Array  # (n_vertices, 3) m, relative to the body's centroid
    ring: IntArray  # (n_faces + 1,) first corner of each face
    corner: IntArray  # (n_corners, 2) vertex, and the edge from there to the next corner
    setback: Array  # (n_corners,) m, by how much that edge lies inside of the designed face
    plane: Array  # (n_faces, 6) outward normal, and first tangent
    extent: Array  # (n_faces, 2) area [m2] and width [m]
    edge: IntArray  # (n_edges, 4) two vertices, two faces


class World(NamedTuple):
    """Bodies in their present places; scratch, refilled for every pose."""

    turn: Array  # (n, 3, 3) rotation less identity
    axes: Array  # (n, 3, 3) columns are the principal axes
    vertex: Array  # (n_vertices, 3) m
    normal: Array  # (n_faces, 3)
    middle: Array  # (n_parts, 3) mean of the vertices [m]

    @classmethod
    def of(cls, shapes: Shapes) -> World:
        """Memory for these shapes."""
        n = len(shapes.centroid)
        return cls(
            turn=np.zeros((n, 3, 3)),
            axes=np.zeros((n, 3, 3)),
            vertex=np.zeros_like(shapes.local),
            normal=np.zeros((len(shapes.plane), 3)),
            middle=np.zeros((len(shapes.of_part), 3)),
        )


def slots_of(shapes: Shapes, points: int, part_a: IntArray, part_b: IntArray) -> IntArray:
    """How many contact points each pair of parts may have, (n_pairs,).

    Overlaps have at most as many corners as both faces have.  With 9 points per quadrilateral there
    is room for those of any overlap; with more for as many, fewer of a polygon with many corners.
    """
    corners = np.maximum.reduceat(np.diff(shapes.ring), shapes.first[:-1, 1])
    most = corners[part_a] + corners[part_b]
    if points == 4:
        return np.asarray(most, np.int64)
    return np.asarray(np.maximum(2 * most + 1, points), np.int64)


@njit(cache=True)
def turn_bodies(shapes, pose, world):
    """Rotations and principal axes of all bodies in poses (n, 7)."""
    designed, turn, axes = shapes.axes, world.turn, world.axes
    for body in range(pose.shape[0]):
        place_axes(pose, body, designed, turn, axes)


@njit(cache=True)
def place(shapes, pose, world):
    """Vertices and face normals of all parts in poses (n, 7), and what `turn_bodies` does."""
    turn_bodies(shapes, pose, world)
    turn, vertex, normal, middle = world.turn, world.vertex, world.normal, world.middle
    first, of_part, centroid = shapes.first, shapes.of_part, shapes.centroid
    local, plane = shapes.local, shapes.plane
    for part in range(of_part.shape[0]):
        body = of_part[part]
        middle[part, :] = 0.0
        share = 1.0 / (first[part + 1, 0] - first[part, 0])
        for v in range(first[part, 0], first[part + 1, 0]):
            for i in range(3):
                arm = local[v, i]
                for k in range(3):
                    arm += turn[body, i, k] * local[v, k]
                vertex[v, i] = centroid[body, i] + pose[body, i] + arm
                middle[part, i] += share * vertex[v, i]
        for f in range(first[part, 1], first[part + 1, 1]):
            for i in range(3):
                along = plane[f, i]
                for k in range(3):
                    along += turn[body, i, k] * plane[f, k]
                normal[f, i] = along


@njit(cache=True)
def _turned(turn, body, table, row, column):
    """What the rotation of a body adds to the vector in three columns of a table."""
    x, y, z = table[row, column], table[row, column + 1], table[row, column + 2]
    return (
        turn[body, 0, 0] * x + turn[body, 0, 1] * y + turn[body, 0, 2] * z,
        turn[body, 1, 0] * x + turn[body, 1, 1] * y + turn[body, 1, 2] * z,
        turn[body, 2, 0] * x + turn[body, 2, 1] * y + turn[body, 2, 2] * z,
    )


@njit(cache=True)
def _evaluate(centroid, radii, turn, pose, which, value, k, a, b):
    """Gap, normal, tangent and arms of slot k, whose local data is given; see the module."""
    if which[k, KIND] == VERTEX_B:
        v, f, sign, of_v, of_f = b, a, 1.0, ARM_B_3, ARM_A_3
    else:
        v, f, sign, of_v, of_f = a, b, -1.0, ARM_A_3, ARM_B_3
    at_point = _turned(turn, v, value, k, POINT_3)
    at_place = _turned(turn, f, value, k, PLACE_3)
    at_normal = _turned(turn, f, value, k, PLANE_NORMAL_3)
    at_tangent = _turned(turn, f, value, k, PLANE_TANGENT_3)
    designed, moved, ball = 0.0, 0.0, value[k, BALL_3]
    for i in range(3):
        before, point = value[k, PLANE_NORMAL_3 + i], value[k, POINT_3 + i]
        now = before + at_normal[i]
        between, shift = centroid[v, i] - centroid[f, i], pose[v, i] - pose[f, i]
        d = between + (point - value[k, PLACE_3 + i])
        designed += before * d
        moved += at_normal[i] * d + now * (shift + (at_point[i] - at_place[i]))
        arm = point + at_point[i] - ball * now
        value[k, NORMAL_3 + i] = sign * now
        value[k, TANGENT_3 + i] = value[k, PLANE_TANGENT_3 + i] + at_tangent[i]
        value[k, of_v + i] = arm
        value[k, of_f + i] = (between + shift) + arm
    value[k, GAP] = (designed - radii) + moved


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
def _overlap(reference, incident, m, n, near, polygon, name):
    """Corners of the overlap, by name: which half of the arrays, how many, area and centroid."""
    half, count = clip(incident, m, reference, n, ROUNDING * near / CLIP, polygon, name)
    area, cx, cy, perimeter = measure(polygon, half, count)
    if area == 0.0:
        half, count = clip(incident, m, reference, n, near, polygon, name)
        _, cx, cy, perimeter = measure(polygon, half, count)
    if count > 0:
        short = max(MERGE * width_of(area, perimeter), near)
        name_corners(polygon, name, half, count, incident, m, reference, n, near)
        count = merge_corners(polygon, name, half, count, short, near)
        half = sort_corners(polygon, name, half, count)
    return half, count, area, cx, cy


@njit(cache=True)
def _on_face(ring, corner, local, face, incident, m, x, y, value, k):
    """Material point of the incident face that is seen at (x, y), into slot k."""
    i, j, far, widest = 1, 2, 0.0, 0.0  # corners that, with the first one, span the face best
    for c in range(1, m):
        ux, uy = incident[c, 0] - incident[0, 0], incident[c, 1] - incident[0, 1]
        if ux * ux + uy * uy > far:
            i, far = c, ux * ux + uy * uy
    for c in range(1, m):
        ux, uy = incident[i, 0] - incident[0, 0], incident[i, 1] - incident[0, 1]
        vx, vy = incident[c, 0] - incident[0, 0], incident[c, 1] - incident[0, 1]
        if abs(ux * vy - uy * vx) > widest:
            j, widest = c, abs(ux * vy - uy * vx)
    ux, uy = incident[i, 0] - incident[0, 0], incident[i, 1] - incident[0, 1]
    vx, vy = incident[j, 0] - incident[0, 0], incident[j, 1] - incident[0, 1]
    dx, dy = x - incident[0, 0], y - incident[0, 1]
    det = ux * vy - uy * vx
    s, t = (dx * vy - dy * vx) / det, (ux * dy - uy * dx) / det
    v0, v1 = _vertex(ring, corner, face, 0, True), _vertex(ring, corner, face, i, True)
    v2 = _vertex(ring, corner, face, j, True)
    for c in range(3):
        along = s * (local[v1, c] - local[v0, c]) + t * (local[v2, c] - local[v0, c])
        value[k, POINT_3 + c] = local[v0, c] + along


@njit(cache=True)
def _features(ring, corner, face_p, face_q, mark, i, n, m, n_vertices, n_edges):
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


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def _write_points(
    ring, corner, local, plane, edge, face_p, face_q, p_is_a, incident, n, m, n_points, first, end,
    which, value, polygon, mark, weight,
):  # fmt: skip
    """Points of an overlap as slots from ``first`` on, but for what `_evaluate` adds."""
    n_vertices, n_edges = local.shape[0], edge.shape[0]
    k = first
    for i in range(n_points):
        if k >= end:
            break
        if weight[i] == 0.0:  # no joint behind it
            continue
        type_ = mark[i, TYPE]
        swapped = type_ == VERTEX_P
        carrier = face_q if swapped else face_p
        on_p, on_q = _features(ring, corner, face_p, face_q, mark, i, n, m, n_vertices, n_edges)
        which[k, KIND] = VERTEX_B if p_is_a != swapped else VERTEX_A
        which[k, FEATURE_A], which[k, FEATURE_B] = (on_p, on_q) if p_is_a else (on_q, on_p)
        which[k, EDGE_A], which[k, EDGE_B] = (face_p, face_q) if p_is_a else (face_q, face_p)
        value[k, SIZE] = weight[i]
        origin = corner[ring[carrier], 0]
        for c in range(3):
            value[k, PLACE_3 + c] = local[origin, c]
            value[k, PLANE_NORMAL_3 + c] = plane[carrier, c]
            value[k, PLANE_TANGENT_3 + c] = plane[carrier, 3 + c]
        if type_ == VERTEX_P or type_ == VERTEX_Q:
            v = on_p if swapped else on_q
            for c in range(3):
                value[k, POINT_3 + c] = local[v, c]
        elif type_ == CROSSING:
            j = mark[i, OF_Q]
            after = j + 1 if j + 1 < m else 0
            ex, ey = incident[after, 0] - incident[j, 0], incident[after, 1] - incident[j, 1]
            share = (polygon[i, 0] - incident[j, 0]) * ex + (polygon[i, 1] - incident[j, 1]) * ey
            share = min(max(share / (ex * ex + ey * ey), 0.0), 1.0)
            v = _vertex(ring, corner, face_q, j, True)
            w = _vertex(ring, corner, face_q, after, True)
            for c in range(3):
                value[k, POINT_3 + c] = local[v, c] + share * (local[w, c] - local[v, c])
        else:
            x, y = polygon[i, 0], polygon[i, 1]
            _on_face(ring, corner, local, face_q, incident, m, x, y, value, k)
        k += 1
    return k


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def _face_points(
    ring, corner, setback, local, plane, edge, extent, turn, vertex, normal, of_part, face_p,
    face_q, part_p, p_is_a, points, first, end, which, value, reference, incident, polygon, name,
    point, mark, weight, t1, t2,
):  # fmt: skip
    """Points of the overlap of a reference face p and an incident face q; the slot behind them."""
    n, m = project_both(
        ring, corner, vertex, normal, plane, turn, of_part[part_p], face_p, face_q, t1, t2,
        reference, incident,
    )  # fmt: skip
    near = CLIP * min(extent[face_p, 1], extent[face_q, 1])
    half, count, area, cx, cy = _overlap(reference, incident, m, n, near, polygon, name)
    if count == 0:
        return first
    cosine = 0.0
    for c in range(3):
        cosine -= normal[face_p, c] * normal[face_q, c]
    if area > 0.0:
        for i in range(count):
            j = name[half, i, LEAVES]
            at = ring[face_q] + (m - 2 - j) % m if j < m else ring[face_p] + j - m
            weight[i] = setback[at]
        area += widened(polygon, half, count, weight)
    n_points = n_spread(count, points if cosine > EDGE_ON and area > 0.0 else 4, end - first)
    spread(polygon, name, half, count, cx, cy, n_points, point, mark, weight)
    least = LEAST_SHARE * min(extent[face_p, 0], extent[face_q, 0])
    scale(point, n_points, cx, cy, max(area, least), weight)
    return _write_points(
        ring, corner, local, plane, edge, face_p, face_q, p_is_a, incident, n, m, n_points,
        first, end, which, value, point, mark, weight,
    )  # fmt: skip


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def _edge_point(
    local, edge, plane, extent, turn, body_a, k, edges, faces, which, value, axis, shares
):
    """The point where edges of a and b cross, as slot k, but for what `_evaluate` adds."""
    edge_a, edge_b = edges
    face_a, face_b = faces
    n_vertices = local.shape[0]
    which[k, KIND] = VERTEX_B
    which[k, FEATURE_A], which[k, FEATURE_B] = n_vertices + edge_a, n_vertices + edge_b
    which[k, EDGE_A], which[k, EDGE_B] = face_a, face_b
    value[k, SIZE] = LEAST_SHARE * min(extent[face_a, 0], extent[face_b, 0])
    a0, a1, b0, b1 = edge[edge_a, 0], edge[edge_a, 1], edge[edge_b, 0], edge[edge_b, 1]
    for c in range(3):
        value[k, PLACE_3 + c] = local[a0, c] + shares[0] * (local[a1, c] - local[a0, c])
        value[k, POINT_3 + c] = local[b0, c] + shares[1] * (local[b1, c] - local[b0, c])
        back = axis[c]
        for i in range(3):
            back += turn[body_a, i, c] * axis[i]
        value[k, PLANE_NORMAL_3 + c] = back
    # A tangent: of the edge of a and the first tangent of its face, what is farther off the normal.
    best = -1.0
    for trial in range(2):
        along, size = 0.0, 0.0
        for c in range(3):
            t = local[a1, c] - local[a0, c] if trial == 0 else plane[face_a, 3 + c]
            along += t * value[k, PLANE_NORMAL_3 + c]
            size += t * t
        off = 1.0 - along * along / size
        if off <= best:
            continue
        best = off
        for c in range(3):
            t = local[a1, c] - local[a0, c] if trial == 0 else plane[face_a, 3 + c]
            t -= along * value[k, PLANE_NORMAL_3 + c]
            value[k, PLANE_TANGENT_3 + c] = t / np.sqrt(size * off)


# Many: arrays one by one, for records that are handed on count references at every pair.
@njit(cache=True)
def _evaluate_all(centroid, radius_a, radius_b, turn, pose, which, value, begin, stop, a, b):
    """Evaluate the slots from ``begin`` to ``stop``; the least gap."""
    least = np.inf
    for k in range(begin, stop):
        _evaluate(centroid, radius_a + radius_b, turn, pose, which, value, k, a, b)
        least = min(least, value[k, GAP])
    return least


@njit(cache=True)
def _empty(which, value, begin, stop):
    """Take the slots from ``begin`` to ``stop`` out of use."""
    for k in range(begin, stop):
        which[k, KIND], value[k, GAP] = NONE, np.inf
        which[k, FEATURE_A], which[k, FEATURE_B] = -1, -1


# Arrays are taken one by one, for records that are handed on count references at every pair.
# Long, and many: the phases of one pair, with the scratch that they share.
@njit(cache=True)
def _find(shapes, pose, world, of_pair, reach, points, which, value):
    centroid, of_part, radius, size = shapes.centroid, shapes.of_part, shapes.radius, shapes.size
    first, local, ring, corner = shapes.first, shapes.local, shapes.ring, shapes.corner
    setback = shapes.setback
    plane, extent, edge = shapes.plane, shapes.extent, shapes.edge
    turn, vertex, normal, middle = world.turn, world.vertex, world.normal, world.middle
    most = 0
    for f in range(ring.shape[0] - 1):
        most = max(most, ring[f + 1] - ring[f])
    reference, incident = np.empty((most, 2)), np.empty((most, 2))
    room = 2 * most + 8
    polygon, name = np.empty((2, room, 2)), np.empty((2, room, 4), np.int64)
    largest = max(4 * room, points)
    point, mark = np.empty((largest, 2)), np.empty((largest, 4), np.int64)
    weight, work, t1, t2 = np.empty(largest), np.empty((5, 3)), np.empty(3), np.empty(3)
    n_pairs, n_slots = of_pair.shape[0], which.shape[0]
    for i in range(n_pairs):
        begin = of_pair[i, FIRST]
        end = of_pair[i + 1, FIRST] if i + 1 < n_pairs else n_slots
        if begin == end:
            continue
        p, q, a, b = of_pair[i, PART_A], of_pair[i, PART_B], of_pair[i, A], of_pair[i, B]
        kept_a, kept_b = which[begin, EDGE_A], which[begin, EDGE_B]
        _empty(which, value, begin, end)  # unused ones as well: their values may be of other poses
        radii = radius[p] + radius[q]
        limit = reach + radii
        face_a, apart_a, held_a = best_face(
            first, ring, corner, vertex, normal, middle, p, q, kept_a, limit
        )
        if apart_a > limit:
            continue
        face_b, apart_b, held_b = best_face(
            first, ring, corner, vertex, normal, middle, q, p, kept_b, limit
        )
        if apart_b > limit:
            continue
        smaller = min(size[p], size[q])
        slack, tie, edged = HELD * smaller, TIED * smaller, EDGED * smaller
        best = max(apart_a, apart_b)
        holds_a = held_a >= best - edged or (held_a >= best - slack and lies_on(
            first, ring, corner, vertex, normal, plane, extent, turn, a, kept_a, q, kept_b,
            held_a + slack, t1, t2, reference, incident, polygon, name,
        ))  # fmt: skip
        holds_b = held_b >= best - edged or (held_b >= best - slack and lies_on(
            first, ring, corner, vertex, normal, plane, extent, turn, b, kept_b, p, kept_a,
            held_b + slack, t1, t2, reference, incident, polygon, name,
        ))  # fmt: skip
        prefers_a = apart_a >= apart_b - edged or (apart_a >= apart_b - slack and lies_on(
            first, ring, corner, vertex, normal, plane, extent, turn, a, face_a, q, kept_b,
            apart_a + slack, t1, t2, reference, incident, polygon, name,
        ))  # fmt: skip
        stop, tried, least = begin, -1, np.inf
        p_is_a, face_p, face_q, cosine = True, face_a, face_b, 0.0
        for attempt in range(2):
            if attempt == 0 and holds_a:
                p_is_a, face_p, apart = True, kept_a, held_a
            elif attempt == 0 and holds_b:
                p_is_a, face_p, apart = False, kept_b, held_b
            elif prefers_a:
                p_is_a = True
                face_p, apart = untied(
                    first, ring, corner, vertex, normal, plane, extent, turn, a, p, q, face_a,
                    apart_a, tie, slack, kept_b, t1, t2, reference, incident, polygon, name,
                )  # fmt: skip
            else:
                p_is_a = False
                face_p, apart = untied(
                    first, ring, corner, vertex, normal, plane, extent, turn, b, q, p, face_b,
                    apart_b, tie, slack, kept_a, t1, t2, reference, incident, polygon, name,
                )  # fmt: skip
            if face_p == tried:
                break
            tried = face_p
            part_p, part_q = (p, q) if p_is_a else (q, p)
            face_q, cosine = incident_face(
                first, ring, corner, vertex, normal, face_p, part_q, kept_b if p_is_a else kept_a,
                apart + slack,
            )  # fmt: skip
            stop = _face_points(
                ring, corner, setback, local, plane, edge, extent, turn, vertex, normal, of_part,
                face_p, face_q, part_p, p_is_a, points, begin, end, which, value, reference,
                incident, polygon, name, point, mark, weight, t1, t2,
            )  # fmt: skip
            meet_rims(
                ring, corner, local, plane, edge, turn, vertex, normal, a, b, radius[p],
                radius[q], begin, stop, which, value, work[2:],
            )  # fmt: skip
            least = _evaluate_all(
                centroid, radius[p], radius[q], turn, pose, which, value, begin, stop, a, b
            )
            if stop > begin:
                break
        face_a, face_b = (face_p, face_q) if p_is_a else (face_q, face_p)
        margin, near = MARGIN * min(size[p], size[q]), least <= best - radii + slack
        if not (near and best >= -margin) and (radii > 0.0 or cosine > -1.0 + HELD * HELD):
            edge_a, edge_b, across = best_edges(first, edge, vertex, normal, p, q, work)
            found = across > best + margin or (not near and least + radii > across + margin)
            found = found and edge_a >= 0 and -np.inf < across <= limit
            p_is_a, face_p, face_q = True, -1, -1
            if found:
                p_is_a, face_p, face_q = edge_on_face(edge, normal, edge_a, edge_b, work[0])
            elif radii > 0.0:
                edge_a, edge_b, across = nearest_edges(first, edge, vertex, p, q, work)
                found = slack < across <= limit and across - radii < least - slack
            if found:
                _empty(which, value, begin, stop)
                stop = begin
            if face_p >= 0:
                stop = _face_points(
                    ring, corner, setback, local, plane, edge, extent, turn, vertex, normal,
                    of_part, face_p, face_q, p if p_is_a else q, p_is_a, points, begin, end, which,
                    value, reference, incident, polygon, name, point, mark, weight, t1, t2,
                )  # fmt: skip
                meet_rims(
                    ring, corner, local, plane, edge, turn, vertex, normal, a, b, radius[p],
                    radius[q], begin, stop, which, value, work[2:],
                )  # fmt: skip
                least = _evaluate_all(
                    centroid, radius[p], radius[q], turn, pose, which, value, begin, stop, a, b
                )
                if abs(least + radii - across) > margin:  # not by what lies on the face alone
                    _empty(which, value, begin, stop)
                    stop = begin
            if found and stop == begin:
                _edge_point(
                    local, edge, plane, extent, turn, a, begin, (edge_a, edge_b),
                    (face_a, face_b), which, value, work[0], work[1],
                )  # fmt: skip
                stop, value[begin, BALL_3] = begin + 1, radius[q]
                _evaluate_all(
                    centroid, radius[p], radius[q], turn, pose, which, value, begin, stop, a, b
                )
        for k in range(begin, stop):
            if value[k, GAP] > reach:
                which[k, KIND], value[k, GAP] = NONE, np.inf


@njit(cache=True)
def find(shapes, pose, world, pairs, reach, points, slots):
    """Fill the slots of all pairs in poses (n, 7); ``reach`` [m] is the largest gap watched.

    ``points`` is 4, 16 or the square of an odd number per quadrilateral overlap.  What the slots
    hold before says which faces were used last, and is otherwise of no account.
    """
    which, value = slots
    place(shapes, pose, world)
    _find(shapes, pose, world, pairs.which, reach, points, which, value)


@njit(cache=True)
def follow(shapes, pose, world, pairs, known, slots):
    """Fill the slots in poses (n, 7) with the points that ``known`` slots have, bodies moved on.

    Within a step this is cheaper than finding contacts anew, and smooth.
    """
    turn_bodies(shapes, pose, world)
    centroid, radius, turn = shapes.centroid, shapes.radius, world.turn
    (which, value), of_pair, pair = slots, pairs.which, pairs.of_slot
    first, known_value = known
    for k in range(which.shape[0]):
        for c in range(which.shape[1]):
            which[k, c] = first[k, c]
        if which[k, KIND] == NONE:
            value[k, GAP] = np.inf
            continue
        value[k, SIZE] = known_value[k, SIZE]
        for c in range(POINT_3, BALL_3 + 1):
            value[k, c] = known_value[k, c]
        i = pair[k]
        a, b = of_pair[i, A], of_pair[i, B]
        radii = radius[of_pair[i, PART_A]] + radius[of_pair[i, PART_B]]
        _evaluate(centroid, radii, turn, pose, which, value, k, a, b)
