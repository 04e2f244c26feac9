"""The unbalanced force of a solution, the measure that judges every solver."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B
from drystone.contact.rows import IN_PLANE, IN_SPACE, add_reaction


@njit(cache=True, error_model="numpy")
def unbalanced_force(force, inertia, extent, fixed):
    """Largest unbalanced force, or moment over block size, on a movable block [N]; NaN if a force
    is NaN.

    ``force`` (n, n_dof) [N, N m] are all forces on each block, contacts included.  ``inertia``
    (n, n_dof) is mass times acceleration.  ``extent`` (n,) [m] is the size by which moments are
    divided.  ``fixed`` (n,) are the blocks that are left out.
    """
    worst = 0.0
    dim = 2 if force.shape[1] == 3 else 3
    for i in range(force.shape[0]):
        if fixed[i]:
            continue
        straight, turn = 0.0, 0.0
        for d in range(dim):
            straight += (force[i, d] - inertia[i, d]) ** 2
        for d in range(dim, force.shape[1]):
            turn += (force[i, d] - inertia[i, d]) ** 2
        size = max(np.sqrt(straight), np.sqrt(turn) / extent[i])
        if not np.isfinite(straight + turn):
            return np.nan
        worst = max(worst, size)
    return worst


@njit(cache=True, error_model="numpy")
def add_contact_forces(contacts, reaction, force):
    """Add the forces H^T r of reactions (n_contacts, dim) to ``force`` (n, n_dof), on all bodies,
    fixed ones included."""
    which, rows, _ = contacts
    for c in range(reaction.shape[0]):
        a, b = which[c, BODY_A], which[c, BODY_B]
        if force.shape[1] == len(IN_SPACE):
            add_reaction(IN_SPACE, rows, c, reaction, c, a, b, force)
        else:
            add_reaction(IN_PLANE, rows, c, reaction, c, a, b, force)


@njit(cache=True, error_model="numpy")
def mark_touched(contacts, reaction, touched):
    """Set ``touched`` (n,) for bodies on which a contact acts."""
    which = contacts.which
    for c in range(reaction.shape[0]):
        acts = False
        for i in range(reaction.shape[1]):
            acts |= reaction[c, i] != 0.0
        if acts:
            touched[which[c, BODY_A]] = True
            touched[which[c, BODY_B]] = True
