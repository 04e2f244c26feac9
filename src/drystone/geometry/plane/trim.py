"""Overlaps of two convex parts in the plane, cut off along the line that separates them best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.tolerances import NO_OVERLAP, ROUNDING
from drystone.geometry import GeometryError
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.plane.parts import parts_of
from drystone.geometry.plane.polygon import check_convex
from drystone.geometry.space.solid import Part


def trimmed(
    outlines: Sequence[Array], allowed: Array, fixed: BoolArray
) -> tuple[dict[int, list[Part]], dict[int, float]]:
    """Convex parts of outlines that lost overlaps which are small, by their rows, and how much was
    cut off each [m].

    Of two parts each loses half, to the line in the middle of their overlap along the direction in
    which it is least; beside a support the other loses all of it.

    Parameters
    ----------
    allowed
        Largest depth that is cut off each outline [m].
    fixed
        Which outlines are supports.
    """
    parts = [parts_of(outline) for outline in outlines]
    packed = Outlines.pack(parts)
    first = np.searchsorted(packed.body, np.arange(len(parts)))
    p, q = packed.near_pairs()
    depth, size = packed.overlap_depths(p, q), packed.pair_size(p, q)
    cut: dict[int, float] = {}
    for k in np.flatnonzero(depth > NO_OVERLAP * size).tolist():
        a, b = int(packed.body[p[k]]), int(packed.body[q[k]])
        i, j = int(p[k] - first[a]), int(q[k] - first[b])
        normal, low, high = _overlap(parts[a][i], parts[b][j])
        share = (0.0, 1.0) if fixed[a] else (1.0, 0.0) if fixed[b] else (0.5, 0.5)
        by = [part * (high - low) for part in share]
        if high <= low or (fixed[a] and fixed[b]) or by[0] > allowed[a] or by[1] > allowed[b]:
            continue  # cut off by now, or drawn so: whoever checks the model says it
        level = high - by[0]
        kept = _below(parts[a][i], normal, level), _below(parts[b][j], -normal, -level)
        if kept[0] is None or kept[1] is None:
            continue
        for row, part, left, depth_cut in ((a, i, kept[0], by[0]), (b, j, kept[1], by[1])):
            if depth_cut:
                parts[row][part] = left
                cut[row] = max(cut.get(row, 0.0), depth_cut)
    return {i: [Part(outline) for outline in parts[i]] for i in cut}, cut


def common(p: Array, q: Array) -> Array | None:
    """What two convex parts share, (n, 2) [m]; None where that is next to nothing."""
    edges = np.roll(q, -1, axis=0) - q
    normals = np.column_stack((edges[:, 1], -edges[:, 0]))
    normals /= np.hypot(edges[:, 0], edges[:, 1])[:, None]
    left: Array | None = p
    for normal, start in zip(normals, q, strict=True):
        if left is not None:
            left = _below(left, normal, float(normal @ start))
    return left


def _overlap(p: Array, q: Array) -> tuple[Array, float, float]:
    """The unit normal from p to q along which they overlap least, how far q reaches down along it
    and p up [m]."""
    best, found = np.inf, (np.zeros(2), 0.0, 0.0)
    for outline, sense in ((p, 1.0), (q, -1.0)):
        edges = np.roll(outline, -1, axis=0) - outline
        length = np.hypot(edges[:, 0], edges[:, 1])
        normals = sense * np.column_stack((edges[:, 1], -edges[:, 0])) / length[:, None]
        high, low = (p @ normals.T).max(axis=0), (q @ normals.T).min(axis=0)
        k = int(np.argmin(high - low))
        if high[k] - low[k] < best:
            best, found = high[k] - low[k], (normals[k], float(low[k]), float(high[k]))
    return found


def _below(outline: Array, normal: Array, level: float) -> Array | None:
    """What of a convex outline lies below a level along a normal; None where too little does."""
    height = outline @ normal - level
    near = ROUNDING * float(np.ptp(outline, axis=0).max())
    height[np.abs(height) <= near] = 0.0
    kept = []
    for k in range(len(outline)):
        if height[k] <= 0.0:
            kept.append(outline[k])
        if height[k - len(outline) + 1] * height[k] < 0.0:
            share = height[k] / (height[k] - height[k - len(outline) + 1])
            kept.append(outline[k] + share * (outline[k - len(outline) + 1] - outline[k]))
    found = np.array(kept).reshape(-1, 2)
    try:
        check_convex(found)
    except GeometryError:
        return None
    return found
