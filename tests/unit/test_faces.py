"""Faces of solids on each other: clipping, joints as designed in space, set-backs."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drystone.contact.space import overlap
from drystone.geometry.interfaces import Interfaces, corner_shares
from drystone.geometry.plane.outlines import TOUCHING
from drystone.geometry.space import faces, solid
from drystone.geometry.space.polyhedra import Polyhedra

pytestmark = pytest.mark.kernels

#: Numbers of the order of 1 m, to some rounding errors.
EXACT = 1e-13


def packed(*parts):
    """One block of one part each."""
    return Polyhedra.pack([[part] for part in parts])


def prism(outline, low, high):
    """A prism of an outline (n, 2) in x and y, from z = low to z = high [m]."""
    n = len(outline)
    vertices = np.vstack([np.column_stack((outline, np.full(n, z))) for z in (low, high)])
    around = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return vertices, (tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *around)


def regular(n, radius, at=(0.0, 0.0), turn=0.0):
    """A regular polygon, counter-clockwise."""
    angle = turn + 2 * np.pi * np.arange(n) / n
    return np.column_stack((np.cos(angle), np.sin(angle))) * radius + at


def area_of(corners):
    """Of a polygon in the plane z = 0."""
    x, y = corners[:, 0], corners[:, 1]
    return 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("turn", [(0, 0, 0), (0.3, -0.2, 0.9), (2.0, 1.0, 0.0)])
def test_a_joint_is_what_both_faces_cover(turn):
    rotation = Rotation.from_rotvec(turn)
    base = solid.box([[0, 0, -1], [2, 2, 0]])
    upper = solid.box([[1.5, 1.0, 0], [3, 3, 1]])
    away = solid.box([[5, 5, 0], [6, 6, 1]])
    parts = [(rotation.apply(vertices), f) for vertices, f in (base, upper, away)]
    joints = Interfaces.of(packed(*parts))
    assert (joints.block_a.tolist(), joints.block_b.tolist()) == ([0], [1])
    assert (joints.face_a.tolist(), joints.face_b.tolist()) == ([1], [6])  # its top; its bottom
    assert joints.size == pytest.approx([0.5 * 1.0], rel=EXACT)
    np.testing.assert_allclose(joints.normal, rotation.apply([[0.0, 0.0, 1.0]]), atol=EXACT)
    np.testing.assert_allclose(joints.tangent, rotation.apply([[1.0, 0.0, 0.0]]), atol=EXACT)
    back = rotation.inv().apply(joints.corners)
    expected = {(1.5, 1.0, 0.0), (2.0, 1.0, 0.0), (2.0, 2.0, 0.0), (1.5, 2.0, 0.0)}
    assert {tuple(np.round(corner, 12) + 0.0) for corner in back} == expected


@pytest.mark.parametrize("seed", range(20))
def test_random_prisms_share_what_points_in_both_of_them_say(seed):
    """Area against counting points of a grid, which is off by its spacing along the outlines."""
    rng = np.random.default_rng(seed)
    outlines = [
        regular(rng.integers(3, 8), rng.uniform(0.5, 1.0), rng.uniform(-0.5, 0.5, 2), rng.uniform())
        for _ in range(2)
    ]
    joints = Interfaces.of(packed(prism(outlines[0], -1.0, 0.0), prism(outlines[1], 0.0, 0.7)))
    grid = np.linspace(-1.6, 1.6, 400)
    points = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    inside = np.ones(len(points), bool)
    for outline in outlines:
        edge = np.roll(outline, -1, axis=0) - outline
        for start, (ex, ey) in zip(outline, edge, strict=True):
            arm = points - start
            inside &= ex * arm[:, 1] - ey * arm[:, 0] >= 0.0
    counted = inside.sum() * (grid[1] - grid[0]) ** 2
    lying = np.flatnonzero(joints.normal[:, 2] > 0.5)
    assert len(lying) == 1 and counted > 0.0
    own = joints.corners[joints.offset[lying[0]] : joints.offset[lying[0] + 1]]
    assert joints.size[lying[0]] == pytest.approx(area_of(own), rel=EXACT)
    assert joints.size[lying[0]] == pytest.approx(counted, rel=0.05)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_one_tolerance_of_the_smaller_block_tells_what_touches(side):
    small = solid.box([[0.5, 0.5, 0.0], [0.8, 0.9, 0.5]])
    size = np.linalg.norm([0.3, 0.4, 0.5])  # its diagonal
    for share, count in ((0.9, 1), (1.1, 0)):
        base = solid.box([[0, 0, -1], [2, 2, side * share * TOUCHING * size]])
        assert len(Interfaces.of(packed(base, small)).size) == count
    assert len(Interfaces.of(packed(base, small), distance=1e-3).size) == 1


def test_blocks_that_meet_along_an_edge_or_at_a_corner_share_no_joint():
    one = solid.box([[0, 0, 0], [1, 1, 1]])
    edge, corner = solid.box([[1, 0, 1], [2, 1, 2]]), solid.box([[1, 1, 1], [2, 2, 2]])
    joints = Interfaces.of(packed(one, edge, corner))
    assert list(zip(joints.block_a, joints.block_b, strict=True)) == [(1, 2)]  # along y = 1


def test_parts_of_one_block_share_no_joint():
    low, high = solid.box([[0, 0, 0], [1, 1, 1]]), solid.box([[0, 0, 1], [1, 1, 2]])
    beside = solid.box([[1, 0, 0], [2, 1, 2]])
    joints = Interfaces.of(Polyhedra.pack([[low, high], [beside]]))
    assert list(zip(joints.block_a, joints.block_b, strict=True)) == [(0, 1)] * 2
    np.testing.assert_allclose(joints.size, 1.0, rtol=EXACT)


def test_a_wall_of_boxes_has_as_many_joints_as_counted():
    """Three courses of three by two boxes, each on the one below: 4 + 3 head joints a course."""
    boxes = [
        solid.box([[i, j, k], [i + 1, j + 1, k + 1]])
        for k in range(3)
        for j in range(2)
        for i in range(3)
    ]
    joints = Interfaces.of(packed(*boxes))
    assert len(joints.size) == 3 * (4 + 3) + 2 * 6
    assert np.diff(joints.offset).tolist() == [4] * len(joints.size)
    np.testing.assert_allclose(joints.size, 1.0, rtol=EXACT)


def test_corners_go_round_the_normal():
    joints = Interfaces.of(packed(prism(regular(5, 1.0), -1, 0), prism(regular(4, 1.1), 0, 1)))
    (row,) = np.flatnonzero(joints.normal[:, 2] > 0.5)
    corners = joints.corners[joints.offset[row] : joints.offset[row + 1]]
    arm = corners - corners.mean(axis=0)
    assert np.all(np.cross(arm, np.roll(arm, -1, axis=0))[:, 2] > 0.0)


def test_shares_of_corners():
    """A quarter each in a rectangle, a third in a triangle, together one."""
    corners = np.array(
        [[0, 0, 0], [3, 0, 0], [3, 1, 0], [0, 1, 0], [0, 0, 1], [2, 0, 1], [0, 1, 1]]
    )
    shares = corner_shares(corners.astype(float), np.array([0, 4, 4, 7]))
    np.testing.assert_allclose(shares, [0.25] * 4 + [1 / 3] * 3, rtol=EXACT)
    np.testing.assert_array_equal(corner_shares(np.zeros((4, 2)), np.array([0, 2, 4])), 0.5)


def test_rounded_edges_put_corners_back_as_far_as_the_core_does():
    """r tan(a / 2) from every edge: of a box the radius, of a hexagonal prism r tan 30 degrees
    between its sides."""
    prisms = packed(prism(regular(6, 1.0), -1.0, 0.0))
    back = prisms.setbacks(np.full(8, 0.1))
    upright = np.abs(prisms.vertices[prisms.following] - prisms.vertices[prisms.rows])[:, 2] > 0.5
    np.testing.assert_allclose(back[upright], 0.1 * np.tan(np.radians(30)), rtol=EXACT)
    np.testing.assert_allclose(back[~upright], 0.1, rtol=EXACT)


def test_faces_at_seams_do_not_recede():
    """Where the block goes on behind a face at right angles, the edges of its neighbours stay."""
    box = packed(solid.box([[0, 0, 0], [1, 1, 1]]))
    back = box.setbacks(np.array([0.0, 0.1, 0.1, 0.1, 0.1, 0.1]))
    at_bottom = np.all(box.vertices[np.stack((box.rows, box.following))][..., 2] == 0.0, axis=0)
    side = box.face_of_edge > 0
    np.testing.assert_allclose(back[at_bottom & side], 0.0, atol=EXACT)
    np.testing.assert_allclose(back[~at_bottom], 0.1, rtol=EXACT)


def test_what_is_left_between_treated_edges():
    base, upper = solid.box([[0, 0, -1], [2, 2, 0]]), solid.box([[0.5, 1.0, 0], [3, 3, 1]])
    solids = packed(base, upper)
    joints = Interfaces.of(solids)
    corners, offset = joints.between_edges(solids, np.full(len(solids.rows), 0.1))
    assert offset.tolist() == [0, 4]
    np.testing.assert_allclose(corners.min(axis=0), [0.6, 1.1, 0.0], atol=EXACT)
    np.testing.assert_allclose(corners.max(axis=0), [1.9, 1.9, 0.0], atol=EXACT)
    corners, offset = joints.between_edges(solids, np.full(len(solids.rows), 0.5))
    assert offset.tolist() == [0, 0] and corners.shape == (0, 3)


@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-12, 1e-9])
def test_sides_in_one_line_widen_an_overlap_apart(off):
    """A corner amid the lowest side of a square, off it by a rounding: the two halves of the side
    move out by different lengths, and their lines meet nowhere near."""
    corner = np.zeros((1, 5, 2))
    corner[0] = [[0, 0], [0.5, -off], [1, 0], [1, 1], [0, 1]]
    reach = np.array([0.1, 0.3, 0.2, 0.2, 0.2])
    at_corners = 0.2 * (0.1 + 0.3 + 0.2 + 0.2)
    sides = 0.5 * (0.1 + 0.3) + 3 * 0.2
    gained = overlap.widened(corner, 0, 5, reach)
    assert gained == pytest.approx(sides + at_corners, abs=1e-8)


def test_clipping_keeps_what_lies_on_the_line():
    square = np.zeros((6, 3))
    square[:4, :2] = [[0, 0], [1, 0], [1, 1], [0, 1]]
    out = np.zeros((6, 3))
    assert faces.clip(square, 4, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, out) == 4  # along an edge
    assert faces.clip(square, 4, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, out) == 4
    assert out[:4, 0].min() == 0.5
    assert faces.clip(square, 4, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0, out) == 0
