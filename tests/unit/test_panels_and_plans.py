"""Walls that builders lay: their volume, their joints, where units are cut and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from built import assembled, exposed, joint_area
from drystone.model.builders import ModelError, panel, plan
from drystone.model.builders.coursing import BONDS, LEAST

W = {"unit_weight": 20e3}
# Sums of some hundred areas of the order of 1 m2, each to rounding errors of coordinates.
EXACT = {"rel": 1e-9}

lengths = st.integers(12, 60).map(lambda n: 0.05 * n)
bonds = st.sampled_from(BONDS)


def lengths_of(blocks, along=0):
    return np.array([np.ptp(block.vertices[:, along]) for block in blocks])


@settings(max_examples=25, deadline=None)
@given(
    length=lengths, courses=st.integers(1, 6), bond=bonds, leaves=st.integers(1, 3),
    headers=st.sampled_from((0, 2, 3)), deep=st.booleans(),
)  # fmt: skip
def test_a_panel_is_its_box_cut_into_stones(length, courses, bond, leaves, headers, deep):
    t, h = 0.3, 0.2
    more = {"thickness": t, "leaves": leaves} if deep else {}
    blocks = panel(
        length=length, height=courses * h, unit=(0.4, h), bond=bond, headers=headers, **more, **W
    )
    assembly = assembled(blocks)
    height = courses * h
    assert assembly.volume.sum() == pytest.approx(length * height * (t if deep else 1.0), **EXACT)
    box = 2 * (length * height + length * t + height * t) if deep else 2 * (length + height)
    assert exposed(assembly) == pytest.approx(box, **EXACT)
    # A stone is as short as a closer where the wall itself is not, and a joint left out makes its
    # neighbour that much longer.
    assert lengths_of(blocks).min() >= min(LEAST * 0.4, length) - 1e-12
    assert lengths_of(blocks).max() <= (1.0 + 2 * LEAST) * 0.4 + 1e-12


def test_joints_of_a_panel_by_hand():
    """Six courses of 2 m: five beds, and 4 or 5 head joints by turns."""
    blocks = panel(length=2.0, height=1.2, unit=(0.4, 0.2), thickness=0.3, **W)
    beds, heads = 5 * 2.0 * 0.3, (3 * 4 + 3 * 5) * 0.2 * 0.3
    assert joint_area(assembled(blocks)) == pytest.approx(beds + heads, **EXACT)
    assert [b.id for b in blocks][:6] == ["c1u1", "c1u2", "c1u3", "c1u4", "c1u5", "c2u1"]
    assert blocks[5].groups == ("course 2",)


@settings(max_examples=20, deadline=None)
@given(
    at=st.integers(6, 30), width=st.integers(4, 20), sill=st.integers(0, 2), rows=st.integers(1, 4),
    bond=bonds, leaves=st.integers(1, 2),
)  # fmt: skip
def test_an_opening_leaves_its_hole_and_its_reveals(at, width, sill, rows, bond, leaves):
    length, t, h = 3.0, 0.3, 0.2
    opening = {"at": 0.05 * at, "width": 0.05 * width, "sill": sill * h, "height": rows * h}
    measures = {"length": length, "height": 8 * h, "unit": (0.4, h), "thickness": t}
    try:
        blocks = panel(**measures, bond=bond, leaves=leaves, openings=[opening], **W)
    except ModelError as error:  # it would meet the wall's end: what it names fits
        assert not 0.1 <= 0.05 * at - 0.2 <= 0.05 * (at + width) + 0.2 <= length - 0.1
        if "nearest that fits is at = " in str(error):
            opening["at"] = float(str(error).rsplit(" ", 1)[1])
            panel(**measures, bond=bond, leaves=leaves, openings=[opening], **W)
        return
    wide, high = opening["width"], opening["height"]
    assembly = assembled(blocks)
    assert assembly.volume.sum() == pytest.approx((length * 8 * h - wide * high) * t, **EXACT)
    box = 2 * (length * 8 * h + length * t + 8 * h * t - wide * high)
    # An opening on the ground has no sill, and the wall no foot there: both are its width.
    around = 2 * high + (wide - wide if sill == 0 else 2 * wide)
    assert exposed(assembly) == pytest.approx(box + around * t, **EXACT)
    (lintel,) = [block for block in blocks if "lintels" in block.groups]
    assert np.ptp(lintel.vertices, axis=0) == pytest.approx([wide + 0.4, t, h], **EXACT)


def test_bonds_tie_leaves_together():
    """Leaves alone are two walls side by side; headers go through both."""
    measures = {"length": 2.0, "height": 1.2, "unit": (0.4, 0.2), "thickness": 0.4, "leaves": 2}
    for bond, headers in (("english", 3 * 11), ("header", 3 * 10 + 3 * 11)):
        blocks = panel(**measures, bond=bond, **W)
        assert sum("headers" in block.groups for block in blocks) == headers
    blocks = panel(**measures, **W)
    assert {g for b in blocks for g in b.groups if g.startswith("leaf")} == {"leaf 1", "leaf 2"}
    assert not any("headers" in block.groups for block in blocks)
    tied = panel(**measures, headers=3, **W)
    rows = {b.groups[0] for b in tied if "headers" in b.groups}
    assert rows == {"course 3", "course 6"}


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"height": 1.3}, "height: 1.3 m is no whole number of courses of 0.2 m: .* 1.2 m and 1.4"),
        ({"bond": "flemisch"}, 'bond: there is no bond "flemisch": did you mean "flemish"'),
        ({"leaves": 2}, "leaves: must be 1 in the plane"),
        ({"openings": [{"at": 0.9, "width": 0.5, "height": 0.5}]}, "height: .* 0.4 m and 0.6 m"),
        ({"openings": [{"at": 0.0, "width": 0.5, "height": 0.4}]}, "fits is at = 0.3"),
        ({"openings": [{"at": 0.9, "width": 0.5, "height": 1.2, "sill": 0.2}]}, "lower the sill"),
        ({"openings": [{"at": 0.9, "width": 0.5}]}, r"openings\[1\]: height is missing"),
        ({"openings": [{"at": 0.9, "widht": 0.5}]}, 'unknown key "widht": did you mean "width"'),
        ({"length": 1e9}, "more than 20000 blocks"),
    ],
)
def test_what_does_not_fit_is_refused_with_what_does(change, sentence):
    measures = {"length": 2.0, "height": 1.2, "unit": (0.4, 0.2)}
    with pytest.raises(ModelError, match=sentence):
        panel(**{**measures, **change}, **W)


@settings(max_examples=15, deadline=None)
@given(a=lengths, b=lengths, courses=st.integers(1, 5), bond=bonds, leaves=st.integers(1, 2))
def test_a_rectangle_of_walls(a, b, courses, bond, leaves):
    t, h = 0.2, 0.2
    blocks = plan(
        rectangle=(a, b), thickness=t, height=courses * h, unit=(0.4, h), bond=bond, leaves=leaves,
        **W,
    )  # fmt: skip
    assembly = assembled(blocks)
    foot, height = a * b - (a - 2 * t) * (b - 2 * t), courses * h
    assert assembly.volume.sum() == pytest.approx(foot * height, **EXACT)
    assert exposed(assembly) == pytest.approx(
        2 * foot + 2 * (a + b + a + b - 4 * t) * height, **EXACT
    )


@settings(max_examples=15, deadline=None)
@given(
    angle=st.integers(30, 150), at=st.integers(12, 24), through=st.booleans(), bond=bonds,
    courses=st.integers(1, 4),
)  # fmt: skip
def test_a_wall_that_meets_another_one_at_any_angle(angle, at, through, bond, courses):
    """Volume by inclusion and exclusion: of strips that cross, their rhombus is once."""
    t, h, turn = 0.2, 0.2, np.radians(angle)
    foot = np.array([0.1 * at, 0.0])
    tip = foot + 2.0 * np.array([np.cos(turn), np.sin(turn)])
    other = 2 * foot - tip if through else foot
    blocks = plan(
        lines=[[(0.0, 0.0), (4.0, 0.0)], [other, tip]],
        thickness=t, height=courses * h, unit=(0.4, h), bond=bond, **W,
    )  # fmt: skip
    rhombus = t * t / np.sin(turn)
    length = 4.0 if through else 2.0
    area = 4.0 * t + length * t - rhombus / (1.0 if through else 2.0)
    assert assembled(blocks).volume.sum() == pytest.approx(area * courses * h, **EXACT)


@pytest.mark.parametrize("angle", [30, 60, 90, 120, 145, -60])
def test_a_corner_is_closed_and_interlocked(angle):
    """In plan two strips to a mitre: what each is longer by on its outer face, t/2 tan(a/2), it is
    shorter by on its inner one."""
    t, turn = 0.3, np.radians(angle)
    lines = [[(0.0, 0.0), (3.0, 0.0), (3.0 + 3 * np.cos(turn), 3 * np.sin(turn))]]
    blocks = plan(lines=lines, thickness=t, height=0.8, unit=(0.5, 0.2), **W)
    assembly = assembled(blocks)
    assert assembly.volume.sum() == pytest.approx(6.0 * t * 0.8, **EXACT)
    # In every course the stone in the corner's inner face reaches further, by a closer at least.
    corner = np.array([3.0, 0.0])
    ways = {"wall w1": np.array([-1.0, 0.0]), "wall w2": np.array([np.cos(turn), np.sin(turn)])}
    for course in range(4):
        row = [blocks[i] for i in assembly.groups[f"course {course + 1}"]]
        (stone,) = (
            b for b in row if b.figure().distance(np.array([*corner, 0.1 + 0.2 * course])) < 0
        )
        (wall,) = (group for group in stone.groups if group.startswith("wall"))
        assert wall == ("wall w1" if course % 2 else "wall w2")
        length = np.ptp(stone.vertices[:, :2] @ ways[wall])
        assert length >= t / abs(np.sin(turn)) + LEAST * 0.5 - 1e-9


def test_storeys_floors_and_their_groups():
    openings = [
        {"wall": "south", "at": 0.5, "width": 0.5, "height": 0.8, "storey": 1},
        {"wall": "east", "at": 0.8, "width": 0.6, "height": 0.4, "sill": 0.4},
    ]
    blocks = plan(
        rectangle=(3.0, 2.4), thickness=0.2, height=1.6, unit=(0.4, 0.2), storeys=2, floor=0.15,
        beam=0.5, openings=openings, lines=[[(1.5, 0.1), (1.5, 2.3)]], **W,
    )  # fmt: skip
    assembly = assembled(blocks)
    foot = 3.0 * 2.4 - 2.6 * 2.0 + 2.0 * 0.2
    holes = 0.5 * 0.8 + 2 * 0.6 * 0.4
    volume = 2 * (foot * 1.6 + 3.0 * 2.4 * 0.15) - holes * 0.2
    assert assembly.volume.sum() == pytest.approx(volume, **EXACT)
    assert len(assembly.groups["floor 1"]) == 6  # beams of 0.5 m across 3 m
    assert len(assembly.groups["lintels"]) == 3
    assert {"storey 1", "storey 2", "wall w1", "course 16"} <= set(assembly.groups)
    assert "course 17" not in assembly.groups
    assert "east/s2lintel1" in assembly.ids
    assert assembly.blocks[-1].vertices[:, 2].max() == pytest.approx(2 * 1.75, **EXACT)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"rectangle": None}, "there is no wall: give a rectangle or lines"),
        ({"rectangle": None, "floor": 0.2, "lines": [[(0, 0), (3, 0)]]}, "beams need a rectangle"),
        ({"lines": [[(0.1, 0.1), (2.9, 0.1)]]}, "go on straight"),
        ({"lines": [[(0.1, 0.1), (1.0, 1.0)]]}, "all end at"),
        ({"openings": [{"wall": "sud", "at": 1, "width": 1, "height": 1}]}, 'mean "south"'),
        (
            {"openings": [{"wall": "south", "at": 1, "width": 1, "height": 1, "storey": 2}]},
            "storey: must be from 1 to 1",
        ),
        (
            {
                "lines": [[(1.5, 0.1), (1.5, 2.3)]],
                "openings": [{"wall": "south", "at": 1.2, "width": 0.4, "height": 1.0}],
            },
            "another wall or an opening: the nearest that fits is at = ",
        ),
    ],
)
def test_plans_that_cannot_be_laid(change, sentence):
    measures = {"rectangle": (3.0, 2.4), "thickness": 0.2, "height": 1.6, "unit": (0.4, 0.2)}
    with pytest.raises(ModelError, match=sentence):
        plan(**{**measures, **change}, **W)
