"""Models that are written and read again: the same structure, whatever its numbers are made of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import drystone as ds
from builders import rectangle, stack
from drystone.model.builders import panel, placed, plan
from drystone.model.construction.describe import digest

BASE = ds.Block(id="base", vertices=rectangle(-2, -1, 4, 1), unit_weight=1e4, support=True)


def again(model, tmp_path, ending):
    ds.write_model(model, tmp_path / f"m.{ending}")
    return ds.read_model(tmp_path / f"m.{ending}")


@pytest.mark.parametrize("ending", ["toml", "json"])
def test_numbers_of_numpy(tmp_path, ending):
    """A stiffness of `np.float64` was written as that word, which is no TOML."""
    number = np.float64
    spring = ds.Tie(
        start=ds.TieEnd(point=np.array([-1.0, 0.5])),
        end=ds.TieEnd(block="b1", point=np.array([-0.2, 0.5])),
        stiffness=number(1e6),
        yield_force=number(5e3),
        compression=False,
        name="s",
    )
    dead = ds.SurchargeLoad(block="b1", weight=number(2e3), stage=np.int64(1), mass=False)
    model = replace(stack((0.4, 0.6)), ties=(spring,), dead_loads=(dead,))
    read = again(model, tmp_path, ending)
    assert read.ties[0].stiffness == 1e6
    assert read.dead_loads[0].keys() == {**dead.keys(), "stage": 1}
    assert digest(read) == digest(model)


@pytest.mark.parametrize("ending", ["toml", "json"])
def test_joints_that_are_meant_to_be_open(tmp_path, ending):
    """A pier is 0.2 mm short of its lintel.  No drawing tolerance closes the joint when the
    file is read again, either."""
    piers = [
        ds.Block(id=name, vertices=rectangle(x, 0.0, 0.4, height), unit_weight=1e4)
        for name, x, height in (("a", -1.0, 1.0), ("b", -0.2, 0.9998), ("c", 0.6, 1.0))
    ]
    lintel = ds.Block(id="lintel", vertices=rectangle(-1.0, 1.0, 2.0, 0.3), unit_weight=1e4)
    model = ds.make_model(
        [BASE, *piers, lintel],
        joint=stack((0.4, 0.6)).assembly.joint,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        drawing_tolerance=0.0,
    )
    read = again(model, tmp_path, ending)
    for before, after in zip(model.assembly.blocks, read.assembly.blocks, strict=True):
        np.testing.assert_array_equal(before.vertices, after.vertices)
    assert len(read.assembly.interfaces.size) == len(model.assembly.interfaces.size) == 5


@pytest.mark.parametrize("kind", ["face", "fill"])
def test_sides_are_directions(kind):
    """A side twice as long was taken for one that more faces look to."""
    given = {
        "face": {"pressure": np.array([1e3, 0.0])},
        "fill": {"unit_weight": 1e4, "level": 1.0, "at_rest": 0.5},
    }
    make = {"face": ds.FaceLoad, "fill": ds.FillLoad}[kind]
    loads = [
        make(block="b1", side=np.array(side), mass=False, **given[kind])
        for side in ([-1, 0], [-2, 0])
    ]
    assembly = stack((0.4, 0.6)).assembly
    forces = [load.forces(assembly).force for load in loads]
    np.testing.assert_array_equal(*forces)
    assert forces[0].any()
    np.testing.assert_array_equal(loads[1].keys()["side"], [-1.0, 0.0])


def test_the_default_control_point_is_no_matter_of_the_order_of_vertices():
    """Two corners of a box are as high and as far: the same one is taken, whichever comes first."""
    base = np.array([[x, y, z] for x in (-1, 2) for y in (-1, 2) for z in (-1, 0)], float)
    box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 0.3)], float)
    points = []
    for vertices in (box, box[::-1]):
        blocks = [
            ds.Block(id="base", vertices=base, unit_weight=1e4, support=True),
            ds.Block(id="b", vertices=vertices, unit_weight=1e4),
        ]
        joint = stack((0.4, 0.6)).assembly.joint
        model = ds.make_model(blocks, joint=joint, load_direction=(1.0, 0.0, 0.0))
        points.append(model.control_point.point)
    np.testing.assert_array_equal(*points)


class TestBuildersTakeNumbersOfNumpy:
    """And say in a sentence what they do not take."""

    def test_a_stack(self):
        sizes = np.array([1.0, 0.5])
        blocks = ds.stack(widths=sizes, heights=sizes, depths=sizes, unit_weight=1e4)
        assert [block.id for block in blocks] == ["base", "b1", "b2"]

    def test_a_turn(self):
        made = ds.stack(widths=[1.0], heights=[0.5], unit_weight=1e4, base=False)
        by_numpy, by_hand = (placed(made, rotation=angle) for angle in (np.int64(90), 90.0))
        np.testing.assert_array_equal(by_numpy[0].vertices, by_hand[0].vertices)
        with pytest.raises(ds.ModelError, match="rotation: must be one number in degrees"):
            placed(made, rotation="a")

    def test_a_history(self):
        assert stack((0.4, 0.6)).with_history([np.float32(0.01), 0.0]).history is not None

    def test_a_unit_that_is_none(self):
        with pytest.raises(ds.ModelError, match=r"unit: must be \[length, height\]"):
            panel(length=2.0, height=1.0, unit=0.5, unit_weight=1e4)

    def test_a_line_of_points_that_are_none(self):
        with pytest.raises(ds.ModelError, match="a list of at least two points"):
            plan(
                lines=[[[0, 0], [1, 0, 2]]], thickness=0.3, height=1.0, unit=[0.5, 0.25],
                unit_weight=1e4,
            )  # fmt: skip
