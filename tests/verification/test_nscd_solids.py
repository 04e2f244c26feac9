"""Contact dynamics of solids against closed forms, and however the whole is turned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import drystone as ds
from builders import problem_of
from drystone.dynamics.nscd import NscdEngine
from drystone.engines.base import Demand
from solids import box, joint, leaf, model_of, one_block, turned


def curve_of(model, **options):
    return ds.pushover(model, engine="nscd", **options)


@pytest.mark.parametrize(
    ("angle", "peak"),
    [
        # Over the edge across b / h or d / h, whichever is less: (b / h) / cos, (d / h) / sin.
        (0.0, 0.4 / 1.5),
        (30.0, 0.4 / 1.5 / np.cos(np.radians(30.0))),
        (45.0, 0.4 / 1.5 / np.cos(np.radians(45.0))),
        (90.0, 0.6 / 1.5),
    ],
)
def test_a_block_overturns_whichever_way_it_is_pushed(angle, peak):
    curve = curve_of(one_block(angle=angle), max_displacement=0.01)
    # Joints of 1e11 Pa/m press in by 0.2 um; 1e-3 with the steps in which the peak is looked for.
    assert curve.peak.load_multiplier == pytest.approx(peak, rel=1e-3)
    assert max(point.residual for point in curve.points) <= NscdEngine.capabilities.residual_limit


def test_a_rocking_block_follows_its_closed_form():
    """On an edge, tilted by t: (b / 2 cos t - h / 2 sin t) over (b / 2 sin t + h / 2 cos t)."""
    curve = curve_of(one_block(angle=0.0), max_displacement=0.2)
    # The control point, the far upper corner, moves by h sin t - b (1 - cos t).
    tilt = np.linspace(0.0, 0.3, 20001)
    moved = 1.5 * np.sin(tilt) - 0.4 * (1.0 - np.cos(tilt))
    force = 0.4 * np.cos(tilt) - 1.5 * np.sin(tilt), 0.4 * np.sin(tilt) + 1.5 * np.cos(tilt)
    beyond = [p for p in curve.points if p.control_displacement > 0.01]
    assert len(beyond) > 20
    for point in beyond:
        expected = np.interp(point.control_displacement, moved, force[0] / force[1])
        # Steps of 1.8 mm go straight on, by which the block rises from its edge; in the plane they
        # leave the same 3.5e-3.
        assert point.load_multiplier == pytest.approx(expected, abs=4e-3)


@pytest.mark.parametrize("angle", [0.0, 30.0, 77.0])
def test_a_block_slides_straight_whichever_way_it_is_pushed(angle):
    model = one_block(0.4, 0.6, 0.3, friction=0.2, stiffness=1e9, angle=angle)
    curve = curve_of(model, max_displacement=0.1)
    assert curve.peak.load_multiplier == pytest.approx(0.2, rel=1e-6)
    went = curve.poses[-1][1, :3] - curve.poses[0][1, :3]
    along = model.load.direction
    length = went @ along
    assert length == pytest.approx(0.1, rel=0.05)
    # Four points share the friction as they share the weight: nothing turns the block about z.
    assert abs(np.cross(went, along)[2]) < 1e-6 * length
    assert abs(curve.poses[-1][1, 6]) < 1e-7


def test_however_the_whole_is_turned():
    model = leaf(length=0.8, courses=3, stiffness=1e9)
    there = turned(model, Rotation.from_rotvec([0.4, -1.1, 2.0]), shift=(3.0, -2.0, 5.0))
    curves = [curve_of(m, max_steps=40) for m in (model, there)]
    first, second = (
        np.array([(p.control_displacement, p.load_multiplier) for p in c.points]) for c in curves
    )
    assert len(first) == len(second)
    # Residuals of 5e-7 of the heaviest weight, in steps that follow on each other.
    assert second == pytest.approx(first, abs=1e-5)


def test_a_leaf_overturns_as_one():
    """A leaf of 24 units on its base: thickness over height, 0.2 / 0.525."""
    curve = curve_of(leaf(length=1.6, courses=3, stiffness=1e10), max_displacement=0.005)
    # Joints of 1e10 Pa/m lower it by a share of 1e-3.
    assert curve.peak.load_multiplier == pytest.approx(0.2 / 0.525, rel=3e-3)


@pytest.mark.parametrize("turn", [(0.6, 0.0, 0.0), (0.0, 0.75, 0.3), (0.5, 0.4, 0.2)])
def test_a_box_dropped_on_an_edge_or_a_corner_comes_to_rest(turn):
    """It falls on an edge or a corner, rocks, and lies flat; energy is lost all the time."""
    blocks = [
        box("base", (-2.0, -2.0, -0.5), (2.0, 2.0, 0.0), support=True),
        box("b1", (0.0, 0.0, 0.0), (0.3, 0.4, 0.2)),
    ]
    model = model_of(blocks, joint(0.5, 1e8), push=(1.0, 0.0, 0.0))
    engine, assembly = NscdEngine(), model.assembly
    state, _ = engine.start(problem_of(model))
    pose = assembly.design_pose()
    pose[1, 2] = 0.25
    pose[1, 3:] = Rotation.from_rotvec(turn).as_quat(scalar_first=True)
    state = replace(state, pose=pose, velocity=assembly.no_motion())
    mass, h, last = assembly.mass[1], 5e-3, np.inf
    for _ in range(300):
        state, report = engine.step(state, Demand(multiplier=0.0, time_step=h, stop_blocks=False))
        assert report.converged, report.reason
        assert report.residual <= engine.capabilities.residual_limit
        energy = 0.5 * np.sum(mass * state.velocity[1] ** 2) + 9.81 * mass[0] * state.pose[1, 2]
        # What joints store is left out: (m v)^2 / k of an impact at 2 m/s, of 100 J.
        assert energy <= last + 1.0
        last = min(last, energy)
    assert np.abs(state.velocity[1]).max() < 1e-3
    # Flat: one of its axes is upright.
    upright = Rotation.from_quat(state.pose[1, 3:], scalar_first=True).as_matrix()[2]
    assert np.abs(upright).max() == pytest.approx(1.0, abs=1e-5)
