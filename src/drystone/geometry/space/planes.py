"""Vertices moved as little as may be, so that those that belong to a plane lie in it.

Which vertices belong to which plane is known, where the planes lie is not: they are found together.
With unit normals n, offsets d and vertices x + u, each vertex of each plane is to have
n . (x + u) = d.  Of all solutions the one of least sum of u . u is taken (Gauss, Newton, Lagrange):
each iteration solves the equations linearised in u, in d and in the tilts of n.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import BETTER, FIXED_VERTEX, SPARE, SUMS
from drystone.geometry.space.solid import plane_axes

MOST_ITERATIONS = 12


@dataclass(frozen=True, eq=False)
class Incidences:
    """Which vertices belong to which planes, sorted by planes."""

    vertex: IntArray  # (k,) row of the vertex
    plane: IntArray  # (k,) number of the plane, from 0 without gaps

    @property
    def start(self) -> IntArray:
        """Row of each plane's first incidence, and the end, (n_planes + 1,)."""
        return np.append(np.flatnonzero(np.diff(self.plane, prepend=-1)), len(self.plane))

    @classmethod
    def of(cls, vertex: IntArray, plane: IntArray, dimension: int = 3) -> Incidences:
        """Each pair once; planes that any vertices lie in, as three in space, are left out."""
        pairs = np.unique(np.column_stack((plane, vertex)), axis=0)
        number, count = np.unique(pairs[:, 0], return_counts=True)
        pairs = pairs[np.isin(pairs[:, 0], number[count > dimension])]
        _, dense = np.unique(pairs[:, 0], return_inverse=True)
        return cls(pairs[:, 1].astype(np.int64), dense.reshape(-1).astype(np.int64))


@dataclass(frozen=True, eq=False)
class Fit:
    """Planes fitted to vertices."""

    normal: Array  # (n_planes, 3)
    middle: Array  # (n_planes, 3) m
    reach: Array  # (n_planes,) m, of the farthest vertex from the middle
    off: Array  # (k,) m, of each incidence


def fitted_planes(vertices: Array, incidences: Incidences) -> Fit:
    """The planes that fit best, one by one."""
    if not len(incidences.vertex):
        return Fit(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    start, plane = incidences.start, incidences.plane
    points = vertices[incidences.vertex]
    middle = np.add.reduceat(points, start[:-1]) / np.diff(start)[:, None]
    arm = points - middle[plane]
    spread = np.add.reduceat(arm[:, :, None] * arm[:, None, :], start[:-1])
    normal = np.linalg.eigh(spread)[1][:, :, 0]  # of least spread
    return Fit(
        normal=normal,
        middle=middle,
        reach=np.maximum.reduceat(np.linalg.norm(arm, axis=1), start[:-1]),
        off=np.sum(arm * normal[plane], axis=1),
    )


def onto_planes(vertices: Array, incidences: Incidences, fixed: BoolArray) -> Array:
    """Vertices (n, 3) [m] moved into their planes.

    Parameters
    ----------
    fixed
        Which vertices give way last, (n,): a million times less than the others, as the weight of
        their motions, `FIXED_VERTEX`, enters twice.

    What cannot be had, as five planes through one vertex where others hold them, is met as well as
    may be: `fitted_planes` tells by how much it is missed.
    """
    if not len(incidences.vertex):
        return vertices
    place = vertices.copy()
    size = float(np.ptp(vertices, axis=0).max())
    ease = np.where(fixed, FIXED_VERTEX, 1.0)
    missed = np.inf
    for _ in range(MOST_ITERATIONS):
        fit = fitted_planes(place, incidences)
        worst = float(np.abs(fit.off).max())
        if worst <= SUMS * size or worst > BETTER * missed:
            break
        missed = worst
        place += _step(place, incidences, fit, ease)
    return place


def _step(place: Array, incidences: Incidences, fit: Fit, ease: Array) -> Array:
    """Motions (n, 3) [m] that solve the linearised equations."""
    vertex, plane = incidences.vertex, incidences.plane
    k, n, m = len(vertex), len(place), len(fit.normal)
    rows = np.arange(k)
    normal = fit.normal[plane]
    soft = ease[vertex]
    moves = csr_array(
        (
            (normal * soft[:, None]).ravel(),
            (np.repeat(rows, 3), (3 * vertex[:, None] + np.arange(3)).ravel()),
        ),
        shape=(k, 3 * n),
    )
    axes = np.array([plane_axes(own) for own in fit.normal])
    arm = (place[vertex] - fit.middle[plane]) / fit.reach[plane, None]
    tilt = np.einsum("ki,kij->kj", arm, axes[plane])
    columns = np.column_stack((tilt, np.ones(k)))
    planes = csr_array(
        (columns.ravel(), (np.repeat(rows, 3), (3 * plane[:, None] + np.arange(3)).ravel())),
        shape=(k, 3 * m),
    )
    system = block_array(
        [
            [moves @ moves.T + SPARE * eye_array(k), planes],
            [planes.T, -SPARE * eye_array(3 * m)],
        ],
        format="csc",
    )
    load = np.concatenate((-fit.off, np.zeros(3 * m)))
    force = splu(system).solve(load)[:k]
    return (moves.T @ force).reshape(n, 3) * ease[:, None]
