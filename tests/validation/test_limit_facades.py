"""Limit analysis in space against published figures and an independent program.

The façades: an independent program of ours, five digits, associative.  The dome: J. Heyman, *The
stone skeleton* (1995), least thickness 0.042 of the radius for infinitely many voussoirs without
friction's limit; 0.0427 of 16 rings by 24 sectors is ours, by an independent program.
"""

from pathlib import Path

import pytest

import buildings
import solids
from drystone.limit import ASSOCIATIVE, collapse_load, stands
from drystone.model.assembly import Corner

CASES = Path(__file__).parents[1] / "cases" / "solids"
OUT, IN, ALONG = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
FACADES = {
    ("facade_5x3x8", OUT): (0.39307, 0.33958),
    ("facade_5x3x8", IN): (0.54795, 0.50070),
    ("facade_5x3x8", ALONG): (0.35326, 0.29659),
    ("facade_2.4m", OUT): (0.38933, 0.34402),
    ("facade_2.4m", IN): (0.52604, 0.46983),
    ("facade_2.4m", ALONG): (0.40728, 0.34051),
}


@pytest.mark.parametrize(("name", "push"), FACADES)
@pytest.mark.parametrize("set_back", [0.0, 0.02])
def test_facade(name, push, set_back):
    corner = Corner(chamfer=set_back) if set_back else None
    model = solids.from_boxes(CASES / f"{name}.toml", push=push, corner=corner)
    found = collapse_load(model, flow=ASSOCIATIVE)
    assert round(found.load_multiplier, 5) == FACADES[name, push][1 if set_back else 0]
    assert found.duality_gap < 1e-9 and found.residual < 1e-9
    assert found.dilatancy_violation < 1e-9


def dome(ratio, friction):
    """A hemisphere of mean radius 1 m and thickness ``ratio`` [m], closed at the crown."""
    return buildings.dome(16, 24, radius=1.0, thickness=ratio, opening=0.0, friction=friction)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.25, 0.7])
def test_least_thickness_of_a_dome(friction):
    """To 1 % of the mean radius."""
    assert stands(dome(1.01 * 0.0427, friction).assembly)
    assert not stands(dome(0.99 * 0.0427, friction).assembly)
