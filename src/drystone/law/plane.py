"""The joint law of contacts in the plane, where shear has a sign; on rows of the contacts' table.

Let k_n, k_s [N/m] be the stiffness times the tributary area of the contact, g the gap, d the
dilation so far, s the slip in the step and t_0 the shear at its start.  The trial reactions are

    r_n = k_n (d - g)          r_t = t_0 - k_s s

A joint without tension is open if k_s r_n + k_n tan(psi) |r_t| <= 0, which without dilatancy is
r_n <= 0.  It sticks if |r_t| <= mu r_n.  Otherwise it slides by

    gamma = (|r_t| - mu r_n) / (k_s + mu k_n tan psi)

against the trial shear.  Sliding raises the normal reaction by k_n tan(psi) gamma.  This is a
return mapping, non-associative unless tan psi = mu.  A bond stays intact whatever it carries;
`law.bonds` decides between steps whether it breaks.  In each of these branches the reactions are
linear in the trial reactions, and they are continuous across branches.
"""

from __future__ import annotations

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ADD_N,
    ADD_T,
    FRICTION,
    INTACT,
    INTERCEPT,
    LIFT,
    PLASTIC,
    PULL,
    SLOT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.law.branches import (
    BACKWARD,
    BONDED,
    CRUSHED,
    FORWARD,
    OPEN,
    across_joint,
    along_joint,
    sense,
)
from drystone.law.columns import DILATION, SHEAR, SLID
from drystone.law.limits import crushing, limited_normal
from drystone.law.return_map import branch_for, derivatives_in, reactions_in


@njit(cache=True, error_model="numpy")
def slide(rn, rt, stiffness, friction, lift):
    """Slip [m] of a joint under trial reactions beyond the friction cone, with positive shear."""
    return (rt - friction * rn) / (stiffness + friction * lift)


@njit(cache=True, error_model="numpy")
def branch_of(table, c, hint):
    """Branch of the law for the trial reactions of a row of the table; see `branch_for`."""
    if hint == BONDED:
        return BONDED
    rt = table[c, TRIAL_T]
    return branch_for(
        table[c, TRIAL_N], abs(rt), table[c, STIFF_T], table[c, FRICTION], table[c, LIFT],
        table[c, INTERCEPT], crushing(table, c), hint, FORWARD if rt > 0.0 else BACKWARD,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def reactions(table, c, branch):
    """Normal and tangential reaction [N] in a branch of the law, and the sliding in it [m]."""
    sign = -1.0 if along_joint(branch) == BACKWARD else 1.0
    rn, rt, gamma = reactions_in(
        branch, table[c, TRIAL_N], sign * table[c, TRIAL_T], table[c, STIFF_T], table[c, FRICTION],
        table[c, LIFT], table[c, INTERCEPT], crushing(table, c),
    )  # fmt: skip
    return rn - table[c, PULL], sign * rt, gamma


@njit(cache=True, error_model="numpy")
def choose(table, low, high, branch):
    """Fill the branches (n_contacts,) for the trial reactions of contacts from ``low`` to before
    ``high``."""
    for c in range(low, high):
        branch[c] = branch_of(table, c, BONDED if table[c, INTACT] != 0.0 else branch[c])


@njit(cache=True, error_model="numpy")
def respond(table, low, high, branch, reaction, response):
    """Fill reactions (n_contacts, 3) and their derivatives by the trial reactions (n_contacts, 3,
    3), of contacts from ``low`` to before ``high`` in their present branches."""
    for c in range(low, high):
        now = branch[c]
        sign = -1.0 if along_joint(now) == BACKWARD else 1.0
        reaction[c, 0], reaction[c, 1], _ = reactions(table, c, now)
        nn, nt, tn, tt = derivatives_in(now, table[c, STIFF_T], table[c, FRICTION], table[c, LIFT])
        response[c, 0, 0], response[c, 0, 1] = nn, sign * nt
        response[c, 1, 0], response[c, 1, 1] = sign * tn, tt


@njit(cache=True, error_model="numpy")
def age(which, table, branch, count, history):
    """Change ``history`` (n_slots, N_HISTORY) from that at the start of a step to that at its
    end."""
    for c in range(count):
        k, now = which[c, SLOT], branch[c]
        _, history[k, SHEAR], slid = reactions(table, c, now)
        if across_joint(now) == CRUSHED:
            beyond = table[c, TRIAL_N] - crushing(table, c)
            history[k, DILATION] -= beyond / table[c, STIFF_N]
        if table[c, LIFT] > 0.0:
            history[k, DILATION] += table[c, LIFT] / table[c, STIFF_N] * slid
        history[k, SLID] += slid


@njit(cache=True, error_model="numpy")
def commit(table, c, before):
    """Keep the sliding and crushing of a contact that leaves the branch ``before``, in its row of
    the table.  A contact that was open loses its shear."""
    if before == OPEN:
        table[c, ADD_T] -= table[c, TRIAL_T]
        table[c, TRIAL_T] = 0.0
        return
    if across_joint(before) == CRUSHED:
        beyond = max(table[c, TRIAL_N] - crushing(table, c), 0.0)
        table[c, TRIAL_N] -= beyond
        table[c, ADD_N] -= beyond
    sign = sense(before)
    if sign != 0.0:
        rn, rt = limited_normal(table, c, before), sign * table[c, TRIAL_T] - table[c, INTERCEPT]
        gamma = slide(rn, rt, table[c, STIFF_T], table[c, FRICTION], table[c, LIFT])
        table[c, TRIAL_N] += table[c, LIFT] * gamma
        table[c, ADD_N] += table[c, LIFT] * gamma
        table[c, ADD_T] -= sign * table[c, STIFF_T] * gamma
        table[c, TRIAL_T] -= sign * table[c, STIFF_T] * gamma
        table[c, PLASTIC] += gamma


@njit(cache=True, error_model="numpy")
def remember(which, table, count, history_before):
    """Add the sliding that has ended in the step to the history at its start, (n_slots,
    N_HISTORY)."""
    for c in range(count):
        k = which[c, SLOT]
        history_before[k, SHEAR] += table[c, ADD_T]
        history_before[k, DILATION] += table[c, ADD_N] / table[c, STIFF_N]
        history_before[k, SLID] += table[c, PLASTIC]
        table[c, ADD_N] = 0.0
        table[c, ADD_T] = 0.0
        table[c, PLASTIC] = 0.0
