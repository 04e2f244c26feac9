"""Outlines as they were drawn, made to fit: turned round, vertices amid straight edges left out,
and joints closed that nearly are.

Drawings are never exact.  A gap or an overlap of a hair between two edges that were meant to lie on
each other would be a joint that carries nothing, or one under stress before any load.  Edges that
lie on each other within a tolerance, and all that lie on those, are therefore given one line:
that of a support where there is one, otherwise the mean of their own.  Every corner of a block
then stands where the lines of its two edges meet.  What fits already stays as it is, to the last
bit.  Solids stay as they were drawn, but for faces that run the wrong way round: a vertex of three
faces and more has no place to go that keeps all of them flat.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.names import number_of
from drystone.common.tolerances import FLAT
from drystone.geometry.dimension import dimension_of
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.links import components
from drystone.geometry.plane import polygon
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.space import solid
from drystone.geometry.space.solid import Part
from drystone.model.assembly import Block
from drystone.model.construction.words import listed, millimetres

#: Share of the smallest edge up to which gaps and overlaps are those of a drawing.
DRAWING_TOLERANCE = 1e-3
#: Distance, over the size of everything and its distance from the origin, that is rounding.
ROUNDING = 1e-13
#: Sine of the angle under which two edges of a block are one, and have no corner to compute.
STRAIGHT = 1e-2


def turned_round(blocks: Sequence[Block]) -> tuple[list[Block], tuple[str, ...]]:
    """The blocks with clockwise outlines and faces the other way round, and a sentence on which."""
    turned = [_turned_round(block) for block in blocks]
    ids = [block.id for block, before in zip(turned, blocks, strict=True) if block is not before]
    if not ids:
        return turned, ()
    what, was = dimension_of(max(block.dimension for block in blocks)).run_round(len(ids))
    return turned, (f"block: {what} ran clockwise and {was} turned round: {listed(ids)}",)


def _turned_round(block: Block) -> Block:
    """The block itself where nothing of it runs clockwise."""
    if block.parts:
        parts = tuple(_part_turned_round(part) for part in block.parts)
        if all(part is before for part, before in zip(parts, block.parts, strict=True)):
            return block
        return replace(block, vertices=np.vstack([part.vertices for part in parts]), parts=parts)
    part = Part(block.vertices, block.faces)
    turned = _part_turned_round(part)
    if turned is part:
        return block
    return replace(block, vertices=turned.vertices, faces=turned.faces)


def _part_turned_round(part: Part) -> Part:
    if polygon.is_clockwise(part.vertices):
        return Part(part.vertices[::-1].copy())
    if part.faces and solid.is_inside_out(part.vertices, part.faces):
        return Part(part.vertices, tuple(face[::-1] for face in part.faces))
    return part


def straightened(blocks: Sequence[Block]) -> tuple[list[Block], tuple[str, ...]]:
    """The blocks of the plane without vertices amid straight edges, and a sentence on which.

    An edge is as straight as a face of a solid is flat.  Contact between two parts is on one edge
    of each: half an edge would carry the load of both halves.
    """
    straight = [_straightened(block) for block in blocks]
    pairs = list(zip(straight, blocks, strict=True))
    ids = [block.id for block, before in pairs if block is not before]
    if not ids:
        return list(blocks), ()
    n = sum(len(before.vertices) - len(block.vertices) for block, before in pairs)
    what = "1 vertex amid a straight edge was" if n == 1 else f"{n} vertices amid edges were"
    return straight, (f"block: {what} left out: {listed(ids)}",)


def _straightened(block: Block) -> Block:
    """The block itself where every vertex of it bends its outline, and in space."""
    if block.dimension == 3:
        return block
    parts = [_without_straight(outline) for outline in _outlines_of(block)]
    if sum(map(len, parts)) == len(block.vertices):
        return block
    own = tuple(map(Part, parts)) if block.parts else ()
    return replace(block, vertices=np.vstack(parts), parts=own)


def _without_straight(outline: Array) -> Array:
    return outline[polygon.turning(outline, FLAT * solid.size_of(outline))]


def _outlines_of(block: Block) -> list[Array]:
    """Of the parts of a block of the plane."""
    return [part.vertices for part in block.parts] or [block.vertices]


def fitted(blocks: Sequence[Block], tolerance: float) -> tuple[list[Block], tuple[str, ...]]:
    """The blocks with joints closed that nearly are, and a sentence on what was moved.

    Parameters
    ----------
    blocks
        With outlines that are counter-clockwise.
    tolerance
        Largest gap or overlap that is closed, over the smallest edge of all blocks; no corner is
        moved further than that.
    """
    if any(block.dimension == 3 for block in blocks):
        return list(blocks), ()
    shapes = [_outlines_of(block) for block in blocks]
    # Each part by itself: where two of a block lie on each other, they get one line as well.
    outlines = Outlines.pack([[outline] for own in shapes for outline in own])
    distance = tolerance * float(outlines.edges[1].min())
    if not distance > 0.0:
        return list(blocks), ()
    fixed = np.array(
        [block.support for block, own in zip(blocks, shapes, strict=True) for _ in own]
    )
    vertices, n_joints = _closed(outlines, fixed, distance)
    way = np.hypot(*(vertices - outlines.vertices).T)
    moved = (way > 0.0) & (way <= distance)  # what would go further stays, and is refused later
    if n_joints == 0 or not moved.any():
        return list(blocks), ()
    vertices = np.where(moved[:, None], vertices, outlines.vertices)
    joints = number_of(n_joints, "joint")
    note = (
        f"block: {joints} gaped or overlapped by up to {tolerance:g} of the smallest edge as "
        f"drawn; to close them {np.count_nonzero(moved)} vertices were moved, by up to "
        f"{millimetres(float(way[moved].max()))} (drawing_tolerance)"
    )
    last = np.cumsum([len(block.vertices) for block in blocks])[:-1]
    pieces = np.split(vertices, last)
    return [
        block.with_vertices(piece) if np.any(piece != block.vertices) else block
        for block, piece in zip(blocks, pieces, strict=True)
    ], (note,)


def _closed(outlines: Outlines, fixed: BoolArray, distance: float) -> tuple[Array, int]:
    """Vertices with all joints closed that are open or overlap by up to ``distance`` [m].

    And how many joints there were of that kind.
    """
    shared = Interfaces.of(outlines, distance)
    e, f = shared.face_a, shared.face_b
    vertices, following = outlines.vertices, outlines.following
    still = fixed[outlines.owner]
    origin = vertices.mean(axis=0)
    start, end = vertices - origin, vertices[following] - origin
    tangent = end - start
    length = np.hypot(tangent[:, 0], tangent[:, 1])
    tangent = tangent / length[:, None]
    normal = np.column_stack((tangent[:, 1], -tangent[:, 0]))
    level = np.sum(normal * start, axis=1)

    n = len(vertices)
    line = components(n, e, f)
    rounding = ROUNDING * (float(np.ptp(vertices, axis=0).max()) + float(np.abs(origin).max()))
    ends = start[e, None] + shared.extent[:, :, None] * tangent[e, None]  # of the common part
    misfit = np.abs(np.einsum("kij,kj->ki", ends, normal[f]) - level[f, None]).max(axis=1)
    apart = misfit > rounding
    apart &= ~(still[e] & still[f])
    open_lines = np.unique(line[e[apart]])
    altered = np.isin(line, open_lines)
    for k in open_lines:
        edges = np.flatnonzero(line == k)
        given = edges[still[edges]]
        chosen = given if len(given) else edges
        sense = np.where(normal[chosen] @ normal[chosen[0]] > 0.0, 1.0, -1.0)
        weight = length[chosen] / length[chosen].sum()
        mean = (weight * sense) @ normal[chosen]
        mean /= np.hypot(*mean)
        middle = 0.5 * (start[chosen] + end[chosen])
        at = float(weight @ (middle @ mean))
        way = np.where(normal[edges] @ mean > 0.0, 1.0, -1.0)
        normal[edges], level[edges] = way[:, None] * mean, way * at

    before = np.empty(n, np.int64)
    before[following] = np.arange(n)
    touched = (altered | altered[before]) & ~still
    corners = _corners(normal, level, altered, before, start)
    return np.where(touched[:, None], corners + origin, vertices), int(np.count_nonzero(apart))


def _corners(
    normal: Array, level: Array, altered: BoolArray, before: IntArray, start: Array
) -> Array:
    """Where each edge's line meets that of the edge before it; on the altered one if straight."""
    p, q = normal[before], normal
    sine = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    straight = np.abs(sine) < STRAIGHT
    safe = np.where(straight, 1.0, sine)
    a, b = level[before], level
    meeting = np.column_stack((a * q[:, 1] - b * p[:, 1], b * p[:, 0] - a * q[:, 0]))
    meeting /= safe[:, None]
    onto, at = (np.where(altered[:, None], q, p), np.where(altered, b, a))
    foot = start + (at - np.sum(onto * start, axis=1))[:, None] * onto
    return np.where(straight[:, None], foot, meeting)
