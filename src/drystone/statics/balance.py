"""The equations of a static step: the unbalanced forces, and the solution of the bordered system.

All kernels work on fields (n, n_dof): forces or motions of all bodies.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.compiled import njit


class BodyForces(NamedTuple):
    """Forces on the bodies, with mass and size; arrays are (n, n_dof) unless said otherwise."""

    contact: Array  # N, N m, of contacts and ties
    dead: Array  # N, N m, dead load
    pattern: Array  # N, N m, load pattern, at multiplier one
    mass: Array  # kg, kg m2
    extent: Array  # (n,) m, by which moments are divided
    fixed: BoolArray  # (n,)
    left: Array  # N, N m, unbalanced forces


@njit(cache=True, error_model="numpy")
def unbalance(forces, multiplier, x, inertia_factor):
    """Fill ``left`` of the forces with the unbalanced force on each block, zero on fixed blocks.

    ``x`` (n, n_dof) are the increments; ``inertia_factor`` [1/s2] times mass times increment is the
    inertia.  Returns the largest unbalanced force, or moment over block size [N].
    """
    contact, dead, pattern, mass, extent, fixed, force = forces
    n, n_dof = x.shape
    worst = 0.0
    for i in range(n):
        if fixed[i]:
            force[i, :] = 0.0
            continue
        for d in range(n_dof):
            f = contact[i, d] + dead[i, d] + multiplier * pattern[i, d]
            force[i, d] = f - mass[i, d] * x[i, d] * inertia_factor
        size = np.sqrt(force[i, 0] ** 2 + force[i, 1] ** 2)
        turning = abs(force[i, 2])
        if n_dof == 6:
            size = np.sqrt(size * size + turning * turning)
            turning = np.sqrt(force[i, 3] ** 2 + force[i, 4] ** 2 + force[i, 5] ** 2)
        worst = max(worst, size, turning / extent[i])
    return worst


@njit(cache=True, error_model="numpy")
def stiffen(diagonal, mass, inertia_factor, damping, body, gradient):
    """Add inertia and damping to the ``diagonal`` blocks (n, n_dof, n_dof), and a spring along
    the ``gradient`` (n, n_dof) of a displacement of ``body`` to its block.

    The spring makes the matrix regular at the peak.  It is as stiff as the joints of the body that
    it restrains.  This stiffness is read before inertia is added, because a roller is a mass that
    exceeds all stiffness.  Returns the stiffness of the spring; ``body`` is -1 if there is none.
    """
    n, n_dof = mass.shape
    largest = 0.0
    if body >= 0:
        for i in range(n_dof):
            for j in range(n_dof):
                largest = max(largest, abs(diagonal[body, i, j]))
    for i in range(n):
        for d in range(n_dof):
            diagonal[i, d, d] += mass[i, d] * (inertia_factor + damping[i])
    if body < 0:
        return 0.0
    square = 0.0
    for i in range(n_dof):
        square += gradient[body, i] ** 2
    spring = largest / square
    for i in range(n_dof):
        for j in range(n_dof):
            diagonal[body, i, j] += spring * gradient[body, i] * gradient[body, j]
    return spring


@njit(cache=True, error_model="numpy")
def dot(first, second):
    """Scalar product of two fields (n, n_dof)."""
    total = 0.0
    for i in range(first.shape[0]):
        for d in range(first.shape[1]):
            total += first[i, d] * second[i, d]
    return total


@njit(cache=True, error_model="numpy")
def solve_bordered(bordered, x, lag):
    """Solve K dx - F dl = rhs, g . dx = lag, in place from ``x`` = K'^-1 (rhs + k lag g), (n,
    n_dof); returns dl, NaN if the system is singular.

    K' = K + k g g^T has a spring k along g.  With g . dx = lag, its force k lag g is known.
    """
    flat, by_load = x.reshape(-1), bordered.columns[1].reshape(-1)
    gradient = bordered.gradient.reshape(-1)
    moved = compliance = 0.0
    for i in range(flat.shape[0]):
        moved += gradient[i] * flat[i]
        compliance += gradient[i] * by_load[i]
    bordered.compliance[0] = compliance
    if compliance == 0.0:
        return np.nan
    change = (lag - moved) / compliance
    for i in range(flat.shape[0]):
        flat[i] += change * by_load[i]
    return change
