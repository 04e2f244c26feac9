"""Overlaps of a hair between convex parts of different blocks, cut off."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import NO_OVERLAP, ROUNDING
from drystone.geometry.space.cells import below, cell_of, heights, packed
from drystone.geometry.space.polyhedra import Polyhedra
from drystone.geometry.space.separation import separating_axis
from drystone.geometry.space.solid import Part, size_of


def trimmed(
    blocks: Sequence[Sequence[Part]], allowed: Sequence[float], fixed: Sequence[bool]
) -> tuple[list[list[Part]], dict[int, float]]:
    """Convex parts of blocks without overlaps that are small, and how much was cut off which [m].

    Of two parts the one loses what lies beyond the plane that separates them best: of a support
    and another the other, else of the block that comes later.

    Parameters
    ----------
    allowed
        Largest depth that is cut off each block [m].
    fixed
        Which blocks are supports.
    """
    parts = [list(own) for own in blocks]
    solids = Polyhedra.pack([[(p.vertices, p.faces) for p in own] for own in parts])
    first = np.searchsorted(solids.body, np.arange(len(parts)))
    p, q = solids.near_pairs()
    depth = solids.overlap_depths(p, q)
    size = solids.pair_size(p, q)
    cut: dict[int, float] = {}
    for k in np.flatnonzero(depth > NO_OVERLAP * size).tolist():
        a, b = int(solids.body[p[k]]), int(solids.body[q[k]])
        if depth[k] > min(allowed[a], allowed[b]):
            continue  # drawn so: whoever checks the model says it
        i, j = int(p[k] - first[a]), int(q[k] - first[b])
        normal, apart = separating_axis(_one(parts[a][i]), _one(parts[b][j]))
        if apart >= 0.0:
            continue  # cut off by now
        if fixed[b] and not fixed[a]:
            a, b, i, j, normal = b, a, j, i, -normal
        kept = _beyond(parts[b][j], normal, parts[a][i])
        if kept is not None:
            parts[b][j] = kept
            cut[b] = max(cut.get(b, 0.0), -apart)
    return parts, cut


def _one(part: Part) -> Polyhedra:
    return Polyhedra.pack([[(part.vertices, part.faces)]])


def _beyond(part: Part, normal: Array, other: Part) -> Part | None:
    """What of a part lies beyond another one along a unit normal; None where nothing is left."""
    size = size_of(part.vertices)
    tip = other.vertices[np.argmax(other.vertices @ normal)] + ROUNDING * size * normal
    points, cell = cell_of(part.vertices, part.faces)
    height = heights(points, cell, (*(-normal).tolist(), *tip.tolist()))
    kept = below(points, cell, height, ROUNDING * size, -1, {})
    return None if kept is None else Part(*packed(points, kept))
