"""Contacts of a static step in space: where they are, what they carry, how stiff they are.

A contact is a point of body v on a plane of body f.  With Q = [n t1 t2] its axes (n from f to v), d
from f's centroid to the point and p from v's, all where the step starts, and with the motions (u, R)
since then, the axes are E = R_f Q, and gap and slips have grown by

    y = Q^T { (R_f^T - I) d + u_v - u_f + (R_v - I) p }

measured in f's own axes: a rigid motion of both gives nothing.  Everything is formed from
increments, for stiffness times the rounding of coordinates would be felt.  Where the point is the
centre of a rounded corner of radius r, its surface is met at -r n from it, and rolls on the plane.

The force F = E r acts on v at arm a and, reversed, on f at arm b.  As E turns with f, forces turn
as well; that gives the geometric part of the stiffness, which is not symmetric.  Matrices are found
per pair in axes of the world, and turned to the principal axes of the bodies.

Kernels take a range of pairs: parts of a structure may be gone through at the same time, and what
each body gets is summed afterwards in the order of its pairs, however many did the work.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drystone.kernels.contacts import (
    ARM_A_3,
    ARM_B_3,
    BALL_3,
    BODY_A,
    BODY_B,
    GAP,
    KIND,
    LAW,
    NONE,
    NORMAL_3,
    PAIR,
    SIZE,
    SLOT,
    TANGENT_3,
    VERTEX_B,
    A,
    B,
)
from drystone.kernels.law import (
    BONDED,
    BROKEN,
    COHESION,
    DILATANCY_END,
    DILATION,
    FORWARD,
    OPEN,
    SHEAR,
    SLID,
    STICKING,
    TAN_PSI,
    TENSION,
    TIE,
)
from drystone.kernels.law import KN as LAW_KN
from drystone.kernels.law import KS as LAW_KS
from drystone.kernels.law import MU as LAW_MU

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Columns of a contact's place where the step starts: the point from v's centroid and from f's, the
#: axes Q by columns, gap less dilation, radius, and +1 where v is b, -1 where it is a.
POINT, FROM_F, AXES, GAP_0, BALL, SIDE = 0, 3, 6, 15, 16, 17
N_PLACE = 18

#: Columns of where it is now: what gap and slips have grown by, axes E by columns, the arms from
#: both bodies to where the surfaces meet.
Y, NOW, ARM_V, ARM_F = 0, 3, 12, 15
N_NOW = 18

#: Columns of its law: stiffnesses [N/m], friction, lift [N/m], bond and tensile force [N].
KN, KS, MU, LIFT, BOND, TENSILE = range(6)
N_LAW = 6


class Places(NamedTuple):
    """Contacts in use, in the order of their pairs; the first ``count`` rows."""

    which: IntArray  # (n_slots, 4) slot, pair, bodies
    start: Array  # (n_slots, N_PLACE)
    law: Array  # (n_slots, N_LAW)
    shear: Array  # (n_slots, 2) N, at the start of the step
    held: Array  # (n_slots,) 1 where a bond holds
    first: IntArray  # (n_pairs + 1,) first contact of each pair


@njit(cache=True)
def pack(slots, pairs, laws, history, closed, places):
    """Fill ``places`` from the slots in use, as found where the step starts; their number.

    ``closed`` (n_slots,) says which joints may dilate in the step.
    """
    meets, value = slots
    pair, of_pair = pairs.of_slot, pairs.which
    which, start, law_of, first = places.which, places.start, places.law, places.first
    count, last = 0, -1
    for k in range(meets.shape[0]):
        if meets[k, KIND] == NONE:
            continue
        c, p = count, pair[k]
        count += 1
        while last < p:
            last += 1
            first[last] = c
        law = of_pair[p, LAW]
        which[c, SLOT], which[c, PAIR] = k, p
        which[c, BODY_A], which[c, BODY_B] = of_pair[p, A], of_pair[p, B]
        on_b = meets[k, KIND] == VERTEX_B
        side, of_v, of_f = (1.0, ARM_B_3, ARM_A_3) if on_b else (-1.0, ARM_A_3, ARM_B_3)
        ball = value[k, BALL_3]
        for i in range(3):
            j, m = (i + 1) % 3, (i + 2) % 3
            n, t = value[k, NORMAL_3 + i], value[k, TANGENT_3 + i]
            s = value[k, NORMAL_3 + j] * value[k, TANGENT_3 + m]
            s -= value[k, NORMAL_3 + m] * value[k, TANGENT_3 + j]
            start[c, AXES + 3 * i] = side * n
            start[c, AXES + 3 * i + 1] = side * t
            start[c, AXES + 3 * i + 2] = side * s
            start[c, POINT + i] = value[k, of_v + i] + ball * side * n
            start[c, FROM_F + i] = value[k, of_f + i] + ball * side * n
        start[c, GAP_0] = value[k, GAP] - history[k, DILATION]
        start[c, BALL], start[c, SIDE] = ball, side
        area = value[k, SIZE]
        law_of[c, KN], law_of[c, KS] = laws[law, LAW_KN] * area, laws[law, LAW_KS] * area
        law_of[c, MU] = laws[law, LAW_MU]
        dilates = closed[k] and history[k, SLID] < laws[law, DILATANCY_END]
        law_of[c, LIFT] = law_of[c, KN] * laws[law, TAN_PSI] if dilates else 0.0
        law_of[c, BOND], law_of[c, TENSILE] = laws[law, COHESION] * area, laws[law, TENSION] * area
        bonded = law_of[c, BOND] > 0.0 or law_of[c, TENSILE] > 0.0
        places.held[c] = 1.0 if bonded and history[k, BROKEN] == 0.0 else 0.0
        places.shear[c, 0], places.shear[c, 1] = history[k, SHEAR], history[k, SHEAR + 1]
    while last < of_pair.shape[0]:
        last += 1
        first[last] = count
    return count


@njit(cache=True)
def turn_on(step, length, axes_0, motion, spin, turn, axes):
    """Move bodies on by ``length`` times increments, from where they are in a step.

    Parameters
    ----------
    step
        (n, 6) increments [m, rad], rotations about the principal axes as they are now.
    length
        Of it.
    axes_0
        (n, 3, 3) principal axes where the step starts, in columns.
    motion, spin
        (n, 3) [m] and unit quaternion (n, 4) since the start of the step, axes of the world;
        changed in place.
    turn, axes
        (n, 3, 3) filled with the rotation less identity, and the principal axes.
    """
    for i in range(step.shape[0]):
        for d in range(3):
            motion[i, d] += length * step[i, d]
        vx, vy, vz = 0.0, 0.0, 0.0
        for k in range(3):
            w = length * step[i, 3 + k]
            vx += axes[i, 0, k] * w
            vy += axes[i, 1, k] * w
            vz += axes[i, 2, k] * w
        if vx != 0.0 or vy != 0.0 or vz != 0.0:
            angle = np.sqrt(vx * vx + vy * vy + vz * vz)
            half = 0.5 * angle
            share = np.sin(half) / angle if angle > 1e-8 else 0.5 - angle * angle / 48.0
            w0, x0, y0, z0 = np.cos(half), share * vx, share * vy, share * vz
            w1, x1, y1, z1 = spin[i, 0], spin[i, 1], spin[i, 2], spin[i, 3]
            w2 = w0 * w1 - x0 * x1 - y0 * y1 - z0 * z1
            x2 = w0 * x1 + w1 * x0 + y0 * z1 - z0 * y1
            y2 = w0 * y1 + w1 * y0 + z0 * x1 - x0 * z1
            z2 = w0 * z1 + w1 * z0 + x0 * y1 - y0 * x1
            norm = 1.0 / np.sqrt(w2 * w2 + x2 * x2 + y2 * y2 + z2 * z2)
            spin[i, 0], spin[i, 1] = w2 * norm, x2 * norm
            spin[i, 2], spin[i, 3] = y2 * norm, z2 * norm
        w, x, y, z = spin[i, 0], spin[i, 1], spin[i, 2], spin[i, 3]
        turn[i, 0, 0] = -2.0 * (y * y + z * z)
        turn[i, 1, 1] = -2.0 * (x * x + z * z)
        turn[i, 2, 2] = -2.0 * (x * x + y * y)
        turn[i, 0, 1] = 2.0 * (x * y - w * z)
        turn[i, 1, 0] = 2.0 * (x * y + w * z)
        turn[i, 0, 2] = 2.0 * (x * z + w * y)
        turn[i, 2, 0] = 2.0 * (x * z - w * y)
        turn[i, 1, 2] = 2.0 * (y * z - w * x)
        turn[i, 2, 1] = 2.0 * (y * z + w * x)
        for j in range(3):
            for k in range(3):
                total = axes_0[i, j, k]
                for m in range(3):
                    total += turn[i, j, m] * axes_0[i, m, k]
                axes[i, j, k] = total


@njit(cache=True)
def locate(which, start, law, shear, first, low, high, motion, turn, now, trial):
    """Where the contacts of pairs ``low`` to ``high`` are, and their trial reactions (n, 3) [N]."""
    for c in range(first[low], first[high]):
        s, e = start[c], now[c]
        on_b = s[SIDE] > 0.0
        v = which[c, BODY_B] if on_b else which[c, BODY_A]
        f = which[c, BODY_A] if on_b else which[c, BODY_B]
        ball = s[BALL]
        p0, p1, p2 = s[POINT], s[POINT + 1], s[POINT + 2]
        m0 = turn[v, 0, 0] * p0 + turn[v, 0, 1] * p1 + turn[v, 0, 2] * p2
        m1 = turn[v, 1, 0] * p0 + turn[v, 1, 1] * p1 + turn[v, 1, 2] * p2
        m2 = turn[v, 2, 0] * p0 + turn[v, 2, 1] * p1 + turn[v, 2, 2] * p2
        g0 = motion[v, 0] - motion[f, 0] + m0
        g1 = motion[v, 1] - motion[f, 1] + m1
        g2 = motion[v, 2] - motion[f, 2] + m2
        d0, d1, d2 = s[FROM_F] + g0, s[FROM_F + 1] + g1, s[FROM_F + 2] + g2
        # (R_f^T - I) d is that of the transpose.
        g0 += turn[f, 0, 0] * d0 + turn[f, 1, 0] * d1 + turn[f, 2, 0] * d2
        g1 += turn[f, 0, 1] * d0 + turn[f, 1, 1] * d1 + turn[f, 2, 1] * d2
        g2 += turn[f, 0, 2] * d0 + turn[f, 1, 2] * d1 + turn[f, 2, 2] * d2
        for k in range(3):
            q0, q1, q2 = s[AXES + k], s[AXES + 3 + k], s[AXES + 6 + k]
            e[Y + k] = q0 * g0 + q1 * g1 + q2 * g2
            e[NOW + k] = q0 + turn[f, 0, 0] * q0 + turn[f, 0, 1] * q1 + turn[f, 0, 2] * q2
            e[NOW + 3 + k] = q1 + turn[f, 1, 0] * q0 + turn[f, 1, 1] * q1 + turn[f, 1, 2] * q2
            e[NOW + 6 + k] = q2 + turn[f, 2, 0] * q0 + turn[f, 2, 1] * q1 + turn[f, 2, 2] * q2
        e[ARM_V] = p0 + m0 - ball * e[NOW]
        e[ARM_V + 1] = p1 + m1 - ball * e[NOW + 3]
        e[ARM_V + 2] = p2 + m2 - ball * e[NOW + 6]
        e[ARM_F] = d0 - ball * e[NOW]
        e[ARM_F + 1] = d1 - ball * e[NOW + 3]
        e[ARM_F + 2] = d2 - ball * e[NOW + 6]
        if ball > 0.0:
            # Rolling: the rotation of v against f, to third order, times the radius.
            w0 = 0.5 * (turn[v, 2, 1] - turn[v, 1, 2] - turn[f, 2, 1] + turn[f, 1, 2])
            w1 = 0.5 * (turn[v, 0, 2] - turn[v, 2, 0] - turn[f, 0, 2] + turn[f, 2, 0])
            w2 = 0.5 * (turn[v, 1, 0] - turn[v, 0, 1] - turn[f, 1, 0] + turn[f, 0, 1])
            n0, n1, n2 = e[NOW], e[NOW + 3], e[NOW + 6]
            x0, x1, x2 = w1 * n2 - w2 * n1, w2 * n0 - w0 * n2, w0 * n1 - w1 * n0
            for k in range(1, 3):
                along = e[NOW + k] * x0 + e[NOW + 3 + k] * x1 + e[NOW + 6 + k] * x2
                e[Y + k] -= ball * along
        trial[c, 0] = -law[c, KN] * (s[GAP_0] + e[Y])
        trial[c, 1] = shear[c, 0] - law[c, KS] * e[Y + 1]
        trial[c, 2] = shear[c, 1] - law[c, KS] * e[Y + 2]


@njit(cache=True)
def relative(which, start, now, first, low, high, twist, found):
    """How gaps and slips go (n, 3) with twists (n, 6) of the bodies, in axes of the world."""
    for c in range(first[low], first[high]):
        e = now[c]
        on_b = start[c, SIDE] > 0.0
        v = which[c, BODY_B] if on_b else which[c, BODY_A]
        f = which[c, BODY_A] if on_b else which[c, BODY_B]
        a0, a1, a2 = e[ARM_V], e[ARM_V + 1], e[ARM_V + 2]
        b0, b1, b2 = e[ARM_F], e[ARM_F + 1], e[ARM_F + 2]
        x = twist[v, 0] - twist[f, 0] + twist[v, 4] * a2 - twist[v, 5] * a1
        x -= twist[f, 4] * b2 - twist[f, 5] * b1
        y = twist[v, 1] - twist[f, 1] + twist[v, 5] * a0 - twist[v, 3] * a2
        y -= twist[f, 5] * b0 - twist[f, 3] * b2
        z = twist[v, 2] - twist[f, 2] + twist[v, 3] * a1 - twist[v, 4] * a0
        z -= twist[f, 3] * b1 - twist[f, 4] * b0
        for k in range(3):
            found[c, k] = e[NOW + k] * x + e[NOW + 3 + k] * y + e[NOW + 6 + k] * z


@njit(cache=True)
def twists(motion, axes, twist):
    """Twists (n, 6) in axes of the world of motions (n, 6), rotations about the principal axes."""
    for i in range(motion.shape[0]):
        for d in range(3):
            twist[i, d] = motion[i, d]
            twist[i, 3 + d] = (
                axes[i, d, 0] * motion[i, 3]
                + axes[i, d, 1] * motion[i, 4]
                + axes[i, d, 2] * motion[i, 5]
            )


@njit(cache=True)
def wrenches(which, start, now, first, low, high, reaction, wrench):
    """What the contacts of each pair do to its bodies, (n_pairs, 2, 6), in axes of the world."""
    for p in range(low, high):
        wrench[p, :, :] = 0.0
        for c in range(first[p], first[p + 1]):
            e = now[c]
            r0, r1, r2 = reaction[c, 0], reaction[c, 1], reaction[c, 2]
            if r0 == 0.0 and r1 == 0.0 and r2 == 0.0:
                continue
            x = e[NOW] * r0 + e[NOW + 1] * r1 + e[NOW + 2] * r2
            y = e[NOW + 3] * r0 + e[NOW + 4] * r1 + e[NOW + 5] * r2
            z = e[NOW + 6] * r0 + e[NOW + 7] * r1 + e[NOW + 8] * r2
            v, f = (1, 0) if start[c, SIDE] > 0.0 else (0, 1)
            wrench[p, v, 0] += x
            wrench[p, v, 1] += y
            wrench[p, v, 2] += z
            wrench[p, v, 3] += e[ARM_V + 1] * z - e[ARM_V + 2] * y
            wrench[p, v, 4] += e[ARM_V + 2] * x - e[ARM_V] * z
            wrench[p, v, 5] += e[ARM_V] * y - e[ARM_V + 1] * x
            wrench[p, f, 0] -= x
            wrench[p, f, 1] -= y
            wrench[p, f, 2] -= z
            wrench[p, f, 3] -= e[ARM_F + 1] * z - e[ARM_F + 2] * y
            wrench[p, f, 4] -= e[ARM_F + 2] * x - e[ARM_F] * z
            wrench[p, f, 5] -= e[ARM_F] * y - e[ARM_F + 1] * x


@njit(cache=True)
def sum_wrenches(begin, of_body, wrench, axes, force):
    """Fill ``force`` (n, 6): of each body the wrenches of its pairs, moments about its axes.

    ``of_body`` lists twice the pair, plus one where the body is b, of body i from ``begin[i]`` on.
    """
    for i in range(force.shape[0]):
        f0, f1, f2, m0, m1, m2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(begin[i], begin[i + 1]):
            p, side = of_body[j] // 2, of_body[j] % 2
            f0 += wrench[p, side, 0]
            f1 += wrench[p, side, 1]
            f2 += wrench[p, side, 2]
            m0 += wrench[p, side, 3]
            m1 += wrench[p, side, 4]
            m2 += wrench[p, side, 5]
        force[i, 0], force[i, 1], force[i, 2] = f0, f1, f2
        for d in range(3):
            force[i, 3 + d] = axes[i, 0, d] * m0 + axes[i, 1, d] * m1 + axes[i, 2, d] * m2


@njit(cache=True)
def respond(law, held, trial, low, high, branch, reaction, response):
    """The joint law: reactions (n, 3) and their derivatives (n, 3, 3) by the trial reactions.

    ``branch`` (n,) is filled; a contact at its cone to rounding keeps the one it has.
    """
    for c in range(low, high):
        tn, t1, t2 = trial[c, 0], trial[c, 1], trial[c, 2]
        a = response[c]
        a[:, :] = 0.0
        if held[c] != 0.0:
            branch[c] = BONDED
            reaction[c, 0], reaction[c, 1], reaction[c, 2] = tn, t1, t2
            a[0, 0], a[1, 1], a[2, 2] = 1.0, 1.0, 1.0
            continue
        ks, mu, lift = law[c, KS], law[c, MU], law[c, LIFT]
        size = np.sqrt(t1 * t1 + t2 * t2)
        if ks * tn + lift * size <= 0.0:
            branch[c] = OPEN
            reaction[c, 0], reaction[c, 1], reaction[c, 2] = 0.0, 0.0, 0.0
            continue
        over, near = size - mu * tn, TIE * (size + mu * abs(tn))
        if over <= 0.0 and not (branch[c] == FORWARD and over >= -near) or (
            branch[c] == STICKING and over <= near
        ):
            branch[c] = STICKING
            reaction[c, 0], reaction[c, 1], reaction[c, 2] = tn, t1, t2
            a[0, 0], a[1, 1], a[2, 2] = 1.0, 1.0, 1.0
            continue
        branch[c] = FORWARD
        raised = lift / (ks + mu * lift)
        rn = tn + raised * (size - mu * tn)
        e1, e2 = (t1 / size, t2 / size) if size > 0.0 else (0.0, 0.0)
        share = mu * rn / size if size > 0.0 else 0.0
        reaction[c, 0], reaction[c, 1], reaction[c, 2] = rn, mu * rn * e1, mu * rn * e2
        nn, n1, n2 = 1.0 - raised * mu, raised * e1, raised * e2
        a[0, 0], a[0, 1], a[0, 2] = nn, n1, n2
        a[1, 0], a[2, 0] = mu * e1 * nn, mu * e2 * nn
        a[1, 1] = mu * e1 * n1 + share * (1.0 - e1 * e1)
        a[1, 2] = mu * e1 * n2 - share * e1 * e2
        a[2, 1] = mu * e2 * n1 - share * e1 * e2
        a[2, 2] = mu * e2 * n2 + share * (1.0 - e2 * e2)


@njit(cache=True)
def age(which, law, trial, reaction, branch, count, history):
    """What contacts have at the end of a step, into ``history`` (n_slots, N_HISTORY) of its start."""
    for c in range(count):
        k = which[c, SLOT]
        history[k, SHEAR], history[k, SHEAR + 1] = reaction[c, 1], reaction[c, 2]
        if branch[c] == FORWARD:
            size = np.hypot(trial[c, 1], trial[c, 2])
            mu, lift = law[c, MU], law[c, LIFT]
            slid = (size - mu * trial[c, 0]) / (law[c, KS] + mu * lift)
            if lift > 0.0:
                history[k, DILATION] += lift / law[c, KN] * slid
            history[k, SLID] += slid


@njit(cache=True)
def _cross_rows(m, x, y, z, out):
    """M [a]: each row of M times a."""
    for i in range(3):
        p, q, r = m[i, 0], m[i, 1], m[i, 2]
        out[i, 0] = q * z - r * y
        out[i, 1] = r * x - p * z
        out[i, 2] = p * y - q * x


@njit(cache=True)
def _cross_columns(m, x, y, z, out):
    """[a] M: a times each column of M."""
    for j in range(3):
        p, q, r = m[0, j], m[1, j], m[2, j]
        out[0, j] = y * r - z * q
        out[1, j] = z * p - x * r
        out[2, j] = x * q - y * p


# Long: one contact's blocks, written out.
@njit(cache=True)
def stiffness(
    which, start, now, law, first, low, high, reaction, response, axes, diagonal, upper, lower,
):  # fmt: skip
    """Stiffness of the contacts of pairs ``low`` to ``high``, of minus forces, geometric part and
    all.

    Parameters
    ----------
    reaction
        (n, 3) [N] of which the geometric part is that.
    response
        (n, 3, 3) derivatives of the reactions by the trial reactions.
    axes
        (n, 3, 3) principal axes of the bodies.
    diagonal
        (n_pairs, 2, 6, 6) filled: what each pair adds to the diagonal blocks of its bodies.
    upper, lower
        (n_pairs, 6, 6) filled: rows of a and columns of b, and the other way round.
    """
    core, ba, bb = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    work, force, moved = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    blocks = np.zeros((2, 2, 6, 6))
    for p in range(low, high):
        blocks[:, :, :, :] = 0.0
        for c in range(first[p], first[p + 1]):
            e, s = now[c], start[c]
            kn, ks = law[c, KN], law[c, KS]
            v, f = (1, 0) if s[SIDE] > 0.0 else (0, 1)
            vv, vf, fv, ff = blocks[v, v], blocks[v, f], blocks[f, v], blocks[f, f]
            m = response[c]
            r0, r1, r2 = reaction[c, 0], reaction[c, 1], reaction[c, 2]
            for i in range(3):
                e0, e1, e2 = e[NOW + 3 * i], e[NOW + 3 * i + 1], e[NOW + 3 * i + 2]
                x = (e0 * m[0, 0] + e1 * m[1, 0] + e2 * m[2, 0]) * kn
                y = (e0 * m[0, 1] + e1 * m[1, 1] + e2 * m[2, 1]) * ks
                z = (e0 * m[0, 2] + e1 * m[1, 2] + e2 * m[2, 2]) * ks
                for j in range(3):
                    core[i, j] = x * e[NOW + 3 * j] + y * e[NOW + 3 * j + 1] + z * e[NOW + 3 * j + 2]
            a0, a1, a2 = e[ARM_V], e[ARM_V + 1], e[ARM_V + 2]
            b0, b1, b2 = e[ARM_F], e[ARM_F + 1], e[ARM_F + 2]
            _cross_rows(core, a0, a1, a2, ba)
            _cross_rows(core, b0, b1, b2, bb)
            for i in range(3):
                for j in range(3):
                    vv[i, j] += core[i, j]
                    ff[i, j] += core[i, j]
                    vf[i, j] -= core[i, j]
                    fv[i, j] -= core[i, j]
                    vv[i, 3 + j] -= ba[i, j]
                    fv[i, 3 + j] += ba[i, j]
                    vf[i, 3 + j] += bb[i, j]
                    ff[i, 3 + j] -= bb[i, j]
            _cross_columns(core, a0, a1, a2, work)
            for i in range(3):
                for j in range(3):
                    vv[3 + i, j] += work[i, j]
                    vf[3 + i, j] -= work[i, j]
            _cross_columns(core, b0, b1, b2, work)
            for i in range(3):
                for j in range(3):
                    fv[3 + i, j] -= work[i, j]
                    ff[3 + i, j] += work[i, j]
            _cross_columns(ba, a0, a1, a2, work)
            for i in range(3):
                for j in range(3):
                    vv[3 + i, 3 + j] -= work[i, j]
            _cross_columns(bb, a0, a1, a2, work)
            for i in range(3):
                for j in range(3):
                    vf[3 + i, 3 + j] += work[i, j]
            _cross_columns(ba, b0, b1, b2, work)
            for i in range(3):
                for j in range(3):
                    fv[3 + i, 3 + j] += work[i, j]
            _cross_columns(bb, b0, b1, b2, work)
            for i in range(3):
                for j in range(3):
                    ff[3 + i, 3 + j] -= work[i, j]
            if r0 == 0.0 and r1 == 0.0 and r2 == 0.0:
                continue
            fx = e[NOW] * r0 + e[NOW + 1] * r1 + e[NOW + 2] * r2
            fy = e[NOW + 3] * r0 + e[NOW + 4] * r1 + e[NOW + 5] * r2
            fz = e[NOW + 6] * r0 + e[NOW + 7] * r1 + e[NOW + 8] * r2
            force[0, 1], force[0, 2], force[1, 2] = -fz, fy, -fx
            force[1, 0], force[2, 0], force[2, 1] = fz, -fy, fx
            ball = s[BALL]
            n0, n1, n2 = ball * e[NOW], ball * e[NOW + 3], ball * e[NOW + 6]
            # The arm to the point itself turns with v; what lies between it and the surface, with f.
            _cross_rows(force, a0 + n0, a1 + n1, a2 + n2, moved)
            for i in range(3):
                for j in range(3):
                    vv[3 + i, 3 + j] -= moved[i, j]
                    fv[3 + i, 3 + j] += moved[i, j]
                    vf[i, 3 + j] += force[i, j]
                    ff[i, 3 + j] -= force[i, j]
                    fv[3 + i, j] -= force[i, j]
                    ff[3 + i, j] += force[i, j]
            _cross_columns(force, a0, a1, a2, moved)
            _cross_columns(force, b0, b1, b2, work)
            for i in range(3):
                for j in range(3):
                    vf[3 + i, 3 + j] += moved[i, j]
                    ff[3 + i, 3 + j] -= work[i, j]
            if ball > 0.0:
                _cross_rows(force, n0, n1, n2, moved)
                for i in range(3):
                    for j in range(3):
                        vf[3 + i, 3 + j] += moved[i, j]
                        ff[3 + i, 3 + j] -= moved[i, j]
        a, b = 0, 0  # where there is nothing to turn
        if first[p] < first[p + 1]:
            a, b = which[first[p], BODY_A], which[first[p], BODY_B]
        for row in range(2):
            for column in range(2):
                block = blocks[row, column]
                x, w = axes[b if row else a], axes[b if column else a]
                _about_axes(block, x, w, work)
                if row == column:
                    diagonal[p, row, :, :] = block
                elif row == 0:
                    upper[p, :, :] = block
                else:
                    lower[p, :, :] = block


@njit(cache=True)
def _about_axes(block, rows, columns, work):
    """Turn a block (6, 6) of forces by motions to principal axes, in place."""
    for i in range(6):
        x, y, z = block[i, 3], block[i, 4], block[i, 5]
        for j in range(3):
            block[i, 3 + j] = x * columns[0, j] + y * columns[1, j] + z * columns[2, j]
    for j in range(6):
        x, y, z = block[3, j], block[4, j], block[5, j]
        for i in range(3):
            block[3 + i, j] = rows[0, i] * x + rows[1, i] * y + rows[2, i] * z


@njit(cache=True)
def sum_diagonals(begin, of_body, part, diagonal):
    """Fill the diagonal blocks (n, 6, 6) from those of each body's pairs; see `sum_wrenches`."""
    for i in range(diagonal.shape[0]):
        diagonal[i, :, :] = 0.0
        for j in range(begin[i], begin[i + 1]):
            p, side = of_body[j] // 2, of_body[j] % 2
            for k in range(6):
                for m in range(6):
                    diagonal[i, k, m] += part[p, side, k, m]


@njit(cache=True)
def increments(motion, spin, axes_0, x):
    """Fill ``x`` (n, 6) [m, rad] with the increments that a motion and a spin amount to, rotations
    about the principal axes where the step starts; see `turn_on`."""
    for i in range(motion.shape[0]):
        sign = -1.0 if spin[i, 0] < 0.0 else 1.0
        v0, v1, v2 = sign * spin[i, 1], sign * spin[i, 2], sign * spin[i, 3]
        size = np.sqrt(v0 * v0 + v1 * v1 + v2 * v2)
        share = 2.0 * np.arctan2(size, sign * spin[i, 0]) / size if size > 0.0 else 2.0
        for d in range(3):
            x[i, d] = motion[i, d]
            x[i, 3 + d] = share * (axes_0[i, 0, d] * v0 + axes_0[i, 1, d] * v1 + axes_0[i, 2, d] * v2)
