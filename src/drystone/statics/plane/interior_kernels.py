"""The joint law of all contacts at once, by an interior point method.

With the trial reactions T_n, T_t linear in the increments (gradients held fast), the implicit law
of `law.return_map` is a set of products that vanish, of factors that are not negative:

    r_n = T_n + w + (k_n tan psi / k_s) (p + q)          r_n w = 0
    r_t = T_t - p + q         (mu r_n - r_t) p = 0,  (mu r_n + r_t) q = 0

w is k_n times the gap, p and q are k_s times what is slid under positive and negative shear, all
in newtons.  The products are made equal to a barrier instead, k_n or k_s times an energy, and
Newton's method takes that to zero with all factors kept positive: no contact ever has to choose a
branch on the way, so that it does not matter how many of them change.

In the equations linearised, w, p and q go contact by contact, which leaves

    d r = A (d T + b)

with A of 2 x 2 instead of the derivatives of a branch: the matrix is as sparse as ever.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    FRICTION,
    LIFT,
    ROOM,
    SLOT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
)
from drystone.contact.plane.rows import N_DOF, add_force
from drystone.contact.rows import MEASURED, OF_GAP
from drystone.law.branches import BONDED
from drystone.law.columns import NN, NT, RN, RT, TN, TT
from drystone.law.interior import (
    CAP,
    D_TRIAL_N,
    D_TRIAL_T,
    FAR,
    N_INNER,
    NEAR,
    P,
    Q,
    V,
    W,
    lacking,
    lacking_of_crushing,
)
from drystone.law.limits import crushing

#: Columns of b.
B_N, B_T = 0, 1


@njit(cache=True, error_model="numpy")
def offset(contacts, count, branch, inner, barrier, second, change, response, b, force):
    """Fill b of every contact and add the forces A b to ``force`` (n, n_dof)."""
    which, rows, table = contacts
    for c in range(count):
        bn, bt = table[c, TRIAL_N] - inner[c, RN], table[c, TRIAL_T] - inner[c, RT]
        if branch[which[c, SLOT]] != BONDED:
            n, p, q = lacking(table, inner, change, c, barrier, second)
            bn += inner[c, W] + n / inner[c, RN]
            if crushing(table, c) < np.inf:
                v = lacking_of_crushing(table, inner, change, c, barrier, second)
                bn -= inner[c, V] + v / inner[c, CAP]
            if table[c, FRICTION] > 0.0 or table[c, ROOM] > 0.0:
                p = inner[c, P] + p / inner[c, NEAR]
                q = inner[c, Q] + q / inner[c, FAR]
                bn += table[c, LIFT] / table[c, STIFF_T] * (p + q)
                bt += q - p
        b[c, B_N], b[c, B_T] = bn, bt
        rn = response[c, NN] * bn + response[c, NT] * bt
        rt = response[c, TN] * bn + response[c, TT] * bt
        add_force(rows, c, rn, rt, which[c, BODY_A], which[c, BODY_B], force)


@njit(cache=True, error_model="numpy")
def _room(value, change, longest):
    return min(longest, -value / change) if change < 0.0 else longest


@njit(cache=True, error_model="numpy")
def changes(contacts, count, branch, inner, barrier, second, response, b, direction, change):
    """Changes of all variables along the bodies' ``direction`` (n, n_dof), for b as it was filled.

    Returns how far along it all factors stay positive, the contact that ends it, and how the mean
    energy changes with the way gone, to first and second order [J].
    """
    which, rows, table = contacts
    longest = np.inf
    limiting = -1
    first, second_order = 0.0, 0.0
    n_products = 0
    for c in range(count):
        first_body, second_body = which[c, BODY_A], which[c, BODY_B]
        tn, tt = 0.0, 0.0
        for i in range(N_DOF):
            tn += rows[c, OF_GAP, i] * direction[first_body, i]
            tn += rows[c, OF_GAP, N_DOF + i] * direction[second_body, i]
            tt += rows[c, MEASURED, i] * direction[first_body, i]
            tt += rows[c, MEASURED, N_DOF + i] * direction[second_body, i]
        n, p, q = lacking(table, inner, change, c, barrier, second)
        tn *= -table[c, STIFF_N]
        tt *= -table[c, STIFF_T]
        change[c, D_TRIAL_N], change[c, D_TRIAL_T] = tn, tt
        bn, bt = tn + b[c, B_N], tt + b[c, B_T]
        rn = response[c, NN] * bn + response[c, NT] * bt
        rt = response[c, TN] * bn + response[c, TT] * bt
        change[c, RN], change[c, RT] = rn, rt
        if branch[which[c, SLOT]] == BONDED:
            continue
        w = inner[c, W]
        dw = (n - w * rn) / inner[c, RN]
        change[c, W] = dw
        room = _room(w, dw, _room(inner[c, RN], rn, longest))
        first += (w * rn + inner[c, RN] * dw) / table[c, STIFF_N]
        second_order += rn * dw / table[c, STIFF_N]
        n_products += 1
        if crushing(table, c) < np.inf:
            cap, v = inner[c, CAP], inner[c, V]
            lack = lacking_of_crushing(table, inner, change, c, barrier, second)
            dv = (lack + v * rn) / cap
            change[c, CAP], change[c, V] = -rn, dv
            room = _room(cap, -rn, _room(v, dv, room))
            first += (cap * dv - v * rn) / table[c, STIFF_N]
            second_order -= rn * dv / table[c, STIFF_N]
            n_products += 1
        if table[c, FRICTION] == 0.0 and table[c, ROOM] == 0.0:
            if room < longest:
                longest, limiting = room, c
            continue
        # Of the room to either side, and of what is slid there.
        near, slid = inner[c, NEAR], inner[c, P]
        d_near = table[c, FRICTION] * rn - rt
        d_slid = (p - slid * d_near) / near
        change[c, NEAR], change[c, P] = d_near, d_slid
        room = _room(near, d_near, _room(slid, d_slid, room))
        first += (near * d_slid + slid * d_near) / table[c, STIFF_T]
        second_order += d_near * d_slid / table[c, STIFF_T]
        far, slid = inner[c, FAR], inner[c, Q]
        d_far = table[c, FRICTION] * rn + rt
        d_slid = (q - slid * d_far) / far
        change[c, FAR], change[c, Q] = d_far, d_slid
        room = _room(far, d_far, _room(slid, d_slid, room))
        first += (far * d_slid + slid * d_far) / table[c, STIFF_T]
        second_order += d_far * d_slid / table[c, STIFF_T]
        n_products += 2
        if room < longest:
            longest, limiting = room, c
    n_products = max(n_products, 1)
    return longest, limiting, first / n_products, second_order / n_products


@njit(cache=True, error_model="numpy")
def move(contacts, count, inner, change, length):
    """Go along the changes, trial reactions included."""
    table = contacts.table
    for c in range(count):
        for i in range(N_INNER):
            inner[c, i] += length * change[c, i]
        table[c, TRIAL_N] += length * change[c, D_TRIAL_N]
        table[c, TRIAL_T] += length * change[c, D_TRIAL_T]
