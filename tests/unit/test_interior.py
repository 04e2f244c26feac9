"""Steps of the plane from the interior of the joint law: they end where paths lead."""

from __future__ import annotations

import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from builders import problem_of, stack
from drystone.analysis.driver import pushover
from drystone.engines.base import Demand, UnstableError
from drystone.model.assembly import Corner
from drystone.model.builders import published_wall
from drystone.statics import solution, stability
from drystone.statics.equilibrium import EquilibriumEngine, EquilibriumSettings
from drystone.statics.interior import InteriorPoint
from drystone.statics.plane import plane_step
from drystone.statics.plane.piecewise import PathSettings
from drystone.statics.shape import excess_of_cubic
from drystone.statics.solution import SolutionSettings

pytestmark = pytest.mark.kernels

#: Without the accelerator.
WITHIN = EquilibriumSettings(solution=SolutionSettings(path=None))

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


class Counting(EquilibriumEngine):
    """Counts the steps that are tried."""

    steps = 0

    def step(self, state, demand):
        self.steps += 1
        return super().step(state, demand)


@pytest.mark.compiled
@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_step_from_the_interior_ends_where_the_path_leads(number):
    """Increments on the rising branch, each solved both ways from the state that is followed."""
    problem = problem_of(published_wall(number))
    engine, within = EquilibriumEngine(), EquilibriumEngine(WITHIN)
    state, _ = engine.start(problem)
    compared = 0
    for _ in range(12):
        demand = Demand(increment=2e-4, over_fold=True)  # by the implicit law
        followed, by_path = engine.step(state, demand)
        jumped, from_within = within.step(state, demand)
        assert by_path.converged and from_within.converged
        if by_path.path.fold is None:
            compared += 1
            assert from_within.static_multiplier == pytest.approx(
                by_path.static_multiplier, rel=1e-6
            )
            np.testing.assert_allclose(jumped.pose, followed.pose, atol=1e-8)
        state = followed
    assert compared >= 8


@pytest.mark.compiled
@pytest.mark.parametrize("number", [1, 3])
def test_curves_are_the_same_without_paths(number):
    """Points lie elsewhere, as steps are chosen by how the curve bends."""
    model = published_wall(number)
    by_path = pushover(model)
    within = pushover(model, engine=EquilibriumEngine(WITHIN))
    assert within.status == by_path.status == "finished"
    peaks = [curve.peak.load_multiplier for curve in (within, by_path)]
    assert peaks[0] == pytest.approx(peaks[1], rel=2e-4)
    still = [
        np.array(
            [
                (p.control_displacement, p.load_multiplier)
                for p in curve.points
                if p.status != "dynamic"
            ]
        )
        for curve in (within, by_path)
    ]
    # Up to the first jump, after which either goes its way.  Between points that lie elsewhere a
    # curve bends by up to 4e-3 of its peak without paths, and by 2e-3 with them.
    at = by_path.peak.control_displacement * np.linspace(0.1, 1.5, 15)
    values = [np.interp(at, *points.T) for points in still]
    np.testing.assert_allclose(values[0], values[1], atol=6e-3 * peaks[0])


@pytest.mark.compiled
def test_a_path_that_is_soon_given_up_leads_to_the_same_curve():
    """After five changes the interior-point method goes on."""
    soon = EquilibriumSettings(solution=SolutionSettings(path=PathSettings(changes=5)))
    curves = [pushover(published_wall(3), engine=EquilibriumEngine(s)) for s in (None, soon)]
    assert [curve.status for curve in curves] == ["finished", "finished"]
    peaks = [curve.peak.load_multiplier for curve in curves]
    assert peaks[1] == pytest.approx(peaks[0], rel=2e-4)


@pytest.mark.compiled
@pytest.mark.parametrize("changes", [1, 2, 33])
def test_paths_do_not_depend_on_when_their_matrix_is_renewed(changes, monkeypatch):
    """Folds and detours come at any change: also at the last one with a factorisation."""

    def points():
        curve = pushover(published_wall(2), max_displacement=0.35)
        return np.array([(p.control_displacement, p.load_multiplier) for p in curve.points])

    as_ever = points()
    monkeypatch.setattr(plane_step, "CHANGES_PER_MATRIX", changes)
    peak = as_ever[:, 1].max()
    before = as_ever[:, 0] < 0.25  # roundings grow in jumps
    np.testing.assert_allclose(points()[: before.sum()], as_ever[before], atol=1e-5 * peak)


@pytest.mark.compiled
def test_under_a_given_load_the_path_is_followed_where_nothing_else_leads_on(monkeypatch):
    """Neither the interior-point method nor a path of no changes finds anything."""
    monkeypatch.setattr(solution._Solver, "find", lambda *args, **options: False)
    problem = problem_of(published_wall(3))

    def begun(path):
        settings = EquilibriumSettings(solution=SolutionSettings(path=path))
        state, _ = EquilibriumEngine(settings).start(problem)
        return state

    long, short = (begun(PathSettings(changes=changes)).pose for changes in (10_000, 0))
    np.testing.assert_allclose(short, long, atol=1e-9)
    with pytest.raises(UnstableError):
        begun(PathSettings(changes=0, changes_at_last=0.0))


@pytest.mark.slow
@pytest.mark.gate
@pytest.mark.compiled
def test_paths_of_a_large_facade_do_not_cost_many_steps():
    """Of 502 blocks, on the rising branch: twice as many as without paths, as these turn back at
    stones that move.  Paths that were followed however long they are took 3.8 times as many."""
    model = runpy.run_path(str(BENCHMARKS / "walls.py"))["facade"](500)
    assert model.assembly.n_blocks == 502
    tried = []
    for settings in (EquilibriumSettings(), WITHIN):
        engine = Counting(settings)
        pushover(model, engine=engine, max_displacement=0.03)
        tried.append(engine.steps)
    assert tried[0] <= 2.5 * tried[1]


def test_a_stack_finds_its_equilibrium_in_one_long_step():
    """From blocks that only touch, with gravity at once: every joint carries what is above it."""
    problem = problem_of(stack(*12 * [(1.0, 0.5)], corner=Corner(radius=0.02)))
    engine = EquilibriumEngine()
    engine._apply_dead_load = lambda state: (state, None)
    state, _ = engine.start(problem)
    state, report = engine.step(state, Demand(multiplier=0.0, time_step=30.0))
    assert report.converged
    weight = problem.assembly.weight[~problem.assembly.fixed]
    carried = engine.contacts(state)
    joints = np.zeros(problem.assembly.n_bodies)
    np.add.at(joints, carried.block_b, carried.normal_reaction)
    expected = np.cumsum(weight)
    assert sorted(joints[joints > 0.0]) == pytest.approx(expected.tolist(), rel=1e-6)


def test_a_block_has_no_more_modes_than_motions():
    """Two of a block in the plane whose control displacement is held; others would be rounding."""
    problem = problem_of(stack((0.5, 1.0)))
    engine = EquilibriumEngine(WITHIN)
    state, _ = engine.start(problem)
    state, report = engine.step(state, Demand(increment=1e-6))
    assert report.converged and not report.unstable
    step = engine.last
    assert stability.judge(step).stable
    free = np.count_nonzero(~problem.assembly.fixed)
    assert len(stability.quotients(step)) == min(4, 3 * free - 1)
    assert (stability.quotients(step) > 0.0).all()


def test_a_cubic_exceeds_its_ends():
    """x - x^3, which has its top at 1 / sqrt(3), and what rises all along."""
    excess, share = excess_of_cubic(1.0, 0.0, -2.0)
    assert excess == pytest.approx(2.0 / 27.0**0.5, rel=3e-3)
    assert share == pytest.approx(3.0**-0.5, abs=0.03)
    assert excess_of_cubic(0.5, 1.0, 0.5)[0] == 0.0


class LastChanges:
    """A step whose unbalanced forces rise for two iterations of Newton's method and then vanish, as
    in the iterations of a corner of two walls in motion."""

    residuals = (7e-8, 1e-3, 2e-5, 1.6e-7, 2.6e-10)

    def __init__(self):
        body = np.zeros((1, 3))
        self.loads = SimpleNamespace(dead=np.array([[0.0, -1.0, 0.0]]), fixed=np.array([False]))
        self.bordered = SimpleNamespace(columns=np.zeros((3, 1, 3)))
        self.x, self.damping, self.reaction = body, np.zeros(1), None
        self.multiplier, self.n_moved = 0.0, 0

    def respond(self):
        """Nothing to be done."""

    def balance(self, _):
        return self.residuals[self.n_moved]

    def balanced(self):
        return self.residuals[self.n_moved] < 1e-9

    def aim(self):
        return 0.0

    def move(self, *_):
        self.n_moved += 1

    def restart(self, *_):
        self.n_moved = 0

    inside = None


@pytest.mark.parametrize("told", [True, False])
def test_newtons_method_has_all_its_iterations_once_branches_can_be_told(told):
    """It was given up as soon as forces had not come down in two."""
    solver = InteriorPoint(LastChanges())
    assert solver._try_newton(told) == told
