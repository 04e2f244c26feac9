"""Faces that are bent, cut into flat pieces: fans from their first corners, or along their bends.

A face of more than three corners that do not lie in a plane says nothing of what is between them.
Programs that draw and measure such faces take the fan of triangles from the first corner, and so is
the volume that they tell.  What was meant may be another surface: flat pieces that meet in bends.
Where another solid lies on a face, both must be cut alike, and bends are what both of them have.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.tolerances import ROUNDING
from drystone.geometry.space.flatness import flat_pieces, triangles
from drystone.geometry.space.meshes import Mesh, face_normals, unevenness

Loop = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Cut:
    """A mesh of which faces were cut."""

    whole: Mesh  # as it was
    pieces: tuple[tuple[Loop, ...], ...]  # of each of its faces
    bent: tuple[int, ...]  # faces that were bent

    @property
    def mesh(self) -> Mesh:
        """All the pieces."""
        return Mesh(self.whole.vertices, tuple(loop for own in self.pieces for loop in own))

    @property
    def owner(self) -> list[int]:
        """The face that each piece is of."""
        return [k for k, own in enumerate(self.pieces) for _ in own]


def along_bends(mesh: Mesh, near: float) -> Cut:
    """Faces whose corners are farther than ``near`` [m] off a plane cut along their bends."""
    pieces = [
        (face,) if off <= near else tuple(flat_pieces(mesh.vertices, face, near))
        for face, off in zip(mesh.faces, unevenness(mesh).tolist(), strict=True)
    ]
    bent = tuple(k for k, own in enumerate(pieces) if len(own) > 1)
    return Cut(mesh, tuple(pieces), bent)


def as_fans(cut: Cut) -> Cut | None:
    """All bent faces cut into fans instead; None where the surface would cross or fold itself."""
    pieces = list(cut.pieces)
    for k in cut.bent:
        pieces[k] = fan_of(cut.whole.faces[k])
    fans = Cut(cut.whole, tuple(pieces), cut.bent)
    if _is_folded(fans):
        return None
    for k in cut.bent:
        others = [loop for m, own in enumerate(pieces) if m != k for loop in own]
        if _crosses(cut.whole.vertices, pieces[k], others):
            return None
    return fans


def fan_of(face: Loop) -> tuple[Loop, ...]:
    """Triangles from a face's first corner."""
    return tuple((face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1))


def _is_folded(cut: Cut) -> bool:
    """Whether triangles of a bent face have no area, or are turned over against the one beside
    them, as in a fan from a corner that does not see all of a concave face."""
    for k in cut.bent:
        normals = face_normals(Mesh(cut.whole.vertices, cut.pieces[k]))
        length = np.linalg.norm(normals, axis=1)
        if length.min() <= ROUNDING * length.max():
            return True
        normals /= length[:, None]
        if np.sum(normals[1:] * normals[:-1], axis=1).min(initial=1.0) <= 0.0:
            return True
    return False


def _crosses(vertices: Array, fan: Sequence[Loop], others: Sequence[Loop]) -> bool:
    """Whether triangles pierce any of the other faces, or are pierced by them."""
    corners = vertices[list({i for loop in fan for i in loop})]
    low, high = corners.min(axis=0), corners.max(axis=0)
    around = [
        piece
        for loop in others
        if np.all(vertices[list(loop)].min(axis=0) <= high)
        and np.all(vertices[list(loop)].max(axis=0) >= low)
        for piece in triangles(vertices, loop)
    ]
    if not around:
        return False
    one, other = np.array(fan), np.array(around)
    return _pierces(vertices, _edges(one), other) or _pierces(vertices, _edges(other), one)


def _edges(loops: IntArray) -> IntArray:
    pairs = np.concatenate([loops[:, [i, (i + 1) % 3]] for i in range(3)])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _pierces(vertices: Array, edges: IntArray, loops: IntArray) -> bool:
    """Whether an edge goes through a triangle with which it has no corner in common."""
    start = vertices[edges[:, 0]][:, None]
    way = vertices[edges[:, 1]][:, None] - start
    a, b, c = (vertices[loops[:, i]][None] for i in range(3))
    p, q = b - a, c - a
    across = np.cross(way, q)
    scale = np.sum(p * across, axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        arm = start - a
        u = np.sum(arm * across, axis=2) / scale
        turned = np.cross(arm, np.broadcast_to(p, arm.shape))
        v = np.sum(way * turned, axis=2) / scale
        along = np.sum(q * turned, axis=2) / scale
        hit = (
            (u > ROUNDING)
            & (v > ROUNDING)
            & (u + v < 1.0 - ROUNDING)
            & (along > ROUNDING)
            & (along < 1.0 - ROUNDING)
        )
    apart = np.all(edges[:, None, :, None] != loops[None, :, None, :], axis=(2, 3))
    return bool(np.any(hit & apart))
