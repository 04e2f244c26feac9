"""The joint law of contacts in space, where shear has a direction; on rows of the contacts'
table."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    FRICTION,
    INTACT,
    INTERCEPT,
    LIFT,
    PULL,
    SLOT,
    STIFF_N,
    STIFF_T,
)
from drystone.law.branches import BONDED, CRUSHED, FORWARD, across_joint, along_joint
from drystone.law.columns import DILATION, SHEAR, SLID
from drystone.law.limits import crushing
from drystone.law.return_map import branch_for, derivatives_in, reactions_in


@njit(cache=True, nogil=True)
def respond(table, trial, low, high, branch, reaction, response):
    """Fill reactions (n, 3), and their derivatives (n, 3, 3) by the trial reactions (n, 3), of
    contacts from ``low`` to before ``high``.

    ``branch`` (n,) is filled too; a contact at its friction cone, but for rounding, keeps its
    branch.  Shear acts along the trial shear; its size is that of `law.return_map`.
    """
    for c in range(low, high):
        tn, t1, t2, ks, mu = (
            trial[c, 0],
            trial[c, 1],
            trial[c, 2],
            table[c, STIFF_T],
            table[c, FRICTION],
        )
        lift, intercept, crush = table[c, LIFT], table[c, INTERCEPT], crushing(table, c)
        size, now = np.sqrt(t1 * t1 + t2 * t2), BONDED
        if table[c, INTACT] == 0.0:
            now = branch_for(tn, size, ks, mu, lift, intercept, crush, branch[c], FORWARD)
        branch[c] = now
        rn, rt, _ = reactions_in(now, tn, size, ks, mu, lift, intercept, crush)
        nn, nt, dn, dt = derivatives_in(now, ks, mu, lift)
        response[c, 0, 0] = nn
        reaction[c, 0] = rn - table[c, PULL]
        if along_joint(now) != FORWARD:
            stays = 1.0 if dt != 0.0 else 0.0
            reaction[c, 1], reaction[c, 2] = stays * t1, stays * t2
            response[c, 0, 1:], response[c, 1:, 0] = 0.0, 0.0
            response[c, 1, 1], response[c, 2, 2] = stays, stays
            response[c, 1, 2], response[c, 2, 1] = 0.0, 0.0
            continue
        e1, e2, share = 0.0, 0.0, 0.0
        if size > 0.0:
            e1, e2, share = t1 / size, t2 / size, rt / size
        reaction[c, 1], reaction[c, 2] = rt * e1, rt * e2
        response[c, 0, 1], response[c, 0, 2] = nt * e1, nt * e2
        response[c, 1, 0], response[c, 2, 0] = dn * e1, dn * e2
        # Along the shear, the derivative is that of its size; across, that of its direction.
        response[c, 1, 1] = dt * e1 * e1 + share * (1.0 - e1 * e1)
        response[c, 2, 2] = dt * e2 * e2 + share * (1.0 - e2 * e2)
        response[c, 1, 2] = response[c, 2, 1] = dt * e1 * e2 - share * e1 * e2


@njit(cache=True)
def age(which, table, trial, reaction, branch, count, history):
    """Change ``history`` (n_slots, N_HISTORY + 1) from that at the start of a step to that at its
    end."""
    for c in range(count):
        k, now = which[c, SLOT], branch[c]
        history[k, SHEAR], history[k, SHEAR + 1] = reaction[c, 1], reaction[c, 2]
        kn, lift, size = table[c, STIFF_N], table[c, LIFT], np.hypot(trial[c, 1], trial[c, 2])
        rn, _, slid = reactions_in(
            now, trial[c, 0], size, table[c, STIFF_T], table[c, FRICTION], lift,
            table[c, INTERCEPT], crushing(table, c),
        )  # fmt: skip
        if across_joint(now) == CRUSHED:
            history[k, DILATION] -= (trial[c, 0] - rn) / kn
        if along_joint(now) == FORWARD:
            if lift > 0.0:
                history[k, DILATION] += lift / kn * slid
            history[k, SLID] += slid
