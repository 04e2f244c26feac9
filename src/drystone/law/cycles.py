"""Joints that soften or are crushed, as cycles follow them: their strengths fall on the way.

See `law.strengths` for how.  In a cycle strengths are those that the last one has left, and
what opens, slips or is crushed in it is small.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.law.law import (
    BROKEN,
    DILATION,
    L_BY_CRUSHING,
    L_BY_OPENING,
    L_BY_SLIP,
    L_COHESIVE,
    L_CRUSH,
    L_KN,
    L_KS,
    L_MU,
    L_PER_SLIP,
    L_PULL,
    L_RESIDUAL,
    OPEN,
    OPENED,
    SLID,
    SLIDING,
    SOFTENED,
    STICKING,
)
from drystone.law.softening import LOST


@njit(cache=True)
def normal_in_cycle(law, history, c, gap):
    """Normal reaction [N] at a gap, and the work [J] of opening or crushing in it."""
    kn, work = law[c, L_KN], 0.0
    away = gap - history[c, DILATION]
    if away <= 0.0:
        rn = -kn * away
        softened = law[c, L_BY_CRUSHING] * max(-history[c, DILATION], 0.0)
        most = law[c, L_CRUSH] * np.exp(-min(softened, LOST))
        if rn > most:
            crushed = (rn - most) / kn
            history[c, DILATION] -= crushed
            return most, most * crushed
        return rn, work
    pull = law[c, L_PULL]
    if history[c, BROKEN] != 0.0 or pull == 0.0 or away <= history[c, OPENED]:
        return 0.0, work
    rn, most = -kn * (away - history[c, OPENED]), pull * np.exp(-history[c, SOFTENED])
    if -rn > most:
        torn = (-rn - most) / kn
        history[c, OPENED] += torn
        history[c, SOFTENED] += law[c, L_BY_OPENING] * torn
        rn = -pull * np.exp(-history[c, SOFTENED])
        work = most * torn
    return rn, work


@njit(cache=True)
def shear_in_cycle(law, history, c, rn, size):
    """Size of the tangential reaction [N] of a trial one, the contact's status, and work [J]."""
    bonded = law[c, L_COHESIVE] + law[c, L_PULL] > 0.0
    whole = bonded and history[c, BROKEN] == 0.0
    left = np.exp(-history[c, SOFTENED]) if whole else 0.0
    if rn <= 0.0 and not whole:
        return 0.0, OPEN, 0.5 * size * size / law[c, L_KS]
    share = left if bonded else np.exp(-law[c, L_PER_SLIP] * history[c, SLID])
    mu = law[c, L_RESIDUAL] + (law[c, L_MU] - law[c, L_RESIDUAL]) * share
    most = max(mu * rn + law[c, L_COHESIVE] * left, 0.0)
    now, work = STICKING, 0.0
    if size > most:
        slid = (size - most) / law[c, L_KS]
        history[c, SLID] += slid
        if whole:
            history[c, SOFTENED] += law[c, L_BY_SLIP] * slid
        now, work, size = SLIDING, most * slid, most
    if whole and history[c, SOFTENED] > LOST:
        history[c, BROKEN] = 1.0
    return size, now, work
