"""Cycles of the distinct element method: forces from contacts, motion from forces, and again.

Semi-implicit Euler (central differences with velocities at half steps):

    v <- v + dt M^-1 (f - damping),        x <- x + dt v

Between two searches for contacts, the features of every contact stay the same: its vertex and edge,
or point and plane, and its tributary area.  The gap is then a function of the poses alone, and the
shear changes with the sliding velocity,

    r_n = k_n (d - g)          r_t <- r_t - k_s dt (grad slip . v)

with dilation d.  The shear is kept in the axes of the contact, and turns with them.  The joint law
is that of `law.return_map`.  Contacts and poses differ between plane and space.  Their kernels are
in `plane.explicit` and `space.explicit`, which have the same functions.  A run chooses between them
with `form_of`, compiled cycles by the length of ``dof``.
"""

from __future__ import annotations

from types import ModuleType
from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.contact.contacts import BODY_A, BODY_B, KIND, LAW, NONE, SIZE, STIFF_N, STIFF_T
from drystone.contact.rows import OF_GAP, OF_SLIP
from drystone.dynamics.plane import explicit as plane
from drystone.dynamics.space import explicit as space
from drystone.law.branches import OPEN
from drystone.law.columns import N_HISTORY, N_LAW, PER_AREA
from drystone.model.tie_kernels import add_forces, age, locate

#: Entries of the meter, see `cycle`.
MULTIPLIER, FRICTION_WORK, DAMPING_WORK, LOAD_WORK, RESIDUAL, CYCLES = 0, 1, 2, 3, 4, 5
N_METER = 6

#: Why `cycle` returned: all cycles are done; a body has moved far; all forces balance.
DONE, MOVED, BALANCED = 0, 1, 2

#: Cycles between two evaluations of the residual.
LOOK = 25


def form_of(dof: tuple[int, ...]) -> ModuleType:
    """The module of the dimension: `plane.explicit` or `space.explicit`."""
    return plane if len(dof) == 3 else space


class FrozenContacts(NamedTuple):
    """Contacts between two searches, packed; row c belongs to ``slot[c]``."""

    slot: IntArray  # (n_contacts,)
    edge: IntArray  # (n_contacts,) body that owns the normal
    other: IntArray  # (n_contacts,) the other body
    shape: Array  # (n_contacts, N_SHAPE), of `form_of`
    law: Array  # (n_contacts, N_LAW), as the table of laws; see `PER_AREA`
    history: Array  # (n_contacts, N_HISTORY + dim - 2)
    reaction: Array  # (n_contacts, dim) N
    status: IntArray  # (n_contacts,)

    @classmethod
    def empty(cls, n: int, dim: int, n_shape: int) -> FrozenContacts:
        """Memory for ``n`` contacts."""
        return cls(
            slot=np.zeros(n, np.int64),
            edge=np.zeros(n, np.int64),
            other=np.zeros(n, np.int64),
            shape=np.zeros((n, n_shape)),
            law=np.zeros((n, N_LAW)),
            history=np.zeros((n, N_HISTORY + dim - 2)),
            reaction=np.zeros((n, dim)),
            status=np.zeros(n, np.int64),
        )


class Motion(NamedTuple):
    """The variables that evolve in the cycles."""

    pose: Array  # (n, n_pose) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s, half a step behind the pose
    rotation: plane.Rotations | space.Rotations
    force: Array  # (n, n_dof) N, N m, unbalanced, of the last cycle
    last: Array  # (n, n_dof) N, N m, unbalanced, of the last cycle with combined damping
    mean: Array  # (n, n_dof) sum of the unbalanced forces over the cycles
    opposed: Array  # (n, n_dof) sum over the cycles of the forces of inertia and damping

    @classmethod
    def of(
        cls, pose: Array, velocity: Array, rotation: plane.Rotations | space.Rotations
    ) -> Motion:
        """The variables from copies of poses (n, n_pose) and velocities (n, n_dof)."""
        sums = (np.zeros_like(velocity) for _ in range(4))
        return cls(pose.copy(), velocity.copy(), rotation, *sums)


class Loads(NamedTuple):
    """The data that do not change in the cycles."""

    centroid: Array  # (n, dim) m, as designed
    dead: Array  # (n, n_dof) N, N m
    pattern: Array  # (n, n_dof) N, N m, at multiplier one
    inverse_mass: Array  # (n, n_dof) zero on fixed bodies
    extent: Array  # (n,) m, by which moments are divided and rotations multiplied
    weight: Array  # (n,) N, by which unbalanced forces are divided


@njit(cache=True)
def _pack(slots, pairs, laws, thickness, history, contacts):
    """Fill slots, laws and histories of ``contacts``; returns their number."""
    meets, value = slots
    pair, of_pair = pairs.of_slot, pairs.which
    slot, law, known = contacts.slot, contacts.law, contacts.history
    reaction, status = contacts.reaction, contacts.status
    c = 0
    for k in range(meets.shape[0]):
        if meets[k, KIND] == NONE:
            continue
        slot[c] = k
        area = value[k, SIZE] * thickness
        row = of_pair[pair[k], LAW]
        for h in range(N_LAW):
            law[c, h] = laws[row, h]
        for h in PER_AREA:
            law[c, h] *= area
        for h in range(known.shape[1]):
            known[c, h] = history[k, h]
        for d in range(reaction.shape[1]):
            reaction[c, d] = 0.0
        status[c] = OPEN
        c += 1
    return c


@njit(cache=True)
def unpack(contacts, n_contacts, history, reaction, status):
    """Copy histories, reactions and status of the contacts to their slots."""
    slot = contacts.slot
    history[:] = 0.0
    reaction[:] = 0.0
    status[:] = OPEN
    for c in range(n_contacts):
        k = slot[c]
        for h in range(history.shape[1]):
            history[k, h] = contacts.history[c, h]
        for d in range(reaction.shape[1]):
            reaction[k, d] = contacts.reaction[c, d]
        status[k] = contacts.status[c]


def pack(form, slots, bodies, pairs, laws, thickness, history, contacts):
    """Fill ``contacts`` from the slots in use and return their number."""
    n_contacts = _pack(slots, pairs, laws, thickness, history, contacts)
    form.freeze(slots, bodies, pairs, contacts, n_contacts)
    return n_contacts


@njit(cache=True)
def stiffness_blocks(dof, contacts, acts, blocks):
    """Add 2 sum k h h^T over the contacts of each body to ``blocks`` (n, n_dof, n_dof); h are the
    gradients of gap and slips.

    Only contacts that are true in ``acts`` (n_contacts,) count.
    """
    n_dof = len(dof)
    which, rows, table = contacts
    n_rows = (rows.shape[1] + 1) // 2  # of gap and slips
    for c in range(which.shape[0]):
        if not acts[c]:
            continue
        kn, ks = 2.0 * table[c, STIFF_N], 2.0 * table[c, STIFF_T]
        for side in range(2):
            body, at = (which[c, BODY_A], 0) if side == 0 else (which[c, BODY_B], n_dof)
            for i in range(n_dof):
                for j in range(i, n_dof):
                    stiffness = kn * rows[c, OF_GAP, at + i] * rows[c, OF_GAP, at + j]
                    for slip in range(OF_SLIP, n_rows):
                        stiffness += ks * rows[c, slip, at + i] * rows[c, slip, at + j]
                    blocks[body, i, j] += stiffness
    for body in range(blocks.shape[0]):
        for i in range(n_dof):
            for j in range(i):
                blocks[body, i, j] = blocks[body, j, i]


class Drive(NamedTuple):
    """How cycles are driven, and when they end."""

    dt: float  # s
    multiplier: float  # load multiplier; if guided, only its start
    # Whether bonds stay intact: vibrations must not break bonds that would bear the load at rest.
    keep_bonds: bool
    guided: bool  # see `cycle`
    rate: float  # N m/s, F.v if guided
    combined: bool  # whether damping is combined, see `cycle`
    local_damping: float  # share of the unbalanced force
    viscous_damping: float  # 1/s, damping of velocities in proportion to mass
    # Largest unbalanced force of a block, or moment over extent, over its weight, at which cycles
    # end as `BALANCED`; negative: never.
    tolerance: float
    reach: float  # m, motion of a body since the last search at which cycles end as `MOVED`
    gyroscopic: bool  # in space: whether bodies rotate with their real moments of inertia


@njit(cache=True, inline="always")
def _accelerate(n_dof, motion, loads, drive, applied, look, damping_work):
    """Update the velocities by the damped unbalanced forces.

    Returns the accumulated work of damping [J]; F.v [N m/s]; and, with ``look``, the square of the
    largest unbalanced force over the block's weight.
    """
    velocity, force, last = motion.velocity, motion.force, motion.last
    mean, opposed = motion.mean, motion.opposed
    pattern, inverse_mass = loads.pattern, loads.inverse_mass
    extent, weight = loads.extent, loads.weight
    dt, viscous_damping = drive.dt, drive.viscous_damping
    local_damping, combined = drive.local_damping, drive.combined
    keep = (1.0 - 0.5 * viscous_damping * dt) / (1.0 + 0.5 * viscous_damping * dt)
    push = dt / (1.0 + 0.5 * viscous_damping * dt)
    dim = loads.centroid.shape[1]
    worst, course = 0.0, 0.0
    for i in range(force.shape[0]):
        for d in range(n_dof):
            force[i, d] += applied * pattern[i, d]
            mean[i, d] += force[i, d]
        if inverse_mass[i, 0] == 0.0:
            continue
        if look:
            straight, turning = 0.0, 0.0
            for d in range(n_dof):
                if d < dim:
                    straight += force[i, d] * force[i, d]
                else:
                    turning += (force[i, d] / extent[i]) ** 2
            worst = max(worst, max(straight, turning) / weight[i] ** 2)
        for d in range(n_dof):
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
def _steer(n_dof, motion, loads, drive, applied, steer, load_work):
    """Correct the velocities by ``steer`` times M^-1 F if they are guided; returns the accumulated
    work of the loads [J]."""
    velocity, dt, guided = motion.velocity, drive.dt, drive.guided
    dead, pattern, inverse_mass = loads.dead, loads.pattern, loads.inverse_mass
    for i in range(velocity.shape[0]):
        if inverse_mass[i, 0] == 0.0:
            continue
        if guided:
            for d in range(n_dof):
                velocity[i, d] += steer * inverse_mass[i, d] * pattern[i, d]
        for d in range(n_dof):
            step = velocity[i, d] * dt
            load_work += (dead[i, d] + applied * pattern[i, d]) * step
    return load_work


@njit(cache=True)
def cycle(dof, contacts, n_contacts, motion, loads, origin, drive, n_cycles, meter, ties):
    """Run cycles in place until one of three events; returns the event and the cycles run.

    If cycles are guided, the multiplier is the unknown force that keeps F.v, the velocity along the
    load pattern F, at the given rate at every half step.  From M a = f + lambda F and F.a = 0,
    lambda = -F.M^-1 f / F.M^-1 F.

    Local damping (Cundall) is a share of the unbalanced force, separately for every degree of
    freedom: - alpha |f| sgn(v).  It is subtracted from a force that drives the motion, and added to
    a force that brakes it.  Combined damping is alpha |f| (sgn(df) - sgn(v)) / 2.  It damps
    vibrations about a steady motion, and brakes the motion itself less.

    Parameters
    ----------
    dof
        `rows.IN_PLANE` or `rows.IN_SPACE`.
    contacts, n_contacts
        See `pack`.
    motion, loads
        `Motion` and `Loads`.
    origin
        (n, n_pose) poses at the last search.
    drive
        `Drive`.
    n_cycles
        Number of cycles after which `DONE` is returned.
    meter
        (N_METER,) multiplier of the last cycle; accumulated work of friction, damping and loads
        [J]; last evaluated largest unbalanced force over the block's weight; cycles so far.
    ties
        `model.tie_kernels.Ties`.  They yield and break in the cycles, unless bonds are kept.  If
        bonds are kept, yielding counts from the start of the cycles, so that vibrations have no
        lasting effect.
    """
    n_dof = len(dof)
    force, dead, pattern, inverse_mass = motion.force, loads.dead, loads.pattern, loads.inverse_mass
    n, guided, n_ties = force.shape[0], drive.guided, ties.body.shape[0]
    flexibility = 0.0
    for i in range(n):
        for d in range(n_dof):
            flexibility += pattern[i, d] * pattern[i, d] * inverse_mass[i, d]
    friction_work, damping_work, load_work = 0.0, 0.0, 0.0
    applied = drive.multiplier
    before = int(meter[CYCLES])
    for count in range(n_cycles):
        for i in range(n):
            for d in range(n_dof):
                force[i, d] = dead[i, d]
        if len(dof) == 3:
            friction_work = plane.act(
                contacts, n_contacts, motion, loads, drive.dt, drive.keep_bonds, friction_work
            )
        else:
            friction_work = space.act(
                contacts, n_contacts, motion, loads, drive.dt, drive.keep_bonds, friction_work
            )
        if n_ties > 0:
            locate(ties.body, ties.value, motion.pose, ties.now)
            add_forces(ties.body, ties.now, motion.rotation.axes, force)
            if not drive.keep_bonds:
                friction_work += age(ties.value, ties.now)
        if guided:
            driven = 0.0
            for i in range(n):
                for d in range(n_dof):
                    driven += pattern[i, d] * inverse_mass[i, d] * force[i, d]
            applied = -driven / flexibility
        look = (before + count) % LOOK == LOOK - 1
        damping_work, course, worst = _accelerate(
            n_dof, motion, loads, drive, applied, look, damping_work
        )
        steer = (drive.rate - course) / flexibility if guided else 0.0
        load_work = _steer(n_dof, motion, loads, drive, applied, steer, load_work)
        if len(dof) == 3:
            moved = plane.move(motion, loads, origin, drive.dt, drive.reach, drive.gyroscopic)
        else:
            moved = space.move(motion, loads, origin, drive.dt, drive.reach, drive.gyroscopic)
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
