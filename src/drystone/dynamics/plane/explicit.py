"""Contacts in the cycles of `dynamics.explicit`, in the plane: forces, and the update of poses.

For all kinds of contact, one of the two bodies, the *edge body* e, owns the normal, which points to
the *other body* o.  With arms from the centroids, t = (n_y, -n_x), S the quarter turn, q = 1 except
between two vertices, and rolling terms as in `contact.plane.narrow`,

    grad gap  = [-n, -n.S arm_e, n, n.S arm_o]
    grad slip = q [-t, -t.S arm_e, t, t.S arm_o] + [0, 0, roll_e, 0, 0, roll_o]
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.common.compiled import njit
from drystone.contact.contacts import (
    FEATURE_A,
    FEATURE_B,
    INSIDE,
    KIND,
    PART_A,
    PART_B,
    VERTEX_A,
    VERTICES,
    A,
    B,
)
from drystone.law.branches import OPEN
from drystone.law.columns import DILATION, KN, KS, SHEAR
from drystone.law.cycles import keeps_bond_in_cycle, open_in_cycle, opens_in_cycle, react_in_cycle

#: Columns of `explicit.FrozenContacts.shape`: local vertex of the other body [m]; local vertex [m]
#: and tangent of the edge body; radius of the other body, and sum of both radii [m]; 1 if two
#: vertices meet.
OX, OY, EX, EY, TX, TY, R_O, R_SUM, ROUND = 0, 1, 2, 3, 4, 5, 6, 7, 8
N_SHAPE = 9


class Rotations(NamedTuple):
    """Rotations of all bodies in their present poses."""

    direction: Array  # (n, 2) cosine and sine
    axes: Array  # (n, 2, 2) principal axes as designed, which are not used

    @classmethod
    def of(cls, axes: Array) -> Rotations:
        """Memory for bodies with these principal axes."""
        return cls(direction=np.zeros((len(axes), 2)), axes=np.ascontiguousarray(axes))


@njit(cache=True)
def freeze(slots, bodies, pairs, contacts, n_contacts):
    """Fill bodies and shape of ``contacts``, whose slots are known."""
    meets, value = slots
    local, local_tangent, radius = bodies.local, bodies.local_tangent, bodies.radius
    pair, of_pair = pairs.of_slot, pairs.which
    slot, edge, other, shape = contacts.slot, contacts.edge, contacts.other, contacts.shape
    for c in range(n_contacts):
        k = slot[c]
        p = pair[k]
        e, o, fe, fo = of_pair[p, A], of_pair[p, B], meets[k, FEATURE_A], meets[k, FEATURE_B]
        radius_e, radius_o = radius[of_pair[p, PART_A]], radius[of_pair[p, PART_B]]
        if meets[k, KIND] == VERTEX_A:
            e, o, fe, fo = o, e, fo, fe
            radius_e, radius_o = radius_o, radius_e
        edge[c] = e
        other[c] = o
        inside = value[k, INSIDE] * bodies.length[fo]
        shape[c, OX] = local[fo, 0] + inside * local_tangent[fo, 0]
        shape[c, OY] = local[fo, 1] + inside * local_tangent[fo, 1]
        shape[c, EX] = local[fe, 0]
        shape[c, EY] = local[fe, 1]
        shape[c, TX] = local_tangent[fe, 0]
        shape[c, TY] = local_tangent[fe, 1]
        shape[c, R_O] = radius_o
        shape[c, R_SUM] = radius_e + radius_o
        shape[c, ROUND] = 1.0 if meets[k, KIND] == VERTICES else 0.0


@njit(cache=True, inline="always")
def act(contacts, n_contacts, motion, loads, dt, keep_bonds, friction_work):
    """Evaluate the joint law of the contacts, and add their forces on the bodies; returns the
    accumulated work of friction [J]."""
    edge, other, shape, law = contacts.edge, contacts.other, contacts.shape, contacts.law
    history, reaction, status = contacts.history, contacts.reaction, contacts.status
    pose, velocity, force, cosines = (
        motion.pose,
        motion.velocity,
        motion.force,
        motion.rotation.direction,
    )
    centroid = loads.centroid
    for c in range(n_contacts):
        e = edge[c]
        o = other[c]
        ce = cosines[e, 0]
        se = cosines[e, 1]
        co = cosines[o, 0]
        so = cosines[o, 1]
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
        rn = law[c, KN] * (history[c, DILATION] - gap)
        kept = keeps_bond_in_cycle(law, history, c, keep_bonds)
        if opens_in_cycle(law, history, c, rn, gap, kept):
            if history[c, SHEAR] != 0.0 or status[c] != OPEN:
                friction_work += open_in_cycle(law, history, reaction, status, c)
            continue
        # Moments per unit of normal and of tangential reaction.
        me_n = nx * ey - ny * ex
        mo_n = ny * ox - nx * oy
        me_t = q * (ny * ey + nx * ex) + roll_e
        mo_t = roll_o - q * (ny * oy + nx * ox)
        slip = q * (ny * (velocity[o, 0] - velocity[e, 0]) - nx * (velocity[o, 1] - velocity[e, 1]))
        slip += me_t * velocity[e, 2] + mo_t * velocity[o, 2]
        trial = history[c, SHEAR] - law[c, KS] * dt * slip
        rn, rt, now, work = react_in_cycle(law, history, c, rn, gap, abs(trial), kept)
        friction_work += work
        rt = rt if trial >= 0.0 else -rt
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


def place(motion):
    """Calculate cosines and sines of the rotations of all bodies from their poses."""
    rotation = motion.pose[:, 2]
    motion.rotation.direction[:, 0] = np.cos(rotation)
    motion.rotation.direction[:, 1] = np.sin(rotation)


@njit(cache=True, inline="always")
def move(motion, loads, origin, dt, reach, gyroscopic):
    """Update the poses by the velocities; returns whether a body is farther than ``reach`` [m] from
    its ``origin`` (n, 3), or its pose is NaN.

    ``gyroscopic`` is used in space only.
    """
    pose, velocity, cosines = motion.pose, motion.velocity, motion.rotation.direction
    inverse_mass, extent = loads.inverse_mass, loads.extent
    moved = False
    for i in range(pose.shape[0]):
        driven = velocity[i, 0] != 0.0 or velocity[i, 1] != 0.0 or velocity[i, 2] != 0.0
        if inverse_mass[i, 0] == 0.0 and not driven:
            continue
        for d in range(3):
            pose[i, d] += velocity[i, d] * dt
        half = 0.5 * velocity[i, 2] * dt
        # Cayley's rotation by 2 atan(half); its error is of third order.
        scale = 1.0 / (1.0 + half * half)
        cosine = (1.0 - half * half) * scale
        sine = 2.0 * half * scale
        c_old = cosines[i, 0]
        cosines[i, 0] = cosine * c_old - sine * cosines[i, 1]
        cosines[i, 1] = sine * c_old + cosine * cosines[i, 1]
        far = abs(pose[i, 0] - origin[i, 0]) + abs(pose[i, 1] - origin[i, 1])
        far += extent[i] * abs(pose[i, 2] - origin[i, 2])
        moved = moved or not far <= reach  # also if it is NaN
    return moved
