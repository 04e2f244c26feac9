"""Cycles of the distinct element method: forces from contacts, motion from forces, and again.

Semi-implicit Euler (central differences with velocities at half steps):

    v <- v + dt M^-1 (f - damping),        x <- x + dt v

Between two searches the features of every contact are frozen: which vertex against which edge (or
against which vertex), with which tributary area.  The gap is then a function of the poses alone,
and the shear force grows with the sliding velocity,

    r_n = k_n (d - g)          r_t <- r_t - k_s dt (grad slip . v)

with dilation d; it is kept in the axes of the contact and turns with them.  The joint law is that
of `kernels.law`.  For all kinds of contact one of the two bodies, the *edge body* e, owns the
normal, which points to the *other body* o; with arms from the centroids, t = (n_y, -n_x), S the
quarter turn, q = 1 but between two vertices, and rolling terms as in `kernels.narrow`,

    grad gap  = [-n, -n.S arm_e, n, n.S arm_o]
    grad slip = q [-t, -t.S arm_e, t, t.S arm_o] + [0, 0, roll_e, 0, 0, roll_o]
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drystone.kernels.contacts import (
    ARM_A,
    ARM_B,
    FEATURE_A,
    FEATURE_B,
    GAP,
    KIND,
    LAW,
    NONE,
    NORMAL,
    PART_A,
    PART_B,
    RATIO,
    SIZE,
    VERTEX_A,
    VERTICES,
    A,
    B,
)
from drystone.kernels.law import (
    BROKEN,
    COHESION,
    DILATANCY_END,
    DILATION,
    KN,
    KS,
    L_BOND,
    L_END,
    L_KN,
    L_KS,
    L_MU,
    L_TAN_PSI,
    L_TENSION,
    MU,
    OPEN,
    SHEAR,
    SLID,
    SLIDING,
    STICKING,
    TAN_PSI,
    TENSION,
    drag,
    opens,
)  # fmt: skip
from drystone.kernels.rows import N_DOF, OF_GAP, OF_SLIP, gradients

#: Columns of `FrozenContacts.shape`: local vertex of the other body, local vertex and tangent of
#: the edge body [m], radius of the other body, sum of both, 1 where two vertices meet [m].
OX, OY, EX, EY, TX, TY, R_O, R_SUM, ROUND = 0, 1, 2, 3, 4, 5, 6, 7, 8
N_SHAPE = 9

#: Entries of the meter, see `cycle`.
MULTIPLIER, FRICTION_WORK, DAMPING_WORK, LOAD_WORK, RESIDUAL, CYCLES = 0, 1, 2, 3, 4, 5
N_METER = 6

#: Why `cycle` returned.
DONE, MOVED, BALANCED = 0, 1, 2

#: Cycles between two looks at the residual.
LOOK = 25

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class FrozenContacts(NamedTuple):
    """Contacts that are watched between two searches, packed; row c belongs to ``slot[c]``."""

    slot: IntArray  # (n_contacts,)
    edge: IntArray  # (n_contacts,) body that owns the normal
    other: IntArray  # (n_contacts,)
    shape: Array  # (n_contacts, N_SHAPE)
    law: Array  # (n_contacts, N_CONTACT_LAW), see `kernels.law`
    history: Array  # (n_contacts, 4)
    reaction: Array  # (n_contacts, 2) N
    status: IntArray  # (n_contacts,)


class Motion(NamedTuple):
    """What evolves in the cycles."""

    pose: Array  # (n, 3) m, rad
    velocity: Array  # (n, 3) m/s, rad/s, half a step behind the pose
    turn: Array  # (n, 2) cosine and sine of the rotation
    force: Array  # (n, 3) N, N m, unbalanced, of the last cycle
    last: Array  # (n, 3) N, N m, unbalanced, of the last cycle with combined damping
    mean: Array  # (n, 3) sum of the unbalanced forces over the cycles
    opposed: Array  # (n, 3) sum over the cycles of what opposes them: inertia and damping


class Loads(NamedTuple):
    """What does not change in the cycles."""

    centroid: Array  # (n, 2) m, as designed
    dead: Array  # (n, 3) N, N m
    pattern: Array  # (n, 3) N, N m, at multiplier one
    inverse_mass: Array  # (n, 3) zero on fixed bodies
    extent: Array  # (n,) m, by which moments are divided and rotations multiplied


@njit(cache=True)
def pack(slots, bodies, pairs, laws, thickness, history, contacts):
    """Fill ``contacts`` from the slots in use and return their number."""
    meets, value = slots
    local, local_tangent, radius = bodies.local, bodies.local_tangent, bodies.radius
    pair, of_pair = pairs.of_slot, pairs.which
    slot, edge, other, shape, law = (
        contacts.slot, contacts.edge, contacts.other, contacts.shape, contacts.law
    )  # fmt: skip
    c = 0
    for k in range(meets.shape[0]):
        if meets[k, KIND] == NONE:
            continue
        p = pair[k]
        e, o, fe, fo = of_pair[p, A], of_pair[p, B], meets[k, FEATURE_A], meets[k, FEATURE_B]
        radius_e, radius_o = radius[of_pair[p, PART_A]], radius[of_pair[p, PART_B]]
        if meets[k, KIND] == VERTEX_A:
            e, o, fe, fo = o, e, fo, fe
            radius_e, radius_o = radius_o, radius_e
        slot[c] = k
        edge[c] = e
        other[c] = o
        shape[c, OX] = local[fo, 0]
        shape[c, OY] = local[fo, 1]
        shape[c, EX] = local[fe, 0]
        shape[c, EY] = local[fe, 1]
        shape[c, TX] = local_tangent[fe, 0]
        shape[c, TY] = local_tangent[fe, 1]
        shape[c, R_O] = radius_o
        shape[c, R_SUM] = radius_e + radius_o
        shape[c, ROUND] = 1.0 if meets[k, KIND] == VERTICES else 0.0
        area = value[k, SIZE] * thickness
        row = of_pair[p, LAW]
        law[c, L_KN] = laws[row, KN] * area
        law[c, L_KS] = laws[row, KS] * area
        law[c, L_MU] = laws[row, MU]
        law[c, L_TAN_PSI] = laws[row, TAN_PSI]
        law[c, L_BOND] = laws[row, COHESION] * area
        law[c, L_TENSION] = laws[row, TENSION] * area
        law[c, L_END] = laws[row, DILATANCY_END]
        for h in range(4):
            contacts.history[c, h] = history[k, h]
        contacts.reaction[c, 0] = 0.0
        contacts.reaction[c, 1] = 0.0
        contacts.status[c] = OPEN
        c += 1
    return c


@njit(cache=True)
def unpack(contacts, n_contacts, loads, motion, slots, pairs, history, reaction, status):
    """Write what the cycles made of the contacts back to the slots: geometry, history, reaction."""
    turn, pose, centroid = motion.turn, motion.pose, loads.centroid
    shape, pair, of_pair, value = contacts.shape, pairs.of_slot, pairs.which, slots.value
    history[:] = 0.0
    reaction[:] = 0.0
    status[:] = OPEN
    for c in range(n_contacts):
        k, e, o = contacts.slot[c], contacts.edge[c], contacts.other[c]
        ce, se, co, so = turn[e, 0], turn[e, 1], turn[o, 0], turn[o, 1]
        ox = co * shape[c, OX] - so * shape[c, OY]
        oy = so * shape[c, OX] + co * shape[c, OY]
        ex = ce * shape[c, EX] - se * shape[c, EY]
        ey = se * shape[c, EX] + ce * shape[c, EY]
        xe, ye = centroid[e, 0] + pose[e, 0], centroid[e, 1] + pose[e, 1]
        xo, yo = centroid[o, 0] + pose[o, 0], centroid[o, 1] + pose[o, 1]
        dx = xo + ox - xe - ex
        dy = yo + oy - ye - ey
        if shape[c, ROUND] == 0.0:
            nx = se * shape[c, TX] + ce * shape[c, TY]
            ny = -(ce * shape[c, TX] - se * shape[c, TY])
            value[k, GAP] = nx * dx + ny * dy - shape[c, R_SUM]
            ex += dx
            ey += dy
        else:
            distance = np.sqrt(dx * dx + dy * dy)
            nx = dx / distance
            ny = dy / distance
            value[k, GAP] = distance - shape[c, R_SUM]
            value[k, RATIO] = shape[c, R_SUM] / distance
        if e == of_pair[pair[k], A]:
            value[k, NORMAL], value[k, NORMAL + 1] = nx, ny
            value[k, ARM_A], value[k, ARM_A + 1] = ex, ey
            value[k, ARM_B], value[k, ARM_B + 1] = ox, oy
        else:
            value[k, NORMAL], value[k, NORMAL + 1] = -nx, -ny
            value[k, ARM_A], value[k, ARM_A + 1] = ox, oy
            value[k, ARM_B], value[k, ARM_B + 1] = ex, ey
        for h in range(4):
            history[k, h] = contacts.history[c, h]
        reaction[k, 0] = contacts.reaction[c, 0]
        reaction[k, 1] = contacts.reaction[c, 1]
        status[k] = contacts.status[c]


@njit(cache=True)
def stiffness_blocks(slots, pairs, laws, thickness, watched, blocks):
    """Add 2 sum k h h^T over the contacts of each body, (n, n_dof, n_dof), h = grad gap, grad slip.

    Contacts open by more than ``watched`` [m] are left out.
    """
    meets, value = slots
    pair, of_pair = pairs.of_slot, pairs.which
    rows = np.zeros((1, 2, 2 * N_DOF))
    for k in range(meets.shape[0]):
        if meets[k, KIND] == NONE or value[k, GAP] > watched:
            continue
        p = pair[k]
        area = value[k, SIZE] * thickness
        kn = 2.0 * laws[of_pair[p, LAW], KN] * area
        ks = 2.0 * laws[of_pair[p, LAW], KS] * area
        gradients(value, k, rows, 0)
        for side in range(2):
            body, at = (of_pair[p, A], 0) if side == 0 else (of_pair[p, B], N_DOF)
            for i in range(N_DOF):
                of_gap, of_slip = kn * rows[0, OF_GAP, at + i], ks * rows[0, OF_SLIP, at + i]
                for j in range(i, N_DOF):
                    gap_j, slip_j = rows[0, OF_GAP, at + j], rows[0, OF_SLIP, at + j]
                    blocks[body, i, j] += of_gap * gap_j + of_slip * slip_j
    for body in range(blocks.shape[0]):
        for i in range(N_DOF):
            for j in range(i):
                blocks[body, i, j] = blocks[body, j, i]


class Drive(NamedTuple):
    """How cycles are driven, and when they end."""

    dt: float  # s
    multiplier: float  # load multiplier; where guided only a start
    bonds_hold: bool  # whatever they carry: waves on the way to rest break none that rest would not
    guided: bool  # see `cycle`
    rate: float  # N m/s, F.v of the guided pattern
    combined: bool  # damping is combined, see `cycle`
    local_damping: float  # share of the unbalanced force
    viscous_damping: float  # 1/s by which velocities are damped, in proportion to mass
    tolerance: float  # N, `BALANCED` when no unbalanced force, or moment over extent, exceeds it;
    # negative: never
    reach: float  # m, `MOVED` when a body has moved so far from where it was searched


@njit(cache=True, inline="always")
def _act(contacts, n_contacts, motion, loads, dt, bonds_hold, friction_work):
    """Add the contacts' forces on the bodies, with their law; returns the friction's work [J],
    which is added to what it was."""
    edge, other, shape, law = contacts.edge, contacts.other, contacts.shape, contacts.law
    history, reaction, status = contacts.history, contacts.reaction, contacts.status
    pose, velocity, turn, force = motion.pose, motion.velocity, motion.turn, motion.force
    centroid = loads.centroid
    for c in range(n_contacts):
        e = edge[c]
        o = other[c]
        ce = turn[e, 0]
        se = turn[e, 1]
        co = turn[o, 0]
        so = turn[o, 1]
        ox = co * shape[c, OX] - so * shape[c, OY]
        oy = so * shape[c, OX] + co * shape[c, OY]
        ex = ce * shape[c, EX] - se * shape[c, EY]
        ey = se * shape[c, EX] + ce * shape[c, EY]
        dx = (centroid[o, 0] - centroid[e, 0]) + (pose[o, 0] - pose[e, 0]) + ox - ex
        dy = (centroid[o, 1] - centroid[e, 1]) + (pose[o, 1] - pose[e, 1]) + oy - ey
        if shape[c, ROUND] == 0.0:
            nx = se * shape[c, TX] + ce * shape[c, TY]
            ny = se * shape[c, TY] - ce * shape[c, TX]
            gap = nx * dx + ny * dy - shape[c, R_SUM]
            ex += dx
            ey += dy
            q = 1.0
            roll_o = shape[c, R_O]
            roll_e = -roll_o
        else:
            distance = np.sqrt(dx * dx + dy * dy)
            nx = dx / distance
            ny = dy / distance
            gap = distance - shape[c, R_SUM]
            q = shape[c, R_SUM] / distance
            roll_o = shape[c, R_O]
            roll_e = shape[c, R_SUM] - roll_o
        rn = law[c, L_KN] * (history[c, DILATION] - gap)
        bonded = history[c, BROKEN] == 0.0
        held = bonded and bonds_hold and law[c, L_BOND] + law[c, L_TENSION] > 0.0
        if not held:
            is_open, whole = opens(rn, gap, law[c, L_TENSION], bonded)
            if bonded and not whole:
                history[c, BROKEN] = 1.0
            if is_open:
                rt = history[c, SHEAR]
                if rt != 0.0 or status[c] != OPEN:
                    friction_work += 0.5 * rt * rt / law[c, L_KS]
                    history[c, SHEAR] = 0.0
                    reaction[c, 0] = 0.0
                    reaction[c, 1] = 0.0
                    status[c] = OPEN
                continue
        # Moments per unit of normal and of tangential reaction.
        me_n = nx * ey - ny * ex
        mo_n = ny * ox - nx * oy
        me_t = q * (ny * ey + nx * ex) + roll_e
        mo_t = roll_o - q * (ny * oy + nx * ox)
        slip = q * (ny * (velocity[o, 0] - velocity[e, 0]) - nx * (velocity[o, 1] - velocity[e, 1]))
        slip += me_t * velocity[e, 2] + mo_t * velocity[o, 2]
        ks = law[c, L_KS]
        trial = history[c, SHEAR] - ks * dt * slip
        rt, now = trial, STICKING
        if not held:
            tan_psi = law[c, L_TAN_PSI] if history[c, SLID] < law[c, L_END] else 0.0
            bond = law[c, L_BOND] if bonded else 0.0
            rn, rt, now, gamma = drag(rn, trial, bond, law[c, L_KN], ks, law[c, L_MU], tan_psi)
            if now != STICKING:
                history[c, BROKEN] = 1.0
            if now == OPEN:
                friction_work += 0.5 * trial * trial / ks
            elif now == SLIDING:
                history[c, DILATION] += tan_psi * gamma
                history[c, SLID] += gamma
                # What sliding takes, less what it gives back by lifting the joint.
                friction_work += (abs(rt) - rn * tan_psi) * gamma
        history[c, SHEAR] = rt
        reaction[c, 0] = rn
        reaction[c, 1] = rt
        status[c] = now
        if now == OPEN:
            continue
        fx = rn * nx + q * rt * ny
        fy = rn * ny - q * rt * nx
        force[o, 0] += fx
        force[o, 1] += fy
        force[o, 2] += rn * mo_n + rt * mo_t
        force[e, 0] -= fx
        force[e, 1] -= fy
        force[e, 2] += rn * me_n + rt * me_t
    return friction_work


@njit(cache=True, inline="always")
def _accelerate(motion, loads, drive, applied, look, damping_work):
    """Bring velocities on by the unbalanced forces, damped.

    Returns the damping's work [J], added to what it was, F.v, and the square of the largest
    unbalanced force [N2] where there is a ``look`` at it.
    """
    velocity, force, last = motion.velocity, motion.force, motion.last
    mean, opposed = motion.mean, motion.opposed
    pattern, inverse_mass, extent = loads.pattern, loads.inverse_mass, loads.extent
    dt, viscous_damping = drive.dt, drive.viscous_damping
    local_damping, combined = drive.local_damping, drive.combined
    keep = (1.0 - 0.5 * viscous_damping * dt) / (1.0 + 0.5 * viscous_damping * dt)
    push = dt / (1.0 + 0.5 * viscous_damping * dt)
    worst, course = 0.0, 0.0
    for i in range(force.shape[0]):
        for d in range(N_DOF):
            force[i, d] += applied * pattern[i, d]
            mean[i, d] += force[i, d]
        if inverse_mass[i, 0] == 0.0:
            continue
        if look:
            worst = max(
                worst,
                force[i, 0] * force[i, 0] + force[i, 1] * force[i, 1],
                (force[i, 2] / extent[i]) ** 2,
            )
        for d in range(N_DOF):
            f = force[i, d]
            v = velocity[i, d]
            sense = 0.0
            if v > 0.0:
                sense = -1.0
            elif v < 0.0:
                sense = 1.0
            if combined:
                if f > last[i, d]:
                    sense = 0.5 * (sense + 1.0)
                elif f < last[i, d]:
                    sense = 0.5 * (sense - 1.0)
                last[i, d] = f
            f += sense * local_damping * abs(f)
            new = keep * v + push * inverse_mass[i, d] * f
            course += pattern[i, d] * new
            velocity[i, d] = new
            middle = 0.5 * (v + new) * dt
            damping_work += (force[i, d] - f) * middle
            braked = viscous_damping * 0.5 * (v + new) / inverse_mass[i, d]
            damping_work += braked * middle
            opposed[i, d] += (new - v) / (inverse_mass[i, d] * dt) + force[i, d] - f + braked
    return damping_work, course, worst


@njit(cache=True, inline="always")
def _move(motion, loads, origin, drive, applied, steer, load_work):
    """Bring poses on by velocities, which are steered first where they are guided.

    Returns the loads' work [J], added to what it was, and whether a body is too far from its
    ``origin``, or lost.
    """
    pose, velocity, turn = motion.pose, motion.velocity, motion.turn
    dead, pattern, inverse_mass = loads.dead, loads.pattern, loads.inverse_mass
    extent = loads.extent
    dt, guided, reach = drive.dt, drive.guided, drive.reach
    moved = False
    for i in range(pose.shape[0]):
        if inverse_mass[i, 0] == 0.0:
            continue
        if guided:
            for d in range(N_DOF):
                velocity[i, d] += steer * inverse_mass[i, d] * pattern[i, d]
        for d in range(N_DOF):
            step = velocity[i, d] * dt
            load_work += (dead[i, d] + applied * pattern[i, d]) * step
            pose[i, d] += step
        half = 0.5 * velocity[i, 2] * dt
        # Cayley's rotation by 2 atan(half): exact but for half^3.
        scale = 1.0 / (1.0 + half * half)
        cosine = (1.0 - half * half) * scale
        sine = 2.0 * half * scale
        c_old = turn[i, 0]
        turn[i, 0] = cosine * c_old - sine * turn[i, 1]
        turn[i, 1] = sine * c_old + cosine * turn[i, 1]
        far = abs(pose[i, 0] - origin[i, 0]) + abs(pose[i, 1] - origin[i, 1])
        far += extent[i] * abs(pose[i, 2] - origin[i, 2])
        moved = moved or not far <= reach  # nor where it is not a number
    return load_work, moved


@njit(cache=True)
def cycle(contacts, n_contacts, motion, loads, origin, drive, n_cycles, meter):
    """Run cycles in place until one of three things happens; returns what, and the cycles run.

    Where they are guided, the multiplier is the force that keeps the pattern's own displacement on
    its course: F.v is the rate given at every half step.  From M a = f + lambda F and F.a = 0,
    lambda = -F.M^-1 f / F.M^-1 F.

    Local damping is a share of the unbalanced force that is taken off where it drives the motion,
    and added where it brakes it (Cundall's damping), for every degree of freedom by itself:
    - alpha |f| sgn(v).  Combined, it is alpha |f| (sgn(df) - sgn(v)) / 2, which damps what vibrates
    upon a steady motion, and brakes the motion itself less.

    Parameters
    ----------
    contacts, n_contacts
        See `pack`.
    motion, loads
        `Motion` and `Loads`.
    origin
        (n, n_dof) poses at the last search.
    drive
        `Drive`.
    n_cycles
        Return `DONE` after so many.
    meter
        (N_METER,) multiplier of the last cycle; work done by friction, damping and loads, added
        to [J]; largest unbalanced force when last looked at [N]; cycles so far.
    """
    force, dead, pattern, inverse_mass = motion.force, loads.dead, loads.pattern, loads.inverse_mass
    n, guided = force.shape[0], drive.guided
    flexibility = 0.0
    for i in range(n):
        for d in range(N_DOF):
            flexibility += pattern[i, d] * pattern[i, d] * inverse_mass[i, d]
    friction_work, damping_work, load_work = 0.0, 0.0, 0.0
    applied = drive.multiplier
    before = int(meter[CYCLES])
    for count in range(n_cycles):
        for i in range(n):
            for d in range(N_DOF):
                force[i, d] = dead[i, d]
        friction_work = _act(
            contacts, n_contacts, motion, loads, drive.dt, drive.bonds_hold, friction_work
        )
        if guided:
            driven = 0.0
            for i in range(n):
                for d in range(N_DOF):
                    driven += pattern[i, d] * inverse_mass[i, d] * force[i, d]
            applied = -driven / flexibility
        look = (before + count) % LOOK == LOOK - 1
        damping_work, course, worst = _accelerate(motion, loads, drive, applied, look, damping_work)
        steer = (drive.rate - course) / flexibility if guided else 0.0
        load_work, moved = _move(motion, loads, origin, drive, applied, steer, load_work)
        if look:
            meter[RESIDUAL] = np.sqrt(worst)
        balanced = look and worst <= drive.tolerance**2 and drive.tolerance > 0.0
        if moved or balanced or count == n_cycles - 1:
            meter[MULTIPLIER] = applied
            meter[FRICTION_WORK] += friction_work
            meter[DAMPING_WORK] += damping_work
            meter[LOAD_WORK] += load_work
            meter[CYCLES] += count + 1
            if balanced:
                return BALANCED, count + 1
            return (MOVED if moved else DONE), count + 1
    return DONE, 0
