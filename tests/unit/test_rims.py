"""Rounded edges that face each other at the ends of two faces: in space as in the plane.

A block of 1 m depth that lies on another one is tilted and shifted in the plane.  Contacts of the
plane are closed forms of their own, found by other code: a disc on an edge, or two discs.  In space
each of them is two, one on either side.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import drystone as ds
from drystone.contact.contacts import NONE, VERTEX_A, VERTEX_B, VERTICES
from drystone.contact.detection import Detector
from drystone.model.assembly import Corner
from solids import joint

pytestmark = pytest.mark.kernels

RADIUS = 0.02  # m


def stack():
    """Two blocks of 0.4 x 0.2 m, one on the other, flush at both ends."""
    outline = np.array([[0.0, 0.0], [0.4, 0.0], [0.4, 0.2], [0.0, 0.2]])
    blocks = [
        ds.Block(id="below", vertices=outline, unit_weight=10e3, support=True),
        ds.Block(id="above", vertices=outline + (0.0, 0.2), unit_weight=10e3),
    ]
    return ds.make_model(
        blocks,
        joint=joint(0.6),
        corner=Corner(radius=RADIUS),
        thickness=1.0,
        load_direction=(1.0, 0.0),
    )


def contacts(assembly, pose):
    detector = Detector(assembly)
    pairs = detector.pairs(pose)
    slots = detector.find(pairs, pose)
    return slots, np.flatnonzero(slots.kind != NONE)


def in_both(above):
    """Kinds, gaps and normals of the contacts in the plane; gaps and normals of those in space.

    ``above`` is the pose (x, y, turn) of the upper block, which turns about its centroid.
    """
    model = stack()
    solid = ds.extruded(model)
    flat, used = contacts(model.assembly, np.array([[0.0, 0.0, 0.0], above]))
    x, y, turn = above
    pose = solid.assembly.design_pose()
    pose[1] = (x, 0.0, y, np.cos(0.5 * turn), 0.0, -np.sin(0.5 * turn), 0.0)
    deep, taken = contacts(solid.assembly, pose)
    table = np.column_stack((flat.gap[used], flat.normal[used]))
    other = np.column_stack((deep.gap[taken], deep.normal[taken][:, [0, 2]]))
    return flat.kind[used], table, other


def hinged(turn, past, apart):
    """A turn of the upper block about its lower right end, which then lies by ``past`` [m] past the
    end of the block below and ``apart`` [m] above it."""
    arm = np.array([0.2, -0.1])
    c, s = np.cos(turn), np.sin(turn)
    x, y = arm - (c * arm[0] - s * arm[1], s * arm[0] + c * arm[1])
    return x + past, y + apart, turn


def at_hinge(seed):
    """A random tilt by up to 0.1 rad about ends that are flush to within where rims meet: both ends
    lie past the other face where `past` is between zero and the cores' distance times the turn."""
    rng = np.random.default_rng(seed)
    turn = -rng.uniform(0.002, 0.1)
    past = rng.uniform(-1.5, 1.5) * 2.0 * RADIUS * turn
    kinds, flat, solid = in_both(hinged(turn, past, -1e-4 * rng.uniform()))
    nearest = np.argmin(flat[:, 0])
    return kinds[nearest], flat[nearest], solid


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(100))
def test_a_contact_at_flush_ends_is_that_of_the_plane(seed):
    """Gaps are sums of some 0.4 m: 1e-12 is ten thousand times their rounding."""
    _, (gap, *normal), solid = at_hinge(seed)
    same = np.abs(solid[:, 0] - gap) < 1e-12
    assert same.sum() == 2
    np.testing.assert_allclose(solid[same, 1:], [normal] * 2, atol=1e-10)


@pytest.mark.compiled
def test_flush_ends_meet_in_every_way():
    """Else the cases above would not be those of the module."""
    assert {kind for kind, _, _ in map(at_hinge, range(100))} == {VERTEX_A, VERTEX_B, VERTICES}


@pytest.mark.parametrize("past", [-4e-4, 1e-5, 4e-4])
def test_rims_that_meet_touch_midway(past):
    """The upper block is turned by 0.03 about its lower right end, which is off the end below by
    less than the turn times the radius: then either core ends before the other one, seen along the
    other one's normal.
    """
    turn = -0.03
    pose = hinged(turn, -past, 0.0)
    c, s = np.cos(turn), np.sin(turn)
    edge = np.array([-RADIUS, RADIUS])  # of the upper core, from the hinge
    above = np.array([0.4 - past, 0.2]) + (c * edge[0] - s * edge[1], s * edge[0] + c * edge[1])
    below = np.array([0.4 - RADIUS, 0.2 - RADIUS])
    apart = above - below
    distance = np.hypot(*apart)
    model = ds.extruded(stack())
    place = model.assembly.design_pose()
    place[1] = (pose[0], 0.0, pose[1], np.cos(0.5 * turn), 0.0, -np.sin(0.5 * turn), 0.0)
    slots, used = contacts(model.assembly, place)
    at = used[np.argsort(slots.gap[used])[:2]]
    np.testing.assert_allclose(slots.gap[at], distance - 2.0 * RADIUS, atol=1e-14)
    np.testing.assert_allclose(slots.normal[at][:, [0, 2]], [apart / distance] * 2, atol=1e-12)
    middle = below + 0.5 * apart - model.assembly.centroid[0, [0, 2]]
    np.testing.assert_allclose(slots.arm_a[at][:, [0, 2]], [middle] * 2, atol=1e-12)


@pytest.mark.parametrize("twist", [0.0, 1e-6, -3e-4, 3e-4, 5e-3, -5e-3])
@pytest.mark.parametrize("turn", [0.0, 0.01, -0.01])
def test_edges_that_are_nearly_parallel_meet_at_both_ends(turn, twist):
    """The upper block lies beyond the end of the block below, and its lower left edge faces the
    upper right one there.  It is turned about the direction from edge to edge by ``twist``, and
    about a line across both by ``turn``.
    """
    model = ds.extruded(stack())
    below, above = model.assembly.centroid
    apart = np.array([0.6, 0.0, 0.8]) * 1.9 * RADIUS
    own = np.array([RADIUS - 0.2, 0.0, RADIUS - 0.1])  # middle of the core's edge
    edge = np.array([0.2 - RADIUS, 0.0, 0.1 - RADIUS])
    rotation = Rotation.from_rotvec(
        twist * np.array([0.6, 0.0, 0.8]) + turn * np.array([-0.8, 0.0, 0.6])
    )
    pose = model.assembly.design_pose()
    pose[1, :3] = below + edge + apart - rotation.apply(own) - above
    pose[1, 3:] = rotation.as_quat(scalar_first=True)
    slots, used = contacts(model.assembly, pose)
    half = np.array([0.0, 0.5 - RADIUS, 0.0])
    ends = [apart + rotation.apply(side * half) - side * half for side in (-1.0, 1.0)]
    # The turned edge ends first, seen along the other one, which is straight there.
    gaps = [np.hypot(end[0], end[2]) - 2.0 * RADIUS for end in ends]
    assert len(used) == 2
    at = used[np.argsort(slots.arm_a[used][:, 1])]
    np.testing.assert_allclose(slots.gap[at], gaps, atol=1e-12)
    np.testing.assert_allclose(slots.size[at], slots.size[at[0]])
