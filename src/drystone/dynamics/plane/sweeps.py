"""Gauss-Seidel and the penalty law of implicit steps in the plane: see `dynamics.sweeps`."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B, FRICTION, PAIR, STIFF_N
from drystone.contact.rows import OF_GAP, OF_SLIP, add_block, along, contact_velocities
from drystone.dynamics.sweeps import push
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING
from drystone.law.impulse import branch_of_impulse, impulse_in, local_impulse, projected_impulse

#: Number of columns that describe the direction of slip beside the branch: none in the plane.
N_SLIP = 0

#: The interior-point method for velocities: none, because Newton's method suffices.
WITHIN = None


def sense(piece: IntArray, slip: Array) -> Array:
    """Directions in which contacts slide, +1 or -1, (n_contacts, 1); 0 for others."""
    found = np.where(piece == FORWARD, 1.0, 0.0) - np.where(piece == BACKWARD, 1.0, 0.0)
    return np.asarray(found[:, None])


@njit(cache=True)
def sweep(dof, problem, blocks, h, order, n_sweeps, impulse, velocity):
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
        Number of sweeps, forward and backward ones alternating.
    impulse
        (n_contacts, dim) [N s], normal and tangential.
    velocity
        (n, n_dof), kept consistent with the impulses.
    """
    contacts, inverse_mass, gap = problem.contacts, problem.inverse_mass, problem.gap
    which, rows, table = contacts
    n = gap.shape[0]
    change = np.zeros((1, 2))
    for s in range(n_sweeps):
        for i in range(n):
            c = order[i] if s % 2 == 0 else order[n - 1 - i]
            a, b = which[c, BODY_A], which[c, BODY_B]
            wnn, wnt, wtt = blocks[c, 0, 0], blocks[c, 0, 1], blocks[c, 1, 1]
            bn = along(dof, rows, c, OF_GAP, velocity, a, b)
            bn = bn - wnn * impulse[c, 0] - wnt * impulse[c, 1]
            bt = along(dof, rows, c, OF_SLIP, velocity, a, b)
            bt = bt - wnt * impulse[c, 0] - wtt * impulse[c, 1]
            cnn = wnn + 1.0 / (table[c, STIFF_N] * h * h)
            bn += gap[c] / h
            pn, pt = local_impulse(bn, bt, cnn, wnt, wtt, table[c, FRICTION])
            change[0, 0], change[0, 1] = pn - impulse[c, 0], pt - impulse[c, 1]
            impulse[c, 0], impulse[c, 1] = pn, pt
            if change[0, 0] != 0.0 or change[0, 1] != 0.0:
                push(dof, rows, c, change, 0, a, b, inverse_mass, velocity)


@njit(cache=True)
def penalty_law(dof, problem, h, penalty, centre, stuck, velocity, impulse, piece, slip):
    """Impulses of the joint law at given velocities, with a penalty for sticking.

        p_n = <-h k_n (g + h u_n)>,    p_t = centre - P u_t, projected onto mu p_n

    P is the ``penalty`` [kg].  ``centre`` (n_contacts, dim - 1) [N s] is the tangential impulse
    without slip.  Contacts that are ``stuck`` (n_contacts,) stick even outside the friction cone.
    Fills ``impulse`` (n_contacts, dim) [N s] and the branches ``piece`` (n_contacts,), see
    `law.branches`.  ``slip`` is used in space only.
    """
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(dof, problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c, 0] - penalty * impulse[c, 1]
        found = projected_impulse(pn, pt, table[c, FRICTION], stuck[c])
        impulse[c, 0], impulse[c, 1], piece[c] = found


@njit(cache=True)
def branch_law(dof, problem, h, penalty, centre, piece, velocity, impulse, slip):
    """Impulses in the branches ``piece``, whether or not the velocities belong to them; see
    `penalty_law`.

    In known branches the law is linear, so that one linear solution gives the velocities.  In
    space, contacts slide along ``centre``, and ``slip`` is filled.
    """
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(dof, problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c, 0] - penalty * impulse[c, 1]
        impulse[c, 0], impulse[c, 1] = impulse_in(piece[c], pn, pt, table[c, FRICTION])


@njit(cache=True)
def branches(problem, impulse, piece):
    """Fill ``piece`` (n_contacts,) with the branches to which impulses belong; see
    `penalty_law`."""
    table = problem.contacts.table
    for c in range(impulse.shape[0]):
        piece[c] = branch_of_impulse(impulse[c, 0], impulse[c, 1], table[c, FRICTION])


@njit(cache=True)
def penalty_law_tangent(dof, problem, h, penalty, piece, slip, diagonal, upper, lower):
    """Add -d(H^T p)/dv of the branches in ``piece`` to the block matrix [kg]; see `penalty_law`."""
    nd = len(dof)
    which, rows, table = problem.contacts
    block = np.zeros((2 * nd, 2 * nd))
    for c in range(which.shape[0]):
        if piece[c] == OPEN:
            continue
        stiffness = h * h * table[c, STIFF_N]
        slope, spring = 0.0, penalty
        if piece[c] != STICKING:
            slope = table[c, FRICTION] if piece[c] == FORWARD else -table[c, FRICTION]
            spring = 0.0
        for i in range(2 * nd):
            gn = (rows[c, OF_GAP, i] + slope * rows[c, OF_SLIP, i]) * stiffness
            gt = rows[c, OF_SLIP, i] * spring
            for j in range(2 * nd):
                block[i, j] = gn * rows[c, OF_GAP, j] + gt * rows[c, OF_SLIP, j]
        a, b, pair = which[c, BODY_A], which[c, BODY_B], which[c, PAIR]
        add_block(dof, block, a, b, pair, diagonal, upper, lower)
