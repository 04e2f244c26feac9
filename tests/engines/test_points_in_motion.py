"""Where blocks move far by themselves, curves have points in motion: no step hides a fall."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from builders import rectangle
from drystone.common.tolerances import BETWEEN_POINTS
from drystone.geometry.motion import translations
from drystone.limit import on_what_moves
from drystone.model.assembly import Block
from drystone.model.builders import make_model
from drystone.model.joint_law import JointLaw
from drystone.model.model import Analysis
from drystone.results.curve import DYNAMIC, STATIC
from drystone.results.events import EventKind
from random_kinds import KINDS

CASES = Path(__file__).parents[1] / "cases"

ENGINES = pytest.mark.parametrize("engine", ["equilibrium", "nscd", "distinct"])


def furthest(model, curve):
    """By how far of its smallest extent a block's centroid goes from each point to the next."""
    place = np.array([translations(pose) for pose in curve.poses])
    moved = np.linalg.norm(np.diff(place, axis=0), axis=2)
    return (moved / model.assembly.extents).max(axis=1)


def longest_jump(model, curve):
    """The largest such motion to a point at rest that has one at rest before it."""
    static = curve.column("status") == STATIC
    steps = furthest(model, curve)[static[1:] & static[:-1]]
    return float(steps.max(initial=0.0))


def ledge(joint=None, **analysis):
    """A small block on a ledge slides at 0.2, and falls to a shelf 0.6 m lower, where it lies on; a
    tall one beside it rocks from 0.4 on."""
    stiff = JointLaw(friction_coefficient=0.9, normal_stiffness=1e10, shear_stiffness=1e10)
    outlines = {
        "base": rectangle(-1.0, -0.5, 2.0, 0.5),
        "shelf": rectangle(0.9, -0.9, 2.0, 0.3),
        "small": rectangle(0.78, 0.0, 0.2, 0.1),
        "tall": rectangle(-0.8, 0.0, 0.4, 1.0),
    }
    slippery = joint or replace(stiff, friction_coefficient=0.2)
    return make_model(
        [
            Block(id=name, vertices=v, unit_weight=20e3, support=name in ("base", "shelf"))
            for name, v in outlines.items()
        ],
        joint=stiff,
        joint_between={frozenset({"base", "small"}): slippery},
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block="tall",
        analysis=Analysis(**analysis),
    )


@cache
def followed(engine):
    """The curve of what stands on the ledge, once."""
    return ds.pushover(ledge(), engine=engine, max_displacement=0.1, keep_poses=True)


@ENGINES
def test_no_static_step_hides_a_fall(engine):
    """A block that rests 0.6 m lower has passed points in motion, and an event tells of it."""
    model, curve = ledge(), followed(engine)
    assert longest_jump(model, curve) <= model.analysis.event_share
    first = curve.first_collapse
    assert first.kind is EventKind.BLOCK_FALLEN and first.blocks == ("small",)
    assert first.motion > 0.5
    assert curve.events[0].kind is EventKind.LOSS_OF_EQUILIBRIUM
    assert any(point.status == DYNAMIC for point in until_regained(curve, first))
    assert curve.capacity.load_multiplier == pytest.approx(0.2, abs=4e-3)
    # It has come to rest there, and the curve goes on: turned by 0.1 about its toe, the tall block
    # carries tan(arctan 0.4 - 0.1) = 0.29.
    last = curve.points[-1]
    assert last.status == STATIC and last.load_multiplier == pytest.approx(0.29, abs=0.01)


def until_regained(curve, event):
    """The points after an event up to the first at rest with a larger control displacement: an
    engine may follow what slides through equilibria before it moves."""
    for point in curve.points[event.step + 1 :]:
        if point.status == STATIC and point.control_displacement > event.control_displacement:
            return
        yield point


class TestDistinct:
    def test_points_lie_a_tenth_of_a_block_apart(self):
        """Between two searches a block moves by 2e-3 of the smallest extent, and one cycle more:
        at the end of a fall of 0.6 m, a cycle is some 2 mm long."""
        curve = followed("distinct")
        dynamic = curve.column("status") == DYNAMIC
        moved = furthest(ledge(), curve)[dynamic[1:]]
        assert moved.max() < 1.5 * BETWEEN_POINTS
        assert dynamic.sum() > 0.5 * 0.6 / (BETWEEN_POINTS * 0.1)

    def test_points_in_motion_are_certified(self):
        """Inertia and damping are among the forces, the joint law holds in the cycle."""
        curve = followed("distinct")
        dynamic = curve.column("status") == DYNAMIC
        assert dynamic.any() and curve.residual[dynamic].max() <= 1e-4
        assert curve.column("friction_violation")[dynamic].max() <= 1e-4

    @pytest.mark.slow
    def test_they_change_nothing_at_rest(self, monkeypatch):
        """To the last bit: states are copied on the way, and the cycles go on as they would."""

        def at_rest(curve):
            static = curve.column("status") == STATIC
            columns = [curve.control_displacement, curve.load_multiplier, curve.residual]
            return static, [column[static] for column in (*columns, curve.poses)]

        some, seen = at_rest(followed("distinct"))
        monkeypatch.setattr("drystone.dynamics.distinct.cycles.BETWEEN_POINTS", np.inf)
        followed.cache_clear()
        none, unseen = at_rest(followed("distinct"))
        followed.cache_clear()
        assert not some.all() and none.all()
        for one, other in zip(seen, unseen, strict=True):
            assert np.array_equal(one, other)

    def test_the_analysis_ends_in_motion_where_asked(self):
        """Once the block is farther than half of its height from where it stood, at the first
        point that is no rest: in motion, or where it is held back by a load against the load."""
        model = ledge(falling="stop")
        curve = ds.pushover(model, engine="distinct", keep_poses=True)
        assert curve.status == "finished" and '"small" has collapsed' in curve.reason
        last = curve.points[-1]
        assert last.status == DYNAMIC or last.load_multiplier < 0.0
        moved = np.linalg.norm(
            curve.poses[-1][2, :2] - curve.poses[curve.first_collapse.step][2, :2]
        )
        assert moved > 0.05
        assert all(p.status == STATIC and p.load_multiplier >= 0.0 for p in curve.points[:-1])

    @pytest.mark.slow
    def test_what_a_broken_bond_lets_fall_is_followed(self):
        """Steps of bonds are made of several: points in motion of all of them are told.

        A block of weight W, b = 0.2 m long and h = 0.1 m high, rests on two points.  The load takes
        W m h / 2b off the one, at the multiplier m, which slides where m W / 2 is 0.2 times what
        is left of W / 2, and the bond's 0.05 W: at m (1 / 2 + 0.2 / 4) = 0.15.  The other follows.
        """
        bonded = JointLaw(
            friction_coefficient=0.2, normal_stiffness=1e10, shear_stiffness=1e10, cohesion=200.0
        )
        model = ledge(bonded)
        curve = ds.pushover(model, engine="distinct", max_displacement=0.01, keep_poses=True)
        assert longest_jump(model, curve) <= model.analysis.event_share
        assert curve.first_collapse.blocks == ("small",)
        assert curve.capacity.load_multiplier == pytest.approx(0.15 / 0.55, abs=4e-3)


#: The curve of `equilibrium` falls to 0.01 there [m].
FLAT_ARCHES = [("flat_arch", 0.1118), ("flat_arch_space", 0.1113)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "end"), FLAT_ARCHES)
def test_voussoirs_of_a_flat_arch_are_seen_to_fall(name, end):
    """They lay a metre lower in the next static step, and the peak of what was left was 0.38.

    Piers spread under the load until the voussoirs fall between them, under next to none.  Peaks of
    the engines differ by what a step may hide, 0.5 %; where equilibrium is lost, by some steps of a
    hundredth of the smallest voussoir, 2.6 mm.  20 s.
    """
    model = ds.read_model(CASES / f"{name}.toml")
    curve = ds.pushover(
        model, engine="distinct", stop_multiplier=5e-4, falling="stop", keep_poses=True
    )
    other = ds.pushover(model, engine="equilibrium", stop_multiplier=5e-4)
    assert curve.status == "finished" and "collapsed" in curve.reason
    assert curve.capacity.load_multiplier == pytest.approx(0.083, rel=0.01)
    assert curve.capacity.load_multiplier == pytest.approx(other.capacity.load_multiplier, rel=5e-3)
    assert longest_jump(model, curve) <= model.analysis.event_share
    lost, fallen = curve.events[-2:]
    assert lost.kind is EventKind.LOSS_OF_EQUILIBRIUM and fallen.is_collapse
    assert set(fallen.blocks) & {"b10", "b11", "b12", "b13", "b14"}
    assert fallen.control_displacement == pytest.approx(end, rel=0.03)
    assert fallen.load_multiplier < 0.02
    assert (curve.column("status")[fallen.step + 1 :] == DYNAMIC).all()


WINDOW = """
title = "Dry wall with a window"
dimension = 2
thickness = 0.3
[material.brick]
unit_weight = 20e3
[joint]
friction_coefficient = 0.4
normal_stiffness = 1e9
shear_stiffness = 4e8
[[build]]
kind = "panel"
length = 3.2
height = 2.0
unit = [0.4, 0.2]
base = true
openings = [{ at = 1.0, width = 0.8, height = 1.0, sill = 0.4 }]
[load]
pattern = "mass"
direction = [1.0, 0.0]
"""


@pytest.mark.slow
def test_a_wall_with_a_window_is_seen_to_lose_a_block(tmp_path):
    """Its upper corner, with the control point, went from 0.256 to 0.553 m in one static step.

    8 s.
    """
    path = tmp_path / "window.toml"
    path.write_text(WINDOW)
    model = ds.read_model(path)
    curve = ds.pushover(model, engine="distinct", keep_poses=True)
    assert longest_jump(model, curve) <= model.analysis.event_share
    first = curve.first_collapse
    assert first.kind is EventKind.BLOCK_FALLEN and "panel/c10u9" in first.blocks
    assert (curve.column("status")[first.step + 1 :] == DYNAMIC).sum() > 10
    other = ds.pushover(model, engine="equilibrium")
    assert curve.capacity.load_multiplier == pytest.approx(other.capacity.load_multiplier, rel=5e-3)


@pytest.mark.slow
def test_wall106_ends_where_its_control_point_falls():
    """By `distinct` the block of the control point fell by 2 m, and the curve went on from there to
    1.24 m.

    It ends with the last point at rest, as by `equilibrium`, 0.02 m earlier on a branch of its own
    (tests/validation/test_branches.py).  25 s.
    """
    model = ds.read_model(CASES / "wall106.toml")
    curve, other = (
        ds.pushover(model, engine=engine, keep_poses=True) for engine in ("distinct", "equilibrium")
    )
    for found in (curve, other):
        assert found.status == "finished"
        assert found.reason.endswith("collapsed in motion: it falls without any load")
        rest = [point for point in found.points if point.status == STATIC][-1]
        assert found.ultimate_displacement == rest.control_displacement
        assert found.first_collapse.step == rest.step
    assert "u71" in curve.first_collapse.blocks  # on which the control point is
    assert longest_jump(model, curve) <= model.analysis.event_share
    assert curve.ultimate_displacement == pytest.approx(other.ultimate_displacement, rel=0.1)


def test_ties_break_in_motion_where_blocks_come_to_other_neighbours():
    """A tie that breaks in a step of time is taken out where the step begins, by the pairs there:
    those at its end may be others, and are more or fewer."""
    model = on_what_moves(KINDS["tied-plane"](4))
    curve = ds.pushover(model)
    assert curve.status == "finished"
    broken = [event.step for event in curve.events if event.kind is EventKind.TIE_BROKEN]
    assert any(curve.points[step + 1].status == DYNAMIC for step in broken)
