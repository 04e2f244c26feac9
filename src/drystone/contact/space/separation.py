"""The separation of two convex parts, along the normals of their faces and across their edges.

This is the method of separating axes: the separation of convex bodies is the largest separation
along any axis.  If a vertex or an edge meets a face, the axis is the normal of the face.  If two
edges cross, the axis is the cross product of their directions, provided that the planes normal to
it support both bodies there.  They do if the arcs between the normals of the edges' faces cross on
the unit sphere, with the normals of one body reversed.

Rounded bodies may also be nearest to each other at other features.  Then the nearest points of all
edges are looked for.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import ON_NORMAL, PARALLEL, SUMS


@njit(cache=True)
def separation(first, ring, corner, vertex, normal, face, q):
    """Distance [m] of part q from the plane of a ``face`` of another part; negative if it reaches
    below."""
    nx, ny, nz = normal[face, 0], normal[face, 1], normal[face, 2]
    least = np.inf
    for j in range(first[q, 0], first[q + 1, 0]):
        least = min(least, nx * vertex[j, 0] + ny * vertex[j, 1] + nz * vertex[j, 2])
    v = corner[ring[face], 0]
    return least - (nx * vertex[v, 0] + ny * vertex[v, 1] + nz * vertex[v, 2])


@njit(cache=True)
def best_face(first, ring, corner, vertex, normal, middle, p, q, kept, limit):
    """Face of part p that separates it most from part q, and its separation [m].

    The third result is the separation of the face ``kept``, or minus infinity if p has no such
    face.  A separation beyond ``limit`` [m] ends the search.  ``middle`` (n_parts, 3) [m] is a
    point within each part.  It allows to skip faces: part q is no farther from a face than its
    middle.
    """
    best, found, of_kept = -np.inf, first[p, 1], -np.inf
    mx, my, mz = middle[q, 0], middle[q, 1], middle[q, 2]
    for f in range(first[p, 1], first[p + 1, 1]):
        nx, ny, nz = normal[f, 0], normal[f, 1], normal[f, 2]
        v = corner[ring[f], 0]
        base = nx * vertex[v, 0] + ny * vertex[v, 1] + nz * vertex[v, 2]
        if nx * mx + ny * my + nz * mz - base <= best and f != kept:
            continue
        least = separation(first, ring, corner, vertex, normal, f, q)
        if f == kept:
            of_kept = least
        if least > best:
            best, found = least, f
            if best > limit:
                break
    return found, best, of_kept


@njit(cache=True)
def most_opposed(first, normal, face, q, kept, slack):
    """Face of part q whose normal is most opposed to that of ``face``, and the scalar product of
    the normals.

    The face ``kept`` of q is returned if its scalar product is worse by no more than ``slack``.
    """
    nx, ny, nz = normal[face, 0], normal[face, 1], normal[face, 2]
    best, found, of_kept = np.inf, first[q, 1], np.inf
    for f in range(first[q, 1], first[q + 1, 1]):
        d = nx * normal[f, 0] + ny * normal[f, 1] + nz * normal[f, 2]
        if f == kept:
            of_kept = d
        if d < best - SUMS:
            best, found = d, f
    if of_kept <= best + slack:
        return kept, of_kept
    return found, best


@njit(cache=True)
def most_opposed_near(first, ring, corner, vertex, normal, face, q, deepest):
    """The same as `most_opposed`, among those faces of q that have a vertex no higher than
    ``deepest`` [m] above the plane of ``face``."""
    nx, ny, nz = normal[face, 0], normal[face, 1], normal[face, 2]
    v = corner[ring[face], 0]
    base = nx * vertex[v, 0] + ny * vertex[v, 1] + nz * vertex[v, 2]
    best, found = np.inf, first[q, 1]
    for f in range(first[q, 1], first[q + 1, 1]):
        d = nx * normal[f, 0] + ny * normal[f, 1] + nz * normal[f, 2]
        if d >= best - SUMS:
            continue
        for c in range(ring[f], ring[f + 1]):
            v = corner[c, 0]
            h = nx * vertex[v, 0] + ny * vertex[v, 1] + nz * vertex[v, 2] - base
            if h <= deepest:
                best, found = d, f
                break
    return found, best


@njit(cache=True)
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def distance(vertex, a0, a1, b0, b1, shares):
    """Distance [m] of two points at ``shares`` (2,) of the segments a0-a1 and b0-b1."""
    apart = 0.0
    for c in range(3):
        u, v = vertex[a1, c] - vertex[a0, c], vertex[b1, c] - vertex[b0, c]
        apart += (vertex[a0, c] - vertex[b0, c] + shares[0] * u - shares[1] * v) ** 2
    return np.sqrt(apart)


@njit(cache=True)
def nearest_on_lines(vertex, a0, a1, b0, b1, out):
    """Fill ``out`` (2,) with the shares of two segments at their nearest points; returns the
    distance of these points [m].

    Parallel segments get points in the middle of where they face each other.
    """
    aa, bb, ab, ad, bd = 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(3):
        u, v = vertex[a1, c] - vertex[a0, c], vertex[b1, c] - vertex[b0, c]
        w = vertex[a0, c] - vertex[b0, c]
        aa += u * u
        bb += v * v
        ab += u * v
        ad += u * w
        bd += v * w
    det = aa * bb - ab * ab
    if det > PARALLEL * PARALLEL * aa * bb:
        s = min(max((ab * bd - bb * ad) / det, 0.0), 1.0)
    else:  # b's ends along a
        s0, s1 = -ad / aa, (ab - ad) / aa
        s = 0.5 * (min(max(s0, 0.0), 1.0) + min(max(s1, 0.0), 1.0))
    t = min(max((ab * s + bd) / bb, 0.0), 1.0)
    s = min(max((ab * t - ad) / aa, 0.0), 1.0)
    t = min(max((ab * s + bd) / bb, 0.0), 1.0)
    out[0], out[1] = s, t
    return distance(vertex, a0, a1, b0, b1, out)


@njit(cache=True)
def best_edges(first, edge, vertex, normal, p, q, work):
    """Edges of p and q that cross and separate the parts most, and their separation [m].

    ``work`` (5, 3) is scratch memory.  On return its first row is the axis from p to q, and the
    second row has the shares of both edges.  The separation is minus infinity if the edges would
    meet beyond an end.
    """
    axis, shares, u, v, found = work[0], work[1], work[2], work[3], work[4]
    best, edge_p, edge_q = -np.inf, -1, -1
    for i in range(first[p, 2], first[p + 1, 2]):
        a0, a1 = edge[i, 0], edge[i, 1]
        na, nb = normal[edge[i, 2]], normal[edge[i, 3]]
        for c in range(3):
            u[c] = vertex[a1, c] - vertex[a0, c]
        for j in range(first[q, 2], first[q + 1, 2]):
            nc, nd = normal[edge[j, 2]], normal[edge[j, 3]]
            # Arcs na-nb and (-nc)-(-nd): each edge has the direction of the cross product of its
            # two normals.
            c_side, d_side = _dot(nc, u), _dot(nd, u)
            if c_side * d_side >= 0.0:
                continue
            b0, b1 = edge[j, 0], edge[j, 1]
            for c in range(3):
                v[c] = vertex[b1, c] - vertex[b0, c]
            a_side, b_side = _dot(na, v), _dot(nb, v)
            if a_side * b_side >= 0.0 or c_side * b_side >= 0.0:
                continue
            _cross(u, v, found)
            size = np.sqrt(_dot(found, found))
            if size <= PARALLEL * np.sqrt(_dot(u, u) * _dot(v, v)):
                continue
            if _dot(found, na) + _dot(found, nb) < 0.0:
                size = -size
            apart = 0.0
            for c in range(3):
                found[c] /= size
                apart += found[c] * (vertex[b0, c] - vertex[a0, c])
            if apart > best:
                best, edge_p, edge_q = apart, i, j
                for c in range(3):
                    axis[c] = found[c]
    if edge_p >= 0:
        a0, a1, b0, b1 = edge[edge_p, 0], edge[edge_p, 1], edge[edge_q, 0], edge[edge_q, 1]
        apart = nearest_on_lines(vertex, a0, a1, b0, b1, shares)
        if apart > abs(best) + ON_NORMAL * np.sqrt(_dot(u, u)):
            return edge_p, edge_q, -np.inf
    return edge_p, edge_q, best


@njit(cache=True)
def toward(vertex, a0, a1, b0, b1, shares, axis):
    """Fill ``axis`` (3,) with the unit vector from a point of segment a0-a1 to a point of segment
    b0-b1, at ``shares`` (2,) of the segments; the points must not coincide."""
    size = distance(vertex, a0, a1, b0, b1, shares)
    for c in range(3):
        of_a = vertex[a0, c] + shares[0] * (vertex[a1, c] - vertex[a0, c])
        of_b = vertex[b0, c] + shares[1] * (vertex[b1, c] - vertex[b0, c])
        axis[c] = (of_b - of_a) / size


@njit(cache=True)
def nearest_edges(first, edge, vertex, p, q, work):
    """Edges of p and q that are nearest to each other, and their distance [m].

    ``work`` (5, 3) is scratch memory.  On return its first row is the unit vector from the point of
    p to that of q, if they do not coincide, and the second row has the shares of both edges.
    """
    axis, shares, trial = work[0], work[1], work[4]
    best, edge_p, edge_q = np.inf, -1, -1
    for i in range(first[p, 2], first[p + 1, 2]):
        for j in range(first[q, 2], first[q + 1, 2]):
            a0, a1, b0, b1 = edge[i, 0], edge[i, 1], edge[j, 0], edge[j, 1]
            apart = nearest_on_lines(vertex, a0, a1, b0, b1, trial)
            if apart < best:
                best, edge_p, edge_q = apart, i, j
                shares[0], shares[1] = trial[0], trial[1]
    if best > 0.0 and edge_p >= 0:
        a0, a1, b0, b1 = edge[edge_p, 0], edge[edge_p, 1], edge[edge_q, 0], edge[edge_q, 1]
        toward(vertex, a0, a1, b0, b1, shares, axis)
    return edge_p, edge_q, best
