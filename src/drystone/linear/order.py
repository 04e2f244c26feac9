"""Order in which bodies are eliminated: nested dissection by their places (George 1973).

The bodies are cut into two halves where the fewest bodies are joined across the cut.  These bodies
come last.  The halves are cut in the same way.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit


@njit(cache=True)
def neighbours(n, row, a, b):
    """Movable neighbours of each of ``n`` movable bodies, and the pairs that join them.

    ``row`` holds for each body its row among the movable ones, or -1.  Returns where each body
    begins in the two lists (n + 1,), the neighbours, and the pairs.
    """
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
    """Find the cut of a ``line`` of bodies at which the fewest bodies are joined to the other side.

    Returns this number, increased for unequal halves; the number of bodies before the cut; and the
    side on which the joined bodies are.
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
    """Order of elimination (n,): both halves, then the bodies between them; the same within the
    halves.

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
