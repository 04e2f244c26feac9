"""Contacts of a static step in the plane: their places, reactions and stiffness.

The force on block b is r_n n + r_t t.  The generalised forces on both blocks are r_n grad(g) +
r_t grad(s), with the reactions of `law.return_map`, and the gradients of gap g and slip s of
`contact.plane.rows`.  Their tangent includes the second derivatives of g and s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ADD_N,
    ADD_T,
    BODY_A,
    BODY_B,
    GAP,
    KIND,
    PAIR,
    PLASTIC,
    SHIFT,
    SLOT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
    Contacts,
    Pairs,
    Slots,
)
from drystone.contact.plane.narrow import Bodies, World, follow_contacts
from drystone.contact.plane.rows import N_DOF, gradients, second_derivatives, slot_rows
from drystone.contact.plane.rows import slip as slip_of
from drystone.contact.rows import (
    IN_PLANE,
    MEASURED,
    OF_GAP,
    OF_SLIP,
    add_block,
    add_reaction,
    along,
)
from drystone.law.columns import DILATION, SHEAR
from drystone.law.plane import choose, respond
from drystone.statics.balance import BodyForces, unbalance


class Beginning(NamedTuple):
    """Where a step begins, and the features by which it follows contacts."""

    bodies: Bodies
    world: World  # scratch
    pose: Array  # (n, 3)
    pairs: Pairs
    known: Slots  # features
    history: Array  # (n_slots, N_HISTORY) at the beginning; see `law.plane.remember`
    there: BoolArray  # (n_slots,) contacts that exist at the beginning
    # (n_slots, dim, 2 n_dof) gradients of gap and slip of these contacts.  The slip is linear in
    # the increments by them, during the step.  The slip of other contacts is the exact distance.
    lines: Array


class Answer(NamedTuple):
    """Reactions of the contacts: one row for each contact in use, in arrays as long as all
    slots."""

    trial: Array  # (n_slots, 3) N
    branch: IntArray  # (n_slots,)
    reaction: Array  # (n_slots, 3) N
    response: Array  # (n_slots, 3, 3) derivatives of the reactions by the trial reactions


class Located(NamedTuple):
    """Contacts and forces where a step is."""

    begin: Beginning
    x: Array  # (n, n_dof) increments
    now: Array  # (n, 3) poses
    slots: Slots
    contacts: Contacts  # packed
    answer: Answer
    held: Array  # (n, n_dof) forces of ties [N, N m]
    forces: BodyForces


@njit(cache=True, error_model="numpy")
def _follow(located, increment, share):
    """Follow the contacts by their features to a ``share`` of the increments (n, n_dof)."""
    begin, now = located.begin, located.now
    for i in range(now.shape[0]):
        for d in range(now.shape[1]):
            now[i, d] = begin.pose[i, d] + share * increment[i, d]
    follow_contacts(begin.bodies, now, begin.world, begin.pairs, begin.known, located.slots)


@njit(cache=True, error_model="numpy")
def take_lines(box, guess):
    """Fill the ``lines`` of a step that is expected to end at increments ``guess`` (n, n_dof): the
    gradients midway.  The first item of the ``box`` is the `Located`, here and below."""
    located = box.value[0]
    _follow(located, guess, 0.5)
    slot_rows(located.slots, located.begin.lines)


@njit(cache=True, error_model="numpy")
def locate_all(box, count):
    """Locate the ``count`` contacts at the increments of a step; see `locate`."""
    located = box.value[0]
    begin = located.begin
    _follow(located, located.x, 1.0)
    locate(
        located.slots, begin.history, begin.there, begin.lines, located.contacts, count, located.x,
        located.answer.trial,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def evaluate(box, count, multiplier, inertia_factor):
    """Locate the contacts, and evaluate reactions and unbalanced forces; returns the largest
    unbalanced force [N], see `balance.unbalance`.

    One kernel for what `StaticStep` does in three calls, which would take a small wall 8 % longer.
    """
    located = box.value[0]
    contacts, answer, forces = located.contacts, located.answer, located.forces
    locate_all(box, count)
    choose(contacts.table, 0, count, answer.branch)
    respond(contacts.table, 0, count, answer.branch, answer.reaction, answer.response)
    sum_forces(contacts, count, answer.reaction, forces.contact)
    add(located.held, forces.contact)
    return unbalance(forces, multiplier, located.x, inertia_factor)


@njit(cache=True, error_model="numpy")
def add(field, total):
    """Add a field (n, n_dof) to ``total`` (n, n_dof)."""
    for i in range(field.shape[0]):
        for d in range(field.shape[1]):
            total[i, d] += field[i, d]


@njit(cache=True, error_model="numpy")
def locate(slots, history, known, lines, contacts, count, increment, trial):
    """Fill the gradients of ``contacts`` in the present poses, and their trial reactions
    ``trial`` (n_slots, 3) [N].

    ``known`` (n_slots,) are the contacts that exist at the beginning, `Beginning.there`.  See there
    for ``history`` and ``lines``.  ``increment`` (n, n_dof) are the increments of the step.
    """
    meets, value = slots
    which, rows, table = contacts
    for c in range(count):
        k, a, b = which[c, SLOT], which[c, BODY_A], which[c, BODY_B]
        gradients(value, k, rows, c)
        if known[k]:
            slip = 0.0
            for i in range(N_DOF):
                rows[c, MEASURED, i] = lines[k, OF_SLIP, i]
                rows[c, MEASURED, N_DOF + i] = lines[k, OF_SLIP, N_DOF + i]
                slip += lines[k, OF_SLIP, i] * increment[a, i]
                slip += lines[k, OF_SLIP, N_DOF + i] * increment[b, i]
        else:
            for i in range(2 * N_DOF):
                rows[c, MEASURED, i] = rows[c, OF_SLIP, i]
            slip = slip_of(meets[k, KIND], value, k, a, b, increment)
        closing = table[c, STIFF_N] * (history[k, DILATION] - value[k, GAP])
        table[c, TRIAL_N] = trial[c, 0] = closing + table[c, SHIFT]
        table[c, TRIAL_T] = trial[c, 1] = history[k, SHEAR] - table[c, STIFF_T] * slip
        table[c, ADD_N], table[c, ADD_T], table[c, PLASTIC] = 0.0, 0.0, 0.0


@njit(cache=True, error_model="numpy")
def sum_forces(contacts, count, reaction, force):
    """Fill ``force`` (n, n_dof) with the forces that reactions (n_slots, 2 or more) [N] exert on
    the bodies."""
    which, rows = contacts.which, contacts.rows
    force[:, :] = 0.0
    for c in range(count):
        a, b = which[c, BODY_A], which[c, BODY_B]
        add_reaction(IN_PLANE, rows, c, reaction, c, a, b, force)


@njit(cache=True, error_model="numpy")
def rates(contacts, count, direction, found):
    """Fill ``found`` (n_slots, 3) with the rates of gaps and slips along a motion (n, n_dof) of the
    bodies, the ``direction``."""
    which, rows = contacts.which, contacts.rows
    for c in range(count):
        a, b = which[c, BODY_A], which[c, BODY_B]
        found[c, 0] = along(IN_PLANE, rows, c, OF_GAP, direction, a, b)
        found[c, 1] = along(IN_PLANE, rows, c, MEASURED, direction, a, b)


@njit(cache=True, error_model="numpy")
def trial_rates(table, rows, c, motion, a, b):
    """Rates of the trial reactions of contact c between bodies a and b along a ``motion`` (n,
    n_dof) of the bodies."""
    gap = along(IN_PLANE, rows, c, OF_GAP, motion, a, b)
    slip = along(IN_PLANE, rows, c, MEASURED, motion, a, b)
    return -table[c, STIFF_N] * gap, -table[c, STIFF_T] * slip


@njit(cache=True, error_model="numpy")
def move_trial(which, rows, table, count, motion):
    """Continue the trial reactions in the table to first order by a ``motion`` (n, n_dof)."""
    for c in range(count):
        a, b = which[c, BODY_A], which[c, BODY_B]
        rate_n, rate_t = trial_rates(table, rows, c, motion, a, b)
        table[c, TRIAL_N] += rate_n
        table[c, TRIAL_T] += rate_t


@njit(cache=True, error_model="numpy")
def geometric_stiffness(slots, contacts, count, reaction, tangent):
    """Fill ``tangent`` with the geometric stiffness of the contacts: the derivative of minus their
    forces, with constant ``reaction`` (n_slots, 2 or more) [N], as their gradients turn with the
    bodies.  ``slots`` are the contacts where the step is."""
    tangent.diagonal[:, :, :] = 0.0
    tangent.upper[:, :, :] = 0.0
    tangent.lower[:, :, :] = 0.0
    add_geometric_stiffness(slots, contacts, count, reaction, tangent)


@njit(cache=True, error_model="numpy")
def add_geometric_stiffness(slots, contacts, count, reaction, tangent):
    """Add the geometric stiffness of the contacts to ``tangent``; see `geometric_stiffness`."""
    # Fields are read before the loop, and rows are no views: in the loop each would cost a count
    # of references.
    meets, value = slots
    which = contacts.which
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    hess = np.zeros((2 * N_DOF, 2 * N_DOF))
    for c in range(count):
        k = which[c, SLOT]
        if reaction[c, 0] == 0.0 and reaction[c, 1] == 0.0:
            continue
        hess[:, :] = 0.0
        second_derivatives(meets[k, KIND], value, k, reaction[c, 0], reaction[c, 1], hess)
        a, b, pair = which[c, BODY_A], which[c, BODY_B], which[c, PAIR]
        add_block(IN_PLANE, hess, a, b, pair, diagonal, upper, lower)


@njit(cache=True, error_model="numpy")
def assemble(contacts, count, pair_bodies, reaction, response, geometric, motion, force, tangent):
    """Fill ``force`` (n, n_dof) with the forces of all contacts, and ``tangent`` with the
    derivative of minus these forces.

    The forces are continued to first order by a ``motion`` (n, n_dof) from where the gradients were
    taken.  ``geometric`` is the `Tangent` of the parts that do not depend on the branches.
    ``pair_bodies`` (n_pairs, 2) are the bodies of all pairs of the matrix.
    """
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    bent, above, below = geometric.diagonal, geometric.upper, geometric.lower
    which, rows, table = contacts
    for body in range(motion.shape[0]):
        for i in range(N_DOF):
            force[body, i] = 0.0
            for j in range(N_DOF):
                force[body, i] -= bent[body, i, j] * motion[body, j]
                diagonal[body, i, j] = bent[body, i, j]
    for p in range(pair_bodies.shape[0]):
        a = pair_bodies[p, 0]
        b = pair_bodies[p, 1]
        for i in range(N_DOF):
            for j in range(N_DOF):
                force[a, i] -= above[p, i, j] * motion[b, j]
                force[b, i] -= below[p, i, j] * motion[a, j]
                upper[p, i, j] = above[p, i, j]
                lower[p, i, j] = below[p, i, j]
    hess = np.zeros((2 * N_DOF, 2 * N_DOF))
    for c in range(count):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        rn, rt = reaction[c, 0], reaction[c, 1]
        kn, kt = table[c, STIFF_N], table[c, STIFF_T]
        nn, nt = kn * response[c, 0, 0], kt * response[c, 0, 1]
        tn, tt = kn * response[c, 1, 0], kt * response[c, 1, 1]
        if rn == rt == nn == nt == tn == tt == 0.0:  # it is open
            continue
        for i in range(2 * N_DOF):
            by_gap = rows[c, OF_GAP, i] * nn + rows[c, OF_SLIP, i] * tn
            by_slip = rows[c, OF_GAP, i] * nt + rows[c, OF_SLIP, i] * tt
            for j in range(2 * N_DOF):
                hess[i, j] = by_gap * rows[c, OF_GAP, j] + by_slip * rows[c, MEASURED, j]
        add_reaction(IN_PLANE, rows, c, reaction, c, a, b, force)
        add_block(IN_PLANE, hess, a, b, which[c, PAIR], diagonal, upper, lower)
