"""Equilibrium of every movable block under its contact forces, in numbers of order one.

With contact forces f (normal and tangential components, compression positive), dead load G, load
pattern F and multiplier lambda, the blocks balance when

    B f + G + lambda F = 0

The transpose of B takes block velocities to the relative velocities of b seen from a at the
contacts, along their normals and tangents: B^T u > 0 along a normal opens the contact.  Forces are
measured in the weight of the heaviest block and moments in that weight times its size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from drystone.common.arrays import Array
from drystone.geometry.motion import moments
from drystone.limit.crushing import rows_of, spread, with_crushing_points
from drystone.limit.joints import ContactPoints, contact_points
from drystone.limit.tied import UNBOUNDED, rollers, with_ties
from drystone.limit.tied import rows_of as tied_rows
from drystone.model.assembly import Assembly
from drystone.model.loading import Acting, DeadForces, DeadLoad, LoadPattern
from drystone.model.ties import Tie

#: How near to its strength, relatively, a tie yields: programs from within stop short of it.
YIELDING = 1e-4


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """The balance of an assembly, scaled.

    Rows are movable blocks times degrees of freedom, then one for each tie, see `tied`, and for
    each contact point that may be crushed, see `crushing`.
    """

    assembly: Assembly
    points: ContactPoints
    matrix: csc_array  # B, (n_rows, n_contacts dim)
    dead: Array  # G, (n_rows,)
    live: Array  # F, (n_rows,)
    cohesion: Array  # (n_contacts,) in units of force
    tension: Array  # (n_contacts,) likewise
    force: float  # N, the unit of force
    length: float  # m, the unit of length
    n_ties: int = 0  # with those that stand for rollers
    n_drawn: int = 0  # without, the first ones
    n_crushed: int = 0  # contact points that may be crushed
    untilted: Array | None = None
    """(n_rows,) what of the dead load stays as large where gravity turns; None for all patterns but
    `tilt`, and where there is none."""

    # Long: rows of blocks, then of ties, then of crushed joints, each in their units.
    @classmethod
    def of(
        cls,
        assembly: Assembly,
        load: LoadPattern,
        dead_loads: Sequence[DeadLoad] = (),
        ties: Sequence[Tie] = (),
        *,
        points: ContactPoints | None = None,
    ) -> Equilibrium:
        """Set up the balance in the designed shape; all ``dead_loads`` act from the start.

        ``points`` are those of the assembly's joints unless they are given.
        """
        points = spread(contact_points(assembly) if points is None else points)
        n_drawn, (held, lever) = len(ties), rollers(assembly)
        ties = (*ties, *held)
        points = with_ties(points, assembly, ties, np.append(np.ones(n_drawn), lever))
        tied = points
        still = int(np.flatnonzero(assembly.fixed)[0])
        points, crushed = with_crushing_points(points, still)
        force = assembly.heaviest_weight
        movable = np.flatnonzero(~assembly.fixed)
        size = assembly.volume[movable] / assembly.thickness  # area in the plane, else volume
        length = float((size ** (1.0 / assembly.dimension)).mean())
        scale = np.full(assembly.n_dof, 1.0 / force)
        scale[assembly.dimension :] /= length
        acting = Acting.of(assembly, load, dead_loads, ties[:n_drawn])
        dead = acting.dead if acting.tilted is None else acting.dead + acting.tilted
        beside = None if acting.tilted is None else acting.dead

        def scaled(forces: DeadForces) -> Array:
            """About axes of the world, (n_rows,)."""
            return (np.column_stack((forces.force, forces.moments()))[movable] * scale).ravel()

        matrix, own = _matrix(assembly, points, length), np.zeros(0)
        if ties:
            rows, own = tied_rows(ties, tied, force)
            padded = csc_array((len(ties), assembly.dimension * len(crushed)))
            matrix = csc_array(vstack([matrix, hstack([rows, padded])]))
            matrix.sort_indices()
        if len(crushed):
            rows, least = rows_of(points, crushed, force)
            matrix, own = csc_array(vstack([matrix, rows])), np.concatenate((own, least))
            matrix.sort_indices()
        untilted = None
        if beside is not None and (beside.force.any() or own.any()):
            untilted = np.concatenate((scaled(beside), own))
        return cls(
            assembly=assembly,
            points=points,
            matrix=matrix,
            dead=np.concatenate((scaled(dead), own)),
            live=np.concatenate((scaled(acting.pattern), np.zeros(len(own)))),
            n_ties=len(ties),
            n_drawn=n_drawn,
            n_crushed=len(crushed),
            untilted=untilted,
            cohesion=points.cohesion / force,
            tension=points.tension / force,
            force=force,
            length=length,
        )

    @property
    def n_contacts(self) -> int:
        """Number of contact points."""
        return self.points.n_contacts

    @property
    def n_joined(self) -> int:
        """Contact points of joints, those that stand for ties and for strengths left out."""
        return self.n_contacts - 2 * self.n_ties - self.n_crushed

    @property
    def n_beside(self) -> int:
        """Rows that are no balance of blocks."""
        return self.n_ties + self.n_crushed

    def tie_forces(self, forces: Array) -> Array | None:
        """Of ties (n_ties,) [N], tension positive, from ``forces`` (n_contacts, dim); None where
        there are none."""
        if not self.n_drawn:
            return None
        n = self.n_joined
        return -self.force * forces[n : n + self.n_drawn, 0]

    def loads_what_never_yields(self, forces: Array) -> bool:
        """Whether ``forces`` (n_contacts, dim) make a tie yield that has no limit of strength, as a
        spring or a roller: what the programs take for one is all that limits the load."""
        own = slice(self.n_joined, self.n_joined + self.n_ties)
        strength = self.tension[own]
        weight = float(self.assembly.weight[~self.assembly.fixed].sum())
        endless = strength >= (1.0 - YIELDING) * UNBOUNDED * weight / self.force
        yielding = np.abs(forces[own, 0]) >= (1.0 - YIELDING) * strength
        return bool((endless & yielding).any())

    def residual(self, forces: Array, multiplier: float) -> float:
        """Largest unbalanced force or moment, in scaled units, of ``forces`` (n_contacts, dim)."""
        unbalanced = self.matrix @ forces.ravel() + self.dead + multiplier * self.live
        return float(np.abs(unbalanced).max(initial=0.0))

    def relative(self, velocity: Array) -> Array:
        """Velocities of b seen from a at the contacts, (n_contacts, dim), from scaled ones."""
        return (self.matrix.T @ velocity).reshape(self.n_contacts, -1)

    def slip(self, relative: Array) -> Array:
        """Size of the tangential part of relative velocities (n_contacts, dim), (n_contacts,)."""
        return np.asarray(np.linalg.norm(relative[:, 1:], axis=1))

    def block_velocities(self, velocity: Array) -> Array:
        """Scaled velocities (n_rows,) as those of all blocks, (n, n_dof) [m/s, rad/s]."""
        assembly = self.assembly
        blocks = np.zeros((assembly.n_bodies, assembly.n_dof))
        rows = len(velocity) - self.n_beside
        blocks[~assembly.fixed] = velocity[:rows].reshape(-1, assembly.n_dof)
        blocks[:, assembly.dimension :] /= self.length
        return blocks


def _matrix(assembly: Assembly, points: ContactPoints, length: float) -> csc_array:
    dim, n_dof = points.dimension, assembly.n_dof
    row_of = np.cumsum(~assembly.fixed) - 1
    column = np.arange(points.n_contacts * dim).reshape(points.n_contacts, dim)
    rows, columns, values = [], [], []
    for block, sign in ((points.block_a, -1.0), (points.block_b, 1.0)):
        arm = (points.position - assembly.centroid[block])[:, None, :]
        wrench = np.concatenate((points.frame, moments(arm, points.frame) / length), axis=2)
        moves = ~assembly.fixed[block]
        shape = wrench[moves].shape
        row = n_dof * row_of[block[moves], None, None] + np.arange(n_dof)
        rows.append(np.broadcast_to(row, shape).ravel())
        columns.append(np.broadcast_to(column[moves][..., None], shape).ravel())
        values.append(sign * wrench[moves].ravel())
    entries = np.concatenate(values)
    matrix = csc_array(
        (entries, (np.concatenate(rows), np.concatenate(columns))),
        shape=(n_dof * assembly.n_blocks, points.n_contacts * dim),
    )
    matrix.eliminate_zeros()
    matrix.sort_indices()
    return matrix
