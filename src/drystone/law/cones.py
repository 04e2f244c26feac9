"""The joint law of contacts, smoothed by a barrier, for interior-point methods.

Static steps (`statics.interior`) and implicit steps in time (`dynamics.space.interior`) use it.

With the trial reactions T of a contact, its stiffnesses k_n, k_s and a barrier e [J],

    r_n = T_n + w + c zeta,    r_n w = k_n e,
    r_t = T_t - z,             (mu r_n, r_t) o (zeta, -z) = (2 k_s e, 0),

where (a, b) o (c, d) = (a c + b.d, a d + c b), and both pairs lie within the cone of second order.
Here w is the slack of the normal reaction, and zeta and z are k_s times the length and vector of
the slip.  Without a barrier this is the joint law of `law.return_map`, with zeta = |z|.  Slip lifts
the joint by dilatancy only, c = k_n tan psi / k_s.  A contact with an intact bond is linear, r = T.
Changes are scaled by the method of Nesterov and Todd.

For joints with tensile strength f, cohesion intercept k (the shear that they carry without
pressure) and crushing strength C (see `law.limits`), normal reactions are counted from the tension
on, r_n' = r_n + f and C' = C + f:

    r_n' = T_n' + w - v,    r_n' w = k_n e,    (C' - r_n') v = k_n e,    (mu r_n' + k, r_t) o ...

with the slack v of crushing.  For steps in time the same is written in impulses, T_n = -h k_n (g +
h u_n) and T_t = c - P u_t, for a contact with a penalty spring P centred on c.  Then h^2 k_n and P
take the place of the stiffness.
"""

from __future__ import annotations

import numpy as np

from drystone.common.compiled import njit
from drystone.common.tolerances import (
    BELOW_CRUSHING,
    CENTRAL,
    CENTRAL_NORMAL,
    KEPT,
    LAST_DIGITS,
    LEAST_DISTANCE,
    OPENING,
    STICKS_AGAIN,
    TURNING_FRICTION,
)
from drystone.contact.contacts import (
    BODY_A,
    BODY_B,
    CRUSH,
    FRICTION,
    INTACT,
    INTERCEPT,
    LIFT,
    PAIR,
    PULL,
    STIFF_N,
    STIFF_T,
)
from drystone.contact.rows import add_block

#: Columns of a contact's variables, and of their changes: reactions; slack of the normal reaction;
#: slip times k_s, its length and vector; slack of crushing; distance to the crushing strength
#: [N; N s].
PN, P1, P2, W, ZETA, Z1, Z2, V, CAP = range(9)
N_INNER = 9

#: Columns of a contact's scaling: factor and direction of the scaling of its cones; the response
#: A = [[nn, n1, n2], [t1, s11, s12], [t2, s12, s22]]; the residual, before multiplication by A; the
#: residual of the cones' product, scaled back.
ETA, V0, V1, V2, NN, N1, N2, T1, T2, S11, S12, S22, B0, B1, B2, R0, R1, R2 = range(18)
N_SCALING = 18

#: Cosine of the largest angle by which a slip may change its direction in an iteration.
SLIP_COSINE = 0.5


@njit(cache=True, error_model="numpy")
def central_normal(trial, crush, product):
    """The normal reaction r in (0, C) with r - product (1 / r - 1 / (C - r)) = trial."""
    low, high = 0.0, crush
    r = min(max(trial, 0.25 * crush), BELOW_CRUSHING * crush)
    for _ in range(80):
        missing = trial - r + product / r - product / (crush - r)
        if missing > 0.0:
            low = r
        else:
            high = r
        nearer = r + missing / (1.0 + product / r**2 + product / (crush - r) ** 2)
        if not low < nearer < high:
            nearer = 0.5 * (low + high)
        done = abs(nearer - r) <= LAST_DIGITS * r
        r = nearer
        if done:
            break
    return r


@njit(cache=True, error_model="numpy")
def central_crushing(trial, crush, product):
    """Normal variables of a contact that may be crushed, for a given product of reaction and slack:
    the reaction, its slack, the slack of crushing and the distance to the crushing strength."""
    r = central_normal(trial, crush, product)
    slack = product / r
    if trial > 0.5 * crush:  # the distance to crushing is not calculated as a small difference
        beyond = max(trial - r + slack, product / crush)
        return r, slack, beyond, product / beyond
    return r, slack, product / (crush - r), crush - r


@njit(cache=True, error_model="numpy")
def trial_impulses(problem, h, penalty, centre, relative, trial):
    """Fill the trial impulses (n_contacts, 3) [N s] for relative velocities (n_contacts, 3)
    [m/s]."""
    table, gap = problem.contacts.table, problem.gap
    for c in range(gap.shape[0]):
        trial[c, 0] = -h * table[c, STIFF_N] * (gap[c] + h * relative[c, 0])
        trial[c, 1] = centre[c, 0] - penalty * relative[c, 1]
        trial[c, 2] = centre[c, 1] - penalty * relative[c, 2]


@njit(cache=True, error_model="numpy")
def _floor(table, inner, c):
    """Product of the pairs of a contact that remains without a barrier; see `LEAST_DISTANCE`."""
    square = inner[c, Z1] * inner[c, Z1] + inner[c, Z2] * inner[c, Z2]
    most = (
        2.0 * LEAST_DISTANCE * table[c, FRICTION] * inner[c, PN]
        + 2.0 * LEAST_DISTANCE * table[c, INTERCEPT]
    )
    return most * np.sqrt(square)


@njit(cache=True, error_model="numpy")
def _is_central(table, inner, c, energy):
    """Whether the pairs of a contact lie well within their cones, for the product that they should
    have with a barrier ``energy`` [J]."""
    beta = 2.0 * table[c, STIFF_T] * energy + _floor(table, inner, c)
    most, zeta = table[c, FRICTION] * inner[c, PN] + table[c, INTERCEPT], inner[c, ZETA]
    square = inner[c, P1] * inner[c, P1] + inner[c, P2] * inner[c, P2]
    slid = inner[c, Z1] * inner[c, Z1] + inner[c, Z2] * inner[c, Z2]
    if not (square < most * most and slid < zeta * zeta and zeta > 0.0):
        return False
    return (most * most - square) * (zeta * zeta - slid) > (CENTRAL * beta) ** 2


@njit(cache=True, error_model="numpy")
def _is_central_normal(table, inner, c, product):
    """The same for the normal reaction of a contact and its slack, for the ``product`` that they
    should have.  It is true of contacts that may be crushed, as `length` keeps them within."""
    if table[c, CRUSH] > 0.0:
        return True
    pn, w = inner[c, PN], inner[c, W]
    return pn > 0.0 and w > 0.0 and pn * w >= CENTRAL_NORMAL * product


@njit(cache=True, error_model="numpy")
def _distance_of_friction(most, size, beta):
    """Distance s in (0, m] to the friction cone: (T - m + s) s (2 m - s) = beta (m - s)."""
    low, high, distance = 0.0, most, min(most, max(most - size, beta / (size + most + beta / most)))
    for _ in range(80):
        excess = size - most + distance
        value = excess * distance * (2.0 * most - distance) - beta * (most - distance)
        if value > 0.0:
            high = distance
        else:
            low = distance
        slope = distance * (2.0 * most - distance) + 2.0 * excess * (most - distance) + beta
        nearer = distance - value / slope
        if not low < nearer < high:
            nearer = 0.5 * (low + high)
        done = abs(nearer - distance) <= LAST_DIGITS * distance
        distance = nearer
        if done:
            break
    return distance


@njit(cache=True, error_model="numpy")
def _dilation(table, c, trial, size, energy):
    """The part c zeta of the normal equation of a contact that dilates, on the central path [N].

    ``trial`` and ``size`` [N] are its trial normal reaction and its trial shear.  The reaction r
    solves r - k_n e / r - c zeta(mu r) = T_n, of which the left side grows with r.  In a joint that
    slides, T_n and c zeta are much larger than their sum, so that neither may be taken without the
    other.  Joints that dilate are never crushed.
    """
    product, beta = table[c, STIFF_N] * energy, 2.0 * table[c, STIFF_T] * energy
    raised = table[c, LIFT] / table[c, STIFF_T]
    larger = 0.5 * (abs(trial) + np.sqrt(trial * trial + 4.0 * product))
    r = larger if trial > 0.0 else product / larger  # without dilatancy, which adds to it
    low, high, lifted = 0.0, np.inf, 0.0
    for _ in range(80):
        most = table[c, FRICTION] * r + table[c, INTERCEPT]
        pair = beta + 2.0 * LEAST_DISTANCE * most * size
        s = _distance_of_friction(most, size, pair)
        both, excess = s * (2.0 * most - s), size - most + s
        lifted = raised * pair * most / both
        missing = trial + lifted - r + product / r
        if missing > 0.0:
            low = r
        else:
            high = r
        # Rates by `most`: of the distance s, and of minus zeta.
        rate = (both - 2.0 * s * excess + pair) / (both + 2.0 * excess * (most - s) + pair)
        falls = raised * pair * (s * s + 2.0 * most * (most - s) * rate) / (both * both)
        nearer = r + missing / (1.0 + product / r**2 + table[c, FRICTION] * falls)
        if not low < nearer < high:
            nearer = 0.5 * (low + high) if high < np.inf else 2.0 * r
        done = abs(nearer - r) <= LAST_DIGITS * r
        r = nearer
        if done:
            break
    return lifted


@njit(cache=True, error_model="numpy")
def _centre_normal(table, inner, c, trial, energy):
    """Fill the normal variables of a contact with those on the central path; ``trial`` [N] is its
    trial normal reaction, with the part of dilatancy."""
    product = table[c, STIFF_N] * energy
    larger = 0.5 * (abs(trial) + np.sqrt(trial * trial + 4.0 * product))
    inner[c, PN] = larger if trial > 0.0 else product / larger
    inner[c, W] = product / inner[c, PN]
    inner[c, V], inner[c, CAP] = 0.0, 0.0
    if table[c, CRUSH] > 0.0:
        inner[c, PN], inner[c, W], inner[c, V], inner[c, CAP] = central_crushing(
            trial, table[c, CRUSH], product
        )


@njit(cache=True, error_model="numpy")
def _centre_friction(table, inner, c, t1, t2, energy):
    """The same for the pairs of friction, for the trial shear (t1, t2) [N] and the normal reaction
    that the contact has."""
    size = np.sqrt(t1 * t1 + t2 * t2)
    most = table[c, FRICTION] * inner[c, PN] + table[c, INTERCEPT]
    if most == 0.0:
        inner[c, P1], inner[c, P2], inner[c, ZETA] = 0.0, 0.0, 0.0
        inner[c, Z1], inner[c, Z2] = 0.0, 0.0
        return
    beta = 2.0 * table[c, STIFF_T] * energy + 2.0 * LEAST_DISTANCE * most * size
    distance = _distance_of_friction(most, size, beta)
    share = (most - distance) / size if size > 0.0 else 0.0
    zeta, p1, p2 = beta * most / (distance * (2.0 * most - distance)), share * t1, share * t2
    inner[c, P1], inner[c, P2], inner[c, ZETA] = p1, p2, zeta
    inner[c, Z1], inner[c, Z2] = zeta * p1 / most, zeta * p2 / most


@njit(cache=True, error_model="numpy", nogil=True)
def centre_contacts(table, energy, everything, trial, inner):
    """Centre contacts: fill their variables ``inner`` with those on the central path, for their
    trial reactions and a barrier ``energy`` [J].

    Without ``everything``, only variables that are too near to the boundary of their cones, or
    outside, are changed.
    """
    for c in range(table.shape[0]):
        tn, t1, t2 = trial[c, 0], trial[c, 1], trial[c, 2]
        if table[c, INTACT] != 0.0:
            if everything:
                inner[c, PN], inner[c, P1], inner[c, P2], inner[c, W] = tn, t1, t2, 0.0
                inner[c, ZETA], inner[c, Z1], inner[c, Z2] = 0.0, 0.0, 0.0
                inner[c, V], inner[c, CAP] = 0.0, 0.0
            continue
        friction = everything
        normal = everything or not _is_central_normal(table, inner, c, table[c, STIFF_N] * energy)
        if table[c, LIFT] > 0.0 and table[c, FRICTION] + table[c, INTERCEPT] > 0.0:
            # The normal reaction and the slip depend on each other.  Both are centred, or neither.
            normal = normal or not _is_central(table, inner, c, energy)
            friction = normal
            if normal:
                tn += _dilation(table, c, tn, np.sqrt(t1 * t1 + t2 * t2), energy)
        if normal:
            _centre_normal(table, inner, c, tn, energy)
        if friction or not _is_central(table, inner, c, energy):
            _centre_friction(table, inner, c, t1, t2, energy)


@njit(cache=True, error_model="numpy")
def scale(table, inner, scaling):
    """Fill the columns of ``scaling`` that do not depend on the barrier aimed at; returns the mean
    energy [J]."""
    energy, n = 0.0, 0
    for c in range(table.shape[0]):
        mu, ks = table[c, FRICTION], table[c, STIFF_T]
        n1, n2, t1, t2, s11, s12, s22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if table[c, INTACT] != 0.0:
            nn, s11, s22 = 1.0, 1.0, 1.0
        else:
            pn, p1, p2, w = inner[c, PN], inner[c, P1], inner[c, P2], inner[c, W]
            energy += pn * w / table[c, STIFF_N]
            n += 1
            nn = pn / (pn + w)
            if table[c, CRUSH] > 0.0:
                energy += inner[c, V] * inner[c, CAP] / table[c, STIFF_N]
                n += 1
                nn = 1.0 / (1.0 + w / pn + inner[c, V] / inner[c, CAP])
        if table[c, INTACT] == 0.0 and mu + table[c, INTERCEPT] != 0.0:
            zeta, z1, z2 = inner[c, ZETA], inner[c, Z1], inner[c, Z2]
            most = mu * pn + table[c, INTERCEPT]
            dot = most * zeta - p1 * z1 - p2 * z2
            energy += max(dot - _floor(table, inner, c), 0.0) / (2.0 * ks)
            n += 1
            det_p, det_d = most * most - (p1 * p1 + p2 * p2), zeta * zeta - (z1 * z1 + z2 * z2)
            rp, rd = 1.0 / np.sqrt(det_p), 1.0 / np.sqrt(det_d)
            half = 0.5 / np.sqrt(0.5 * (1.0 + rp * rd * dot))
            v1, v2 = half * (rp * p1 + rd * z1), half * (rp * p2 + rd * z2)
            v0 = np.sqrt(1.0 + v1 * v1 + v2 * v2)
            scaling[c, V0], scaling[c, V1], scaling[c, V2] = v0, v1, v2
            g = det_d * rd * rp  # sqrt(det_d / det_p), one over the square of the factor
            scaling[c, ETA] = 1.0 / np.sqrt(g)
            # (I + G_tt)^-1, separately along and across the direction, to avoid cancellation.
            square = v1 * v1 + v2 * v2
            across, along = 1.0 / (1.0 + g), 1.0 / (1.0 + g + 2.0 * g * square)
            size = np.sqrt(square)
            e1, e2 = (v1 / size, v2 / size) if size > 0.0 else (1.0, 0.0)
            s11, s22 = along * e1 * e1 + across * e2 * e2, along * e2 * e2 + across * e1 * e1
            s12 = (along - across) * e1 * e2
            g1, g2 = -2.0 * g * v0 * v1, -2.0 * g * v0 * v2
            first, second = along * g1, along * g2
            raised = table[c, LIFT] / table[c, STIFF_T]
            if raised > 0.0:
                g0 = g * (2.0 * v0 * v0 - 1.0)
                nn = 1.0 / (1.0 + w / pn + raised * mu * (g0 - g1 * first - g2 * second))
                n1, n2 = -nn * raised * first, -nn * raised * second
                s11 -= mu * first * n1
                s12 -= mu * first * n2
                s22 -= mu * second * n2
            t1, t2 = -mu * nn * first, -mu * nn * second
        scaling[c, NN], scaling[c, N1], scaling[c, N2] = nn, n1, n2
        scaling[c, T1], scaling[c, T2] = t1, t2
        scaling[c, S11], scaling[c, S12], scaling[c, S22] = s11, s12, s22
    return energy / max(n, 1)


@njit(cache=True, error_model="numpy")
def _scaled(eta, v0, v1, v2, x0, x1, x2):
    """W x for the scaling W with factor ``eta`` and direction v; W^-1 x follows with 1 / eta, v0,
    -v1, -v2."""
    dot = v1 * x1 + v2 * x2
    more = x0 + dot / (1.0 + v0)
    return eta * (v0 * x0 + dot), eta * (x1 + more * v1), eta * (x2 + more * v2)


@njit(cache=True, error_model="numpy", nogil=True)
def aim(table, energy, second, trial, inner, change, scaling, reaction):
    """Fill the residuals in ``scaling`` for a barrier ``energy`` [J] to aim at.

    With ``second``, the products of the changes of the predictor are subtracted.  ``reaction``
    (n_contacts, 3) is filled with the reactions that result if the blocks do not move.
    """
    for c in range(table.shape[0]):
        mu = table[c, FRICTION]
        pn, p1, p2, w = inner[c, PN], inner[c, P1], inner[c, P2], inner[c, W]
        if table[c, INTACT] != 0.0:
            b0, b1, b2 = trial[c, 0] - pn, trial[c, 1] - p1, trial[c, 2] - p2
        else:
            lack = table[c, STIFF_N] * energy - pn * w
            if second:
                lack -= change[c, PN] * change[c, W]
            b0, b1, b2 = trial[c, 0] + w - pn + lack / pn, 0.0, 0.0
            if table[c, CRUSH] > 0.0:
                lack = table[c, STIFF_N] * energy - inner[c, V] * inner[c, CAP]
                if second:
                    lack -= change[c, V] * change[c, CAP]
                b0 -= inner[c, V] + lack / inner[c, CAP]
        if table[c, INTACT] == 0.0 and mu + table[c, INTERCEPT] != 0.0:
            zeta, z1, z2 = inner[c, ZETA], inner[c, Z1], inner[c, Z2]
            eta, v0, v1, v2 = scaling[c, ETA], scaling[c, V0], scaling[c, V1], scaling[c, V2]
            back = 1.0 / eta
            l0, l1, l2 = _scaled(eta, v0, v1, v2, zeta, -z1, -z2)
            floor = _floor(table, inner, c)
            x0 = 2.0 * table[c, STIFF_T] * energy + floor - (l0 * l0 + l1 * l1 + l2 * l2)
            x1, x2 = -2.0 * l0 * l1, -2.0 * l0 * l2
            if second:
                q0, q1, q2 = _scaled(
                    back, v0, -v1, -v2, mu * change[c, PN], change[c, P1], change[c, P2]
                )
                d0, d1, d2 = _scaled(
                    eta, v0, v1, v2, change[c, ZETA], -change[c, Z1], -change[c, Z2]
                )
                x0 -= q0 * d0 + q1 * d1 + q2 * d2
                x1 -= q0 * d1 + d0 * q1
                x2 -= q0 * d2 + d0 * q2
            y0 = (l0 * x0 - l1 * x1 - l2 * x2) / (l0 * l0 - l1 * l1 - l2 * l2)
            y1, y2 = (x1 - y0 * l1) / l0, (x2 - y0 * l2) / l0
            r0, r1, r2 = _scaled(back, v0, -v1, -v2, y0, y1, y2)
            scaling[c, R0], scaling[c, R1], scaling[c, R2] = r0, r1, r2
            b1, b2 = trial[c, 1] - z1 - p1 + r1, trial[c, 2] - z2 - p2 + r2
            b0 += (table[c, LIFT] / table[c, STIFF_T]) * (zeta + r0)
        scaling[c, B0], scaling[c, B1], scaling[c, B2] = b0, b1, b2
        s12 = scaling[c, S12]
        reaction[c, 0] = pn + scaling[c, NN] * b0 + scaling[c, N1] * b1 + scaling[c, N2] * b2
        reaction[c, 0] -= table[c, PULL]
        reaction[c, 1] = p1 + scaling[c, T1] * b0 + scaling[c, S11] * b1 + s12 * b2
        reaction[c, 2] = p2 + scaling[c, T2] * b0 + s12 * b1 + scaling[c, S22] * b2


@njit(cache=True, error_model="numpy")
def tangent(dof, problem, table, scaling, diagonal, upper, lower):
    """Add H^T A diag(k_n, k_s, k_s) H of contacts without dilatancy to a block matrix [kg]; ``dof``
    is `rows.IN_SPACE`."""
    nd = len(dof)
    which, rows, _ = problem.contacts
    block = np.zeros((2 * nd, 2 * nd))
    for c in range(which.shape[0]):
        kn, penalty = table[c, STIFF_N], table[c, STIFF_T]
        a, b, pair = which[c, BODY_A], which[c, BODY_B], which[c, PAIR]
        a00, a10, a20 = kn * scaling[c, NN], kn * scaling[c, T1], kn * scaling[c, T2]
        a11, a12 = penalty * scaling[c, S11], penalty * scaling[c, S12]
        a22 = penalty * scaling[c, S22]
        for i in range(2 * nd):
            x, y, z = rows[c, 0, i], rows[c, 1, i], rows[c, 2, i]
            b0 = a00 * x + a10 * y + a20 * z
            b1, b2 = a11 * y + a12 * z, a12 * y + a22 * z
            for j in range(2 * nd):
                block[i, j] = b0 * rows[c, 0, j] + b1 * rows[c, 1, j] + b2 * rows[c, 2, j]
        add_block(dof, block, a, b, pair, diagonal, upper, lower)


@njit(cache=True, error_model="numpy", nogil=True)
def responses(scaling, response):
    """Fill ``response`` (n_contacts, 3, 3): derivatives of the reactions by the trial reactions."""
    for c in range(scaling.shape[0]):
        response[c, 0, 0] = scaling[c, NN]
        response[c, 0, 1], response[c, 0, 2] = scaling[c, N1], scaling[c, N2]
        response[c, 1, 0], response[c, 2, 0] = scaling[c, T1], scaling[c, T2]
        response[c, 1, 1], response[c, 2, 2] = scaling[c, S11], scaling[c, S22]
        response[c, 1, 2] = response[c, 2, 1] = scaling[c, S12]


@njit(cache=True, error_model="numpy", nogil=True)
def changes(table, energy, second, relative, inner, scaling, change):
    """Fill ``change`` with the changes of all variables, for changes ``relative`` (n_contacts, 3)
    of gaps and slips, or of relative velocities; see `aim` for ``energy`` and ``second``."""
    for c in range(inner.shape[0]):
        mu, kn, ks = table[c, FRICTION], table[c, STIFF_N], table[c, STIFF_T]
        x0 = scaling[c, B0] - kn * relative[c, 0]
        x1, x2 = scaling[c, B1] - ks * relative[c, 1], scaling[c, B2] - ks * relative[c, 2]
        s12 = scaling[c, S12]
        dn = scaling[c, NN] * x0 + scaling[c, N1] * x1 + scaling[c, N2] * x2
        d1 = scaling[c, T1] * x0 + scaling[c, S11] * x1 + s12 * x2
        d2 = scaling[c, T2] * x0 + s12 * x1 + scaling[c, S22] * x2
        dw, d_zeta, dz1, dz2, dv = 0.0, 0.0, 0.0, 0.0, 0.0
        if table[c, INTACT] == 0.0:
            pn, w = inner[c, PN], inner[c, W]
            lack = kn * energy - pn * w
            if second:
                lack -= change[c, PN] * change[c, W]
            dw = (lack - w * dn) / pn
            if table[c, CRUSH] > 0.0:
                lack = kn * energy - inner[c, V] * inner[c, CAP]
                if second:
                    lack -= change[c, V] * change[c, CAP]
                dv = (lack + inner[c, V] * dn) / inner[c, CAP]
            if mu + table[c, INTERCEPT] == 0.0:
                d1, d2 = 0.0, 0.0
            else:
                # W^-2 = (2 v v^T - diag(1, -1, -1)) / eta^2, with the direction reversed.
                v0, v1, v2 = scaling[c, V0], scaling[c, V1], scaling[c, V2]
                g = 1.0 / (scaling[c, ETA] * scaling[c, ETA])
                along = 2.0 * (v0 * mu * dn - v1 * d1 - v2 * d2)
                d_zeta = scaling[c, R0] - g * (v0 * along - mu * dn)
                dz1 = g * (d1 - v1 * along) - scaling[c, R1]
                dz2 = g * (d2 - v2 * along) - scaling[c, R2]
        change[c, PN], change[c, P1], change[c, P2], change[c, W] = dn, d1, d2, dw
        change[c, ZETA], change[c, Z1], change[c, Z2] = d_zeta, dz1, dz2
        if table[c, CRUSH] > 0.0:
            change[c, V], change[c, CAP] = dv, -dn


@njit(cache=True, error_model="numpy")
def _distance_to_cone(p0, p1, p2, d0, d1, d2):
    """Length along d (3,) at which a point p (3,) of the cone leaves it."""
    a = d0 * d0 - d1 * d1 - d2 * d2
    b = p0 * d0 - p1 * d1 - p2 * d2
    c = p0 * p0 - (p1 * p1 + p2 * p2)
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
def _within(p0, p1, p2, d0, d1, d2, far):
    """Whether a point p of the cone is still in it after a length ``far`` along d, and so all the
    way, because the cone is convex."""
    x0, x1, x2 = p0 + far * d0, p1 + far * d1, p2 + far * d2
    return x0 > 0.0 and x0 * x0 > x1 * x1 + x2 * x2


@njit(cache=True, error_model="numpy")
def length(table, inner, change, radius):
    """Two step lengths, at most 1: for the first, the normal reactions of all contacts stay in the
    neighbourhood of the central path; for the second, their pairs also stay within the cones.

    In the neighbourhood, normal reactions and slacks may be negative down to -sqrt(k_n e), where e
    is the barrier ``radius`` [J].  `centre_contacts` then projects them back.
    """
    far, pairs = 1.0, 1.0
    for c in range(inner.shape[0]):
        if table[c, INTACT] != 0.0:
            continue
        mu, pn, dn = table[c, FRICTION], inner[c, PN], change[c, PN]
        w, dw = inner[c, W], change[c, W]
        if table[c, CRUSH] > 0.0:
            far = _up_to(inner[c, V], change[c, V], 0.0, far)
            far = _up_to(inner[c, CAP], change[c, CAP], 0.0, far)
            beyond = 0.0
        else:
            beyond = np.sqrt(table[c, STIFF_N] * radius)
        far = _up_to(pn, dn, beyond, far)
        far = _up_to(w, dw, beyond, far)
        if mu + table[c, INTERCEPT] > 0.0 and pn + far * dn > 0.0:
            p1, p2, d1, d2 = inner[c, P1], inner[c, P2], change[c, P1], change[c, P2]
            most = mu * pn + table[c, INTERCEPT]
            if not _within(most, p1, p2, mu * dn, d1, d2, pairs):
                pairs = min(pairs, _distance_to_cone(most, p1, p2, mu * dn, d1, d2))
            p0, d0 = inner[c, ZETA], change[c, ZETA]
            p1, p2, d1, d2 = inner[c, Z1], inner[c, Z2], change[c, Z1], change[c, Z2]
            if not _within(p0, p1, p2, d0, d1, d2, pairs):
                pairs = min(pairs, _distance_to_cone(p0, p1, p2, d0, d1, d2))
    return far, min(far, pairs)


@njit(cache=True, error_model="numpy")
def _up_to(value, change, beyond, far):
    """The length ``far``, or the smaller length at which a ``value`` has fallen to its share `KEPT`
    less ``beyond``."""
    least = KEPT * value - beyond
    return (least - value) / change if value + far * change < least else far


@njit(cache=True, error_model="numpy")
def slip_rotates_too_far(table, far, inner, change, radius):
    """Whether a contact leaves its cone after a length ``far``, while its slip changes its
    direction by more than `SLIP_COSINE` allows.  Such a contact cannot be projected back.

    Forces below sqrt(k_s e), where e is the barrier ``radius`` [J], may have any direction.
    """
    for c in range(inner.shape[0]):
        if table[c, INTACT] != 0.0:
            continue
        w1, w2, u1, u2 = inner[c, P1], inner[c, P2], inner[c, Z1], inner[c, Z2]
        most = table[c, FRICTION] * (inner[c, PN] + far * change[c, PN]) + table[c, INTERCEPT]
        p1, p2 = w1 + far * change[c, P1], w2 + far * change[c, P2]
        z1, z2 = u1 + far * change[c, Z1], u2 + far * change[c, Z2]
        zeta = inner[c, ZETA] + far * change[c, ZETA]
        size, slid = p1 * p1 + p2 * p2, z1 * z1 + z2 * z2
        if size < most * most and slid < zeta * zeta and most > 0.0 and zeta > 0.0:
            continue
        if most <= 0.0 or most < OPENING * (inner[c, W] + far * change[c, W]):
            continue
        size, slid = np.sqrt(size), np.sqrt(slid)
        was, slid_was = np.sqrt(w1 * w1 + w2 * w2), np.sqrt(u1 * u1 + u2 * u2)
        fuzzy = np.sqrt(table[c, STIFF_T] * radius)
        if max(most, size, slid, abs(zeta)) < fuzzy:
            continue
        # A contact that has slid little may stick again at once.
        little = max(most, fuzzy)
        if size > 2.0 * most + fuzzy or (slid_was > little and slid < STICKS_AGAIN * slid_was):
            return True
        if (
            size > max(TURNING_FRICTION * most, fuzzy)
            and p1 * w1 + p2 * w2 < SLIP_COSINE * size * was
        ):
            return True
        if slid > little and z1 * u1 + z2 * u2 < SLIP_COSINE * slid * slid_was:
            return True
    return False


@njit(cache=True, error_model="numpy")
def energy_at(table, far, inner, change):
    """Mean energy [J] of the contacts after a length ``far`` along their changes."""
    energy, n = 0.0, 0
    for c in range(inner.shape[0]):
        if table[c, INTACT] != 0.0:
            continue
        mu, pn = table[c, FRICTION], inner[c, PN] + far * change[c, PN]
        energy += pn * (inner[c, W] + far * change[c, W]) / table[c, STIFF_N]
        n += 1
        if table[c, CRUSH] > 0.0:
            v, cap = inner[c, V] + far * change[c, V], inner[c, CAP] + far * change[c, CAP]
            energy += v * cap / table[c, STIFF_N]
            n += 1
        if mu + table[c, INTERCEPT] > 0.0:
            most = mu * pn + table[c, INTERCEPT]
            dot = most * (inner[c, ZETA] + far * change[c, ZETA])
            dot -= (inner[c, P1] + far * change[c, P1]) * (inner[c, Z1] + far * change[c, Z1])
            dot -= (inner[c, P2] + far * change[c, P2]) * (inner[c, Z2] + far * change[c, Z2])
            energy += max(dot - _floor(table, inner, c), 0.0) / (2.0 * table[c, STIFF_T])
            n += 1
    return energy / max(n, 1)
