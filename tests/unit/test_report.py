"""Figures: what they say of a made-up wall whose mechanism is known."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import synthetic
from matplotlib.collections import LineCollection
from matplotlib.image import imread

from drystone.cli.run import report
from drystone.common.language import speaking
from drystone.io.results.summary import summarise
from drystone.limit.beside import Beside
from drystone.report import canvas, draw_benchmark_wall, draw_curve, draw_mechanism, plot_curve
from drystone.report.curve_figure import plot_curves
from drystone.report.joints import Joints
from drystone.report.mechanism import Drawn, Mechanism, readable_magnification
from drystone.report.mechanism_figure import plot_mechanism
from drystone.results.curve import SETTLEMENT
from drystone.results.events import Event, EventKind
from drystone.results.shapes import MovingShapes, moving_blocks


def mechanism(model, control_displacement):
    return Mechanism(
        assembly=model.assembly,
        pose=synthetic.pose_at(model, control_displacement),
        load_direction=model.load.direction,
        control_point=model.control_point,
    )


def labels(axes):
    return axes.get_legend_handles_labels()[1]


def is_picture(path: Path) -> bool:
    """A PNG with something on it."""
    return float(imread(path)[..., :3].std()) > 0.01


def test_outlines_move_like_the_assembly():
    model = synthetic.wall_model()
    pose = synthetic.pose_at(model, 0.2)
    outlines = MovingShapes.of(model.assembly)
    for i, outline in enumerate(outlines.split(outlines.moved(pose))):
        # The same rotation and sum, rounded in another order: some units in the last place.
        np.testing.assert_allclose(outline, model.assembly.outline(i, pose), rtol=0, atol=1e-14)


def test_moving_blocks_are_those_of_the_mechanism():
    model = synthetic.wall_model()
    displacement = MovingShapes.of(model.assembly).displacement(synthetic.pose_at(model, 0.2))
    moving = moving_blocks(displacement, model.assembly.fixed)
    # Base and first course, four bodies, stay; three blocks in each of three courses go.
    assert moving.tolist() == [False] * 4 + [True] * 9


def test_nothing_moves_at_rest():
    model = synthetic.wall_model()
    displacement = MovingShapes.of(model.assembly).displacement(model.assembly.design_pose())
    assert not moving_blocks(displacement, model.assembly.fixed).any()


def test_blocks_that_only_sank_do_not_move():
    """The wall as a whole sank before the load began; since then only one block has moved."""
    model = synthetic.wall_model()
    sunk = model.assembly.design_pose()
    sunk[~model.assembly.fixed, 1] = -0.01
    pose = sunk.copy()
    row = model.assembly.n_bodies - 1
    pose[row, 0] += 1e-3
    outlines = MovingShapes.of(model.assembly)
    moving = moving_blocks(outlines.displacement(pose, sunk), model.assembly.fixed)
    assert np.flatnonzero(moving).tolist() == [row]
    joints = Joints.of(model.assembly)
    opening, slip = joints.opening_and_slip(pose, sunk)
    others = (joints.designed.block_a != row) & (joints.designed.block_b != row)
    # Differences of coordinates of the order of 1 m.
    assert opening[others] == pytest.approx(0.0, abs=1e-14)
    assert slip[others] == pytest.approx(0.0, abs=1e-14)

    axes = canvas.new_figure(4.0, 4.0).subplots()
    plot_mechanism(axes, replace(mechanism(model, 0.0), pose=sunk, initial=sunk, contacts=None))
    assert "moving" not in axes.get_legend_handles_labels()[1]
    # The sinking alone would have been magnified otherwise.
    alone = readable_magnification(model.assembly, pose - sunk)
    assert readable_magnification(model.assembly, pose, sunk) == alone > 1.0


def test_opening_of_the_rocking_joint():
    model = synthetic.wall_model()
    pose = synthetic.pose_at(model, 0.1)
    joints = Joints.of(model.assembly)
    opening, slip = joints.opening_and_slip(pose)
    crossing = (joints.designed.block_a <= 3) & (joints.designed.block_b >= 4)
    # The joint turns about its right end by asin(0.1 / 0.525), and is 1 m long.
    assert opening[crossing].max() == pytest.approx(np.sin(np.arcsin(0.1 / 0.525)), rel=1e-12)
    assert np.abs(opening[~crossing]).max() < 1e-12  # rigid within each part
    assert slip[~crossing].max() < 1e-12


def test_open_and_slid_joints_are_drawn_apart():
    model = synthetic.wall_model()
    axes = canvas.new_figure(4, 4).subplots()
    plot_mechanism(axes, mechanism(model, 0.1))
    assert {"moving", "at rest", "support", "open joint", "control point"} <= set(labels(axes))
    assert "slid joint" not in labels(axes)

    pose = model.assembly.design_pose()
    pose[4:, 0] = 0.05  # the upper courses slide as one
    axes = canvas.new_figure(4, 4).subplots()
    plot_mechanism(axes, replace(mechanism(model, 0.0), pose=pose))
    assert "slid joint" in labels(axes) and "open joint" not in labels(axes)
    (slid,) = [c for c in axes.collections if isinstance(c, LineCollection)]
    assert len(slid.get_segments()) == 5  # the bed joints between first and second course


def test_joints_of_blocks_that_have_left_are_none():
    """The upper courses slide past what stays; of one that has left nothing is drawn but dashes."""
    model = synthetic.wall_model()
    pose = model.assembly.design_pose()
    pose[4:, 0] = 0.05
    row = model.assembly.n_bodies - 1
    departed = np.arange(model.assembly.n_bodies) == row
    shown = replace(mechanism(model, 0.0), pose=pose, departed=departed)
    joints = Joints.of(model.assembly)
    opened, slid = Drawn.of(shown).changed(joints)
    of_it = (joints.designed.block_a == row) | (joints.designed.block_b == row)
    assert of_it.any() and not (opened | slid)[of_it].any() and slid[~of_it].any()


def test_numbers_along_the_axes_have_the_decimal_mark_of_the_language(tmp_path):
    for language, mark in (("en", "0.6"), ("it", "0,6")):
        figure = canvas.new_figure(4.0, 4.0)
        with speaking(language):
            axes = figure.subplots()
            canvas.plain_axes(axes)
            axes.set_xlim(0.0, 1.0)
            axes.set_ylim(0.24957, 0.249571)  # of which all but the last figures stand apart
        canvas.save(figure, tmp_path / "axes.svg", "svg")
        told = set(re.findall(r">([^<>]+)</text>", (tmp_path / "axes.svg").read_text()))
        assert mark in told
        assert not any("." in text for text in told) or language == "en"


def test_picture_of_a_wall_at_rest(tmp_path):
    model = synthetic.wall_model()
    pose = model.assembly.design_pose()
    draw_mechanism(Mechanism(assembly=model.assembly, pose=pose), tmp_path / "rest.png")
    assert is_picture(tmp_path / "rest.png")


@pytest.mark.parametrize("direction", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.6, -0.8)])
def test_arrow_of_the_load_is_in_the_picture(direction):
    model = synthetic.wall_model()
    axes = canvas.new_figure(4, 4).subplots()
    plot_mechanism(axes, replace(mechanism(model, 0.1), load_direction=np.array(direction)))
    (arrow,) = [text for text in axes.texts if getattr(text, "arrow_patch", None)]
    tail, tip = np.array(arrow.get_position()), np.array(arrow.xy)
    along = (tip - tail) / np.linalg.norm(tip - tail)
    np.testing.assert_allclose(along, direction, atol=1e-12)
    for end in (tail, tip):
        assert axes.get_xlim()[0] < end[0] < axes.get_xlim()[1]
        assert axes.get_ylim()[0] < end[1] < axes.get_ylim()[1]


def test_small_displacements_are_magnified_by_a_round_number():
    model = synthetic.wall_model()
    magnified = readable_magnification(model.assembly, synthetic.pose_at(model, 1e-3))
    assert magnified in {20.0, 50.0}  # to about a twentieth of the wall's 1.2 m
    assert readable_magnification(model.assembly, synthetic.pose_at(model, 0.2)) == 1.0
    assert readable_magnification(model.assembly, model.assembly.design_pose()) == 1.0


def test_mechanism_of_many_blocks(tmp_path):
    model = synthetic.wall_model(courses=50, units=40)
    pose = synthetic.pose_at(model, 0.5)
    many = synthetic.contacts_at(model, pose)
    draw_mechanism(
        Mechanism(assembly=model.assembly, pose=pose, contacts=many), tmp_path / "many.png"
    )
    assert is_picture(tmp_path / "many.png")


def test_curve_names_branches_peak_and_end(tmp_path):
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", synthetic.curve())], limits={"non-associative": 0.52})
    assert {
        "ascending branch",
        "post-peak branch",
        "peak",
        "ultimate displacement",
        "dynamic: between states at rest",
        "non-associative: 0.520",
    } == set(labels(axes))
    written = " ".join(text.get_text() for text in axes.texts)
    assert "0.500" in written and "2.00 mm" in written  # the peak that synthetic.curve has
    assert "0.392 m" in written  # 0.002 + 0.398 (1 - 0.01 / 0.5), see synthetic.points
    assert axes.get_xlabel().endswith("[m]")


def test_a_branch_that_is_passed_in_motion_is_not_in_the_legend():
    """Nothing is drawn of it but the points in motion, which have a name of their own."""
    whole = synthetic.curve(dynamic=False)
    top = whole.points.index(whole.capacity)
    points = tuple(
        replace(point, status="dynamic") if k > top else point
        for k, point in enumerate(whole.points)
    )
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", replace(whole, points=points))])
    assert "ascending branch" in labels(axes) and "post-peak branch" not in labels(axes)


def test_what_is_left_after_a_collapse_has_a_branch_of_its_own():
    """The post-peak branch of the whole structure was told to be that of what is left."""
    whole = synthetic.curve(dynamic=False)
    last = whole.points[40]
    points = tuple(
        replace(point, load_multiplier=point.load_multiplier + (point.step > last.step))
        for point in whole.points
    )
    fallen = Event(
        kind=EventKind.BLOCK_FALLEN,
        step=last.step,
        control_displacement=last.control_displacement,
        load_multiplier=last.load_multiplier,
        blocks=("b1",),
        motion=1.0,
    )
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", replace(whole, points=points, events=(fallen,)))])
    lines = {line.get_label(): line for line in axes.lines}
    assert lines["post-peak branch"].get_xdata()[-1] == last.control_displacement
    left = lines["after a part collapsed"]
    assert left.get_xdata()[-1] == points[-1].control_displacement
    assert left.get_color() != lines["post-peak branch"].get_color()


def test_static_line_leaves_out_dynamic_points():
    curve = synthetic.curve()
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", curve)])
    static = [line for line in axes.lines if "branch" in str(line.get_label())]
    drawn = np.concatenate([line.get_ydata() for line in static])
    dynamic = [p.load_multiplier for p in curve.points if p.status == "dynamic"]
    assert dynamic and not np.isin(dynamic, drawn).any()


def test_curve_that_stopped_says_so():
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", synthetic.curve(200, end=0.1, status="stopped"))])
    assert "curve stopped" in labels(axes)


def test_a_curve_interrupted_on_its_ascent_has_no_peak_yet():
    """What it has reached was called its peak."""
    ascent = synthetic.curve(200, end=0.5 * synthetic.PEAK_AT, status="interrupted")
    assert not ascent.peak_passed and synthetic.curve().peak_passed
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", ascent)])
    assert "highest so far" in labels(axes) and "peak" not in labels(axes)
    assert all("peak" not in text.get_text() for text in axes.texts)
    told = report("wall", ascent, Path("out"), Beside())
    assert "highest so far" in told and "peak" not in told
    assert summarise(ascent, synthetic.wall_model())["peak_passed"] is False


def test_several_curves_have_their_values_in_the_legend():
    axes = canvas.new_figure(4, 4).subplots()
    curves = [("nscd", synthetic.curve()), ("distinct", synthetic.curve(dynamic=False))]
    plot_curves(axes, curves, reference=[("recorded", np.array([0.0, 0.4]), np.array([0.5, 0.0]))])
    assert "nscd: peak 0.500, 0.392 m at 0.01" in labels(axes)
    assert {"distinct: peak 0.500, 0.392 m at 0.01", "recorded"} <= set(labels(axes))


@pytest.mark.parametrize("n", [8, 60])
@pytest.mark.parametrize("end", [0.0, 1e-3, 0.02, 0.4])
def test_curve_figure_of_any_length(tmp_path, n, end):
    """From a single point at rest to the whole curve."""
    draw_curve(synthetic.curve(n, end=end, status="interrupted"), tmp_path / "curve.png")
    assert is_picture(tmp_path / "curve.png")


def test_a_curve_that_ends_far_beyond_what_is_shown(tmp_path, recwarn):
    """Its last point, in motion, had a mark where it was, which left no place for the axes."""
    curve = synthetic.curve(end=0.1, status="stopped")
    last = synthetic.point(len(curve.points), 0.12, 1e7, status="dynamic")
    curve = replace(curve, points=(*curve.points, last))
    axes = canvas.new_figure(4, 4).subplots()
    plot_curves(axes, [("", curve)])
    (mark,) = (line for line in axes.lines if line.get_label() == "curve stopped")
    assert axes.get_ylim()[1] < 1.0 and 0.0 < mark.get_ydata()[0] < axes.get_ylim()[1]
    (words,) = (text for text in axes.texts if text.get_text().startswith("ends at"))
    assert words.xy[1] == mark.get_ydata()[0]
    draw_curve(curve, tmp_path / "curve.png")
    assert not recwarn.list


def test_benchmark_page(tmp_path):
    model = synthetic.wall_model()
    for engines in (["nscd"], ["nscd", "distinct"], ["a", "b", "c"]):
        path = tmp_path / f"{len(engines)}.png"
        draw_benchmark_wall(
            [(name, synthetic.curve()) for name in engines],
            [(name, mechanism(model, 0.2)) for name in engines],
            path,
            title="Wall",
        )
        assert is_picture(path)


def test_pyplot_is_not_touched(tmp_path):
    """Figures leave the global state of matplotlib alone."""
    code = (
        "import sys, synthetic, matplotlib as m; from drystone.report import draw_curve\n"
        "settings = lambda: list(dict.items(m.rcParams))  # dict(m.rcParams) would import pyplot\n"
        "before = settings(); draw_curve(synthetic.curve(), sys.argv[1])\n"
        "assert 'matplotlib.pyplot' not in sys.modules; assert before == settings()\n"
    )
    synthetic.python(code, str(tmp_path / "curve.png"))


@pytest.mark.parametrize(("unit", "motion"), [("m", "0.200 m"), ("rad", "11.46°")])
def test_curve_of_supports_that_move(tmp_path, unit, motion):
    """Reaction [N, N m] against their motion [m, degrees]; values stand in the legend alone."""
    moves_supports = moved_supports(unit)
    draw_curve(moves_supports, tmp_path / "curve.png", title="Arch")
    assert is_picture(tmp_path / "curve.png")
    axes = plot_curve(moves_supports, canvas.new_figure(4, 4).subplots())
    degrees = unit == "rad"
    assert axes.get_xlabel().endswith("[°]" if degrees else "[m]")
    assert axes.get_ylabel() == f"support reaction [{'N m' if degrees else 'N'}]"
    force = "N m" if degrees else "N"
    # 9000 N at first, 7500 N at 0.05, 12000 N at 0.2, see `moved_supports`.
    assert {f"greatest and last: 12000 {force} at {motion}", "support reaction"} < set(labels(axes))
    assert not axes.texts
    told = report("arch", moves_supports, Path("out"), Beside())
    assert f"12000 {force} at " in told and "peak" not in told
    assert "peak" not in repr(moves_supports)


def moved_supports(unit):
    """Supports that move: their reaction falls from 9000 N to 7500 N and rises to 12000 N."""
    at, reaction = (0.0, 0.05, 0.2), (9e3, 7.5e3, 1.2e4)
    points = [
        synthetic.point(step, x, r / 5e4, reaction=r)
        for step, (x, r) in enumerate(zip(at, reaction, strict=True))
    ]
    whole = replace(synthetic.curve(), points=tuple(points))
    return replace(whole, strategy=SETTLEMENT, motion_unit=unit)


def test_words_at_the_end_of_a_rising_curve_stay_within_it(tmp_path):
    """Peak and end are one point: it is written once, to its left."""
    rising = synthetic.curve(200, end=0.5 * synthetic.PEAK_AT, status="interrupted")
    figure = canvas.new_figure(7.5, 5.4)
    axes = figure.subplots()
    plot_curves(axes, [("", rising)])
    figure.draw_without_rendering()
    (text,) = axes.texts
    box, frame = text.get_window_extent(), axes.get_window_extent()
    assert box.x0 > frame.x0 and box.x1 < frame.x1
