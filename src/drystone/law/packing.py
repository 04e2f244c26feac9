"""Packs the contacts in use for solvers, with the parameters of their joint laws."""

from __future__ import annotations

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    BOND,
    FRICTION,
    KIND,
    LAW,
    NONE,
    PAIR,
    SIZE,
    SLOT,
    STIFF_N,
    STIFF_T,
    TENSILE,
    A,
    B,
)
from drystone.contact.plane.rows import N_DOF, gradients
from drystone.contact.rows import MEASURED, OF_SLIP
from drystone.law.columns import COHESION, KN, KS, MU, TENSION


@njit(cache=True, error_model="numpy")
def pack(slots, pairs, laws, thickness, contacts):
    """Fill ``contacts`` of the plane from the slots in use, with gradients but without history;
    returns their number.  ``laws`` (n_laws, N_LAW); ``thickness`` [m]."""
    count = pack_laws(slots, pairs, laws, thickness, contacts)
    which, rows, value = contacts.which, contacts.rows, slots.value
    for c in range(count):
        gradients(value, which[c, SLOT], rows, c)
        for i in range(2 * N_DOF):
            rows[c, MEASURED, i] = rows[c, OF_SLIP, i]
    return count


@njit(cache=True, error_model="numpy")
def pack_laws(slots, pairs, laws, thickness, contacts):
    """The same without gradients, in both dimensions; in space ``thickness`` is one."""
    meets, value = slots
    pair, of_pair = pairs.of_slot, pairs.which
    which, table = contacts.which, contacts.table
    count = 0
    for k in range(meets.shape[0]):
        if meets[k, KIND] == NONE:
            continue
        c = count
        count += 1
        p = pair[k]
        law, area = of_pair[p, LAW], value[k, SIZE] * thickness
        which[c, SLOT], which[c, PAIR] = k, p
        which[c, BODY_A], which[c, BODY_B] = of_pair[p, A], of_pair[p, B]
        table[c, :] = 0.0
        table[c, STIFF_N], table[c, STIFF_T] = laws[law, KN] * area, laws[law, KS] * area
        table[c, FRICTION] = laws[law, MU]
        table[c, BOND], table[c, TENSILE] = laws[law, COHESION] * area, laws[law, TENSION] * area
    return count
