"""Contacts of a static step in space: their places, reactions and stiffness.

A contact is a point of body v on a plane of body f.  Where the step starts, its axes are
Q = [n t1 t2], with n from f to v, and p leads from the centroid of v to the point.  The bodies have
moved by (u, R) since then, and d leads from the centroid of f to the point now.  The axes now are
E = R_f Q, and gap and slips have grown by

    y = Q^T { (R_f^T - I) d + u_v - u_f + (R_v - I) p }

This is measured in the axes of f, so that a rigid motion of both bodies gives zero.  Everything is
formed from increments, because stiffness times the rounding of coordinates would be noticeable.  If
the point is the centre of a rounded corner of radius r, the surfaces meet at -r n from the point,
and the corner rolls on the plane.

The force F = E r acts on v at arm a and, reversed, on f at arm b.  As E turns with f, forces turn
as well.  This gives the geometric part of the stiffness, which is not symmetric.  Matrices are
calculated per pair in axes of the world, and turned to the principal axes of the bodies.

Kernels take a range of pairs, so that several threads may work on parts of a structure at the same
time.  Forces on a body are summed afterwards in the order of its pairs, so that the result does not
depend on the number of threads.
"""

import numpy as np

from drystone.common.compiled import njit
from drystone.contact.contacts import (
    ARM_A_3,
    ARM_B_3,
    BALL_3,
    BODY_A,
    BODY_B,
    GAP,
    KIND,
    NORMAL_3,
    SHIFT,
    SLOT,
    STIFF_N,
    STIFF_T,
    TANGENT_3,
    VERTEX_B,
)
from drystone.geometry.rotation import place_axes, spin
from drystone.law.columns import DILATION, SHEAR

#: Columns of a contact's place where the step starts: the point from the centroid of v and from
#: that of f; the axes Q, a matrix (3, 3) by rows; the gap less dilation; the radius; +1 if v is
#: body b, -1 if v is body a.
POINT, FROM_F, AXES, GAP_0, BALL, SIDE = 0, 3, 6, 15, 16, 17
N_PLACE = 18

#: Columns of a contact's place now: by how much gap and slips have grown; the axes E, a matrix
#: (3, 3) by rows; the arms from the centroids of v and f to where the surfaces meet.
Y, NOW, ARM_V, ARM_F = 0, 3, 12, 15
N_NOW = 18

#: The stiffness of a pair is made from sums over its contacts, in one array.  The material part of
#: 6 by 6 comes first.  The sums for the geometric part begin here: of contacts whose v is body b,
#: and of those whose v is body a.
ON_B, ON_A = 36, 57
N_TOTAL = 78


@njit(cache=True)
def pack_places(slots, history, count, which, start, shear):
    """Fill the places ``start`` (n_slots, N_PLACE) of the ``count`` contacts in use, and their
    ``shear`` (n_slots, 2) [N], from the slots where the step starts."""
    meets, value = slots
    for c in range(count):
        k = which[c, SLOT]
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
        shear[c, 0], shear[c, 1] = history[k, SHEAR], history[k, SHEAR + 1]


@njit(cache=True)
def rotate_on(step, length, axes_0, motion, rotation, axes):
    """Move the poses ``motion`` (n, 7), counted from the start of the step, on by ``length`` times
    the increments ``step`` (n, 6).

    Rotations are about the principal axes at the start, the columns of ``axes_0`` (n, 3, 3).  Fills
    the ``rotation`` matrices less identity and the ``axes``, (n, 3, 3) each.
    """
    for i in range(step.shape[0]):
        vx, vy, vz = 0.0, 0.0, 0.0
        for k in range(3):
            motion[i, k] += length * step[i, k]
            w = length * step[i, 3 + k]
            vx += axes_0[i, 0, k] * w
            vy += axes_0[i, 1, k] * w
            vz += axes_0[i, 2, k] * w
        spin(motion, i, vx, vy, vz)
        place_axes(motion, i, axes_0, rotation, axes)


@njit(cache=True, nogil=True)
def locate(which, start, table, shear, first, low, high, motion, rotation, now, trial):
    """Fill the places ``now`` (n_slots, N_NOW) of the contacts of pairs ``low`` to before ``high``,
    and their trial reactions ``trial`` (n_slots, 3) [N]."""
    for c in range(first[low], first[high]):
        on_b = start[c, SIDE] > 0.0
        v = which[c, BODY_B] if on_b else which[c, BODY_A]
        f = which[c, BODY_A] if on_b else which[c, BODY_B]
        ball = start[c, BALL]
        p0, p1, p2 = start[c, POINT], start[c, POINT + 1], start[c, POINT + 2]
        m0 = rotation[v, 0, 0] * p0 + rotation[v, 0, 1] * p1 + rotation[v, 0, 2] * p2
        m1 = rotation[v, 1, 0] * p0 + rotation[v, 1, 1] * p1 + rotation[v, 1, 2] * p2
        m2 = rotation[v, 2, 0] * p0 + rotation[v, 2, 1] * p1 + rotation[v, 2, 2] * p2
        g0 = motion[v, 0] - motion[f, 0] + m0
        g1 = motion[v, 1] - motion[f, 1] + m1
        g2 = motion[v, 2] - motion[f, 2] + m2
        d0, d1, d2 = start[c, FROM_F] + g0, start[c, FROM_F + 1] + g1, start[c, FROM_F + 2] + g2
        # (R_f^T - I) d, with the transpose of the rotation.
        g0 += rotation[f, 0, 0] * d0 + rotation[f, 1, 0] * d1 + rotation[f, 2, 0] * d2
        g1 += rotation[f, 0, 1] * d0 + rotation[f, 1, 1] * d1 + rotation[f, 2, 1] * d2
        g2 += rotation[f, 0, 2] * d0 + rotation[f, 1, 2] * d1 + rotation[f, 2, 2] * d2
        for k in range(3):
            q0, q1, q2 = start[c, AXES + k], start[c, AXES + 3 + k], start[c, AXES + 6 + k]
            now[c, Y + k] = q0 * g0 + q1 * g1 + q2 * g2
            now[c, NOW + k] = (
                q0 + rotation[f, 0, 0] * q0 + rotation[f, 0, 1] * q1 + rotation[f, 0, 2] * q2
            )
            now[c, NOW + 3 + k] = (
                q1 + rotation[f, 1, 0] * q0 + rotation[f, 1, 1] * q1 + rotation[f, 1, 2] * q2
            )
            now[c, NOW + 6 + k] = (
                q2 + rotation[f, 2, 0] * q0 + rotation[f, 2, 1] * q1 + rotation[f, 2, 2] * q2
            )
        now[c, ARM_V] = p0 + m0 - ball * now[c, NOW]
        now[c, ARM_V + 1] = p1 + m1 - ball * now[c, NOW + 3]
        now[c, ARM_V + 2] = p2 + m2 - ball * now[c, NOW + 6]
        now[c, ARM_F] = d0 - ball * now[c, NOW]
        now[c, ARM_F + 1] = d1 - ball * now[c, NOW + 3]
        now[c, ARM_F + 2] = d2 - ball * now[c, NOW + 6]
        if ball > 0.0:
            # Rolling: the rotation of v relative to f, to third order, times the radius.
            w0 = 0.5 * (
                rotation[v, 2, 1] - rotation[v, 1, 2] - rotation[f, 2, 1] + rotation[f, 1, 2]
            )
            w1 = 0.5 * (
                rotation[v, 0, 2] - rotation[v, 2, 0] - rotation[f, 0, 2] + rotation[f, 2, 0]
            )
            w2 = 0.5 * (
                rotation[v, 1, 0] - rotation[v, 0, 1] - rotation[f, 1, 0] + rotation[f, 0, 1]
            )
            n0, n1, n2 = now[c, NOW], now[c, NOW + 3], now[c, NOW + 6]
            x0, x1, x2 = w1 * n2 - w2 * n1, w2 * n0 - w0 * n2, w0 * n1 - w1 * n0
            for k in range(1, 3):
                along = now[c, NOW + k] * x0 + now[c, NOW + 3 + k] * x1 + now[c, NOW + 6 + k] * x2
                now[c, Y + k] -= ball * along
        trial[c, 0] = table[c, SHIFT] - table[c, STIFF_N] * (start[c, GAP_0] + now[c, Y])
        trial[c, 1] = shear[c, 0] - table[c, STIFF_T] * now[c, Y + 1]
        trial[c, 2] = shear[c, 1] - table[c, STIFF_T] * now[c, Y + 2]


@njit(cache=True, nogil=True)
def relative(which, start, now, first, low, high, twist, found):
    """Fill ``found`` (n_slots, 3) with the rates of gaps and slips for twists (n, 6) of the bodies,
    in axes of the world."""
    for c in range(first[low], first[high]):
        on_b = start[c, SIDE] > 0.0
        v = which[c, BODY_B] if on_b else which[c, BODY_A]
        f = which[c, BODY_A] if on_b else which[c, BODY_B]
        a0, a1, a2 = now[c, ARM_V], now[c, ARM_V + 1], now[c, ARM_V + 2]
        b0, b1, b2 = now[c, ARM_F], now[c, ARM_F + 1], now[c, ARM_F + 2]
        x = twist[v, 0] - twist[f, 0] + twist[v, 4] * a2 - twist[v, 5] * a1
        x -= twist[f, 4] * b2 - twist[f, 5] * b1
        y = twist[v, 1] - twist[f, 1] + twist[v, 5] * a0 - twist[v, 3] * a2
        y -= twist[f, 5] * b0 - twist[f, 3] * b2
        z = twist[v, 2] - twist[f, 2] + twist[v, 3] * a1 - twist[v, 4] * a0
        z -= twist[f, 3] * b1 - twist[f, 4] * b0
        for k in range(3):
            found[c, k] = now[c, NOW + k] * x + now[c, NOW + 3 + k] * y + now[c, NOW + 6 + k] * z


@njit(cache=True)
def twists(motion, axes, twist):
    """Fill ``twist`` (n, 6), in axes of the world, from motions (n, 6) whose rotations are about
    the principal axes."""
    for i in range(motion.shape[0]):
        for d in range(3):
            twist[i, d] = motion[i, d]
            twist[i, 3 + d] = (
                axes[i, d, 0] * motion[i, 3]
                + axes[i, d, 1] * motion[i, 4]
                + axes[i, d, 2] * motion[i, 5]
            )


@njit(cache=True, nogil=True)
def wrenches(start, now, first, low, high, reaction, wrench):
    """Fill ``wrench`` (n_pairs, 2, 6) with the forces and moments that the contacts of each pair
    exert on its bodies, in axes of the world [N, N m]."""
    for p in range(low, high):
        # The force on b, which acts reversed on a, and the moments on both.
        fx, fy, fz = 0.0, 0.0, 0.0
        ax, ay, az, bx, by, bz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for c in range(first[p], first[p + 1]):
            r0, r1, r2 = reaction[c, 0], reaction[c, 1], reaction[c, 2]
            if r0 == 0.0 and r1 == 0.0 and r2 == 0.0:
                continue
            side = start[c, SIDE]
            x = now[c, NOW] * r0 + now[c, NOW + 1] * r1 + now[c, NOW + 2] * r2
            y = now[c, NOW + 3] * r0 + now[c, NOW + 4] * r1 + now[c, NOW + 5] * r2
            z = now[c, NOW + 6] * r0 + now[c, NOW + 7] * r1 + now[c, NOW + 8] * r2
            x, y, z = side * x, side * y, side * z
            v0, v1, v2 = now[c, ARM_V], now[c, ARM_V + 1], now[c, ARM_V + 2]
            f0, f1, f2 = now[c, ARM_F], now[c, ARM_F + 1], now[c, ARM_F + 2]
            if side < 0.0:
                v0, v1, v2, f0, f1, f2 = f0, f1, f2, v0, v1, v2
            fx += x
            fy += y
            fz += z
            bx += v1 * z - v2 * y
            by += v2 * x - v0 * z
            bz += v0 * y - v1 * x
            ax -= f1 * z - f2 * y
            ay -= f2 * x - f0 * z
            az -= f0 * y - f1 * x
        wrench[p, 0, 0], wrench[p, 0, 1], wrench[p, 0, 2] = -fx, -fy, -fz
        wrench[p, 0, 3], wrench[p, 0, 4], wrench[p, 0, 5] = ax, ay, az
        wrench[p, 1, 0], wrench[p, 1, 1], wrench[p, 1, 2] = fx, fy, fz
        wrench[p, 1, 3], wrench[p, 1, 4], wrench[p, 1, 5] = bx, by, bz


@njit(cache=True)
def sum_wrenches(begin, of_body, wrench, axes, force):
    """Fill ``force`` (n, 6) of each body with the sum of its wrenches, moments about its principal
    axes.

    ``of_body`` lists the pairs of body i from ``begin[i]`` on: twice the pair, plus one if the body
    is b.
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
def _add_row(total, at, b0, b1, b2, r0, r1, r2, j, up, k, down):
    """Add a row of B and its share of the moments' rows, from ``j`` and ``k`` on."""
    c0, c1, c2 = b1 * r2 - b2 * r1, b2 * r0 - b0 * r2, b0 * r1 - b1 * r0
    total[at] += b0
    total[at + 1] += b1
    total[at + 2] += b2
    total[at + 3] += c0
    total[at + 4] += c1
    total[at + 5] += c2
    total[j] += up * b0
    total[j + 1] += up * b1
    total[j + 2] += up * b2
    total[j + 3] += up * c0
    total[j + 4] += up * c1
    total[j + 5] += up * c2
    total[k] -= down * b0
    total[k + 1] -= down * b1
    total[k + 2] -= down * b2
    total[k + 3] -= down * c0
    total[k + 4] -= down * c1
    total[k + 5] -= down * c2


@njit(cache=True)
def _add_material(now, table, response, c, side, total):
    """Add a contact's B, B [r], [r] B and [r] B [r] to ``total``, r its arm from body a."""
    kn, ks = table[c, STIFF_N], table[c, STIFF_T]
    arm = ARM_F if side > 0.0 else ARM_V
    r0, r1, r2 = now[c, arm], now[c, arm + 1], now[c, arm + 2]
    q00, q01, q02 = now[c, NOW], now[c, NOW + 1], now[c, NOW + 2]
    q10, q11, q12 = now[c, NOW + 3], now[c, NOW + 4], now[c, NOW + 5]
    q20, q21, q22 = now[c, NOW + 6], now[c, NOW + 7], now[c, NOW + 8]
    # What the axes get of a motion along each of them: A diag(k_n, k_s, k_s) E^T.
    a00, a01, a02 = response[c, 0, 0] * kn, response[c, 0, 1] * ks, response[c, 0, 2] * ks
    a10, a11, a12 = response[c, 1, 0] * kn, response[c, 1, 1] * ks, response[c, 1, 2] * ks
    a20, a21, a22 = response[c, 2, 0] * kn, response[c, 2, 1] * ks, response[c, 2, 2] * ks
    n0 = a00 * q00 + a01 * q01 + a02 * q02
    n1 = a00 * q10 + a01 * q11 + a02 * q12
    n2 = a00 * q20 + a01 * q21 + a02 * q22
    s0 = a10 * q00 + a11 * q01 + a12 * q02
    s1 = a10 * q10 + a11 * q11 + a12 * q12
    s2 = a10 * q20 + a11 * q21 + a12 * q22
    t0 = a20 * q00 + a21 * q01 + a22 * q02
    t1 = a20 * q10 + a21 * q11 + a22 * q12
    t2 = a20 * q20 + a21 * q21 + a22 * q22
    b0 = q00 * n0 + q01 * s0 + q02 * t0
    b1 = q00 * n1 + q01 * s1 + q02 * t1
    b2 = q00 * n2 + q01 * s2 + q02 * t2
    _add_row(total, 0, b0, b1, b2, r0, r1, r2, 24, r2, 30, r1)
    b0 = q10 * n0 + q11 * s0 + q12 * t0
    b1 = q10 * n1 + q11 * s1 + q12 * t1
    b2 = q10 * n2 + q11 * s2 + q12 * t2
    _add_row(total, 6, b0, b1, b2, r0, r1, r2, 30, r0, 18, r2)
    b0 = q20 * n0 + q21 * s0 + q22 * t0
    b1 = q20 * n1 + q21 * s1 + q22 * t1
    b2 = q20 * n2 + q21 * s2 + q22 * t2
    _add_row(total, 12, b0, b1, b2, r0, r1, r2, 18, r1, 24, r0)


@njit(cache=True)
def _add_geometric(now, reaction, c, ball, total, at):
    """Add F, F v^T and r n F^T of a contact to ``total`` from ``at`` on.

    F is its force, v its arm from the centroid of body v, r the radius of its corner.
    """
    r0, r1, r2 = reaction[c, 0], reaction[c, 1], reaction[c, 2]
    v0, v1, v2 = now[c, ARM_V], now[c, ARM_V + 1], now[c, ARM_V + 2]
    x = now[c, NOW] * r0 + now[c, NOW + 1] * r1 + now[c, NOW + 2] * r2
    y = now[c, NOW + 3] * r0 + now[c, NOW + 4] * r1 + now[c, NOW + 5] * r2
    z = now[c, NOW + 6] * r0 + now[c, NOW + 7] * r1 + now[c, NOW + 8] * r2
    total[at] += x
    total[at + 1] += y
    total[at + 2] += z
    total[at + 3] += x * v0
    total[at + 4] += x * v1
    total[at + 5] += x * v2
    total[at + 6] += y * v0
    total[at + 7] += y * v1
    total[at + 8] += y * v2
    total[at + 9] += z * v0
    total[at + 10] += z * v1
    total[at + 11] += z * v2
    if ball > 0.0:
        for i in range(3):
            n = ball * now[c, NOW + 3 * i]
            total[at + 12 + 3 * i] += n * x
            total[at + 13 + 3 * i] += n * y
            total[at + 14 + 3 * i] += n * z


@njit(cache=True)
def _spread_material(total, d0, d1, d2, aa, ab, ba, bb):
    """Fill the blocks (6, 6) of a pair from its sums about body a; see `stiffness`."""
    for i in range(6):
        for j in range(6):
            aa[i, j] = total[6 * i + j]
        x, y, z = aa[i, 0], aa[i, 1], aa[i, 2]
        ab[i, 0], ab[i, 1], ab[i, 2] = -x, -y, -z
        ab[i, 3] = y * d2 - z * d1 - aa[i, 3]
        ab[i, 4] = z * d0 - x * d2 - aa[i, 4]
        ab[i, 5] = x * d1 - y * d0 - aa[i, 5]
    for j in range(6):
        x, y, z = aa[0, j], aa[1, j], aa[2, j]
        ba[0, j], ba[1, j], ba[2, j] = -x, -y, -z
        ba[3, j] = d2 * y - d1 * z - aa[3, j]
        ba[4, j] = d0 * z - d2 * x - aa[4, j]
        ba[5, j] = d1 * x - d0 * y - aa[5, j]
        x, y, z = ab[0, j], ab[1, j], ab[2, j]
        bb[0, j], bb[1, j], bb[2, j] = -x, -y, -z
        bb[3, j] = d2 * y - d1 * z - ab[3, j]
        bb[4, j] = d0 * z - d2 * x - ab[4, j]
        bb[5, j] = d1 * x - d0 * y - ab[5, j]


@njit(cache=True)
def _spread_geometric(total, at, sense, way, vv, vf, fv, ff):
    """Add the geometric part to the blocks (6, 6) of a pair, of its contacts with the same body v;
    ``sense`` times ``way`` (3,) leads from the centroid of f to that of v."""
    by_v = total[at + 3] + total[at + 7] + total[at + 11]
    by_n = total[at + 12] + total[at + 16] + total[at + 20]
    by_d = total[at] * way[0] + total[at + 1] * way[1] + total[at + 2] * way[2]
    for i in range(3):
        j, k = (i + 1 if i < 2 else 0), (i - 1 if i > 0 else 2)
        fj, fk, along = total[at + j], total[at + k], sense * total[at + i]
        # The matrix of F x.
        vf[j, 3 + i] += fk
        vf[k, 3 + i] -= fj
        ff[j, 3 + i] -= fk
        ff[k, 3 + i] += fj
        fv[3 + j, i] -= fk
        fv[3 + k, i] += fj
        ff[3 + j, i] += fk
        ff[3 + k, i] -= fj
        for m in range(3):
            # [v] [F] = F v^T - (v . F), [F] [v] its transpose; the arm from f is v + d.
            rolled = total[at + 12 + 3 * i + m]
            by_arm, turned = total[at + 3 + 3 * i + m] + rolled, total[at + 3 + 3 * m + i] + rolled
            vv[3 + i, 3 + m] -= turned
            fv[3 + i, 3 + m] += turned
            vf[3 + i, 3 + m] += by_arm
            ff[3 + i, 3 + m] -= by_arm + along * way[m]
        vv[3 + i, 3 + i] += by_v + by_n
        fv[3 + i, 3 + i] -= by_v + by_n
        vf[3 + i, 3 + i] -= by_v + by_n
        ff[3 + i, 3 + i] += by_v + by_n + sense * by_d


# Many: contacts, their reactions, and the blocks that are filled.
@njit(cache=True, nogil=True)
def stiffness(
    which, start, now, table, first, low, high, reaction, response, axes, diagonal, upper, lower,
):  # fmt: skip
    """Stiffness of the contacts of pairs ``low`` to before ``high``: the derivative of minus their
    forces, geometric part included.

    With A the responses, r the arms from body a and B = E A diag(k_n, k_s, k_s) E^T, the material
    part is

        K_aa = sum [[B, -B [r]], [[r] B, -[r] B [r]]],    K_ab = -K_aa T,    K_bb = T^t K_aa T,

    T = [[1, -[d]], [0, 1]] with d from the centroid of b to that of a.  The geometric part follows
    from the sums of F, F v^T and r n F^T, separately for contacts with v = b and with v = a.

    Filled are ``diagonal`` (n_pairs, 2, 6, 6), what each pair adds to the diagonal blocks of its
    two bodies, in axes of the world; and ``upper`` and ``lower``, see `Tangent`.
    """
    total, way = np.zeros(N_TOTAL), np.zeros(3)
    for p in range(low, high):
        aa, bb, ab, ba = diagonal[p, 0], diagonal[p, 1], upper[p], lower[p]
        if first[p] == first[p + 1]:
            aa[:, :], ab[:, :], ba[:, :], bb[:, :] = 0.0, 0.0, 0.0, 0.0
            continue
        total[:] = 0.0
        on_a, on_b = False, False
        for c in range(first[p], first[p + 1]):
            side = start[c, SIDE]
            _add_material(now, table, response, c, side, total)
            if reaction[c, 0] == 0.0 and reaction[c, 1] == 0.0 and reaction[c, 2] == 0.0:
                continue
            if side > 0.0:
                on_b = True
                _add_geometric(now, reaction, c, start[c, BALL], total, ON_B)
            else:
                on_a = True
                _add_geometric(now, reaction, c, start[c, BALL], total, ON_A)
        for i in range(6):  # these columns hold B [r], which has a minus sign in the stiffness
            for j in range(3, 6):
                total[6 * i + j] = -total[6 * i + j]
        c = first[p]
        side = start[c, SIDE]
        for i in range(3):
            way[i] = side * (now[c, ARM_V + i] - now[c, ARM_F + i])
        _spread_material(total, way[0], way[1], way[2], aa, ab, ba, bb)
        if on_b:
            _spread_geometric(total, ON_B, -1.0, way, bb, ba, ab, aa)
        if on_a:
            _spread_geometric(total, ON_A, 1.0, way, aa, ab, ba, bb)
        a, b = which[c, BODY_A], which[c, BODY_B]
        _about_axes(ab, axes, a, b)
        _about_axes(ba, axes, b, a)


@njit(cache=True)
def _about_axes(block, axes, r, c):
    """Turn a block (6, 6), of forces on body r by motions of body c, from axes of the world to the
    principal axes of both, in place."""
    a00, a01, a02 = axes[c, 0, 0], axes[c, 0, 1], axes[c, 0, 2]
    a10, a11, a12 = axes[c, 1, 0], axes[c, 1, 1], axes[c, 1, 2]
    a20, a21, a22 = axes[c, 2, 0], axes[c, 2, 1], axes[c, 2, 2]
    for i in range(6):
        x, y, z = block[i, 3], block[i, 4], block[i, 5]
        block[i, 3] = x * a00 + y * a10 + z * a20
        block[i, 4] = x * a01 + y * a11 + z * a21
        block[i, 5] = x * a02 + y * a12 + z * a22
    a00, a01, a02 = axes[r, 0, 0], axes[r, 0, 1], axes[r, 0, 2]
    a10, a11, a12 = axes[r, 1, 0], axes[r, 1, 1], axes[r, 1, 2]
    a20, a21, a22 = axes[r, 2, 0], axes[r, 2, 1], axes[r, 2, 2]
    for i in range(6):
        x, y, z = block[3, i], block[4, i], block[5, i]
        block[3, i] = a00 * x + a10 * y + a20 * z
        block[4, i] = a01 * x + a11 * y + a21 * z
        block[5, i] = a02 * x + a12 * y + a22 * z


@njit(cache=True)
def sum_diagonals(begin, of_body, part, axes, diagonal):
    """Fill the diagonal blocks (n, 6, 6) with the sums of ``part`` (n_pairs, 2, 6, 6) over the
    pairs of each body, turned to its principal axes; see `sum_wrenches`."""
    for i in range(diagonal.shape[0]):
        diagonal[i, :, :] = 0.0
        for j in range(begin[i], begin[i + 1]):
            p, side = of_body[j] // 2, of_body[j] % 2
            for k in range(6):
                for m in range(6):
                    diagonal[i, k, m] += part[p, side, k, m]
        _about_axes(diagonal[i], axes, i, i)
