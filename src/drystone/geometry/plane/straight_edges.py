"""Points that outlines share, moved as little as may be so that edges run straight through them.

Where a point lies on an edge, it is to lie on the line between the edge's ends.  Of all places that
make it so, those are taken whose distances from where the points were drawn have the least sum of
squares (Gauss, Newton, Lagrange).

An edge is then like a beam between its ends, loaded by points that springs hold to where they were
drawn; the multipliers are these loads.  Where a vertex would go farther than it may, the beams at
it get a hinge at their largest bending moment, one after the other, until none does.  A hinge that
bends outwards leaves its block convex; these come first.  So beams that can be straight are, and a
bed that is curved bends at as few points as there may be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, coo_array, diags_array, eye_array
from scipy.sparse.linalg import splu

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import LAST_DIGIT, OFF_LINE, ROUNDING, SPARE_IN_LINE
from drystone.geometry.links import components
from drystone.geometry.plane.corners import Points

MOST_ITERATIONS = 12


@dataclass(frozen=True, eq=False)
class Loads:
    """Points that are to lie on a line between two others of their outline, see `Points.loops`."""

    outline: IntArray  # (n,) whose edge it is
    at: IntArray  # (n,) row of the point in the outline's loop
    stiff: BoolArray  # (n,) whether the outline is fixed, and its edges have no hinges


@dataclass(frozen=True, eq=False)
class Straightened:
    """Where the points come to lie."""

    place: Array  # (n_points, 2) m
    straight: BoolArray  # (n_loads,) which lie amid a straight edge
    too_far: IntArray  # outlines with vertices that went farther than they may


def straightened(points: Points, loads: Loads, reach: Array, fixed: BoolArray) -> Straightened:
    """Move points so that edges are straight where vertices need not go too far for it.

    Parameters
    ----------
    reach, fixed
        Of each outline, by how much its vertices may be moved [m], and whether they are not.
    """
    straight = np.ones(len(loads.outline), bool)
    vertices = _Vertices.of(points, reach, fixed)
    size = float(np.ptp(points.place, axis=0).max())
    while True:
        rows = np.flatnonzero(straight)
        beams = _Beams.of(points, loads, rows)
        place, load = _solved(points, beams.ends)
        far = np.zeros(len(place), bool)
        far[vertices.point[vertices.too_far(place)]] = True
        off = np.abs(_off(place, beams.ends)[0])
        far[beams.ends[off > OFF_LINE * size].ravel()] = True
        hinges = beams.hinges(place, load, far, loads.stiff[rows])
        if not len(hinges):
            break
        straight[rows[hinges]] = False
    too_far = vertices.outline[vertices.too_far(place)]
    return Straightened(place, straight, np.unique(too_far))


@dataclass(frozen=True, eq=False)
class _Vertices:
    """Where each point was drawn in each outline, and how far it may go from there."""

    point: IntArray
    outline: IntArray
    drawn: Array  # (n, 2) m
    reach: Array  # (n,) m
    along: Array  # (n, 2) unit vector of the edge that an inserted point may slide on; else zero

    @classmethod
    def of(cls, points: Points, reach: Array, fixed: BoolArray) -> _Vertices:
        rows: list[int] = []
        outline: list[int] = []
        drawn, along = [np.zeros((0, 2))], [np.zeros((0, 2))]
        for i, (loop, inserted, own) in enumerate(
            zip(points.loops, points.inserted, points.drawn, strict=True)
        ):
            if fixed[i]:
                continue
            way = np.roll(own, -1, axis=0) - own
            length = np.hypot(way[:, 0], way[:, 1])[:, None]
            way /= np.where(length > 0.0, length, 1.0)
            rows += loop
            outline += [i] * len(loop)
            drawn.append(own)
            along.append(np.where(np.array(inserted)[:, None], way, 0.0))
        whose = np.array(outline, np.int64)
        return cls(
            np.array(rows, np.int64), whose, np.vstack(drawn), reach[whose], np.vstack(along)
        )

    def too_far(self, place: Array) -> BoolArray:
        """Which went farther than they may, points on edges across these alone."""
        way = place[self.point] - self.drawn
        way -= np.sum(way * self.along, axis=1)[:, None] * self.along
        return np.asarray(np.hypot(way[:, 0], way[:, 1]) > self.reach * (1.0 + ROUNDING))


@dataclass(frozen=True, eq=False)
class _Beams:
    """Loads by the ends of their beams."""

    ends: IntArray  # (n, 3) the point where the beam begins, the load's own, the one where it ends
    beam: IntArray  # (n,) number of the beam
    line: IntArray  # (n,) number of the line: of beams that have a piece in common

    @classmethod
    def of(cls, points: Points, loads: Loads, rows: IntArray) -> _Beams:
        free: dict[int, set[int]] = {}
        for k in rows.tolist():
            free.setdefault(int(loads.outline[k]), set()).add(int(loads.at[k]))
        ends, names = [], []
        pieces: dict[tuple[int, int], int] = {}
        first, second = [], []
        for n, k in enumerate(rows.tolist()):
            i, at = int(loads.outline[k]), int(loads.at[k])
            loop, amid = points.loops[i], free[i]
            low = high = at
            while low % len(loop) in amid:
                low -= 1
            while high % len(loop) in amid:
                high += 1
            ends.append((loop[low % len(loop)], loop[at], loop[high % len(loop)]))
            names.append((i, low % len(loop)))
            for a, b in ((loop[at - 1], loop[at]), (loop[at], loop[(at + 1) % len(loop)])):
                other = pieces.setdefault((min(a, b), max(a, b)), n)
                if other != n:
                    first.append(n)
                    second.append(other)
        _, beam = np.unique(np.array(names, np.int64).reshape(-1, 2), axis=0, return_inverse=True)
        line = components(len(rows), first, second)
        return cls(np.array(ends, np.int64).reshape(-1, 3), beam.reshape(-1), line)

    def hinges(self, place: Array, load: Array, far: BoolArray, stiff: BoolArray) -> IntArray:
        """Which loads become hinges: on each line with points that are too far off, that of the
        largest moment, outwards where there is one."""
        moved = np.isin(self.line, np.unique(self.line[far[self.ends].any(axis=1)]))
        if not moved.any():
            return np.zeros(0, np.int64)
        moment = np.zeros(len(load))
        a, m, b = (place[self.ends[:, k]] for k in range(3))
        length = np.hypot(*(b - a).T)
        along = np.clip(np.sum((m - a) * (b - a), axis=1) / length, 0.0, length)
        for own in _groups(self.beam, moved):
            x, span = along[own], length[own[0]]
            low, high = np.minimum(x[:, None], x), np.maximum(x[:, None], x)
            moment[own] = (low * (span - high) / span) @ load[own]
        found = []
        for own in _groups(self.line, moved & ~stiff):
            outward = own[moment[own] < 0.0]
            own = outward if len(outward) else own
            found.append(own[np.argmax(np.abs(moment[own]))])
        return np.array(found, np.int64)


def _groups(number: IntArray, some: BoolArray) -> list[IntArray]:
    """Rows that are some, by their numbers."""
    rows = np.flatnonzero(some)
    rows = rows[np.argsort(number[rows], kind="stable")]
    return np.split(rows, np.flatnonzero(np.diff(number[rows])) + 1) if len(rows) else []


def _off(place: Array, ends: IntArray) -> tuple[Array, Array, Array]:
    """How far each middle point is to the left of the line through the others [m], the normal of
    that line, (n, 2), and where along it the point lies, from 0 to 1."""
    a, m, b = (place[ends[:, k]] for k in range(3))
    way = b - a
    length = np.hypot(way[:, 0], way[:, 1])
    tangent = way / length[:, None]
    normal = np.column_stack((-tangent[:, 1], tangent[:, 0]))
    arm = m - a
    return np.sum(arm * normal, axis=1), normal, np.sum(arm * tangent, axis=1) / length


def _solved(points: Points, ends: IntArray) -> tuple[Array, Array]:
    """Places with the least motion that have all loads on their beams, and the loads [m] of
    springs of stiffness one."""
    k, n = len(ends), 2 * len(points.place)
    place, load = points.place.copy(), np.zeros(k)
    if not k:
        return place, load
    loose = np.repeat(~points.fixed, 2).astype(float)
    weight = np.repeat(points.weight, 2)
    size = float(np.ptp(points.place, axis=0).max())
    for iteration in range(MOST_ITERATIONS):
        off, normal, share = _off(place, ends)
        if iteration > 1 and float(np.abs(off).max()) <= LAST_DIGIT * size:
            break
        factors = np.column_stack((share - 1.0, np.ones(k), -share))
        values = factors[:, :, None] * normal[:, None, :]
        columns = 2 * ends[:, :, None] + np.arange(2)
        rows = np.broadcast_to(np.arange(k)[:, None, None], values.shape)
        slopes = coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(k, n))
        slopes = slopes.tocsr() @ diags_array(loose)
        system = block_array(
            [[diags_array(weight), slopes.T], [slopes, -SPARE_IN_LINE * eye_array(k)]], format="csc"
        )
        pull = weight * (points.place - place).ravel() * loose
        solved = splu(system).solve(np.concatenate((pull, -off - SPARE_IN_LINE * load)))
        place += (solved[:n] * loose).reshape(-1, 2)
        load = solved[n:]
    return place, load
