"""Ties in the equations of implicit steps: their stiffness against differences of forces."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.engines.tie_forces import JoinedTies, TieForces
from drystone.linear.symbolic import Tangent
from drystone.model import tie_kernels as kernel
from drystone.model.assembly import Assembly, Block
from drystone.model.joint_law import JointLaw
from drystone.model.ties import Bars, Tie, TieEnd

pytestmark = pytest.mark.kernels

JOINT = JointLaw(friction_coefficient=0.7, normal_stiffness=1e9, shear_stiffness=1e9)


def box(name, at, dimension, **more):
    corners = np.array(np.meshgrid(*[(0.0, 0.5)] * dimension)).reshape(dimension, -1).T
    if dimension == 2:
        corners = corners[[0, 1, 3, 2]]
        first, last = corners[1] - corners[0], corners[2] - corners[1]
        if first[0] * last[1] < first[1] * last[0]:
            corners = corners[::-1]
    return Block(id=name, vertices=corners + at, unit_weight=2e4, **more)


def forces_of(dimension, **more):
    """Of three bodies apart from each other, the last two of which a tie joins."""
    origins = [np.full(dimension, x) for x in (-2.0, 0.0, 1.5)]
    blocks = [box(n, at, dimension, support=n == "g") for n, at in zip("gab", origins, strict=True)]
    assembly = Assembly.build(blocks, joint=JOINT)
    first, last = (origins[k] + 0.5 * np.linspace(0.2, 0.9, dimension) for k in (1, 2))
    tie = Tie(
        start=TieEnd(block="a", point=first), end=TieEnd(block="b", point=last), stiffness=1e4,
        yield_force=1e5, pretension=500.0, compression=True, **more,
    )  # fmt: skip
    ties = TieForces(Bars.of(assembly, [tie]), assembly, np.zeros(3, np.bool_))
    ties.begin(ties.bars.first())
    return ties


@pytest.mark.parametrize("dimension", [2, 3])
def test_stiffness_is_the_change_of_forces(dimension):
    """By central differences, of moments about the axes where they were; relative to the largest
    entry they are good to the square of 1e-6 and to the rounding over 1e-6."""
    ties, random = forces_of(dimension), np.random.default_rng(dimension)
    assembly = ties.assembly
    n_dof, step = assembly.n_dof, 1e-6
    begin = assembly.moved(assembly.design_pose(), 0.2 * random.normal(size=(3, n_dof)))
    ties.act(begin)
    (exact,), axes = ties.stiffness(), ties.axes
    found = np.zeros_like(exact)
    for column in range(2 * n_dof):
        for sign in (1.0, -1.0):
            x = np.zeros((3, n_dof))
            x[1 + column // n_dof, column % n_dof] = sign * step
            ties.act(assembly.moved(begin, x))
            ties.axes = axes
            force = np.zeros((3, n_dof))
            ties.add_to(force)
            assert not force[0].any()
            found[:, column] -= sign * force[1:].ravel() / (2.0 * step)
    assert found == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())


def test_law_yields_slackens_and_breaks():
    """N over a history of elongations, by hand: k = 1e4, S = 200, tension only, breaks at 0.06."""
    value, now = np.zeros((1, kernel.N_VALUE)), np.zeros((1, kernel.N_NOW))
    value[0, [kernel.STIFFNESS, kernel.MOST, kernel.BREAKING]] = 1e4, 200.0, 0.06
    value[0, kernel.ACTIVE] = 1.0
    history = (
        (0.01, 100.0),
        (0.05, 200.0),
        (0.04, 100.0),
        (0.02, 0.0),
        (0.035, 50.0),
        (0.07, 200.0),
    )
    for elongation, force in (*history, (0.05, 0.0)):
        now[0, kernel.ELONGATION] = elongation
        kernel.pull(value, now, 0)
        assert now[0, kernel.FORCE] == pytest.approx(force, abs=1e-9)
        kernel.age(value, now)


def test_pairs_of_ties_stand_behind_those_of_contacts():
    """Blocks of a tie along a pair turned round, of one between others, and of one on one body."""
    body = np.array([[2, 0], [1, 3], [0, 2]])
    joined = JoinedTies.of(body, np.array([0, 1]), np.array([2, 2]))
    assert joined.pair.tolist() == [0, 2, 0]
    assert joined.turned.tolist() == [True, False, False]
    assert (joined.a.tolist(), joined.b.tolist()) == ([0, 1, 1], [2, 2, 3])
    random = np.random.default_rng(0)
    found = random.normal(size=(3, 6, 6))
    found += found.transpose(0, 2, 1)
    tangent = Tangent.zeros(4, 3, 3)
    joined.stiffen(tangent, found)
    whole = np.zeros((12, 12))
    for (a, b), block in zip(body, found, strict=True):
        rows = np.r_[3 * a : 3 * a + 3, 3 * b : 3 * b + 3]
        whole[np.ix_(rows, rows)] += block
    for p, (a, b) in enumerate(zip(joined.a, joined.b, strict=True)):
        assert tangent.upper[p] == pytest.approx(whole[3 * a : 3 * a + 3, 3 * b : 3 * b + 3])
        assert tangent.lower[p] == pytest.approx(whole[3 * b : 3 * b + 3, 3 * a : 3 * a + 3])
