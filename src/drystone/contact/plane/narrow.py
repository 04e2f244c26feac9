"""Narrow phase in two dimensions: the contact points of every pair of nearby blocks.

Each candidate pair owns two slots, one for each end of the interface between its facing edges.  It
has more if there are points between the ends.  A slot in use holds one contact between a vertex and
an edge, or between two vertices:

    VERTEX_B  vertex of b on an edge of a        normal: the edge's
    VERTEX_A  vertex of a on an edge of b        normal: the edge's, reversed
    VERTICES  vertex of a and vertex of b        normal: from one to the other

With unit normal n (from a to b), tangent t = (n_y, -n_x), arms from the centroids to the vertex
(or vertices), S the quarter turn counter-clockwise, q = (x_a, theta_a, x_b, theta_b):

    grad gap  = [-n, -n.S arm_a, n, n.S arm_b]
    grad slip = ratio [-t, -t.S arm_a, t, t.S arm_b] + [0, 0, roll_a, 0, 0, roll_b]

The roll terms are the radii of rounded vertices, which roll without slipping.  The ratio is 1,
except between two vertices, where it is (r_a + r_b) / distance.  Both are exact gradients of the
gap and of the sliding distance, so that reactions along them balance in force and in moment.

A gap is the sum of the designed gap and its change, calculated separately.  With the designed
vector d_0 from the edge's first vertex to the vertex, the edge's designed normal n_0, and the arms
l as designed,

    d = d_0 + D,    D = u_v - u_e + (R_v - I) l_v - (R_e - I) l_e
    n . d = n_0 . d_0 + (R_e - I) n_0 . d_0 + n . D

So gaps are as precise as the displacements.  This is needed because a stiff joint closes by less
than the rounding of coordinates.  The distance of two vertices is calculated in the same way,
|d| = |d_0| + D . (d_0 + d) / (|d_0| + |d|).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.common.tolerances import DEEP, LEAST_LENGTH, PASSAGE, ROUNDING, SAME_CORNER
from drystone.contact.contacts import (
    ARM_A,
    ARM_B,
    EDGE_A,
    EDGE_B,
    FEATURE_A,
    FEATURE_B,
    FIRST,
    GAP,
    INSIDE,
    KIND,
    NONE,
    NORMAL,
    PART_A,
    PART_B,
    RATIO,
    ROLL_A,
    ROLL_B,
    SIZE,
    VERTEX_A,
    VERTEX_B,
    VERTICES,
    A,
    B,
)

#: Number of contact points at the ends of the interface of a pair.  Further points lie between
#: them, at equal distances, on the edge of b.
ENDS = 2


class Bodies(NamedTuple):
    """Contact shapes of all bodies.  Row i of vertices also stands for the edge from vertex i to
    the next."""

    centroid: Array  # (n, 2) m, as designed
    of_part: IntArray  # (n_parts,) body of each convex part
    offset: IntArray  # (n_parts + 1,) first vertex of each part
    following: IntArray  # (n_vertices,) the next vertex around the same part
    local: Array  # (n_vertices, 2) m, relative to the body's centroid
    local_tangent: Array  # (n_vertices, 2) unit vector of the edge
    length: Array  # (n_vertices,) m, of the core edge
    # (n_vertices, 2) m, by how much the core edge is shorter than the designed one: at start, end
    setback: Array
    radius: Array  # (n_parts,) m, of rounded corners: the surface lies so far outside the core


class World(NamedTuple):
    """Vertices and edge tangents in the present poses; scratch memory, filled anew for all
    poses."""

    vertex: Array  # (n_vertices, 2) m
    tangent: Array  # (n_vertices, 2)
    arm: Array  # (n_vertices, 2) m, from the centroid
    rotation: Array  # (n, 2) sine and 1 - cosine of each body's rotation


@njit(cache=True, error_model="numpy")
def place(bodies, pose, world):
    """Fill ``world`` with the core vertices and edge tangents in the poses (n, 3)."""
    for part in range(bodies.of_part.shape[0]):
        body = bodies.of_part[part]
        c = np.cos(pose[body, 2])
        s = np.sin(pose[body, 2])
        world.rotation[body, 0] = s
        world.rotation[body, 1] = 2.0 * np.sin(0.5 * pose[body, 2]) ** 2
        x = bodies.centroid[body, 0] + pose[body, 0]
        y = bodies.centroid[body, 1] + pose[body, 1]
        for v in range(bodies.offset[part], bodies.offset[part + 1]):
            lx = bodies.local[v, 0]
            ly = bodies.local[v, 1]
            ax = c * lx - s * ly
            ay = s * lx + c * ly
            world.arm[v, 0] = ax
            world.arm[v, 1] = ay
            world.vertex[v, 0] = x + ax
            world.vertex[v, 1] = y + ay
            tx = bodies.local_tangent[v, 0]
            ty = bodies.local_tangent[v, 1]
            world.tangent[v, 0] = c * tx - s * ty
            world.tangent[v, 1] = s * tx + c * ty


@njit(cache=True, error_model="numpy")
def _best_edge(offset, vertex, tangent, a, b):
    """Edge of part a whose outward normal separates parts a and b most, and this separation [m]."""
    best = -np.inf
    edge = offset[a]
    for i in range(offset[a], offset[a + 1]):
        nx = tangent[i, 1]
        ny = -tangent[i, 0]
        base = nx * vertex[i, 0] + ny * vertex[i, 1]
        least = np.inf
        for j in range(offset[b], offset[b + 1]):
            d = nx * vertex[j, 0] + ny * vertex[j, 1] - base
            if d < least:
                least = d
        if least > best:
            best = least
            edge = i
    return edge, best


@njit(cache=True, error_model="numpy")
def _most_opposed(offset, tangent, edge, b):
    """Edge of part b whose tangent is most opposed to that of ``edge``."""
    best = np.inf
    found = offset[b]
    for j in range(offset[b], offset[b + 1]):
        d = tangent[edge, 0] * tangent[j, 0] + tangent[edge, 1] * tangent[j, 1]
        if d < best:
            best = d
            found = j
    return found


@njit(cache=True, error_model="numpy")
def _nearly_as_opposed(first, end, tangent, edge, found):
    """The neighbour of the edge ``found`` that is more opposed to ``edge``, and its share of the
    tributary length.

    The share is a half if both edges of the corner are equally opposed to ``edge``.  It falls
    smoothly to zero as the corner turns: at PASSAGE of the rotation that lays one of them on
    ``edge``.  ``first`` and ``end`` bound the edges of the part.
    """
    tx, ty = tangent[edge, 0], tangent[edge, 1]
    before = found - 1 if found > first else end - 1
    after = found + 1 if found + 1 < end else first
    d_before = tx * tangent[before, 0] + ty * tangent[before, 1]
    d_after = tx * tangent[after, 0] + ty * tangent[after, 1]
    beside = before if d_before < d_after else after
    least = tx * tangent[found, 0] + ty * tangent[found, 1]
    corner = tangent[found, 0] * tangent[beside, 0] + tangent[found, 1] * tangent[beside, 1]
    away = (min(d_before, d_after) - least) / (PASSAGE * (1.0 - corner))
    return beside, 0.5 * (1.0 - away) ** 2 if away < 1.0 else 0.0


@njit(cache=True, error_model="numpy")
def _overlap(length, setback, vertex, tangent, ea, eb, b1):
    """Half of the length along which the edges ``ea`` and ``eb`` face each other [m]; ``b1`` is the
    end vertex of ``eb``."""
    start = max(_along(vertex, tangent, ea, b1) - setback[eb, 1], -setback[ea, 0])
    end = min(_along(vertex, tangent, ea, eb) + setback[eb, 0], length[ea] + setback[ea, 1])
    return max(0.5 * (end - start), LEAST_LENGTH * min(length[ea], length[eb]))


@njit(cache=True, error_model="numpy")
def _along(vertex, tangent, edge, v):
    """Coordinate of a vertex along an edge, from the edge's start [m]."""
    x = (vertex[v, 0] - vertex[edge, 0]) * tangent[edge, 0]
    return x + (vertex[v, 1] - vertex[edge, 1]) * tangent[edge, 1]


@njit(cache=True, error_model="numpy")
def _end(length, vertex, tangent, radii, ea, eb, va, vb, reference_is_a):
    """Kind and features of the contact at one end of the interface of edges ``ea`` and ``eb``.

    The vertices at this end are va and vb.  The vertex that lies within the other edge makes the
    contact.  If neither does, the two vertices face each other across a corner.  Sharp corners then
    have a contact only if they nearly coincide; its normal is that of the reference edge.
    """
    dx = vertex[vb, 0] - vertex[va, 0]
    dy = vertex[vb, 1] - vertex[va, 1]
    sb = _along(vertex, tangent, ea, vb)
    sa = _along(vertex, tangent, eb, va)
    # Rounding must not hide sharp corners that lie exactly above each other.
    slack = 0.0 if radii > 0.0 else ROUNDING * (length[ea] + length[eb])
    b_inside = -slack <= sb <= length[ea] + slack
    a_inside = -slack <= sa <= length[eb] + slack
    if b_inside and a_inside:
        # The edges open towards this end; the nearer one of the two candidates is taken.
        gap_b = dx * tangent[ea, 1] - dy * tangent[ea, 0]
        gap_a = -dx * tangent[eb, 1] + dy * tangent[eb, 0]
        b_inside = gap_b < gap_a or (gap_b == gap_a and reference_is_a)
    elif not b_inside and not a_inside:
        apart = dx * dx + dy * dy
        if radii > 0.0 and apart > (DEEP * radii) ** 2:
            return VERTICES, va, vb
        near = SAME_CORNER * (length[ea] + length[eb])
        if apart > near * near:
            return NONE, va, vb
        b_inside = reference_is_a
    if b_inside:
        return VERTEX_B, ea, vb
    return VERTEX_A, va, eb


# Many: arrays one by one, because records passed on would count references at every pair.
@njit(cache=True, error_model="numpy")
def _interface(
    offset, following, length, setback, radii, vertex, tangent, p, q, reach, which, value, k, points
):
    """Fill kinds, features, edges and tributary lengths of the slots of parts p and q, from slot k
    on."""
    for slot in range(k, k + points):
        which[slot, KIND] = NONE
    ea, apart_a = _best_edge(offset, vertex, tangent, p, q)
    if apart_a > radii + reach:
        return
    eb, apart_b = _best_edge(offset, vertex, tangent, q, p)
    if apart_b > radii + reach:
        return
    tie = ROUNDING * (length[ea] + length[eb])
    reference_is_a = apart_a >= apart_b - tie
    if reference_is_a:
        eb = _most_opposed(offset, tangent, ea, q)
    else:
        ea = _most_opposed(offset, tangent, eb, p)
    a0, a1 = ea, following[ea]
    b0, b1 = eb, following[eb]
    # Coordinates of b's vertices along a's edge; b1 faces a0 and b0 faces a1.
    s1 = _along(vertex, tangent, ea, b1)
    s0 = _along(vertex, tangent, ea, b0)
    length_a = length[ea]
    tributary = _overlap(length, setback, vertex, tangent, ea, eb, b1)
    if reference_is_a:
        beside, share = _nearly_as_opposed(offset[q], offset[q + 1], tangent, ea, eb)
        pa, pb = ea, beside
    else:
        beside, share = _nearly_as_opposed(offset[p], offset[p + 1], tangent, eb, ea)
        pa, pb = beside, eb
    if share > 0.0:
        other = _overlap(length, setback, vertex, tangent, pa, pb, following[pb])
        tributary += share * (other - tributary)
    for slot in range(k, k + points):
        value[slot, SIZE], value[slot, INSIDE] = tributary, 0.0
        which[slot, EDGE_A], which[slot, EDGE_B] = ea, eb
    if s1 > length_a or s0 < 0.0:  # b lies past an end of a's edge
        va = a1 if s1 > length_a else a0
        sa = _along(vertex, tangent, eb, va)
        which[k, FEATURE_A] = va
        if 0.0 <= sa <= length[eb]:
            which[k, KIND], which[k, FEATURE_B] = VERTEX_A, eb
        elif radii > 0.0:
            which[k, KIND], which[k, FEATURE_B] = VERTICES, b0 if sa < 0.0 else b1
        return
    va, vb = a0, b1
    for slot in range(k, k + 2):
        kind, fa, fb = _end(length, vertex, tangent, radii, ea, eb, va, vb, reference_is_a)
        which[slot, KIND], which[slot, FEATURE_A], which[slot, FEATURE_B] = kind, fa, fb
        va, vb = a1, b0
    start, end = max(s1, 0.0), min(s0, length_a)
    if points == ENDS or not start < end:
        return
    share = 1.0 / (points - 1)
    value[k, SIZE], value[k + 1, SIZE] = share * tributary, share * tributary
    for j in range(1, points - 1):
        slot = k + 1 + j
        which[slot, KIND], which[slot, FEATURE_A], which[slot, FEATURE_B] = VERTEX_B, ea, eb
        value[slot, SIZE] = 2.0 * share * tributary
        value[slot, INSIDE] = (s0 - start - (end - start) * j * share) / (s0 - s1)


@njit(cache=True, error_model="numpy")
def _rotated(rotation, body, x, y):
    """Change of a designed vector (x, y) of a body by its rotation."""
    sine, versine = rotation[body, 0], rotation[body, 1]
    return -versine * x - sine * y, sine * x - versine * y


@njit(cache=True, error_model="numpy")
def _measure(bodies, pose, world, pairs, slots):
    """Fill gap, normal, arms and roll terms of all slots, whose features are known."""
    # Fields are read before the loop: within it, each reading would count references.
    centroid, local, radius = bodies.centroid, bodies.local, bodies.radius
    local_tangent, tangent, arm, rotation = (
        bodies.local_tangent,
        world.tangent,
        world.arm,
        world.rotation,
    )
    length = bodies.length
    pair, of_pair, (which, value) = pairs.of_slot, pairs.which, slots
    for k in range(which.shape[0]):
        kind = which[k, KIND]
        if kind == NONE:
            value[k, GAP] = np.inf
            continue
        p = pair[k]
        a, b = of_pair[p, A], of_pair[p, B]
        va, vb = which[k, FEATURE_A], which[k, FEATURE_B]
        # Vectors lead from the vertex (or first vertex of the edge) of a to that of b; the reverse
        # if the edge is of b.
        sign = -1.0 if kind == VERTEX_A else 1.0
        between_x, between_y = centroid[b, 0] - centroid[a, 0], centroid[b, 1] - centroid[a, 1]
        shift_x, shift_y = pose[b, 0] - pose[a, 0], pose[b, 1] - pose[a, 1]
        ax, ay, bx, by = local[va, 0], local[va, 1], local[vb, 0], local[vb, 1]
        inside = value[k, INSIDE] * length[vb]
        if inside != 0.0:
            bx += inside * local_tangent[vb, 0]
            by += inside * local_tangent[vb, 1]
        rotated_ax, rotated_ay = _rotated(rotation, a, ax, ay)
        rotated_bx, rotated_by = _rotated(rotation, b, bx, by)
        x, y = sign * (between_x + (bx - ax)), sign * (between_y + (by - ay))  # as designed
        moved_x = sign * (shift_x + (rotated_bx - rotated_ax))
        moved_y = sign * (shift_y + (rotated_by - rotated_ay))
        ra, rb = radius[of_pair[p, PART_A]], radius[of_pair[p, PART_B]]
        if kind == VERTICES:
            dx, dy = x + moved_x, y + moved_y
            distance, before = np.sqrt(dx * dx + dy * dy), np.sqrt(x * x + y * y)
            grown = (moved_x * (x + dx) + moved_y * (y + dy)) / (distance + before)
            value[k, GAP] = (before - ra - rb) + grown
            value[k, NORMAL], value[k, NORMAL + 1] = dx / distance, dy / distance
            value[k, ROLL_A], value[k, ROLL_B] = ra, rb
            value[k, RATIO] = (ra + rb) / distance
        else:
            owner, edge, rolling = (a, va, rb) if kind == VERTEX_B else (b, vb, ra)
            nx, ny = tangent[edge, 1], -tangent[edge, 0]
            before_x, before_y = local_tangent[edge, 1], -local_tangent[edge, 0]
            rotated_x, rotated_y = _rotated(rotation, owner, before_x, before_y)
            designed = before_x * x + before_y * y - ra - rb
            moved = (rotated_x * x + rotated_y * y) + (nx * moved_x + ny * moved_y)
            value[k, GAP] = designed + moved
            value[k, NORMAL], value[k, NORMAL + 1] = sign * nx, sign * ny
            value[k, ROLL_A], value[k, ROLL_B] = -sign * rolling, sign * rolling
            value[k, RATIO] = 1.0
        ax, ay, bx, by = arm[va, 0], arm[va, 1], arm[vb, 0], arm[vb, 1]
        if inside != 0.0:
            bx += inside * tangent[vb, 0]
            by += inside * tangent[vb, 1]
        if kind == VERTEX_B:
            ax, ay = between_x + shift_x + bx, between_y + shift_y + by
        elif kind == VERTEX_A:
            bx, by = ax - (between_x + shift_x), ay - (between_y + shift_y)
        value[k, ARM_A], value[k, ARM_A + 1] = ax, ay
        value[k, ARM_B], value[k, ARM_B + 1] = bx, by


@njit(cache=True, error_model="numpy")
def find_contacts(box, pose, pairs, reach, slots):
    """Fill the slots of all pairs in the poses (n, 3); ``reach`` [m] is the largest gap listed.

    The ``box`` holds `Bodies` and their `World`, which is scratch memory.
    """
    bodies, world = box.value
    place(bodies, pose, world)
    # Fields are read before the loop: within it, each reading would count references.
    offset, following, length = bodies.offset, bodies.following, bodies.length
    setback, radius = bodies.setback, bodies.radius
    vertex, tangent = world.vertex, world.tangent
    of_pair, (which, value) = pairs.which, slots
    points = which.shape[0] // max(of_pair.shape[0], 1)
    for k in range(of_pair.shape[0]):
        p, q = of_pair[k, PART_A], of_pair[k, PART_B]
        _interface(
            offset, following, length, setback, radius[p] + radius[q], vertex, tangent, p, q,
            reach, which, value, of_pair[k, FIRST], points,
        )  # fmt: skip
    _measure(bodies, pose, world, pairs, slots)
    for k in range(which.shape[0]):
        if value[k, GAP] > reach:
            which[k, KIND] = NONE


@njit(cache=True, error_model="numpy")
def follow_contacts(bodies, pose, world, pairs, known, slots):
    """Fill the slots in new poses, with the features of the ``known`` slots.

    Within a step this is cheaper than finding contacts anew, and it is smooth.  If two vertices
    pass each other, contacts found anew would alternate with every correction.
    """
    place(bodies, pose, world)
    which, value = slots
    for k in range(which.shape[0]):
        value[k, SIZE], value[k, INSIDE] = known.value[k, SIZE], known.value[k, INSIDE]
        for i in range(which.shape[1]):
            which[k, i] = known.which[k, i]
    _measure(bodies, pose, world, pairs, slots)


@njit(cache=True, error_model="numpy")
def changed_contacts(before, after, depth):
    """Number of contacts with different features ``before`` and ``after`` whose overlap differs by
    more than ``depth`` [m]."""
    was, now = before.value, after.value
    first, last = before.which, after.which
    changed = 0
    for k in range(first.shape[0]):
        if was[k, GAP] > -depth and now[k, GAP] > -depth:
            continue
        if (
            first[k, KIND] == last[k, KIND]
            and first[k, FEATURE_A] == last[k, FEATURE_A]
            and first[k, FEATURE_B] == last[k, FEATURE_B]
        ):
            continue
        if abs(min(was[k, GAP], 0.0) - min(now[k, GAP], 0.0)) > depth:
            changed += 1
    return changed


@njit(cache=True, error_model="numpy")
def find_predecessors(pairs, previous, slots, source):
    """For every slot, the slot of the same pair whose history it inherits, or -1.

    A slot inherits from itself as long as its interface keeps its edges.  If a block rotates so far
    that another edge faces its neighbour, a contact inherits from one with which it shares a
    vertex.
    """
    pair, was, now = pairs.of_slot, previous.which, slots.which
    n = now.shape[0]
    first = 0  # slot of the pair
    for k in range(n):
        if pair[k] != pair[first]:
            first = k
        source[k] = -1
        kind = now[k, KIND]
        if kind == NONE:
            continue
        same_edges = was[k, EDGE_A] == now[k, EDGE_A] and was[k, EDGE_B] == now[k, EDGE_B]
        if was[k, KIND] != NONE and same_edges:
            source[k] = k
            continue
        j = first if k < first + ENDS else n
        while j < min(first + ENDS, n) and pair[j] == pair[k]:
            kind_before = was[j, KIND]
            vertex_a = kind_before != NONE and kind != VERTEX_B and kind_before != VERTEX_B
            vertex_b = kind_before != NONE and kind != VERTEX_A and kind_before != VERTEX_A
            same_a = was[j, FEATURE_A] == now[k, FEATURE_A]
            same_b = was[j, FEATURE_B] == now[k, FEATURE_B]
            if (same_a and vertex_a) or (same_b and vertex_b):
                source[k] = j
                break
            j += 1
