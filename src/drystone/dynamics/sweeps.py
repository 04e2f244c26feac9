"""Non-linear Gauss-Seidel: one contact after another, each solved exactly for its own impulse.

It is the projected Gauss-Seidel method of other fields.  With the velocity v of the bodies kept up
to date, a contact sees its own free velocity b = H v - W p (W its Delassus block) and solves

    W p + b + (C p_n + g / h, 0) = u,    0 <= p_n,  u_n = 0 where p_n > 0,    |p_t| <= mu p_n,

with the compliance C = 1 / (k_n h^2) of the joint; friction opposes sliding where it is at its
limit.  In space p_t and u_t are vectors of two.

``dof`` is `rows.IN_PLANE` or `rows.IN_SPACE` everywhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B, FRICTION, PAIR, STIFF_N, Contacts
from drystone.contact.rows import OF_GAP, OF_SLIP, add_reaction, contact_velocities
from drystone.law.branches import FORWARD, OPEN, STICKING
from drystone.law.impulse import (
    branch_of_impulse,
    held_impulse,
    held_impulse_in_space,
    impulse_in,
    local_impulse,
    local_impulse_in_space,
)

Array = NDArray[np.float64]

#: Columns of how a contact in space slides: direction of its friction, and what of a change of the
#: trial impulse across it is one of the impulse.
ALONG_1, ALONG_2, ACROSS = 0, 1, 2


class ContactProblem(NamedTuple):
    """Everything a contact solver needs of one step, and nothing else."""

    contacts: Contacts  # (n_contacts,)
    gap: Array  # (n_contacts,) m, at the start of the step
    inverse_mass: Array  # (n, n_dof) 1/kg, 1/(kg m2); zero on fixed bodies


@njit(cache=True)
def delassus_blocks(dof, problem, blocks):
    """Diagonal blocks W = H M^-1 H^T, (n_contacts, dim, dim) [1/kg]."""
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
    """Add M^-1 H^T p to the velocities, (n, n_dof)."""
    contacts, inverse_mass = problem.contacts, problem.inverse_mass
    which, rows = contacts.which, contacts.rows
    for c in range(rows.shape[0]):
        p2 = impulse[c, 2] if len(dof) == 6 else 0.0
        _push(
            dof,
            rows,
            c,
            impulse[c, 0],
            impulse[c, 1],
            p2,
            which[c, BODY_A],
            which[c, BODY_B],
            inverse_mass,
            velocity,
        )


@njit(cache=True)
def _push(dof, rows, c, pn, pt, p2, a, b, inverse_mass, velocity):
    """Add to the velocities of bodies a and b what impulses at contact c do to them."""
    nd = len(dof)
    for d in range(nd):
        on_a = rows[c, OF_GAP, d] * pn + rows[c, OF_SLIP, d] * pt
        on_b = rows[c, OF_GAP, nd + d] * pn + rows[c, OF_SLIP, nd + d] * pt
        if nd == 6:
            on_a += rows[c, OF_SLIP + 1, d] * p2
            on_b += rows[c, OF_SLIP + 1, nd + d] * p2
        velocity[a, d] += inverse_mass[a, d] * on_a
        velocity[b, d] += inverse_mass[b, d] * on_b


@njit(cache=True)
def _relative(dof, rows, c, i, velocity, a, b):
    """Relative velocity along row i of contact c, of its bodies a and b [m/s]."""
    nd = len(dof)
    u = 0.0
    for d in range(nd):
        u += rows[c, i, d] * velocity[a, d] + rows[c, i, nd + d] * velocity[b, d]
    return u


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
        Number of sweeps, forward and backward ones in turn.
    impulse
        (n_contacts, dim) [N s], normal and tangential.
    velocity
        (n, n_dof), kept consistent with the impulses.
    """
    contacts, inverse_mass, gap = problem.contacts, problem.inverse_mass, problem.gap
    which, rows, table = contacts
    n = gap.shape[0]
    found = np.zeros(3)
    for s in range(n_sweeps):
        for i in range(n):
            c = order[i] if s % 2 == 0 else order[n - 1 - i]
            a = which[c, BODY_A]
            b = which[c, BODY_B]
            un = _relative(dof, rows, c, OF_GAP, velocity, a, b)
            ut = _relative(dof, rows, c, OF_SLIP, velocity, a, b)
            wnn = blocks[c, 0, 0]
            wnt = blocks[c, 0, 1]
            wtt = blocks[c, 1, 1]
            bn = un - wnn * impulse[c, 0] - wnt * impulse[c, 1]
            bt = ut - wnt * impulse[c, 0] - wtt * impulse[c, 1]
            cnn = wnn + 1.0 / (table[c, STIFF_N] * h * h)
            d2 = 0.0
            if len(dof) == 3:
                bn += gap[c] / h
                pn, pt = local_impulse(bn, bt, cnn, wnt, wtt, table[c, FRICTION])
            else:
                wn2, wt2, w22 = blocks[c, 0, 2], blocks[c, 1, 2], blocks[c, 2, 2]
                b2 = _relative(dof, rows, c, OF_SLIP + 1, velocity, a, b)
                b2 -= wn2 * impulse[c, 0] + wt2 * impulse[c, 1] + w22 * impulse[c, 2]
                bt -= wt2 * impulse[c, 2]
                bn += gap[c] / h - wn2 * impulse[c, 2]
                local_impulse_in_space(bn, bt, b2, blocks[c], cnn, table[c, FRICTION], found)
                pn, pt = found[0], found[1]
                d2 = found[2] - impulse[c, 2]
                impulse[c, 2] = found[2]
            dn = pn - impulse[c, 0]
            dt = pt - impulse[c, 1]
            impulse[c, 0] = pn
            impulse[c, 1] = pt
            if dn != 0.0 or dt != 0.0 or d2 != 0.0:
                _push(dof, rows, c, dn, dt, d2, a, b, inverse_mass, velocity)


@njit(cache=True)
def held_law(dof, problem, h, penalty, centre, held, velocity, impulse, piece, turn):
    """Impulses of the joint law at given velocities, with sticking as a stiff hold.

        p_n = <-h k_n (g + h u_n)>,    p_t = centre - P u_t, drawn back to mu p_n

    where P is ``penalty`` [kg] and ``centre`` (n_contacts, dim - 1) [N s] the tangential impulse
    that is reached without slip.  Contacts that are ``held`` stick whatever the cone says.
    ``piece`` (n_contacts,) tells the branch, see `law.branches`; in space ``turn`` (n_contacts, 3)
    how it slides, see `ALONG_1`.
    """
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(dof, problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        mu = table[c, FRICTION]
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c, 0] - penalty * impulse[c, 1]
        if len(dof) == 3:
            impulse[c, 0], impulse[c, 1], piece[c] = held_impulse(pn, pt, mu, held[c])
            continue
        p2 = centre[c, 1] - penalty * impulse[c, 2]
        now = held_impulse_in_space(pn, pt, p2, mu, held[c])
        impulse[c, 0], impulse[c, 1], impulse[c, 2], piece[c] = now
        size = np.sqrt(pt * pt + p2 * p2)
        if piece[c] > STICKING:
            turn[c, ALONG_1], turn[c, ALONG_2] = pt / size, p2 / size
            turn[c, ACROSS] = mu * pn / size


@njit(cache=True)
def branch_law(dof, problem, h, penalty, centre, piece, velocity, impulse, turn):
    """Impulses of the branches in ``piece``, whether or not velocities lie on them: see `held_law`.

    On known branches the law is linear, and one linear solution finds the velocities; in space this
    slides along ``centre``, and ``turn`` is filled.
    """
    table, gap = problem.contacts.table, problem.gap
    contact_velocities(dof, problem.contacts, velocity, impulse)
    for c in range(gap.shape[0]):
        mu = table[c, FRICTION]
        pn = -h * table[c, STIFF_N] * (gap[c] + h * impulse[c, 0])
        pt = centre[c, 0] - penalty * impulse[c, 1]
        if len(dof) == 3:
            impulse[c, 0], impulse[c, 1] = impulse_in(piece[c], pn, pt, mu)
            continue
        p2 = centre[c, 1] - penalty * impulse[c, 2]
        if piece[c] > STICKING:
            size = np.sqrt(centre[c, 0] ** 2 + centre[c, 1] ** 2)
            along, across = centre[c, 0] / size, centre[c, 1] / size
            trial = np.sqrt(pt * pt + p2 * p2)
            share = size / trial if trial > size else 1.0
            turn[c, ALONG_1], turn[c, ALONG_2], turn[c, ACROSS] = along, across, share
            aside = share * (along * p2 - across * pt)
            pt, p2 = mu * pn * along - aside * across, mu * pn * across + aside * along
        elif piece[c] == OPEN:
            pn, pt, p2 = 0.0, 0.0, 0.0
        impulse[c, 0], impulse[c, 1], impulse[c, 2] = pn, pt, p2


@njit(cache=True)
def branches(dof, problem, impulse, piece):
    """The branches that impulses lie on, in place: see `held_law`."""
    table = problem.contacts.table
    for c in range(impulse.shape[0]):
        pt = impulse[c, 1]
        if len(dof) == 6:
            pt = np.sqrt(pt * pt + impulse[c, 2] ** 2)
        piece[c] = branch_of_impulse(impulse[c, 0], pt, table[c, FRICTION])


@njit(cache=True)
def held_law_tangent(dof, problem, h, penalty, piece, turn, diagonal, upper, lower):
    """Add -d(H^T p)/dv of the branches in ``piece`` to the block matrix [kg]; see `held_law`."""
    nd = len(dof)
    contacts = problem.contacts
    which, rows, table = contacts
    block = np.zeros((2 * nd, 2 * nd))
    for c in range(which.shape[0]):
        if piece[c] == OPEN:
            continue
        stiffness = h * h * table[c, STIFF_N]
        a, b, pair = which[c, BODY_A], which[c, BODY_B], which[c, PAIR]
        if nd == 3:
            slope = 0.0
            hold = penalty
            if piece[c] != STICKING:
                slope = table[c, FRICTION] if piece[c] == FORWARD else -table[c, FRICTION]
                hold = 0.0
            for i in range(2 * nd):
                gn = (rows[c, OF_GAP, i] + slope * rows[c, OF_SLIP, i]) * stiffness
                gt = rows[c, OF_SLIP, i] * hold
                for j in range(2 * nd):
                    block[i, j] = gn * rows[c, OF_GAP, j] + gt * rows[c, OF_SLIP, j]
        else:
            sliding = piece[c] != STICKING
            along, across = (turn[c, ALONG_1], turn[c, ALONG_2]) if sliding else (1.0, 0.0)
            slope = table[c, FRICTION] if sliding else 0.0
            hold = 0.0 if sliding else penalty
            aside = penalty * turn[c, ACROSS] if sliding else penalty
            for i in range(2 * nd):
                with_it = along * rows[c, OF_SLIP, i] + across * rows[c, OF_SLIP + 1, i]
                beside = along * rows[c, OF_SLIP + 1, i] - across * rows[c, OF_SLIP, i]
                gn = (rows[c, OF_GAP, i] + slope * with_it) * stiffness
                g1 = hold * with_it * along - aside * beside * across
                g2 = hold * with_it * across + aside * beside * along
                for j in range(2 * nd):
                    block[i, j] = gn * rows[c, OF_GAP, j] + (
                        g1 * rows[c, OF_SLIP, j] + g2 * rows[c, OF_SLIP + 1, j]
                    )
        for i in range(nd):
            for j in range(nd):
                diagonal[a, i, j] += block[i, j]
                diagonal[b, i, j] += block[nd + i, nd + j]
                upper[pair, i, j] += block[i, nd + j]
                lower[pair, i, j] += block[nd + i, j]


@njit(cache=True)
def momentum_defect(dof, problem, mass, free_velocity, velocity, impulse, defect):
    """H^T p - M (v - v_free), (n, n_dof), and its norm weighted with M^-1."""
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
