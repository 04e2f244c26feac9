"""Contacts in the cycles of `dynamics.explicit`, in space: forces, and the update of poses.

Every contact is a material point of the *other body* o against a plane that the *edge body* e
carries along; the names are those of the plane.  With the local data of `contacts.Slots`, d_0 the
designed vector from the plane's place to the point, n_0 the designed normal of the plane, R_e and
R_o the rotations,

    D = u_o - u_e + (R_o - I) point - (R_e - I) place
    gap = n_0 . d_0 - radii + (R_e - I) n_0 . (d_0 + D) + n_0 . D

This is as precise as the displacements.  The shear is kept along the two tangents of the plane,
which turn with it, and changes with the velocity of o relative to e where they touch.  Forces act
at this place on both bodies, so that they balance in force and in moment.

Rotations are about the principal axes of the bodies.  The rotational velocity w that is stored
belongs to the angular momentum l = I w half a step before the pose, with components along the
present axes.  With the moments of inertia I, the moments M of the forces, and exp(v) the rotation
by a vector v:

    l <- l + dt M                       as for any other velocity
    exp(s dt / 2) I s = l               gives s; the body rotates by exp(s dt)
    l <- exp(-s dt) l                   is the same vector along the new axes

So a free body keeps its angular momentum to rounding, and its energy to second order without drift,
because the scheme is reversible in time.  If masses are scaled, the motion has no meaning, and the
body simply rotates by w.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array
from drystone.common.compiled import njit
from drystone.contact.contacts import (
    BALL_3,
    KIND,
    PART_A,
    PART_B,
    PLACE_3,
    PLANE_NORMAL_3,
    PLANE_TANGENT_3,
    POINT_3,
    VERTEX_A,
    A,
    B,
)
from drystone.geometry.rotation import fill_rotation, rotated, spin
from drystone.law.branches import OPEN, STICKING
from drystone.law.columns import DILATION, KN, KS, SHEAR
from drystone.law.cycles import keeps_bond_in_cycle, open_in_cycle, opens_in_cycle, react_in_cycle

#: Columns of `explicit.FrozenContacts.shape`, for vectors the first: point of the other body;
#: place, normal and first tangent of the plane; designed vector from the place to the point [m];
#: designed gap [m]; distance of the other body's surface beyond the point [m]; 1 if the other body
#: is b, else -1.  If it is a, the tangent is reversed, so that shear always moves the other body.
POINT, PLACE, NORMAL, TANGENT, DESIGNED, DESIGN_GAP, BALL, SENSE = 0, 3, 6, 9, 12, 15, 16, 17
N_SHAPE = 18

#: Largest number of iterations for the rotational velocity; each gains some digits.
TURNING = 30


class Rotations(NamedTuple):
    """Rotations of all bodies in their present poses, and scratch memory."""

    added: Array  # (n, 3, 3) rotation less identity
    axes: Array  # (n, 3, 3) columns are the principal axes
    designed: Array  # (n, 3, 3) the same as designed
    spin: Array  # (n, 3) rad/s, rotational velocities along the axes of the world
    moment: Array  # (n, 3) N m, of the contacts, along the axes of the world

    @classmethod
    def of(cls, axes: Array) -> Rotations:
        """Memory for bodies with designed principal axes, the columns of ``axes`` (n, 3, 3)."""
        n = len(axes)
        return cls(
            added=np.zeros((n, 3, 3)),
            axes=np.zeros((n, 3, 3)),
            designed=np.ascontiguousarray(axes, np.float64),
            spin=np.zeros((n, 3)),
            moment=np.zeros((n, 3)),
        )


def freeze(slots, bodies, pairs, contacts, n_contacts):
    """Fill bodies and shape of ``contacts``, whose slots are known."""
    _freeze(slots, bodies.centroid, bodies.radius, pairs, contacts, n_contacts)


@njit(cache=True)
def _freeze(slots, centroid, radius, pairs, contacts, n_contacts):
    """See `freeze`; ``centroid`` (n, 3) [m] of the bodies, ``radius`` (n_parts,) [m] of parts."""
    meets, value = slots
    pair, of_pair = pairs.of_slot, pairs.which
    slot, edge, other, shape = contacts.slot, contacts.edge, contacts.other, contacts.shape
    for c in range(n_contacts):
        k = slot[c]
        p = pair[k]
        e, o, sense = of_pair[p, A], of_pair[p, B], 1.0
        if meets[k, KIND] == VERTEX_A:
            e, o, sense = o, e, -1.0
        edge[c] = e
        other[c] = o
        design_gap = 0.0
        for d in range(3):
            point, place = value[k, POINT_3 + d], value[k, PLACE_3 + d]
            designed = centroid[o, d] - centroid[e, d] + (point - place)
            design_gap += value[k, PLANE_NORMAL_3 + d] * designed
            shape[c, POINT + d] = point
            shape[c, PLACE + d] = place
            shape[c, NORMAL + d] = value[k, PLANE_NORMAL_3 + d]
            shape[c, TANGENT + d] = sense * value[k, PLANE_TANGENT_3 + d]
            shape[c, DESIGNED + d] = designed
        shape[c, DESIGN_GAP] = design_gap - radius[of_pair[p, PART_A]] - radius[of_pair[p, PART_B]]
        shape[c, BALL] = value[k, BALL_3]
        shape[c, SENSE] = sense


@njit(cache=True, inline="always")
def _rotated(added, body, x, y, z):
    """Change of a designed vector (x, y, z) of a body by its rotation."""
    return (
        added[body, 0, 0] * x + added[body, 0, 1] * y + added[body, 0, 2] * z,
        added[body, 1, 0] * x + added[body, 1, 1] * y + added[body, 1, 2] * z,
        added[body, 2, 0] * x + added[body, 2, 1] * y + added[body, 2, 2] * z,
    )


@njit(cache=True)
def place(motion):
    """Calculate the rotations and axes of all bodies from their poses."""
    for i in range(motion.pose.shape[0]):
        _place(
            motion.pose, i, motion.rotation.added, motion.rotation.axes, motion.rotation.designed
        )


@njit(cache=True, inline="always")
def _place(pose, i, added, axes, designed):
    """Fill the rotation less identity and the axes of body i."""
    fill_rotation(pose, i, added)
    for d in range(3):
        for j in range(3):
            rotated = added[i, d, 0] * designed[i, 0, j] + added[i, d, 1] * designed[i, 1, j]
            axes[i, d, j] = designed[i, d, j] + (rotated + added[i, d, 2] * designed[i, 2, j])


# Long: one pass over a contact's geometry, law and forces, without the cost of calls.
@njit(cache=True)
def act(contacts, n_contacts, motion, loads, dt, keep_bonds, friction_work):
    """Evaluate the joint law of the contacts, and add their forces on the bodies; returns the
    accumulated work of friction [J]."""
    edge, other, shape, law = contacts.edge, contacts.other, contacts.shape, contacts.law
    history, reaction, status = contacts.history, contacts.reaction, contacts.status
    pose, velocity, force, centroid = motion.pose, motion.velocity, motion.force, loads.centroid
    added, axes = motion.rotation.added, motion.rotation.axes
    spins, moment = motion.rotation.spin, motion.rotation.moment
    _spins(velocity, axes, spins, moment)
    for c in range(n_contacts):
        e = edge[c]
        o = other[c]
        ball = shape[c, BALL]
        px, py, pz = shape[c, POINT], shape[c, POINT + 1], shape[c, POINT + 2]
        hx, hy, hz = shape[c, NORMAL], shape[c, NORMAL + 1], shape[c, NORMAL + 2]
        ox, oy, oz = _rotated(added, o, px, py, pz)
        ex, ey, ez = _rotated(added, e, shape[c, PLACE], shape[c, PLACE + 1], shape[c, PLACE + 2])
        nx, ny, nz = _rotated(added, e, hx, hy, hz)
        ux, uy, uz = pose[o, 0] - pose[e, 0], pose[o, 1] - pose[e, 1], pose[o, 2] - pose[e, 2]
        dx, dy, dz = ux + (ox - ex), uy + (oy - ey), uz + (oz - ez)
        gap = nx * (shape[c, DESIGNED] + dx) + ny * (shape[c, DESIGNED + 1] + dy)
        gap += nz * (shape[c, DESIGNED + 2] + dz)
        gap = shape[c, DESIGN_GAP] + (gap + (hx * dx + hy * dy + hz * dz))
        rn = law[c, KN] * (history[c, DILATION] - gap)
        kept = keeps_bond_in_cycle(law, history, c, keep_bonds)
        r1, r2 = history[c, SHEAR], history[c, SHEAR + 1]
        if opens_in_cycle(law, history, c, rn, gap, kept):
            if r1 != 0.0 or r2 != 0.0 or status[c] != OPEN:
                friction_work += open_in_cycle(law, history, reaction, status, c)
            continue
        nx, ny, nz = hx + nx, hy + ny, hz + nz
        ox, oy, oz = ox + px - ball * nx, oy + py - ball * ny, oz + pz - ball * nz
        ex = (centroid[o, 0] - centroid[e, 0]) + ux + ox
        ey = (centroid[o, 1] - centroid[e, 1]) + uy + oy
        ez = (centroid[o, 2] - centroid[e, 2]) + uz + oz
        tx, ty, tz = shape[c, TANGENT], shape[c, TANGENT + 1], shape[c, TANGENT + 2]
        hx, hy, hz = _rotated(added, e, tx, ty, tz)
        tx, ty, tz = tx + hx, ty + hy, tz + hz
        sense = shape[c, SENSE]
        sx, sy, sz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
        sx, sy, sz = sense * sx, sense * sy, sense * sz
        wx, wy, wz = spins[o, 0], spins[o, 1], spins[o, 2]
        vx = velocity[o, 0] - velocity[e, 0] + (wy * oz - wz * oy)
        vy = velocity[o, 1] - velocity[e, 1] + (wz * ox - wx * oz)
        vz = velocity[o, 2] - velocity[e, 2] + (wx * oy - wy * ox)
        wx, wy, wz = spins[e, 0], spins[e, 1], spins[e, 2]
        vx -= wy * ez - wz * ey
        vy -= wz * ex - wx * ez
        vz -= wx * ey - wy * ex
        ks = law[c, KS]
        trial_1 = r1 - ks * dt * (vx * tx + vy * ty + vz * tz)
        trial_2 = r2 - ks * dt * (vx * sx + vy * sy + vz * sz)
        size = np.sqrt(trial_1 * trial_1 + trial_2 * trial_2)
        rn, rt, now, work = react_in_cycle(law, history, c, rn, gap, size, kept)
        friction_work += work
        share = rt / size if now != STICKING and size > 0.0 else 1.0
        r1, r2 = share * trial_1, share * trial_2
        history[c, SHEAR], history[c, SHEAR + 1] = r1, r2
        reaction[c, 0], reaction[c, 1], reaction[c, 2] = rn, r1, r2
        status[c] = now
        if now == OPEN:
            continue
        fx = rn * nx + r1 * tx + r2 * sx
        fy = rn * ny + r1 * ty + r2 * sy
        fz = rn * nz + r1 * tz + r2 * sz
        force[o, 0] += fx
        force[o, 1] += fy
        force[o, 2] += fz
        force[e, 0] -= fx
        force[e, 1] -= fy
        force[e, 2] -= fz
        moment[o, 0] += oy * fz - oz * fy
        moment[o, 1] += oz * fx - ox * fz
        moment[o, 2] += ox * fy - oy * fx
        moment[e, 0] -= ey * fz - ez * fy
        moment[e, 1] -= ez * fx - ex * fz
        moment[e, 2] -= ex * fy - ey * fx
    _about_axes(moment, axes, force)
    return friction_work


@njit(cache=True)
def _spins(velocity, axes, spins, moment):
    """Fill the rotational velocities along the axes of the world, and set the moments to zero."""
    for i in range(velocity.shape[0]):
        x, y, z = velocity[i, 3], velocity[i, 4], velocity[i, 5]
        for d in range(3):
            spins[i, d] = axes[i, d, 0] * x + axes[i, d, 1] * y + axes[i, d, 2] * z
            moment[i, d] = 0.0


@njit(cache=True)
def _about_axes(moment, axes, force):
    """Add moments along the axes of the world to ``force`` (n, 6), about the bodies' own."""
    for i in range(force.shape[0]):
        x, y, z = moment[i, 0], moment[i, 1], moment[i, 2]
        for d in range(3):
            force[i, 3 + d] += axes[i, 0, d] * x + axes[i, 1, d] * y + axes[i, 2, d] * z


@njit(cache=True)
def _take_on(velocity, inverse_mass, i, dt):
    """Rotational velocity s of body i by which it rotates in a step; see the module's text."""
    wx, wy, wz = velocity[i, 3], velocity[i, 4], velocity[i, 5]
    jx, jy, jz = inverse_mass[i, 3], inverse_mass[i, 4], inverse_mass[i, 5]
    lx, ly, lz = wx / jx, wy / jy, wz / jz
    half, before = 0.5 * dt, np.inf
    for _ in range(TURNING):
        x, y, z = rotated(-half * wx, -half * wy, -half * wz, lx, ly, lz)
        x, y, z = jx * x, jy * y, jz * z
        change = abs(x - wx) + abs(y - wy) + abs(z - wz)
        wx, wy, wz = x, y, z
        if not change < before or change == 0.0:  # converged to rounding
            break
        before = change
    return wx, wy, wz


@njit(cache=True)
def _bring(velocity, inverse_mass, i, wx, wy, wz, dt):
    """Store the rotational velocity of body i along its axes after it has rotated by s dt, with s =
    (wx, wy, wz)."""
    jx, jy, jz = inverse_mass[i, 3], inverse_mass[i, 4], inverse_mass[i, 5]
    half = 0.5 * dt
    lx, ly, lz = rotated(-half * wx, -half * wy, -half * wz, wx / jx, wy / jy, wz / jz)
    velocity[i, 3], velocity[i, 4], velocity[i, 5] = jx * lx, jy * ly, jz * lz


@njit(cache=True)
def move(motion, loads, origin, dt, reach, gyroscopic):
    """Update the poses by the velocities; returns whether a body is farther than ``reach`` [m] from
    its ``origin`` (n, 7), or its pose is NaN."""
    pose, velocity = motion.pose, motion.velocity
    added, axes, designed = motion.rotation.added, motion.rotation.axes, motion.rotation.designed
    inverse_mass, extent = loads.inverse_mass, loads.extent
    moved = False
    for i in range(pose.shape[0]):
        wx, wy, wz = velocity[i, 3], velocity[i, 4], velocity[i, 5]
        if inverse_mass[i, 0] == 0.0:
            fast = abs(velocity[i, 0]) + abs(velocity[i, 1]) + abs(velocity[i, 2])
            if fast + abs(wx) + abs(wy) + abs(wz) == 0.0:
                continue
        elif gyroscopic:
            wx, wy, wz = _take_on(velocity, inverse_mass, i, dt)
            _bring(velocity, inverse_mass, i, wx, wy, wz, dt)
        far = 0.0
        for d in range(3):
            pose[i, d] += velocity[i, d] * dt
            far += abs(pose[i, d] - origin[i, d])
        x, y, z = wx * dt, wy * dt, wz * dt
        vx = designed[i, 0, 0] * x + designed[i, 0, 1] * y + designed[i, 0, 2] * z
        vy = designed[i, 1, 0] * x + designed[i, 1, 1] * y + designed[i, 1, 2] * z
        vz = designed[i, 2, 0] * x + designed[i, 2, 1] * y + designed[i, 2, 2] * z
        spin(pose, i, vx, vy, vz)
        _place(pose, i, added, axes, designed)
        far += extent[i] * _turned_by(pose, origin, i)
        moved = moved or not far <= reach  # also if it is NaN
    return moved


@njit(cache=True)
def _turned_by(pose, origin, i):
    """Rotation between two poses of a body, as twice the sine of half the angle."""
    w, x, y, z = pose[i, 3], pose[i, 4], pose[i, 5], pose[i, 6]
    a, b, c, d = origin[i, 3], origin[i, 4], origin[i, 5], origin[i, 6]
    vx = a * x - w * b - (c * z - d * y)
    vy = a * y - w * c - (d * x - b * z)
    vz = a * z - w * d - (b * y - c * x)
    return 2.0 * np.sqrt(vx * vx + vy * vy + vz * vz)
