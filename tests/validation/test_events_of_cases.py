"""Structures of which a part falls while the rest goes on carrying; the models are in tests/cases.

Each of them once had a "peak" of what was left, or a verdict on a displacement beyond the collapse.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from drystone.geometry.motion import translations
from drystone.results.curve import STATIC
from drystone.results.events import EventKind, Outcome

CASES = Path(__file__).parents[1] / "cases"

#: By name of the case: blocks of the first event in which a part collapses, or some of them.
PARTS = {
    "facade_tie": {"casa/w2/c10u2"},
    # Rubble: equilibrium is lost at 0.14 mm under 0.45; which stone goes first is of the motion.
    "voronoi1": {"b6", "b18"},
    "voronoi3": {"b23"},
    "corner_short_leg": {"w2/c6u4"},
    # Mirror images of each other: rounding says which is the first to go.
    "facade_inward": {"b115", "b118"},
}

#: The same; ten seconds is too long for every run.
NAMES = [
    pytest.param(name, marks=pytest.mark.slow if name == "facade_inward" else ()) for name in PARTS
]


@cache
def model_of(name):
    return ds.read_model(CASES / f"{name}.toml")


@cache
def to_the_collapse(name):
    """The curve to the first event in which a part collapses."""
    return ds.pushover(model_of(name), falling="stop", keep_poses=True)


@cache
def past_the_stone():
    """The curve of the facade with a tie, beyond where a stone is pulled off."""
    return ds.pushover(model_of("facade_tie"), max_displacement=0.3)


@pytest.mark.parametrize("name", NAMES)
def test_the_analysis_ends_where_the_part_collapses(name):
    curve = to_the_collapse(name)
    first = curve.first_collapse
    assert curve.status == "finished" and "collapsed" in curve.reason
    assert PARTS[name] & set(first.blocks)
    assert curve.events[0].kind is EventKind.LOSS_OF_EQUILIBRIUM
    # What is said of the event is what the poses show.
    assembly, before = model_of(name).assembly, curve.points[first.step]
    assert before.status == STATIC and before.control_displacement == first.control_displacement
    way = np.linalg.norm(
        translations(curve.poses[first.step :]) - translations(curve.poses[first.step]), axis=2
    ).max(axis=0)
    for block in first.blocks:
        row = assembly.index(block)
        assert way[row] > 0.5 * assembly.extents[row]
    assert first.motion == pytest.approx(max(way[assembly.index(b)] for b in first.blocks))
    # And no block went so far before.
    for one, next_ in zip(curve.poses[: first.step], curve.poses[1 : first.step + 1], strict=True):
        step = np.linalg.norm(translations(next_) - translations(one), axis=1)
        assert (step <= 0.5 * assembly.extents).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_capacity_is_that_of_the_whole_structure(name):
    """It is the highest static multiplier up to the event, and no more than the bound."""
    curve = to_the_collapse(name)
    upto = [p for p in curve.points if p.step <= curve.first_collapse.step and p.status == STATIC]
    assert curve.capacity.load_multiplier == max(p.load_multiplier for p in upto)
    bound = ds.collapse_load(model_of(name), flow="associative").load_multiplier
    assert curve.capacity.load_multiplier <= bound * (1.0 + 1e-4)


def test_a_stone_that_hangs_on_its_tie_has_fallen():
    """It was pulled off at 0.227 m and hung 4.4 m away, with no block said to have left."""
    curve = past_the_stone()
    first = curve.first_collapse
    assert first.kind is EventKind.BLOCK_FALLEN and first.outcome is Outcome.HANGING
    assert first.blocks == ("casa/w2/c10u2",) and first.motion > 1.0
    assert not curve.blocks_left


def test_a_verdict_lies_before_the_stone_that_is_pulled_off():
    """It was "satisfied, 1.114", on a displacement beyond the jump."""
    curve = past_the_stone()
    verdict = curve.assess(model_of("facade_tie"))
    end = curve.first_collapse.control_displacement
    assert verdict.capacity.collapse_displacement == end
    assert not verdict.satisfied and verdict.safety_index < 1.0
    for state in verdict.limit_states:
        place = state.limit_control_displacement
        assert place is None or place <= end


def test_what_is_left_does_not_give_the_peak():
    """The leg that still stood bore 0.553; the structure had borne 0.309."""
    curve = ds.pushover(model_of("corner_short_leg"), max_displacement=0.02)
    assert curve.rises_after_collapse
    assert curve.capacity.load_multiplier < 0.32 < 0.5 < curve.peak.load_multiplier
    assert "highest of what is left" in repr(curve)


@pytest.mark.slow
def test_stones_that_hang_on_friction_do_so_as_long_as_the_shear_stiffness_lets_them():
    """The engine nscd takes sticking as rigid, and goes by 0.3205, where soft joints lose b23: so
    does equilibrium with joints as stiff as that.  Both peaks lie between the collapse states."""
    model = model_of("voronoi3")
    assert to_the_collapse("voronoi3").capacity.load_multiplier == pytest.approx(0.3205, abs=1e-3)
    stiff = ds.pushover(model.with_joint(shear_stiffness=1e11), falling="stop")
    rigid = ds.pushover(model, engine="nscd", falling="stop", max_displacement=0.01)
    assert stiff.first_collapse is None and rigid.first_collapse is None
    # The engine nscd has the load of where a step begins: 1.7e-3 here, 3e-4 with steps of 0.2 mm.
    peaks = [curve.peak.load_multiplier for curve in (stiff, rigid)]
    assert peaks[1] == pytest.approx(peaks[0], rel=3e-3)
    low, high = ds.collapse_load(model, flow="non-associative").collapse_range
    assert low < 0.3205 < min(peaks) and max(peaks) < high
    # What carries is closed, but for what gaps change by to second order in a step: its motion
    # squared over the size of a stone, some 1e-7 m, on which stiff joints carry a newton.
    contacts = rigid.contacts[int(np.argmax(rigid.load_multiplier))]
    size = model.assembly.smallest_extent
    carry = contacts.normal_reaction > 1e-3 * model.assembly.heaviest_weight
    assert contacts.gap[carry].max() < 0.0
    assert contacts.gap[contacts.normal_reaction > 0.0].max() < 1e-6 * size
