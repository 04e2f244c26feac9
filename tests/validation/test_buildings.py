"""Structures that other tests take: they stand, hold what they should, and have no overlaps."""

import numpy as np
import pytest

import buildings
from drystone.engines import make_engine
from drystone.engines.base import Problem
from drystone.limit import ASSOCIATIVE, collapse_load, stands, watched
from drystone.model.construction.checks import layout_problems
from random_solids import KINDS, random_solids

SMALL = {
    "corner wall": buildings.corner_wall,
    "box building": buildings.box_building,
    "arch": buildings.arch,
    "dome": buildings.dome,
    "closed dome": lambda **more: buildings.dome(4, 8, opening=0.0, **more),
    "house": lambda **more: buildings.house(buildings.House(units=6, courses=4, storeys=1), **more),
}


def problems(model):
    """What a reader of model files would find wrong with the layout."""
    return layout_problems(model.assembly, lambda i: model.assembly.ids[i])


@pytest.mark.parametrize("name", SMALL)
def test_it_stands_under_its_own_weight_and_falls_to_any_side(name):
    for push in ((1.0, 0.0, 0.0), (-0.6, -0.8, 0.0)):
        model = SMALL[name](push=push)
        assert not problems(model)
        found = collapse_load(model, flow=ASSOCIATIVE)
        # No more than friction carries of all blocks at once, and no less than a leaf 12 high.
        assert found.status == "finished", found.reason
        assert (
            1.0 / 12.0 < found.load_multiplier <= model.assembly.joint.friction_coefficient + 1e-6
        )


@pytest.mark.slow
@pytest.mark.parametrize("name", SMALL)
def test_contact_dynamics_brings_it_to_rest(name):
    """No block moves by more than a hundredth of the smallest one: joints only close."""
    model = SMALL[name](stiffness=1e9)
    problem = Problem(assembly=model.assembly, load=model.load, control_point=model.control_point)
    engine = make_engine("nscd")
    state, report = engine.start(problem)
    assert report.converged, report.reason
    assert np.abs(state.pose[:, :3]).max() < 0.01 * model.assembly.smallest_extent
    engine.close()


def test_the_same_function_makes_a_house_of_any_size():
    for shape, n_blocks in (
        (buildings.House(), 1046),
        (buildings.House(units=27, courses=25), 5022),
        (buildings.House(unit=(0.2, 0.1, 0.1)), 1046),
    ):
        assert len(shape.blocks()) == n_blocks + 1


def test_a_house_holds_what_its_walls_do_less_the_openings():
    shape = buildings.House(units=8, courses=6)
    volume = buildings.house(shape).assembly.volume[1:].sum()
    half, thickness, height = 0.2, 0.2, 0.2
    walls = 4 * 2 * shape.units * half * thickness * height * shape.courses * shape.storeys
    floors = ((2 * shape.units + 1) * half) ** 2 * height * shape.storeys
    void = thickness * sum(hole.width * hole.height for hole in shape.openings())
    assert void > 0.05 * walls
    assert volume == pytest.approx(walls + floors - void, rel=1e-12)


@pytest.mark.slow
def test_a_house_of_a_thousand_blocks_stands():
    model = buildings.house()
    assert not problems(model)
    assert stands(model.assembly)


def test_load_and_control_point_go_with_the_direction():
    for push in buildings.directions(6):
        model = buildings.corner_wall(push=push, points=9)
        top = np.vstack([b.vertices for b in model.assembly.blocks])
        top = top[top[:, 2] > top[:, 2].max() - 1e-9]
        assert model.assembly.points == 9
        np.testing.assert_allclose(model.load.direction, push, atol=1e-12)
        assert model.control_point.point @ push == pytest.approx((top @ push).max(), abs=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_a_random_structure_stands_and_is_the_same_again(seed):
    model, again = random_solids(seed), random_solids(seed)
    assert model.sha256 == again.sha256
    assert model.title == f"{KINDS[seed % len(KINDS)].__name__} {seed}"
    assert 2 <= model.assembly.n_blocks <= 40
    assert not problems(model)
    found = collapse_load(model, flow=ASSOCIATIVE)
    assert found.status == "finished" and found.load_multiplier > 0.0


def test_rubble_fills_what_it_was_cut_from():
    """The pieces of a seed's pillar have the volume of its box: a plane cuts, and loses nothing."""
    for seed in (1, 6, 11):
        model = random_solids(seed)
        vertices = np.vstack([b.vertices for b in model.assembly.blocks if not b.support])
        assert model.assembly.volume[1:].sum() == pytest.approx(
            np.prod(np.ptp(vertices, axis=0)), rel=1e-9
        )


def test_voussoirs_of_a_dome_have_the_volume_between_two_polyhedra():
    """Both have their corners on a sphere, and volumes as the cubes of the radii."""
    shells = [
        buildings.dome(3, 8, radius=r, thickness=t, opening=0.0).assembly.volume[1:].sum()
        for r, t in ((2.0, 0.4), (1.0, 0.8))
    ]
    of_one = shells[1] / (1.4**3 - 0.6**3)
    assert shells[0] == pytest.approx(of_one * (2.2**3 - 1.8**3), rel=1e-12)
    assert 0.8 < of_one / (2.0 / 3.0 * np.pi) < 1.0  # inside the half ball


def test_what_is_watched_moves():
    """Of two walls around a corner, pulled off along y, the control point is on one that falls."""
    model = watched(buildings.corner_wall(push=(0.0, -1.0, 0.0)))
    found = collapse_load(model, flow=ASSOCIATIVE)
    control = model.control_point
    assert model.assembly.ids[control.block] in found.moving
    assert found.velocities[control.block, 1] < 0.0
    vertices = model.assembly.blocks[control.block].vertices
    assert np.abs(vertices - control.point).max(axis=1).min() == 0.0
