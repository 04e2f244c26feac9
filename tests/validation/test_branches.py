"""Where blocks have fallen, walls have several branches of equilibria, and engines take their own.

What falls comes to rest where its motion takes it, and friction remembers the way.  A difference
between two curves is no error where the states of the one are equilibria for the engine of the
other: these tests hand them over.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from drystone.engines.base import Demand
from drystone.engines.distinct import DistinctEngine
from drystone.engines.equilibrium import EquilibriumEngine
from drystone.frame import Frame
from handover import KeptDistinct, KeptEquilibrium, to_distinct, to_equilibrium

CASES = Path(__file__).parents[1] / "cases"


@cache
def traced(name, engine, **options):
    """A curve, and its engine with the states that were kept; once."""
    kept = engine()
    return ds.pushover(ds.read_model(CASES / f"{name}.toml"), engine=kept, **options), kept


def static(curve):
    """Displacements and multipliers at rest, the displacements never falling."""
    rest = curve.column("status") == "static"
    return np.maximum.accumulate(curve.control_displacement[rest]), curve.load_multiplier[rest]


#: Where the states of `distinct` are taken over [m]: after the first block has come loose, at
#: 0.30 m, and after the fall of another one, from 0.36 m on.
TAKEN = [0.2, 0.34, 0.5]


@pytest.mark.slow
@pytest.mark.parametrize("place", TAKEN)
def test_what_distinct_rests_on_is_equilibrium_on_wall105(place):
    """The static path goes on from there, with the multipliers of `distinct` and no jump."""
    curve, distinct = traced("wall105", KeptDistinct, max_displacement=0.52)
    length = Frame.of(ds.read_model(CASES / "wall105.toml").assembly).length
    state = next(s for s in distinct.kept if length * distinct.displacement(s) >= place)
    engine = EquilibriumEngine()
    engine.start(distinct.problem)
    begin = length * distinct.displacement(state)
    state = to_equilibrium(engine, state)
    step = 5e-4
    for i in range(1, 6):
        state, report = engine.step(state, Demand(increment=step / length))
        assert report.converged, report.reason
        assert not report.dynamic
        assert report.residual <= 1e-9  # the engine's tolerance
        # As far as the blocks of a rigid mechanism go with the control point, or twice that.
        assert length * report.motion <= 2.0 * step
        there = np.interp(begin + i * step, curve.control_displacement, curve.load_multiplier)
        # What counts as agreement of two curves, see `test_cases_by_cycles`.
        assert report.applied_multiplier == pytest.approx(
            there, abs=5e-3 * curve.peak.load_multiplier
        )


@pytest.mark.slow
def test_wall105_has_two_branches_after_its_falls():
    """Both engines are at rest at 0.5 m, and apart by more than what counts as agreement above.

    Four times that: 0.104 and 0.126 are 6 % of the peak apart.
    """
    by_cycles, _ = traced("wall105", KeptDistinct, max_displacement=0.52)
    path, _ = traced("wall105", KeptEquilibrium)
    apart = np.interp(0.5, *static(by_cycles)) - np.interp(0.5, *static(path))
    assert abs(apart) > 4.0 * 5e-3 * path.peak.load_multiplier


@pytest.mark.slow
def test_distinct_too_finds_no_rest_beyond_the_end_of_wall106():
    """From the last state at rest of `equilibrium`, which collapses there, a hundredth of a
    millimetre leads `distinct` to no rest above the multiplier at which curves end."""
    curve, path = traced("wall106", KeptEquilibrium)
    assert "collapsed in motion" in curve.reason
    length = Frame.of(ds.read_model(CASES / "wall106.toml").assembly).length
    end = static(curve)[0][-1]
    last = next(s for s in path.kept if length * path.displacement(s) >= end - 1e-9)
    engine = DistinctEngine()
    state = to_distinct(engine, path.problem, last)
    _, report = engine.step(state, Demand(increment=1e-5 / length))
    assert not report.converged or report.applied_multiplier < curve.stop_multiplier
