"""Conservation laws of solids that fly, spin and collide: momentum, angular momentum, energy.

See `test_energy` for linear momentum.  Spins are those amid a step: with Q the axes at its end and
x its rotation, the moment of momentum is Q exp(-x / 2) I w, which free bodies keep to rounding
(`geometry.rotation`), and impulses change by no more than they are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import problem_of
from drystone.dynamics.nscd import NscdEngine
from drystone.engines.base import Demand
from drystone.geometry.motion import design_pose, moved, rotated
from drystone.geometry.rotation import spin_on
from drystone.model.assembly import GRAVITY, Corner
from solids import box, joint, model_of

HEIGHT = 50.0  # m over the base: nothing lands while the tests look


class Flight:
    """Two boxes thrown at each other high above the base."""

    def __init__(self, sizes, places, velocities, spins, corner=None):
        boxes = [
            box(f"b{i}", (3.0 * i, 0.0, 0.0), (3.0 * i + s[0], s[1], s[2]))
            for i, s in enumerate(sizes)
        ]
        base = box("base", (-9.0, -9.0, -1.0), (9.0, 9.0, 0.0), support=True)
        model = model_of([base, *boxes], joint(0.5, 1e8), push=(1.0, 0.0, 0.0), corner=corner)
        self.assembly, self.engine = model.assembly, NscdEngine()
        state, _ = self.engine.start(problem_of(model))
        pose, velocity = self.assembly.design_pose(), self.assembly.no_motion()
        pose[1:, :3] = np.array(places) + (0.0, 0.0, HEIGHT) - self.assembly.centroid[1:]
        velocity[1:, :3], velocity[1:, 3:] = velocities, spins
        self.state = replace(state, pose=pose, velocity=velocity, increment=0.0 * velocity)

    def fly(self, n, h):
        for _ in range(n):
            left = h
            while left > 1e-9 * h:  # halves of steps that are refused
                trial = left
                new, report = self.engine.step(
                    self.state, Demand(multiplier=0.0, time_step=trial, stop_blocks=False)
                )
                while not report.converged:
                    trial *= 0.5
                    assert trial > 1e-6, report.reason
                    new, report = self.engine.step(
                        self.state, Demand(multiplier=0.0, time_step=trial, stop_blocks=False)
                    )
                before, self.state = self.state, new
                left -= trial
                yield before, trial, report

    def momentum(self, state):
        """Linear momentum and, about the origin, angular momentum: (6,) kg m/s and kg m2/s."""
        m, v, axes = self.assembly.mass, state.velocity, self.assembly.axes
        x = self.assembly.centroid + state.pose[:, :3]
        amid = moved(state.pose, -0.5 * state.increment, axes)
        spin = rotated(np.einsum("nij,nj->ni", axes, m[:, 3:] * v[:, 3:]), amid)
        angular = spin + np.cross(x, m[:, :3] * v[:, :3])
        return np.concatenate(((m[:, :3] * v[:, :3])[1:].sum(axis=0), angular[1:].sum(axis=0)))

    def weight_in(self, state, h):
        """What gravity adds to `momentum` in a step from ``state``."""
        m = self.assembly.mass[1:, :1]
        x = (self.assembly.centroid + state.pose[:, :3])[1:]
        force = m * np.array([0.0, 0.0, -GRAVITY])
        return h * np.concatenate((force.sum(axis=0), np.cross(x, force).sum(axis=0)))

    def inner_energy(self, state):
        """Kinetic energy about the common centre of mass, and what contacts store [J]."""
        m, v = self.assembly.mass[1:], state.velocity[1:].copy()
        v[:, :3] -= (m[:, :3] * v[:, :3]).sum(axis=0) / m[:, 0].sum()
        contacts = self.engine.contacts(state)
        stored = 0.5 * np.sum(1e8 * contacts.area * np.minimum(contacts.gap, 0.0) ** 2)
        return 0.5 * np.sum(m * v**2) + stored


# Flat, on an edge, on a corner, edge against edge: places, velocities, spins.
COLLISIONS = {
    "flat": ([(-0.5, 0, 0), (0.5, 0.1, 0.05)], [(2, 0, 0), (-2, 0, 0)], [(0, 0, 0), (0, 0, 0)]),
    "turning": ([(-0.5, 0, 0), (0.5, 0, 0)], [(2, 0, 0), (-2, 0.3, 0)], [(1, 2, 3), (-3, 1, 0)]),
    "spinning": ([(-0.5, 0, 0), (0.4, 0.1, 0)], [(1, 0, 0), (-1, 0, 0)], [(0, 9, 4), (7, 1, -5)]),
}


@pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.02)], ids=["sharp", "rounded"])
@pytest.mark.parametrize("name", COLLISIONS)
def test_collisions(name, corner):
    flight = Flight([(0.4, 0.3, 0.2), (0.3, 0.5, 0.25)], *COLLISIONS[name], corner=corner)
    # Of one block at 1 m/s about the origin, far below: the terms that the sums are made of.
    scale = flight.assembly.mass[1, 0] * HEIGHT
    first = last = flight.inner_energy(flight.state)
    touched = 0
    for before, h, report in flight.fly(200, 2e-3):
        added = flight.momentum(flight.state) - flight.momentum(before)
        # Rounding, of a few such terms at a time.
        assert added == pytest.approx(flight.weight_in(before, h), abs=1e-12 * scale)
        energy = flight.inner_energy(flight.state)
        # The implicit step loses energy; turning contacts, and spins between steps of 2 ms, give
        # back of second order only.
        assert energy <= last * (1.0 + 3e-3) + 1e-9
        last = energy
        touched += report.penetration > 0.0
    assert touched > 0
    assert last < 0.99 * first


def test_free_bodies_keep_what_they_have():
    """Straight on, and down by g t h in every step that ends at t; about the axis between, nearly,
    that is not stable, where a box turns over and over."""
    spins = [(0.5, 6.0, 0.2), (3.0, 0.1, -2.0)]
    velocities = [(0.5, 0.0, 1.0), (-0.2, 0.1, -2.0)]
    places = [(-3.0, 0.0, 0.0), (3.0, 0.0, 0.0)]
    flight = Flight([(0.6, 0.4, 0.2)] * 2, places, velocities, spins)
    start, energy = flight.state, flight.inner_energy(flight.state)
    n, h, least, time, fallen = 500, 4e-3, np.inf, 0.0, 0.0
    for before, step, _ in flight.fly(n, h):
        added = flight.momentum(flight.state) - flight.momentum(before)
        scale = flight.assembly.mass[1, 0] * HEIGHT
        assert added == pytest.approx(flight.weight_in(before, step), abs=1e-12 * scale)
        # Of second order: (h w)^2 / 12 = 5e-5.
        assert flight.inner_energy(flight.state) == pytest.approx(energy, rel=1e-4)
        amid = np.argsort(flight.assembly.mass[1, 3:])[1]
        least = min(least, flight.state.velocity[1, 3 + amid])
        time += step
        fallen += GRAVITY * time * step
    went = flight.state.pose[1:, :3] - start.pose[1:, :3]
    expected = n * h * np.array(velocities)
    expected[:, 2] -= fallen
    assert went == pytest.approx(expected, abs=1e-12 * HEIGHT * n)
    assert least < -5.0  # it has turned over


def test_energy_of_a_free_spin_is_of_second_order_and_does_not_drift():
    mass, spin = np.array([[1.0, 1.0, 1.0, 1.0, 2.0, 3.5]]), np.array([0.1, 2.0, 0.2])
    spread = []
    for h in (0.02, 0.01):
        velocity, increment, energy = np.zeros((1, 6)), np.zeros((1, 6)), []
        velocity[0, 3:] = spin
        for _ in range(int(60.0 / h)):
            spin_on(increment, mass, h, velocity)
            increment = h * velocity
            energy.append(0.5 * np.sum(mass * velocity**2))
        first, last = np.array(energy[: len(energy) // 2]), np.array(energy[len(energy) // 2 :])
        spread.append(np.ptp(energy) / energy[0])
        assert last.max() == pytest.approx(first.max(), rel=0.02 * spread[-1])
    assert spread[0] / spread[1] == pytest.approx(4.0, rel=0.02)
    assert spread[0] < 1e-4


def test_a_steady_spin_about_a_principal_axis_is_exact():
    axes, pose, increment = np.eye(3)[None], design_pose(1, 3), np.zeros((1, 6))
    mass, velocity = np.array([[1.0, 1, 1, 2, 3, 4]]), np.array([[0, 0, 0, 0, 0, 5.0]])
    for _ in range(100):
        spin_on(increment, mass, 0.01, velocity)
        increment = 0.01 * velocity
        pose = moved(pose, increment, axes)
    # 5 rad about z.
    expected = (0.0, 0.0, 0.0, np.cos(2.5), 0.0, 0.0, np.sin(2.5))
    assert pose[0] == pytest.approx(expected, abs=1e-13)
