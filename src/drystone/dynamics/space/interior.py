"""Velocities of an implicit step in space, by an interior-point method.

Newton's method on the branches of the law fails if many contacts change their direction of slip.
With a barrier, every contact sticks, slides and opens a little, and comes to one state as the
barrier is reduced.  This takes 7 to 30 linear systems, nearly independent of the structure.  Then
Newton's method completes the solution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drystone.common.arrays import Array
from drystone.common.tolerances import FAR_ENOUGH, FIRST_BARRIER_OF_IMPULSES, NEAR_BARRIER
from drystone.contact.contacts import FRICTION, N_TABLE, STIFF_N, STIFF_T
from drystone.contact.rows import IN_SPACE, contact_velocities
from drystone.dynamics.sweeps import ContactProblem, momentum_defect
from drystone.engines.tie_forces import TieImpulses
from drystone.law import central_path
from drystone.law import cones as kernels
from drystone.linear.block_system import BlockSystem, SingularMatrixError

#: Largest number of iterations.
ITERATIONS = 40


@dataclass
class Interior:
    """One search, made anew for every step and every penalty."""

    problem: ContactProblem
    system: BlockSystem
    free_velocity: Array
    h: float
    penalty: float  # kg, see `law.cones`
    centre: Array  # (n_contacts, 2) N s
    ties: TieImpulses | None = None

    def __post_init__(self) -> None:
        """Allocate memory, and prepare the table of the contacts' law."""
        n = len(self.centre)
        self.inner, self.change = np.zeros((n, kernels.N_INNER)), np.zeros((n, kernels.N_INNER))
        self.scaling = np.zeros((n, kernels.N_SCALING))
        self.trial, self.relative, self.aimed = (np.zeros((n, 3)) for _ in range(3))
        self.defect = np.zeros_like(self.free_velocity)
        table = self.problem.contacts.table
        self.joint = np.zeros((n, N_TABLE))
        self.joint[:, STIFF_N] = self.h * self.h * table[:, STIFF_N]
        self.joint[:, STIFF_T] = self.penalty
        self.joint[:, FRICTION] = table[:, FRICTION]

    def start(self, velocity: Array, usual: float) -> None:
        """Begin at a velocity (n, n_dof), with impulses of the ``usual`` size [N s]."""
        self.velocity = velocity.copy()
        stiffness = self.h * self.h * float(self.problem.contacts.table[:, STIFF_N].mean())
        self.first = self.energy = FIRST_BARRIER_OF_IMPULSES * usual * usual / stiffness
        self._renew()
        kernels.centre_contacts(self.joint, self.energy, True, self.trial, self.inner)

    def _renew(self) -> None:
        contact_velocities(IN_SPACE, self.problem.contacts, self.velocity, self.relative)
        kernels.trial_impulses(
            self.problem, self.h, self.penalty, self.centre, self.relative, self.trial
        )

    def steps(self) -> Iterator[bool]:
        """Iterate; each iteration yields whether Newton's method is to be tried from here."""
        for k in range(ITERATIONS):
            try:
                self.step()
            except SingularMatrixError:
                return
            yield k % 2 == 0 and self.energy < NEAR_BARRIER * self.first

    def step(self) -> None:
        """One iteration."""
        joint, inner, change = self.joint, self.inner, self.change
        self.energy = kernels.scale(joint, inner, self.scaling)
        tangent = self.system.begin()
        kernels.tangent(IN_SPACE, self.problem, joint, self.scaling, *tangent)
        if self.ties:
            self.ties.act(self.velocity)
            self.ties.stiffen(tangent)
        self.system.factorise()
        self._solve(0.0, second=False)
        far = central_path.step_length(joint, inner, change)
        share = central_path.reduction(joint, inner, change, far, self.energy)
        moved = self._solve(share * self.energy, second=far >= FAR_ENOUGH)
        far = central_path.step_length(joint, inner, change)
        inner += far * change
        self.velocity += far * moved
        self._renew()
        left = (1.0 - far) * self.energy + far * share * self.energy
        kernels.centre_contacts(joint, left, False, self.trial, inner)

    def _solve(self, energy: float, *, second: bool) -> Array:
        joint = self.joint
        kernels.aim(
            joint, energy, second, self.trial, self.inner, self.change, self.scaling, self.aimed
        )
        momentum_defect(
            IN_SPACE, self.problem, self.system.mass, self.free_velocity, self.velocity, self.aimed,
            self.defect,
        )  # fmt: skip
        if self.ties:
            self.ties.act(self.velocity)
            self.ties.add_to(self.defect)
            self.defect[self.system.mass == 0.0] = 0.0
        moved = self.system.solve_again(self.defect)
        contact_velocities(IN_SPACE, self.problem.contacts, moved, self.relative)
        kernels.changes(joint, energy, second, self.relative, self.inner, self.scaling, self.change)
        return moved
