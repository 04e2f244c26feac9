"""What all contacts do to the blocks in the places at the end of a step, and how that changes.

The force on block b is r_n n + r_t t, on the blocks together r_n grad(g) + r_t grad(s), with the
reactions of `kernels.law` and the gradients of `kernels.rows`; their tangent includes the second
derivatives of g and s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drystone.kernels.law import (
    ADD_N,
    ADD_T,
    BOND,
    BONDED,
    BROKEN,
    COHESION,
    DILATANCY_END,
    DILATION,
    FRICTION,
    KN,
    KS,
    LIFT,
    MU,
    N_HISTORY,
    NN,
    NT,
    OPEN,
    PLASTIC,
    RN,
    RT,
    SHEAR,
    SLID,
    STIFF_N,
    STIFF_T,
    TAN_PSI,
    TENSILE,
    TENSION,
    TN,
    TRIAL_N,
    TRIAL_T,
    TT,
    branch_of,
    reactions,
)  # fmt: skip
from drystone.kernels.narrow import NONE
from drystone.kernels.rows import (
    GAP,
    MEASURED,
    SLIP,
    add_force,
    along,
    gradients,
    second_derivatives,
)  # fmt: skip
from drystone.kernels.rows import (
    slip as slip_of,
)

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


@njit(cache=True)
def joint_forces(
    slots, pair_a, pair_b, pair_law, laws, thickness, start_length, start_slip, closed, memory,
    increment, force, table, used, branch, reaction, state,
):  # fmt: skip
    """Reactions of all contacts in the present poses; returns the number of contacts.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    pair_a, pair_b, pair_law
        Bodies and joint law of each pair, (n_pairs,).
    laws
        (n_laws, N_LAW), see the columns above.
    thickness
        [m]
    start_length
        Tributary lengths at the start of the step, (n_slots,) [m]; zero where there was none.
    start_slip
        Gradients of the slip that hold for the step, (n_slots, 6), of contacts that were there
        when it began; others slip by the exact distance.
    closed
        (n_slots,) whether a contact was closed when the step began; others do not dilate in it.
    memory
        (n_slots, N_HISTORY), what contacts bring along; see `remember`.
    increment
        Motion since the start of the step, (n, 3) [m, rad].
    force
        (n, 3) [N, N m], filled with what all contacts do to each body.
    table, used
        Filled: (n_slots, N_TABLE) and (n_slots,), rows of contacts and the slots they are of.
    branch
        (n_slots,) branch that each slot has been in, or -1; replaced by the present one.
    reaction, state
        Filled: (n_slots, 2) [N], and the history at the end, (n_slots, N_HISTORY).
    """
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio, gap, length = slots.roll, slots.ratio, slots.gap, slots.length
    force[:, :] = 0.0
    count = 0
    for k in range(kind.shape[0]):
        reaction[k, 0] = 0.0
        reaction[k, 1] = 0.0
        for i in range(N_HISTORY):
            state[k, i] = memory[k, i]
        hint = branch[k]
        branch[k] = OPEN
        if kind[k] == NONE:
            continue
        shear = state[k, SHEAR]
        state[k, SHEAR] = 0.0
        p = k // 2
        a = pair_a[p]
        b = pair_b[p]
        law = pair_law[p]
        known = start_length[k] > 0.0
        area = thickness * (start_length[k] if known else length[k])
        c = count
        count += 1
        used[c] = k
        gradients(kind, normal, arm_a, arm_b, roll, ratio, k, table, c)
        if known:
            slip = 0.0
            for i in range(3):
                table[c, MEASURED + i] = start_slip[k, i]
                table[c, MEASURED + 3 + i] = start_slip[k, 3 + i]
                slip += start_slip[k, i] * increment[a, i]
                slip += start_slip[k, 3 + i] * increment[b, i]
        else:
            for i in range(6):
                table[c, MEASURED + i] = table[c, SLIP + i]
            slip = slip_of(kind, normal, arm_a, arm_b, roll, ratio, k, a, b, increment)
        kn, kt = laws[law, KN] * area, laws[law, KS] * area
        bond, tensile = laws[law, COHESION] * area, laws[law, TENSION] * area
        dilates = closed[k] and state[k, SLID] < laws[law, DILATANCY_END]
        lift = kn * laws[law, TAN_PSI] if dilates else 0.0
        table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION] = kn, kt, laws[law, MU]
        table[c, LIFT], table[c, BOND], table[c, TENSILE] = lift, bond, tensile
        table[c, TRIAL_N] = kn * (state[k, DILATION] - gap[k])
        table[c, TRIAL_T] = shear - kt * slip
        table[c, ADD_N], table[c, ADD_T], table[c, PLASTIC] = 0.0, 0.0, 0.0
        if state[k, BROKEN] == 0.0 and (bond > 0.0 or tensile > 0.0):
            hint = BONDED
        now = branch_of(table, c, hint)
        branch[k] = now
        rn, rt, gamma = reactions(table, c, now)
        state[k, DILATION] += laws[law, TAN_PSI] * gamma if lift > 0.0 else 0.0
        state[k, SLID] += gamma
        reaction[k, 0] = rn
        reaction[k, 1] = rt
        state[k, SHEAR] = rt
        add_force(table, c, rn, rt, a, b, force)
    return count


@njit(cache=True)
def move_trial(table, count, used, pair_a, pair_b, motion):
    """Trial reactions where the blocks have moved on by ``motion`` (n, 3), to first order."""
    for c in range(count):
        a = pair_a[used[c] // 2]
        b = pair_b[used[c] // 2]
        table[c, TRIAL_N] -= table[c, STIFF_N] * along(table, c, GAP, motion, a, b)
        table[c, TRIAL_T] -= table[c, STIFF_T] * along(table, c, MEASURED, motion, a, b)


@njit(cache=True)
def judge(table, count, used, pair_a, pair_b, gap, reaction, state, bodies, judged, values):
    """Contacts as `contact.certificate.JudgedContacts` has them: a row of ``bodies`` (2, count) and
    ``values`` (8, count) for each of its fields, and the reactions ``judged`` (count, 2)."""
    for c in range(count):
        k = used[c]
        bodies[0, c], bodies[1, c] = pair_a[k // 2], pair_b[k // 2]
        whole = 1.0 if state[k, BROKEN] == 0.0 else 0.0
        values[0, c] = gap[k] - state[k, DILATION]
        values[1, c] = 0.0  # the slip is in the trial reaction
        judged[c, 0], judged[c, 1] = reaction[k, 0], reaction[k, 1]
        values[2, c] = table[c, TRIAL_T]
        values[3, c], values[4, c] = table[c, STIFF_N], table[c, STIFF_T]
        values[5, c] = table[c, FRICTION]
        values[6, c], values[7, c] = table[c, BOND] * whole, table[c, TENSILE] * whole


@njit(cache=True)
def geometric_stiffness(slots, count, used, pair_a, pair_b, reaction, tangent):
    """Fill ``tangent`` with what turning contacts, at held reactions, add to that of minus forces.

    Parameters
    ----------
    slots
        Contacts in the present poses.
    count, used
        See `joint_forces`.
    pair_a, pair_b
        Bodies of each pair, (n_pairs,).
    reaction
        (n_slots, 2) [N].
    tangent
        `Tangent`.
    """
    # Fields read once, and no views of rows: in the loop each would count references.
    kind, normal, arm_a, arm_b = slots.kind, slots.normal, slots.arm_a, slots.arm_b
    roll, ratio = slots.roll, slots.ratio
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    diagonal[:, :, :] = 0.0
    upper[:, :, :] = 0.0
    lower[:, :, :] = 0.0
    hess = np.zeros((6, 6))
    for c in range(count):
        k = used[c]
        if reaction[k, 0] == 0.0:
            continue
        p = k // 2
        hess[:, :] = 0.0
        second_derivatives(
            kind, normal, arm_a, arm_b, roll, ratio, k, reaction[k, 0], reaction[k, 1], hess
        )
        _add(hess, pair_a[p], pair_b[p], p, diagonal, upper, lower)


@njit(cache=True)
def _add(hess, a, b, p, diagonal, upper, lower):
    """Add the blocks of a contact of pair p."""
    for i in range(3):
        for j in range(3):
            diagonal[a, i, j] += hess[i, j]
            diagonal[b, i, j] += hess[3 + i, 3 + j]
            upper[p, i, j] += hess[i, 3 + j]
            lower[p, i, j] += hess[3 + i, j]


@njit(cache=True)
def assemble(table, count, used, pair_a, pair_b, response, geometric, motion, force, tangent):
    """Forces of all contacts that respond as given, and the tangent of minus them.

    Parameters
    ----------
    table, count, used
        See `joint_forces`.
    pair_a, pair_b
        Bodies of each pair, (n_pairs,).
    response
        (n_slots, N_RESPONSE), see `respond`.
    geometric
        `Tangent`, see `geometric_stiffness`.
    motion
        (n, 3) from where the table was made to where the response belongs.
    force
        (n, 3) filled with the forces there, to first order.
    tangent
        `Tangent`, filled.
    """
    diagonal, upper, lower = tangent.diagonal, tangent.upper, tangent.lower
    bent, above, below = geometric.diagonal, geometric.upper, geometric.lower
    for body in range(motion.shape[0]):
        for i in range(3):
            force[body, i] = 0.0
            for j in range(3):
                force[body, i] -= bent[body, i, j] * motion[body, j]
                diagonal[body, i, j] = bent[body, i, j]
    for p in range(pair_a.shape[0]):
        a = pair_a[p]
        b = pair_b[p]
        for i in range(3):
            for j in range(3):
                force[a, i] -= above[p, i, j] * motion[b, j]
                force[b, i] -= below[p, i, j] * motion[a, j]
                upper[p, i, j] = above[p, i, j]
                lower[p, i, j] = below[p, i, j]
    hess = np.zeros((6, 6))
    for c in range(count):
        p = used[c] // 2
        a = pair_a[p]
        b = pair_b[p]
        rn, rt = response[c, RN], response[c, RT]
        kn, kt = table[c, STIFF_N], table[c, STIFF_T]
        nn, nt = kn * response[c, NN], kt * response[c, NT]
        tn, tt = kn * response[c, TN], kt * response[c, TT]
        for i in range(6):
            by_gap = table[c, GAP + i] * nn + table[c, SLIP + i] * tn
            by_slip = table[c, GAP + i] * nt + table[c, SLIP + i] * tt
            for j in range(6):
                hess[i, j] = by_gap * table[c, GAP + j] + by_slip * table[c, MEASURED + j]
        add_force(table, c, rn, rt, a, b, force)
        _add(hess, a, b, p, diagonal, upper, lower)
