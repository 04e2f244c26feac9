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
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

NONE, VERTEX_B, VERTEX_A, VERTICES = 0, 1, 2, 3

#: Tributary length of a contact point is at least this share of the shorter facing edge.
LEAST_SHARE = 0.01

#: Sharp corners nearer than this share of their edges' lengths count as one.
SAME_CORNER = 1e-3

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Bodies(NamedTuple):
    """Contact shapes of all bodies; rows of vertices are edges too, from vertex i to the next."""

    centroid: Array  # (n, 2) m, as designed
    offset: IntArray  # (n + 1,) first vertex of each body
    following: IntArray  # (n_vertices,) the next vertex around the same body
    owner: IntArray  # (n_vertices,)
    local: Array  # (n_vertices, 2) m, relative to the centroid
    local_tangent: Array  # (n_vertices, 2) unit vector of the edge
    length: Array  # (n_vertices,) m, of the core edge
    setback: Array  # (n_vertices, 2) m, start and end
    radius: Array  # (n,) m


class World(NamedTuple):
    """Vertices and edge tangents in their present places; scratch, refilled for every pose."""

    vertex: Array  # (n_vertices, 2) m
    tangent: Array  # (n_vertices, 2)


class Slots(NamedTuple):
    """Contacts of all candidate pairs, slot ``2 p + end`` for pair ``p``."""

    kind: IntArray  # (n_slots,)
    feature: IntArray  # (n_slots, 2) vertex or edge (by its first vertex) of a and of b
    edges: IntArray  # (n_slots, 2) the facing edges of a and of b
    gap: Array  # (n_slots,) m, positive open
    normal: Array  # (n_slots, 2)
    arm_a: Array  # (n_slots, 2) m
    arm_b: Array  # (n_slots, 2) m
    roll: Array  # (n_slots, 2) m, roll_a and roll_b
    ratio: Array  # (n_slots,)
    length: Array  # (n_slots,) m, tributary length of joint


@njit(cache=True)
def place(bodies, pose, world):
    """World coordinates of all core vertices and edge tangents in the given poses."""
    for body in range(bodies.centroid.shape[0]):
        c = np.cos(pose[body, 2])
        s = np.sin(pose[body, 2])
        x = bodies.centroid[body, 0] + pose[body, 0]
        y = bodies.centroid[body, 1] + pose[body, 1]
        for v in range(bodies.offset[body], bodies.offset[body + 1]):
            lx = bodies.local[v, 0]
            ly = bodies.local[v, 1]
            world.vertex[v, 0] = x + c * lx - s * ly
            world.vertex[v, 1] = y + s * lx + c * ly
            tx = bodies.local_tangent[v, 0]
            ty = bodies.local_tangent[v, 1]
            world.tangent[v, 0] = c * tx - s * ty
            world.tangent[v, 1] = s * tx + c * ty


@njit(cache=True, inline="always")
def _best_edge(bodies, world, a, b):
    """Edge of a whose outward normal separates a and b most, and that separation [m]."""
    best = -np.inf
    edge = bodies.offset[a]
    for i in range(bodies.offset[a], bodies.offset[a + 1]):
        nx = world.tangent[i, 1]
        ny = -world.tangent[i, 0]
        base = nx * world.vertex[i, 0] + ny * world.vertex[i, 1]
        least = np.inf
        for j in range(bodies.offset[b], bodies.offset[b + 1]):
            d = nx * world.vertex[j, 0] + ny * world.vertex[j, 1] - base
            if d < least:
                least = d
        if least > best:
            best = least
            edge = i
    return edge, best


@njit(cache=True, inline="always")
def _most_opposed(bodies, world, edge, b):
    """Edge of b whose tangent is most opposed to that of ``edge``."""
    best = np.inf
    found = bodies.offset[b]
    for j in range(bodies.offset[b], bodies.offset[b + 1]):
        d = (
            world.tangent[edge, 0] * world.tangent[j, 0]
            + world.tangent[edge, 1] * world.tangent[j, 1]
        )
        if d < best:
            best = d
            found = j
    return found


@njit(cache=True, inline="always")
def _centre(bodies, pose, body):
    return bodies.centroid[body, 0] + pose[body, 0], bodies.centroid[body, 1] + pose[body, 1]


@njit(cache=True, inline="always")
def _along(world, edge, vertex):
    """Coordinate of a vertex along an edge, from the edge's start [m]."""
    return (world.vertex[vertex, 0] - world.vertex[edge, 0]) * world.tangent[edge, 0] + (
        world.vertex[vertex, 1] - world.vertex[edge, 1]
    ) * world.tangent[edge, 1]


@njit(cache=True, inline="always")
def _arms(bodies, pose, world, slots, k, a, b, va, vb):
    ax, ay = _centre(bodies, pose, a)
    bx, by = _centre(bodies, pose, b)
    slots.arm_a[k, 0] = world.vertex[va, 0] - ax
    slots.arm_a[k, 1] = world.vertex[va, 1] - ay
    slots.arm_b[k, 0] = world.vertex[vb, 0] - bx
    slots.arm_b[k, 1] = world.vertex[vb, 1] - by


@njit(cache=True, inline="always")
def _vertex_on_edge(bodies, pose, world, slots, k, a, b, kind, fa, fb):
    """Fill slot k with a vertex against an edge; ``fa`` and ``fb`` are the features of a and b."""
    if kind == VERTEX_B:
        vertex, edge, sign, rolling = fb, fa, 1.0, bodies.radius[b]
        slots.roll[k, 0] = -rolling
        slots.roll[k, 1] = rolling
    else:
        vertex, edge, sign, rolling = fa, fb, -1.0, bodies.radius[a]
        slots.roll[k, 0] = rolling
        slots.roll[k, 1] = -rolling
    nx = world.tangent[edge, 1]
    ny = -world.tangent[edge, 0]
    slots.kind[k] = kind
    slots.feature[k, 0] = fa
    slots.feature[k, 1] = fb
    slots.gap[k] = (
        nx * (world.vertex[vertex, 0] - world.vertex[edge, 0])
        + ny * (world.vertex[vertex, 1] - world.vertex[edge, 1])
        - bodies.radius[a]
        - bodies.radius[b]
    )
    slots.normal[k, 0] = sign * nx
    slots.normal[k, 1] = sign * ny
    slots.ratio[k] = 1.0
    _arms(bodies, pose, world, slots, k, a, b, vertex, vertex)


@njit(cache=True, inline="always")
def _vertex_on_vertex(bodies, pose, world, slots, k, a, b, va, vb):
    """Fill slot k with two rounded vertices."""
    dx = world.vertex[vb, 0] - world.vertex[va, 0]
    dy = world.vertex[vb, 1] - world.vertex[va, 1]
    distance = np.sqrt(dx * dx + dy * dy)
    slots.kind[k] = VERTICES
    slots.feature[k, 0] = va
    slots.feature[k, 1] = vb
    slots.gap[k] = distance - bodies.radius[a] - bodies.radius[b]
    slots.normal[k, 0] = dx / distance
    slots.normal[k, 1] = dy / distance
    slots.roll[k, 0] = bodies.radius[a]
    slots.roll[k, 1] = bodies.radius[b]
    slots.ratio[k] = (bodies.radius[a] + bodies.radius[b]) / distance
    _arms(bodies, pose, world, slots, k, a, b, va, vb)


@njit(cache=True)
def _end(bodies, pose, world, slots, k, a, b, ea, eb, va, vb, reference_is_a):
    """One end of the interface of edges ``ea`` and ``eb``, whose vertices there are va and vb.

    The vertex that lies within the other edge makes the contact; where neither does, the two
    vertices face each other across a corner.  Sharp corners that do so have no common normal but
    where they all but coincide, and there it is the reference edge's.
    """
    dx = world.vertex[vb, 0] - world.vertex[va, 0]
    dy = world.vertex[vb, 1] - world.vertex[va, 1]
    sb = _along(world, ea, vb)
    sa = _along(world, eb, va)
    # Sharp corners right above each other must not miss each other by a rounding error.
    rounded = bodies.radius[a] + bodies.radius[b] > 0.0
    slack = 0.0 if rounded else 1e-9 * (bodies.length[ea] + bodies.length[eb])
    b_inside = -slack <= sb <= bodies.length[ea] + slack
    a_inside = -slack <= sa <= bodies.length[eb] + slack
    if b_inside and a_inside:
        # Edges that open towards this end: the nearer of the two candidates.
        gap_b = dx * world.tangent[ea, 1] - dy * world.tangent[ea, 0]
        gap_a = -dx * world.tangent[eb, 1] + dy * world.tangent[eb, 0]
        b_inside = gap_b < gap_a or (gap_b == gap_a and reference_is_a)
    elif not b_inside and not a_inside:
        radii = bodies.radius[a] + bodies.radius[b]
        apart = dx * dx + dy * dy
        if radii > 0.0 and apart > 0.01 * radii * radii:
            _vertex_on_vertex(bodies, pose, world, slots, k, a, b, va, vb)
            return
        near = SAME_CORNER * (bodies.length[ea] + bodies.length[eb])
        if apart > near * near:
            return
        b_inside = reference_is_a
    if b_inside:
        _vertex_on_edge(bodies, pose, world, slots, k, a, b, VERTEX_B, ea, vb)
    else:
        _vertex_on_edge(bodies, pose, world, slots, k, a, b, VERTEX_A, va, eb)


@njit(cache=True)
def _interface(bodies, pose, world, slots, p, a, b, reach):
    """Both slots of pair p."""
    k = 2 * p
    slots.kind[k] = NONE
    slots.kind[k + 1] = NONE
    slots.gap[k] = np.inf
    slots.gap[k + 1] = np.inf
    radii = bodies.radius[a] + bodies.radius[b]
    ea, apart_a = _best_edge(bodies, world, a, b)
    if apart_a > radii + reach:
        return
    eb, apart_b = _best_edge(bodies, world, b, a)
    if apart_b > radii + reach:
        return
    tie = 1e-9 * (bodies.length[ea] + bodies.length[eb])
    reference_is_a = apart_a >= apart_b - tie
    if reference_is_a:
        eb = _most_opposed(bodies, world, ea, b)
    else:
        ea = _most_opposed(bodies, world, eb, a)
    a0, a1 = ea, bodies.following[ea]
    b0, b1 = eb, bodies.following[eb]
    # Coordinates of b's vertices along a's edge; b1 faces a0 and b0 faces a1.
    s1 = _along(world, ea, b1)
    s0 = _along(world, ea, b0)
    length_a = bodies.length[ea]
    start = s1 - bodies.setback[eb, 1] if s1 > 0.0 else -bodies.setback[ea, 0]
    end = s0 + bodies.setback[eb, 0] if s0 < length_a else length_a + bodies.setback[ea, 1]
    least = LEAST_SHARE * min(length_a, bodies.length[eb])
    half = max(0.5 * (end - start), least)
    if s1 > length_a or s0 < 0.0:  # b lies past an end of a's edge
        va = a1 if s1 > length_a else a0
        sa = _along(world, eb, va)
        if 0.0 <= sa <= bodies.length[eb]:
            _vertex_on_edge(bodies, pose, world, slots, k, a, b, VERTEX_A, va, eb)
        elif radii > 0.0:
            _vertex_on_vertex(bodies, pose, world, slots, k, a, b, va, b0 if sa < 0.0 else b1)
        else:
            return
        slots.length[k] = half
        slots.edges[k, 0] = ea
        slots.edges[k, 1] = eb
        if slots.gap[k] > reach:
            slots.kind[k] = NONE
        return
    _end(bodies, pose, world, slots, k, a, b, ea, eb, a0, b1, reference_is_a)
    _end(bodies, pose, world, slots, k + 1, a, b, ea, eb, a1, b0, reference_is_a)
    for end_slot in range(k, k + 2):
        slots.length[end_slot] = half
        slots.edges[end_slot, 0] = ea
        slots.edges[end_slot, 1] = eb
        if slots.gap[end_slot] > reach:
            slots.kind[end_slot] = NONE


@njit(cache=True)
def find_contacts(bodies, pose, world, pair_a, pair_b, reach, slots):
    """Fill the slots of all pairs in the given poses; ``reach`` [m] is the largest gap watched."""
    place(bodies, pose, world)
    for p in range(pair_a.shape[0]):
        _interface(bodies, pose, world, slots, p, pair_a[p], pair_b[p], reach)


@njit(cache=True)
def follow_contacts(bodies, pose, world, pair_a, pair_b, known, slots):
    """Fill the slots in new poses with the features that ``known`` slots have.

    Within a step this is cheaper than finding contacts anew, and smooth: where two vertices pass
    each other, features would otherwise change to and fro with every correction.
    """
    place(bodies, pose, world)
    for k in range(known.kind.shape[0]):
        kind = known.kind[k]
        slots.kind[k] = kind
        slots.length[k] = known.length[k]
        slots.edges[k, 0] = known.edges[k, 0]
        slots.edges[k, 1] = known.edges[k, 1]
        if kind == NONE:
            slots.gap[k] = np.inf
            continue
        a = pair_a[k // 2]
        b = pair_b[k // 2]
        fa = known.feature[k, 0]
        fb = known.feature[k, 1]
        if kind == VERTICES:
            _vertex_on_vertex(bodies, pose, world, slots, k, a, b, fa, fb)
        else:
            _vertex_on_edge(bodies, pose, world, slots, k, a, b, kind, fa, fb)


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
def carry_history(previous_kind, previous_feature, previous_edges, slots, source):
    """For every slot, the slot of the same pair whose history it goes on with, or -1.

    A slot goes on with itself while its interface keeps its edges.  When a block turns so far
    that another edge faces its neighbour, the contact that shares a vertex goes on.
    """
    for p in range(slots.kind.shape[0] // 2):
        for k in range(2 * p, 2 * p + 2):
            source[k] = -1
            if slots.kind[k] == NONE:
                continue
            if (
                previous_kind[k] != NONE
                and previous_edges[k, 0] == slots.edges[k, 0]
                and previous_edges[k, 1] == slots.edges[k, 1]
            ):
                source[k] = k
                continue
            for j in range(2 * p, 2 * p + 2):
                if previous_kind[j] == NONE:
                    continue
                same_a = previous_feature[j, 0] == slots.feature[k, 0]
                same_b = previous_feature[j, 1] == slots.feature[k, 1]
                vertex_a = slots.kind[k] != VERTEX_B and previous_kind[j] != VERTEX_B
                vertex_b = slots.kind[k] != VERTEX_A and previous_kind[j] != VERTEX_A
                if (same_a and vertex_a) or (same_b and vertex_b):
                    source[k] = j
                    break
