"""Bonds of brittle joints: how near each is to its strength, and which ones break.

A bond with cohesion c and tensile strength f_t, at a contact of area A, is intact while

    |r_t| <= mu r_n + c A,        r_n >= -f_t A

Beyond this it breaks at once.  Its margin is the smaller of two distances: to the first limit over
the cohesion, and to the second limit over the tensile strength.  Bonds that soften have no margin,
with one exception: if slip softens a cohesion and there is no tensile strength, opening takes no
energy, so the bond breaks at once when the joint opens.
"""

from __future__ import annotations

from functools import reduce

import numpy as np

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.common.tolerances import BOND_TIE, BUILT_SHUT, LEAST_STRENGTH, TOGETHER
from drystone.contact.contacts import FRICTION, INTERCEPT, NONE, STIFF_N, Slots
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING
from drystone.law.certificate import JudgedContacts
from drystone.law.columns import COHESION, MU, TENSION


def brittle(laws: Array) -> bool:
    """Whether any joint law has a bond, by the table of `law.table`."""
    return bool((laws[:, [COHESION, TENSION]] > 0.0).any())


def built_open(slots: Slots, size: float) -> BoolArray:
    """Contacts (n_slots,) without a bond because the joint is open in the design.

    ``size`` [m] is the smallest extent of a block.
    """
    return (slots.kind == NONE) | (slots.gap > BUILT_SHUT * size)


def shear(reaction: Array) -> Array:
    """Size of the tangential reaction (n,) [N] of reactions (n, dim)."""
    size: Array = reduce(np.hypot, reaction[:, 1:].T)
    return np.abs(size)


def margins(judged: JudgedContacts, tears: BoolArray) -> Array:
    """Margins of contacts, (n_contacts,); infinite for contacts without a bond.

    ``tears`` (n_contacts,) are the contacts whose bond softens by slip, and breaks by opening.
    """
    normal, tangential, slack = judged.reaction[:, 0], shear(judged.reaction), judged.slack
    bond, tension = judged.strength
    bonded = bond + tension > 0.0
    along = judged.contacts.table[:, FRICTION] * normal + bond + slack - tangential
    along = np.divide(along, np.maximum(bond, LEAST_STRENGTH * tension), where=bonded, out=along)
    across = normal + tension + slack
    across = np.divide(across, np.maximum(tension, LEAST_STRENGTH * bond), where=bonded, out=across)
    margin = np.where(bonded, np.minimum(along, across), np.inf)
    table = judged.contacts.table[tears]
    cohesion = table[:, INTERCEPT] * judged.whole[tears]
    # The pressure is continued linearly into negative values if the joint is open.
    pressure = slack[tears] - table[:, STIFF_N] * judged.gap[tears]
    opens = np.full(len(cohesion), np.inf)
    np.divide(pressure, LEAST_STRENGTH * cohesion, where=cohesion > 0.0, out=opens)
    margin[tears] = opens
    return margin


def dilating_margins(slid: Array, until: Array) -> Array:
    """Margins (n,) to the end of dilatancy, for contacts that have ``slid`` (n,) [m] and dilate
    ``until`` a slip (n,) [m]: the slip that is left over the whole; infinite if there is no end."""
    left = np.full(len(slid), np.inf)
    np.divide(until - slid, until, where=np.isfinite(until), out=left)
    return left


def weakest(margin: Array) -> IntArray:
    """Rows of the bonds that break: those that exceed their strength most, if any does."""
    worst = margin.min(initial=np.inf)
    if worst >= -BOND_TIE:
        return np.zeros(0, np.int64)
    return np.flatnonzero(margin <= worst + TOGETHER)


def crossing(first: float, before: Array, second: float, after: Array, aim: float) -> float:
    """Share of a step at which the first bond reaches the margin ``aim``; infinity if none does.

    ``before`` and ``after`` (n,) are margins of the same contacts at the shares ``first`` and
    ``second`` of the step.  They are interpolated and extrapolated linearly.
    """
    falling = np.isfinite(before) & (after < before)
    drop = before[falling] - after[falling]
    reached = first + (second - first) * (before[falling] - aim) / drop
    return float(reached.min(initial=np.inf))


def yielded(laws: Array, law: IntArray, reaction: Array) -> IntArray:
    """Branch of the joint law (n,) of contacts whose bond breaks at a reaction (n, dim) [N]."""
    normal, in_plane = reaction[:, 0], reaction.shape[1] == 2
    sliding = np.where(reaction[:, 1] > 0.0, FORWARD, BACKWARD)
    sliding = sliding if in_plane else np.full(len(normal), FORWARD)
    sticks = shear(reaction) <= laws[law, MU] * normal
    return np.where(normal <= 0.0, OPEN, np.where(sticks, STICKING, sliding))


def release(laws: Array, law: IntArray, reaction: Array) -> Array:
    """Force (n,) [N] that contacts release when their bond breaks at a reaction (n, dim) [N]."""
    normal, tangential = reaction[:, 0], shear(reaction)
    limit = laws[law, MU] * np.maximum(normal, 0.0)
    return np.hypot(np.minimum(normal, 0.0), np.maximum(tangential - limit, 0.0))
