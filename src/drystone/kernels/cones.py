"""Contacts in space from the interior of their law: of static steps (`solvers.cone_search`) and of
implicit steps in time (`solvers.cones`).

With the trial reactions T of a contact, its stiffnesses k_n, k_s and a barrier e [J],

    r_n = T_n + w + c zeta,    r_n w = k_n e,
    r_t = T_t - z,             (mu r_n, r_t) o (zeta, -z) = (2 k_s e, 0),

where (a, b) o (c, d) = (a c + b.d, a d + c b) and both pairs lie within the cone of second order.
Without a barrier this is the joint law of `kernels.law`: zeta is |z|, k_s times the length slid,
and lifts the joint by dilatancy alone, c = k_n tan psi / k_s.  A contact that its bond holds is
linear, r = T.  Changes are scaled as by Nesterov and Todd.

Of steps in time the same is written in impulses: T_n = -h k_n (g + h u_n), T_t = c - P u_t for a
contact that a spring P holds about c; h^2 k_n and P then stand for the stiffnesses.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from drystone.kernels.contacts import BODY_A, BODY_B, PAIR, STIFF_N
from drystone.kernels.rows import IN_SPACE

#: Columns of a contact's law: stiffnesses [N/m; kg], friction, what dilatancy lifts by over the
#: shear that slid, whether a bond holds.
KN, KS, MU, RAISE, HELD = range(5)
N_JOINT = 5

#: Columns of a contact's variables, and of their changes: reactions, slacks [N; N s].
PN, P1, P2, W, ZETA, Z1, Z2 = 0, 1, 2, 3, 4, 5, 6
N_INNER = 7

#: Columns of a contact's scaling: the factor of the cone's pair and its direction; the response
#: A = [[nn, n1, n2], [t1, s11, s12], [t2, s12, s22]]; what is lacking, before A; rho.
ETA, V0, V1, V2, NN, N1, N2, T1, T2, S11, S12, S22, B0, B1, B2, R0, R1, R2 = range(18)
N_SCALING = 18

#: A pair this near to the ends of its cones, over the middle between them, is put back there.
CENTRAL = 1e-2
#: Cosine of the angle by which what slides may turn in an iteration.
TURN = 0.98


@njit(cache=True, error_model="numpy")
def trial_impulses(problem, h, penalty, centre, relative, trial):
    """Trial impulses (n_contacts, 3) for relative velocities (n_contacts, 3)."""
    table, gap = problem.contacts.table, problem.gap
    for c in range(gap.shape[0]):
        trial[c, 0] = -h * table[c, STIFF_N] * (gap[c] + h * relative[c, 0])
        trial[c, 1] = centre[c, 0] - penalty * relative[c, 1]
        trial[c, 2] = centre[c, 1] - penalty * relative[c, 2]


@njit(cache=True, error_model="numpy")
def _is_central(mu, beta, v):
    """Whether a contact's pair lies well within its cones, for the product that it should have."""
    most, size, slid = mu * v[PN], np.hypot(v[P1], v[P2]), np.hypot(v[Z1], v[Z2])
    if not (size < most and slid < v[ZETA]):
        return False
    room = (most - size) * (most + size) * (v[ZETA] - slid) * (v[ZETA] + slid)
    return room > (CENTRAL * beta) ** 2


@njit(cache=True, error_model="numpy")
def centre_contacts(joint, energy, everything, trial, inner):
    """Variables of contacts for their trial reactions and a barrier ``energy`` [J]: of those that
    lie too near to the end of their cones, or of all."""
    for c in range(joint.shape[0]):
        v, tn = inner[c], trial[c, 0]
        if joint[c, HELD] != 0.0:
            if everything:
                v[PN], v[P1], v[P2] = tn, trial[c, 1], trial[c, 2]
                v[W], v[ZETA], v[Z1], v[Z2] = 0.0, 0.0, 0.0, 0.0
            continue
        if everything:
            product = joint[c, KN] * energy
            larger = 0.5 * (abs(tn) + np.sqrt(tn * tn + 4.0 * product))
            v[PN] = larger if tn > 0.0 else product / larger
            v[W] = product / v[PN]
        elif _is_central(joint[c, MU], 2.0 * joint[c, KS] * energy, v):
            continue
        most, size = joint[c, MU] * v[PN], np.hypot(trial[c, 1], trial[c, 2])
        if most == 0.0:
            v[P1], v[P2], v[ZETA], v[Z1], v[Z2] = 0.0, 0.0, 0.0, 0.0, 0.0
            continue
        beta = 2.0 * joint[c, KS] * energy
        # (T - m + s) s (2 m - s) = beta (m - s) for the room s that friction leaves, in (0, m].
        low, high, room = 0.0, most, min(most, max(most - size, beta / (size + most + beta / most)))
        for _ in range(80):
            rest = size - most + room
            value = rest * room * (2.0 * most - room) - beta * (most - room)
            if value > 0.0:
                high = room
            else:
                low = room
            slope = room * (2.0 * most - room) + 2.0 * rest * (most - room) + beta
            nearer = room - value / slope
            if not low < nearer < high:
                nearer = 0.5 * (low + high)
            done = abs(nearer - room) <= 1e-14 * room
            room = nearer
            if done:
                break
        v[ZETA] = beta * most / (room * (2.0 * most - room))
        share = (most - room) / size if size > 0.0 else 0.0
        v[P1], v[P2] = share * trial[c, 1], share * trial[c, 2]
        v[Z1], v[Z2] = v[ZETA] * v[P1] / most, v[ZETA] * v[P2] / most


@njit(cache=True, error_model="numpy")
def scale(joint, inner, scaling):
    """Fill what of the scaling does not depend on what is aimed at; the mean energy [J]."""
    energy, n = 0.0, 0
    for c in range(joint.shape[0]):
        v, s, mu = inner[c], scaling[c], joint[c, MU]
        s[N1], s[N2] = 0.0, 0.0
        if joint[c, HELD] != 0.0:
            s[NN], s[T1], s[T2], s[S11], s[S12], s[S22] = 1.0, 0.0, 0.0, 1.0, 0.0, 1.0
            continue
        energy += v[PN] * v[W] / joint[c, KN]
        n += 1
        s[NN] = v[PN] / (v[PN] + v[W])
        if mu == 0.0:
            s[T1], s[T2], s[S11], s[S12], s[S22] = 0.0, 0.0, 0.0, 0.0, 0.0
            continue
        most = mu * v[PN]
        energy += (most * v[ZETA] - v[P1] * v[Z1] - v[P2] * v[Z2]) / (2.0 * joint[c, KS])
        n += 1
        size, slid = np.hypot(v[P1], v[P2]), np.hypot(v[Z1], v[Z2])
        det_p, det_d = (most - size) * (most + size), (v[ZETA] - slid) * (v[ZETA] + slid)
        rp, rd = 1.0 / np.sqrt(det_p), 1.0 / np.sqrt(det_d)
        along = rp * rd * (most * v[ZETA] - v[P1] * v[Z1] - v[P2] * v[Z2])
        half = 0.5 / np.sqrt(0.5 * (1.0 + along))
        s[ETA] = (det_p / det_d) ** 0.25
        s[V1], s[V2] = half * (rp * v[P1] + rd * v[Z1]), half * (rp * v[P2] + rd * v[Z2])
        s[V0] = np.sqrt(1.0 + s[V1] * s[V1] + s[V2] * s[V2])
        g = 1.0 / (s[ETA] * s[ETA])
        a, k = 1.0 + g, 2.0 * g
        k /= a * (a + k * (s[V1] * s[V1] + s[V2] * s[V2]))
        s[S11], s[S12], s[S22] = (
            1.0 / a - k * s[V1] * s[V1],
            -k * s[V1] * s[V2],
            1.0 / a - k * s[V2] * s[V2],
        )
        g1, g2 = -2.0 * g * s[V0] * s[V1], -2.0 * g * s[V0] * s[V2]
        first, second = s[S11] * g1 + s[S12] * g2, s[S12] * g1 + s[S22] * g2
        if joint[c, RAISE] > 0.0:
            raised = joint[c, RAISE]
            g0 = g * (2.0 * s[V0] * s[V0] - 1.0)
            held = 1.0 + v[W] / v[PN] + raised * mu * (g0 - g1 * first - g2 * second)
            s[NN] = 1.0 / held
            s[N1], s[N2] = -s[NN] * raised * first, -s[NN] * raised * second
            s[S11] -= mu * first * s[N1]
            s[S12] -= mu * first * s[N2]
            s[S22] -= mu * second * s[N2]
        s[T1] = -mu * s[NN] * first
        s[T2] = -mu * s[NN] * second
    return energy / max(n, 1)


@njit(cache=True, error_model="numpy")
def _scaled(s, x0, x1, x2, back):
    """W x, or W^-1 x where ``back`` is -1 (else 1)."""
    v0, v1, v2 = s[V0], back * s[V1], back * s[V2]
    eta = s[ETA] if back > 0.0 else 1.0 / s[ETA]
    dot = v1 * x1 + v2 * x2
    more = x0 + dot / (1.0 + v0)
    return eta * (v0 * x0 + dot), eta * (x1 + more * v1), eta * (x2 + more * v2)


@njit(cache=True, error_model="numpy")
def aim(joint, energy, second, trial, inner, change, scaling):
    """Fill what is lacking of a barrier ``energy`` [J]; with ``second``, the products of the
    changes that the step without a barrier would make are taken off."""
    for c in range(joint.shape[0]):
        v, d, s, mu = inner[c], change[c], scaling[c], joint[c, MU]
        if joint[c, HELD] != 0.0:
            s[B0], s[B1], s[B2] = trial[c, 0] - v[PN], trial[c, 1] - v[P1], trial[c, 2] - v[P2]
            continue
        lack = joint[c, KN] * energy - v[PN] * v[W]
        if second:
            lack -= d[PN] * d[W]
        s[B0] = trial[c, 0] + v[W] - v[PN] + lack / v[PN]
        if mu == 0.0:
            s[B1], s[B2] = 0.0, 0.0
            continue
        l0, l1, l2 = _scaled(s, v[ZETA], -v[Z1], -v[Z2], 1.0)
        x0 = 2.0 * joint[c, KS] * energy - (l0 * l0 + l1 * l1 + l2 * l2)
        x1, x2 = -2.0 * l0 * l1, -2.0 * l0 * l2
        if second:
            p0, p1, p2 = _scaled(s, mu * d[PN], d[P1], d[P2], -1.0)
            d0, d1, d2 = _scaled(s, d[ZETA], -d[Z1], -d[Z2], 1.0)
            x0 -= p0 * d0 + p1 * d1 + p2 * d2
            x1 -= p0 * d1 + d0 * p1
            x2 -= p0 * d2 + d0 * p2
        y0 = (l0 * x0 - l1 * x1 - l2 * x2) / (l0 * l0 - l1 * l1 - l2 * l2)
        s[R0], s[R1], s[R2] = _scaled(s, y0, (x1 - y0 * l1) / l0, (x2 - y0 * l2) / l0, -1.0)
        s[B1] = trial[c, 1] - v[Z1] - v[P1] + s[R1]
        s[B2] = trial[c, 2] - v[Z2] - v[P2] + s[R2]
        if joint[c, RAISE] > 0.0:
            s[B0] += joint[c, RAISE] * (v[ZETA] + s[R0])


@njit(cache=True, error_model="numpy")
def tangent(problem, joint, scaling, diagonal, upper, lower):
    """Add H^T A diag(k_n, k_s, k_s) H to a block matrix [kg], of contacts without dilatancy."""
    nd = len(IN_SPACE)
    which, rows, _ = problem.contacts
    block = np.zeros((2 * nd, 2 * nd))
    for c in range(which.shape[0]):
        s = scaling[c]
        kn, penalty = joint[c, KN], joint[c, KS]
        a, b, pair = which[c, BODY_A], which[c, BODY_B], which[c, PAIR]
        a00, a10, a20 = kn * s[NN], kn * s[T1], kn * s[T2]
        a11, a12, a22 = penalty * s[S11], penalty * s[S12], penalty * s[S22]
        for i in range(2 * nd):
            x, y, z = rows[c, 0, i], rows[c, 1, i], rows[c, 2, i]
            b0 = a00 * x + a10 * y + a20 * z
            b1, b2 = a11 * y + a12 * z, a12 * y + a22 * z
            for j in range(2 * nd):
                block[i, j] = b0 * rows[c, 0, j] + b1 * rows[c, 1, j] + b2 * rows[c, 2, j]
        for i in range(nd):
            for j in range(nd):
                diagonal[a, i, j] += block[i, j]
                diagonal[b, i, j] += block[nd + i, nd + j]
                upper[pair, i, j] += block[i, nd + j]
                lower[pair, i, j] += block[nd + i, j]


@njit(cache=True, error_model="numpy")
def responses(scaling, response):
    """Derivatives (n_contacts, 3, 3) of the reactions by the trial reactions."""
    for c in range(scaling.shape[0]):
        s, a = scaling[c], response[c]
        a[0, 0], a[0, 1], a[0, 2] = s[NN], s[N1], s[N2]
        a[1, 0], a[1, 1], a[1, 2] = s[T1], s[S11], s[S12]
        a[2, 0], a[2, 1], a[2, 2] = s[T2], s[S12], s[S22]


@njit(cache=True, error_model="numpy")
def towards(inner, scaling, reaction):
    """Reactions (n_contacts, 3) that the aim asks for where the blocks do not move on."""
    for c in range(inner.shape[0]):
        v, s = inner[c], scaling[c]
        reaction[c, 0] = v[PN] + s[NN] * s[B0] + s[N1] * s[B1] + s[N2] * s[B2]
        reaction[c, 1] = v[P1] + s[T1] * s[B0] + s[S11] * s[B1] + s[S12] * s[B2]
        reaction[c, 2] = v[P2] + s[T2] * s[B0] + s[S12] * s[B1] + s[S22] * s[B2]


@njit(cache=True, error_model="numpy")
def changes(joint, energy, second, relative, inner, scaling, change):
    """Changes of all variables for those of the relative places (or velocities), (n_contacts, 3)."""
    for c in range(inner.shape[0]):
        v, s, d, mu = inner[c], scaling[c], change[c], joint[c, MU]
        x0 = s[B0] - joint[c, KN] * relative[c, 0]
        x1, x2 = s[B1] - joint[c, KS] * relative[c, 1], s[B2] - joint[c, KS] * relative[c, 2]
        lack = joint[c, KN] * energy - v[PN] * v[W]
        if second:
            lack -= d[PN] * d[W]
        d[PN] = s[NN] * x0 + s[N1] * x1 + s[N2] * x2
        d[P1] = s[T1] * x0 + s[S11] * x1 + s[S12] * x2
        d[P2] = s[T2] * x0 + s[S12] * x1 + s[S22] * x2
        if joint[c, HELD] != 0.0:
            d[W], d[ZETA], d[Z1], d[Z2] = 0.0, 0.0, 0.0, 0.0
            continue
        d[W] = (lack - v[W] * d[PN]) / v[PN]
        if mu == 0.0:
            d[P1], d[P2], d[ZETA], d[Z1], d[Z2] = 0.0, 0.0, 0.0, 0.0, 0.0
            continue
        p0, p1, p2 = _scaled(s, mu * d[PN], d[P1], d[P2], -1.0)
        p0, p1, p2 = _scaled(s, p0, p1, p2, -1.0)
        d[ZETA], d[Z1], d[Z2] = s[R0] - p0, p1 - s[R1], p2 - s[R2]


@njit(cache=True, error_model="numpy")
def _room(p0, p1, p2, d0, d1, d2):
    """How far a pair may go before it leaves the cone."""
    a = d0 * d0 - d1 * d1 - d2 * d2
    b = p0 * d0 - p1 * d1 - p2 * d2
    size = np.hypot(p1, p2)
    c = (p0 - size) * (p0 + size)
    far = np.inf
    if d0 < 0.0:
        far = -p0 / d0
    disc = b * b - a * c
    if disc < 0.0:
        return far
    q = -(b + np.sqrt(disc)) if b > 0.0 else -(b - np.sqrt(disc))
    if a != 0.0 and q / a > 0.0:
        far = min(far, q / a)
    if q != 0.0 and c / q > 0.0:
        far = min(far, c / q)
    return far


@njit(cache=True, error_model="numpy")
def length(joint, inner, change):
    """How far all contacts may go along their changes, at most 1, by their normal reactions; and by
    their pairs as well."""
    far, pairs = 1.0, 1.0
    for c in range(inner.shape[0]):
        v, d, mu = inner[c], change[c], joint[c, MU]
        if joint[c, HELD] != 0.0:
            continue
        if d[PN] < 0.0:
            far = min(far, -v[PN] / d[PN])
        if d[W] < 0.0:
            far = min(far, -v[W] / d[W])
        if mu > 0.0:
            pairs = min(pairs, _room(mu * v[PN], v[P1], v[P2], mu * d[PN], d[P1], d[P2]))
            pairs = min(pairs, _room(v[ZETA], v[Z1], v[Z2], d[ZETA], d[Z1], d[Z2]))
    return far, min(far, pairs)


@njit(cache=True, error_model="numpy")
def turns_too_far(joint, far, inner, change):
    """Whether a contact leaves its cone by so much, ``far`` along its changes, that it cannot be
    put back by turning: see `TURN`."""
    for c in range(inner.shape[0]):
        v, d, mu = inner[c], change[c], joint[c, MU]
        most = mu * (v[PN] + far * d[PN])
        p1, p2 = v[P1] + far * d[P1], v[P2] + far * d[P2]
        z1, z2, zeta = v[Z1] + far * d[Z1], v[Z2] + far * d[Z2], v[ZETA] + far * d[ZETA]
        size, slid = np.hypot(p1, p2), np.hypot(z1, z2)
        if (size < most and slid < zeta) or joint[c, HELD] != 0.0:
            continue
        was, slid_was = np.hypot(v[P1], v[P2]), np.hypot(v[Z1], v[Z2])
        if size > 2.0 * most or slid < 0.1 * slid_was:
            return True
        if size > 0.3 * most and p1 * v[P1] + p2 * v[P2] < TURN * size * was:
            return True
        if slid > most and z1 * v[Z1] + z2 * v[Z2] < TURN * slid * slid_was:
            return True
    return False


@njit(cache=True, error_model="numpy")
def energy_at(joint, far, inner, change):
    """Mean energy [J] where all contacts have gone ``far`` along their changes."""
    energy, n = 0.0, 0
    for c in range(inner.shape[0]):
        v, d, mu = inner[c], change[c], joint[c, MU]
        if joint[c, HELD] != 0.0:
            continue
        pn, w = v[PN] + far * d[PN], v[W] + far * d[W]
        energy += pn * w / joint[c, KN]
        n += 1
        if mu > 0.0:
            dot = mu * pn * (v[ZETA] + far * d[ZETA])
            dot -= (v[P1] + far * d[P1]) * (v[Z1] + far * d[Z1])
            dot -= (v[P2] + far * d[P2]) * (v[Z2] + far * d[Z2])
            energy += dot / (2.0 * joint[c, KS])
            n += 1
    return energy / max(n, 1)
