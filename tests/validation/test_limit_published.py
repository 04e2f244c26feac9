"""The published walls by limit analysis, and what must hold between their multipliers.

Sources: associative, Ferris & Tin-Loi (2001), five digits; non-associative, Ferris & Tin-Loi (2001)
and Gilbert, Casapulla & Ahmed (2006), three digits, of walls with sharp corners.  With contact
points 0.02 m inside the corners: first-order limit analysis of the same walls, four digits.
"""

import numpy as np
import pytest

import drystone as ds
from builders import with_corner
from drystone.limit import NonAssociativeSettings, collapse_load, collapse_loads
from drystone.model.assembly import Corner
from drystone.model.builders import PUBLISHED_WALLS, coursed_wall, make_model
from drystone.model.builders.published import JOINT, UNIT, UNIT_WEIGHT

SET_BACK = {1: 0.5856, 2: 0.5244, 3: 0.3374}
WALLS = tuple(PUBLISHED_WALLS)
SHARP = Corner()


@pytest.fixture(scope="module")
def sharp():
    """Both results of every wall with sharp corners."""
    return {n: collapse_loads(with_corner(ds.published_wall(n), SHARP)) for n in WALLS}


@pytest.fixture(scope="module")
def rounded():
    """The same with corners of 0.02 m."""
    return {n: collapse_loads(ds.published_wall(n)) for n in WALLS}


@pytest.mark.parametrize("wall", WALLS)
def test_associative_multiplier_to_five_digits(sharp, wall):
    published = PUBLISHED_WALLS[wall].associative_multiplier
    assert round(sharp[wall][0].load_multiplier, 5) == published


@pytest.mark.parametrize("wall", WALLS)
def test_published_non_associative_multiplier_is_among_those_found(sharp, wall):
    # Published to three digits: half a unit of the last one is rounding.
    low, high = sharp[wall][1].collapse_range
    published = PUBLISHED_WALLS[wall].peak_gilbert
    assert low - 5e-4 <= published <= high + 5e-4
    assert low <= sharp[wall][1].load_multiplier <= high
    assert f"{low:.5g}" in sharp[wall][1].reason  # that it is not unique is said


@pytest.mark.parametrize("wall", WALLS)
def test_rounded_corners_have_one_multiplier(rounded, wall):
    found = rounded[wall][1]
    assert found.load_multiplier == pytest.approx(SET_BACK[wall], rel=2e-3)
    assert np.ptp(found.collapse_range) < 1e-6
    assert found.n_paths == 8  # every path ends in a certified state


@pytest.mark.parametrize("wall", WALLS)
def test_a_chamfer_sets_back_as_a_radius_does(rounded, wall):
    model = with_corner(ds.published_wall(wall), Corner(chamfer=0.02))
    settings = NonAssociativeSettings(n_paths=1)
    for found, other in zip(collapse_loads(model, settings=settings), rounded[wall], strict=True):
        assert found.load_multiplier == pytest.approx(other.load_multiplier, abs=1e-9)


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("corners", ["sharp", "rounded"])
def test_final_states_are_certified(request, corners, wall):
    # The linear programs are solved to 1e-10; what they leave is rounding.
    for found in request.getfixturevalue(corners)[wall]:
        assert found.status == "finished"
        assert found.residual < 1e-9
        assert found.friction_violation < 1e-9
        assert found.dilatancy_violation < 1e-7  # `STILL`: slower contacts count as resting
        assert found.duality_gap < 1e-9


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("corners", ["sharp", "rounded"])
def test_associative_multiplier_is_an_upper_bound(request, corners, wall):
    associative, other = request.getfixturevalue(corners)[wall]
    assert other.collapse_range[1] <= associative.load_multiplier + 1e-9


@pytest.mark.parametrize("wall", WALLS)
def test_a_smaller_block_stands_no_better(sharp, rounded, wall):
    # Forces between set-back points are forces between the corners, too.
    assert rounded[wall][0].load_multiplier <= sharp[wall][0].load_multiplier


@pytest.mark.parametrize("wall", WALLS)
def test_contacts_are_those_of_the_published_joints(sharp, wall):
    contacts = sharp[wall][0].contacts
    assert contacts.n_contacts == 2 * PUBLISHED_WALLS[wall].n_joints
    model = ds.published_wall(wall)
    supported = contacts.block_a == 0  # the base is the first block
    vertical = np.sum(contacts.vectors()[supported, 1])
    weight = model.assembly.weight[~model.assembly.fixed].sum()
    assert vertical == pytest.approx(weight, rel=1e-9)


def test_the_other_way_is_the_same():
    # Walls 1 and 2 are symmetric.
    wall = PUBLISHED_WALLS[1]
    blocks = coursed_wall(
        unit=UNIT, courses=wall.courses, repeat=wall.repeat, base=True, unit_weight=UNIT_WEIGHT
    )
    left, right = (
        collapse_load(
            make_model(blocks, joint=JOINT, thickness=1.0, load_direction=(way, 0.0)),
            flow="associative",
        ).load_multiplier
        for way in (-1.0, 1.0)
    )
    assert left == pytest.approx(right, abs=1e-9)


@pytest.mark.slow
def test_wall_of_a_thousand_blocks_by_both_methods(monkeypatch):
    """The interior-point method against HiGHS, which takes ten seconds."""
    import drystone.limit.associative as method

    blocks = coursed_wall(
        unit=UNIT,
        courses=("h" + 24 * "1" + "h", 25 * "1"),
        repeat=10,
        base=True,
        unit_weight=UNIT_WEIGHT,
    )
    model = make_model(blocks, joint=JOINT, thickness=1.0, load_direction=(1.0, 0.0))
    inside = collapse_load(model, flow="associative")
    monkeypatch.setitem(method.INTERIOR_FROM, 2, 10**9)
    simplex = collapse_load(model, flow="associative")
    assert inside.load_multiplier == pytest.approx(simplex.load_multiplier, abs=1e-6)
    assert inside.duality_gap < 1e-6 and simplex.duality_gap < 1e-9
