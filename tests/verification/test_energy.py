"""Conservation laws of blocks that fly and collide: momentum, angular momentum, energy.

A step of the Moreau-Jean scheme takes impulses where it starts, p at the arm x_k, and moves by the
new velocities, x_{k+1} = x_k + h v_{k+1}.  Impulses of a contact balance in force and moment, so
linear and angular momentum about a fixed point are conserved to rounding, whatever the step:

    sum m v          grows by h sum m g
    sum x m v + I w  grows by h sum x_k m g,    as  v_{k+1} x m v_{k+1} = 0
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import PUBLISHED_JOINT, UNIT_WEIGHT, problem_of, rectangle
from drystone.dynamics.nscd import NscdEngine
from drystone.engines.base import Demand
from drystone.model.assembly import GRAVITY, Block, Corner
from drystone.model.builders import make_model

HEIGHT = 50.0  # m over the base: nothing lands while the tests look


class Flight:
    """Two blocks thrown at each other high above the base."""

    def __init__(self, sizes, places, velocities, corner=None, turn=(0.0, 0.0)):
        base = Block(
            id="base",
            vertices=rectangle(-9.0, -1.0, 18.0, 1.0),
            unit_weight=UNIT_WEIGHT,
            support=True,
        )
        blocks = [
            Block(
                id=f"b{i}",
                vertices=rectangle(3.0 * i - 1.5 - w / 2, 0.0, w, h),
                unit_weight=UNIT_WEIGHT,
            )
            for i, (w, h) in enumerate(sizes)
        ]
        self.model = make_model(
            [base, *blocks],
            joint=PUBLISHED_JOINT,
            corner=corner,
            thickness=1.0,
            load_direction=(1.0, 0.0),
        )
        self.assembly = self.model.assembly
        self.engine = NscdEngine()
        state, _ = self.engine.start(problem_of(self.model))
        pose, velocity = np.zeros((3, 3)), np.zeros((3, 3))
        pose[1:, :2] = np.array(places) + (0.0, HEIGHT) - self.assembly.centroid[1:]
        pose[1:, 2] = turn
        velocity[1:] = velocities
        self.state = replace(state, pose=pose, velocity=velocity)
        self.time = 0.0

    def fly(self, duration, h):
        """Steps of ``h`` [s], or halves of it where a step is refused; yields after each."""
        end, trial = self.time + duration, h
        while self.time < end - 1e-12:
            demand = Demand(multiplier=0.0, time_step=trial, stop_blocks=False)
            new, report = self.engine.step(self.state, demand)
            if not report.converged:
                trial *= 0.5
                assert trial > 1e-6, report.reason
                continue
            before, self.state = self.state, new
            self.time += trial
            yield before, trial, report
            trial = min(2.0 * trial, h)

    def momentum(self, state):
        """Linear momentum and, about the origin, angular momentum: (3,) kg m/s and kg m2/s."""
        m, v = self.assembly.mass[1:], state.velocity[1:]
        x = (self.assembly.centroid + state.pose[:, :2])[1:]
        linear = (m[:, :2] * v[:, :2]).sum(axis=0)
        spin = m[:, 2] * v[:, 2] + m[:, 0] * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])
        return np.array([*linear, spin.sum()])

    def weight_in(self, state, h):
        """What gravity adds to `momentum` in a step from ``state``."""
        m = self.assembly.mass[1:, 0]
        x = (self.assembly.centroid + state.pose[:, :2])[1:, 0]
        return -h * GRAVITY * np.array([0.0, m.sum(), (m * x).sum()])

    def inner_energy(self, state):
        """Kinetic energy about the common centre of mass, and what contacts store [J]."""
        m, v = self.assembly.mass[1:], state.velocity[1:].copy()
        v[:, :2] -= (m[:, :2] * v[:, :2]).sum(axis=0) / m[:, 0].sum()
        contacts = self.engine.contacts(state)
        stiffness = 1e8 * contacts.area
        stored = 0.5 * np.sum(stiffness * np.minimum(contacts.gap, 0.0) ** 2)
        return 0.5 * np.sum(m * v**2) + stored


# Offset, turned, spinning: every kind of contact in turn.
COLLISIONS = {
    "head on": (
        [(0.4, 0.4), (0.4, 0.4)],
        [(-0.5, 0.0), (0.5, 0.0)],
        [(2.0, 0.0, 0.0), (-2.0, 0.0, 0.0)],
        0.0,
    ),
    "offset": (
        [(0.4, 0.2), (0.4, 0.2)],
        [(-0.5, 0.0), (0.5, 0.12)],
        [(3.0, 0.0, 0.0), (0.0, 0.0, 0.0)],
        0.0,
    ),
    "on a corner": (
        [(0.4, 0.4), (0.2, 0.8)],
        [(-0.6, 0.0), (0.5, 0.1)],
        [(2.0, 0.3, 1.0), (-1.0, 0.0, -2.0)],
        0.7,
    ),
    "grazing": (
        [(0.4, 0.2), (0.4, 0.2)],
        [(-0.6, 0.0), (0.5, 0.19)],
        [(4.0, 0.4, 0.0), (-4.0, 0.0, 3.0)],
        0.1,
    ),
}


@pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.03)], ids=["sharp", "rounded"])
@pytest.mark.parametrize("name", COLLISIONS)
def test_collisions(name, corner):
    sizes, places, velocities, turn = COLLISIONS[name]
    flight = Flight(sizes, places, velocities, corner, turn=(0.0, turn))
    # Of one block at 1 m/s about the origin, far below: the terms that the sums are made of.
    scale = flight.assembly.mass[1, 0] * HEIGHT
    first = last = flight.inner_energy(flight.state)
    touched = 0
    for before, h, report in flight.fly(0.5, 2e-3):
        added = flight.momentum(flight.state) - flight.momentum(before)
        # Rounding, of a few such terms at a time.
        assert added == pytest.approx(flight.weight_in(before, h), abs=1e-12 * scale)
        energy = flight.inner_energy(flight.state)
        # The implicit step loses energy; turning contacts may give back of second order only.
        assert energy <= last * (1.0 + 1e-3) + 1e-9
        last = energy
        touched += report.penetration > 0.0
    assert touched > 0
    assert last < 0.99 * first


def test_free_flight_is_exact():
    """Nothing touches: straight on at a constant spin, and down by h^2 g (1 + 2 + ... + n)."""
    velocities = [(0.5, 0.0, 1.0), (-0.2, 0.1, -2.0)]
    flight = Flight([(0.4, 0.2)] * 2, [(-2.0, 0.0), (2.0, 0.0)], velocities)
    start, n, h = flight.state, 50, 2e-3
    assert sum(1 for _ in flight.fly(n * h, h)) == n
    moved = flight.state.pose[1:] - start.pose[1:]
    expected = n * h * np.array(velocities)
    expected[:, 1] -= GRAVITY * h**2 * n * (n + 1) / 2
    assert moved == pytest.approx(expected, abs=1e-12 * HEIGHT)


def test_a_head_on_collision_is_inelastic():
    """Equal blocks of opposite velocities: an implicit step leaves them together, at rest."""
    sizes, places, velocities, _ = COLLISIONS["head on"]
    flight = Flight(sizes, places, velocities)
    # The impact takes one step: m / k h^2 = 160 kg / (4e7 N/m * 4e-6 s2) = 1 m of 2 m/s h, so the
    # contact may still open with a part of it; long steps leave nothing.
    for _ in flight.fly(0.3, 0.02):
        pass
    assert flight.state.velocity[1:, 0] == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.005)], ids=["sharp", "rounded"])
@pytest.mark.parametrize("speed", [1.0, 5.0, 30.0])
def test_nothing_flies_through_anything(speed, corner):
    """A shot at a slab of 5 cm: a step of 20 ms would take it up to 0.6 m along.

    10 kg at 30 m/s press 3 cm into a joint of 1e7 N/m; much faster ones would rightly get through.
    """
    flight = Flight(
        [(0.1, 0.1), (0.05, 1.0)],
        [(-0.5, 0.0), (0.0, 0.0)],
        [(speed, 0.0, 0.0), (0.0, 0.0, 0.0)],
        corner,
    )
    deepest = 0.0
    for _, _, report in flight.fly(1.0 / speed, 0.02):
        x = (flight.assembly.centroid + flight.state.pose[:, :2])[1:, 0]
        assert x[0] < x[1], "the shot is behind the slab"
        deepest = max(deepest, report.penetration)
    assert deepest > 0.0
    # The slab of 51 kg was hit by 10 kg, and flies off with what momentum it got.
    assert flight.state.velocity[2, 0] > 0.05 * speed
