"""The joint law of contacts in the plane: the map with a sign, on rows of their table.

With the stiffnesses times the contact's tributary area k_n, k_s [N/m], gap g, accumulated
dilation d, slip increment s and shear t_0 at the start of the step, the trial reactions are

    r_n = k_n (d - g)          r_t = t_0 - k_s s

Without tension k_s r_n + k_n tan(psi) |r_t| <= 0 means open, which without dilatancy is r_n <= 0.
|r_t| <= mu r_n sticks.  Otherwise the joint slides by

    gamma = (|r_t| - mu r_n) / (k_s + mu k_n tan psi)

against the trial shear, which raises the normal reaction by k_n tan(psi) gamma (return mapping;
non-associative unless tan psi = mu).  A bond stays intact whatever it carries: whether it breaks is
decided between steps (see `law.bonds`).  In each of these branches the reactions are linear in the
trial reactions, and they are continuous.
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
    """How far a joint has slid under trial reactions beyond the cone, shear taken positive [m]."""
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
    """Branches (n_contacts,) for the trial reactions of contacts from ``low`` to ``high``."""
    for c in range(low, high):
        branch[c] = branch_of(table, c, BONDED if table[c, INTACT] != 0.0 else branch[c])


@njit(cache=True, error_model="numpy")
def respond(table, low, high, branch, reaction, response):
    """Fill reactions (n_contacts, 3), and their derivatives by the trial reactions (n_contacts, 3,
    3), of contacts from ``low`` to ``high`` in the branches they are in."""
    for c in range(low, high):
        now = branch[c]
        sign = -1.0 if along_joint(now) == BACKWARD else 1.0
        reaction[c, 0], reaction[c, 1], _ = reactions(table, c, now)
        nn, nt, tn, tt = derivatives_in(now, table[c, STIFF_T], table[c, FRICTION], table[c, LIFT])
        response[c, 0, 0], response[c, 0, 1] = nn, sign * nt
        response[c, 1, 0], response[c, 1, 1] = sign * tn, tt


@njit(cache=True, error_model="numpy")
def age(which, table, branch, count, history):
    """What contacts have at the end of a step, into ``history`` (n_slots, N_HISTORY) so far."""
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
    """Make the sliding of a contact part of its history, where it sticks or opens; and forget
    the shear of one that was open."""
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
    """Sliding that has ended becomes part of what contacts bring along (n_slots, N_HISTORY)."""
    for c in range(count):
        k = which[c, SLOT]
        history_before[k, SHEAR] += table[c, ADD_T]
        history_before[k, DILATION] += table[c, ADD_N] / table[c, STIFF_N]
        history_before[k, SLID] += table[c, PLASTIC]
        table[c, ADD_N] = 0.0
        table[c, ADD_T] = 0.0
        table[c, PLASTIC] = 0.0
