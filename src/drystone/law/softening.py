"""Reactions and tangent of joints that soften or are crushed, with their strengths at a step's end.

In `law.limits`, strengths are constant while a step is solved.  Here they follow from the gap y and
the trial shear T per area of a contact, by the law of `law.strengths`.  A contact may open, slip
and soften at once.  The only unknown is then the softening s of its bond:

    s = s_0 + (c / G_II) gamma(s) + (f_t / G_I) kappa(s),
    gamma = (|T| - most(s)) / k_s,    kappa = y - opened - f_t e^-s / k_n,

where negative values of gamma and kappa count as zero.  Without a bond, the unknown is the slip,
with which friction falls.  The tangent follows from the same equation, so that Newton's method on
the balance of the blocks is consistent with the law (Simo and Taylor 1985).
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import FULLY_SOFTENED, LAST_DIGIT, LAST_DIGITS, LEAST_SLOPE
from drystone.law.columns import (
    BY_CRUSHING,
    BY_OPENING,
    BY_SLIP,
    COHESIVE,
    CRUSHES,
    KN,
    KS,
    LEAST_MU,
    MU,
    PER_SLIP,
    PULLS,
    SOFTENS,
)

#: Columns of a contact: 1 if its bond is whole; its state of softening (see `strengths.Reached`);
#: gap [m]; size of the trial shear [Pa].  The index of its law is passed separately.
C_WHOLE, C_SOFTENED, C_OPENED, C_SLID, C_CRUSHED, C_GAP, C_SHEAR = 0, 1, 2, 3, 4, 5, 6
N_CONTACT = 7

#: Columns of the results of a contact: pressure, shear [Pa]; their derivatives by the gap [Pa/m]
#: and by the trial shear; and its new state of softening.
P_NORMAL, P_SHEAR, P_NY, P_NT, P_TY, P_TT, P_SOFTENED, P_OPENED, P_SLID, P_CRUSHED = range(10)
N_POINT = 10


@njit(cache=True, error_model="numpy")
def _pressed(law, crushed, y):
    """Pressure [Pa] of a contact that is closed, its derivative by the gap [Pa/m], and its closure
    by crushing [m].

    The strength falls less steeply than the stiffness rises, as `model.construction.joint_checks`
    asks.
    """
    kn, strength, rate = law[KN], law[CRUSHES], law[BY_CRUSHING]
    p = -kn * y
    at = crushed
    if not p > strength * np.exp(-min(rate * crushed, FULLY_SOFTENED)):
        return p, -kn, crushed
    for _ in range(60):  # Newton's method, which converges from below
        carried = strength * np.exp(-min(rate * at, FULLY_SOFTENED))
        slope = rate * carried if rate * at < FULLY_SOFTENED else 0.0
        more = (-kn * (y + at - crushed) - carried) / (kn - slope)
        at += more
        if abs(more) <= LAST_DIGIT * (abs(y) + at):
            break
    carried = strength * np.exp(-min(rate * at, FULLY_SOFTENED))
    slope = rate * carried if rate * at < FULLY_SOFTENED else 0.0
    return carried, slope * kn / (kn - slope), at


@njit(cache=True, error_model="numpy")
def _normal(law, whole, opened, pulls, y, s, at):
    """Fill ``at`` (6,) for a contact that is open: the pressure, its derivatives by y and s, kappa,
    and its derivatives by y and s."""
    for i in range(6):
        at[i] = 0.0
    if not (whole and pulls):
        return
    kn, f = law[KN], law[PULLS] * np.exp(-s)
    beyond = y - opened
    if beyond > f / kn:
        at[0], at[2] = -f, f
        at[3], at[4], at[5] = beyond - f / kn, 1.0, f / kn
    else:
        at[0], at[1] = -kn * beyond, -kn


@njit(cache=True, error_model="numpy")
def points(laws, law_of, contact, point):
    """Fill ``point`` (n, N_POINT) for contacts (n, N_CONTACT) of laws (n_laws, N_LAW)."""
    at = np.zeros(6)
    for c in range(law_of.shape[0]):
        law = laws[law_of[c]]
        whole = contact[c, C_WHOLE] != 0.0 and law[COHESIVE] + law[PULLS] > 0.0
        y, shear, out = contact[c, C_GAP], contact[c, C_SHEAR], point[c]
        opened, slid, crushed = contact[c, C_OPENED], contact[c, C_SLID], contact[c, C_CRUSHED]
        ks, least, fall = law[KS], law[LEAST_MU], law[MU] - law[LEAST_MU]
        pulls = opened == 0.0 or y > opened
        shut = y <= 0.0
        if shut:
            p, py, crushed = _pressed(law, crushed, y)
            at[:] = 0.0
            at[0], at[1] = p, py
        s, start = contact[c, C_SOFTENED], contact[c, C_SOFTENED]
        gamma, most, my, ms, slope = 0.0, 0.0, 0.0, 0.0, 1.0
        if whole:
            by_slip, by_opening = law[BY_SLIP], law[BY_OPENING]
            for _ in range(100):
                left = np.exp(-s)
                if not shut:
                    _normal(law, whole, opened, pulls, y, s, at)
                mu = least + fall * left
                most = mu * at[0] + law[COHESIVE] * left
                my, ms = mu * at[1], mu * at[2] - fall * left * at[0] - law[COHESIVE] * left
                if most < 0.0:
                    most, my, ms = 0.0, 0.0, 0.0
                gamma, slope = 0.0, 1.0 - by_opening * at[5]
                if shear > most:
                    gamma = (shear - most) / ks
                    slope += by_slip * ms / ks
                slope = max(slope, LEAST_SLOPE)
                more = (start + by_slip * gamma + by_opening * at[3] - s) / slope
                s += more
                if abs(more) <= LAST_DIGITS * (1.0 + s):
                    break
        else:
            rate = 0.0 if law[SOFTENS] != 0.0 else law[PER_SLIP]
            fallen = law[SOFTENS] != 0.0
            if not shut:
                at[:] = 0.0
            pressure = max(at[0], 0.0)
            for _ in range(100):
                mu = least + (0.0 if fallen else fall * np.exp(-rate * (slid + gamma)))
                most, my = mu * pressure, mu * at[1]
                if not shear > most:
                    gamma = 0.0
                    break
                slope = max(1.0 - rate * (mu - least) * pressure / ks, LEAST_SLOPE)
                more = ((shear - most) / ks - gamma) / slope
                gamma += more
                if abs(more) <= LAST_DIGITS * (gamma + slid):
                    break
        slides = shear > most
        if whole:
            sy = by_opening * at[4] - (by_slip * my / ks if slides else 0.0)
            sy, st = sy / slope, (by_slip / ks / slope if slides else 0.0)
            out[P_NY], out[P_NT] = at[1] + at[2] * sy, at[2] * st
            out[P_TY], out[P_TT] = (my + ms * sy, ms * st) if slides else (0.0, 1.0)
        else:
            # Further slip lowers friction: most = mu(slid + gamma) p.
            loss = -rate * (mu - least) * pressure if slides else 0.0
            gy, gt = -my / ks / slope, 1.0 / ks / slope
            out[P_NY], out[P_NT] = at[1], 0.0
            out[P_TY], out[P_TT] = (my + loss * gy, loss * gt) if slides else (0.0, 1.0)
        if not (whole or at[0] > 0.0):
            most, slides = 0.0, True
            out[P_TY], out[P_TT] = 0.0, 0.0
        out[P_NORMAL], out[P_SHEAR] = at[0], most if slides else shear
        out[P_SOFTENED], out[P_SLID] = s, slid + gamma
        out[P_OPENED] = opened + (at[3] if whole else 0.0)
        out[P_CRUSHED] = crushed
