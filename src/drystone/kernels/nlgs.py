"""Non-linear Gauss-Seidel: one contact after another, each solved exactly for its own impulse.

It is the projected Gauss-Seidel method of other fields.  With the velocity v of the bodies kept up
to date, a contact sees its own free velocity b = H v - W p (W its Delassus block) and solves

    W p + b + (C p_n + g / h, 0) = u,    0 <= p_n,  u_n = 0 where p_n > 0,    |p_t| <= mu p_n,

with the compliance C = 1 / (k_n h^2) of the joint; friction opposes sliding where it is at its
limit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drystone.kernels.contacts import BODY_A, BODY_B, FRICTION, PAIR, STIFF_N, Contacts
from drystone.kernels.forces import add_blocks
from drystone.kernels.law import (
    FORWARD,
    OPEN,
    STICKING,
    branch_of_impulse,
    held_impulse,
    impulse_in,
    local_impulse,
)
from drystone.kernels.rows import N_DOF, OF_GAP, OF_SLIP, add_force

Array = NDArray[np.float64]


class ContactProblem(NamedTuple):
    """Everything a contact solver needs of one step, and nothing else."""

    contacts: Contacts  # (n_contacts,)
    gap: Array  # (n_contacts,) m, at the start of the step
    inverse_mass: Array  # (n, n_dof) 1/kg, 1/(kg m2); zero on fixed bodies


@njit(cache=True)
def delassus_blocks(problem, blocks):
    """Diagonal blocks W = H M^-1 H^T, (n_contacts, dim, dim) [1/kg]."""
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        for i in range(blocks.shape[1]):
            for j in range(blocks.shape[1]):
                w = 0.0
                for d in range(N_DOF):
                    w += rows[c, i, d] * inverse_mass[a, d] * rows[c, j, d]
                    w += rows[c, i, N_DOF + d] * inverse_mass[b, d] * rows[c, j, N_DOF + d]
                blocks[c, i, j] = w


@njit(cache=True)
def apply_impulses(problem, impulse, velocity):
    """Add M^-1 H^T p to the velocities, (n, n_dof)."""
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        _push(
            rows,
            c,
            impulse[c, 0],
            impulse[c, 1],
            which[c, BODY_A],
            which[c, BODY_B],
            inverse_mass,
            velocity,
        )


@njit(cache=True)
def _push(rows, c, pn, pt, a, b, inverse_mass, velocity):
    """Add to the velocities of bodies a and b what impulses at contact c do to them."""
    for d in range(N_DOF):
        velocity[a, d] += inverse_mass[a, d] * (rows[c, OF_GAP, d] * pn + rows[c, OF_SLIP, d] * pt)
        velocity[b, d] += inverse_mass[b, d] * (
            rows[c, OF_GAP, N_DOF + d] * pn + rows[c, OF_SLIP, N_DOF + d] * pt
        )


@njit(cache=True)
def sweep(problem, blocks, h, order, n_sweeps, impulse, velocity):
    """Gauss-Seidel sweeps forth and back over the contacts, in place.

    Parameters
    ----------
    problem, blocks
        See `ContactProblem` and `delassus_blocks`.
    h
        Time step [s].
    order
        (n_contacts,) the order of a forward sweep.
    n_sweeps
        Number of sweeps, forward and backward ones in turn.
    impulse
        (n_contacts, dim) [N s], normal and tangential.
    velocity
        (n, n_dof), kept consistent with the impulses.
    """
    contacts, inverse_mass, gap = problem.contacts, problem.inverse_mass, problem.gap
    which, rows, table = contacts
    n = gap.shape[0]
    for s in range(n_sweeps):
        for i in range(n):
            c = order[i] if s % 2 == 0 else order[n - 1 - i]
            a = which[c, BODY_A]
            b = which[c, BODY_B]
            un = 0.0
            ut = 0.0
            for d in range(N_DOF):
                un += (
                    rows[c, OF_GAP, d] * velocity[a, d]
                    + rows[c, OF_GAP, N_DOF + d] * velocity[b, d]
                )
                ut += (
                    rows[c, OF_SLIP, d] * velocity[a, d]
                    + rows[c, OF_SLIP, N_DOF + d] * velocity[b, d]
                )
            wnn = blocks[c, 0, 0]
            wnt = blocks[c, 0, 1]
            wtt = blocks[c, 1, 1]
            bn = un - wnn * impulse[c, 0] - wnt * impulse[c, 1] + gap[c] / h
            bt = ut - wnt * impulse[c, 0] - wtt * impulse[c, 1]
            cnn = wnn + 1.0 / (table[c, STIFF_N] * h * h)
            pn, pt = local_impulse(bn, bt, cnn, wnt, wtt, table[c, FRICTION])
            dn = pn - impulse[c, 0]
            dt = pt - impulse[c, 1]
            impulse[c, 0] = pn
            impulse[c, 1] = pt
            if dn != 0.0 or dt != 0.0:
                _push(rows, c, dn, dt, a, b, inverse_mass, velocity)


@njit(cache=True)
def contact_velocities(contacts, velocity, out):
    """Relative velocities H v, normal and tangential, (n_contacts, dim) [m/s]."""
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        for i in range(out.shape[1]):
            u = 0.0
            for d in range(N_DOF):
                u += rows[c, i, d] * velocity[a, d]
                u += rows[c, i, N_DOF + d] * velocity[b, d]
            out[c, i] = u


@njit(cache=True)
def held_law(problem, h, penalty, centre, held, velocity, impulse, piece):
    """Impulses of the joint law at given velocities, with sticking as a stiff hold.

        p_n = <-h k_n (g + h u_n)>,    p_t = clip(centre - P u_t, +-mu p_n)

    where P is ``penalty`` [kg] and ``centre`` (n_contacts,) [N s] the tangential impulse that is
    reached without slip.  Contacts that are ``held`` stick whatever the cone says.  ``piece``
    (n_contacts,) tells the branch, see `kernels.law`.
    """
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        ut = impulse[c, 1]
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c] - penalty * ut
        impulse[c, 0], impulse[c, 1], piece[c] = held_impulse(pn, pt, table[c, FRICTION], held[c])


@njit(cache=True)
def branch_law(problem, h, penalty, centre, piece, velocity, impulse):
    """Impulses of the branches in ``piece``, whether or not velocities lie on them: see `held_law`.

    On known branches the law is linear, and one linear solution finds the velocities.
    """
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        ut = impulse[c, 1]
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c] - penalty * ut
        impulse[c, 0], impulse[c, 1] = impulse_in(piece[c], pn, pt, table[c, FRICTION])


@njit(cache=True)
def branches(problem, impulse, piece):
    """The branches that impulses lie on, in place: see `held_law`."""
    table = problem.contacts.table
    for c in range(impulse.shape[0]):
        piece[c] = branch_of_impulse(impulse[c, 0], impulse[c, 1], table[c, FRICTION])


@njit(cache=True)
def held_law_tangent(problem, h, penalty, piece, diagonal, upper, lower):
    """Add -d(H^T p)/dv of the branches in ``piece`` to the block matrix [kg]."""
    contacts = problem.contacts
    which, rows, table = contacts
    block = np.zeros((2 * N_DOF, 2 * N_DOF))
    for c in range(which.shape[0]):
        if piece[c] == OPEN:
            continue
        stiffness = h * h * table[c, STIFF_N]
        slope = 0.0
        hold = penalty
        if piece[c] != STICKING:
            slope = table[c, FRICTION] if piece[c] == FORWARD else -table[c, FRICTION]
            hold = 0.0
        for i in range(2 * N_DOF):
            gn = (rows[c, OF_GAP, i] + slope * rows[c, OF_SLIP, i]) * stiffness
            gt = rows[c, OF_SLIP, i] * hold
            for j in range(2 * N_DOF):
                block[i, j] = gn * rows[c, OF_GAP, j] + gt * rows[c, OF_SLIP, j]
        add_blocks(
            block, which[c, BODY_A], which[c, BODY_B], which[c, PAIR], diagonal, upper, lower
        )


@njit(cache=True)
def momentum_defect(problem, mass, free_velocity, velocity, impulse, defect):
    """H^T p - M (v - v_free), (n, n_dof), and its norm weighted with M^-1."""
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for i in range(mass.shape[0]):
        for d in range(N_DOF):
            defect[i, d] = -mass[i, d] * (velocity[i, d] - free_velocity[i, d])
    for c in range(rows.shape[0]):
        add_force(rows, c, impulse[c, 0], impulse[c, 1], which[c, BODY_A], which[c, BODY_B], defect)
    norm = 0.0
    for i in range(mass.shape[0]):
        for d in range(N_DOF):
            if mass[i, d] == 0.0:
                defect[i, d] = 0.0
            norm += defect[i, d] ** 2 * inverse_mass[i, d]
    return np.sqrt(norm)
