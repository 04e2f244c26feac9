"""The joint law in explicit cycles: the reactions of a contact, and the change of its history.

Brittle bonds break at once.  Strengths of joints that soften or are crushed fall from cycle to
cycle, see `law.strengths`.  Each cycle uses the strengths at the end of the last one, because
opening, slip and crushing in one cycle are small.  Shear is taken by its size, so that the same
kernels serve plane and space.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import AT_CONE, FULLY_SOFTENED, GRAZE
from drystone.contact.forces import OPEN, SLIDING, STICKING
from drystone.law.columns import (
    BROKEN,
    BY_CRUSHING,
    BY_OPENING,
    BY_SLIP,
    COHESION,
    COHESIVE,
    CRUSHES,
    DILATANCY_END,
    DILATION,
    KN,
    KS,
    LEAST_MU,
    MU,
    OPENED,
    PER_SLIP,
    PULLS,
    SHEAR,
    SLID,
    SOFTENED,
    TAN_PSI,
    TENSION,
    YIELDS,
)
from drystone.law.plane import slide


@njit(cache=True)
def _opens(rn, gap, tension, whole):
    """Whether a contact is open in a cycle, and whether its bond is still ``whole``.

    ``rn`` [N] is the normal trial reaction, ``tension`` [N] the tensile strength.
    """
    if rn >= 0.0:
        return False, whole
    whole = whole and not (gap > GRAZE and rn < -tension)
    return not whole or tension == 0.0, whole


@njit(cache=True)
def _drag(rn, rt, bond, kn, ks, mu, tan_psi):
    """Reactions [N] for trial reactions in a cycle, the status of the contact, and its slip [m].

    A bond that breaks under tension leaves the contact open.  ``bond`` [N] is the cohesion, zero if
    the bond is broken.
    """
    limit = mu * rn + bond
    if not (abs(rt) > limit * (1.0 - AT_CONE) and rt != 0.0):
        return rn, rt, STICKING, 0.0
    if rn <= 0.0:
        return 0.0, 0.0, OPEN, 0.0
    gamma = slide(rn, abs(rt), ks, mu, kn * tan_psi)
    rn += kn * tan_psi * gamma
    return rn, mu * rn if rt > 0.0 else -mu * rn, SLIDING, gamma


@njit(cache=True)
def opens_in_cycle(law, history, c, rn, gap, kept):
    """Whether a contact carries nothing in this cycle, for its trial reaction ``rn`` [N].

    A brittle bond that the gap has torn is marked as broken.  Bonds that are ``kept`` stay intact
    whatever they carry.  Joints that yield are left to `react_in_cycle`.
    """
    if kept or law[c, YIELDS] != 0.0:
        return False
    bonded = history[c, BROKEN] == 0.0
    is_open, whole = _opens(rn, gap, law[c, TENSION], bonded)
    if bonded and not whole:
        history[c, BROKEN] = 1.0
    return is_open


@njit(cache=True)
def open_in_cycle(law, history, reaction, status, c):
    """Open a contact from this cycle on; the work [J] of the shear that it loses."""
    square = 0.0
    for d in range(SHEAR, history.shape[1]):
        square += history[c, d] * history[c, d]
        history[c, d] = 0.0
    for d in range(reaction.shape[1]):
        reaction[c, d] = 0.0
    status[c] = OPEN
    return 0.5 * square / law[c, KS]


@njit(cache=True)
def keeps_bond_in_cycle(law, history, c, keep_bonds):
    """Whether a contact has a brittle bond that stays intact whatever it carries."""
    whole = history[c, BROKEN] == 0.0
    return whole and keep_bonds and law[c, COHESION] + law[c, TENSION] > 0.0


@njit(cache=True)
def react_in_cycle(law, history, c, rn, gap, size, kept):
    """The reactions of contact c, which is not open, in a cycle; its history is updated.

    Parameters
    ----------
    law, history
        Of all contacts, (n, N_LAW), see `law.columns.PER_AREA`, and (n, N_HISTORY or more).
    rn, size
        Normal trial reaction and size of the trial shear [N].
    gap
        Gap in the present poses [m].
    kept
        See `keeps_bond_in_cycle`.

    Returns
    -------
    rn, rt
        Normal reaction and size of the shear [N].
    now
        Status of the contact.
    work
        Dissipated energy [J].
    """
    if law[c, YIELDS] != 0.0:
        rn, taken = normal_in_cycle(law, history, c, gap)
        rt, now, work = shear_in_cycle(law, history, c, rn, size)
        return rn, rt, now, taken + work
    if kept:
        return rn, size, STICKING, 0.0
    tan_psi = law[c, TAN_PSI] if history[c, SLID] < law[c, DILATANCY_END] else 0.0
    bond = law[c, COHESION] if history[c, BROKEN] == 0.0 else 0.0
    ks, work = law[c, KS], 0.0
    rn, rt, now, gamma = _drag(rn, size, bond, law[c, KN], ks, law[c, MU], tan_psi)
    if now != STICKING:
        history[c, BROKEN] = 1.0
    if now == OPEN:
        work = 0.5 * size * size / ks
    elif now == SLIDING:
        history[c, DILATION] += tan_psi * gamma
        history[c, SLID] += gamma
        # The work of sliding, less the work that lifts the joint.
        work = (rt - rn * tan_psi) * gamma
    return rn, rt, now, work


@njit(cache=True)
def normal_in_cycle(law, history, c, gap):
    """Normal reaction [N] of a joint that yields at a ``gap`` [m], and the work [J] dissipated by
    opening or crushing."""
    kn, work = law[c, KN], 0.0
    away = gap - history[c, DILATION]
    if away <= 0.0:
        rn = -kn * away
        softened = law[c, BY_CRUSHING] * max(-history[c, DILATION], 0.0)
        most = law[c, CRUSHES] * np.exp(-min(softened, FULLY_SOFTENED))
        if rn > most:
            crushed = (rn - most) / kn
            history[c, DILATION] -= crushed
            return most, most * crushed
        return rn, work
    pull = law[c, PULLS]
    if history[c, BROKEN] != 0.0 or pull == 0.0 or away <= history[c, OPENED]:
        return 0.0, work
    rn, most = -kn * (away - history[c, OPENED]), pull * np.exp(-history[c, SOFTENED])
    if -rn > most:
        torn = (-rn - most) / kn
        history[c, OPENED] += torn
        history[c, SOFTENED] += law[c, BY_OPENING] * torn
        rn = -pull * np.exp(-history[c, SOFTENED])
        work = most * torn
    return rn, work


@njit(cache=True)
def shear_in_cycle(law, history, c, rn, size):
    """Size of the tangential reaction [N] of a joint that yields, for a trial shear of this
    ``size`` [N]; the contact's status; and the dissipated work [J]."""
    bonded = law[c, COHESIVE] + law[c, PULLS] > 0.0
    whole = bonded and history[c, BROKEN] == 0.0
    left = np.exp(-history[c, SOFTENED]) if whole else 0.0
    if rn <= 0.0 and not whole:
        return 0.0, OPEN, 0.5 * size * size / law[c, KS]
    share = left if bonded else np.exp(-law[c, PER_SLIP] * history[c, SLID])
    mu = law[c, LEAST_MU] + (law[c, MU] - law[c, LEAST_MU]) * share
    most = max(mu * rn + law[c, COHESIVE] * left, 0.0)
    now, work = STICKING, 0.0
    if size > most:
        slid = (size - most) / law[c, KS]
        history[c, SLID] += slid
        if whole:
            history[c, SOFTENED] += law[c, BY_SLIP] * slid
        now, work, size = SLIDING, most * slid, most
    if whole and history[c, SOFTENED] > FULLY_SOFTENED:
        history[c, BROKEN] = 1.0
    return size, now, work
