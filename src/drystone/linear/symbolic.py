"""Pattern of the factors of a matrix made of blocks, found once per list of pairs of bodies.

The multifrontal method eliminates bodies in fronts (Duff and Reid 1983).  A front is a dense matrix
of a group of bodies and of the later bodies to which they are joined.  `linear.numeric` calculates
with these fronts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.compiled import njit
from drystone.common.tolerances import CALL_TIME, MULTIPLICATION_TIME
from drystone.linear.order import dissect, neighbours

#: Columns of `Structure.fronts`.  The first four are offsets: a front ends where the next begins.
FIRST, BORDER, ENTRY, PANEL, UPDATE, N_RUNS, CHILD, SIBLING = range(8)
#: Number of rows and columns of dense matrices that are processed at once.  They fit into the
#: registers of a processor, and the number divides the degrees of freedom of a body in the plane
#: (3) and in space (6).
TILE = 3
#: Time of a front [ns]: constant, per entry, per product.  Rough values suffice, because the
#: optimum is flat.
COST = (CALL_TIME, 0.5, MULTIPLICATION_TIME)


class Structure(NamedTuple):
    """Order of elimination and pattern of the factors, for one list of pairs."""

    order: IntArray  # (n,) bodies as they are eliminated, then the fixed ones
    fronts: IntArray  # (n_fronts + 1, 8) offsets and tree; a front comes after those below it
    border: IntArray  # (n_border,) later bodies to which fronts are joined
    runs: IntArray  # (n_border, 3) place in ``border``, place in the front above, number of bodies
    entries: IntArray  # (n_entries, 4) pair, places of its bodies in the front, whether a is first
    dof: tuple[int, ...]  # its length is a body's number of degrees of freedom, see `contact.rows`


class Tangent(NamedTuple):
    """Block form of the stiffness matrix: diagonal blocks, and both of every pair."""

    diagonal: Array  # (n, n_dof, n_dof)
    upper: Array  # (n_pairs, n_dof, n_dof) rows of a, columns of b
    lower: Array  # (n_pairs, n_dof, n_dof) rows of b, columns of a

    @classmethod
    def zeros(cls, n: int, n_pairs: int, n_dof: int) -> Tangent:
        """A matrix of zeros."""
        return cls(*(np.zeros((count, n_dof, n_dof)) for count in (n, n_pairs, n_pairs)))


@njit(cache=True)
def elimination_tree(start, other, order):
    """For each place in the order: the first later place to which it is joined in the factors, or
    -1; and the number of such later places."""
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
    """Merge bodies with the front above if that saves time, and number the fronts.

    Returns the front of each place; and for each front its last place and its depth in the tree.
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
    """The parts of a `Structure`; bodies are given as rows among the movable bodies."""
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
        # The update matrix of a front waits for the front above on one of two stacks: one for even
        # depths, one for odd.
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


def analyse(a: IntArray, b: IntArray, fixed: BoolArray, place: Array, n_dof: int) -> Structure:
    """Order the bodies and find the pattern of the factors.

    Parameters
    ----------
    a, b
        Bodies of each pair, (n_pairs,); pairs with a fixed body are left out.
    fixed
        (n,) bodies that do not move.
    place
        (n, dim) [m] approximate places of the bodies; they affect only speed and memory.
    n_dof
        Degrees of freedom of a body, a multiple of `TILE`.
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
