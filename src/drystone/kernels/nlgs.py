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

from drystone.kernels.law import OPEN, SLIDING, STICKING
from drystone.kernels.rows import add_force

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class ContactProblem(NamedTuple):
    """Everything a contact solver needs of one step, and nothing else."""

    body_a: IntArray  # (n_contacts,)
    body_b: IntArray  # (n_contacts,)
    mapping: Array  # (n_contacts, 2, 6) rows: gradients of gap and slip by (a, b)
    inverse_mass: Array  # (n, 3) 1/kg, 1/(kg m2); zero on fixed bodies
    gap: Array  # (n_contacts,) m, at the start of the step
    normal_stiffness: Array  # (n_contacts,) N/m
    friction: Array  # (n_contacts,)


@njit(cache=True)
def delassus_blocks(problem, blocks):
    """Diagonal blocks W = H M^-1 H^T, (n_contacts, 2, 2) [1/kg]."""
    for c in range(problem.gap.shape[0]):
        a = problem.body_a[c]
        b = problem.body_b[c]
        for i in range(2):
            for j in range(2):
                w = 0.0
                for d in range(3):
                    w += (
                        problem.mapping[c, i, d]
                        * problem.inverse_mass[a, d]
                        * problem.mapping[c, j, d]
                    )
                    w += (
                        problem.mapping[c, i, 3 + d]
                        * problem.inverse_mass[b, d]
                        * problem.mapping[c, j, 3 + d]
                    )
                blocks[c, i, j] = w


@njit(cache=True)
def apply_impulses(problem, impulse, velocity):
    """Add M^-1 H^T p to the velocities, (n, 3)."""
    for c in range(problem.gap.shape[0]):
        a = problem.body_a[c]
        b = problem.body_b[c]
        for d in range(3):
            velocity[a, d] += problem.inverse_mass[a, d] * (
                problem.mapping[c, 0, d] * impulse[c, 0] + problem.mapping[c, 1, d] * impulse[c, 1]
            )
            velocity[b, d] += problem.inverse_mass[b, d] * (
                problem.mapping[c, 0, 3 + d] * impulse[c, 0]
                + problem.mapping[c, 1, 3 + d] * impulse[c, 1]
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
        (n_contacts, 2) [N s], normal and tangential.
    velocity
        (n, 3), kept consistent with the impulses.
    """
    body_a, body_b, mapping = problem.body_a, problem.body_b, problem.mapping
    inverse_mass, gap = problem.inverse_mass, problem.gap
    stiffness, friction = problem.normal_stiffness, problem.friction
    n = gap.shape[0]
    for s in range(n_sweeps):
        for i in range(n):
            c = order[i] if s % 2 == 0 else order[n - 1 - i]
            a = body_a[c]
            b = body_b[c]
            un = 0.0
            ut = 0.0
            for d in range(3):
                un += mapping[c, 0, d] * velocity[a, d] + mapping[c, 0, 3 + d] * velocity[b, d]
                ut += mapping[c, 1, d] * velocity[a, d] + mapping[c, 1, 3 + d] * velocity[b, d]
            wnn = blocks[c, 0, 0]
            wnt = blocks[c, 0, 1]
            wtt = blocks[c, 1, 1]
            bn = un - wnn * impulse[c, 0] - wnt * impulse[c, 1] + gap[c] / h
            bt = ut - wnt * impulse[c, 0] - wtt * impulse[c, 1]
            cnn = wnn + 1.0 / (stiffness[c] * h * h)
            pn = 0.0
            pt = 0.0
            det = cnn * wtt - wnt * wnt
            stick_n = (wnt * bt - wtt * bn) / det
            stick_t = (wnt * bn - cnn * bt) / det
            mu = friction[c]
            if stick_n > 0.0 and abs(stick_t) <= mu * stick_n:
                pn = stick_n
                pt = stick_t
            else:
                slope = mu if stick_t > 0.0 else -mu
                along = cnn + slope * wnt
                if bn < 0.0 and along > 0.0:
                    pn = -bn / along
                    pt = slope * pn
                    if (wnt * pn + wtt * pt + bt) * slope > 0.0:  # slides with its friction
                        slope = -slope
                        along = cnn + slope * wnt
                        if along > 0.0:
                            pn = -bn / along
                            pt = slope * pn
            dn = pn - impulse[c, 0]
            dt = pt - impulse[c, 1]
            impulse[c, 0] = pn
            impulse[c, 1] = pt
            if dn != 0.0 or dt != 0.0:
                for d in range(3):
                    velocity[a, d] += inverse_mass[a, d] * (
                        mapping[c, 0, d] * dn + mapping[c, 1, d] * dt
                    )
                    velocity[b, d] += inverse_mass[b, d] * (
                        mapping[c, 0, 3 + d] * dn + mapping[c, 1, 3 + d] * dt
                    )


@njit(cache=True)
def contact_velocities(problem, velocity, out):
    """Relative velocities H v, normal and tangential, (n_contacts, 2) [m/s]."""
    for c in range(problem.gap.shape[0]):
        a = problem.body_a[c]
        b = problem.body_b[c]
        for i in range(2):
            u = 0.0
            for d in range(3):
                u += problem.mapping[c, i, d] * velocity[a, d]
                u += problem.mapping[c, i, 3 + d] * velocity[b, d]
            out[c, i] = u


@njit(cache=True)
def held_law(problem, h, penalty, centre, held, velocity, impulse, piece):
    """Impulses of the joint law at given velocities, with sticking as a stiff hold.

        p_n = <-h k_n (g + h u_n)>,    p_t = clip(centre - P u_t, +-mu p_n)

    where P is ``penalty`` [kg] and ``centre`` (n_contacts,) [N s] the tangential impulse that is
    reached without slip.  Contacts that are ``held`` stick whatever the cone says.  ``piece``
    (n_contacts,) tells the branch: 0 open, 1 sticking, 2 and 3 sliding.
    """
    for c in range(problem.gap.shape[0]):
        a = problem.body_a[c]
        b = problem.body_b[c]
        un = 0.0
        ut = 0.0
        for d in range(3):
            un += problem.mapping[c, 0, d] * velocity[a, d]
            un += problem.mapping[c, 0, 3 + d] * velocity[b, d]
            ut += problem.mapping[c, 1, d] * velocity[a, d]
            ut += problem.mapping[c, 1, 3 + d] * velocity[b, d]
        pn = -h * problem.normal_stiffness[c] * (problem.gap[c] + h * un)
        if pn <= 0.0:
            piece[c] = OPEN
            impulse[c, 0] = 0.0
            impulse[c, 1] = 0.0
            continue
        pt = centre[c] - penalty * ut
        limit = problem.friction[c] * pn
        piece[c] = STICKING
        if abs(pt) > limit * (1.0 - 1e-9) and pt != 0.0 and not held[c]:
            piece[c] = SLIDING if pt > 0.0 else SLIDING + 1
            pt = limit if pt > 0.0 else -limit
        impulse[c, 0] = pn
        impulse[c, 1] = pt


@njit(cache=True)
def branch_law(problem, h, penalty, centre, piece, velocity, impulse):
    """Impulses of the branches in ``piece``, whether or not velocities lie on them: see `held_law`.

    On known branches the law is linear, and one linear solution finds the velocities.
    """
    contact_velocities(problem, velocity, impulse)
    for c in range(problem.gap.shape[0]):
        ut = impulse[c, 1]
        pn = -h * problem.normal_stiffness[c] * (problem.gap[c] + h * impulse[c, 0])
        pt = centre[c] - penalty * ut
        if piece[c] == OPEN:
            pn = 0.0
            pt = 0.0
        elif piece[c] != STICKING:
            pt = problem.friction[c] * pn if piece[c] == SLIDING else -problem.friction[c] * pn
        impulse[c, 0] = pn
        impulse[c, 1] = pt


@njit(cache=True)
def branches(problem, impulse, piece):
    """The branches that impulses lie on, in place: see `held_law`."""
    for c in range(problem.gap.shape[0]):
        limit = problem.friction[c] * impulse[c, 0]
        if impulse[c, 0] <= 0.0:
            piece[c] = OPEN
        elif abs(impulse[c, 1]) < limit * (1.0 - 1e-9) or limit == 0.0:
            piece[c] = STICKING
        else:
            piece[c] = SLIDING if impulse[c, 1] > 0.0 else SLIDING + 1


@njit(cache=True)
def held_law_tangent(problem, pair, h, penalty, piece, diagonal, upper, lower):
    """Add -d(H^T p)/dv of the branches in ``piece`` to the block matrix [kg]."""
    for c in range(problem.gap.shape[0]):
        if piece[c] == OPEN:
            continue
        a = problem.body_a[c]
        b = problem.body_b[c]
        p = pair[c]
        stiffness = h * h * problem.normal_stiffness[c]
        slope = 0.0
        hold = penalty
        if piece[c] != STICKING:
            slope = problem.friction[c] if piece[c] == SLIDING else -problem.friction[c]
            hold = 0.0
        for i in range(6):
            gn = (problem.mapping[c, 0, i] + slope * problem.mapping[c, 1, i]) * stiffness
            gt = problem.mapping[c, 1, i] * hold
            for j in range(6):
                k = gn * problem.mapping[c, 0, j] + gt * problem.mapping[c, 1, j]
                if i < 3 and j < 3:
                    diagonal[a, i, j] += k
                elif i < 3:
                    upper[p, i, j - 3] += k
                elif j < 3:
                    lower[p, i - 3, j] += k
                else:
                    diagonal[b, i - 3, j - 3] += k


@njit(cache=True)
def momentum_defect(problem, mass, inverse_mass, free_velocity, velocity, impulse, defect):
    """H^T p - M (v - v_free), (n, 3), and its norm weighted with M^-1."""
    for i in range(mass.shape[0]):
        for d in range(3):
            defect[i, d] = -mass[i, d] * (velocity[i, d] - free_velocity[i, d])
    rows = problem.mapping.reshape(problem.gap.shape[0], 12)
    for c in range(problem.gap.shape[0]):
        a = problem.body_a[c]
        b = problem.body_b[c]
        add_force(rows, c, impulse[c, 0], impulse[c, 1], a, b, defect)
    norm = 0.0
    for i in range(mass.shape[0]):
        for d in range(3):
            if mass[i, d] == 0.0:
                defect[i, d] = 0.0
            norm += defect[i, d] ** 2 * inverse_mass[i, d]
    return np.sqrt(norm)
