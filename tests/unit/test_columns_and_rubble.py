"""Columns, towers, pyramids, buttresses, spirals, rubble: volume, joints and surface."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from built import assembled, brute_joints, exposed, joint_area
from drystone.geometry.plane import polygon
from drystone.model.builders import (
    ModelError,
    buttress,
    column,
    drum_column,
    pyramid,
    rubble,
    spiral,
    stack,
    tower,
)

W = {"unit_weight": 20e3}
# Sums of some hundred areas of the order of 1 m2, each to rounding errors of coordinates.
EXACT = {"rel": 1e-9}


def test_columns_and_stacks_in_space():
    assembly = assembled(column(width=0.4, depth=0.3, height=2.0, n_blocks=4, base=False, **W))
    assert assembly.volume.sum() == pytest.approx(0.4 * 0.3 * 2.0, **EXACT)
    assert joint_area(assembly) == pytest.approx(3 * 0.4 * 0.3, **EXACT)
    blocks = stack(
        widths=[0.6, 0.4], depths=[0.5, 0.7], heights=[0.3, 0.2], offsets=[0.0, 0.1], base=True, **W
    )
    # On the base all of the lower one; on that 0.4 m by 0.5 m of the upper one.
    assert joint_area(assembled(blocks)) == pytest.approx(0.6 * 0.5 + 0.4 * 0.5, **EXACT)
    with pytest.raises(ModelError, match="give one of each for every block"):
        stack(widths=[0.6], depths=[0.5, 0.7], heights=[0.3], **W)


@settings(max_examples=15, deadline=None)
@given(
    drums=st.integers(1, 6), sides=st.integers(3, 20), taper=st.integers(5, 10), feet=st.booleans()
)
def test_a_drum_column_is_a_frustum(drums, sides, taper, feet):
    top = 0.1 * taper
    more = {"plinth": (1.2, 0.2), "capital": (1.1, 0.3)} if feet else {}
    blocks = drum_column(
        diameter=1.0, top_diameter=top, height=4.0, drums=drums, sides=sides, **more, **W
    )
    assembly = assembled(blocks)
    per = 0.5 * sides * np.sin(2 * np.pi / sides)  # area over the square of the radius
    shaft = per * 4.0 * (0.25 + 0.25 * top + 0.25 * top * top) / 3.0
    extra = 1.2**2 * 0.2 + 1.1**2 * 0.3 if feet else 0.0
    assert assembly.volume.sum() == pytest.approx(shaft + extra, **EXACT)
    radii = np.linspace(0.5, 0.5 * top, drums + 1)
    joints = radii if feet else radii[1:-1]
    assert joint_area(assembly) == pytest.approx(per * float((joints**2).sum()), **EXACT)


def test_a_plinth_is_no_narrower_than_the_shaft():
    with pytest.raises(ModelError, match=r"plinth: 0.9 m is narrower .* nearest that fits is 1 m"):
        drum_column(diameter=1.0, height=2.0, drums=2, plinth=(0.9, 0.2), **W)


@settings(max_examples=15, deadline=None)
@given(side=st.integers(1, 6), depth=st.integers(0, 5), cut=st.integers(0, 3))
def test_a_pyramid_stands_on_the_corners_of_the_course_below(side, depth, cut):
    length, height = 0.4, 0.2
    rows = min(side, depth) if depth else side
    courses = max(1, rows - cut)
    more = {"depth": depth} if depth else {}
    blocks = pyramid(side=side, unit=(length, height), courses=courses, **more, **W)
    assembly, joints = assembled(blocks), 0.0
    for k in range(courses):
        a, b = side - k, depth - k if depth else 1
        if depth:
            joints += ((a - 1) * b + a * (b - 1)) * length * height
            joints += a * b * length**2 if k else 0.0
        else:
            joints += (a - 1) * height + (a * length if k else 0.0)
    assert joint_area(assembly) == pytest.approx(joints, **EXACT)
    with pytest.raises(ModelError, match=f"the nearest that fits is {rows}"):
        pyramid(side=side, unit=(length, height), courses=rows + 1, **more, **W)


@settings(max_examples=20, deadline=None)
@given(foot=st.integers(4, 30), less=st.integers(0, 25), rows=st.integers(1, 8), deep=st.booleans())
def test_a_buttress_is_its_trapezoid(foot, less, rows, deep):
    wide = 0.1 * foot
    top, height = max(0.1 * (foot - less), 0.2), 0.25 * rows
    more = {"depth": 0.5} if deep else {}
    blocks = buttress(foot=wide, top=top, height=height, unit=(0.5, 0.25), **more, **W)
    assembly = assembled(blocks)
    area = 0.5 * (wide + top) * height
    rim = wide + top + height + np.hypot(height, wide - top)
    assert assembly.volume.sum() == pytest.approx(0.5 * area if deep else area, **EXACT)
    assert exposed(assembly) == pytest.approx(2 * area + 0.5 * rim if deep else rim, **EXACT)


@pytest.mark.parametrize("shape", ["round", "square"])
def test_a_tower_and_its_stair_of_openings(shape):
    width = 2.0 if shape == "round" else 2.8
    walls = {"width": width, "thickness": 0.4, "height": 2.5, "unit": (0.8, 0.25), "shape": shape}
    blocks = tower(**walls, openings=3, opening=(0.5, 0.5), first_sill=0.25, climb=0.5, **W)
    assembly = assembled(blocks)
    assert joint_area(assembly) == pytest.approx(brute_joints(assembly), rel=1e-6)
    whole = assembled(tower(**walls, **W))
    assert len(assembly.groups["lintels"]) == 3
    middles = np.array([assembly.centroid[k, :2] for k in assembly.groups["lintels"]])
    # In the south, a quarter of the way further each: east, north.
    assert np.degrees(np.arctan2(*middles.T[::-1])) == pytest.approx([-90, 0, 90], abs=1e-6)
    if shape == "square":
        assert whole.volume.sum() == pytest.approx((2.8**2 - 2.0**2) * 2.5, **EXACT)
        assert assembly.volume.sum() == pytest.approx(
            whole.volume.sum() - 3 * 0.5 * 0.5 * 0.4, **EXACT
        )
        return
    # Eight stones around (2 pi / 0.8 = 7.9): octagons, in every second course turned by half a
    # stone; an opening, 0.64 of a stone wide, takes one, half of it beyond a joint where it must.
    octagons = 0.5 * 8 * np.sin(2 * np.pi / 8) * (1.0 - 0.6**2)
    assert whole.volume.sum() == pytest.approx(octagons * 2.5, **EXACT)
    assert assembly.volume.sum() < whole.volume.sum()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"climb": None}, "give opening = "),
        ({"climb": 0.3}, "climb: 0.55 m ends inside a course"),
        ({"openings": 5}, "the nearest that fits are 4"),
        ({"openings": 5, "climb": 0.0}, "openings meet"),
        ({"opening": (3.0, 0.5)}, "as wide as half the tower"),
        ({"thickness": 1.0}, "less than half the width"),
        ({"shape": "oval"}, "there is no shape"),
    ],
)
def test_towers_that_cannot_be(change, sentence):
    measures = {
        "width": 2.0, "thickness": 0.4, "height": 2.75, "unit": (0.5, 0.25), "openings": 3,
        "opening": (0.5, 0.5), "first_sill": 0.25, "climb": 0.5,
    }  # fmt: skip
    with pytest.raises(ModelError, match=sentence):
        tower(**{**measures, **change}, **W)


@settings(max_examples=15, deadline=None)
@given(turns=st.integers(1, 4), stones=st.integers(6, 16), sunk=st.integers(0, 4))
def test_a_spiral_covers_itself(turns, stones, sunk):
    """Joints: all that is neither the outer turn, the last face, nor the cut by the ground."""
    core, pitch = 0.3, 0.25
    measures = {"core": core, "pitch": pitch, "turns": turns, "stones": stones}
    whole = assembled(spiral(**measures, **W))
    m = 2 * stones + 1
    angle = 2 * np.pi * np.arange(m * turns + 1) / m
    radius = core + pitch * np.arange(m * turns + 1) / m
    inner = radius[: m + 1] * np.exp(1j * angle[: m + 1])
    outer = (radius + pitch) * np.exp(1j * angle)
    rim = np.concatenate((outer[-m - 1 :], [radius[-1] * np.exp(1j * angle[-1])]))
    area = 0.5 * np.sum(rim.real * np.roll(rim.imag, -1) - np.roll(rim.real, -1) * rim.imag)
    assert whole.volume.sum() == pytest.approx(area, **EXACT)
    assert exposed(whole) == pytest.approx(np.abs(np.roll(rim, -1) - rim).sum(), **EXACT)
    assert len(inner) == m + 1
    cut = assembled(spiral(**measures, sunk=0.05 * sunk, depth=0.4, **W))
    heights = [block.vertices[:, 2].min() for block in cut.blocks]
    assert min(heights) == pytest.approx(0.0, abs=1e-9)
    assert cut.volume.sum() <= 0.4 * area * (1 + 1e-9)


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 10**6), columns=st.integers(1, 6), rows=st.integers(1, 6),
    relaxed=st.integers(0, 3), deep=st.booleans(),
)  # fmt: skip
def test_rubble_fills_its_rectangle(seed, columns, rows, relaxed, deep):
    length, height = 0.4 * columns, 0.25 * rows
    more = {"depth": 0.5} if deep else {}
    blocks = rubble(
        length=length, height=height, stone=(0.4, 0.25), seed=seed, relaxed=relaxed, **more, **W
    )
    assembly = assembled(blocks)
    assert len(blocks) == columns * rows + rows // 2
    for block in blocks:  # one convex part each, and no sliver of an edge
        assert len(block.figure().parts) == 1
    area, rim = length * height, 2 * (length + height)
    assert assembly.volume.sum() == pytest.approx(0.5 * area if deep else area, **EXACT)
    wanted = 2 * area + 0.5 * rim if deep else rim
    # Joints narrower than what counts as touching are none: 1e-4 of a stone each.
    assert exposed(assembly) == pytest.approx(wanted, rel=1e-3)


def test_rubble_is_as_its_seed_says():
    measures = {"length": 2.0, "height": 1.0, "stone": (0.4, 0.25), **W}
    first, again, other = (rubble(seed=seed, **measures) for seed in (3, 3, 4))
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.vertices, b.vertices)
    assert any(
        a.vertices.shape != b.vertices.shape or not np.allclose(a.vertices, b.vertices)
        for a, b in zip(first, other, strict=True)
    )
    for block in first:
        polygon.check_convex(block.vertices)
