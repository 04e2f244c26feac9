"""Joints as designed: which faces lie on each other, where, and by which tolerance."""

import numpy as np
import pytest
import synthetic

from builders import rectangle
from drystone.geometry.interfaces import Interfaces
from drystone.geometry.plane.outlines import TOUCHING, Outlines


def found(*outlines, distance=None):
    return Interfaces.of(
        Outlines.pack([[np.array(outline, float)] for outline in outlines]), distance
    )


def test_joints_of_a_running_bond():
    # Four courses of three blocks: 2 head joints in each; 3 bed joints on the base, and 5 between
    # two courses, whose three and three edges start and end together.
    assert len(synthetic.wall_model().assembly.interfaces.block_a) == 4 * 2 + 3 + 3 * 5


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2])
def test_a_joint_is_what_both_faces_cover(angle):
    """A triangle on a rectangle, and one away from it."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    pair = (rectangle(0, 0, 2, 1), np.array([[1.5, 1], [3, 1], [3, 2.0]]), rectangle(5, 1, 1, 1))
    joints = found(*(outline @ turn for outline in pair))
    assert (joints.block_a.tolist(), joints.block_b.tolist()) == ([0], [1])
    assert (joints.face_a.tolist(), joints.face_b.tolist()) == ([2], [4])  # of 4 and 3 faces
    # Places of the order of 1 m, to some rounding errors.
    np.testing.assert_allclose(joints.normal[0], np.array([0.0, 1.0]) @ turn, atol=1e-14)
    # Block a to the left of the way along the points: from right to left on its upper face.
    np.testing.assert_allclose(joints.ends[0], np.array([[2, 1], [1.5, 1.0]]) @ turn, atol=1e-14)
    assert joints.size == pytest.approx([0.5], rel=1e-14)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_one_tolerance_of_the_smaller_block_tells_what_touches(side):
    smaller = 0.5  # m, the longer side of the upper block
    for share, joints in ((0.9, 1), (1.1, 0)):
        pair = rectangle(0, 0, 2, 1), rectangle(0, 1 + side * share * TOUCHING * smaller, 0.5, 0.3)
        assert len(found(*pair).block_a) == joints
        if side > 0.0:
            outlines = Outlines.pack([[outline] for outline in pair])
            row = np.array([0]), np.array([1])
            assert outlines.touching(*row).tolist() == [bool(joints)]
        assert len(found(*pair, distance=1e-3).block_a) == 1


def test_what_is_left_between_treated_corners():
    """The nearer corner ends it at either side; short joints have nothing left."""
    outlines = Outlines.pack([[rectangle(0, 0, 1, 0.4)], [rectangle(0.1, 0.4, 1, 0.5)]])
    joints = Interfaces.of(outlines)
    for back, left in ((0.03, [[0.97, 0.4], [0.13, 0.4]]), (0.46, None)):
        corners, offset = joints.between_edges(outlines, np.full((8, 2), back))
        assert offset.tolist() == [0, 2 if left else 0]
        if left:
            np.testing.assert_allclose(corners, left, atol=1e-14)
