"""Outlines as drawn made outlines that touch: corners that were meant to be one made one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import ROUNDING, STRAIGHT_EDGE
from drystone.geometry import GeometryError
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.plane import polygon
from drystone.geometry.plane.corners import Points, shared_points
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.plane.parts import parts_of
from drystone.geometry.plane.straight_edges import Loads, Straightened, straightened

#: How often the distance is doubled within which corners are looked for.
FINEST = 5


@dataclass(frozen=True, eq=False)
class Closed:
    """Outlines with joints closed, and what was done to each."""

    outlines: tuple[Array, ...]  # (n, 2) m each
    way: Array  # (n_outlines,) m, the largest motion of a vertex
    bent: IntArray  # (n_outlines,) edges that were bent to go through a neighbour's corner
    straight: IntArray  # (n_outlines,) vertices that were left out, as they lay amid an edge
    given_up: tuple[int, ...] = ()  # outlines that stayed as drawn


def closed(outlines: Sequence[Array], reach: Array, bends: Array, fixed: BoolArray) -> Closed:
    """Close the joints of outlines that are counter-clockwise.

    Corners that belong together are looked for near by first, and farther off as long as that makes
    more outlines fit: two corners near each other that were meant to be two stay so.  What fits
    already stays as it is.

    Parameters
    ----------
    reach
        By how much vertices of each outline may be moved [m].
    bends
        By how much a vertex of each outline may be off the line between its neighbours [m], and
        still lie amid an edge.
    fixed
        Outlines that stay as they are.
    """
    packed = Outlines.pack([[outline] for outline in outlines])
    loose = _Loose(outlines, packed, np.where(fixed, 0.0, reach), bends, fixed)
    # Around what does not fit, points may be shared with outlines that do.
    a, b = packed.near_pairs(4.0 * float(loose.reach.max(initial=0.0)))
    level = np.zeros(len(outlines), np.int64)
    best = trial = loose.closed(level)
    while trial.misfit.any():
        around = trial.misfit.copy()
        around[a[trial.misfit[b]]] = around[b[trial.misfit[a]]] = True
        more = around & (level < 2 * FINEST)
        if not more.any():
            break
        level[more] += 1
        trial = loose.closed(level)
        if trial.misfit.sum() < best.misfit.sum():
            best = trial
    return best.closed


@dataclass(frozen=True, eq=False)
class _Trial:
    closed: Closed
    misfit: BoolArray  # (n_outlines,) which still do not fit


@dataclass(frozen=True, eq=False)
class _Loose:
    """Outlines as drawn, see `closed`."""

    outlines: Sequence[Array]
    packed: Outlines
    reach: Array
    bends: Array
    fixed: BoolArray

    def closed(self, level: IntArray) -> _Trial:
        """Those at a level each, (n_outlines,): 0 as they are; then two to each doubling of the
        distance, the first without edges being lost whose ends become one, the second with."""
        near = np.where(self.fixed, np.inf, 2.0 * self.reach)
        share = np.where(level > 0, 0.5 ** (FINEST - (level + 1) // 2), 0.0)
        looked = np.maximum(share * self.reach, ROUNDING * self.packed.sizes)
        lost = (level > 0) & (level % 2 == 0)
        most = np.maximum(STRAIGHT_EDGE * looked, self.bends)
        most = np.minimum(most, np.maximum(self.reach, looked))
        given_up = np.zeros(len(self.outlines), bool)
        while True:
            fixed = self.fixed | given_up
            points = shared_points(self.packed, looked, fixed, lost)
            loads = _loads(points, self.bends, fixed)
            found = straightened(points, loads, most, fixed)
            made = _made(self.outlines, points, loads, found, fixed)
            wrong = _wrong(self.outlines, made.outlines)
            wrong[found.too_far] = True
            if not wrong.any():
                break
            given_up |= wrong
        stayed = tuple(np.flatnonzero(given_up).tolist())
        misfit = given_up | _misfitting(made.outlines, near, self.packed.sizes)
        return _Trial(replace(made, given_up=stayed), misfit)


def _loads(points: Points, bends: Array, fixed: BoolArray) -> Loads:
    """Points on edges, and vertices that hardly bend them."""
    outline: list[int] = []
    at: list[int] = []
    for i, (inserted, drawn) in enumerate(zip(points.inserted, points.drawn, strict=True)):
        own = [k for k, between in enumerate(inserted) if not between]
        amid = {k for k, between in enumerate(inserted) if between}
        if not fixed[i] and len(own) > 3:
            amid |= {own[k] for k in _apart(polygon.bends(drawn[own]), bends[i]).tolist()}
        outline += [i] * len(amid)
        at += sorted(amid)
    rows = np.array(outline, np.int64)
    return Loads(rows, np.array(at, np.int64), fixed[rows])


def _apart(off: Array, near: float) -> IntArray:
    """Vertices within ``near``, as long as three others are left."""
    rows = np.argsort(off, kind="stable")[: max(len(off) - 3, 0)]
    return rows[off[rows] <= near]


def _made(
    outlines: Sequence[Array], points: Points, loads: Loads, found: Straightened, fixed: BoolArray
) -> Closed:
    """The outlines without the points that lie amid their edges."""
    n = len(outlines)
    way, bent, left_out = np.zeros(n), np.zeros(n, np.int64), np.zeros(n, np.int64)
    kept_of = [np.ones(len(loop), bool) for loop in points.loops]
    for i, at, straight in zip(loads.outline, loads.at, found.straight, strict=True):
        kept_of[i][at] = not straight
    made = list(outlines)
    for i in np.flatnonzero(~fixed).tolist():
        loop, inserted = np.array(points.loops[i]), np.array(points.inserted[i])
        size = float(np.ptp(outlines[i], axis=0).max())
        kept = _turning(found.place[loop], kept_of[i], ROUNDING * size)
        lost = len(outlines[i]) - np.count_nonzero(~inserted)  # with their edges
        moved = np.linalg.norm(found.place[loop] - points.drawn[i], axis=1)[~inserted]
        way[i] = float(moved.max(initial=0.0))
        bent[i] = np.count_nonzero(inserted & kept)
        left_out[i] = np.count_nonzero(~inserted & ~kept) + lost
        if way[i] > ROUNDING * size or bent[i] or left_out[i]:
            made[i] = found.place[loop[kept]]
        else:
            way[i] = 0.0
    return Closed(tuple(made), way, bent, left_out)


def _turning(place: Array, kept: BoolArray, near: float) -> BoolArray:
    """Which of the points kept bend an outline: those that others' edges hold straight do not."""
    rows = np.flatnonzero(kept)
    return np.asarray(np.isin(np.arange(len(kept)), rows[polygon.turning(place[rows], near)]))


def _misfitting(outlines: Sequence[Array], near: Array, size: Array) -> BoolArray:
    """Which outlines overlap others, or have edges so near those of others that both may be meant
    to lie on each other, and do not to rounding.

    ``near`` (n_outlines,) is how near [m]; of two outlines the less counts.
    """
    found = np.zeros(len(outlines), bool)
    packed = Outlines.pack([[outline] for outline in outlines])
    joints = Interfaces.of(packed, np.minimum(near, near[np.isfinite(near)].max(initial=0.0)))
    tangent, _ = packed.edges
    normal = np.column_stack((tangent[:, 1], -tangent[:, 0]))
    arm = joints.ends - packed.vertices[joints.face_b, None]
    off = np.abs(np.einsum("kij,kj->ki", arm, normal[joints.face_b])).max(axis=1, initial=0.0)
    a, b = joints.block_a, joints.block_b
    apart = off > ROUNDING * np.minimum(size[a], size[b])
    found[a[apart]] = found[b[apart]] = True
    parts = Outlines.pack([parts_of(outline) for outline in outlines])
    p, q = parts.near_pairs()
    a, b = parts.body[p], parts.body[q]
    over = parts.overlap_depths(p, q) > ROUNDING * np.minimum(size[a], size[b])
    found[a[over]] = found[b[over]] = True
    return found


def _wrong(before: Sequence[Array], after: Sequence[Array]) -> BoolArray:
    """Which outlines are none any more."""
    found = np.zeros(len(after), bool)
    for i, (old, new) in enumerate(zip(before, after, strict=True)):
        if new is not old:
            try:
                polygon.check_outline(new)
            except GeometryError:
                found[i] = True
    return found
