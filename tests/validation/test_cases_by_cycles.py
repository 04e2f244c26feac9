"""The random walls of tests/cases by the distinct element engine, beside the static path.

In them blocks come off and touch nothing for a while.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

import drystone as ds

CASES = Path(__file__).parents[1] / "cases"


@cache
def traced(name, engine, max_displacement):
    """A curve, once."""
    model = ds.read_model(CASES / f"{name}.toml")
    return ds.pushover(model, engine=engine, max_displacement=max_displacement)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wall101", "wall105", "wall113"])
def test_distinct_goes_on_where_blocks_come_off(name):
    """To where the multiplier falls to a hundredth; every point at rest to the engine's 1e-5."""
    curve = traced(name, "distinct", float("inf"))
    assert curve.status == "finished"
    assert "fell below" in curve.reason
    assert curve.residual.max() <= 1e-5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "engine"),
    [
        ("wall101", "distinct"),
        ("wall105", "distinct"),
        ("wall113", "distinct"),
        ("wall101", "nscd"),
        ("wall105", "nscd"),
        ("wall113", "nscd"),
    ],
)
def test_peaks_are_those_of_the_static_path(name, engine):
    """1 %: the steps of both, and friction, which remembers them.  No spike is taken for a peak."""
    static = traced(name, "equilibrium", 0.08)
    curve = traced(name, engine, 0.08)
    assert curve.peak.load_multiplier == pytest.approx(static.peak.load_multiplier, rel=0.01)
