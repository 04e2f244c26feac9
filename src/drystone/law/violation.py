"""Differences of reactions from those of the joint law, for certificates."""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import BOND_TIE
from drystone.contact.contacts import (
    BOND,
    FRICTION,
    INTERCEPT,
    PULL,
    SHIFT,
    STIFF_N,
    STIFF_T,
    TENSILE,
)
from drystone.law.limits import crushing


@njit(cache=True, error_model="numpy")
def joint_law_violation(table, gap, slip, reaction, shear_before, whole, slack):
    """Largest differences [N] of reactions from those of the joint law.

    The reactions of the law are r_n = k_n <-g> and r_t = t_0 - k_s s, the latter limited to mu r_n
    + bond.  A bond also pulls, r_n = -k_n g, up to its tensile strength.  For joints that soften or
    are crushed see `law.limits`.  For friction without shear stiffness, pass the reaction itself as
    ``shear_before`` and any positive stiffness: the difference is then zero only if the law holds
    (natural map).  If the slip is zero too, only the friction cone is checked.

    Parameters
    ----------
    table
        Stiffness, friction and strengths, (n_contacts, N_TABLE).
    gap
        At the end of the step, less dilation, (n_contacts,) [m].
    slip
        Sliding in the step, (n_contacts, dim - 1) [m].
    reaction
        (n_contacts, dim) [N], normal and tangential.
    shear_before
        (n_contacts, dim - 1) [N], tangential reaction at the start of the step.
    whole
        (n_contacts,) 1 if a bond has not broken, else 0.
    slack
        (n_contacts,) accuracy of reactions [N]: a smaller excess breaks no bond.

    Returns
    -------
    normal, tangential
        Largest difference of normal and of tangential reactions [N].
    cone
        Excess of tangential reactions over friction and cohesion [N].
    """
    normal, tangential, cone = 0.0, 0.0, 0.0
    for c in range(gap.shape[0]):
        bond, tension = whole[c] * table[c, BOND], whole[c] * table[c, TENSILE]
        strength = bond + tension
        law_n = min(table[c, SHIFT] - table[c, STIFF_N] * gap[c], crushing(table, c))
        beyond = law_n < -tension - BOND_TIE * strength - slack[c]
        if beyond or (law_n < 0.0 and strength == 0.0):
            law_n = 0.0
        law_n -= table[c, PULL]
        intercept = table[c, INTERCEPT] + bond
        limit = max(table[c, FRICTION] * (reaction[c, 0] + table[c, PULL]) + intercept, 0.0)
        if slip.shape[1] == 1:
            law_t = shear_before[c, 0] - table[c, STIFF_T] * slip[c, 0]
            law_t = min(max(law_t, -limit), limit)
            size, away = abs(reaction[c, 1]), abs(reaction[c, 1] - law_t)
        else:
            first = shear_before[c, 0] - table[c, STIFF_T] * slip[c, 0]
            second = shear_before[c, 1] - table[c, STIFF_T] * slip[c, 1]
            trial = np.hypot(first, second)
            share = limit / trial if trial > limit else 1.0
            size = np.hypot(reaction[c, 1], reaction[c, 2])
            away = np.hypot(reaction[c, 1] - share * first, reaction[c, 2] - share * second)
        normal = max(normal, abs(reaction[c, 0] - law_n))
        tangential = max(tangential, away)
        cone = max(cone, size - limit)
        # Comparisons with NaN would hide it.
        if not np.isfinite(law_n + away + size + reaction[c, 0]):
            return np.nan, np.nan, np.nan
    return normal, tangential, cone
