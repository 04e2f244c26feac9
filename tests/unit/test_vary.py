"""Models varied in Python: derived data follows, exceptions and digests are as they should be."""

import copy
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from builders import PUBLISHED_JOINT, UNIT_WEIGHT, RockingBlock, rectangle, stack
from drystone.io.modelfile import read_model, write_model
from drystone.model.assembly import Block, Corner
from drystone.model.builders import make_model
from drystone.model.inspection import inspect

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
WALL = EXAMPLES / "wall1.toml"


@pytest.fixture
def piers():
    """Two piers of different stone side by side, each with a law of its own on the base."""
    blocks = [
        Block(id="base", vertices=rectangle(-1, -1, 6, 1), unit_weight=UNIT_WEIGHT, support=True),
        Block(id="left", vertices=rectangle(0, 0, 0.4, 1), unit_weight=UNIT_WEIGHT, material="a"),
        Block(id="right", vertices=rectangle(3, 0, 0.4, 1), unit_weight=UNIT_WEIGHT, material="b"),
    ]
    between = {
        frozenset(("base", "left")): replace(PUBLISHED_JOINT, friction_coefficient=0.3),
        frozenset(("base", "right")): replace(PUBLISHED_JOINT, cohesion=1e3),
    }
    return make_model(
        blocks, joint=PUBLISHED_JOINT, joint_between=between, thickness=1.0, load_direction=(1, 0)
    )


class TestReplace:
    """`dataclasses.replace` of what is designed."""

    def test_of_a_joint_reaches_the_laws(self):
        assembly = stack((0.4, 0.9)).assembly
        joint = replace(assembly.joint, friction_coefficient=0.2)
        assert replace(assembly, joint=joint).laws == (joint,)
        assert assembly.laws == (PUBLISHED_JOINT,)

    def test_of_the_thickness_reaches_weight_and_mass(self):
        assembly = stack((0.4, 0.9)).assembly
        assert assembly.heaviest_weight > 0.0  # kept from now on, but not by the copy
        doubled = replace(assembly, thickness=2.0 * assembly.thickness)
        np.testing.assert_array_equal(doubled.weight, 2.0 * assembly.weight)
        np.testing.assert_array_equal(doubled.mass, 2.0 * assembly.mass)
        assert doubled.heaviest_weight == 2.0 * assembly.heaviest_weight

    def test_of_corners_reaches_the_shapes(self):
        assembly = stack((0.4, 0.9)).assembly
        assert replace(assembly, corner=Corner(radius=0.02)).shapes.radius.tolist() == [0.02, 0.02]

    def test_of_a_friction_coefficient_changes_the_curve(self):
        """A block of 0.4 x 0.9 m rocks at B / H, and slides at a friction below that."""
        model = stack((0.4, 0.9))
        for friction in (0.2, 0.3):
            joint = replace(model.assembly.joint, friction_coefficient=friction)
            slippery = replace(model, assembly=replace(model.assembly, joint=joint))
            curve = ds.pushover(slippery, max_displacement=0.01)
            # A sliding block carries its friction coefficient; the two are 0.1 apart.
            assert curve.peak.load_multiplier == pytest.approx(friction, rel=1e-4)


class TestJoint:
    def test_sweep_gives_the_right_curves(self):
        model = stack((0.4, 0.9), corner=Corner(radius=0.02))
        rocking = RockingBlock(width=0.4 - 2 * 0.02, height=0.9).multiplier(0.0)
        for friction, expected in ((0.1, 0.1), (0.25, 0.25), (0.8, rocking)):
            curve = ds.pushover(
                model.with_joint(friction_coefficient=friction), max_displacement=0.02
            )
            # Elastic joints lower the rocking peak by a share of their closing, W / (k_n A) over
            # the width, which is 1e-4; the peak may lie half a step of 2 mm beside a point.
            assert curve.peak.load_multiplier == pytest.approx(expected, rel=5e-3)

    def test_exceptions_keep_what_is_their_own_and_share_the_rest(self, piers):
        laws = piers.with_joint(friction_coefficient=0.5).assembly.joint_between
        assert laws[frozenset(("base", "left"))].friction_coefficient == 0.3
        right = laws[frozenset(("base", "right"))]
        assert (right.friction_coefficient, right.cohesion) == (0.5, 1e3)

    def test_between_changes_one_pair(self, piers):
        varied = piers.with_joint(between=("left", "base"), friction_coefficient=0.1).assembly
        assert varied.joint == PUBLISHED_JOINT
        assert varied.joint_between[frozenset(("base", "left"))].friction_coefficient == 0.1
        assert varied.joint_between[frozenset(("base", "right"))].cohesion == 1e3

    def test_between_makes_an_exception(self, piers):
        varied = piers.with_joint(between=("a", "b"), cohesion=5.0).assembly
        assert varied.joint_between[frozenset("ab")] == replace(PUBLISHED_JOINT, cohesion=5.0)

    @pytest.mark.parametrize(
        ("values", "sentence"),
        [
            ({"friction_coefficient": -0.1}, "joint.friction_coefficient: must be at least 0"),
            ({"friction": 0.5}, 'no value "friction": did you mean "friction_coefficient"'),
            (
                {"cohesion": 1.0, "between": ("base", "lfet")},
                "names neither two blocks or groups nor two",
            ),
        ],
    )
    def test_what_no_joint_can_have_is_refused(self, piers, values, sentence):
        with pytest.raises(ds.ModelError, match=sentence):
            piers.with_joint(**values)


class TestOthers:
    def test_a_setting_of_the_analysis_is_a_number(self):
        with pytest.raises(ds.ModelError, match=r'\[analysis\] engin: must be a number, .*"nscd"'):
            stack((0.4, 0.9)).with_analysis(engin="nscd")
        for setting, said in (
            ({"event_share": -1.0}, "event_share: must be greater than 0"),
            ({"stop_multiplier": -5.0}, "stop_multiplier: must be greater than 0"),
            ({"strategy": "push"}, 'strategy: must be "displacement" or "published"'),
            ({"falling": "later"}, 'falling: must be "remove" or "stop"'),
        ):
            with pytest.raises(ds.ModelError, match=said):
                ds.published_wall(1).with_analysis(**setting)

    def test_corners(self):
        model = stack((0.4, 0.9)).with_corner(radius=0.02)
        assert model.assembly.shapes.radius.tolist() == [0.02, 0.02]
        assert model.with_corner().assembly.corner == Corner()
        with pytest.raises(ds.ModelError, match="corner"):
            model.with_corner(radius=0.3)  # more than half of 0.4 m

    def test_load_takes_the_default_control_point_along(self):
        """The wall pushed to the left is read at its upper left corner, leftwards."""
        model = read_model(WALL)
        back = model.with_load(direction=(-2.0, 0.0))
        assert back.load.direction.tolist() == back.control_point.direction.tolist() == [-1.0, 0.0]
        found = inspect(back)
        assert found.control_point == (found.lower[0], found.upper[1])
        again = back.with_load(direction=(1.0, 0.0))
        assert again.control_point.block == model.control_point.block
        assert again.control_point.point.tolist() == model.control_point.point.tolist()

    def test_load_leaves_a_control_point_that_was_chosen(self):
        model = stack((0.4, 0.9), (0.4, 0.9)).with_control(
            block="b1", point="centre", direction=(0.6, 0.8)
        )
        control = model.with_load(direction=(0.0, 1.0)).control_point
        assert model.assembly.ids[control.block] == "b1"
        assert control.point.tolist() == model.assembly.centroid[1].tolist()
        assert control.direction.tolist() == [0.6, 0.8]

    def test_analysis_keeps_what_is_not_named(self):
        model = stack((0.4, 0.9)).with_analysis(engine="nscd", displacement_step=1e-3, max_steps=7)
        assert model.analysis.options == {"displacement_step": 1e-3, "max_steps": 7}
        model = model.with_analysis(stop_multiplier=0.1, max_steps=None)
        assert model.analysis.engine == "nscd" and model.analysis.stop_multiplier == 0.1
        assert model.analysis.options == {"displacement_step": 1e-3}

    def test_nothing_changed_is_the_same_to_the_bit(self):
        """The same description: pushed and read as before, joints as before."""
        model = read_model(WALL)
        own = replace(model, origin=None).sha256
        assert model.with_joint(friction_coefficient=0.65).sha256 == own
        assert model.with_load(direction=model.load.direction).sha256 == own


class TestDigest:
    def test_of_a_varied_model_is_not_the_files(self):
        model = read_model(WALL)
        for varied in (
            model.with_joint(friction_coefficient=0.5),
            model.with_load(direction=(-1.0, 0.0)),
            model.with_corner(radius=0.01),
            model.with_control(point="top left"),
            model.with_analysis(stop_multiplier=0.1),
            replace(model, assembly=replace(model.assembly, thickness=2.0)),
        ):
            assert varied.sha256 != model.sha256 and len(varied.sha256) == 64
            assert varied.source is None

    def test_is_that_of_the_file_it_would_be_written_to(self, tmp_path):
        """Of the description, which reading the written file gives back."""
        varied = read_model(WALL).with_joint(friction_coefficient=0.5)
        write_model(varied, tmp_path / "m.toml")
        assert replace(read_model(tmp_path / "m.toml"), origin=None).sha256 == varied.sha256

    @pytest.mark.parametrize("again", [copy.deepcopy, lambda m: pickle.loads(pickle.dumps(m))])
    def test_of_a_copy_is_still_the_files(self, again):
        model = read_model(WALL)
        assert again(model).sha256 == model.sha256 and again(model).source == str(WALL)


def test_a_joint_of_two_blocks_keeps_what_it_has_from_their_materials():
    """Its friction is changed, and its stiffness stays that of the exception."""
    soft = replace(PUBLISHED_JOINT, normal_stiffness=1e7, friction_coefficient=0.4)
    blocks = [
        Block(id="base", vertices=rectangle(0, -1, 1, 1), unit_weight=1e4, support=True),
        Block(id="a", vertices=rectangle(0, 0, 1, 1), unit_weight=1e4, material="brick"),
    ]
    blocks[0] = replace(blocks[0], material="stone")
    model = make_model(
        blocks,
        joint=PUBLISHED_JOINT,
        joint_between={frozenset(("stone", "brick")): soft},
        thickness=1.0,
        load_direction=(1.0, 0.0),
    )
    changed = model.with_joint(between=("base", "a"), friction_coefficient=0.5).assembly
    (row,) = changed.law_index(np.array([0]), np.array([1]))
    assert changed.laws[row] == replace(soft, friction_coefficient=0.5)


def test_dead_loads_of_a_model_whose_supports_move():
    """They stay the supports that move; a direction of load takes their place."""
    moves = ds.Settlement(blocks=("base",), direction=(0.0, -1.0), max=0.1)
    model = stack((0.4, 0.9)).with_settlement(moves)
    dead = ds.SurchargeLoad(block="b1", weight=1e3, mass=False)
    loaded = model.with_load(dead_loads=[dead])
    assert loaded.settlement is not None and loaded.settlement.max == 0.1
    assert loaded.dead_loads == (dead,)
    assert model.with_load((-1.0, 0.0)).settlement is None


def test_names_say_what_they_are():
    model = read_model(WALL).with_joint(friction_coefficient=0.5)
    assert "33 blocks" in repr(model) and "friction 0.5" in repr(model)
    assert len(repr(model)) < 300


def test_models_of_space_are_varied_too():
    """Points of interfaces and the direction of gravity stay."""
    solid = ds.extruded(stack((0.4, 0.5), (0.4, 0.5)), points=9)
    up = np.array([0.0, 0.6, 0.8])
    solid = replace(solid, assembly=replace(solid.assembly, up=up))
    varied = solid.with_joint(friction_coefficient=0.3)
    assert varied.assembly.joint.friction_coefficient == 0.3
    assert varied.assembly.points == 9
    assert np.array_equal(varied.assembly.up, up)
