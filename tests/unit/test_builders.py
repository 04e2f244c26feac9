"""Walls built in Python, the checks that every model passes, and what `inspect` counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drystone.model.assembly import Block, Corner
from drystone.model.builders import (
    PUBLISHED_WALLS,
    ModelError,
    coursed_wall,
    make_model,
    model_to_dict,
    published_wall,
)
from drystone.model.builders.column import column
from drystone.model.builders.dome import dome
from drystone.model.builders.panel import panel
from drystone.model.construction.vary import remade
from drystone.model.inspection import inspect
from drystone.model.joint_law import JointLaw

LAW = JointLaw(friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11)


def rectangle(name, x, y, width, height, **more):
    vertices = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
    return Block(id=name, vertices=np.array(vertices, dtype=float), unit_weight=10e3, **more)


def tilted(blocks, angle):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    return [
        Block(id=b.id, vertices=b.vertices @ turn, unit_weight=b.unit_weight, support=b.support)
        for b in blocks
    ]


def model_of(blocks, **more):
    settings = {"joint": LAW, "thickness": 1.0, "load_direction": (1.0, 0.0), **more}
    return make_model(blocks, **settings)


BASE = rectangle("base", -1.0, -0.2, 2.0, 0.2, support=True)


class TestCoursedWall:
    def test_ids_count_real_units_from_the_left(self):
        blocks = coursed_wall(unit=(0.4, 0.2), courses=["h1.1h", "11"], unit_weight=1e4)
        assert [b.id for b in blocks] == ["c1u1", "c1u2", "c1u3", "c1u4", "c2u1", "c2u2"]

    def test_void_is_one_unit_wide(self):
        # h 1 . 1: half a unit, a unit to 0.6 m, nothing to 1.0 m, a unit.
        blocks = coursed_wall(unit=(0.4, 0.2), courses=["h1.1"], unit_weight=1e4)
        assert [b.vertices[0, 0] for b in blocks] == pytest.approx([0.0, 0.2, 1.0])

    def test_neighbours_share_their_coordinates_to_the_last_bit(self):
        blocks = coursed_wall(unit=(0.3, 0.1), courses=["h" * 30, "1" * 15], unit_weight=1e4)
        right_edges = {b.vertices[1, 0] for b in blocks[:-1]}
        assert all(b.vertices[0, 0] in right_edges | {0.0} for b in blocks)

    def test_base_reaches_one_unit_beyond_and_below(self):
        base = coursed_wall(
            unit=(0.4, 0.2), courses=["11", "111"], base=True, unit_weight=1e4, origin=(5.0, 3.0)
        )[0]
        assert base.id == "base"
        assert base.support
        assert base.vertices.min(axis=0) == pytest.approx([4.6, 2.8])
        assert base.vertices.max(axis=0) == pytest.approx([6.6, 3.0])

    def test_repeat(self):
        blocks = coursed_wall(unit=(0.4, 0.2), courses=["11", "h1h"], repeat=3, unit_weight=1e4)
        assert len(blocks) == 15
        assert blocks[-1].id == "c6u3"
        assert blocks[-1].vertices[2] == pytest.approx([0.8, 1.2])

    def test_unknown_letter(self):
        with pytest.raises(ModelError, match=r'courses\[2\]: has "x" as letter 3'):
            coursed_wall(unit=(0.4, 0.2), courses=["11", "11x"], unit_weight=1e4)


class TestPublishedWalls:
    @pytest.mark.parametrize("number", PUBLISHED_WALLS)
    def test_counts_of_the_literature(self, number):
        # Blocks and joints: Ferris & Tin-Loi (2001) and Baggio & Trovalusci (1998).
        found = inspect(published_wall(number))
        assert found.n_blocks == {1: 33, 2: 55, 3: 46}[number]
        assert found.n_joints == {1: 83, 2: 141, 3: 102}[number]
        assert found.n_contacts == 2 * found.n_joints
        assert found.n_supports == 1

    @pytest.mark.parametrize("number", PUBLISHED_WALLS)
    def test_counts_of_the_table(self, number):
        found = inspect(published_wall(number))
        wall = PUBLISHED_WALLS[number]
        assert (found.n_blocks, found.n_joints) == (wall.n_blocks, wall.n_joints)

    def test_weight_of_wall_1(self):
        # 2 m x 1.05 m x 1 m of 10 kN/m3, without voids.
        assert inspect(published_wall(1)).weight == pytest.approx(21e3, rel=1e-12)

    @pytest.mark.parametrize(
        ("number", "block", "point"),
        [(1, "c6u5", (2.0, 1.05)), (2, "c10u5", (2.0, 1.75)), (3, "c11u4", (1.6, 1.925))],
    )
    def test_control_point_is_the_upper_right_corner_of_the_upper_right_block(
        self, number, block, point
    ):
        found = inspect(published_wall(number))
        assert found.control_block == block
        assert found.control_point == pytest.approx(point)

    def test_there_are_three(self):
        with pytest.raises(ValueError, match="no wall 4"):
            published_wall(4)

    def test_digest_is_of_the_content(self):
        assert published_wall(1).sha256 == published_wall(1).sha256
        assert published_wall(1).sha256 != published_wall(2).sha256
        assert len(published_wall(1).sha256) == 64


@pytest.mark.parametrize(("strength", "points", "said"), [(0.0, 2, 0), (5e4, 2, 1), (5e4, 9, 0)])
def test_bonds_that_hang_on_the_contact_points(strength, points, said):
    """With a point at each end a bond in bending carries f b^2 / 2, else f b^2 / 6."""
    joint = replace(published_wall(1).assembly.joint, cohesion=1e5, tensile_strength=strength)
    found = inspect(remade(published_wall(1), joint=joint, points=points))
    assert (
        sum("in bending may carry three times" in sentence for sentence in found.warnings) == said
    )
    assert not any("three times" in sentence for sentence in found.problems)


class TestControlPoint:
    TWO = (BASE, rectangle("a", -0.6, 0.0, 0.4, 0.9), rectangle("b", 0.2, 0.0, 0.4, 0.9))

    @pytest.mark.parametrize(
        ("direction", "block", "point"),
        [((1, 0), "b", (0.6, 0.9)), ((-1, 0), "a", (-0.6, 0.9)), ((3, -1), "b", (0.6, 0.9))],
    )
    def test_default_is_highest_then_furthest_along_the_load(self, direction, block, point):
        model = model_of(self.TWO, load_direction=direction)
        assert model.assembly.ids[model.control_point.block] == block
        assert model.control_point.point == pytest.approx(point)
        assert model.control_point.direction == pytest.approx(
            np.array(direction) / np.hypot(*direction)
        )

    @pytest.mark.parametrize(
        ("name", "point"),
        [
            ("top right", (-0.2, 0.9)),
            ("top left", (-0.6, 0.9)),
            ("bottom right", (-0.2, 0.0)),
            ("bottom left", (-0.6, 0.0)),
            ("centre", (-0.4, 0.45)),
            ((-0.2, 0.3), (-0.2, 0.3)),  # on the outline
        ],
    )
    def test_points_by_name_and_place(self, name, point):
        model = model_of(self.TWO, control_block="a", control_point=name)
        assert model.control_point.point == pytest.approx(point)

    def test_named_corner_of_a_tilted_block(self):
        upright = model_of(self.TWO, control_block="b", control_point="top left")
        leaning = model_of(
            tilted(self.TWO, np.radians(10.0)), control_block="b", control_point="top left"
        )
        assert np.hypot(*leaning.control_point.point) == pytest.approx(
            np.hypot(*upright.control_point.point)
        )


class TestChecks:
    def problems(self, *args, **kwargs):
        with pytest.raises(ModelError) as caught:
            model_of(*args, **kwargs)
        return caught.value.problems

    def test_overlap_says_which_and_by_how_much(self):
        (problem,) = self.problems([BASE, rectangle("a", 0, -0.005, 0.4, 0.9)])
        assert problem.startswith('block "base" and block "a" overlap by 5 mm')

    @pytest.mark.parametrize(("overlap", "fine"), [(1e-8, True), (1e-5, False)])
    def test_overlap_within_the_rounding_of_coordinates_is_none(self, overlap, fine):
        blocks = [BASE, rectangle("a", 0, -overlap, 0.4, 0.9)]
        exact = {"drawing_tolerance": 0.0}
        assert model_of(blocks, **exact) if fine else self.problems(blocks, **exact)

    def test_gap_says_how_far(self):
        (problem,) = self.problems([BASE, rectangle("a", 0, 0.004, 0.4, 0.9)])
        assert problem.startswith('block "a" touches no other block (block "base" is nearest, 4 mm')

    def test_gap_to_a_corner_counts_where_boxes_meet(self):
        # A triangle under the slope of another: their boxes overlap, they do not touch.
        lower = Block(id="t", vertices=np.array([[0, 0], [1, 0], [0, 1.0]]), unit_weight=1e4)
        upper = Block(id="u", vertices=np.array([[1, 0.5], [1, 1], [0.5, 1.0]]), unit_weight=1e4)
        (problem,) = self.problems([BASE, lower, upper])
        assert problem.startswith('block "u" touches no other block')

    def test_all_problems_at_once(self):
        blocks = [
            rectangle("a", 0, 0, 1, 1),
            rectangle("a", 1, 0, 1, 1),
            Block(id="c", vertices=np.array([[0, 0], [1, 1], [2, 2.0]]), unit_weight=1e4),
            rectangle("d", 2, 0, 1, 0.03),
        ]
        problems = self.problems(blocks, corner=Corner(radius=0.02))
        assert any('block "a": the id is taken' in p for p in problems)
        assert any('block "c" vertices: the outline encloses no area' in p for p in problems)
        assert any('corner, at block "d"' in p for p in problems)

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            ({"thickness": 0.0}, "thickness"),
            ({"load_direction": (0.0, 0.0)}, "load.direction: has no length"),
            ({"control_block": "base"}, "is a support"),
            ({"control_block": "aa"}, 'did you mean "a"'),
            ({"control_point": (3.0, 3.0)}, "is not on block"),
            ({"joint_between": {frozenset(("a", "z")): LAW}}, 'joint.between."a z"'),
        ],
    )  # fmt: skip
    def test_settings(self, change, said):
        problems = self.problems([BASE, rectangle("a", 0, 0, 0.4, 0.9)], **change)
        assert said in problems[0]

    def test_no_blocks(self):
        assert "there is none" in self.problems([])[0]

    def test_weightless_block(self):
        feather = Block(id="f", vertices=BASE.vertices + (0, 0.2), unit_weight=0.0)
        assert 'block "f" unit_weight: must be greater than 0' in self.problems([BASE, feather])[0]

    def test_long_lists_are_cut_in_the_text_only(self):
        error = ModelError([f"problem {i}" for i in range(25)])
        assert len(error.problems) == 25
        assert str(error).splitlines()[-2:] == ["problem 9", "... and 15 more"]


class TestInspect:
    def test_tilting_an_assembly_does_not_change_its_joints(self):
        blocks = coursed_wall(
            unit=(0.4, 0.175), courses=["h1111h", "11111"], repeat=3, base=True, unit_weight=1e4
        )
        for angle in np.radians([7.0, -30.0, 90.0]):
            assert inspect(model_of(tilted(blocks, angle))).n_joints == 83

    def test_a_corner_on_an_edge_is_no_joint(self):
        diamond = Block(
            id="d", vertices=np.array([[0, 0], [0.5, 0.5], [0, 1], [-0.5, 0.5]]), unit_weight=1e4
        )
        found = inspect(model_of([BASE, diamond]))
        assert (found.n_blocks, found.n_joints, found.n_contacts) == (1, 0, 0)

    def test_joints_between_supports_do_not_count(self):
        beside = rectangle("beside", 1.0, -0.2, 1.0, 0.2, support=True)
        found = inspect(model_of([BASE, beside, rectangle("a", 0, 0, 0.4, 0.9)]))
        assert (found.n_supports, found.n_joints) == (2, 1)

    @pytest.mark.parametrize(
        ("blocks", "said"),
        [
            (
                [BASE, rectangle("far", 3, 5, 1, 1, support=True)],
                'nothing touches the support "far"',
            ),
            ([BASE, rectangle("x", 3, 5, 1, 1), rectangle("y", 3, 6, 1, 1)], '"x", "y"'),
            ([BASE, rectangle("long", -1, 0, 80, 1)], "in metres?"),
        ],
    )
    def test_warnings(self, blocks, said):
        found = inspect(model_of([*blocks, rectangle("a", -1, -1.2, 0.4, 1)]))
        assert any(said in warning for warning in found.warnings)

    def test_published_wall_has_no_warning_but_on_dilatancy(self):
        (warning,) = inspect(published_wall(1)).warnings
        assert "dilatancy" in warning


class TestDescription:
    def test_unnamed_materials_are_told_apart_by_weight(self):
        light = Block(id="l", vertices=BASE.vertices + (0, 0.2), unit_weight=5e3)
        data = model_to_dict(model_of([BASE, light]))
        assert data["material"] == {
            "material1": {"unit_weight": 10e3},
            "material2": {"unit_weight": 5e3},
        }

    def test_one_name_for_two_weights(self):
        a = rectangle("a", -1.0, 0.0, 0.4, 0.9, material="stone")
        b = Block(id="b", vertices=a.vertices + (1, 0), unit_weight=5e3, material="stone")
        with pytest.raises(ModelError, match="stone: has two unit weights"):
            model_of([BASE, a, b])


@pytest.mark.parametrize(
    ("builder", "measures", "said"),
    [
        (column, {"width": 0.5, "height": 2.0, "n_blocks": 2.0}, "n_blocks: must be a whole"),
        (column, {"width": 0.5, "height": 2.0, "n_blocks": "2"}, "n_blocks: must be a whole"),
        (dome, {"span": 4.0, "thickness": 0.3, "rings": 4.0, "sectors": 8}, "rings: must be"),
        (dome, {"span": 4.0, "thickness": 0.3, "rings": 4, "sectors": None}, "sectors: must be"),
        (
            panel,
            {
                "length": 4.0,
                "height": 2.0,
                "unit": (0.4, 0.2),
                "openings": [{"at": 1.2, "width": 0.8, "height": 1.0, "sill": None}],
            },
            r"openings\[1\].sill: must be a number",
        ),
    ],
)
def test_what_is_no_number_is_told(builder, measures, said):
    """It was a TypeError from within."""
    with pytest.raises(ModelError, match=said):
        builder(unit_weight=20e3, **measures)
