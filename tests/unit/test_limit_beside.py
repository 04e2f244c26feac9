"""Limit analysis beside a curve: what is left to the command because its program is large."""

from __future__ import annotations

import pytest

from drystone.limit import ASSOCIATIVE, beside, collapse, collapse_load, default_paths
from drystone.limit.crushing import n_points
from random_kinds import KINDS

STRENGTH = 5e5  # Pa


@pytest.fixture(scope="module")
def dry():
    return KINDS["opening-plane"](3)


@pytest.fixture
def crushed(dry):
    return dry.with_joint(compressive_strength=STRENGTH)


def test_joints_that_may_be_crushed_have_many_points(dry, crushed):
    assert n_points(crushed.assembly) > 10 * n_points(dry.assembly)


def test_without_crushing_it_is_the_dry_structure(dry, crushed):
    bound = collapse_load(dry, flow=ASSOCIATIVE).load_multiplier
    assert collapse.uncrushed(crushed).load_multiplier == pytest.approx(bound, rel=1e-9)
    assert collapse_load(crushed, flow=ASSOCIATIVE).load_multiplier < bound


def test_large_programs_are_left_to_the_command(crushed, monkeypatch):
    small = beside.limits_beside(crushed)
    assert small.associative and small.non_associative
    points = n_points(crushed.assembly)
    monkeypatch.setattr(beside, "MOST_POINTS_NON_ASSOCIATIVE", points - 1)
    found = beside.limits_beside(crushed)
    assert found.associative == small.associative and found.non_associative is None
    assert f"{points} contact points" in found.note
    monkeypatch.setattr(beside, "MOST_POINTS", points - 1)
    found = beside.limits_beside(crushed)
    assert found.associative is None and f"{points} contact points" in found.note


def test_of_large_programs_the_mechanism_without_crushing_is_watched(monkeypatch):
    """The default control point is on a block that stands still."""
    model = KINDS["leaning-plane"](3).with_joint(compressive_strength=1e8)
    moved = beside.limits_beside(model).fastest
    monkeypatch.setattr(beside, "MOST_POINTS", 1)
    found = beside.limits_beside(model)
    assert found.associative is None and found.control_still
    assert moved.block == found.fastest.block == beside.moving_control(model).block
    assert moved.block != model.control_point.block
    assert (moved.point == found.fastest.point).all()


def test_large_programs_have_one_path(crushed, monkeypatch):
    assert default_paths(crushed.assembly) == collapse.MANY
    monkeypatch.setattr(collapse, "FEW_FROM_POINTS", n_points(crushed.assembly))
    assert default_paths(crushed.assembly) == collapse.FEW
