"""Narrow phase in two dimensions: the two contact points of every pair of nearby blocks.

Each candidate pair owns two slots, one for each end of the interface between its facing edges.  A
slot that is in use holds one contact between a vertex and an edge, or between two vertices:

    VERTEX_B  vertex of b on an edge of a        normal: the edge's
    VERTEX_A  vertex of a on an edge of b        normal: the edge's, reversed
    VERTICES  vertex of a and vertex of b        normal: from one to the other

With unit normal n (from a to b), tangent t = (n_y, -n_x), arms from the centroids to the vertex
(or vertices), S the quarter turn counter-clockwise, q = (x_a, theta_a, x_b, theta_b):

    grad gap  = [-n, -n.S arm_a, n, n.S arm_b]
    grad slip = ratio [-t, -t.S arm_a, t, t.S arm_b] + [0, 0, roll_a, 0, 0, roll_b]

where the roll terms are the radius of a rounded vertex, which rolls without slipping, and ratio is
1 but between two vertices, where it is (r_a + r_b) / distance.  Both are exact gradients of the
gap and of the sliding distance, so that reactions along them balance in force and in moment.

Gaps are what they are as designed and the change since, each for itself: with the design's vector
d_0 from the edge's first vertex to the vertex, and the edge's normal n_0,

    d = d_0 + D,    D = u_v - u_e + (R_v - I) l_v - (R_e - I) l_e
    n . d = n_0 . d_0 + (R_e - I) n_0 . d_0 + n . D

so that they are as precise as the displacements: a stiff joint closes by less than the rounding of
its place.  Two vertices, likewise, are |d| = |d_0| + D . (d_0 + d) / (|d_0| + |d|) apart.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drystone.kernels.contacts import (
    FIRST,
    NONE,
    PART_A,
    PART_B,
    VERTEX_A,
    VERTEX_B,
    VERTICES,
    A,
    B,
)

#: Contact points of a pair.
POINTS = 2

#: Tributary length of a contact point is at least this share of the shorter facing edge.
LEAST_SHARE = 0.01

#: Where two edges of a block are opposed to a face almost alike, the tributary length passes from
#: that of the one to that of the other, over this share of the turn from either to the corner on
#: end: 0.2 of a square corner are the angles from 37 to 53 degrees.
PASSAGE = 0.2

#: Sharp corners nearer than this share of their edges' lengths count as one.
SAME_CORNER = 1e-3

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Bodies(NamedTuple):
    """Contact shapes of all bodies; rows of vertices are edges too, from vertex i to the next."""

    centroid: Array  # (n, 2) m, as designed
    of_part: IntArray  # (n_parts,) body of each convex part
    offset: IntArray  # (n_parts + 1,) first vertex of each part
    following: IntArray  # (n_vertices,) the next vertex around the same part
    local: Array  # (n_vertices, 2) m, relative to the body's centroid
    local_tangent: Array  # (n_vertices, 2) unit vector of the edge
    length: Array  # (n_vertices,) m, of the core edge
    setback: Array  # (n_vertices, 2) m, start and end
    radius: Array  # (n_parts,) m


class World(NamedTuple):
    """Vertices and edge tangents in their present places; scratch, refilled for every pose."""

    vertex: Array  # (n_vertices, 2) m
    tangent: Array  # (n_vertices, 2)
    arm: Array  # (n_vertices, 2) m, from the centroid
    turn: Array  # (n, 2) sine and 1 - cosine of each body's rotation


@njit(cache=True)
def place(bodies, pose, world):
    """World coordinates of all core vertices and edge tangents in the given poses."""
    for part in range(bodies.of_part.shape[0]):
        body = bodies.of_part[part]
        c = np.cos(pose[body, 2])
        s = np.sin(pose[body, 2])
        world.turn[body, 0] = s
        world.turn[body, 1] = 2.0 * np.sin(0.5 * pose[body, 2]) ** 2
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


@njit(cache=True)
def _best_edge(offset, vertex, tangent, a, b):
    """Edge of a whose outward normal separates a and b most, and that separation [m]."""
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


@njit(cache=True)
def _most_opposed(offset, tangent, edge, b):
    """Edge of b whose tangent is most opposed to that of ``edge``."""
    best = np.inf
    found = offset[b]
    for j in range(offset[b], offset[b + 1]):
        d = tangent[edge, 0] * tangent[j, 0] + tangent[edge, 1] * tangent[j, 1]
        if d < best:
            best = d
            found = j
    return found


@njit(cache=True)
def _nearly_as_opposed(first, end, tangent, edge, found):
    """The edge beside ``found`` that is the more opposed to ``edge``, and its share of the length.

    The share is a half where both edges of a corner are opposed alike, and falls smoothly to zero
    where the corner has turned from there by PASSAGE of what lays one of them on ``edge``.
    ``first`` and ``end`` bound the edges of their block.
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


@njit(cache=True)
def _overlap(length, setback, vertex, tangent, ea, eb, a1, b1):
    """Half of what faces itself of the edges ``ea`` and ``eb``, which end at a1 and b1 [m]."""
    start = max(_along(vertex, tangent, ea, b1) - setback[eb, 1], -setback[ea, 0])
    end = min(_along(vertex, tangent, ea, eb) + setback[eb, 0], length[ea] + setback[ea, 1])
    return max(0.5 * (end - start), LEAST_SHARE * min(length[ea], length[eb]))


@njit(cache=True)
def _along(vertex, tangent, edge, v):
    """Coordinate of a vertex along an edge, from the edge's start [m]."""
    x = (vertex[v, 0] - vertex[edge, 0]) * tangent[edge, 0]
    return x + (vertex[v, 1] - vertex[edge, 1]) * tangent[edge, 1]


@njit(cache=True)
def _end(length, vertex, tangent, radii, ea, eb, va, vb, reference_is_a):
    """Kind and features of the contact at one end of the interface of edges ``ea`` and ``eb``.

    The vertices there are va and vb.  The one that lies within the other edge makes the contact;
    where neither does, the two face each other across a corner.  Sharp corners that do so have no
    common normal but where they all but coincide, and there it is the reference edge's.
    """
    dx = vertex[vb, 0] - vertex[va, 0]
    dy = vertex[vb, 1] - vertex[va, 1]
    sb = _along(vertex, tangent, ea, vb)
    sa = _along(vertex, tangent, eb, va)
    # Sharp corners right above each other must not miss each other by a rounding error.
    slack = 0.0 if radii > 0.0 else 1e-9 * (length[ea] + length[eb])
    b_inside = -slack <= sb <= length[ea] + slack
    a_inside = -slack <= sa <= length[eb] + slack
    if b_inside and a_inside:
        # Edges that open towards this end: the nearer of the two candidates.
        gap_b = dx * tangent[ea, 1] - dy * tangent[ea, 0]
        gap_a = -dx * tangent[eb, 1] + dy * tangent[eb, 0]
        b_inside = gap_b < gap_a or (gap_b == gap_a and reference_is_a)
    elif not b_inside and not a_inside:
        apart = dx * dx + dy * dy
        if radii > 0.0 and apart > 0.01 * radii * radii:
            return VERTICES, va, vb
        near = SAME_CORNER * (length[ea] + length[eb])
        if apart > near * near:
            return NONE, va, vb
        b_inside = reference_is_a
    if b_inside:
        return VERTEX_B, ea, vb
    return VERTEX_A, va, eb


@njit(cache=True)
def _interface(
    offset, following, length, setback, radii, vertex, tangent, k, a, b, reach,
    kinds, features, edges, lengths,
):  # fmt: skip
    """Kinds, features, edges and tributary lengths of slots k and k + 1, of bodies a and b."""
    kinds[k] = NONE
    kinds[k + 1] = NONE
    ea, apart_a = _best_edge(offset, vertex, tangent, a, b)
    if apart_a > radii + reach:
        return
    eb, apart_b = _best_edge(offset, vertex, tangent, b, a)
    if apart_b > radii + reach:
        return
    tie = 1e-9 * (length[ea] + length[eb])
    reference_is_a = apart_a >= apart_b - tie
    if reference_is_a:
        eb = _most_opposed(offset, tangent, ea, b)
    else:
        ea = _most_opposed(offset, tangent, eb, a)
    a0, a1 = ea, following[ea]
    b0, b1 = eb, following[eb]
    # Coordinates of b's vertices along a's edge; b1 faces a0 and b0 faces a1.
    s1 = _along(vertex, tangent, ea, b1)
    s0 = _along(vertex, tangent, ea, b0)
    length_a = length[ea]
    tributary = _overlap(length, setback, vertex, tangent, ea, eb, a1, b1)
    if reference_is_a:
        beside, share = _nearly_as_opposed(offset[b], offset[b + 1], tangent, ea, eb)
        pa, pb = ea, beside
    else:
        beside, share = _nearly_as_opposed(offset[a], offset[a + 1], tangent, eb, ea)
        pa, pb = beside, eb
    if share > 0.0:
        other = _overlap(length, setback, vertex, tangent, pa, pb, following[pa], following[pb])
        tributary += share * (other - tributary)
    for slot in range(k, k + 2):
        lengths[slot] = tributary
        edges[slot, 0] = ea
        edges[slot, 1] = eb
    if s1 > length_a or s0 < 0.0:  # b lies past an end of a's edge
        va = a1 if s1 > length_a else a0
        sa = _along(vertex, tangent, eb, va)
        features[k, 0] = va
        if 0.0 <= sa <= length[eb]:
            kinds[k] = VERTEX_A
            features[k, 1] = eb
        elif radii > 0.0:
            kinds[k] = VERTICES
            features[k, 1] = b0 if sa < 0.0 else b1
        return
    va, vb = a0, b1
    for slot in range(k, k + 2):
        kind, fa, fb = _end(length, vertex, tangent, radii, ea, eb, va, vb, reference_is_a)
        kinds[slot] = kind
        features[slot, 0] = fa
        features[slot, 1] = fb
        va, vb = a1, b0


@njit(cache=True)
def _turned(turn, body, x, y):
    """What the rotation of a body adds to a vector of it."""
    sine, versine = turn[body, 0], turn[body, 1]
    return -versine * x - sine * y, sine * x - versine * y


@njit(cache=True)
def _measure(bodies, pose, world, pairs, slots):
    """Everything else about the contacts of all slots, whose features are given."""
    # Fields read once: in the loop each reading would count references.
    centroid, local, radius = bodies.centroid, bodies.local, bodies.radius
    local_tangent, tangent, arm, turn = bodies.local_tangent, world.tangent, world.arm, world.turn
    pair, of_pair, kinds, features = pairs.of_slot, pairs.which, slots.kind, slots.feature
    gap, normal = slots.gap, slots.normal
    arm_a, arm_b, roll, ratio = slots.arm_a, slots.arm_b, slots.roll, slots.ratio
    for k in range(kinds.shape[0]):
        kind = kinds[k]
        if kind == NONE:
            gap[k] = np.inf
            continue
        p = pair[k]
        a, b = of_pair[p, A], of_pair[p, B]
        va, vb = features[k, 0], features[k, 1]
        # From a vertex of a, or an edge's first, to one of b; the other way on an edge of b.
        sign = -1.0 if kind == VERTEX_A else 1.0
        between_x, between_y = centroid[b, 0] - centroid[a, 0], centroid[b, 1] - centroid[a, 1]
        shift_x, shift_y = pose[b, 0] - pose[a, 0], pose[b, 1] - pose[a, 1]
        ax, ay, bx, by = local[va, 0], local[va, 1], local[vb, 0], local[vb, 1]
        turned_ax, turned_ay = _turned(turn, a, ax, ay)
        turned_bx, turned_by = _turned(turn, b, bx, by)
        x, y = sign * (between_x + (bx - ax)), sign * (between_y + (by - ay))  # as designed
        moved_x = sign * (shift_x + (turned_bx - turned_ax))
        moved_y = sign * (shift_y + (turned_by - turned_ay))
        ra, rb = radius[of_pair[p, PART_A]], radius[of_pair[p, PART_B]]
        if kind == VERTICES:
            dx, dy = x + moved_x, y + moved_y
            distance, before = np.sqrt(dx * dx + dy * dy), np.sqrt(x * x + y * y)
            grown = (moved_x * (x + dx) + moved_y * (y + dy)) / (distance + before)
            gap[k] = (before - ra - rb) + grown
            normal[k, 0], normal[k, 1] = dx / distance, dy / distance
            roll[k, 0], roll[k, 1] = ra, rb
            ratio[k] = (ra + rb) / distance
        else:
            owner, edge, rolling = (a, va, rb) if kind == VERTEX_B else (b, vb, ra)
            nx, ny = tangent[edge, 1], -tangent[edge, 0]
            before_x, before_y = local_tangent[edge, 1], -local_tangent[edge, 0]
            turned_x, turned_y = _turned(turn, owner, before_x, before_y)
            designed = before_x * x + before_y * y - ra - rb
            gap[k] = designed + ((turned_x * x + turned_y * y) + (nx * moved_x + ny * moved_y))
            normal[k, 0], normal[k, 1] = sign * nx, sign * ny
            roll[k, 0], roll[k, 1] = -sign * rolling, sign * rolling
            ratio[k] = 1.0
        ax, ay, bx, by = arm[va, 0], arm[va, 1], arm[vb, 0], arm[vb, 1]
        if kind == VERTEX_B:
            ax, ay = between_x + shift_x + bx, between_y + shift_y + by
        elif kind == VERTEX_A:
            bx, by = ax - (between_x + shift_x), ay - (between_y + shift_y)
        arm_a[k, 0], arm_a[k, 1], arm_b[k, 0], arm_b[k, 1] = ax, ay, bx, by


@njit(cache=True)
def find_contacts(bodies, pose, world, pairs, reach, slots):
    """Fill the slots of all pairs in the given poses; ``reach`` [m] is the largest gap watched."""
    place(bodies, pose, world)
    # Fields read once: in the loop each reading would count references.
    offset, following, length = bodies.offset, bodies.following, bodies.length
    setback, radius = bodies.setback, bodies.radius
    vertex, tangent = world.vertex, world.tangent
    kinds, features, edges, lengths = slots.kind, slots.feature, slots.edges, slots.length
    of_pair = pairs.which
    for p in range(of_pair.shape[0]):
        a = of_pair[p, PART_A]
        b = of_pair[p, PART_B]
        _interface(
            offset, following, length, setback, radius[a] + radius[b], vertex, tangent,
            of_pair[p, FIRST], a, b, reach, kinds, features, edges, lengths,
        )  # fmt: skip
    _measure(bodies, pose, world, pairs, slots)
    for k in range(slots.kind.shape[0]):
        if slots.gap[k] > reach:
            slots.kind[k] = NONE


@njit(cache=True)
def follow_contacts(bodies, pose, world, pairs, known, slots):
    """Fill the slots in new poses with the features that ``known`` slots have.

    Within a step this is cheaper than finding contacts anew, and smooth: where two vertices pass
    each other, features would otherwise change to and fro with every correction.
    """
    place(bodies, pose, world)
    for k in range(known.kind.shape[0]):
        slots.kind[k] = known.kind[k]
        slots.length[k] = known.length[k]
        for i in range(2):
            slots.feature[k, i] = known.feature[k, i]
            slots.edges[k, i] = known.edges[k, i]
    _measure(bodies, pose, world, pairs, slots)


@njit(cache=True)
def changed_contacts(before, after, depth):
    """Number of contacts that press more than ``depth`` [m] and are not the same in both."""
    changed = 0
    for k in range(before.kind.shape[0]):
        if before.gap[k] > -depth and after.gap[k] > -depth:
            continue
        if (
            before.kind[k] == after.kind[k]
            and before.feature[k, 0] == after.feature[k, 0]
            and before.feature[k, 1] == after.feature[k, 1]
        ):
            continue
        if abs(min(before.gap[k], 0.0) - min(after.gap[k], 0.0)) > depth:
            changed += 1
    return changed


@njit(cache=True)
def find_predecessors(pairs, previous, slots, source):
    """For every slot, the slot of the same pair whose history it goes on with, or -1.

    A slot goes on with itself while its interface keeps its edges.  When a block turns so far
    that another edge faces its neighbour, the contact that shares a vertex goes on.
    """
    pair, kind, feature, edges = pairs.of_slot, slots.kind, slots.feature, slots.edges
    was, were, along = previous.kind, previous.feature, previous.edges
    n = kind.shape[0]
    first = 0  # slot of the pair
    for k in range(n):
        if pair[k] != pair[first]:
            first = k
        source[k] = -1
        if kind[k] == NONE:
            continue
        if was[k] != NONE and along[k, 0] == edges[k, 0] and along[k, 1] == edges[k, 1]:
            source[k] = k
            continue
        j = first
        while j < n and pair[j] == pair[k]:
            vertex_a = was[j] != NONE and kind[k] != VERTEX_B and was[j] != VERTEX_B
            vertex_b = was[j] != NONE and kind[k] != VERTEX_A and was[j] != VERTEX_A
            same_a, same_b = were[j, 0] == feature[k, 0], were[j, 1] == feature[k, 1]
            if (same_a and vertex_a) or (same_b and vertex_b):
                source[k] = j
                break
            j += 1
