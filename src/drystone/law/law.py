"""The joint law: what a contact's reactions are, in every form that a solver needs.

With the stiffnesses times the contact's tributary area k_n, k_s [N/m], gap g, accumulated
dilation d, slip increment s and shear t_0 at the start of the step, the trial reactions are

    r_n = k_n (d - g)          r_t = t_0 - k_s s

Without tension k_s r_n + k_n tan(psi) |r_t| <= 0 means open, which without dilatancy is r_n <= 0.
|r_t| <= mu r_n sticks.  Otherwise the joint slides by

    gamma = (|r_t| - mu r_n) / (k_s + mu k_n tan psi)

against the trial shear, which raises the normal reaction by k_n tan(psi) gamma (return mapping;
non-associative unless tan psi = mu).  A bond holds whatever it carries: when it is lost is decided
between steps (see `law.bonds`).  In each of these branches the reactions are linear in the
trial reactions, and they are continuous.

`law.return_map` is this law, of numbers alone.  Below are its forms for contacts in tables, and
what solvers need beside it: how far a contact is from the next branch, a residual, impulses
without shear stiffness, and products that vanish, for the interior point method.  The form for
explicit cycles, in which bonds break at once, is `law.cycles`; of joints that soften or are
crushed, see `law.yielding` and `law.softening`.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (  # fmt: skip
    ADD_N,
    ADD_T,
    BOND,
    CRUSH,
    FRICTION,
    LAW,
    LIFT,
    PLASTIC,
    PULL,
    ROOM,
    SHIFT,
    SLOT,
    STIFF_N,
    STIFF_T,
    TENSILE,
    TRIAL_N,
    TRIAL_T,
)
from drystone.contact.rows import MEASURED, OF_GAP, OF_SLIP
from drystone.law.return_map import (
    BACKWARD,
    BONDED,
    CRUSHED,
    FORWARD,
    OPEN,
    STICKING,
    TORN,
    along_joint,
    branch_for,
    derivatives_in,
    reactions_in,
    sense,
)  # fmt: skip
from drystone.law.yielding import (
    central_normal,
    change_beyond,
    crushing,
    distance_beyond,
    held_normal,
    landing_beyond,
    yields,
)  # fmt: skip

#: What contacts are called in results; the sense of sliding is that of the reaction.
SLIDING = 2

#: A contact this near to its cone slides, where it is asked anew in every sweep or cycle.
AT_CONE = 1e-9

#: Angles of friction in space are found to this [rad], from at least so many.
ANGLE, N_ANGLES = 1e-9, 32

#: A bond holds beyond its strength by this share of it: what is at its limit has not broken.
BOND_TIE = 1e-6

#: Columns of the history of a contact: dilation, less what crushed it [m], slid distance [m],
#: broken bond, how far its bond has softened, what it was torn open by [m], and shear [N], one for
#: each tangent.
DILATION, SLID, BROKEN, SOFTENED, OPENED, SHEAR = 0, 1, 2, 3, 4, 5
N_HISTORY = 6  # in the plane

#: Columns of the table of joint laws: mu, k_n, k_s [Pa/m], tan psi, c, f_t [Pa] of brittle bonds,
#: slide at which dilatancy ends [m].
MU, KN, KS, TAN_PSI, COHESION, TENSION, DILATANCY_END = 0, 1, 2, 3, 4, 5, 6
#: Of laws that yield: 1, c, f_t, what they soften by opening and by slip [1/m], mu in the end, how
#: it falls by slip [1/m], f_c [Pa] and how that falls by crushing [1/m], 1 where friction falls
#: with the bond.
YIELDS, COHESIVE, PULLS, BY_OPENING, BY_SLIP, LEAST_MU, PER_SLIP, CRUSHES, BY_CRUSHING = range(
    7, 16
)
SOFTENS = 16
N_LAW = 17
#: Those that contacts have times their area, in newtons.
PER_AREA = (KN, KS, COHESION, TENSION, COHESIVE, PULLS, CRUSHES)

#: Columns of what a contact that is not dry has in a step: k_n [Pa/m], what is added to its trial
#: reaction, the tension that counts it from, room for shear without pressure [Pa], mu, and where it
#: is crushed, from the tension on [Pa].  See `law.yielding`, `law.strengths`.
H_KN, H_SHIFT, H_PULL, H_ROOM, H_MU, H_CRUSH = 0, 1, 2, 3, 4, 5
N_HELD = 6

#: Columns of the response of a contact: reactions, and their derivatives by the trial reactions,
#: the first by the normal one.
RN, RT, NN, NT, TN, TT = 0, 1, 2, 3, 4, 5
N_RESPONSE = 6

#: Columns of a contact's variables within the law's products, see `centre`, after RN and RT; and of
#: their changes, which have those of the trial reactions as well.  The room that the shear has to
#: either side is kept apart: its end is lost in rounding.
W, P, Q, NEAR, FAR, V, CAP, D_TRIAL_N, D_TRIAL_T = 2, 3, 4, 5, 6, 7, 8, 9, 10
N_INNER, N_CHANGE = 9, 11


@njit(cache=True, error_model="numpy")
def slide(rn, rt, stiffness, friction, lift):
    """How far a joint has slid under trial reactions beyond the cone, shear taken positive [m]."""
    return (rt - friction * rn) / (stiffness + friction * lift)


@njit(cache=True, error_model="numpy")
def branch_of(table, c, hint):
    """Branch of the law for the trial reactions of a row of the table; see `branch_for`."""
    if hint == BONDED:
        return BONDED
    rt = table[c, TRIAL_T]
    return branch_for(
        table[c, TRIAL_N], abs(rt), table[c, STIFF_T], table[c, FRICTION], table[c, LIFT],
        table[c, ROOM], crushing(table, c), hint, FORWARD if rt > 0.0 else BACKWARD,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def reactions(table, c, branch):
    """Normal and tangential reaction [N] in a branch of the law, and the sliding in it [m]."""
    sign = -1.0 if along_joint(branch) == BACKWARD else 1.0
    rn, rt, gamma = reactions_in(
        branch, table[c, TRIAL_N], sign * table[c, TRIAL_T], table[c, STIFF_T], table[c, FRICTION],
        table[c, LIFT], table[c, ROOM], crushing(table, c),
    )  # fmt: skip
    return rn - table[c, PULL], sign * rt, gamma


@njit(cache=True, error_model="numpy")
def respond(which, table, count, branch, response):
    """Fill reactions and their derivatives by the trial reactions, (n_slots, N_RESPONSE)."""
    for c in range(count):
        now = branch[which[c, SLOT]]
        sign = -1.0 if along_joint(now) == BACKWARD else 1.0
        response[c, RN], response[c, RT], _ = reactions(table, c, now)
        nn, nt, tn, tt = derivatives_in(now, table[c, STIFF_T], table[c, FRICTION], table[c, LIFT])
        response[c, NN], response[c, NT] = nn, sign * nt
        response[c, TN], response[c, TT] = sign * tn, tt


@njit(cache=True, error_model="numpy")
def distance(table, c, now, rate_n, rate_t, whole):
    """How far along the direction a contact leaves its branch, and for which one."""
    if now > BONDED or (table[c, ROOM] > 0.0 and now != BONDED):
        return distance_beyond(table, c, now, rate_n, rate_t, whole)
    nearest, following = distance_of_dry(table, c, now, rate_n, rate_t, whole)
    crush = crushing(table, c)
    if crush < np.inf and OPEN < now < BONDED and rate_n > 0.0:
        far = max(crush - table[c, TRIAL_N], 0.0) / rate_n
        if far < nearest:
            return far, now + CRUSHED
    return nearest, following


@njit(cache=True, error_model="numpy")
def all_dry(table, count):
    """Whether no contact softens or may be crushed."""
    beyond = 0
    for c in range(count):
        beyond += table[c, ROOM] > 0.0 or table[c, CRUSH] > 0.0
    return beyond == 0


@njit(cache=True, error_model="numpy")
def distance_of_dry(table, c, now, rate_n, rate_t, whole):
    rn, rt = table[c, TRIAL_N], table[c, TRIAL_T]
    kt, mu, lift = table[c, STIFF_T], table[c, FRICTION], table[c, LIFT]
    nearest = np.inf
    following = now
    if now == BONDED:
        return nearest, following
    if now == FORWARD or now == BACKWARD:
        sign = 1.0 if now == FORWARD else -1.0
        speed = mu * rate_n - sign * rate_t
        if speed > 0.0 and whole:
            nearest = max(sign * rt - mu * rn, 0.0) / speed
            following = STICKING
        speed = -(kt * rate_n + lift * sign * rate_t)
        if speed > 0.0:
            far = max(kt * rn + lift * sign * rt, 0.0) / speed
            if far < nearest:
                nearest = far
                following = OPEN
        return nearest, following
    for sliding in range(FORWARD, BACKWARD + 1):
        sign = 1.0 if sliding == FORWARD else -1.0
        if now == OPEN:
            speed = kt * rate_n + lift * sign * rate_t
            far = max(-kt * rn - lift * sign * rt, 0.0)
        else:
            speed = sign * rate_t - mu * rate_n
            far = max(mu * rn - sign * rt, 0.0)
        if not speed > 0.0:
            continue
        far /= speed
        if now == OPEN and sign * (rt + far * rate_t if whole else rate_t) < 0.0:
            continue
        if far < nearest:
            nearest = far
            following = sliding
    return nearest, following


@njit(cache=True, error_model="numpy")
def landing(table, c, now):
    """Branch of the law for trial reactions.

    A contact that would slide the other way has passed the band in which it sticks, narrow where
    the shear stiffness is high; it is taken to stick.
    """
    rn, rt, mu = table[c, TRIAL_N], table[c, TRIAL_T], table[c, FRICTION]
    if now == BONDED:
        return BONDED
    if yields(table, c):
        return landing_beyond(table, c, now)
    if table[c, STIFF_T] * rn + table[c, LIFT] * abs(rt) <= 0.0:
        return OPEN
    if abs(rt) <= mu * rn:
        return STICKING
    sliding = FORWARD if rt > 0.0 else BACKWARD
    return STICKING if sense(now) * rt < 0.0 else sliding


@njit(cache=True, error_model="numpy")
def change(table, rows, c, before, after, u, v, k):
    """Fill u (2 n_dof,) and v[k, 0] with the u and v by whose product the matrix changes with the
    branch of contact c."""
    if before > BONDED or after > BONDED:
        change_beyond(table, rows, c, before, after, u, v, k)
        return
    sliding = before if before >= FORWARD else after
    sign = 1.0 if sliding == FORWARD else -1.0
    kn, kt, mu, lift = table[c, STIFF_N], table[c, STIFF_T], table[c, FRICTION], table[c, LIFT]
    along = kt + mu * lift
    if before == OPEN or after == OPEN:
        turn = -1.0 if before == OPEN else 1.0
        for i in range(u.shape[0]):
            u[i] = turn * (rows[c, OF_GAP, i] + sign * mu * rows[c, OF_SLIP, i])
            slid = mu * kn * rows[c, OF_GAP, i] - sign * kt * rows[c, MEASURED, i]
            v[k, 0, i] = lift * slid / along - kn * rows[c, OF_GAP, i]
        return
    turn = 1.0 if before == STICKING else -1.0
    for i in range(u.shape[0]):
        u[i] = turn * (sign * kt * rows[c, OF_SLIP, i] - lift * rows[c, OF_GAP, i])
        slid = mu * kn * rows[c, OF_GAP, i] - sign * kt * rows[c, MEASURED, i]
        v[k, 0, i] = slid / along


@njit(cache=True, error_model="numpy")
def commit(table, c, before):
    """Make the sliding of a contact part of its history, where it sticks or opens; and forget
    the shear of one that was open."""
    if before == OPEN:
        table[c, ADD_T] -= table[c, TRIAL_T]
        table[c, TRIAL_T] = 0.0
        return
    if before > CRUSHED:
        beyond = max(table[c, TRIAL_N] - crushing(table, c), 0.0)
        table[c, TRIAL_N] -= beyond
        table[c, ADD_N] -= beyond
    sign = sense(before)
    if sign != 0.0:
        rn, rt = held_normal(table, c, before), sign * table[c, TRIAL_T] - table[c, ROOM]
        gamma = slide(rn, rt, table[c, STIFF_T], table[c, FRICTION], table[c, LIFT])
        table[c, TRIAL_N] += table[c, LIFT] * gamma
        table[c, ADD_N] += table[c, LIFT] * gamma
        table[c, ADD_T] -= sign * table[c, STIFF_T] * gamma
        table[c, TRIAL_T] -= sign * table[c, STIFF_T] * gamma
        table[c, PLASTIC] += gamma


@njit(cache=True, error_model="numpy")
def joint_law_violation(table, gap, slip, reaction, shear_before, whole):
    """Largest distances [N] of reactions from those that the joint law gives.

    The law's reaction is r_n = k_n <-g> and r_t = t_0 - k_s s, drawn back to mu r_n + bond where it
    is larger; a bond also pulls, r_n = -k_n g, up to its tensile strength; joints that soften or
    are crushed see `law.yielding`.  For friction without
    shear stiffness, pass the reaction itself as ``shear_before`` and any positive stiffness: the
    distance is then zero only where the law holds (natural map).  Without a slip, what is left of
    it is the cone.

    Parameters
    ----------
    table
        Stiffnesses, friction and strengths, (n_contacts, N_TABLE).
    gap
        At the end of the step, less dilation, (n_contacts,) [m].
    slip
        Sliding in the step, (n_contacts, dim - 1) [m].
    reaction
        (n_contacts, dim) [N], normal and tangential.
    shear_before
        (n_contacts, dim - 1) [N], tangential reaction at the start of the step.
    whole
        (n_contacts,) 1 where a bond has not broken, else 0.

    Returns
    -------
    normal, tangential
        Of normal and of tangential reactions [N].
    cone
        Excess of tangential reactions over what friction and cohesion hold [N].
    """
    normal, tangential, cone = 0.0, 0.0, 0.0
    for c in range(gap.shape[0]):
        bond, tension = whole[c] * table[c, BOND], whole[c] * table[c, TENSILE]
        strength = bond + tension
        law_n = min(table[c, SHIFT] - table[c, STIFF_N] * gap[c], crushing(table, c))
        if law_n < -tension - BOND_TIE * strength or (law_n < 0.0 and strength == 0.0):
            law_n = 0.0
        law_n -= table[c, PULL]
        room = table[c, ROOM] + bond
        limit = max(table[c, FRICTION] * (reaction[c, 0] + table[c, PULL]) + room, 0.0)
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
        # Comparisons lose what is not a number.
        if not np.isfinite(law_n + away + size + reaction[c, 0]):
            return np.nan, np.nan, np.nan
    return normal, tangential, cone


@njit(cache=True, error_model="numpy")
def remember(which, table, count, history_before):
    """Sliding that has ended becomes part of what contacts bring along (n_slots, N_HISTORY)."""
    for c in range(count):
        k = which[c, SLOT]
        history_before[k, SHEAR] += table[c, ADD_T]
        history_before[k, DILATION] += table[c, ADD_N] / table[c, STIFF_N]
        history_before[k, SLID] += table[c, PLASTIC]
        table[c, ADD_N] = 0.0
        table[c, ADD_T] = 0.0
        table[c, PLASTIC] = 0.0


@njit(cache=True, error_model="numpy")
def inherit(source, history, reaction, branch, new_history, new_reaction, new_branch):
    """Fill what slots have from those that they go on in, ``source``; -1 marks contacts that are
    new: open, without shear, and never bonded."""
    for k in range(source.shape[0]):
        j = source[k]
        for i in range(history.shape[1]):
            new_history[k, i] = history[j, i] if j >= 0 else 0.0
        if j < 0:
            new_history[k, BROKEN] = 1.0
        for i in range(reaction.shape[1]):
            new_reaction[k, i] = reaction[j, i] if j >= 0 else 0.0
        new_branch[k] = branch[j] if j >= 0 else OPEN


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
            v[RN] = central_normal(tn, row[CRUSH], product)
            v[CAP], v[W] = row[CRUSH] - v[RN], product / v[RN]
            v[V] = max(tn - v[RN] + v[W], product / row[CRUSH])
            if tn > 0.5 * row[CRUSH]:
                v[CAP] = product / v[V]
            else:
                v[V] = product / v[CAP]
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
        if v[NEAR] < v[P]:
            branch[k] = FORWARD
        elif v[FAR] < v[Q]:
            branch[k] = BACKWARD
        else:
            branch[k] = STICKING
        if v[W] > v[RN]:
            branch[k] += TORN
        elif crushing(table, c) < np.inf and v[CAP] < v[V]:
            branch[k] += CRUSHED


@njit(cache=True, error_model="numpy")
def local_impulse(bn, bt, cnn, wnt, wtt, mu):
    """Impulses of one contact for itself [N s]: see `dynamics.sweeps` for its equations.

    ``bn`` and ``bt`` are what its velocity would be without them, the first with the gap [m/s];
    ``cnn``, ``wnt`` and ``wtt`` what they change of it [1/kg].
    """
    det = cnn * wtt - wnt * wnt
    stick_n = (wnt * bt - wtt * bn) / det
    stick_t = (wnt * bn - cnn * bt) / det
    if stick_n > 0.0 and abs(stick_t) <= mu * stick_n:
        return stick_n, stick_t
    pn, pt = 0.0, 0.0
    slope = mu if stick_t > 0.0 else -mu
    along = cnn + slope * wnt
    if bn < 0.0 and along > 0.0:
        pn = -bn / along
        pt = slope * pn
        if (wnt * pn + wtt * pt + bt) * slope > 0.0:  # slides with its friction
            slope = -slope
            along = cnn + slope * wnt
            if along > 0.0:
                pn = -bn / along
                pt = slope * pn
    return pn, pt


@njit(cache=True, error_model="numpy")
def _sliding(angle, a1, a2, m11, m12, m21, m22):
    """Of the sliding velocity a + M t for friction along t, at an angle: its part across t, how
    that goes with the angle, and its part along t."""
    c, s = np.cos(angle), np.sin(angle)
    v1, v2 = a1 + m11 * c + m12 * s, a2 + m21 * c + m22 * s
    along = c * v1 + s * v2
    return c * v2 - s * v1, c * (m22 * c - m21 * s) - s * (m12 * c - m11 * s) - along, along


@njit(cache=True, error_model="numpy")
def _sliding_angle(start, a1, a2, m11, m12, m21, m22):
    """Angle of the friction that opposes sliding, and whether there is one: see `_sliding`.

    Newton's method from an angle; where that fails, bisection wherever what is across changes sign.
    """
    angle = start
    for _ in range(20):
        across, slope, along = _sliding(angle, a1, a2, m11, m12, m21, m22)
        step = across / slope if slope != 0.0 else 1.0
        if abs(step) < ANGLE and along <= 0.0:
            return angle - step, True
        angle -= min(max(step, -0.5), 0.5)
    high, after, _ = start, _sliding(start, a1, a2, m11, m12, m21, m22)[0], 0.0
    for k in range(1, N_ANGLES + 1):
        low, before = high, after
        high = start + 2.0 * np.pi * k / N_ANGLES
        after = _sliding(high, a1, a2, m11, m12, m21, m22)[0]
        if (before < 0.0) == (after < 0.0):
            continue
        x, y = low, high
        for _ in range(60):
            angle = 0.5 * (x + y)
            across, slope, along = _sliding(angle, a1, a2, m11, m12, m21, m22)
            if (across < 0.0) == (before < 0.0):
                x = angle
            else:
                y = angle
        if along <= 0.0:
            return angle, True
    return start, False


@njit(cache=True, error_model="numpy")
def local_impulse_in_space(bn, b1, b2, w, cnn, mu, p):
    """Fill ``p`` (3,) with the impulses of one contact for itself [N s]; see `local_impulse`.

    What slides does so against friction along (cos a, sin a), where the velocity across that is a
    trigonometric polynomial of second degree in the angle.

    Parameters
    ----------
    bn, b1, b2
        Velocity without the impulses, the first with the gap [m/s].
    w
        Delassus block (3, 3) [1/kg]; of its first entry ``cnn``, with the joint's compliance, takes
        the place.
    """
    w01, w02, w11, w12, w22 = w[0, 1], w[0, 2], w[1, 1], w[1, 2], w[2, 2]
    # Tangential impulses that hold the contact: -h - g p_n.
    det = w11 * w22 - w12 * w12
    g1, g2 = (w22 * w01 - w12 * w02) / det, (w11 * w02 - w12 * w01) / det
    h1, h2 = (w22 * b1 - w12 * b2) / det, (w11 * b2 - w12 * b1) / det
    pn = (w01 * h1 + w02 * h2 - bn) / (cnn - w01 * g1 - w02 * g2)
    p1, p2 = -h1 - g1 * pn, -h2 - g2 * pn
    p[0], p[1], p[2] = pn, p1, p2
    if pn > 0.0 and p1 * p1 + p2 * p2 <= mu * mu * pn * pn:
        return
    p[0], p[1], p[2] = 0.0, 0.0, 0.0
    if bn >= 0.0:
        return
    start = np.arctan2(p2, p1) if pn > 0.0 else np.arctan2(-h2, -h1)
    # Times p_n over its force without coupling, which is positive.
    a1, a2 = cnn * b1 - bn * w01, cnn * b2 - bn * w02
    m11, m12 = mu * (b1 * w01 - bn * w11), mu * (b1 * w02 - bn * w12)
    m21, m22 = mu * (b2 * w01 - bn * w12), mu * (b2 * w02 - bn * w22)
    angle, found = _sliding_angle(start, a1, a2, m11, m12, m21, m22)
    c, s = np.cos(angle), np.sin(angle)
    along = cnn + mu * (c * w01 + s * w02)
    if found and along > 0.0:
        p[0] = -bn / along
        p[1], p[2] = mu * p[0] * c, mu * p[0] * s


@njit(cache=True, error_model="numpy")
def held_impulse(pn, pt, mu, held):
    """Impulses of trial ones [N s], and their branch; one that is ``held`` sticks anyway."""
    if pn <= 0.0:
        return 0.0, 0.0, OPEN
    limit = mu * pn
    if abs(pt) > limit * (1.0 - AT_CONE) and pt != 0.0 and not held:
        return pn, limit if pt > 0.0 else -limit, FORWARD if pt > 0.0 else BACKWARD
    return pn, pt, STICKING


@njit(cache=True, error_model="numpy")
def impulse_in(branch, pn, pt, mu):
    """Impulses [N s] in a branch, for trial ones."""
    if branch == OPEN:
        return 0.0, 0.0
    if branch != STICKING:
        return pn, mu * pn if branch == FORWARD else -mu * pn
    return pn, pt


@njit(cache=True, error_model="numpy")
def branch_of_impulse(pn, pt, mu):
    """The branch that impulses lie on."""
    limit = mu * pn
    if pn <= 0.0:
        return OPEN
    if abs(pt) < limit * (1.0 - AT_CONE) or limit == 0.0:
        return STICKING
    return FORWARD if pt > 0.0 else BACKWARD


@njit(cache=True, error_model="numpy")
def held_impulse_in_space(pn, p1, p2, mu, held):
    """`held_impulse` with two tangential ones; what slides has the branch SLIDING."""
    if pn <= 0.0:
        return 0.0, 0.0, 0.0, OPEN
    limit, size = mu * pn, np.sqrt(p1 * p1 + p2 * p2)
    if size > limit * (1.0 - AT_CONE) and size > 0.0 and not held:
        share = limit / size
        return pn, share * p1, share * p2, SLIDING
    return pn, p1, p2, STICKING


@njit(cache=True, error_model="numpy")
def status_of(pairs, laws, reaction, status):
    """Fill what slots are called in results (n_slots,) by their reactions (n_slots, dim) [N]."""
    pair, of_pair = pairs.of_slot, pairs.which
    for k in range(reaction.shape[0]):
        normal, square = reaction[k, 0], 0.0
        for d in range(1, reaction.shape[1]):
            square += reaction[k, d] * reaction[k, d]
        limit = laws[of_pair[pair[k], LAW], MU] * normal * (1.0 - AT_CONE)
        if normal <= 0.0:
            status[k] = OPEN
        else:
            status[k] = SLIDING if np.sqrt(square) >= limit else STICKING
