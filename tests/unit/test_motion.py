"""Poses and increments in space, in Python and compiled, against scipy's rotations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drystone.geometry import motion, rotation

pytestmark = pytest.mark.kernels

ROUNDING = 1e-13  # of products of rotations


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(3)


def poses(random: np.random.Generator, n: int) -> np.ndarray:
    pose = motion.design_pose(n, 3)
    pose[:, :3] = random.normal(size=(n, 3))
    pose[:, 3:] = Rotation.random(n, random_state=1).as_quat(scalar_first=True)
    return pose


def axes_of(n: int) -> np.ndarray:
    return Rotation.random(n, random_state=2).as_matrix()


def test_an_increment_turns_a_body_about_its_own_axes(random: np.random.Generator) -> None:
    pose, axes, increment = poses(random, 40), axes_of(40), random.normal(size=(40, 6))
    after = motion.moved(pose, increment, axes)
    before = Rotation.from_quat(pose[:, 3:], scalar_first=True)
    own = Rotation.from_rotvec(np.einsum("nij,nj->ni", axes, increment[:, 3:]))
    np.testing.assert_allclose(
        Rotation.from_quat(after[:, 3:], scalar_first=True).as_matrix(),
        (before * own).as_matrix(),
        atol=ROUNDING,
    )
    np.testing.assert_allclose(after[:, :3], pose[:, :3] + increment[:, :3], atol=ROUNDING)


def test_difference_is_the_inverse_of_moved(random: np.random.Generator) -> None:
    pose, axes = poses(random, 40), axes_of(40)
    for size in (1.0, 1e-3, 1e-9, 0.0):
        increment = size * random.normal(size=(40, 6))
        increment[:, 3:] *= 0.5  # below half a turn
        back = motion.difference(motion.moved(pose, increment, axes), pose, axes)
        np.testing.assert_allclose(back, increment, rtol=1e-6, atol=1e-15)


def test_small_rotations_are_as_precise_as_they_are_small() -> None:
    """From rest, a turn of 1e-12 rad is known to its own rounding, not to that of one."""
    pose, turn = motion.design_pose(1, 3), np.array([[0.0, 0.0, 0.0, 1e-12, -2e-12, 3e-12]])
    after = motion.moved(pose, turn, np.eye(3)[None])
    arm = np.array([0.3, -0.7, 1.1])
    expected = np.cross(turn[0, 3:], arm)
    np.testing.assert_allclose(motion.displacement(arm, after[0]), expected, rtol=1e-11)


def test_points_and_vectors_go_with_their_body(random: np.random.Generator) -> None:
    pose, centroid = poses(random, 5), random.normal(size=(5, 3))
    owner, points = np.repeat(np.arange(5), 4), random.normal(size=(20, 3))
    turn = Rotation.from_quat(pose[owner, 3:], scalar_first=True)
    expected = centroid[owner] + pose[owner, :3] + turn.apply(points - centroid[owner])
    moved = motion.moved_points(points, owner, centroid, pose)
    np.testing.assert_allclose(moved, expected, atol=ROUNDING)
    np.testing.assert_allclose(
        motion.rotated(points, pose[owner]), turn.apply(points), atol=ROUNDING
    )


def test_compiled_rotations_are_the_same(random: np.random.Generator) -> None:
    pose, axes = poses(random, 6), np.tile(np.eye(3), (6, 1, 1))
    for size in (1.0, 1e-5, 1e-10):
        increment = np.zeros((6, 6))
        increment[:, 3:] = size * random.normal(size=(6, 3))
        expected, spun = motion.moved(pose, increment, axes), pose.copy()
        less, matrix = np.zeros((6, 3, 3)), np.zeros((6, 3, 3))
        for i in range(6):
            rotation.spin(spun, i, *increment[i, 3:])
            rotation.place_axes(spun, i, axes, less, matrix)
            x, y, z = rotation.rotate_by(*spun[i, 3:], 0.2, 0.5, -0.4)
            there = np.array([0.2, 0.5, -0.4]) + (x, y, z)
            np.testing.assert_allclose(there, matrix[i] @ (0.2, 0.5, -0.4), atol=ROUNDING)
        np.testing.assert_allclose(spun, expected, atol=ROUNDING)
        known = Rotation.from_quat(spun[:, 3:], scalar_first=True).as_matrix()
        np.testing.assert_allclose(matrix, known, atol=ROUNDING)
        np.testing.assert_allclose(less, known - np.eye(3), atol=ROUNDING)


@pytest.mark.compiled
def test_a_million_turns_leave_the_quaternion_at_length_one() -> None:
    pose = motion.design_pose(1, 3)
    _spin_often(pose)
    assert abs(np.linalg.norm(pose[0, 3:]) - 1.0) <= 1e-12


def _spin_often(pose: np.ndarray) -> None:
    for k in range(1_000_000):
        rotation.spin(pose, 0, 1e-3, -2e-3 + 1e-9 * k, 3e-3)
