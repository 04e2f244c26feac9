"""Non-linear Gauss-Seidel: one contact after another, each solved exactly for its own impulse.

In other fields the method is called projected Gauss-Seidel.  The velocity v of the bodies is kept
up to date.  With its Delassus block W, a contact has the velocity b = H v - W p without its own
impulse, and solves

    W p + b + (C p_n + g / h, 0) = u,    0 <= p_n,  u_n = 0 if p_n > 0,    |p_t| <= mu p_n,

with the compliance C = 1 / (k_n h^2) of the joint.  Friction at its limit opposes sliding.  In
space, p_t and u_t are vectors with two components.

The sweeps themselves are in `plane.sweeps` and `space.sweeps`, which have the same functions;
``dof`` is `rows.IN_PLANE` or `rows.IN_SPACE` everywhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B, Contacts
from drystone.contact.rows import OF_GAP, OF_SLIP, add_reaction


class ContactProblem(NamedTuple):
    """The data of one step for a contact solver."""

    contacts: Contacts  # (n_contacts,)
    gap: Array  # (n_contacts,) m, at the start of the step
    inverse_mass: Array  # (n, n_dof) 1/kg, 1/(kg m2); zero on fixed bodies


@njit(cache=True)
def delassus_blocks(dof, problem, blocks):
    """Fill the diagonal blocks of W = H M^-1 H^T, (n_contacts, dim, dim) [1/kg]."""
    nd = len(dof)
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        for i in range(blocks.shape[1]):
            for j in range(blocks.shape[1]):
                w = 0.0
                for d in range(nd):
                    w += rows[c, i, d] * inverse_mass[a, d] * rows[c, j, d]
                    w += rows[c, i, nd + d] * inverse_mass[b, d] * rows[c, j, nd + d]
                blocks[c, i, j] = w


@njit(cache=True)
def apply_impulses(dof, problem, impulse, velocity):
    """Add M^-1 H^T p of impulses p (n_contacts, dim) [N s] to the velocities (n, n_dof)."""
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        push(dof, rows, c, impulse, c, which[c, BODY_A], which[c, BODY_B], inverse_mass, velocity)


@njit(cache=True)
def push(dof, rows, c, impulse, k, a, b, inverse_mass, velocity):
    """Add the change of the velocities of bodies a and b by row k of ``impulse`` (n, dim) [N s] at
    contact c."""
    nd = len(dof)
    for d in range(nd):
        on_a = rows[c, OF_GAP, d] * impulse[k, 0] + rows[c, OF_SLIP, d] * impulse[k, 1]
        on_b = rows[c, OF_GAP, nd + d] * impulse[k, 0] + rows[c, OF_SLIP, nd + d] * impulse[k, 1]
        for i in range(2, impulse.shape[1]):
            on_a += rows[c, i, d] * impulse[k, i]
            on_b += rows[c, i, nd + d] * impulse[k, i]
        velocity[a, d] += inverse_mass[a, d] * on_a
        velocity[b, d] += inverse_mass[b, d] * on_b


@njit(cache=True)
def momentum_defect(dof, problem, mass, free_velocity, velocity, impulse, defect):
    """Fill ``defect`` (n, n_dof) with H^T p - M (v - v_free); returns its norm, weighted with
    M^-1."""
    nd = len(dof)
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for i in range(mass.shape[0]):
        for d in range(nd):
            defect[i, d] = -mass[i, d] * (velocity[i, d] - free_velocity[i, d])
    for c in range(rows.shape[0]):
        add_reaction(dof, rows, c, impulse, c, which[c, BODY_A], which[c, BODY_B], defect)
    norm = 0.0
    for i in range(mass.shape[0]):
        for d in range(nd):
            if mass[i, d] == 0.0:
                defect[i, d] = 0.0
            norm += defect[i, d] ** 2 * inverse_mass[i, d]
    return np.sqrt(norm)
