"""The detector over solids: joints' areas with treated edges, turned models, seams, histories."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import buildings
import drystone as ds
from drystone.contact.contacts import NONE, STIFF_N, STIFF_T, A, B
from drystone.contact.detection import Detector
from drystone.engines.frame import Frame
from drystone.geometry.space import solid
from drystone.law.columns import MU
from drystone.model.assembly import Assembly, Block, Corner
from solids import box, joint, leaf, one_block, turned

pytestmark = pytest.mark.kernels

TOUCHING = 1e-9  # m


def found(assembly: Assembly):
    detector, pose = Detector(assembly), assembly.design_pose()
    pairs = detector.pairs(pose)
    return detector, pairs, detector.find(pairs, pose)


def level_area(assembly: Assembly) -> float:
    _, _, slots = found(assembly)
    used = (slots.kind > 0) & (np.abs(slots.gap) < TOUCHING)
    return float(slots.size[used & (np.abs(slots.normal @ assembly.up) > 0.9)].sum())


@pytest.mark.parametrize("corner", [Corner(), Corner(radius=0.02), Corner(chamfer=0.02)])
@pytest.mark.parametrize("points", [4, 9, 16])
def test_a_joint_has_its_whole_area_whatever_is_taken_off_its_edges(corner, points):
    """0.4 x 0.6 m, as stiffness is per area of the joint that was drawn."""
    assembly = one_block(corner=corner, points=points).assembly
    assert level_area(assembly) == pytest.approx(0.24, rel=1e-9)


@pytest.mark.compiled
def test_bed_joints_of_an_extruded_wall_are_those_of_the_plane():
    plane = ds.published_wall(1)
    assert level_area(ds.extruded(plane).assembly) == pytest.approx(
        level_area(plane.assembly) * plane.assembly.thickness, rel=1e-9
    )


@pytest.mark.compiled
def test_a_leaf_turned_as_a_whole_has_the_same_contacts():
    model = leaf(courses=3)
    other = turned(model, Rotation.from_rotvec([0.4, -0.7, 1.1]), (3.0, -2.0, 5.0))
    rotation = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
    (_, first_pairs, first), (_, second_pairs, second) = (found(m.assembly) for m in (model, other))

    def table(pairs, slots, back):
        used = np.flatnonzero((slots.kind > 0) & (np.abs(slots.gap) < TOUCHING))
        which = pairs.which[pairs.of_slot[used]]
        rows = np.column_stack(
            (which[:, :2], slots.size[used], slots.normal[used] @ back, slots.arm_a[used] @ back)
        )
        return rows[np.lexsort(np.round(rows, 6).T)]

    a = table(first_pairs, first, np.eye(3))
    b = table(second_pairs, second, rotation)
    assert a.shape == b.shape
    np.testing.assert_allclose(a, b, atol=1e-9)


def test_seams_of_a_concave_block_are_no_contacts():
    """A U stands on its two feet: 2 x 0.2 x 0.5 m2, and touches nothing of itself."""
    outline = np.array(
        [[0, 0], [0.2, 0], [0.2, 0.4], [0.6, 0.4], [0.6, 0], [0.8, 0], [0.8, 0.6], [0, 0.6]], float
    )
    vertices, faces = solid.extruded(outline, (0.0, 0.5))
    blocks = [
        box("base", (-1.0, -1.0, -0.3), (2.0, 2.0, 0.0), support=True),
        Block(id="u", vertices=vertices, faces=faces, unit_weight=10e3),
    ]
    assembly = Assembly.build(blocks, joint=joint(0.6))
    assert len(assembly.shapes.radius) > 2
    _, pairs, _ = found(assembly)
    assert (pairs.a != pairs.b).all()
    assert level_area(assembly) == pytest.approx(0.2, rel=1e-9)


def test_packed_contacts_balance_and_weigh_by_their_area():
    model = one_block(stiffness=1e9)
    detector, pairs, slots = found(model.assembly)
    laws = np.zeros((1, 7))
    laws[0, MU], laws[0, 1], laws[0, 2] = 0.7, 1e9, 5e8
    contacts = detector.pack(pairs, model.assembly.design_pose(), slots, laws)
    assert contacts.rows.shape == (4, 5, 12)
    np.testing.assert_allclose(contacts.rows[:, :, :3], -contacts.rows[:, :, 6:9], atol=1e-15)
    np.testing.assert_allclose(contacts.rows[:, 1:3], contacts.rows[:, 3:5], atol=0.0)
    assert contacts.table[:, STIFF_N].sum() == pytest.approx(1e9 * 0.24)
    assert contacts.table[:, STIFF_T].sum() == pytest.approx(5e8 * 0.24)


@pytest.mark.compiled
def test_no_contact_is_without_a_joint():
    """Two stones of a dome, apart, whose faces overlap in a triangle; one of its corners has no
    share of the area, and without stiffness no step is solved."""
    drawn = buildings.dome().assembly
    assembly = Frame.of(drawn).assembly(drawn)
    detector, pose = Detector(assembly), assembly.design_pose()
    pose[19] = 0.008857, 0.044211, 0.001658, 0.999577, -0.011035, 0.024977, 0.010043
    pose[30] = 0.020606, 0.053465, 0.008265, 0.99945, -0.013373, 0.02818, 0.011282
    pairs = detector.pairs(pose)
    slots = detector.find(pairs, pose)
    used = slots.kind != NONE
    assert np.all(slots.size[used] > 0.0)
    of = pairs.which[pairs.of_slot]
    assert np.count_nonzero(used & (of[:, A] == 19) & (of[:, B] == 30)) == 2
