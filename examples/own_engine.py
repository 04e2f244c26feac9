"""An engine of your own: drystone drives another program, here one of a single rocking block."""

from collections import namedtuple

import numpy as np

from drystone.contact.forces import STICKING, ContactForces
from drystone.engines.base import Demand, Engine, StepReport

State = namedtuple("State", "pose turn carried")


class Program:  # the other program: a block that turns clockwise about its toe
    def __init__(self, weight, inertia, arm):
        self.weight, self.inertia, self.arm = weight, inertia, arm

    def step(self, start, multiplier, h):  # from rest, by the implicit Euler rule
        turn = start
        for _ in range(8):
            c, s = np.cos(turn), np.sin(turn)
            x, y = np.array([[c, s], [-s, c]]) @ self.arm  # from the toe to the centroid
            turn = max(start + h**2 * self.weight * (multiplier * y + x) / self.inertia, 0.0)
        return turn, x, y


class RockingEngine(Engine):
    name = "rocking"  # it steps under a given multiplier, as an engine does if it says no more
    notes = ("the toe is a hinge",)  # what it leaves out, told with the reason of a curve's end

    def start(self, problem):
        a, self.problem, i = problem.assembly, problem, problem.control_point.block
        self.i, self.toe = i, np.array([a.outline(i)[:, 0].max(), a.outline(i)[:, 1].min()])
        arm = a.centroid[i] - self.toe
        self.program = Program(a.weight[i], a.mass[i, 2] + a.mass[i, 0] * arm @ arm, arm)
        return self.step(State(a.design_pose(), 0.0, 0.0), Demand(multiplier=0.0, time_step=1.0))

    def step(self, state, demand):
        p, a, pose = self.program, self.problem.assembly, state.pose.copy()
        turn, x, y = p.step(state.turn, demand.multiplier, demand.time_step)
        pose[self.i] = x - p.arm[0], y - p.arm[1], -turn
        spin = (turn - state.turn) / demand.time_step**2
        carried = demand.multiplier - a.mass[self.i, 0] * spin * y / p.weight
        return State(pose, turn, carried), StepReport(
            converged=True,
            applied_multiplier=demand.multiplier,
            carried_multiplier=carried,  # what reaches the support
            static_multiplier=demand.multiplier - p.inertia * spin / (p.weight * y),
            control_displacement=self.problem.control_point.displacement(a, pose),
            motion=2.0 * float(np.hypot(x, y)) * abs(turn - state.turn),
        )

    def contacts(self, state):  # for the results' files and pictures
        one, w = np.ones(1, int), self.program.weight
        where = {"block_a": 0 * one, "block_b": self.i * one, "position": self.toe[None]}
        force = {"normal_reaction": w * one, "tangential_reaction": -w * state.carried * one[None]}
        rest = {"normal": np.array([[0.0, 1.0]]), "gap": 0.0 * one, "area": 0.0 * one}
        return ContactForces(**where, **force, **rest, status=STICKING * one)
