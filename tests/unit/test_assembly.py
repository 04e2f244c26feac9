"""Blocks to arrays: masses, laws by pair, and where a moved block's points are."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.geometry import GeometryError
from drystone.model.assembly import GRAVITY, Assembly, Block, Corner
from drystone.model.joint_law import JointLaw
from drystone.model.loading import Acting, MassPattern, dead_load

LAW = JointLaw(friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11)
SMOOTH = JointLaw(friction_coefficient=0.1, normal_stiffness=1e8, shear_stiffness=1e11)
ROUGH = JointLaw(friction_coefficient=0.9, normal_stiffness=1e8, shear_stiffness=1e11)
ROUNDING = 1e-13


def block(name, x, y, width=0.4, height=0.9, **more):
    vertices = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
    return Block(id=name, vertices=np.array(vertices), unit_weight=10e3, **more)


@pytest.fixture
def assembly():
    """A base and two columns upon it, of brick and of stone."""
    return Assembly.build(
        [
            block("base", -1.0, -0.2, 2.0, 0.2, support=True, material="stone"),
            block("left", -0.6, 0.0, material="stone"),
            block("right", 0.2, 0.0, material="brick"),
        ],
        joint=LAW,
        thickness=0.5,
        joint_between={
            frozenset(("brick", "stone")): SMOOTH,
            frozenset(("right", "left")): ROUGH,
        },
    )


def test_counts(assembly):
    assert (assembly.n_bodies, assembly.n_blocks, assembly.n_supports) == (3, 2, 1)
    assert assembly.n_dof == 3
    assert assembly.ids == ("base", "left", "right")
    assert assembly.fixed.tolist() == [True, False, False]


def test_weight_and_mass_of_a_rectangle(assembly):
    # W = gamma b h t; m = W/g; I = m (b^2 + h^2)/12.
    weight = 10e3 * 0.4 * 0.9 * 0.5
    assert assembly.weight[1] == pytest.approx(weight, rel=ROUNDING)
    assert assembly.heaviest_weight == pytest.approx(weight, rel=ROUNDING)
    inertia = weight / GRAVITY * (0.4**2 + 0.9**2) / 12.0
    assert assembly.mass[1] == pytest.approx(
        [weight / GRAVITY, weight / GRAVITY, inertia], rel=ROUNDING
    )
    assert assembly.centroid[2] == pytest.approx([0.4, 0.45], rel=ROUNDING)


def test_corners_do_not_change_the_mass():
    sharp = Assembly.build([block("a", 0, 0)], joint=LAW)
    for corner in (Corner(radius=0.02), Corner(chamfer=0.02)):
        treated = Assembly.build([block("a", 0, 0)], joint=LAW, corner=corner)
        assert np.array_equal(treated.mass, sharp.mass)


def test_shapes_are_relative_to_the_centroid(assembly):
    half = np.array([0.2, 0.45])
    assert assembly.shapes.of(2) == pytest.approx(
        half * [[-1, -1], [1, -1], [1, 1], [-1, 1]], abs=ROUNDING
    )


def test_law_of_a_pair_by_block_goes_before_that_by_material(assembly):
    a, b = np.array([0, 0, 1]), np.array([1, 2, 2])
    laws = [assembly.laws[k] for k in assembly.law_index(a, b)]
    assert laws == [LAW, SMOOTH, ROUGH]


def test_laws_of_many_pairs_are_those_of_each():
    blocks = [block(f"b{i}", 0.4 * i, 0, material="abc"[i % 3], support=i == 0) for i in range(9)]
    between = {
        frozenset(("a", "b")): SMOOTH,
        frozenset(("c",)): ROUGH,
        frozenset(("b1", "b3")): LAW,  # the default again, before that of the materials
        frozenset(("b4", "b2")): ROUGH,
    }
    assembly = Assembly.build(blocks, joint=LAW, joint_between=between)
    a, b = np.nonzero(~np.eye(9, dtype=bool))  # both ways round
    for i, j, k in zip(a, b, assembly.law_index(a, b), strict=True):
        of_materials = between.get(frozenset(("abc"[i % 3], "abc"[j % 3])), LAW)
        law = between.get(frozenset((f"b{i}", f"b{j}")), of_materials)
        assert assembly.laws[k] == law


def test_index_by_name(assembly):
    assert assembly.index("right") == 2
    with pytest.raises(KeyError, match="middle"):
        assembly.index("middle")


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0])
def test_displacement_of_a_point_is_that_of_the_moved_outline(assembly, angle):
    pose = assembly.design_pose()
    pose[1] = (0.1, -0.05, angle)
    moved = assembly.outline(1, pose)
    for corner, place in zip(assembly.outline(1), moved, strict=True):
        displacement = assembly.displacement_at(1, corner, pose)
        assert displacement == pytest.approx(place - corner, abs=ROUNDING)


def test_quarter_turn(assembly):
    # (0.2, 0.45) from the centroid turns into (-0.45, 0.2).
    pose = assembly.design_pose()
    pose[1, 2] = np.pi / 2
    corner = assembly.centroid[1] + (0.2, 0.45)
    assert assembly.displacement_at(1, corner, pose) == pytest.approx([-0.65, -0.25], abs=ROUNDING)


def test_loads_leave_supports_alone(assembly):
    direction = np.array([0.6, 0.8])
    acting = Acting.of(assembly, MassPattern(direction=direction))
    forces = acting.pattern.wrenches(assembly)
    assert not forces[0].any()
    assert forces[1] == pytest.approx([0.6 * 1800.0, 0.8 * 1800.0, 0.0], rel=ROUNDING)
    assert dead_load(assembly)[:, 1] == pytest.approx([0.0, -1800.0, -1800.0], rel=ROUNDING)
    assert acting.total == pytest.approx(3600.0, rel=ROUNDING)


def test_impossible_outline_names_the_block():
    with pytest.raises(GeometryError, match='block "b": the vertices run clockwise'):
        clockwise = Block(
            id="b", vertices=np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]), unit_weight=1e4
        )
        Assembly.build([block("a", 0, 0), clockwise], joint=LAW)
