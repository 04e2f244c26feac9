"""From which former contact point a contact point in space inherits its history.

A point inherits from the point of the same pair that has the same features.  If features have
changed (a crossing has become a vertex), it inherits from the nearest former point from which no
other point inherits, if its distance is at most SUCCESSOR widths of the interface.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import SUCCESSOR
from drystone.contact.contacts import (
    ARM_A_3,
    ARM_B_3,
    FEATURE_A,
    FEATURE_B,
    KIND,
    NONE,
    NORMAL_3,
    SIZE,
    TANGENT_3,
)


@njit(cache=True)
def _apart(was, now, j, k):
    """Squared distance of two points of a pair [m2], the smaller one of the two seen from a and
    from b."""
    on_a, on_b = 0.0, 0.0
    for c in range(3):
        on_a += (was[j, ARM_A_3 + c] - now[k, ARM_A_3 + c]) ** 2
        on_b += (was[j, ARM_B_3 + c] - now[k, ARM_B_3 + c]) ** 2
    return min(on_a, on_b)


@njit(cache=True)
def _match(before, was, after, now, begin, end, source, taken):
    """Find the sources of the slots of one pair, from ``begin`` to before ``end``."""
    area_before, area_now, left = 0.0, 0.0, 0
    for k in range(begin, end):
        source[k], taken[k] = -1, before[k, KIND] == NONE
        area_before += was[k, SIZE] if before[k, KIND] != NONE else 0.0
        area_now += now[k, SIZE] if after[k, KIND] != NONE else 0.0
    for k in range(begin, end):
        if after[k, KIND] == NONE:
            continue
        # Mostly it is the same slot, so the search begins there.
        for step in range(end - begin):
            j = k + step if k + step < end else begin + (k + step - end)
            if (
                not taken[j]
                and before[j, FEATURE_A] == after[k, FEATURE_A]
                and before[j, FEATURE_B] == after[k, FEATURE_B]
            ):
                source[k], taken[j] = j, True
                break
        left += source[k] < 0
    limit = SUCCESSOR * SUCCESSOR * max(area_before, area_now)
    while left > 0:
        nearest, of, to = limit, -1, -1
        for k in range(begin, end):
            if after[k, KIND] == NONE or source[k] >= 0:
                continue
            for j in range(begin, end):
                if not taken[j]:
                    apart = _apart(was, now, j, k)
                    if apart <= nearest:
                        nearest, of, to = apart, j, k
        if of < 0:
            break
        source[to], taken[of] = of, True
        left -= 1


@njit(cache=True)
def find_predecessors(pairs, previous, slots, source):
    """For every slot, the slot of the same pair whose history it inherits, or -1.

    ``previous`` are the former slots of the same pairs.  Each has at most one heir.  Fills
    ``source`` (n_slots,).
    """
    pair = pairs.of_slot
    (before, was), (after, now) = previous, slots
    n = pair.shape[0]
    taken = np.zeros(n, np.bool_)
    begin = 0
    while begin < n:
        end = begin + 1
        while end < n and pair[end] == pair[begin]:
            end += 1
        _match(before, was, after, now, begin, end, source, taken)
        begin = end


@njit(cache=True)
def carried(before, now, source, shear_before, shear):
    """Turn the tangential reactions of former slots to the tangents of the slots that inherit them.

    ``before`` are the former slots, followed to the present pose, with the tangential reactions
    ``shear_before`` (n_before, 2) [N].  Fills ``shear`` (n_slots, 2) [N].  The component along the
    new normal is dropped.
    """
    (_, was), (which, value) = before, now
    for k in range(which.shape[0]):
        j = source[k]
        shear[k, 0], shear[k, 1] = 0.0, 0.0
        if which[k, KIND] == NONE or j < 0:
            continue
        force_1, force_2 = shear_before[j, 0], shear_before[j, 1]
        for c in range(3):
            d, e = (c + 1) % 3, (c + 2) % 3
            second = was[j, NORMAL_3 + d] * was[j, TANGENT_3 + e]
            second -= was[j, NORMAL_3 + e] * was[j, TANGENT_3 + d]
            force = force_1 * was[j, TANGENT_3 + c] + force_2 * second
            second = value[k, NORMAL_3 + d] * value[k, TANGENT_3 + e]
            second -= value[k, NORMAL_3 + e] * value[k, TANGENT_3 + d]
            shear[k, 0] += force * value[k, TANGENT_3 + c]
            shear[k, 1] += force * second
