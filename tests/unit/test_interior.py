"""The interior point: its contacts, its directions, and steps that it solves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from builders import problem_of, stack
from drystone.contact.contacts import (
    BODY_B,
    FRICTION,
    LIFT,
    STIFF_N,
    STIFF_T,
    TRIAL_N,
    TRIAL_T,
    Contacts,
)
from drystone.engines.base import Demand
from drystone.law import interior as interior_law
from drystone.law.branches import BACKWARD, FORWARD, OPEN, STICKING
from drystone.law.columns import N_RESPONSE, NN, NT, RN, TN, TT
from drystone.law.interior import D_TRIAL_N, D_TRIAL_T, FAR, N_CHANGE, N_INNER, NEAR, P, Q, W
from drystone.model.assembly import Corner
from drystone.model.builders import published_wall
from drystone.statics.equilibrium import EquilibriumEngine
from drystone.statics.plane import interior_kernels as interior
from drystone.statics.plane.interior import Descent, InteriorPoint

pytestmark = pytest.mark.kernels

KN, KT = 2e7, 2e10  # N/m


def contacts(n, *, mu=0.65, dilation=0.0, seed=0):
    """Contacts of two bodies with random trial reactions of all kinds, and their branches."""
    random = np.random.default_rng(seed)
    contacts = Contacts.empty(n, 2, 3)
    contacts.rows[:] = random.normal(size=(n, 3, 6))
    contacts.slot[:], contacts.which[:, BODY_B] = np.arange(n), 1
    table = contacts.table
    table[:, STIFF_N], table[:, STIFF_T] = KN, KT
    table[:, FRICTION], table[:, LIFT] = mu, KN * dilation
    table[:, TRIAL_N] = random.normal(size=n) * 1e3
    table[:, TRIAL_T] = random.normal(size=n) * 1e4
    return contacts, n, np.full(n, STICKING)


def centred(every, barrier):
    inner = np.zeros((every[1], N_INNER))
    interior_law.centre(*every, barrier, inner)
    return inner


@pytest.mark.parametrize("barrier", [1e-20, 1e-12, 1e-6, 1.0])
def test_central_contacts_obey_the_law_with_its_products_at_the_barrier(barrier):
    every = contacts(200)
    table, v = every[0].table, centred(every, barrier)
    rn, rt, w, p, q, near, far, *_ = v.T
    assert (v[:, [RN, W, P, Q]] > 0.0).all()
    # To the rounding of the larger of the terms.
    tn, tt = table[:, TRIAL_N], table[:, TRIAL_T]
    np.testing.assert_allclose(rn - w, tn, atol=1e-12 * np.abs(tn).max())
    np.testing.assert_allclose(rt + p - q, tt, atol=1e-7 * np.abs(tt).max())
    np.testing.assert_allclose(rn * w, KN * barrier, rtol=1e-12)
    np.testing.assert_allclose(near * p, KT * barrier, rtol=1e-12)
    np.testing.assert_allclose(far * q, KT * barrier, rtol=1e-12)


def test_without_a_barrier_the_branches_are_those_of_the_law():
    packed, n, branch = every = contacts(500)
    table, v = packed.table, centred(every, 1e-24)
    interior_law.choose(packed, n, v, branch)
    tn, tt = table[:, TRIAL_N], table[:, TRIAL_T]
    sliding = np.where(tt > 0.0, FORWARD, BACKWARD)
    sticks = np.abs(tt) <= table[:, FRICTION] * tn
    expected = np.where(tn <= 0.0, OPEN, np.where(sticks, STICKING, sliding))
    assert branch.tolist() == expected.tolist()
    assert len(set(expected)) == 4


@pytest.mark.parametrize("mu", [0.0, 0.65])
def test_response_is_the_derivative_of_central_reactions(mu):
    every = contacts(100, mu=mu)
    table, barrier = every[0].table, 1e-3
    v = centred(every, barrier)
    response = np.zeros((100, N_RESPONSE))
    energy = interior_law.respond_within(*every, v, response)
    assert energy == pytest.approx(barrier, rel=1e-9)
    for trial, columns, step in (
        (TRIAL_N, [NN, TN], 1e-3),
        (TRIAL_T, [NT, TT], 1e-1),
    ):
        there = table[:, trial].copy()
        table[:, trial] = there + step
        ahead = centred(every, barrier)[:, :2]
        table[:, trial] = there - step
        behind = centred(every, barrier)[:, :2]
        table[:, trial] = there
        np.testing.assert_allclose(
            response[:, columns], (ahead - behind) / (2.0 * step), rtol=1e-4, atol=1e-6
        )


@pytest.mark.parametrize("dilation", [0.0, 0.1])
@pytest.mark.parametrize("second", [False, True])
def test_changes_solve_the_equations_linearised(dilation, second):
    """A full step along them leaves of the products what is of second order, and nothing else."""
    every = contacts(100, dilation=dilation)
    table, n = every[0].table, every[1]
    v = centred(every, 1e-2)
    response, b = np.zeros((n, N_RESPONSE)), np.zeros((n, 2))
    change, force = np.zeros((n, N_CHANGE)), np.zeros((2, 3))
    interior_law.respond_within(*every, v, response)
    direction = np.random.default_rng(1).normal(size=(2, 3)) * 1e-6
    barrier = 1e-3
    for again in (False, True)[: 1 + second]:
        interior.offset(*every, v, barrier, again, change, response, b, force)
        first = change.copy()
        room, limiting, by_way, by_square = interior.changes(
            *every, v, barrier, again, response, b, direction, change
        )
    moved, d = v + change[:, :N_INNER], change
    tn = table[:, TRIAL_N] + d[:, D_TRIAL_N]
    tt = table[:, TRIAL_T] + d[:, D_TRIAL_T]
    rn, rt, w, p, q, *_ = moved.T
    np.testing.assert_allclose(rn, tn + w + KN * dilation / KT * (p + q), rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(rt, tt - p + q, rtol=1e-9, atol=1e-6)
    names = ((RN, W, KN), (NEAR, P, KT))
    for one, other, stiffness in (*names, (FAR, Q, KT)):
        left = v[:, one] * v[:, other] + d[:, one] * v[:, other] + v[:, one] * d[:, other]
        if second:
            left += first[:, one] * first[:, other]
        np.testing.assert_allclose(left, stiffness * barrier, rtol=1e-6)
    positive = (RN, W, P, Q, NEAR, FAR)
    falling = np.where(d[:, positive] < 0.0, -v[:, positive] / d[:, positive], np.inf)
    assert room == falling.min()
    assert limiting == falling.min(axis=1).argmin()
    after = interior_law.respond_within(*every, moved, response)
    before = interior_law.respond_within(*every, v, response)
    assert after == pytest.approx(before + by_way + by_square, rel=1e-9)


class Recorded(InteriorPoint):
    """Notes whether branches were told."""

    def __init__(self, *args):
        super().__init__(*args)
        self.told = []

    def descent(self, *args):
        descent = super().descent(*args)
        run = descent.run

        def noted(tolerance, **options):
            self.told.append(run(tolerance, **options))
            return self.told[-1]

        descent.run = noted
        return descent


@pytest.mark.compiled
@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_step_from_the_interior_ends_where_the_path_leads(number, monkeypatch):
    """Increments on the rising branch, each solved both ways from the state that is followed."""
    problem = problem_of(published_wall(number))
    engine = EquilibriumEngine()
    monkeypatch.setattr("drystone.statics.equations.InteriorPoint", Recorded)
    state, _ = engine.start(problem)
    compared = 0
    for _ in range(12):
        demand = Demand(increment=2e-4, over_fold=True)  # by the implicit law
        followed, by_path = engine.step(state, demand)
        engine.last.interior.told.clear()
        with monkeypatch.context() as patch:
            within = replace(engine.settings.path, worth=0, many_blocks=0)
            patch.setattr(engine, "settings", replace(engine.settings, path=within))
            leapt, from_within = engine.step(state, demand)
        assert by_path.converged and from_within.converged
        assert engine.last.interior.told and engine.last.interior.told[0]
        if by_path.path.turn is None:
            compared += 1
            assert from_within.static_multiplier == pytest.approx(
                by_path.static_multiplier, rel=1e-6
            )
            np.testing.assert_allclose(leapt.pose, followed.pose, atol=1e-8)
        state = followed
    assert compared >= 8


@pytest.mark.compiled
def test_newtons_method_does_without_an_interior_that_leads_nowhere(monkeypatch):
    """From where the step starts: the descent has moved blocks, branches and trial reactions."""

    def lose(descent, tolerance, *, early=False):
        was = run(descent, tolerance, early=early)
        lost.append(was)
        return False

    run, lost = Descent.run, []
    engine = EquilibriumEngine()
    state, _ = engine.start(problem_of(published_wall(2)))
    compared = 0
    for _ in range(12):
        demand = Demand(increment=2e-4, over_fold=True)
        followed, by_path = engine.step(state, demand)
        with monkeypatch.context() as patch:
            within = replace(engine.settings.path, worth=0, many_blocks=0)
            patch.setattr(engine, "settings", replace(engine.settings, path=within))
            patch.setattr(Descent, "run", lose)
            _, by_newton = engine.step(state, demand)
        assert by_path.converged
        if by_newton.converged and by_path.path.turn is None:
            compared += 1
            assert by_newton.static_multiplier == pytest.approx(by_path.static_multiplier, rel=1e-6)
        state = followed
    assert any(lost)
    assert compared >= 6


def test_a_stack_settles_in_one_long_step():
    """From blocks that only touch, with gravity at once: every joint carries what is above it."""
    problem = problem_of(stack(*12 * [(1.0, 0.5)], corner=Corner(radius=0.02)))
    engine = EquilibriumEngine()
    engine._settle = lambda state: (state, None)
    state, _ = engine.start(problem)
    state, report = engine.step(state, Demand(multiplier=0.0, time_step=30.0))
    assert report.converged
    weight = problem.assembly.weight[~problem.assembly.fixed]
    carried = engine.contacts(state)
    joints = np.zeros(problem.assembly.n_bodies)
    np.add.at(joints, carried.block_b, carried.normal_reaction)
    expected = np.cumsum(weight)
    assert sorted(joints[joints > 0.0]) == pytest.approx(expected.tolist(), rel=1e-6)


def test_a_good_direction_lets_go_of_what_a_pivot_holds_by_far_too_much():
    """In one step to below the damping above which more would not help, others by a factor."""
    problem = problem_of(stack(*3 * [(1.0, 0.5)]))
    engine = EquilibriumEngine()
    engine.start(problem)
    interior, settings = engine.last.interior, engine.settings.interior
    held = interior.step.damping
    held[1:4] = 1e8, 1e4, settings.least_damping
    interior.step.frame.columns[0] = 0.0
    interior._move(np.zeros_like(interior.step.force), 1.0)
    let_go = [settings.less * settings.most_damping, settings.less * 1e4, 0.0]
    assert held[1:4].tolist() == let_go


class Linear:
    """Two blocks, one on the other, with a stiffness of one's own [1/s2, times the mass] in place
    of what joints give: (2, 2), of the block that is eliminated first, and of the other."""

    def __init__(self, monkeypatch, stiffness, *, force=1.0):
        problem = problem_of(stack((1.0, 0.5), (1.0, 0.5)))
        engine = EquilibriumEngine()
        engine._settle = lambda state: (state, None)
        state, _ = engine.start(problem)
        self.interior = engine.equations_of(state).interior
        self.step = self.interior.step
        self.step.count, self.x = 0, np.zeros_like(state.pose)
        self.step.inertia_factor = 0.0
        free = np.flatnonzero(~problem.assembly.fixed)
        self.bodies = [int(i) for i in self.step.structure.order if i in free]
        self.mass = self.step.loads.mass
        #: Both blocks have the same mass, so that these are the modes times it.
        assert np.allclose(self.mass[self.bodies[0]], self.mass[self.bodies[1]])
        self.stiffness, self.force = np.array(stiffness), force
        monkeypatch.setattr(self.interior, "_assemble", self.assemble)

    def assemble(self, x, multiplier=0.0, geometry=None):
        step, (first, second), k = self.step, self.bodies, self.stiffness
        mass = np.diag(self.mass[first])
        tangent = step.tangent
        tangent.diagonal[:], tangent.upper[:], tangent.lower[:] = 0.0, 0.0, 0.0
        tangent.diagonal[first], tangent.diagonal[second] = k[0, 0] * mass, k[1, 1] * mass
        pairs = step.pairs
        (pair,) = np.flatnonzero(np.isin(pairs.a, self.bodies) & np.isin(pairs.b, self.bodies))
        ahead = pairs.a[pair] == first
        tangent.upper[pair] = (k[0, 1] if ahead else k[1, 0]) * mass
        tangent.lower[pair] = (k[1, 0] if ahead else k[0, 1]) * mass
        step.force[:] = 0.0
        step.force[self.bodies] = self.force - self.mass[first] * (k @ x[self.bodies])
        step.residual = float(np.abs(step.force).max())
        return 1.0

    def at(self):
        return self.x, 0.0, self.x.copy(), 1.0, 1e-6


#: Eigenvalues 600 and 1e6, though the first pivot is -1e6: b^2 = 6e8 + 1e6 (2e6 + 600).
B = np.sqrt(6e8 + 1e6 * (2e6 + 600.0))
UNSYMMETRIC = [[-1e6, B], [-B, 2e6 + 600.0]]


def test_bodies_stand_whose_unsymmetric_tangent_has_a_negative_pivot(monkeypatch):
    """Held by what makes it positive, 1e6 and more, they hardly move: 600 over that each time."""
    assert np.linalg.eigvals(UNSYMMETRIC).real == pytest.approx([600.0, 1e6], rel=1e-6)
    case = Linear(monkeypatch, UNSYMMETRIC)
    assert not case.interior._come_to_rest(*case.at())
    assert case.interior._stand(*case.at())
    mass = case.mass[case.bodies[0]]
    expected = np.linalg.solve(UNSYMMETRIC, np.ones((2, 3)) / mass)
    np.testing.assert_allclose(case.x[case.bodies], expected, rtol=1e-6)
    assert not case.step.damping.any()


@pytest.mark.parametrize(
    "stiffness",
    [
        [[-1e3, 0.0], [0.0, 1e5]],  # one mode of three motions grows
        [[-40.0, 0.0], [0.0, -4e3]],  # two do: the determinant of the whole is positive
    ],
)
def test_bodies_that_fall_do_not_stand(monkeypatch, stiffness):
    case = Linear(monkeypatch, stiffness)
    case.x[case.bodies] = 1e-3
    case.assemble(case.x)
    assert not case.interior._keeps()
    case.step.damping[case.bodies] = 7.0, 0.0
    before = case.x.copy(), case.step.damping.copy()
    assert not case.interior._stand(*case.at())
    assert np.array_equal(case.x, before[0]) and np.array_equal(case.step.damping, before[1])


def test_only_bodies_that_do_not_stand_are_held(monkeypatch):
    case = Linear(monkeypatch, UNSYMMETRIC)
    nothing = np.zeros_like(case.x)
    for standing in (False, True):
        case.interior.standing[case.bodies[0]] = standing
        case.assemble(case.x)
        case.step.damping[:] = 0.0
        assert case.interior.factorise(None, nothing)
        assert case.step.damping.max() == 0.0 if standing else case.step.damping.max() > 1e6
