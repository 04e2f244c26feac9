"""Blocks that differ from their design: worn corners, uneven units, missing and loose blocks.

None of them overlaps another: corners are broken off (`worn`), loose blocks are smaller, and units
of uneven sizes fill their courses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.model.assembly import Block, Corner
from drystone.model.construction.fit import turned_round
from drystone.studies.errors import StudyError
from drystone.studies.study import Imperfection
from drystone.studies.worn import worn

#: Share of a structure's size under which two levels are the same.
_SAME = 1e-9


def imperfect(
    blocks: Sequence[Block], what: Imperfection, seed: int, corner: Corner | None = None
) -> list[Block]:
    """The blocks as built.

    Each kind of imperfection draws from a stream of its own, so that one does not change another.

    Parameters
    ----------
    corner
        How the model treats corners; sharp ones by default.

    Raises
    ------
    StudyError
        Where blocks are not of the kind that the imperfection is for.
    """
    sizes, wear, missing, loose = (
        np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(4)
    )
    if what.vertices is not None:
        blocks, _ = turned_round(
            blocks
        )  # as the model's check does with outlines that run clockwise
    if what.unit_sizes is not None:
        blocks = _uneven(blocks, what.unit_sizes, sizes)
    meant = [not block.support and _is_meant(block, what.blocks) for block in blocks]
    removed = missing.random(len(blocks)) < (what.missing or 0.0)
    free = loose.random(len(blocks)) < (what.loose or 0.0)
    found: list[Block] = []
    for block, changes, is_removed, is_loose in zip(blocks, meant, removed, free, strict=True):
        if changes and is_removed:
            continue
        if changes and is_loose and what.loose_gap is not None:
            block = _smaller(block, what.loose_gap)
        if changes and what.vertices is not None:
            block = worn(block, what.vertices, wear, corner or Corner())
        found.append(block)
    return found


def _is_meant(block: Block, names: Sequence[str]) -> bool:
    return not names or any(fnmatchcase(block.id, n) or n in block.groups for n in names)


def _smaller(block: Block, gap: float) -> Block:
    """The block shrunk on its bed, so that all other sides lie free by a gap [m]."""
    low, high = block.vertices.min(axis=0), block.vertices.max(axis=0)
    share = 1.0 - np.array([*[2.0] * (len(low) - 1), 1.0]) * gap / (high - low)
    if share.min() <= 0.0:
        raise StudyError([f'imperfection: loose_gap is larger than the block "{block.id}"'])
    fixed = np.array([*(0.5 * (low + high))[:-1], low[-1]])
    return block.with_vertices(fixed + share * (block.vertices - fixed))


def _uneven(blocks: Sequence[Block], share: float, rng: np.random.Generator) -> list[Block]:
    """Courses of uneven heights, of units of uneven lengths; each course is as long as before."""
    laid = [block for block in blocks if not block.support]
    if not _are_rectangles(laid):
        raise StudyError(
            ["imperfection: unit_sizes is for courses of rectangles in the plane: take it out"]
        )
    same = _SAME * float(np.ptp(np.vstack([block.vertices for block in laid]), axis=0).max())
    level = _Levels([y for block in laid for y in block.vertices[:, 1]], same)
    heights = np.diff(level.places) * (1.0 + rng.uniform(-share, share, len(level.places) - 1))
    new_level = level.places[0] + np.concatenate(([0.0], np.cumsum(heights)))
    moved: dict[str, Block] = {}
    courses: dict[int, list[Block]] = {}
    for block in laid:
        lowest = block.vertices[:, 1].min(keepdims=True)
        courses.setdefault(int(level.rows(lowest)[0]), []).append(block)
    for row in sorted(courses):
        course = sorted(courses[row], key=lambda block: float(block.vertices[0, 0]))
        ends = _Levels([x for block in course for x in block.vertices[:, 0]], same)
        new_ends = _shared_out(ends.places, share, rng)
        for block in course:
            x, y = block.vertices.T
            corners = np.column_stack((new_ends[ends.rows(x)], new_level[level.rows(y)]))
            moved[block.id] = replace(block, vertices=corners)
    return [moved.get(block.id, block) for block in blocks]


def _shared_out(places: Array, share: float, rng: np.random.Generator) -> Array:
    """Places along a course with lengths between them varied, and the same whole."""
    lengths = np.diff(places)
    varied = lengths * (1.0 + rng.uniform(-share, share, len(lengths)))
    varied *= lengths.sum() / varied.sum()
    new = places[0] + np.concatenate(([0.0], np.cumsum(varied)))
    new[-1] = places[-1]
    return new


def _are_rectangles(blocks: Sequence[Block]) -> bool:
    """Of sides along the axes; four of them close around an outline alone, never a solid."""
    if any(len(block.vertices) != 4 or block.parts for block in blocks):
        return False
    vertices = np.array([block.vertices for block in blocks])
    sides = np.abs(np.roll(vertices, -1, axis=1) - vertices)
    longest = sides.max(axis=(1, 2), keepdims=True)
    return bool(((sides > _SAME * longest).sum(axis=2) == 1).all())


class _Levels:
    """Numbers that are the same but for rounding, in order."""

    def __init__(self, values: Sequence[float], same: float) -> None:
        ordered = np.sort(np.asarray(values, dtype=float))
        apart = np.concatenate(([True], np.diff(ordered) > same))
        self.places: Array = ordered[apart]

    def rows(self, values: Array) -> IntArray:
        """Rows of the places that are nearest, (n,)."""
        return np.abs(self.places - values[:, np.newaxis]).argmin(axis=1)
