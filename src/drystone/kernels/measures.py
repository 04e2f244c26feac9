"""Sums over the blocks and contacts of a converged step, in one pass: see `engines.measures`."""

from __future__ import annotations

import numpy as np
from numba import njit

NONE = 0


@njit(cache=True)
def sum_blocks(
    increment, acceleration, velocity, contact, held, dead, pattern, mass, fixed, direction,
    multiplier,
):  # fmt: skip
    """Forces, works and energy of a step.

    Parameters
    ----------
    increment, acceleration, velocity
        (n, n_dof) [m, m/s2, m/s; rad, rad/s2, rad/s].
    contact, dead, pattern
        Forces, (n, n_dof) [N, N m]; the pattern is that at multiplier one.
    held
        (n,) whether a contact acts on the block.
    mass
        (n, n_dof) [kg, kg m2].
    fixed
        (n,) supports.
    direction
        (dim,) of the load.

    Returns
    -------
    carried
        What the blocks hand to the supports along the load, less the dead load [N].
    inertia
        Sum of the sizes of all inertia forces [N].
    fastest
        Largest acceleration of a centroid [m/s2].
    kinetic, work
        Kinetic energy; size of the work of all loads [J].
    push, strokes, resistance
        Of the blocks that contacts hold: work of the pattern at multiplier one, that without
        regard to signs, work of the inertia forces [J].
    """
    n, n_dof = increment.shape
    dim = direction.shape[0]
    carried, inertia, fastest = 0.0, 0.0, 0.0
    kinetic, work = 0.0, 0.0
    push, strokes, resistance = 0.0, 0.0, 0.0
    for i in range(n):
        force, square = 0.0, 0.0
        for d in range(dim):
            if fixed[i]:
                carried += contact[i, d] * direction[d]
            carried -= dead[i, d] * direction[d]
            force += (mass[i, d] * acceleration[i, d]) ** 2
            square += acceleration[i, d] ** 2
        inertia += np.sqrt(force)
        fastest = max(fastest, square)
        for d in range(n_dof):
            kinetic += 0.5 * mass[i, d] * velocity[i, d] ** 2
            work += (dead[i, d] + multiplier * pattern[i, d]) * increment[i, d]
        if not held[i]:
            continue
        for d in range(n_dof):
            stroke = pattern[i, d] * increment[i, d]
            push += stroke
            strokes += abs(stroke)
            resistance += mass[i, d] * acceleration[i, d] * increment[i, d]
    return carried, inertia, np.sqrt(fastest), kinetic, abs(work), push, strokes, resistance


@njit(cache=True)
def count_contacts(kind, gap, status, counts):
    """Count the contacts of each status into ``counts`` (3,); returns the deepest overlap [m]."""
    counts[:] = 0
    deepest = 0.0
    for k in range(kind.shape[0]):
        deepest = max(deepest, -gap[k])
        if kind[k] != NONE:
            counts[status[k]] += 1
    return deepest
