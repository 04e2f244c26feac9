"""Limit analysis in space against closed forms, the plane, and itself turned.

Programs of cones are solved to some 1e-11 of numbers of order one; 1e-9 allows for the number
of blocks.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import solids
from builders import with_corner
from drystone.geometry.space import solid
from drystone.limit import (
    ASSOCIATIVE,
    NonAssociativeSettings,
    collapse_load,
    collapse_loads,
    is_locked,
    stands,
)
from drystone.limit.joints import contact_points
from drystone.model.assembly import Block, Corner
from drystone.model.builders import circular_arch, extruded, make_model, published_wall, stack
from drystone.model.joint_law import JointLaw

EXACT = 1e-9
CERTIFIED = 1e-7
B, D, H = 0.4, 0.6, 1.5  # m


def multiplier(model):
    found = collapse_load(model, flow=ASSOCIATIVE)
    certified(found)
    return found.load_multiplier


def certified(found, still=CERTIFIED):
    """Forces and velocities say the same, to what limit analysis is asked for."""
    assert found.status == "finished", found.reason
    assert found.duality_gap < CERTIFIED
    assert found.residual < CERTIFIED
    assert found.friction_violation < CERTIFIED
    assert found.dilatancy_violation < still


def law(friction, **more):
    return JointLaw(
        friction_coefficient=friction, normal_stiffness=None, shear_stiffness=None, **more
    )


def block_under(joint, angle, **more):
    model = solids.one_block(B, D, H, angle=angle, **more)
    return replace(model, assembly=replace(model.assembly, joint=joint))


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 60.0, 90.0, 200.0])
@pytest.mark.parametrize("friction", [0.1, 0.32, 0.7])
def test_a_block_slides_or_rocks_over_its_weaker_edge(angle, friction):
    c, s = abs(np.cos(np.radians(angle))), abs(np.sin(np.radians(angle)))
    expected = min(friction, B / max(H * c, 1e-9), D / max(H * s, 1e-9))
    assert multiplier(block_under(law(friction), angle)) == pytest.approx(expected, abs=EXACT)


@pytest.mark.parametrize("corner", [Corner(radius=0.03), Corner(chamfer=0.03)])
@pytest.mark.parametrize("angle", [0.0, 90.0])
def test_treated_edges_shorten_the_arm(corner, angle):
    found = multiplier(block_under(law(0.9), angle, corner=corner))
    assert found == pytest.approx(((D if angle else B) - 0.06) / H, abs=EXACT)


@pytest.mark.parametrize("angle", [0.0, 33.0])
def test_cohesion_holds_a_sliding_block(angle):
    cohesion = 600.0
    expected = 0.1 + cohesion / (solids.UNIT_WEIGHT * H)  # lambda W = mu W + c A
    found = multiplier(block_under(law(0.1, cohesion=cohesion), angle))
    assert found == pytest.approx(expected, abs=EXACT)


def test_tensile_strength_holds_a_rocking_block():
    # Half the joint's strength at its far edge: lambda W H / 2 = W B / 2 + f A / 2 B
    joint = law(0.9, cohesion=5e4, tensile_strength=400.0)
    expected = B / H * (1.0 + 400.0 / (solids.UNIT_WEIGHT * H))
    assert multiplier(block_under(joint, 0.0)) == pytest.approx(expected, abs=EXACT)


def test_without_friction_nothing_holds_a_block():
    assert multiplier(block_under(law(0.0), 20.0)) == pytest.approx(0.0, abs=EXACT)


def test_shares_of_area_make_up_the_joint():
    points = contact_points(block_under(law(0.5), 0.0).assembly)
    np.testing.assert_allclose(points.area, 0.25 * B * D, rtol=1e-12)
    np.testing.assert_allclose(
        points.frame @ points.frame.transpose(0, 2, 1), np.tile(np.eye(3), (4, 1, 1)), atol=1e-14
    )


def test_points_set_back_by_a_length_are_those_of_treated_edges():
    block = block_under(law(0.5), 0.0)
    chamfered = contact_points(with_corner(block, Corner(chamfer=0.05)).assembly)
    given = contact_points(block.assembly, set_back=0.05)
    np.testing.assert_allclose(given.position, chamfered.position, atol=1e-13)


def test_a_concave_block_is_one_body():
    """An L lying on its long leg, pushed towards the short one that stands up from it: it rocks as
    any block with its weight and centroid does."""
    outline = np.array([[0, 0], [1.0, 0], [1.0, 0.9], [0.8, 0.9], [0.8, 0.2], [0, 0.2]])
    vertices, faces = solid.extruded(outline, (0.0, 0.5))
    blocks = [
        solids.box("base", (-1, -1, -0.3), (2, 2, 0), support=True),
        Block(id="l", vertices=vertices, faces=faces, unit_weight=1e4),
    ]
    model = solids.model_of(blocks, law(2.0), push=(1.0, 0.0, 0.0))
    x, _, z = model.assembly.centroid[1]
    assert multiplier(model) == pytest.approx((1.0 - x) / z, abs=EXACT)


def test_a_leaf_rocks_out_of_plane_as_one_block():
    assert multiplier(solids.leaf()) == pytest.approx(0.2 / 1.4, abs=EXACT)


@pytest.mark.parametrize("wall", [1, 2, 3])
@pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.02)])
def test_walls_in_space_carry_what_they_do_in_the_plane(wall, corner):
    plane = with_corner(published_wall(wall), corner)
    expected = collapse_load(plane, flow=ASSOCIATIVE).load_multiplier
    assert multiplier(extruded(plane)) == pytest.approx(expected, abs=1e-6)


def test_an_arch_in_space_carries_what_it_does_in_the_plane():
    blocks = circular_arch(
        radius=10.0, thickness=1.5, embrace=157.5, n_voussoirs=7, unit_weight=2e4
    )
    plane = make_model(blocks, joint=law(0.7), thickness=2.0, load_direction=(1.0, 0.0))
    expected = collapse_load(plane, flow=ASSOCIATIVE).load_multiplier
    assert multiplier(extruded(plane)) == pytest.approx(expected, abs=1e-8)


def rubble(seed, n=6):
    """Prisms with slanting sides and random outlines, one upon the other."""
    rng = np.random.default_rng(seed)
    blocks = [solids.box("base", (-2, -2, -0.3), (2, 2, 0), support=True)]
    bottom, z = 0.5, 0.0
    for k in range(n):
        count, height = int(rng.integers(3, 8)), rng.uniform(0.2, 0.4)
        angle = rng.uniform(0, 7) + 2 * np.pi * np.arange(count) / count
        middle = rng.uniform(-0.08, 0.08, 2)
        ring = np.column_stack((np.cos(angle), np.sin(angle)))
        low, high = middle + bottom * ring, middle + bottom * rng.uniform(0.8, 1.1) * ring
        vertices = np.vstack(
            (np.column_stack((low, [z] * count)), np.column_stack((high, [z + height] * count)))
        )
        blocks.append(Block(id=f"b{k}", vertices=vertices, unit_weight=1e4))
        z += height
    push = (np.cos(seed), np.sin(seed), 0.0)
    return solids.model_of(blocks, law(float(rng.uniform(0.2, 0.8))), push=push)


def crossed(seed):
    """Courses of three strips over the same square, laid crosswise, with random cuts."""
    rng = np.random.default_rng(seed)
    blocks = [solids.box("base", (-2, -2, -0.3), (4, 4, 0), support=True)]
    for course in range(4):
        cuts = np.concatenate(([0.0], np.sort(rng.uniform(0.1, 1.1, 2)), [1.2]))
        for k in range(3):
            low = np.array([cuts[k], 0.0, 0.2 * course])
            high = np.array([cuts[k + 1], 1.2, 0.2 * course + 0.2])
            if course % 2:
                low[:2], high[:2] = low[1::-1].copy(), high[1::-1].copy()
            blocks.append(solids.box(f"b{course}_{k}", low, high))
    push = (np.cos(seed), np.sin(seed), 0.0)
    return solids.model_of(blocks, law(float(rng.uniform(0.3, 0.8))), push=push)


@pytest.mark.parametrize("make", [rubble, crossed])
@pytest.mark.parametrize("seed", range(12))
def test_bounds_of_random_structures_meet(make, seed):
    """The multiplier by the power of the velocities, from blocks alone, and that of the forces."""
    model = make(seed)
    if not stands(model.assembly):
        assert collapse_load(model, flow=ASSOCIATIVE).status == "unstable"
        return
    found = collapse_load(model, flow=ASSOCIATIVE)
    certified(found)
    weight = np.where(model.assembly.fixed, 0.0, model.assembly.weight)
    live = weight @ (found.velocities[:, :3] @ model.load.direction)
    dead = -weight @ found.velocities[:, 2]
    # Dry joints with associated flow dissipate nothing: lambda F.u + G.u = 0.
    assert -dead / live == pytest.approx(found.load_multiplier, abs=1e-7)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 1.0), (0.7, 0.0, 0.0), (0.4, -1.1, 2.0)])
@pytest.mark.parametrize("make", [lambda: rubble(1), lambda: crossed(0), solids.leaf])
def test_nothing_depends_on_how_the_model_is_turned(turn, make):
    model = make()
    other = solids.turned(model, Rotation.from_rotvec(turn), (3.0, -2.0, 10.0))
    assert multiplier(other) == pytest.approx(multiplier(model), abs=EXACT)


def test_velocities_are_those_of_the_mechanism():
    """A block that rocks over its long edge: about y, the fastest vertex moving by one."""
    found = collapse_load(block_under(law(0.9), 0.0), flow=ASSOCIATIVE)
    rate = 1.0 / np.hypot(B, H)  # of the corner across
    expected = np.array([H / 2, 0.0, B / 2, 0.0, 1.0, 0.0]) * rate
    np.testing.assert_allclose(found.velocities[1], expected, atol=1e-7)
    assert found.moving == ("b1",)


def test_reactions_carry_the_weight():
    found = collapse_load(solids.leaf(), flow=ASSOCIATIVE)
    contacts = found.contacts
    total = contacts.vectors()[contacts.block_a == 0].sum(axis=0)
    weight = 2.0 * 1.4 * 0.2 * solids.UNIT_WEIGHT
    expected = [0.0, -found.load_multiplier * weight, weight]
    np.testing.assert_allclose(total, expected, atol=1e-7 * weight)


def test_what_hangs_falls_and_is_named():
    model = solids.one_block()
    loose = [solids.box(f"loose{i}", (5, 0, 1 + i), (5.4, 0.4, 2 + i)) for i in range(2)]
    model = solids.model_of((*model.assembly.blocks, *loose), law(0.6), push=(1, 0, 0))
    found = collapse_load(model)
    assert (found.status, found.moving) == ("unstable", ("loose0", "loose1"))
    assert not stands(model.assembly)


def test_a_load_straight_down_locks():
    model = block_under(law(0.5), 0.0)
    down = replace(model, load=replace(model.load, direction=np.array([0.0, 0.0, -1.0])))
    assert is_locked(down)
    assert collapse_load(down, flow=ASSOCIATIVE).status == "locked"


def test_a_block_between_supports_is_locked():
    """A pit: supports around it, on the side that the load pushes to."""
    blocks = [
        solids.box("base", (-2, -2, -0.3), (2, 2, 0), support=True),
        solids.box("block", (0, 0, 0), (0.4, 0.4, 0.4)),
        solids.box("wall", (0.4, -1, 0), (0.8, 1, 0.4), support=True),
    ]
    model = solids.model_of(blocks, law(0.5), push=(1, 0, 0))
    assert is_locked(model)
    away = solids.model_of(blocks, law(0.5), push=(-1, 0, 0))
    assert not is_locked(away)
    assert multiplier(away) == pytest.approx(0.5, abs=EXACT)


def test_a_block_leans_out_to_its_centroid_and_no_further():
    # The centroid of what is above over the lower block's edge: 0.5 of the width.
    for shift, standing in ((0.49, True), (0.51, False)):
        blocks = [
            *stack(widths=[1.0, 1.0], heights=[0.4, 0.4], offsets=[0.0, shift], unit_weight=1e4)
        ]
        plane = make_model(blocks, joint=law(0.6), thickness=0.7, load_direction=(1.0, 0.0))
        assert stands(extruded(plane).assembly) is standing


# non-associative


@pytest.mark.parametrize("angle", [0.0, 20.0, 57.0])
@pytest.mark.parametrize("friction", [0.1, 0.7])
def test_a_block_slides_without_opening_or_rocks(angle, friction):
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    expected = min(friction, B / (H * c), D / max(H * s, 1e-9))
    found = collapse_load(block_under(law(friction), angle))
    assert found.load_multiplier == pytest.approx(expected, abs=1e-8)
    assert found.collapse_range == pytest.approx((expected, expected), abs=1e-8)
    assert found.n_paths == 8
    certified(found)
    if friction < 0.2:  # along the load; off it by no more than `ASIDE`
        np.testing.assert_allclose(found.velocities[1, :3], [c, s, 0.0], atol=1e-4)


@pytest.mark.parametrize("wall", [1, 3])
def test_walls_in_space_fall_without_dilatancy_as_in_the_plane(wall):
    """With rounded corners every path ends at one multiplier, in the plane and here."""
    plane = published_wall(wall)
    expected = collapse_load(plane).load_multiplier
    found = collapse_load(extruded(plane), settings=NonAssociativeSettings(n_paths=2))
    assert found.load_multiplier == pytest.approx(expected, abs=1e-6)
    assert found.n_paths == 2
    certified(found)


def test_dilatancy_as_large_as_friction_is_the_associative_flow():
    joint = law(0.2, dilatancy_angle=float(np.degrees(np.arctan(0.2))))
    found = collapse_load(block_under(joint, 25.0), settings=NonAssociativeSettings(n_paths=1))
    assert found.load_multiplier == pytest.approx(0.2, abs=1e-8)
    slip, opening = np.hypot(*found.velocities[1, :2]), found.velocities[1, 2]
    assert opening == pytest.approx(0.2 * slip, abs=1e-4)


def test_what_only_dilatancy_locks_is_not_locked():
    """A block under a ceiling, which associated flow would have to lift.  How hard the ceiling
    presses, and where, is anyone's guess: what is found is at least friction alone."""
    blocks = [
        solids.box("base", (-2, -2, -0.3), (2, 2, 0), support=True),
        solids.box("block", (0, 0, 0), (0.4, 0.4, 0.4)),
        solids.box("ceiling", (-2, -2, 0.4), (2, 2, 0.6), support=True),
    ]
    model = solids.model_of(blocks, law(0.5), push=(0.6, 0.8, 0.0))
    assert collapse_load(model, flow=ASSOCIATIVE).status == "locked"
    assert not is_locked(model)
    found = collapse_load(model, settings=NonAssociativeSettings(n_paths=2))
    assert 0.5 - 1e-7 <= found.load_multiplier < found.collapse_range[1] == np.inf


def test_associative_multipliers_are_upper_bounds_in_space():
    for seed in range(3):
        associative, other = collapse_loads(
            crossed(seed), settings=NonAssociativeSettings(n_paths=2)
        )
        assert other.status == "finished", other.reason
        certified(other, still=2e-5)  # contacts slower than 1e-5 count as resting
        assert other.collapse_range[1] <= associative.load_multiplier + 1e-7
