"""LU of matrices made of one dense block per body and two per pair of bodies.

Nested dissection orders the bodies; the multifrontal method eliminates them in fronts, groups of
bodies in one dense matrix with the later ones they are joined to.  Rows are exchanged only inside
a body's own block, so that all but the numbers is found once per list of pairs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Columns of `Structure.fronts`.  Of the first four a front ends where the next one begins.
FIRST, BORDER, ENTRY, PANEL, UPDATE, N_RUNS, CHILD, SIBLING = range(8)
#: Time a front takes [ns]: each, per entry, per product; rough, as the best is flat.
COST = (100.0, 0.5, 0.04)


class Structure(NamedTuple):
    """Order of elimination and pattern of the factors, for one list of pairs."""

    order: IntArray  # (n,) bodies as they are eliminated, then the fixed ones
    fronts: IntArray  # (n_fronts + 1, 8) offsets and tree; a front comes after those below it
    border: IntArray  # later bodies that fronts are joined to
    runs: IntArray  # (n_border, 3) place in a border, place in the front above, and how many
    entries: IntArray  # (n_entries, 4) pair, places of its bodies in the front, whether a is first
    dof: tuple[int, ...]  # as long as a body has degrees of freedom, which compilers so know


class Factors(NamedTuple):
    """Memory of A = (L + D) (I + U), D being blocks on the diagonal, and of finding it."""

    panels: Array  # of each front its bodies' rows of L, D and U, then L below them, transposed
    inverse: Array  # (n_movable, n_dof, n_dof) of D
    work: Array


@njit(cache=True)
def neighbours(n, row, a, b):
    """Movable neighbours of each of ``n`` movable bodies, and pairs they are neighbours by."""
    start = np.zeros(n + 1, np.int64)
    for p in range(a.shape[0]):
        if row[a[p]] >= 0 and row[b[p]] >= 0:
            start[row[a[p]] + 1] += 1
            start[row[b[p]] + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    other = np.empty(start[n], np.int64)
    pair = np.empty(start[n], np.int64)
    cursor = start.copy()
    for p in range(a.shape[0]):
        i, j = row[a[p]], row[b[p]]
        if i >= 0 and j >= 0:
            other[cursor[i]], pair[cursor[i]] = j, p
            other[cursor[j]], pair[cursor[j]] = i, p
            cursor[i] += 1
            cursor[j] += 1
    return start, other, pair


@njit(cache=True)
def best_cut(start, other, part, line, side, across):
    """Where to cut a ``line`` of bodies such that the fewest are joined to the other side.

    Returns that number, larger for unequal halves, how many bodies come before the cut, and the
    side they are on.
    """
    m = line.shape[0]
    best, cut, edge = np.inf, 0, 0
    for v in line:
        side[v] = 1
        across[v] = 0
    edge0 = edge1 = 0  # bodies of each side that are joined to the other
    for i in range(m - 1):
        v = line[i]
        ahead = 0
        for e in range(start[v], start[v + 1]):
            u = other[e]
            if part[u] != part[v]:
                continue
            if side[u] == 0:
                across[u] -= 1
                edge0 -= across[u] == 0
            else:
                edge1 += across[u] == 0
                across[u] += 1
                ahead += 1
        edge1 -= across[v] > 0
        edge0 += ahead > 0
        side[v], across[v] = 0, ahead
        if m <= 3 * (i + 1) <= 2 * m:
            size = min(edge0, edge1) * (1.0 + abs(2.0 * (i + 1) / m - 1.0))
            if size < best:
                best, cut, edge = size, i + 1, int(edge1 < edge0)
    return best, cut, edge


@njit(cache=True)
def dissect(start, other, lines):
    """Order of elimination: halves, then the bodies between them, and so on inside the halves.

    ``lines`` (dim, n) hold the bodies sorted by each coordinate, and are rearranged.
    """
    dim, n = lines.shape
    part = np.zeros(n, np.int64)
    side = np.empty(n, np.int64)
    across = np.empty(n, np.int64)
    sorted_part = np.empty(n, np.int64)
    todo = np.empty((n + 1, 2), np.int64)
    todo[0, 0], todo[0, 1] = 0, n
    count = np.empty(3, np.int64)
    cursor = np.empty(3, np.int64)
    n_todo, n_parts = 1, 0
    while n_todo > 0:
        n_todo -= 1
        lo, hi = todo[n_todo, 0], todo[n_todo, 1]
        if hi - lo < 3:
            continue
        best, axis, cut, edge = np.inf, 0, 0, 0
        for d in range(dim):
            size, at, keep = best_cut(start, other, part, lines[d, lo:hi], side, across)
            if size < best:
                best, axis, cut, edge = size, d, at, keep
        for i in range(lo, hi):
            side[lines[axis, i]] = int(i >= lo + cut)
        count[0] = count[1] = count[2] = 0
        for i in range(lo, hi):
            v = lines[axis, i]
            if side[v] == edge:
                for e in range(start[v], start[v + 1]):
                    if part[other[e]] == part[v] and side[other[e]] == 1 - edge:
                        side[v] = 2
                        break
            count[side[v]] += 1
        middle, end = lo + count[0], lo + count[0] + count[1]
        n_parts += 3
        for d in range(dim):
            cursor[0], cursor[1], cursor[2] = lo, middle, end
            for i in range(lo, hi):
                v = lines[d, i]
                sorted_part[cursor[side[v]]] = v
                cursor[side[v]] += 1
                part[v] = n_parts + side[v]
            for i in range(lo, hi):
                lines[d, i] = sorted_part[i]
        todo[n_todo, 0], todo[n_todo, 1] = lo, middle
        todo[n_todo + 1, 0], todo[n_todo + 1, 1] = middle, end
        n_todo += 2
    return lines[0]


@njit(cache=True)
def elimination_tree(start, other, order):
    """First later place that each place is joined to in the factors, or -1, and how many."""
    n = order.shape[0]
    position = np.empty(n, np.int64)
    for i in range(n):
        position[order[i]] = i
    parent = np.full(n, -1, np.int64)
    seen = np.full(n, -1, np.int64)
    count = np.zeros(n, np.int64)
    for i in range(n):
        seen[i] = i
        for e in range(start[order[i]], start[order[i] + 1]):
            k = position[other[e]]
            while k < i and seen[k] != i:
                if parent[k] == -1:
                    parent[k] = i
                seen[k] = i
                count[k] += 1
                k = parent[k]
    return parent, count


@njit(cache=True)
def cost(w, r, nd):
    """Time [ns] of a front of ``w`` bodies joined to ``r`` later ones."""
    p, m = nd * w, nd * (w + r)
    return COST[0] + COST[1] * m * m + COST[2] * p * (m * (m - p) + p * p / 3.0)


@njit(cache=True)
def gather_fronts(parent, count, nd):
    """Join bodies to the front above where that saves time, and number the fronts.

    Returns the front of each place, and of each front its last place and its depth.
    """
    n = parent.shape[0]
    width = np.ones(n, np.int64)
    last = np.arange(n)  # of the front that a place is in
    child = np.full(n, -1, np.int64)
    sibling = np.full(n, -1, np.int64)
    n_fronts = n
    for j in range(n):
        k, child[j] = child[j], -1
        while k != -1:
            following = sibling[k]
            apart = cost(width[k], count[k], nd) + cost(width[j], count[j], nd)
            if cost(width[k] + width[j], count[j], nd) <= apart:
                last[k] = j
                width[j] += width[k]
                n_fronts -= 1
                c = child[k]
                while c != -1:
                    after = sibling[c]
                    sibling[c], child[j] = child[j], c
                    c = after
            else:
                sibling[k], child[j] = child[j], k
            k = following
        if parent[j] != -1:
            sibling[j], child[parent[j]] = child[parent[j]], j
    front = np.empty(n, np.int64)
    top = np.empty(n_fronts, np.int64)
    depth = np.empty(n_fronts, np.int64)
    stack = np.empty(n, np.int64)
    s = 0
    for root in range(n):
        if parent[root] != -1:
            continue
        stack[0] = root
        height = 1
        while height > 0:
            j = stack[height - 1]
            if child[j] != -1:
                stack[height] = child[j]
                height += 1
                child[j] = sibling[child[j]]
            else:
                height -= 1
                front[j], top[s], depth[s] = s, j, height
                s += 1
    for j in range(n - 1, -1, -1):
        front[j] = front[last[j]]
    return front, top, depth


@njit(cache=True)
def symbolic(start, other, pair, order, row_a, nd, parent, count, front, top, depth):
    """The parts of a `Structure`, bodies being rows among the movable ones."""
    n = order.shape[0]
    n_fronts = top.shape[0]
    fronts = np.zeros((n_fronts + 1, 8), np.int64)
    for s in range(n_fronts):
        fronts[s, CHILD] = fronts[s, SIBLING] = -1
    for j in range(n):
        fronts[front[j] + 1, FIRST] += 1
    for s in range(n_fronts):
        fronts[s + 1, FIRST] += fronts[s, FIRST]
    cursor = fronts[:, FIRST].copy()
    eliminated = np.empty(n, np.int64)
    position = np.empty(n, np.int64)
    for j in range(n):
        position[order[j]] = cursor[front[j]]
        eliminated[cursor[front[j]]] = order[j]
        cursor[front[j]] += 1

    n_border = 0
    for s in range(n_fronts):
        n_border += count[top[s]]
    border = np.empty(n_border, np.int64)
    runs = np.empty((n_border, 3), np.int64)
    entries = np.empty((other.shape[0] // 2, 4), np.int64)
    seen = np.full(n, -1, np.int64)
    local = np.empty(n, np.int64)
    used = np.zeros(2, np.int64)
    peak = np.zeros(2, np.int64)
    n_entries = 0
    for s in range(n_fronts):
        lo, hi = fronts[s, FIRST], fronts[s + 1, FIRST]
        begin = end = fronts[s, BORDER]
        for v in eliminated[lo:hi]:
            for u in other[start[v] : start[v + 1]]:
                k = position[u]
                if k >= hi and seen[k] != s:
                    seen[k] = s
                    border[end] = k
                    end += 1
        c = fronts[s, CHILD]
        while c != -1:
            for k in border[fronts[c, BORDER] : fronts[c + 1, BORDER]]:
                if k >= hi and seen[k] != s:
                    seen[k] = s
                    border[end] = k
                    end += 1
            c = fronts[c, SIBLING]
        for q in range(begin + 1, end):
            k = border[q]
            while q > begin and border[q - 1] > k:
                border[q] = border[q - 1]
                q -= 1
            border[q] = k
        w, r = hi - lo, end - begin
        for q in range(begin, end):
            local[border[q]] = w + q - begin
        for i in range(lo, hi):
            local[i] = i - lo
        for i in range(lo, hi):
            v = eliminated[i]
            for e in range(start[v], start[v + 1]):
                if position[other[e]] > i:
                    entries[n_entries, 0] = pair[e]
                    entries[n_entries, 1] = i - lo
                    entries[n_entries, 2] = local[position[other[e]]]
                    entries[n_entries, 3] = row_a[pair[e]] == v
                    n_entries += 1
        # What is left of a front waits for the front above on one of two stacks, by depth.
        odd = depth[s] % 2
        fronts[s, UPDATE] = used[odd]
        used[odd] += (nd * r) ** 2
        peak[odd] = max(peak[odd], used[odd])
        c = fronts[s, CHILD]
        while c != -1:
            used[1 - odd] = min(used[1 - odd], fronts[c, UPDATE])
            first = at = fronts[c, BORDER]
            for q in range(first, fronts[c + 1, BORDER]):
                place = local[border[q]]
                if q == first or place == w or place != runs[at, 1] + runs[at, 2]:
                    at += q > first
                    runs[at, 0], runs[at, 1], runs[at, 2] = q - first, place, 0
                runs[at, 2] += 1
            fronts[c, N_RUNS] = at + 1 - first
            c = fronts[c, SIBLING]
        fronts[s + 1, BORDER] = end
        fronts[s + 1, ENTRY] = n_entries
        fronts[s + 1, PANEL] = fronts[s, PANEL] + nd * nd * w * (w + 2 * r)
        if parent[top[s]] != -1:
            above = front[parent[top[s]]]
            fronts[s, SIBLING], fronts[above, CHILD] = fronts[above, CHILD], s
    for s in range(n_fronts):
        fronts[s, UPDATE] += (depth[s] % 2) * peak[0]
    fronts[n_fronts, UPDATE] = peak[0] + peak[1]
    return eliminated, fronts, border, runs, entries


def analyse(a: IntArray, b: IntArray, fixed: BoolArray, place: Array, n_dof: int = 3) -> Structure:
    """Order the bodies and find the pattern of the factors.

    Parameters
    ----------
    a, b
        Bodies of each pair, (n_pairs,); what joins a fixed body is left out.
    fixed
        (n,) bodies that do not move.
    place
        (n, dim) about where the bodies are [m]; it decides on speed and memory only.
    n_dof
        Degrees of freedom of a body, a multiple of three.
    """
    movable = np.flatnonzero(~fixed)
    row = np.full(len(fixed), -1, np.int64)
    row[movable] = np.arange(len(movable))
    start, other, pair = neighbours(len(movable), row, a, b)
    lines = np.ascontiguousarray(np.argsort(place[movable], axis=0, kind="stable").T)
    order = dissect(start, other, lines)
    parent, count = elimination_tree(start, other, order)
    front, top, depth = gather_fronts(parent, count, n_dof)
    order, fronts, border, runs, entries = symbolic(
        start, other, pair, order, row[a], n_dof, parent, count, front, top, depth
    )
    return Structure(
        order=np.concatenate((movable[order], np.flatnonzero(fixed))),
        fronts=fronts,
        border=movable[order[border]],
        runs=runs,
        entries=entries,
        dof=(0,) * n_dof,
    )


def allocate(structure: Structure) -> Factors:
    """Memory for the factors of matrices of this structure."""
    n_dof = len(structure.dof)
    end = structure.fronts[-1]
    width = np.diff(structure.fronts[:, [FIRST, BORDER]], axis=0).sum(axis=1)
    return Factors(
        panels=np.zeros(end[PANEL]),
        inverse=np.zeros((end[FIRST], n_dof, n_dof)),
        work=np.zeros(end[UPDATE] + n_dof * (n_dof * int(width.max(initial=0)) + 1)),
    )


@njit(cache=True, error_model="numpy")
def add_rows(to, t, to_stride, source, s, stride, n, m):
    """Add a matrix (n, m) to another; both are parts of flat arrays, from ``s`` and ``t`` on."""
    for _ in range(n):
        x, y = to[t : t + m], source[s : s + m]
        for j in range(m):
            x[j] += y[j]
        t += to_stride
        s += stride


@njit(cache=True, error_model="numpy")
def subtract_product(c, at, stride, left, i0, down, along, right, j0, r_stride, n, p, m):
    """C -= L R of sizes (n, m), (n, p), (p, m), with ``n`` and ``p`` multiples of three.

    Each is part of a flat array from a place on; ``down`` and ``along`` are the strides of L.
    """
    for _ in range(0, n, 3):
        c0 = c[at : at + m]
        c1 = c[at + stride : at + stride + m]
        c2 = c[at + 2 * stride : at + 2 * stride + m]
        i, j = i0, j0
        for _ in range(0, p, 3):
            l00, l10, l20 = left[i], left[i + down], left[i + 2 * down]
            i += along
            l01, l11, l21 = left[i], left[i + down], left[i + 2 * down]
            i += along
            l02, l12, l22 = left[i], left[i + down], left[i + 2 * down]
            i += along
            r0 = right[j : j + m]
            r1 = right[j + r_stride : j + r_stride + m]
            r2 = right[j + 2 * r_stride : j + 2 * r_stride + m]
            j += 3 * r_stride
            for k in range(m):
                x, y, z = r0[k], r1[k], r2[k]
                c0[k] -= l00 * x + l01 * y + l02 * z
                c1[k] -= l10 * x + l11 * y + l12 * z
                c2[k] -= l20 * x + l21 * y + l22 * z
        at += 3 * stride
        i0 += 3 * down


@njit(cache=True, error_model="numpy")
def multiply_rows(dof, block, c, at, stride, m, scratch):
    """Multiply ``m`` columns of a matrix, part of a flat array, by a small one from the left."""
    nd = len(dof)
    if nd == 3:
        b00, b01, b02 = block[0, 0], block[0, 1], block[0, 2]
        b10, b11, b12 = block[1, 0], block[1, 1], block[1, 2]
        b20, b21, b22 = block[2, 0], block[2, 1], block[2, 2]
        c0 = c[at : at + m]
        c1 = c[at + stride : at + stride + m]
        c2 = c[at + 2 * stride : at + 2 * stride + m]
        for k in range(m):
            x, y, z = c0[k], c1[k], c2[k]
            c0[k] = b00 * x + b01 * y + b02 * z
            c1[k] = b10 * x + b11 * y + b12 * z
            c2[k] = b20 * x + b21 * y + b22 * z
    else:
        for d in range(nd):
            x, y = scratch[d * m : d * m + m], c[at + d * stride : at + d * stride + m]
            for k in range(m):
                x[k] = -y[k]
                y[k] = 0.0
        subtract_product(c, at, stride, block.reshape(nd * nd), 0, nd, 1, scratch, 0, m, nd, nd, m)


@njit(cache=True, error_model="numpy")
def invert(dof, matrix, scale):
    """Invert a small matrix in place, with exchange of rows.

    Returns the smallest ratio of a pivot to the largest entry of its column of ``scale``, at most
    1, with the sign of the determinant; 0 for a singular matrix.
    """
    nd = len(dof)
    smallest, sign = 1.0, 1.0
    exchanged = 0
    for k in range(nd):
        best, size = k, 0.0
        for i in range(nd):
            size = max(size, abs(scale[i, k]))
            if i > k and abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        ratio = abs(matrix[best, k]) / size
        if not ratio > 0.0:  # also where it is not a number
            return 0.0
        smallest = min(smallest, ratio)
        exchanged |= best << (4 * k)
        sign = sign if matrix[best, k] > 0.0 else -sign
        if best != k:
            sign = -sign
            for j in range(nd):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        factor = 1.0 / matrix[k, k]
        matrix[k, k] = 1.0
        for j in range(nd):
            matrix[k, j] *= factor
        for i in range(nd):
            if i != k:
                factor = matrix[i, k]
                matrix[i, k] = 0.0
                for j in range(nd):
                    matrix[i, j] -= factor * matrix[k, j]
    for k in range(nd - 1, -1, -1):
        best = (exchanged >> (4 * k)) & 15
        if best != k:
            for i in range(nd):
                matrix[i, k], matrix[i, best] = matrix[i, best], matrix[i, k]
    return sign * smallest


@njit(cache=True, error_model="numpy")
def assemble(structure, s, diagonal, upper, lower, factors):
    """Fill a front with blocks of the matrix and what is left of the fronts below."""
    nd = len(structure.dof)
    order, fronts, _, runs, entries, _ = structure
    panels, _, work = factors
    w = fronts[s + 1, FIRST] - fronts[s, FIRST]
    r = fronts[s + 1, BORDER] - fronts[s, BORDER]
    m, q = nd * (w + r), nd * r
    rows = fronts[s, PANEL]
    columns = rows + nd * w * m
    rest = fronts[s, UPDATE]
    panels[rows : fronts[s + 1, PANEL]] = 0.0
    work[rest : rest + q * q] = 0.0
    for i in range(w):
        body = order[fronts[s, FIRST] + i]
        at = rows + nd * i * (m + 1)
        for x in range(nd):
            for y in range(nd):
                panels[at + x * m + y] = diagonal[body, x, y]
    for e in range(fronts[s, ENTRY], fronts[s + 1, ENTRY]):
        pair, i, j = entries[e, 0], entries[e, 1], entries[e, 2]
        right = rows + nd * (i * m + j)
        if j < w:
            left, down, along = rows + nd * (j * m + i), m, 1
        else:
            left, down, along = columns + nd * (i * q + j - w), 1, q
        for x in range(nd):
            for y in range(nd):
                xy, yx = upper[pair, x, y], lower[pair, x, y]
                if not entries[e, 3]:
                    xy, yx = yx, xy
                panels[right + x * m + y] += xy
                panels[left + x * down + y * along] += yx
    c = fronts[s, CHILD]
    while c != -1:
        begin = fronts[c, BORDER]
        stride = nd * (fronts[c + 1, BORDER] - begin)
        for a in range(begin, begin + fronts[c, N_RUNS]):
            i, n = runs[a, 1], nd * runs[a, 2]
            row = fronts[c, UPDATE] + nd * runs[a, 0] * stride
            for b in range(begin, begin + fronts[c, N_RUNS]):
                j, length = runs[b, 1], nd * runs[b, 2]
                source = row + nd * runs[b, 0]
                if i < w:
                    at = rows + nd * (i * m + j)
                    add_rows(panels, at, m, work, source, stride, n, length)
                elif j >= w:
                    at = rest + nd * ((i - w) * q + j - w)
                    add_rows(work, at, q, work, source, stride, n, length)
                else:
                    at = columns + nd * (j * q + i - w)
                    for x in range(n):
                        for y in range(length):
                            panels[at + y * q + x] += work[source + x * stride + y]
        c = fronts[c, SIBLING]


@njit(cache=True, error_model="numpy")
def factorise(structure, diagonal, upper, lower, factors, weight, hold, least):
    """Factorise the matrix of the blocks ``diagonal`` (n, n_dof, n_dof), ``upper`` (n_pairs, n_dof,
    n_dof) in the rows of a and columns of b, and ``lower`` in the rows of b and columns of a.

    Where ``least`` is positive, bodies whose pivots have a negative determinant are held: to the
    diagonal of the pivot their ``weight`` (n, n_dof) is added ``least`` times, or twice as often as
    makes the determinant positive.  ``hold`` (n,) counts how often.

    Returns the smallest pivot over the largest entry of its column in the body's own block, at most
    1, with the sign of the determinant; 0, with the factors unusable, for singular matrices and
    such as hold NaN.
    """
    nd = len(structure.dof)
    order, fronts = structure.order, structure.fronts
    panels, inverse, work = factors
    scratch = work[fronts[-1, UPDATE] :]
    smallest, sign = 1.0, 1.0
    for s in range(fronts.shape[0] - 1):
        assemble(structure, s, diagonal, upper, lower, factors)
        w = fronts[s + 1, FIRST] - fronts[s, FIRST]
        r = fronts[s + 1, BORDER] - fronts[s, BORDER]
        m, q = nd * (w + r), nd * r
        rows = fronts[s, PANEL]
        columns = rows + nd * w * m
        for k in range(w):
            at = rows + nd * k * (m + 1)
            place = fronts[s, FIRST] + k
            block = inverse[place]
            for x in range(nd):
                for y in range(nd):
                    block[x, y] = panels[at + x * m + y]
            body = order[place]
            ratio = invert(structure.dof, block, diagonal[body])
            more = least
            lacking = ratio < 0.0
            while lacking and 0.0 < more < 1e12 * least:
                # Once more when it is positive: what is hardly so upsets what it is joined to.
                lacking = ratio < 0.0
                hold[body] += more
                for x in range(nd):
                    panels[at + x * (m + 1)] += more * weight[body, x]
                    for y in range(nd):
                        block[x, y] = panels[at + x * m + y]
                ratio = invert(structure.dof, block, diagonal[body])
                more = hold[body]
            if ratio == 0.0:
                return 0.0
            smallest = min(smallest, abs(ratio))
            sign = sign if ratio > 0.0 else -sign
            ahead = m - nd * (k + 1)
            multiply_rows(structure.dof, block, panels, at + nd, m, ahead, scratch)
            below = at + nd * m
            subtract_product(
                panels, below + nd, m, panels, below, m, 1, panels, at + nd, m,
                nd * (w - k - 1), nd, ahead,
            )  # fmt: skip
            subtract_product(
                panels, columns + nd * k * q, q, panels, rows + nd * k, 1, m, panels, columns, q,
                nd, nd * k, q,
            )  # fmt: skip
        subtract_product(
            work, fronts[s, UPDATE], q, panels, columns, 1, q, panels, rows + nd * w, m,
            q, nd * w, q,
        )  # fmt: skip
    return sign * smallest


@njit(cache=True, error_model="numpy")
def solve(structure, factors, rhs):
    """Replace each of the right-hand sides ``rhs`` (k, n, n_dof) by its solution, in which fixed
    bodies have zeros whatever they had before."""
    nd = len(structure.dof)
    order, fronts, border = structure.order, structure.fronts, structure.border
    panels, inverse, work = factors
    n_fronts = fronts.shape[0] - 1
    for s in range(n_fronts):
        first, begin = fronts[s, FIRST], fronts[s, BORDER]
        w, r = fronts[s + 1, FIRST] - first, fronts[s + 1, BORDER] - begin
        m, q = nd * (w + r), nd * r
        rows = fronts[s, PANEL]
        columns = rows + nd * w * m
        y, below, t = work[: nd * w], work[nd * w : m], work[m : m + nd]
        for side in range(rhs.shape[0]):
            x = rhs[side]
            below[:] = 0.0
            for i in range(w):
                body = order[first + i]
                k = nd * i
                for d in range(nd):
                    left = panels[rows + (k + d) * m : rows + (k + d) * m + k]
                    rest = x[body, d]
                    for j in range(k):
                        rest -= left[j] * y[j]
                    t[d] = rest
                for d in range(nd):
                    y[k + d] = 0.0
                    for e in range(nd):
                        y[k + d] += inverse[first + i, d, e] * t[e]
                    x[body, d] = y[k + d]
                for d in range(k, k + nd, 3):
                    at = columns + d * q
                    l0 = panels[at : at + q]
                    l1 = panels[at + q : at + 2 * q]
                    l2 = panels[at + 2 * q : at + 3 * q]
                    y0, y1, y2 = y[d], y[d + 1], y[d + 2]
                    for j in range(q):
                        below[j] += l0[j] * y0 + l1[j] * y1 + l2[j] * y2
            for j in range(r):
                for d in range(nd):
                    x[border[begin + j], d] -= below[nd * j + d]
    for s in range(n_fronts - 1, -1, -1):
        first, begin = fronts[s, FIRST], fronts[s, BORDER]
        w, r = fronts[s + 1, FIRST] - first, fronts[s + 1, BORDER] - begin
        m = nd * (w + r)
        for side in range(rhs.shape[0]):
            x = rhs[side]
            y = work[:m]
            for i in range(w + r):
                body = order[first + i] if i < w else border[begin + i - w]
                for d in range(nd):
                    y[nd * i + d] = x[body, d]
            for i in range(w - 1, -1, -1):
                k = nd * (i + 1)
                known = y[k:]
                for d in range(nd * i, k, 3):
                    at = fronts[s, PANEL] + d * m
                    u0 = panels[at + k : at + m]
                    u1 = panels[at + m + k : at + 2 * m]
                    u2 = panels[at + 2 * m + k : at + 3 * m]
                    s0 = s1 = s2 = 0.0
                    for j in range(m - k):
                        s0 += u0[j] * known[j]
                        s1 += u1[j] * known[j]
                        s2 += u2[j] * known[j]
                    y[d] -= s0
                    y[d + 1] -= s1
                    y[d + 2] -= s2
                for d in range(nd):
                    x[order[first + i], d] = y[nd * i + d]
    for body in order[fronts[n_fronts, FIRST] :]:
        rhs[:, body] = 0.0


@njit(cache=True)
def residual(structure, a, b, fixed, diagonal, upper, lower, x, rhs):
    """Subtract A x from ``rhs``, both (k, n, n_dof) and zero on fixed bodies.

    It tells how good a solution is; solved for, it is what the solution lacks.
    """
    nd = len(structure.dof)
    for side in range(rhs.shape[0]):
        for i in range(fixed.shape[0]):
            for d in range(nd):
                for e in range(nd):
                    rhs[side, i, d] -= diagonal[i, d, e] * x[side, i, e]
        for p in range(a.shape[0]):
            i, j = a[p], b[p]
            if not (fixed[i] or fixed[j]):
                for d in range(nd):
                    for e in range(nd):
                        rhs[side, i, d] -= upper[p, d, e] * x[side, j, e]
                        rhs[side, j, d] -= lower[p, d, e] * x[side, i, e]
