"""Factorisations shared by threads, which is possible because subtrees of fronts are independent.

Each subtree has its own memory for the parts that wait for the front above it.  The fronts above
all subtrees are factorised at the end.  The results are the same as without threads, to the last
bit.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.threads import Team
from drystone.common.tolerances import WORTH_SHARING
from drystone.linear import numeric as lu_numeric
from drystone.linear.symbolic import (
    BORDER,
    CHILD,
    FIRST,
    SIBLING,
    UPDATE,
    Structure,
    Tangent,
    cost,
)

#: Largest number of times that a subtree is divided to balance the threads.
MOST_PARTED = 40


class SharedLU:
    """Factors of matrices of one structure, calculated by several threads if that is faster."""

    def __init__(self, structure: Structure, team: Team) -> None:
        self.team = team
        times = _times(structure)
        self.parts: list[list[tuple[int, int]]] = []  # ranges of fronts, of each thread
        self.top: list[tuple[int, int]] = []
        self.structure, self.factors = structure, lu_numeric.allocate(structure)
        if team.number > 1 and times.sum() > WORTH_SHARING:
            self._share(structure, times)

    def _share(self, structure: Structure, times: Array) -> None:
        subtrees, loads = _parted(structure.fronts, times, self.team.number)
        waiting = int(structure.fronts[-1, UPDATE])
        fronts = structure.fronts.copy()
        for k, (low, high) in enumerate(subtrees):
            fronts[low:high, UPDATE] += (k + 1) * waiting
        own = len(self.factors.work) - waiting
        #: Begin of the scratch memory of each thread.
        self.scratch = [(len(subtrees) + 1) * waiting + k * own for k in range(self.team.number)]
        self.structure = structure._replace(fronts=fronts)
        self.factors = self.factors._replace(work=np.zeros(self.scratch[-1] + own))
        self.parts = [[subtrees[k] for k in sorted(mine)] for mine in loads]
        inside = np.zeros(len(fronts) - 1, np.bool_)
        for low, high in subtrees:
            inside[low:high] = True
        edges = np.flatnonzero(np.diff(np.concatenate(([True], inside, [True])).astype(np.int8)))
        self.top = [(int(low), int(high)) for low, high in edges.reshape(-1, 2)]

    def factorise(self, matrix: Tangent, mass: Array, damping: Array, least: float) -> float:
        """See `linear.numeric.factorise`."""
        if not self.parts:
            pivot: float = lu_numeric.factorise(
                self.structure, *matrix, self.factors, mass, damping, least
            )
            return pivot
        work = partial(self._fronts, matrix, mass, damping, least)
        found = self.team.run([partial(work, k, mine) for k, mine in enumerate(self.parts)])
        if 0.0 in found:
            return 0.0
        found.append(work(0, self.top))
        smallest = min(abs(pivot) for pivot in found)
        return smallest * float(np.prod(np.sign(found)))

    def _fronts(
        self,
        matrix: Tangent,
        mass: Array,
        damping: Array,
        least: float,
        thread: int,
        ranges: list[tuple[int, int]],
    ) -> float:
        smallest, sign = 1.0, 1.0
        for low, high in ranges:
            pivot = lu_numeric.factorise_fronts(
                self.structure, low, high, self.scratch[thread], *matrix, self.factors, mass,
                damping, least,
            )  # fmt: skip
            if pivot == 0.0:
                return 0.0
            smallest, sign = min(smallest, abs(pivot)), sign if pivot > 0.0 else -sign
        return sign * smallest


def _times(structure: Structure) -> Array:
    """Time of each front [ns], (n_fronts,)."""
    fronts, nd = structure.fronts, len(structure.dof)
    width, joined = np.diff(fronts[:, FIRST]), np.diff(fronts[:, BORDER])
    return np.array([cost(w, r, nd) for w, r in zip(width, joined, strict=True)])


def _parted(
    fronts: IntArray, times: Array, n: int
) -> tuple[list[tuple[int, int]], list[list[int]]]:
    """Subtrees as ranges of fronts, and the subtrees of each of up to ``n`` threads.

    The most expensive subtree is repeatedly divided into the subtrees below its top.  The division
    with the shortest total time is kept.
    """
    count = len(times)
    size, total = np.ones(count, np.int64), times.copy()
    below: list[list[int]] = [[] for _ in range(count)]
    roots = np.ones(count, np.bool_)
    for s in range(count):
        c = fronts[s, CHILD]
        while c != -1:
            below[s].append(int(c))
            size[s] += size[c]
            total[s] += total[c]
            roots[c] = False
            c = fronts[c, SIBLING]
    now, left_over = [int(s) for s in np.flatnonzero(roots)], 0.0
    best, chosen, loads = np.inf, now, [[0]]
    for _ in range(MOST_PARTED):
        order = sorted(now, key=lambda s: (-total[s], s))
        mine: list[list[int]] = [[] for _ in range(n)]
        busy = np.zeros(n)
        for s in order:
            k = int(np.argmin(busy))
            mine[k].append(s)
            busy[k] += total[s]
        if left_over + busy.max() < best:
            best, chosen, loads = left_over + busy.max(), now, mine
        if not order or not below[order[0]]:
            break
        left_over += times[order[0]]
        now = [s for s in now if s != order[0]] + below[order[0]]
    chosen = sorted(chosen)
    place = {s: k for k, s in enumerate(chosen)}
    ranges = [(s - int(size[s]) + 1, s + 1) for s in chosen]
    return ranges, [[place[s] for s in mine] for mine in loads if mine]
