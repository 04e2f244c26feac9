"""A toy engine in a file of its own: walls that turn about their toe as one piece.

It prescribes displacements: of each angle the multiplier is known in closed form.
"""

from dataclasses import dataclass

import numpy as np

from drystone.contact.forces import STICKING, ContactForces
from drystone.engines.base import Capabilities, Engine, PreferredSteps, StepReport


@dataclass(frozen=True)
class MonolithState:
    pose: np.ndarray
    angle: float  # rad, clockwise
    multiplier: float


class MonolithEngine(Engine[MonolithState]):
    name = "monolith"
    capabilities = Capabilities(prescribes_displacement=True, residual_limit=1e-9)
    notes = ("its joints do not open",)

    def preferred_steps(self, assembly):
        return PreferredSteps(displacement_step=0.05 * assembly.smallest_extent)

    def start(self, problem):
        self.problem, self.assembly = problem, problem.assembly
        self.free = np.flatnonzero(~self.assembly.fixed)
        corners = np.vstack([self.assembly.outline(i) for i in self.free])
        self.toe = np.array([corners[:, 0].max(), corners[:, 1].min()])
        return self.turned(0.0, 0.0)

    def step(self, state, demand):
        if demand.increment is None:
            return state, StepReport(converged=False, reason="it follows displacements only")
        goal, angle, small = self.displacement(state.angle) + demand.increment, state.angle, 1e-7
        for _ in range(20):
            left = goal - self.displacement(angle)
            angle += small * left / (self.displacement(angle + small) - self.displacement(angle))
        return self.turned(angle, abs(angle - state.angle))

    def poses(self, angle):
        c, s = np.cos(angle), np.sin(angle)
        pose, arm = self.assembly.design_pose(), self.assembly.centroid[self.free] - self.toe
        pose[self.free, :2] = arm @ np.array([[c, -s], [s, c]]) - arm
        pose[self.free, 2] = -angle
        return pose

    def displacement(self, angle):
        return self.problem.control_point.displacement(self.assembly, self.poses(angle))

    def turned(self, angle, turn):
        pose, weight = self.poses(angle), self.assembly.weight[self.free]
        arm = (self.assembly.centroid + pose[:, :2])[self.free] - self.toe
        multiplier = -(weight @ arm[:, 0]) / (weight @ arm[:, 1])
        if turn == 0.0:
            multiplier = 0.0  # at rest, on all of its base
        return MonolithState(pose, angle, multiplier), StepReport(
            converged=True,
            applied_multiplier=multiplier,
            carried_multiplier=multiplier,
            static_multiplier=multiplier,
            control_displacement=self.displacement(angle),
            residual=0.0,
            penetration=0.0,
            inertia_ratio=0.0,
            motion=turn * np.hypot(*arm.T).max(),
        )

    def contacts(self, state):
        one, weight = np.ones(1, int), self.assembly.weight[self.free].sum() * np.ones(1)
        return ContactForces(
            block_a=np.flatnonzero(self.assembly.fixed)[:1],
            block_b=self.free[:1],
            position=self.toe[None],
            normal=np.array([[0.0, 1.0]]),
            gap=0.0 * one,
            area=0.0 * one,
            normal_reaction=weight,
            tangential_reaction=-state.multiplier * weight[None],
            status=STICKING * one,
        )
