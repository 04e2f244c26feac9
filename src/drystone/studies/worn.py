"""Blocks with corners broken off, in the plane and in space.

A plane cuts each corner off, so that what is left of faces and joints stays where it was: blocks
fit as before, over less.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import linprog

from drystone.common.arrays import Array
from drystone.geometry import GeometryError
from drystone.geometry.space.solid import Faces, Part, face_planes, size_of
from drystone.model.assembly import Block, Corner
from drystone.studies.errors import StudyError

#: Most of an edge that goes with one of its corners: two leave a fifth of it.
_MOST = 0.4
#: Least cut, over the size of the block: at a right corner the face it leaves, 0.87 cuts squared,
#: has 8 times the area that counts as none (`DEGENERATE`).
_LEAST = 1e-4


def worn(block: Block, deviation: float, rng: np.random.Generator, corner: Corner) -> Block:
    """The block with each corner cut off, by up to a half normal length along its edges.

    Parameters
    ----------
    deviation
        Standard deviation of the normal distribution [m].
    corner
        How the model treats corners.  One that is rounded off by more than the cut stays: the cut
        would lie in the air.

    Raises
    ------
    StudyError
        The block is no block, is concave or of several parts, or corners have chamfers.
    """
    if corner.chamfer:
        raise StudyError(
            ["imperfection: vertices stands beside [corner] chamfer: take one of them"]
        )
    try:
        figure = block.figure()
    except GeometryError as error:
        raise StudyError([f'block "{block.id}": {error}']) from None
    if len(figure.parts) > 1:
        raise StudyError(
            [f'imperfection: vertices is for convex blocks, and "{block.id}" is concave or of '
             "several parts: give blocks without it"]
        )  # fmt: skip
    (part,) = figure.parts
    lengths = np.abs(rng.normal(0.0, deviation, len(part.vertices)))
    lengths[lengths < _LEAST * size_of(part.vertices)] = 0.0
    around, sides = _in_space(part) if part.faces else _in_the_plane(part.vertices)
    cuts = [
        _cut(vertex, part.vertices[others], normals, length, corner.radius or 0.0)
        for vertex, others, normals, length in zip(
            part.vertices, around, sides, lengths, strict=True
        )
    ]
    return Block(
        id=block.id, vertices=np.vstack(cuts), faces=_faces(part.faces, around, cuts),
        unit_weight=block.unit_weight, material=block.material, support=block.support,
        groups=block.groups, held=block.held,
    )  # fmt: skip


def _in_the_plane(vertices: Array) -> tuple[list[list[int]], list[Array]]:
    """Of each corner the one before and the one after, and inward normals of its sides (2, 2)."""
    n = len(vertices)
    edges = np.roll(vertices, -1, axis=0) - vertices
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    inward = np.column_stack((-edges[:, 1], edges[:, 0]))
    return [[(i - 1) % n, (i + 1) % n] for i in range(n)], [inward[[i - 1, i]] for i in range(n)]


def _in_space(part: Part) -> tuple[list[list[int]], list[Array]]:
    """Of each corner its neighbours, clockwise from outside, and inward normals of its faces."""
    outward, _ = face_planes(part.vertices, part.faces)
    before: list[dict[int, int]] = [{} for _ in part.vertices]  # in a face, by the one after
    normals: list[list[Array]] = [[] for _ in part.vertices]
    for face, normal in zip(part.faces, outward, strict=True):
        for one, corner, other in zip((face[-1], *face), face, (*face[1:], face[0]), strict=False):
            before[corner][other] = one
            normals[corner].append(-normal)
    around = []
    for own in before:
        ring = [next(iter(own))]
        while (following := own[ring[-1]]) != ring[0]:
            ring.append(following)
        around.append(ring)
    return around, [np.array(own) for own in normals]


def _cut(vertex: Array, others: Array, normals: Array, length: float, radius: float) -> Array:
    """Where a plane meets the edges of a corner, (k, dim), the farthest at a length [m] from it.

    The corner itself where nothing is cut off, or where rounding takes off more.
    """
    edges = others - vertex
    extent = np.linalg.norm(edges, axis=1)
    edges = edges / extent[:, np.newaxis]
    inward = edges.sum(axis=0)
    along = edges @ inward
    if not length or along.min() <= 0.0:  # no such plane cuts off alone a corner so uneven
        return vertex[np.newaxis]
    depth = min(length, _MOST * float(extent.min())) * float(along.min())
    if radius and depth <= _rounded_off(normals, inward, radius):
        return vertex[np.newaxis]
    return np.asarray(vertex + (depth / along)[:, np.newaxis] * edges)


def _rounded_off(normals: Array, inward: Array, radius: float) -> float:
    """How deep a rounded corner lies along a vector, in the length of it.

    The ball that rounds it has its centre at least a radius from all sides.
    """
    if normals.shape[0] == normals.shape[1]:
        centre = np.linalg.solve(normals, np.full(len(normals), radius)) @ inward
    else:
        centre = linprog(
            inward, A_ub=-normals, b_ub=np.full(len(normals), -radius), bounds=(None, None)
        ).fun
    return float(centre - radius * np.linalg.norm(inward))


def _faces(faces: Faces, around: Sequence[Sequence[int]], cuts: Sequence[Array]) -> Faces:
    """Faces of what is left, with one for each corner that is cut off; none of an outline."""
    if not faces:
        return ()
    row: dict[tuple[int, int], int] = {}
    caps: list[tuple[int, ...]] = []
    first = 0
    for corner, (others, cut) in enumerate(zip(around, cuts, strict=True)):
        is_cut = len(cut) > 1
        row |= {(corner, other): first + is_cut * k for k, other in enumerate(others)}
        if is_cut:
            caps.append(tuple(range(first, first + len(cut))))
        first += len(cut)
    left: list[tuple[int, ...]] = []
    for face in faces:
        ring = [row[pair] for a, b in pairwise((*face, face[0])) for pair in ((a, b), (b, a))]
        left.append(
            tuple(k for k, before in zip(ring, (ring[-1], *ring), strict=False) if k != before)
        )
    return (*left, *caps)
