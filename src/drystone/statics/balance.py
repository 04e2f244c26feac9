"""The equations of a static step: what is unbalanced, and the matrix that corrects it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, BoolArray
from drystone.common.compiled import njit


class BodyForces(NamedTuple):
    """Forces on the bodies, and what they are measured by; arrays are (n, n_dof)."""

    contact: Array  # N, N m, of contacts and ties
    dead: Array  # N, N m
    pattern: Array  # N, N m, of the load at multiplier one
    mass: Array  # kg, kg m2
    extent: Array  # (n,) m, by which moments are divided
    fixed: BoolArray  # (n,)
    left: Array  # N, N m, the unbalanced ones


@njit(cache=True, error_model="numpy")
def unbalance(forces, multiplier, x, inertia_factor):
    """Fill ``left`` of the forces with what is left of all on each block, zero on fixed ones.

    Returns the largest force, or moment over block size [N].
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
def stiffen(diagonal, mass, inertia_factor, damping, body, axis):
    """Add inertia to the diagonal blocks and a spring along ``axis`` (n, n_dof) to one of them.

    The spring, as stiff as the joints of the block that it restrains, makes the matrix regular at
    the peak.  Inertia does not count: that of rollers is beyond all stiffness.
    Returns its stiffness; ``body`` is -1 where there is none.
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
        square += axis[body, i] ** 2
    spring = largest / square
    for i in range(n_dof):
        for j in range(n_dof):
            diagonal[body, i, j] += spring * axis[body, i] * axis[body, j]
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
    """From K'^-1 rhs to the solution of K dx - F dl = rhs, g . dx = lag, in place; returns dl.

    With K' = K + k e e^T and s = e . dx:  dx = K'^-1 rhs + dl K'^-1 F + s k K'^-1 e.
    """
    # Flat, so that loops are long; and all products in one, as each alone waits for its last sum.
    flat = x.reshape(-1)
    by_load, by_spring = bordered.columns[1].reshape(-1), bordered.columns[2].reshape(-1)
    gradient, axis = bordered.gradient.reshape(-1), bordered.axis.reshape(-1)
    g1 = g2 = g3 = e1 = e2 = e3 = 0.0
    for i in range(flat.shape[0]):
        g, e = gradient[i], axis[i]
        g1 += g * flat[i]
        g2 += g * by_load[i]
        g3 += g * by_spring[i]
        e1 += e * flat[i]
        e2 += e * by_load[i]
        e3 += e * by_spring[i]
    determinant = g2 * (e3 - 1.0) - g3 * e2
    bordered.determinant_ratio[0] = determinant
    if determinant == 0.0:
        return np.nan
    missing = lag - g1
    change = (missing * (e3 - 1.0) + g3 * e1) / determinant
    along = (-g2 * e1 - e2 * missing) / determinant
    for i in range(flat.shape[0]):
        flat[i] += change * by_load[i] + along * by_spring[i]
    return change
