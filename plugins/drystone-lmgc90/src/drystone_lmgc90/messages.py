"""What goes over the pipes: a setup once, then steps and what came of them.

Bodies are in the order of the assembly; the reference point of each is the centroid of its shape,
which is LMGC90's centre of inertia.  Poses, motions and forces are those of `geometry.motion`, of
these shapes: in space rotations and moments are about the axes in the setup, which turn with the
body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from drystone.common.arrays import Array, BoolArray, IntArray
from drystone.geometry.space.solid import Part


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A simulation: bodies, supports, joints and solver settings."""

    shapes: tuple[Part, ...]  # of every body, m, corners taken off; in the plane no faces
    axes: Array  # (n, dim, dim) that rotations are about in space, in columns
    density: Array  # (n,) kg/m3
    fixed: BoolArray  # (n,)
    thickness: float  # m; 1 in space
    friction: float  # -
    joints: Mapping[tuple[int, int], float]  # N/m of each designed joint, by bodies a < b
    spare_stiffness: float  # N/m of a joint between bodies that do not touch as designed
    reach: float  # m, largest gap at which contacts are looked for
    theta: float  # -, of the theta method
    tolerance: float  # -, of Gauss-Seidel, in the norm "QM/16"
    sweeps_per_check: int
    max_sweeps: int
    scramble: int  # sweeps after which the contacts are taken in another order; 0: never
    time_step: float  # s, of the first step
    upright: bool = False  # in space: bodies stay where they are along z, and turn about it alone


@dataclass(frozen=True, kw_only=True)
class Ready:
    """The simulation stands."""

    program: str  # name and version of what drives LMGC90


@dataclass(frozen=True, kw_only=True)
class Step:
    """One step from the state that was accepted last."""

    accept: bool  # first make the outcome of the step before this one the accepted state
    force: Array  # (n, n_dof) N, N m about the reference points, gravity included
    time_step: float  # s
    stop_blocks: bool  # start from rest


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What came of a step; it is not accepted yet."""

    converged: bool
    n_sweeps: int
    pose: Array  # (n, n_pose) m, rad
    velocity: Array  # (n, n_dof) m/s, rad/s, at the end
    contact_force: Array  # (n, n_dof) N, N m, of all contacts on each body, supports included
    body_a: IntArray  # (n_contacts,)
    body_b: IntArray  # (n_contacts,)
    position: Array  # (n_contacts, dim) m
    normal: Array  # (n_contacts, dim), from a to b
    tangent: Array  # (n_contacts, 3) in space: the first one; (n_contacts, 0) in the plane
    gap: Array  # (n_contacts,) m, where the step started
    reaction: Array  # (n_contacts, dim) N on b, normal and along the tangents of `ContactForces`
    stiffness: Array  # (n_contacts,) N/m
