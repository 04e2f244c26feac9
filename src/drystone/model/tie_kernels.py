"""Ties and springs between points of two bodies: where they are, and the force in them.

A tie runs straight from a point of body a to a point of body b, with the elongation e over its
length as designed.  It carries

    N = T within LEAST <= T <= MOST, else the nearer of the two,      T = N_0 + k (e - p)

tension positive, with the pretension N_0, and pulls both points towards each other along itself.
What exceeds the bounds is plastic elongation p; a tie that carries no compression (LEAST is zero)
buckles instead, and is as long as it was when it is taut again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drystone.common.arrays import Array, IntArray
from drystone.common.compiled import njit
from drystone.geometry.rotation import add_force_at, rotation_adds, translation

#: Columns of `Ties.value`, vectors of three with a zero in the plane: points of a and of b from the
#: centroids as designed, the way from the one to the other, its length [m]; k [N/m], N_0, bounds
#: [N]; what a tie may be elongated by and p [m]; 1, or 0 where it is broken or taken out.
ARM_A, ARM_B, SPAN, LENGTH = 0, 3, 6, 9
STIFFNESS, PRETENSION, LEAST, MOST = 10, 11, 12, 13
BREAKING, PLASTIC, ACTIVE = 14, 15, 16
N_VALUE = 17

#: Columns of `Ties.now`: arms of both points in the present poses, direction from a to b, length,
#: elongation [m], force N, T [N], and how N grows with e [N/m].
NOW_A, NOW_B, ALONG, DISTANCE = 0, 3, 6, 9
ELONGATION, FORCE, TRIAL, TANGENT = 10, 11, 12, 13
N_NOW = 14


class Ties(NamedTuple):
    """All ties of an assembly, a row each."""

    body: IntArray  # (n_ties, 2) a and b
    value: Array  # (n_ties, N_VALUE)
    now: Array  # (n_ties, N_NOW)

    @classmethod
    def none(cls) -> Ties:
        """Of an assembly that has none."""
        return cls(np.zeros((0, 2), np.int64), np.zeros((0, N_VALUE)), np.zeros((0, N_NOW)))


@njit(cache=True)
def locate(body, value, pose, now):
    """Fill ``now`` in the poses (n, n_pose)."""
    for k in range(body.shape[0]):
        a, b = body[k, 0], body[k, 1]
        ax, ay, az = rotation_adds(
            pose, a, value[k, ARM_A], value[k, ARM_A + 1], value[k, ARM_A + 2]
        )
        bx, by, bz = rotation_adds(
            pose, b, value[k, ARM_B], value[k, ARM_B + 1], value[k, ARM_B + 2]
        )
        (fx, fy, fz), (tx, ty, tz) = translation(pose, a), translation(pose, b)
        dx, dy, dz = tx - fx + (bx - ax), ty - fy + (by - ay), tz - fz + (bz - az)
        sx, sy, sz = value[k, SPAN], value[k, SPAN + 1], value[k, SPAN + 2]
        lx, ly, lz = sx + dx, sy + dy, sz + dz
        length = np.sqrt(lx * lx + ly * ly + lz * lz)
        # Of displacements, not of places: as precise as these.
        doubled = (sx + lx) * dx + (sy + ly) * dy + (sz + lz) * dz
        elongation = doubled / (length + value[k, LENGTH])
        now[k, NOW_A] = value[k, ARM_A] + ax
        now[k, NOW_A + 1] = value[k, ARM_A + 1] + ay
        now[k, NOW_A + 2] = value[k, ARM_A + 2] + az
        now[k, NOW_B] = value[k, ARM_B] + bx
        now[k, NOW_B + 1] = value[k, ARM_B + 1] + by
        now[k, NOW_B + 2] = value[k, ARM_B + 2] + bz
        now[k, ALONG], now[k, ALONG + 1], now[k, ALONG + 2] = lx / length, ly / length, lz / length
        now[k, DISTANCE], now[k, ELONGATION] = length, elongation
        pull(value, now, k)


@njit(cache=True)
def pull(value, now, k):
    """The force of tie k at its elongation."""
    stiffness = value[k, STIFFNESS]
    trial = value[k, PRETENSION] + stiffness * (now[k, ELONGATION] - value[k, PLASTIC])
    force, tangent = trial, stiffness
    if trial > value[k, MOST]:
        force, tangent = value[k, MOST], 0.0
    elif trial < value[k, LEAST]:
        force, tangent = value[k, LEAST], 0.0
    if value[k, ACTIVE] == 0.0:
        force, tangent = 0.0, 0.0
    now[k, TRIAL], now[k, FORCE], now[k, TANGENT] = trial, force, tangent


@njit(cache=True)
def age(value, now):
    """Make what has yielded plastic, and break what is elongated too far; the work [J] of that."""
    work = 0.0
    for k in range(value.shape[0]):
        if value[k, ACTIVE] == 0.0:
            continue
        trial, stiffness = now[k, TRIAL], value[k, STIFFNESS]
        over = trial - now[k, FORCE]
        if over > 0.0 or (over < 0.0 and value[k, LEAST] < 0.0):
            value[k, PLASTIC] += over / stiffness
            work += over / stiffness * now[k, FORCE]
        if now[k, ELONGATION] > value[k, BREAKING]:
            value[k, ACTIVE] = 0.0
            work += 0.5 * now[k, FORCE] ** 2 / stiffness
    return work


@njit(cache=True)
def add_forces(body, now, axes, force):
    """Add what the ties do to the bodies to ``force`` (n, n_dof); moments in space are about the
    principal axes in the columns of ``axes`` (n, 3, 3) there."""
    for k in range(body.shape[0]):
        for side in range(2):
            i = body[k, side]
            arm = NOW_A if side == 0 else NOW_B
            pulled = now[k, FORCE] if side == 0 else -now[k, FORCE]
            fx = pulled * now[k, ALONG]
            fy = pulled * now[k, ALONG + 1]
            fz = pulled * now[k, ALONG + 2]
            rx, ry, rz = now[k, arm], now[k, arm + 1], now[k, arm + 2]
            add_force_at(rx, ry, rz, fx, fy, fz, i, axes, force)
