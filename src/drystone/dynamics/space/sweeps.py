"""Gauss-Seidel and the penalty law of implicit steps in space: see `dynamics.sweeps`."""

from __future__ import annotations

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B, FRICTION, PAIR, STIFF_N
from drystone.contact.rows import OF_GAP, OF_SLIP, add_block, along, contact_velocities
from drystone.dynamics.space.interior import Interior
from drystone.dynamics.sweeps import push
from drystone.law.branches import FORWARD, OPEN, STICKING
from drystone.law.impulse import (
    branch_of_impulse,
    local_impulse_in_space,
    projected_impulse_in_space,
)

#: Columns of ``slip``, for contacts that slide: direction of the friction (two columns); and the
#: share of a change of the trial impulse across this direction that the impulse takes over.
ALONG_1, ALONG_2, ACROSS = 0, 1, 2
N_SLIP = 3

#: The interior-point method for velocities.
WITHIN = Interior


def sense(piece: IntArray, slip: Array) -> Array:
    """Directions in which contacts slide, (n_contacts, 2); zeros for others."""
    return np.where(piece[:, None] == FORWARD, slip[:, :ACROSS], 0.0)


@njit(cache=True)
def sweep(dof, problem, blocks, h, order, n_sweeps, impulse, velocity):
    """As `plane.sweeps.sweep`, with two tangential impulses."""
    contacts, inverse_mass, gap = problem.contacts, problem.inverse_mass, problem.gap
    which, rows, table = contacts
    n = gap.shape[0]
    found, change = np.zeros(3), np.zeros((1, 3))
    for s in range(n_sweeps):
        for i in range(n):
            c = order[i] if s % 2 == 0 else order[n - 1 - i]
            a, b = which[c, BODY_A], which[c, BODY_B]
            wnn, wnt, wtt = blocks[c, 0, 0], blocks[c, 0, 1], blocks[c, 1, 1]
            wn2, wt2, w22 = blocks[c, 0, 2], blocks[c, 1, 2], blocks[c, 2, 2]
            bn = along(dof, rows, c, OF_GAP, velocity, a, b)
            bn = bn - wnn * impulse[c, 0] - wnt * impulse[c, 1]
            bt = along(dof, rows, c, OF_SLIP, velocity, a, b)
            bt = bt - wnt * impulse[c, 0] - wtt * impulse[c, 1]
            b2 = along(dof, rows, c, OF_SLIP + 1, velocity, a, b)
            b2 -= wn2 * impulse[c, 0] + wt2 * impulse[c, 1] + w22 * impulse[c, 2]
            bt -= wt2 * impulse[c, 2]
            bn += gap[c] / h - wn2 * impulse[c, 2]
            cnn = wnn + 1.0 / (table[c, STIFF_N] * h * h)
            local_impulse_in_space(bn, bt, b2, blocks[c], cnn, table[c, FRICTION], found)
            moves = False
            for d in range(3):
                change[0, d] = found[d] - impulse[c, d]
                impulse[c, d] = found[d]
                moves = moves or change[0, d] != 0.0
            if moves:
                push(dof, rows, c, change, 0, a, b, inverse_mass, velocity)


@njit(cache=True)
def penalty_law(dof, problem, h, penalty, centre, stuck, velocity, impulse, piece, slip):
    """As `plane.sweeps.penalty_law`; also fills ``slip`` (n_contacts, 3), see `ALONG_1`."""
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(dof, problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        mu = table[c, FRICTION]
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c, 0] - penalty * impulse[c, 1]
        p2 = centre[c, 1] - penalty * impulse[c, 2]
        now = projected_impulse_in_space(pn, pt, p2, mu, stuck[c])
        impulse[c, 0], impulse[c, 1], impulse[c, 2], piece[c] = now
        size = np.sqrt(pt * pt + p2 * p2)
        if piece[c] > STICKING:
            slip[c, ALONG_1], slip[c, ALONG_2] = pt / size, p2 / size
            slip[c, ACROSS] = mu * pn / size


@njit(cache=True)
def branch_law(dof, problem, h, penalty, centre, piece, velocity, impulse, slip):
    """As `plane.sweeps.branch_law`; contacts slide along ``centre``, and ``slip`` is filled."""
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(dof, problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        mu = table[c, FRICTION]
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c, 0] - penalty * impulse[c, 1]
        p2 = centre[c, 1] - penalty * impulse[c, 2]
        if piece[c] > STICKING:
            size = np.sqrt(centre[c, 0] ** 2 + centre[c, 1] ** 2)
            along, across = centre[c, 0] / size, centre[c, 1] / size
            trial = np.sqrt(pt * pt + p2 * p2)
            share = size / trial if trial > size else 1.0
            slip[c, ALONG_1], slip[c, ALONG_2], slip[c, ACROSS] = along, across, share
            aside = share * (along * p2 - across * pt)
            pt, p2 = mu * pn * along - aside * across, mu * pn * across + aside * along
        elif piece[c] == OPEN:
            pn, pt, p2 = 0.0, 0.0, 0.0
        impulse[c, 0], impulse[c, 1], impulse[c, 2] = pn, pt, p2


@njit(cache=True)
def branches(problem, impulse, piece):
    """Fill ``piece`` (n_contacts,) with the branches to which impulses belong; see
    `penalty_law`."""
    table = problem.contacts.table
    for c in range(impulse.shape[0]):
        size = np.sqrt(impulse[c, 1] * impulse[c, 1] + impulse[c, 2] ** 2)
        piece[c] = branch_of_impulse(impulse[c, 0], size, table[c, FRICTION])


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
        sliding = piece[c] != STICKING
        along, across = (slip[c, ALONG_1], slip[c, ALONG_2]) if sliding else (1.0, 0.0)
        slope = table[c, FRICTION] if sliding else 0.0
        spring = 0.0 if sliding else penalty
        aside = penalty * slip[c, ACROSS] if sliding else penalty
        for i in range(2 * nd):
            with_it = along * rows[c, OF_SLIP, i] + across * rows[c, OF_SLIP + 1, i]
            beside = along * rows[c, OF_SLIP + 1, i] - across * rows[c, OF_SLIP, i]
            gn = (rows[c, OF_GAP, i] + slope * with_it) * stiffness
            g1 = spring * with_it * along - aside * beside * across
            g2 = spring * with_it * across + aside * beside * along
            for j in range(2 * nd):
                block[i, j] = gn * rows[c, OF_GAP, j] + (
                    g1 * rows[c, OF_SLIP, j] + g2 * rows[c, OF_SLIP + 1, j]
                )
        a, b, pair = which[c, BODY_A], which[c, BODY_B], which[c, PAIR]
        add_block(dof, block, a, b, pair, diagonal, upper, lower)
