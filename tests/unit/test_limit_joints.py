"""Contact points and the equilibrium matrix."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from builders import rectangle
from drystone.geometry.motion import moments
from drystone.limit.equilibrium import Equilibrium
from drystone.limit.joints import contact_points
from drystone.model.assembly import Assembly, Block, Corner
from drystone.model.builders import coursed_wall
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern

LAW = JointLaw(friction_coefficient=0.6, normal_stiffness=None, shear_stiffness=None)
RIGHT = MassPattern(direction=np.array([1.0, 0.0]))


def pair(corner=None, *, shift=0.1, law=LAW, thickness=1.0):
    blocks = [
        Block(id="base", vertices=rectangle(0, 0, 1, 0.4), unit_weight=1e4, support=True),
        Block(id="top", vertices=rectangle(shift, 0.4, 1, 0.5), unit_weight=2e4),
    ]
    return Assembly.build(blocks, joint=law, corner=corner, thickness=thickness)


def test_points_at_the_ends_of_a_sharp_joint():
    points = contact_points(pair())
    order = np.argsort(points.position[:, 0])
    np.testing.assert_allclose(points.position[order], [[0.1, 0.4], [1.0, 0.4]], atol=1e-12)
    np.testing.assert_allclose(points.frame[:, 0], [[0.0, 1.0]] * 2, atol=1e-12)
    np.testing.assert_allclose(points.frame[:, 1], [[1.0, 0.0]] * 2, atol=1e-12)
    assert points.area == pytest.approx([0.45, 0.45])


@pytest.mark.parametrize("corner", [Corner(radius=0.03), Corner(chamfer=0.03)])
def test_each_end_is_set_back_by_the_corner_that_is_there(corner):
    # Left the corner of the upper block ends the joint, right that of the base.
    points = contact_points(pair(corner))
    assert sorted(points.position[:, 0]) == pytest.approx([0.13, 0.97])
    assert points.area == pytest.approx([0.45, 0.45])  # the designed joint


def test_the_nearer_of_two_corners_counts():
    points = contact_points(pair(Corner(radius=0.03), shift=0.01))
    assert sorted(points.position[:, 0]) == pytest.approx([0.04, 0.97])


def test_joint_shorter_than_its_corners_has_no_points():
    assert contact_points(pair(Corner(radius=0.03), shift=0.95)).n_contacts == 0
    assert contact_points(pair(shift=0.95)).n_contacts == 2


def test_strengths_are_shares_of_the_joint():
    law = JointLaw(
        friction_coefficient=0.6,
        normal_stiffness=None,
        shear_stiffness=None,
        cohesion=100.0,
        tensile_strength=20.0,
        dilatancy_angle=10.0,
    )
    points = contact_points(pair(law=law, thickness=0.5))
    assert points.cohesion.sum() == pytest.approx(100.0 * 0.9 * 0.5)
    assert points.tension.sum() == pytest.approx(20.0 * 0.9 * 0.5)
    assert points.dilatancy == pytest.approx(np.tan(np.radians(10.0)))


def test_two_supports_share_no_contact():
    blocks = [
        Block(id="a", vertices=rectangle(0, 0, 1, 1), unit_weight=1e4, support=True),
        Block(id="b", vertices=rectangle(1, 0, 1, 1), unit_weight=1e4, support=True),
        Block(id="c", vertices=rectangle(0, 1, 1, 1), unit_weight=1e4),
    ]
    points = contact_points(Assembly.build(blocks, joint=LAW))
    assert set(zip(points.block_a, points.block_b, strict=True)) == {(0, 2)}


@pytest.fixture(scope="module")
def wall():
    blocks = coursed_wall(
        unit=(0.4, 0.2), courses=("h11h", "111"), repeat=2, base=True, unit_weight=1e4
    )
    return Equilibrium.of(Assembly.build(blocks, joint=LAW), RIGHT)


@given(data=st.data())
def test_transpose_takes_velocities_to_contacts(wall, data):
    """B^T u against the velocities of the two material points, computed by hand."""
    assembly, points = wall.assembly, wall.points
    numbers = st.floats(-1.0, 1.0)
    n = len(wall.dead)
    scaled = np.array(data.draw(st.lists(numbers, min_size=n, max_size=n)))
    velocities = wall.block_velocities(scaled)

    def of(block):
        arm = points.position - assembly.centroid[block]
        turn = np.column_stack((-arm[:, 1], arm[:, 0])) * velocities[block, 2:]
        return velocities[block, :2] + turn

    jump = of(points.block_b) - of(points.block_a)
    expected = np.einsum("kij,kj->ki", points.frame, jump)
    np.testing.assert_allclose(wall.relative(scaled), expected, atol=1e-12)


def test_rigid_motion_of_everything_does_not_open_inner_joints(wall):
    velocities = np.tile([0.3, -0.2, 0.0], wall.assembly.n_blocks)
    inner = (wall.points.block_a != 0) & (wall.points.block_b != 0)
    np.testing.assert_allclose(wall.relative(velocities)[inner], 0.0, atol=1e-12)


def test_moments_in_a_plane_are_those_in_space():
    rng = np.random.default_rng(1)
    arm, force = rng.normal(size=(2, 5, 2))
    flat = moments(arm, force)
    arm, force = (np.column_stack((v, np.zeros(5))) for v in (arm, force))
    np.testing.assert_allclose(flat[:, 0], moments(arm, force)[:, 2], atol=1e-15)
