"""The equations of a static step: what is unbalanced, and the matrix that corrects it."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit


@njit(cache=True, error_model="numpy")
def unbalance(contact, dead, pattern, multiplier, mass, x, inertia_factor, extent, fixed, force):
    """Fill ``force`` (n, n_dof) with what is left of all forces on each block, zero on fixed ones.

    Returns the largest force, or moment over block size [N].
    """
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

    The spring, as stiff as the block it holds, makes the matrix regular at the peak.  Returns its
    stiffness; ``body`` is -1 where there is none.
    """
    n, n_dof = mass.shape
    for i in range(n):
        for d in range(n_dof):
            diagonal[i, d, d] += mass[i, d] * (inertia_factor + damping[i])
    if body < 0:
        return 0.0
    largest = 0.0
    square = 0.0
    for i in range(n_dof):
        square += axis[body, i] ** 2
        for j in range(n_dof):
            largest = max(largest, abs(diagonal[body, i, j]))
    spring = largest / square
    for i in range(n_dof):
        for j in range(n_dof):
            diagonal[body, i, j] += spring * axis[body, i] * axis[body, j]
    return spring
