"""A façade of 92 blocks with returns, pushed outwards: the equilibrium engine's own consistency.

2.4 m wide, 1.4 m high, joints of 1e9 Pa/m.  There are branches beside each other: points are
compared to half the end, before the units of the returns come out one by one.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from drystone.analysis.driver import pushover
from drystone.results.curve import STATIC, CapacityCurve
from solids import from_boxes

pytestmark = pytest.mark.slow

CASE = Path(__file__).parents[1] / "cases" / "solids" / "facade_2.4m.toml"
STEP = 3.5e-3  # m, what the engine prefers: a fiftieth of the smallest extent


@cache
def traced(*, points: int = 4, **options) -> CapacityCurve:
    """One curve, once."""
    model = from_boxes(CASE, push=(0.0, -1.0, 0.0), points=points)
    return pushover(model, **options)


def static_points(curve: CapacityCurve) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and multipliers of the points at rest."""
    kept = np.array([point.status == STATIC for point in curve.points])
    return curve.control_displacement[kept], curve.load_multiplier[kept]


def apart(first: CapacityCurve, second: CapacityCurve, begin: float, end: float) -> float:
    """Median difference over a stretch of the branch [m], over the first one's peak."""
    places = np.linspace(begin, end, 400)
    one, other = (np.interp(places, *static_points(curve)) for curve in (first, second))
    return float(np.median(np.abs(one - other))) / first.peak.load_multiplier


def test_every_point_at_rest_is_in_equilibrium():
    for point in traced(engine="equilibrium").points:
        assert point.residual <= 1e-8
        assert point.status != STATIC or point.inertia_ratio <= 1e-3


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_other_steps_give_the_same_curve(share):
    """Peaks to 0.2 %, the branch to a median of 0.5 % of the peak."""
    curve = traced(engine="equilibrium")
    other = traced(engine="equilibrium", displacement_step=share * STEP)
    peak = curve.peak.load_multiplier
    assert other.peak.load_multiplier == pytest.approx(peak, rel=2e-3)
    assert apart(curve, other, 1e-4, 0.5 * curve.control_displacement.max()) <= 5e-3


@pytest.mark.parametrize("engine", ["nscd", "distinct"])
def test_other_formulations_give_the_same_curve(engine):
    """To 0.05 m: peaks to 1 %, the branch to a median of 2 % of the peak."""
    curve = traced(engine="equilibrium")
    other = traced(engine=engine, max_displacement=0.05)
    peak = curve.peak.load_multiplier
    assert other.peak.load_multiplier == pytest.approx(peak, rel=1e-2)
    assert apart(curve, other, 2e-3, 0.05) <= 2e-2


@pytest.mark.parametrize("points", [9, 16])
def test_more_points_in_a_joint_take_hardly_more_iterations(points):
    """To 0.03 m, over the peak.

    Four points at its corners make a joint stiffer against turning, three times what it is, and so
    its structure on the rise; peaks differ by less than 2 %.
    """
    few = traced(engine="equilibrium", max_displacement=0.03)
    many = traced(points=points, engine="equilibrium", max_displacement=0.03)
    assert many.peak.load_multiplier == pytest.approx(few.peak.load_multiplier, rel=0.02)
    iterations = [np.mean([point.n_iterations for point in c.points]) for c in (few, many)]
    assert iterations[1] <= 1.75 * iterations[0]  # 11 a step; 14 with 9 points, 16 with 16
