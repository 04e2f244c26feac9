"""Contact points in space: their definition, and their gap, normal and arms in any pose.

Every contact point is a material point of one body, v, on a plane that another body, f, carries
along (`contacts.VERTEX_B`: v is b and f is a; `VERTEX_A`: the reverse):

    p      the point, relative to v's centroid        POINT_3
    o, n   a place on the plane and its normal,       PLACE_3, PLANE_NORMAL_3
           from f to v
    t      unit vector in the plane                   PLANE_TANGENT_3

All vectors are in the axes of the design.  With R the rotation and u the displacement of a body,

    d_0 = c_v - c_f + p - o,     D = u_v - u_f + (R_v - I) p - (R_f - I) o
    gap = n . d_0 + (R_f - I) n . d_0 + R_f n . D - radii

The designed gap and its change are calculated separately, so that a gap is as precise as the
displacements.  This is needed because a stiff joint closes by less than the rounding of
coordinates.

Bodies touch at the point, or where the ball around it (BALL_3, the radius of a rounded part) meets
the plane.  Both arms lead there from the centroids.  With the present unit normal n from a to b,
tangents t_1 = R_f t and t_2 = n x t_1, and motions (u_a, w_a, u_b, w_b),

    d gap    = n . (du_b + dw_b x arm_b - du_a - dw_a x arm_a),      slips likewise with t_1, t_2

These derivatives are exact, and reactions along them balance in force and in moment.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ARM_A_3,
    ARM_B_3,
    BALL_3,
    FEATURE_A,
    FEATURE_B,
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
    VERTEX_B,
    A,
    B,
)
from drystone.contact.space.shapes import rotate_bodies


@njit(cache=True)
def _rotated(rotation, body, table, row, column):
    """Change by the rotation of a body of the vector in three columns of a table."""
    x, y, z = table[row, column], table[row, column + 1], table[row, column + 2]
    return (
        rotation[body, 0, 0] * x + rotation[body, 0, 1] * y + rotation[body, 0, 2] * z,
        rotation[body, 1, 0] * x + rotation[body, 1, 1] * y + rotation[body, 1, 2] * z,
        rotation[body, 2, 0] * x + rotation[body, 2, 1] * y + rotation[body, 2, 2] * z,
    )


@njit(cache=True)
def evaluate(centroid, radii, rotation, pose, which, value, k, a, b):
    """Fill gap, normal, tangent and arms of slot k, whose constant data is given, for bodies a and
    b; see the module's text.  ``radii`` [m] is the sum of the radii of both parts."""
    if which[k, KIND] == VERTEX_B:
        v, f, sign, of_v, of_f = b, a, 1.0, ARM_B_3, ARM_A_3
    else:
        v, f, sign, of_v, of_f = a, b, -1.0, ARM_A_3, ARM_B_3
    at_point = _rotated(rotation, v, value, k, POINT_3)
    at_place = _rotated(rotation, f, value, k, PLACE_3)
    at_normal = _rotated(rotation, f, value, k, PLANE_NORMAL_3)
    at_tangent = _rotated(rotation, f, value, k, PLANE_TANGENT_3)
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
def evaluate_all(centroid, radii, rotation, pose, which, value, begin, stop, a, b):
    """Evaluate the slots from ``begin`` to before ``stop``, of bodies a and b; returns the smallest
    gap [m]."""
    least = np.inf
    for k in range(begin, stop):
        evaluate(centroid, radii, rotation, pose, which, value, k, a, b)
        least = min(least, value[k, GAP])
    return least


@njit(cache=True)
def empty(which, value, begin, stop):
    """Take the slots from ``begin`` to before ``stop`` out of use."""
    for k in range(begin, stop):
        which[k, KIND], value[k, GAP] = NONE, np.inf
        which[k, FEATURE_A], which[k, FEATURE_B] = -1, -1


@njit(cache=True)
def follow(shapes, pose, world, pairs, known, slots):
    """Fill the slots in poses (n, 7) with the points of the ``known`` slots.

    Within a step this is cheaper than finding contacts anew, and it is smooth.
    """
    rotate_bodies(shapes, pose, world)
    centroid, radius, rotation = shapes.centroid, shapes.radius, world.rotation
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
        evaluate(centroid, radii, rotation, pose, which, value, k, a, b)
