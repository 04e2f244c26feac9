"""How far a solution is from the equations of a step: the one measure that judges every solver."""

from __future__ import annotations

import numpy as np
from numba import njit

from drystone.kernels.contacts import BODY_A, BODY_B
from drystone.kernels.rows import add_force


@njit(cache=True)
def unbalanced_force(force, inertia, extent, fixed):
    """Largest force, or moment over block size, that is not balanced on a movable block [N].

    Not a number where a force is none.  ``force`` (n, 3) holds all forces on each block, contacts
    included; ``inertia`` (n, 3) the product of mass and acceleration; ``extent`` (n,) [m] the size
    by which moments are divided.
    """
    worst = 0.0
    for i in range(force.shape[0]):
        if fixed[i]:
            continue
        x = force[i, 0] - inertia[i, 0]
        y = force[i, 1] - inertia[i, 1]
        m = force[i, 2] - inertia[i, 2]
        size = max(np.sqrt(x * x + y * y), abs(m) / extent[i])
        if not np.isfinite(x + y + m):
            return np.nan
        worst = max(worst, size)
    return worst


@njit(cache=True)
def add_contact_forces(contacts, reaction, force):
    """Add H^T r to ``force`` (n, n_dof) on all bodies, fixed ones included."""
    which, rows = contacts.which, contacts.rows
    for c in range(reaction.shape[0]):
        add_force(
            rows, c, reaction[c, 0], reaction[c, 1], which[c, BODY_A], which[c, BODY_B], force
        )


@njit(cache=True)
def mark_held(contacts, reaction, held):
    """Set ``held`` (n,) for bodies on which a contact acts."""
    which = contacts.which
    for c in range(reaction.shape[0]):
        if reaction[c, 0] != 0.0 or reaction[c, 1] != 0.0:
            held[which[c, BODY_A]] = True
            held[which[c, BODY_B]] = True
