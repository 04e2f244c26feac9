"""The joint law from its interior: products that vanish, made equal to a barrier.

See `statics.plane.interior` for the method.  With the barrier at zero the variables are those of
the map.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    CRUSH,
    FRICTION,
    LIFT,
    PULL,
    ROOM,
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
    STICKING,
    TORN,
    WITHIN,
    both,
)
from drystone.law.columns import NN, NT, RN, RT, TN, TT
from drystone.law.limits import crushing

#: Columns of a contact's variables within the law's products, see `centre`, after RN and RT; and of
#: their changes, which have those of the trial reactions as well.  The room that the shear has to
#: either side is kept apart: its end is lost in rounding.
W, P, Q, NEAR, FAR, V, CAP, D_TRIAL_N, D_TRIAL_T = 2, 3, 4, 5, 6, 7, 8, 9, 10


N_INNER, N_CHANGE = 9, 11


@njit(cache=True, error_model="numpy")
def central_normal(trial, crush, product):
    """The normal reaction r in (0, C) with r - product (1 / r - 1 / (C - r)) = trial."""
    low, high = 0.0, crush
    r = min(max(trial, 0.25 * crush), 0.75 * crush)
    for _ in range(80):
        missing = trial - r + product / r - product / (crush - r)
        if missing > 0.0:
            low = r
        else:
            high = r
        nearer = r + missing / (1.0 + product / r**2 + product / (crush - r) ** 2)
        if not low < nearer < high:
            nearer = 0.5 * (low + high)
        done = abs(nearer - r) <= 1e-14 * r
        r = nearer
        if done:
            break
    return r


@njit(cache=True, error_model="numpy")
def central_crushing(trial, crush, product):
    """Normal variables of a contact that may be crushed, for a product: the reaction, its slack,
    what crushes it and the room that is left until then."""
    r = central_normal(trial, crush, product)
    slack = product / r
    if trial > 0.5 * crush:  # what is left is too little to be told from the reaction
        beyond = max(trial - r + slack, product / crush)
        return r, slack, beyond, product / beyond
    return r, slack, product / (crush - r), crush - r


@njit(cache=True, error_model="numpy")
def centre(contacts, count, branch, barrier, inner):
    """Variables of every contact for its present trial reactions and a ``barrier`` [J].

    Dilatancy is left out; the iterations make up for it.  Contacts whose bond holds are linear.
    """
    table, which = contacts.table, contacts.which
    for c in range(count):
        row = table[c]
        v = inner[c]
        tn, tt = row[TRIAL_N], row[TRIAL_T]
        if branch[which[c, SLOT]] == BONDED:
            v[RN], v[RT] = tn, tt
            continue
        product = row[STIFF_N] * barrier
        larger = 0.5 * (abs(tn) + np.sqrt(tn * tn + 4.0 * product))
        v[RN] = larger if tn > 0.0 else product / larger
        v[W] = product / v[RN]
        if crushing(table, c) < np.inf:
            v[RN], v[W], v[V], v[CAP] = central_crushing(tn, row[CRUSH], product)
        most = row[FRICTION] * v[RN] + row[ROOM]
        v[RT], v[NEAR], v[FAR], v[P], v[Q] = 0.0, 0.0, 0.0, 0.0, 0.0
        if most == 0.0:
            continue
        # T_t - r - product (1 / (most - r) - 1 / (most + r)) falls with r.
        product = row[STIFF_T] * barrier
        low, high = -most, most
        r = min(max(tt, -0.5 * most), 0.5 * most)
        for _ in range(60):
            room = most * most - r * r
            missing = tt - r - 2.0 * product * r / room
            if missing > 0.0:
                low = r
            else:
                high = r
            slope = 1.0 + 2.0 * product * (most * most + r * r) / (room * room)
            nearer = r + missing / slope
            if not low < nearer < high:
                nearer = 0.5 * (low + high)
            done = abs(nearer - r) <= 1e-12 * most
            r = nearer
            if done:
                break
        v[RT] = r
        # Of the larger slide and the room it leaves, by which r is too coarse to tell.
        if tt > 0.0:
            v[FAR] = most + r
            v[Q] = product / v[FAR]
            v[P] = tt - r + v[Q]
            v[NEAR] = product / v[P]
        else:
            v[NEAR] = most - r
            v[P] = product / v[NEAR]
            v[Q] = r - tt + v[P]
            v[FAR] = product / v[Q]


@njit(cache=True, error_model="numpy")
def respond_within(contacts, count, branch, inner, response):
    """Fill reactions and A of every contact, (n_slots, N_RESPONSE); see `respond`.

    Returns the mean of the products, as energies [J].
    """
    table, which = contacts.table, contacts.which
    energy = 0.0
    n = 0
    for c in range(count):
        row = table[c]
        v = inner[c]
        a = response[c]
        a[RN], a[RT] = v[RN] - row[PULL], v[RT]
        if branch[which[c, SLOT]] == BONDED:
            a[NN], a[NT], a[TN], a[TT] = 1.0, 0.0, 0.0, 1.0
            continue
        mu = row[FRICTION]
        energy += v[RN] * v[W] / row[STIFF_N]
        n += 1
        crushed = 0.0
        if crushing(table, c) < np.inf:
            energy += v[V] * v[CAP] / row[STIFF_N]
            n += 1
            crushed = v[V] / v[CAP]
        if mu == 0.0 and row[ROOM] == 0.0:
            nn = v[RN] / (v[RN] + v[W])
            a[NN], a[NT], a[TN], a[TT] = nn / (1.0 + nn * crushed), 0.0, 0.0, 0.0
            continue
        energy += (v[NEAR] * v[P] + v[FAR] * v[Q]) / row[STIFF_T]
        n += 2
        lift = row[LIFT] / row[STIFF_T]
        p, q = v[P] / v[NEAR], v[Q] / v[FAR]
        nn, nt = 1.0 + v[W] / v[RN] + lift * mu * (p + q) + crushed, lift * (q - p)
        tn, tt = mu * (q - p), 1.0 + p + q
        over = 1.0 / (nn * tt - nt * tn)
        a[NN], a[NT] = tt * over, -nt * over
        a[TN], a[TT] = -tn * over, nn * over
    return energy / max(n, 1)


@njit(cache=True, error_model="numpy")
def lacking(table, inner, change, c, barrier, second):
    """What the three products lack of the barrier, with the changes' own products if ``second``."""
    kn, kt = table[c, STIFF_N] * barrier, table[c, STIFF_T] * barrier
    n = kn - inner[c, RN] * inner[c, W]
    p = kt - inner[c, NEAR] * inner[c, P]
    q = kt - inner[c, FAR] * inner[c, Q]
    if second:
        n -= change[c, RN] * change[c, W]
        p -= change[c, NEAR] * change[c, P]
        q -= change[c, FAR] * change[c, Q]
    return n, p, q


@njit(cache=True, error_model="numpy")
def lacking_of_crushing(table, inner, change, c, barrier, second):
    """The same of the product of a joint that may be crushed."""
    v = table[c, STIFF_N] * barrier - inner[c, CAP] * inner[c, V]
    return v - change[c, CAP] * change[c, V] if second else v


@njit(cache=True, error_model="numpy")
def choose(contacts, count, inner, branch):
    """Branch of every contact by the smaller factor of each product."""
    which, table = contacts.which, contacts.table
    for c in range(count):
        k = which[c, SLOT]
        if branch[k] == BONDED:
            continue
        v = inner[c]
        if v[W] > v[RN] and table[c, ROOM] == 0.0:
            branch[k] = OPEN
            continue
        across, along = WITHIN, STICKING
        if v[NEAR] < v[P]:
            along = FORWARD
        elif v[FAR] < v[Q]:
            along = BACKWARD
        if v[W] > v[RN]:
            across = TORN
        elif crushing(table, c) < np.inf and v[CAP] < v[V]:
            across = CRUSHED
        branch[k] = both(across, along)
