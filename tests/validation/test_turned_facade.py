"""A façade of 92 blocks with returns, turned with its loads: axes decide nothing.

Where the returns leave it, units meet in a point only, separated alike by their beds, their heads
and their sides: 14 pairs.  Up to the peak and just past it, at some 2 mm; by `nscd` as far as its
steps are the same, which it shortens from 0.46 mm on by what it finds.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drystone.analysis.driver import pushover
from drystone.results.curve import CapacityCurve
from solids import from_boxes, turned

pytestmark = pytest.mark.slow

CASE = Path(__file__).parents[1] / "cases" / "solids" / "facade_2.4m.toml"
#: How well places are known again [m]: steps end at the same place but for what their tolerance
#: leaves of a block's place, 1e-9 of a weight over joints that are hardly pressed.
PLACE = 1e-6
#: Of multipliers: `equilibrium` is satisfied with 1e-9 of a weight, `nscd` with 5e-7.
SAME = {"equilibrium": 1e-9, "nscd": 1e-6}
#: How far curves go [m].
FAR = {"equilibrium": 3e-3, "nscd": 4.5e-4}
SIDEWAYS, INWARDS, OUTWARDS = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)


@cache
def traced(engine: str, push: tuple[float, ...], seed: int | None) -> CapacityCurve:
    """One curve, once; turned by chance where there is a seed."""
    model = from_boxes(CASE, push=push)
    if seed is not None:
        model = turned(model, Rotation.random(random_state=seed))
    return pushover(model, engine=engine, max_displacement=FAR[engine], keep_contacts=True)


def contact_table(curve: CapacityCurve, point: int, turn: np.ndarray) -> np.ndarray:
    """Blocks, places [m], normals and areas [m2] of the contacts of a point, turned back, sorted
    by blocks and by place."""
    c = curve.contacts[point]
    place, normal = c.position @ turn, c.normal @ turn
    table = np.column_stack((c.block_a, c.block_b, place, normal, c.area))
    order = np.lexsort((*np.round(place.T, 3), c.block_b, c.block_a))
    return table[order]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("engine", "push"),
    [
        ("equilibrium", OUTWARDS),
        ("equilibrium", INWARDS),
        ("equilibrium", SIDEWAYS),
        ("nscd", OUTWARDS),
    ],
)
def test_a_facade_that_is_turned_has_the_same_contacts_and_curve(engine, push, seed):
    plain, other = traced(engine, push, None), traced(engine, push, seed)
    assert len(other.points) == len(plain.points)
    assert other.load_multiplier == pytest.approx(plain.load_multiplier, abs=SAME[engine])
    turn = Rotation.random(random_state=seed).as_matrix()
    # Where units meet in a point, places decide between beds and heads once they have moved, and
    # what `nscd` leaves of a weight moves them by 3e-7 m.
    points = range(len(plain.points)) if engine == "equilibrium" else [0]
    for point in points:
        expected = contact_table(plain, point, np.eye(3))
        found = contact_table(other, point, turn)
        assert found.shape == expected.shape
        assert found == pytest.approx(expected, abs=PLACE)
