"""Where blocks have fallen, walls have several branches of equilibria, and engines take their own.

What falls comes to rest where its motion takes it, and friction remembers the way.  A difference
between two curves is no error where the states of the one are equilibria for the engine of the
other: these tests hand them over.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from drystone.dynamics.distinct.engine import DistinctEngine
from drystone.engines.base import Demand
from drystone.engines.frame import Frame
from drystone.statics.equilibrium import EquilibriumEngine
from handover import (
    KeptDistinct,
    KeptEquilibrium,
    KeptNscd,
    from_nscd,
    rest_near,
    to_distinct,
    to_equilibrium,
)
from random_kinds import KINDS
from structures import structure

CASES = Path(__file__).parents[1] / "cases"


def case(name):
    """A model by the name of its file, or by the seed of a random structure."""
    return structure(name) if isinstance(name, int) else ds.read_model(CASES / f"{name}.toml")


@cache
def traced(name, engine, **options):
    """A curve, and its engine with the states that were kept; once."""
    kept = engine()
    return ds.pushover(case(name), engine=kept, **options), kept


def static(curve):
    """Displacements and multipliers at rest, the displacements never falling."""
    rest = curve.column("status") == "static"
    return np.maximum.accumulate(curve.control_displacement[rest]), curve.load_multiplier[rest]


#: Where the states of `distinct` are taken over [m], by structure: on wall105 after the first block
#: has come loose, at 0.30 m, and after the fall of another one, from 0.36 m on; in an opening
#: where the other engine's control point has begun to overturn; in the others after what slid on a
#: plateau has begun to rock, sooner or later than by the other engine.
TAKEN = [
    *(("wall105", place) for place in (0.2, 0.34, 0.5)),
    *((156, place) for place in (0.11, 0.12)),
    *((37, place) for place in (0.1, 0.3, 0.5)),
    *((40, place) for place in (0.3, 0.5)),
    *((69, place) for place in (0.14, 0.22)),
    *((119, place) for place in (0.09, 0.2, 0.3)),
    *((120, place) for place in (0.09, 0.12)),
    *((125, place) for place in (0.1, 0.11)),
    *((145, place) for place in (0.04, 0.06, 0.1)),
]

#: As far as the states of `distinct` are needed [m], by structure.
TRACED = {
    **{"wall105": 0.52, 37: 0.51, 40: 0.53, 69: 0.24, 119: 0.31, 120: 0.13},
    **{125: 0.12, 145: 0.11, 156: 0.13},
}

#: Increments from there [m]: where two joints could turn, the path turns back within longer ones.
INCREMENT = dict.fromkeys((40, 69, 119, 120, 125, 145), 2e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "place"), TAKEN)
def test_what_distinct_rests_on_is_equilibrium(name, place):
    """The static path goes on from there, with the multipliers of `distinct` and no jump."""
    curve, distinct = traced(name, KeptDistinct, max_displacement=TRACED[name])
    length = Frame.of(case(name).assembly).length
    state = next(s for s in distinct.kept if length * distinct.displacement(s) >= place)
    engine = EquilibriumEngine()
    begun, _ = engine.start(distinct.kept[0].prepared.problem)
    begin = length * distinct.displacement(state)
    state = to_equilibrium(begun, state)
    step = INCREMENT.get(name, 5e-4)
    for i in range(1, 6):
        state, report = engine.step(state, Demand(increment=step / length))
        assert report.converged, report.reason
        assert not report.dynamic
        assert report.residual <= 1e-9  # the engine's tolerance
        # As far as the blocks of a rigid mechanism go with the control point, or twice that.
        assert length * report.motion <= 2.0 * step
        there = np.interp(begin + i * step, *static(curve))
        # What counts as agreement of two curves, see `test_cases_by_cycles`.
        assert report.applied_multiplier == pytest.approx(
            there, abs=5e-3 * curve.peak.load_multiplier
        )


@pytest.mark.slow
def test_wall105_has_two_branches_after_its_falls():
    """Both engines rest within a millimetre of the same place, and apart by more than what counts
    as agreement above: four times that."""
    by_cycles, _ = traced("wall105", KeptDistinct, max_displacement=TRACED["wall105"])
    path, _ = traced("wall105", KeptEquilibrium)
    (place, one), (there, other) = static(by_cycles), static(path)
    nearest = np.abs(place[:, None] - there).argmin(axis=1)
    near = np.abs(place - there[nearest]) < 1e-3
    apart = np.abs(one - other[nearest]) / path.peak.load_multiplier
    assert apart[near & (place > 0.4)].max() > 4.0 * 5e-3


@pytest.mark.slow
def test_distinct_too_finds_no_rest_beyond_the_end_of_wall106():
    """From the last state at rest of `equilibrium`, which collapses there, a hundredth of a
    millimetre leads `distinct` to no rest above the multiplier at which curves end, but where
    blocks have fallen by more than their own size."""
    curve, path = traced("wall106", KeptEquilibrium)
    assert "collapsed in motion" in curve.reason
    length = Frame.of(ds.read_model(CASES / "wall106.toml").assembly).length
    end = static(curve)[0][-1]
    last = next(s for s in path.kept if length * path.displacement(s) >= end - 1e-9)
    engine = DistinctEngine()
    state = to_distinct(engine, path.kept[0].prepared.problem, last)
    _, report = engine.step(state, Demand(increment=1e-5 / length))
    fallen = report.motion > path.kept[0].prepared.problem.assembly.smallest_extent
    assert not report.converged or fallen or report.applied_multiplier < curve.stop_multiplier


@pytest.mark.slow
def test_what_nscd_rests_on_before_its_fall_on_wall106_is_equilibrium():
    """It loses its equilibrium 0.08 m beyond the end of `equilibrium`, on a branch of its own.

    The others rest in its states: those that its steps start from, under an excess, so that they
    carry less by no more than 0.01.  Within a millimetre of the last of them, from where it is
    lost, `distinct` falls, too.  10 s.
    """
    curve, path = traced("wall106", KeptNscd, max_displacement=0.56)
    length = Frame.of(case("wall106").assembly).length
    places = np.array([length * path.displacement(state) for state in path.kept])
    lost = curve.first_collapse.control_displacement

    def taken_over(place, increment=1e-5):
        at = int(np.argmax(places >= place))
        multiplier = curve.points[curve.nearest(places[at])].load_multiplier
        engine = DistinctEngine()
        state = from_nscd(engine, path.kept[0].prepared.problem, path.kept[at], multiplier)
        return multiplier, *engine.step(state, Demand(increment=increment / length))

    for place in (0.2, 0.36, 0.45, 0.5, 0.52):
        multiplier, state, report = taken_over(place)
        assert report.converged and not report.path.dynamic_states
        assert report.static_multiplier == pytest.approx(multiplier, abs=0.01)
        engine = EquilibriumEngine()
        begun, _ = engine.start(path.kept[0].prepared.problem)
        state, found = engine.step(to_equilibrium(begun, state), Demand(increment=2e-4 / length))
        assert found.converged and not found.dynamic
        assert found.applied_multiplier == pytest.approx(multiplier, abs=0.01)
        assert length * found.motion <= 2.0 * 2e-4  # as far as the control point, or twice that
    _, _, report = taken_over(lost - 1e-3, increment=2e-3)
    assert not report.converged or report.path.dynamic_states


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed", "place"), [("plane", 11, 0.152), ("solids", 19, 0.267)])
def test_where_nscd_slides_on_both_engines_rest(kind, seed, place):
    """At the friction coefficient one engine slides on and the other rocks, in the plane and in
    space: `equilibrium` has its own point there, and finds the state of `nscd` in balance too."""
    model = KINDS[kind](seed)
    ours = ds.pushover(model, engine="equilibrium")
    kept = KeptNscd()
    curve = ds.pushover(
        replace(model, control_point=ours.control_point), engine=kept, max_displacement=1.1 * place
    )
    problem, peak = kept.kept[0].prepared.problem, ours.peak.load_multiplier
    state = kept.nearest(place)
    at = problem.length * kept.displacement(state)
    multiplier = curve.points[curve.nearest(at)].load_multiplier
    size = problem.assembly.smallest_extent
    rest = rest_near(kept, state, multiplier, 5e-5 * size, 0.01 * peak)
    assert rest is not None
    assert rest.multiplier == pytest.approx(multiplier, abs=0.01 * peak)
    assert rest.motion <= 1e-3 * problem.length * size
    assert abs(np.interp(place, *static(ours)) - multiplier) > 0.015 * peak


@pytest.mark.slow
def test_what_equilibrium_descends_by_on_an_opening_is_one_block_that_overturns():
    """Two joints of the same friction lie above each other, and nothing says which of them slides.

    By `equilibrium` the upper one does, until the block of the control point overhangs so far that
    it overturns alone, from 0.12 m on, and the rest goes back; by `distinct` the lower one does,
    and both piers rock.  A block that turns about the edge it overhangs has, with its centroid at
    *a* before that edge and *h* above it, the multiplier a / h.  A corner that is left alone, with
    a hundredth of an edge of 0.17 m, at 10^10 Pa/m, sinks by 0.06 mm under the block's 1 kN: over
    its height of 0.1 m that is less than 1e-3.
    """
    curve, _ = traced(156, KeptEquilibrium)
    _, lower = traced(156, KeptDistinct, max_displacement=TRACED[156])
    model = case(156)
    ids = list(model.assembly.ids)
    block, below = ids.index("right"), ids.index("p2c3u1")
    edge = model.assembly.blocks[below].vertices.max(axis=0)
    overturning = [
        (point, pose)
        for point, pose in zip(curve.points, curve.poses, strict=True)
        if point.control_displacement > 0.12 and point.status == "static"
    ]
    assert len(overturning) > 10
    for point, pose in overturning:
        assert np.abs(pose[below, 2]) < 1e-3  # the pier is back: its edge has moved only
        foot = edge + pose[below, :2]
        arm = foot - (model.assembly.centroid[block] + pose[block, :2])
        assert point.load_multiplier == pytest.approx(arm[0] / -arm[1], abs=1e-3)

    length = Frame.of(model.assembly).length
    slid = [pose[below, 0] - pose[ids.index("p2c2u1"), 0] for pose in (pose, lower.kept[-1].pose)]
    assert slid[0] + 0.02 < length * slid[1]  # m, where at 0.05 m both had slid as far
