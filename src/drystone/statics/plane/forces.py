"""What all contacts do to the blocks in the places at the end of a step, and how that changes.

The force on block b is r_n n + r_t t, on the blocks together r_n grad(g) + r_t grad(s), with the
reactions of `law.return_map` and the gradients of `contact.plane.rows`; their tangent includes the
second derivatives of g and s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ADD_N,
    ADD_T,
    BODY_A,
    BODY_B,
    BOND,
    CRUSH,
    FRICTION,
    GAP,
    KIND,
    LAW,
    LIFT,
    NONE,
    PAIR,
    PLASTIC,
    PULL,
    ROOM,
    SHIFT,
    SIZE,
    SLOT,
    STIFF_N,
    STIFF_T,
    TENSILE,
    TRIAL_N,
    TRIAL_T,
    A,
    B,
)
from drystone.contact.plane.rows import N_DOF, add_force, along, gradients, second_derivatives
from drystone.contact.plane.rows import slip as slip_of
from drystone.contact.rows import MEASURED, OF_GAP, OF_SLIP
from drystone.law.branches import BONDED, CRUSHED, OPEN, across_joint
from drystone.law.columns import (
    BROKEN,
    COHESION,
    DILATANCY_END,
    DILATION,
    KN,
    KS,
    MU,
    N_HISTORY,
    NN,
    NT,
    RN,
    RT,
    SHEAR,
    SLID,
    TAN_PSI,
    TENSION,
    TN,
    TT,
)
from drystone.law.plane import branch_of, reactions

Array = NDArray[np.float64]


class Tangent(NamedTuple):
    """Block form of the stiffness matrix: diagonal blocks, and both of every pair."""

    diagonal: Array  # (n, n_dof, n_dof)
    upper: Array  # (n_pairs, n_dof, n_dof) rows of a, columns of b
    lower: Array  # (n_pairs, n_dof, n_dof) rows of b, columns of a

    @classmethod
    def zeros(cls, n: int, n_pairs: int, n_dof: int) -> Tangent:
        """That of nothing."""
        return cls(*(np.zeros((count, n_dof, n_dof)) for count in (n, n_pairs, n_pairs)))


class Start(NamedTuple):
    """What contacts had when the step began."""

    size: Array  # (n_slots,) m, tributary; zero where there was no contact
    rows: Array  # (n_slots, dim, 2 n_dof) of contacts that were there: gradients of the slip that
    # hold for the step; others slip by the exact distance
    closed: NDArray[np.bool_]  # (n_slots,) others do not dilate in the step
    held: Array  # (n_slots, N_HELD), see `contact.contacts`; (0, N_HELD) where all joints are dry


@njit(cache=True, error_model="numpy")
def joint_forces(
    slots, pairs, laws, thickness, start, history_before, increment, contacts, force, branch,
    reaction, history,
):  # fmt: skip
    """Reactions of all contacts in the present poses; returns the number of contacts.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    pairs
        Their pairs.
    laws
        (n_laws, N_LAW), see `law.columns`.
    thickness
        [m]
    start
        What holds for the step, see `Start`.
    history_before
        (n_slots, N_HISTORY), what contacts bring along; see `law.plane.remember`.
    increment
        Motion since the start of the step, (n, n_dof) [m, rad].
    contacts
        Filled.
    force
        (n, n_dof) [N, N m], filled with what all contacts do to each body.
    branch
        (n_slots,) branch that each slot has been in, or -1; replaced by the present one.
    reaction, history
        Filled: (n_slots, 2) [N], and what there is at the end, (n_slots, N_HISTORY).
    """
    meets, value = slots
    pair, of_pair = pairs.of_slot, pairs.which
    which, rows, table = contacts
    start_size, start_rows, closed = start.size, start.rows, start.closed
    held, dry = start.held, start.held.shape[0] == 0
    force[:, :] = 0.0
    count = 0
    for k in range(meets.shape[0]):
        reaction[k, 0] = 0.0
        reaction[k, 1] = 0.0
        for i in range(N_HISTORY):
            history[k, i] = history_before[k, i]
        hint = branch[k]
        branch[k] = OPEN
        if meets[k, KIND] == NONE:
            continue
        shear = history[k, SHEAR]
        history[k, SHEAR] = 0.0
        p = pair[k]
        a = of_pair[p, A]
        b = of_pair[p, B]
        law = of_pair[p, LAW]
        known = start_size[k] > 0.0
        area = thickness * (start_size[k] if known else value[k, SIZE])
        c = count
        count += 1
        which[c, SLOT], which[c, PAIR], which[c, BODY_A], which[c, BODY_B] = k, p, a, b
        gradients(value, k, rows, c)
        if known:
            slip = 0.0
            for i in range(N_DOF):
                rows[c, MEASURED, i] = start_rows[k, OF_SLIP, i]
                rows[c, MEASURED, N_DOF + i] = start_rows[k, OF_SLIP, N_DOF + i]
                slip += start_rows[k, OF_SLIP, i] * increment[a, i]
                slip += start_rows[k, OF_SLIP, N_DOF + i] * increment[b, i]
        else:
            for i in range(2 * N_DOF):
                rows[c, MEASURED, i] = rows[c, OF_SLIP, i]
            slip = slip_of(meets[k, KIND], value, k, a, b, increment)
        kn, kt = laws[law, KN] * area, laws[law, KS] * area
        bond, tensile = laws[law, COHESION] * area, laws[law, TENSION] * area
        dilates = closed[k] and history[k, SLID] < laws[law, DILATANCY_END]
        lift = kn * laws[law, TAN_PSI] if dilates else 0.0
        table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION] = kn, kt, laws[law, MU]
        table[c, LIFT], table[c, BOND], table[c, TENSILE] = lift, bond, tensile
        table[c, TRIAL_N] = kn * (history[k, DILATION] - value[k, GAP])
        table[c, TRIAL_T] = shear - kt * slip
        table[c, ADD_N], table[c, ADD_T], table[c, PLASTIC] = 0.0, 0.0, 0.0
        if not dry:
            kn = held[k, STIFF_N] * area
            table[c, STIFF_N], table[c, FRICTION] = kn, held[k, FRICTION]
            table[c, SHIFT], table[c, PULL] = held[k, SHIFT] * area, held[k, PULL] * area
            table[c, ROOM], table[c, CRUSH] = held[k, ROOM] * area, held[k, CRUSH] * area
            closing = kn * (history[k, DILATION] - value[k, GAP])
            table[c, TRIAL_N] = closing + table[c, SHIFT]
        if history[k, BROKEN] == 0.0 and (bond > 0.0 or tensile > 0.0):
            hint = BONDED
        now = branch_of(table, c, hint)
        branch[k] = now
        rn, rt, gamma = reactions(table, c, now)
        if across_joint(now) == CRUSHED:
            history[k, DILATION] -= (table[c, TRIAL_N] - table[c, CRUSH]) / kn
        history[k, DILATION] += laws[law, TAN_PSI] * gamma if lift > 0.0 else 0.0
        history[k, SLID] += gamma
        reaction[k, 0] = rn
        reaction[k, 1] = rt
        history[k, SHEAR] = rt
        add_force(rows, c, rn, rt, a, b, force)
    return count


@njit(cache=True, error_model="numpy")
def move_trial(which, rows, table, count, motion):
    """Trial reactions where the blocks have moved on by ``motion`` (n, n_dof), to first order."""
    for c in range(count):
        a = which[c, BODY_A]
        b = which[c, BODY_B]
        table[c, TRIAL_N] -= table[c, STIFF_N] * along(rows, c, OF_GAP, motion, a, b)
        table[c, TRIAL_T] -= table[c, STIFF_T] * along(rows, c, MEASURED, motion, a, b)


@njit(cache=True, error_model="numpy")
def geometric_stiffness(slots, contacts, count, reaction, tangent):
    """Fill ``tangent`` with what turning contacts, at held reactions, add to that of minus forces.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    contacts, count
        See `joint_forces`.
    reaction
        (n_slots, 2) [N].
    tangent
        `Tangent`.
    """
    # Fields read once, and no views of rows: in the loop each would count references.
    meets, value = slots
    which = contacts.which
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    diagonal[:, :, :] = 0.0
    upper[:, :, :] = 0.0
    lower[:, :, :] = 0.0
    hess = np.zeros((2 * N_DOF, 2 * N_DOF))
    for c in range(count):
        k = which[c, SLOT]
        if reaction[k, 0] == 0.0 and reaction[k, 1] == 0.0:
            continue
        hess[:, :] = 0.0
        second_derivatives(meets[k, KIND], value, k, reaction[k, 0], reaction[k, 1], hess)
        add_blocks(hess, which[c, BODY_A], which[c, BODY_B], which[c, PAIR], diagonal, upper, lower)


@njit(cache=True, error_model="numpy")
def add_blocks(hess, a, b, p, diagonal, upper, lower):
    """Add a contact of pair p, by the motions of both bodies, to the blocks of a matrix."""
    for i in range(N_DOF):
        for j in range(N_DOF):
            diagonal[a, i, j] += hess[i, j]
            diagonal[b, i, j] += hess[N_DOF + i, N_DOF + j]
            upper[p, i, j] += hess[i, N_DOF + j]
            lower[p, i, j] += hess[N_DOF + i, j]


@njit(cache=True, error_model="numpy")
def assemble(contacts, count, pairs, response, geometric, motion, force, tangent):
    """Forces of all contacts that respond as given, and the tangent of minus them.

    Parameters
    ----------
    contacts, count
        See `joint_forces`.
    pairs
        All of them.
    response
        (n_slots, N_RESPONSE), see `law.plane.respond`.
    geometric
        `Tangent`, see `geometric_stiffness`.
    motion
        (n, n_dof) from where the table was made to where the response belongs.
    force
        (n, n_dof) filled with the forces there, to first order.
    tangent
        `Tangent`, filled.
    """
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    bent, above, below = geometric.diagonal, geometric.upper, geometric.lower
    of_pair = pairs.which
    which, rows, table = contacts
    for body in range(motion.shape[0]):
        for i in range(N_DOF):
            force[body, i] = 0.0
            for j in range(N_DOF):
                force[body, i] -= bent[body, i, j] * motion[body, j]
                diagonal[body, i, j] = bent[body, i, j]
    for p in range(of_pair.shape[0]):
        a = of_pair[p, A]
        b = of_pair[p, B]
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
        rn, rt = response[c, RN], response[c, RT]
        kn, kt = table[c, STIFF_N], table[c, STIFF_T]
        nn, nt = kn * response[c, NN], kt * response[c, NT]
        tn, tt = kn * response[c, TN], kt * response[c, TT]
        for i in range(2 * N_DOF):
            by_gap = rows[c, OF_GAP, i] * nn + rows[c, OF_SLIP, i] * tn
            by_slip = rows[c, OF_GAP, i] * nt + rows[c, OF_SLIP, i] * tt
            for j in range(2 * N_DOF):
                hess[i, j] = by_gap * rows[c, OF_GAP, j] + by_slip * rows[c, MEASURED, j]
        add_force(rows, c, rn, rt, a, b, force)
        add_blocks(hess, a, b, which[c, PAIR], diagonal, upper, lower)
