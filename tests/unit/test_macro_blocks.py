"""Blocks that move as one, shapes of mechanisms, and what takes part in them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import drystone as ds
from drystone.assessment.errors import AssessmentError
from drystone.assessment.mechanism import (
    AT_REST,
    capacity_of,
    course_of,
    find_macro_blocks,
    initial_shape,
    reduced,
    secant_participation,
    static_envelope,
    tangent_shape,
)
from drystone.assessment.mechanism.field import VelocityField, chord
from drystone.assessment.mechanism.orientation import share_out_of_plane
from drystone.assessment.mechanism.overturning import stands_on_its_axis
from drystone.geometry.motion import across
from drystone.results.events import Event, EventKind
from rigid_walls import HEIGHT, WIDTH, curve_of, evenly, point_at, turning, wall_in_courses
from solids import box, joint, model_of

ALPHA = np.arctan(WIDTH / HEIGHT)
ANGLES = np.concatenate((np.linspace(1e-6, 2e-3, 5), np.linspace(4e-3, 0.99 * ALPHA, 60)))
#: Rounding of sums of a few dozen products.
EXACT = 1e-11


def field_of(model, twists, place=None):
    """A field of twists (v_x, v_y, spin) about the origin, one for each block."""
    twists = np.array(twists, dtype=float)
    place = model.assembly.centroid if place is None else place
    spin = twists[:, 2:]
    return VelocityField(place=place, velocity=twists[:, :2] + across(spin, place), spin=spin)


def stack(n):
    return wall_in_courses(evenly(n))


X = np.array([1.0, 0.0])


def test_blocks_of_one_twist_are_one_body_and_the_support_is_none():
    model = stack(4)
    labels = find_macro_blocks(
        model.assembly, field_of(model, [[0, 0, 0]] + [[0, 0, -0.25]] * 4), X
    )
    assert labels.tolist() == [AT_REST, 0, 0, 0, 0]


def test_a_difference_below_the_tolerance_is_none_and_above_it_parts():
    model = stack(2)

    def labels(slip):
        twists = [[0, 0, 0], [0.5, 0, 0], [0.5 + slip, 0, 0]]
        return find_macro_blocks(model.assembly, field_of(model, twists), X).tolist()

    assert labels(0.049) == [AT_REST, 0, 0]  # SAME is 0.05
    assert labels(0.051) == [AT_REST, 0, 1]


def test_blocks_that_move_alike_but_do_not_touch_are_apart():
    model = stack(3)
    twists = [[0, 0, 0], [0.5, 0, 0], [0, 0, 0], [0.5, 0, 0]]
    labels = find_macro_blocks(model.assembly, field_of(model, twists), X)
    assert labels.tolist() == [AT_REST, 0, AT_REST, 1]


def test_a_chain_that_bends_link_by_link_is_not_one_body():
    # Neighbours differ by 0.04, within the tolerance; the middle is 0.2 faster than both ends,
    # which no rigid motion is.
    model = stack(10)
    speeds = [0.5 + 0.04 * min(i, 9 - i) for i in range(10)]
    twists = [[0, 0, 0]] + [[speed, 0, 0] for speed in speeds]
    labels = find_macro_blocks(model.assembly, field_of(model, twists), X)
    assert labels.max() >= 1 and (labels[1:] >= 0).all()


def test_a_foot_belongs_to_its_body_but_slow_halves_do_not():
    # The lowest of twenty courses goes 1/40 of the top's way, less than what counts as rest.
    model = stack(20)
    turn = [[0, 0, 0]] + [[0, 0, -1 / HEIGHT]] * 20
    assert (find_macro_blocks(model.assembly, field_of(model, turn), X)[1:] == 0).all()
    # Half of a body that turns about a point within it is slow: that half is at rest.
    model = stack(2)
    low, high = model.assembly.centroid[1:, 1]
    twist = [0.03 - 0.1 * low, 0.0, -0.1]  # 0.03 along the load at the lower centroid
    assert 0.03 + 0.1 * (high - low) > 0.05
    labels = find_macro_blocks(model.assembly, field_of(model, [[0, 0, 0], twist, twist]), X)
    assert labels.tolist() == [AT_REST, AT_REST, 0]


def test_blocks_that_have_left_are_at_rest():
    model = stack(3)
    departed = np.array([False, False, False, True])
    field = field_of(model, [[0, 0, 0]] + [[0.5, 0, 0]] * 3)
    labels = find_macro_blocks(model.assembly, field, X, departed=departed)
    assert labels.tolist() == [AT_REST, 0, 0, AT_REST]


@given(
    angle=st.floats(-2.0, 2.0),
    start=st.floats(-3.0, 3.0),
    pole=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
)
@settings(max_examples=50, deadline=None)
def test_chords_of_a_rotation_in_the_plane_are_its_twist(angle, start, pole):
    """Every point goes 2 tan(angle/2) times its arm from the pole to where it is halfway."""
    model = stack(3)
    pole = np.array(pole)

    def poses(theta):
        c, s = np.cos(theta), np.sin(theta)
        arm = model.assembly.centroid - pole
        move = arm @ np.array([[c, s], [-s, c]]) - arm
        return np.column_stack((move, np.full(len(arm), theta)))

    field = chord(model.assembly, poses(start), poses(start + angle))
    spin = 2.0 * np.tan(0.5 * angle)
    assert field.spin == pytest.approx(np.full((4, 1), spin), rel=1e-9, abs=1e-9)
    expected = across(field.spin, field.place - pole)
    assert field.velocity == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_chords_of_rotations_in_space_are_their_twists():
    model = ds.extruded(stack(3))
    assembly = model.assembly
    rng = np.random.default_rng(3)
    for _ in range(20):
        pole, axis, angle = rng.normal(size=3), rng.normal(size=3), rng.uniform(-2.0, 2.0)
        axis /= np.linalg.norm(axis)
        poses = []
        for turn in (0.4, 0.4 + angle):
            cross = np.cross(np.eye(3), axis)  # times v: axis x v
            matrix = np.eye(3) + np.sin(turn) * cross + (1 - np.cos(turn)) * cross @ cross
            arm = assembly.centroid - pole
            quaternion = [np.cos(0.5 * turn), *(np.sin(0.5 * turn) * axis)]
            move = arm @ matrix.T - arm
            poses.append(np.column_stack((move, np.tile(quaternion, (len(arm), 1)))))
        field = chord(assembly, *poses)
        spin = 2.0 * np.tan(0.5 * angle) * axis
        assert field.spin == pytest.approx(np.tile(spin, (4, 1)), rel=1e-8, abs=1e-9)
        expected = np.cross(spin, field.place - pole)
        assert field.velocity == pytest.approx(expected, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("n", [1, 2, 5, 20])
def test_a_wall_that_turns_as_one_is_one_body_however_it_is_cut(n):
    """e* = 1 and Gamma = 2, as the top goes twice as far as the centroid; brick by brick
    e* = 3 n^2/(4 n^2 - 1)."""
    model = stack(n)
    found = reduced(turning(model, ANGLES), model)
    shape, capacity = found.shape, found.capacities["base_shear"]
    assert (shape.n_bodies, shape.n_moving) == (1, n)
    assert capacity.participating_mass_ratio == pytest.approx(1.0, rel=EXACT)
    assert capacity.participation_factor == pytest.approx(2.0, rel=EXACT)
    assert shape.blocks.mass_ratio == pytest.approx(3 * n**2 / (4 * n**2 - 1), rel=EXACT)
    # One rocking block: c = 0.75/(1 + (b/h)^2), from sum m |v|^2 + J w^2 = m 4/3 R^2 w^2.
    assert shape.kinetic_ratio == pytest.approx(0.75 / (1.0 + (WIDTH / HEIGHT) ** 2), rel=EXACT)
    assert not shape.twists


@given(st.lists(st.floats(0.02, 0.98), min_size=1, max_size=12, unique=True))
@settings(max_examples=25, deadline=None)
def test_the_capacity_does_not_depend_on_where_a_body_is_cut(shares):
    cuts = [HEIGHT * share for share in sorted({round(s, 3) for s in shares})]
    whole, cut = wall_in_courses([HEIGHT]), wall_in_courses([*cuts, HEIGHT])
    one, many = (capacity_of(turning(model, ANGLES), model) for model in (whole, cut))
    for name in ("participating_mass_ratio", "participation_factor", "participating_mass"):
        assert getattr(many, name) == pytest.approx(getattr(one, name), rel=1e-10)
    assert many.collapse_displacement == pytest.approx(one.collapse_displacement, rel=1e-10)
    assert many.acceleration_at(0.1) == pytest.approx(one.acceleration_at(0.1), rel=1e-10)


def test_the_initial_shape_is_that_of_the_undeformed_wall_wherever_it_is_read():
    model = stack(3)
    shapes = [
        initial_shape(turning(model, np.linspace(start, 0.12, 30)), model).delta
        for start in (1e-6, 0.03, 0.06)
    ]
    heights = model.assembly.centroid[1:, 1] / HEIGHT
    for delta in shapes:
        assert delta[1:] == pytest.approx(heights, rel=1e-10)


def test_displacements_by_the_stiffness_of_joints_are_taken_out():
    """Elastic sway in proportion to the multiplier, over the whole wall: none is left."""
    model = stack(4)
    rigid = turning(model, ANGLES)
    sway = 1e-4 * (model.assembly.centroid[:, 1] / HEIGHT) ** 2
    sway[0] = 0.0
    loading = np.linspace(0.0, 0.9, 8)[1:] * rigid.points[1].load_multiplier
    poses = np.zeros((len(loading) + len(rigid.points), 5, 3))
    poses[len(loading) + 1 :] = rigid.poses[1:]
    x = np.concatenate(([0.0], loading, rigid.load_multiplier[1:]))
    poses[:, :, 0] += x[:, None] * sway
    displacement = [model.control_point.displacement(model.assembly, pose) for pose in poses]
    points = [point_at(k, d, v) for k, (d, v) in enumerate(zip(displacement, x, strict=True))]
    shape = initial_shape(curve_of(points, poses), model)
    heights = model.assembly.centroid[1:, 1] / HEIGHT
    # The rate is read at a fifth of the peak from exact data: rounding of 1e-6 rad is left.
    assert shape.delta[1:] == pytest.approx(heights, rel=1e-9)


def test_tangent_and_secant_of_a_turning_wall():
    model = stack(5)
    curve = turning(model, ANGLES)
    tangent = tangent_shape(curve, model, 40)
    assert tangent.bodies.mass_ratio == pytest.approx(1.0, rel=EXACT)
    # Chords turn with the wall: halfway between the angles, about its toe.
    angle = 0.5 * (ANGLES[39] + ANGLES[33])
    u = 0.5 * HEIGHT * np.cos(angle) + 0.5 * WIDTH * np.sin(angle)
    top = HEIGHT * np.cos(angle)
    assert tangent.bodies.factor == pytest.approx(top / u, rel=1e-9)
    secant = secant_participation(curve, model, 40)
    c, s = np.cos(ANGLES[39]), np.sin(ANGLES[39])
    z = model.assembly.centroid[1:, 1]
    move = s * z + (1 - c) * 0.5 * WIDTH
    assert secant.mass_ratio == pytest.approx(move.sum() ** 2 / (5 * (move**2).sum()), rel=1e-9)


def test_a_course_along_the_curve_has_its_ends_and_its_peak():
    model = stack(2)
    curve = turning(model, np.linspace(1e-6, 0.1, 300))
    course = course_of(curve, model)
    assert 50 <= len(course.row) <= 70
    assert curve.points.index(curve.peak) in course.row and course.row[-1] == 300
    assert course.n_bodies.tolist() == [1] * len(course.row)


def test_blocks_may_be_taken_one_by_one_and_say_so():
    model = stack(5)
    capacity = capacity_of(turning(model, ANGLES), model, grouping="blocks")
    assert capacity.participating_mass_ratio == pytest.approx(75 / 99, rel=1e-10)
    assert any("overstates" in note for note in capacity.notes)
    with pytest.raises(AssessmentError, match="grouping"):
        capacity_of(turning(model, ANGLES), model, grouping="storeys")


def test_readings_side_by_side():
    model = stack(3)
    found = reduced(turning(model, ANGLES), model, grouping="blocks", course=False)
    shear, energy, literal = (
        found.capacities[name] for name in ("base_shear", "energy", "literal_ec8")
    )
    e = shear.participating_mass_ratio
    assert energy.activation_acceleration == pytest.approx(e * shear.activation_acceleration)
    assert literal.spectral_collapse_displacement == shear.collapse_displacement


class TestEnvelope:
    def test_a_drop_at_one_displacement_keeps_what_was_borne_before(self):
        """As where a tie breaks: the point before it and the one after it are at one place."""
        rows = [(0.0, 0.0), (0.01, 0.6), (0.05, 0.5), (0.05, 0.1), (0.06, 0.09)]
        found = static_envelope(curve_of([point_at(k, *row) for k, row in enumerate(rows)]))
        assert found.load_multiplier.tolist() == [0.0, 0.6, 0.5, 0.1, 0.09]
        assert np.diff(found.control_displacement).min() == pytest.approx(6e-11, rel=1e-3)
        assert found.control_displacement[-2] == 0.05

    def test_what_the_load_holds_back_for_a_moment_has_not_collapsed(self):
        """A wall beyond its balance whose tie breaks, and which leans on the next one at once: the
        run goes on there, and so does the envelope.  At the end such points are the collapse."""
        rows = [(0.0, 0.0), (0.01, 0.6), (0.05, 0.5), (0.05, -0.1), (0.051, -0.02), (0.052, 0.3)]
        points = [point_at(k, *row) for k, row in enumerate(rows)]
        on = static_envelope(curve_of([*points, point_at(6, 0.1, 0.2)]))
        assert on.load_multiplier.tolist() == [0.0, 0.6, 0.5, 0.3, 0.2]
        assert on.collapse_displacement is None
        assert any("2 points of the curve within jumps were dropped" in note for note in on.notes)
        off = static_envelope(curve_of(points[:-1]))
        assert off.collapse_displacement == pytest.approx(0.05, rel=1e-8)

    def test_no_line_is_extended_over_a_tie_that_breaks(self):
        """The last branch is that of the structure without it, however short."""
        rows = [(0.0, 0.0), (0.01, 0.6), (0.0998, 0.5), (0.1, 0.05), (0.101, 0.0495)]
        points = [point_at(k, *row) for k, row in enumerate(rows)]
        broken = Event(
            kind=EventKind.TIE_BROKEN,
            step=2,
            control_displacement=0.0998,
            load_multiplier=0.5,
            ties=("rod",),
        )
        found = static_envelope(replace(curve_of(points), events=(broken,)))
        assert found.collapse_displacement == pytest.approx(0.2)
        short = static_envelope(replace(curve_of(points[:-1]), events=(broken,)))
        assert short.collapse_displacement is None

    def test_dynamic_points_are_dropped(self):
        rows = [(0.0, 0.0), (0.1, 0.5), (0.2, 9.0), (0.3, 0.2), (0.4, 0.01)]
        points = [
            point_at(k, d, x, status="dynamic" if x == 9.0 else "static")
            for k, (d, x) in enumerate(rows)
        ]
        found = static_envelope(curve_of(points))
        assert found.control_displacement.tolist() == [0.0, 0.1, 0.3, 0.4]
        assert any("jumps were dropped" in note for note in found.notes)

    def test_where_the_curve_turns_back_the_lower_branch_counts(self):
        rows = [(0.0, 0.0), (0.1, 0.5), (0.3, 0.4), (0.2, 0.2), (0.4, 0.01)]
        found = static_envelope(curve_of([point_at(k, *row) for k, row in enumerate(rows)]))
        at = dict(zip(found.control_displacement, found.load_multiplier, strict=True))
        assert (np.diff(found.control_displacement) > 0.0).all()
        assert at[0.2] == 0.2 and at[0.3] == pytest.approx(0.2 - 0.19 / 2)
        assert any("reverses its motion" in note for note in found.notes)

    @given(st.lists(st.tuples(st.floats(-0.05, 0.1), st.floats(0.0, 1.0)), min_size=3, max_size=30))
    @settings(max_examples=60, deadline=None)
    def test_the_envelope_lies_below_every_point_of_the_path(self, moves):
        d = np.cumsum([0.0, 0.1, *(step for step, _ in moves)])
        d = np.abs(d)
        x = np.array([0.0, 1.5, *(value for _, value in moves)])
        points = [point_at(k, a, b) for k, (a, b) in enumerate(zip(d, x, strict=True))]
        found = static_envelope(curve_of(points))
        grown, least = found.control_displacement, found.load_multiplier
        assert (np.diff(grown) > 0.0).all()
        assert (np.interp(d, grown, least) <= x + 1e-12).all()

    def test_the_collapse_is_extrapolated_and_said_so(self):
        rows = [(0.0, 0.0), (0.0001, 0.5), (0.2, 0.25), (0.39, 0.0125), (0.392, 0.01)]
        found = static_envelope(curve_of([point_at(k, *row) for k, row in enumerate(rows)]))
        assert found.collapse_displacement == pytest.approx(0.4)  # all on 0.5 (1 - d/0.4)
        assert found.collapse_extrapolated
        assert "extrapolation" in found.collapse_note

    def test_a_crossing_of_zero_is_no_extrapolation(self):
        rows = [(0.0, 0.0), (0.0001, 0.5), (0.39, 0.0125), (0.41, -0.0125)]
        found = static_envelope(curve_of([point_at(k, *row) for k, row in enumerate(rows)]))
        assert found.collapse_displacement == pytest.approx(0.4) and not found.collapse_extrapolated

    def test_a_fall_from_a_state_at_rest_is_the_collapse(self):
        rows = [(0.0, 0.0), (0.001, 0.5), (0.2, 0.3)]
        points = [point_at(k, *row) for k, row in enumerate(rows)]
        points.append(point_at(3, 0.21, 0.4, status="dynamic"))
        found = static_envelope(curve_of(points))
        assert found.collapse_displacement == 0.2 and not found.collapse_extrapolated
        assert "falls" in found.collapse_note

    def test_a_curve_that_stops_halfway_has_none(self):
        rows = [(0.0, 0.0), (0.001, 0.5), (0.2, 0.3)]
        curve = replace(
            curve_of([point_at(k, *row) for k, row in enumerate(rows)]), status="stopped"
        )
        assert static_envelope(curve).collapse_displacement is None


def test_what_a_curve_must_have_for_a_mechanism():
    model = stack(2)
    curve = turning(model, ANGLES)
    with pytest.raises(AssessmentError, match="keep_poses"):
        reduced(replace(curve, poses=None), model)
    rising = replace(curve, points=curve.points[:2], poses=curve.poses[:2], status="interrupted")
    with pytest.raises(AssessmentError, match="not passed its peak"):
        reduced(rising, model)


def test_a_mechanism_that_turns_about_the_vertical_is_flagged():
    model = ds.extruded(stack(1))
    assembly = model.assembly
    flat = turning(stack(1), ANGLES)
    poses = np.zeros((len(flat.points), 2, 7))
    poses[:, :, 3] = 1.0
    for k, angle in enumerate(np.linspace(0.0, 0.1, len(flat.points))):
        c, s = np.cos(angle), np.sin(angle)
        arm = assembly.centroid[1] - np.array([WIDTH, 0.0, 0.0])
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ arm
        poses[k, 1, :3] = turned - arm
        poses[k, 1, 3:] = np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)
    moves = [model.control_point.displacement(assembly, pose) for pose in poses]
    if moves[-1] < 0.0:
        moves = [-m for m in moves]
    points = [
        replace(point, control_displacement=d) for point, d in zip(flat.points, moves, strict=True)
    ]
    found = initial_shape(curve_of(points, poses), model)
    assert found.twists


class TestOneBody:
    """What one rigid body bears ends where its weight stands above its axis: no extrapolation."""

    @pytest.mark.parametrize("n", [1, 3])
    @pytest.mark.parametrize("to", [0.5, 0.95])
    def test_the_place_is_that_of_its_geometry(self, n, to):
        curve, model = turning(stack(n), np.linspace(1e-4, to * ALPHA, 40)), stack(n)
        # The control point is the far upper corner: it turns by alpha about the toe under it.
        assert stands_on_its_axis(curve, model) == pytest.approx(HEIGHT * np.sin(ALPHA), rel=1e-9)

    def test_its_collapse_is_no_extrapolation_and_the_note_says_why(self):
        curve, model = turning(stack(2), ANGLES), stack(2)
        found = reduced(curve, model, course=False)
        capacity = found.capacities["base_shear"]
        assert not capacity.collapse_extrapolated
        assert any("straight line to 0.4961 m" in note for note in capacity.notes)
        assert not any("extrapol" in note for note in capacity.notes)
        assert static_envelope(curve).collapse_extrapolated  # of the points alone it is

    def test_a_curve_that_ends_elsewhere_is_extrapolated(self):
        model = stack(1)
        curve = turning(model, ANGLES[ANGLES < 0.9 * ALPHA])
        less = [replace(p, load_multiplier=p.load_multiplier - 0.004) for p in curve.points]
        less[0] = curve.points[0]
        found = reduced(replace(curve, points=tuple(less)), model, course=False)
        assert found.capacities["base_shear"].collapse_extrapolated

    def test_ties_bear_without_a_load(self):
        model = stack(1)
        ends = ds.TieEnd(point=[0.5, 3.0], block="c0"), ds.TieEnd(point=[0.5, 6.0])
        tie = ds.spring(start=ends[0], end=ends[1], stiffness=1e3)
        held = replace(model, ties=(tie,))
        assert stands_on_its_axis(turning(model, ANGLES), held) is None

    def test_in_space_whatever_the_direction(self):
        """A block 0.4 x 0.8 x 2.0 m about an edge of its foot, by angles that are not small."""
        for direction, reach in (([1.0, 0.0, 0.0], 0.4), ([0.0, -1.0, 0.0], 0.8)):
            model = model_of(
                [box("base", (-1, -1, -0.2), (2, 2, 0), support=True),
                 box("b", (0, 0, 0), (0.4, 0.8, 2.0))],
                joint(0.7), push=direction,
            )  # fmt: skip
            s = np.array(direction)
            toe = np.array([0.4, 0.4, 0.0]) if reach == 0.4 else np.array([0.2, 0.0, 0.0])
            axis = np.cross([0.0, 0.0, 1.0], s)
            alpha = np.arctan(reach / 2.0)
            angles = np.linspace(1e-4, 0.9 * alpha, 30)
            poses = np.zeros((len(angles) + 1, 2, 7))
            poses[:, :, 3] = 1.0
            points = [point_at(0, 0.0, 0.0)]
            for k, angle in enumerate(angles, start=1):
                turn = Rotation.from_rotvec(angle * axis)
                centre = model.assembly.centroid[1]
                poses[k, 1, :3] = turn.apply(centre - toe) + toe - centre
                x, y, z, w = turn.as_quat()
                poses[k, 1, 3:] = w, x, y, z
                d = model.control_point.displacement(model.assembly, poses[k])
                points.append(point_at(k, d, float(np.tan(alpha - angle))))
            place = stands_on_its_axis(curve_of(points, poses), model)
            lever = model.control_point.point - toe
            end = Rotation.from_rotvec(alpha * axis).apply(lever) - lever
            assert place == pytest.approx(float(end @ s), rel=1e-9)


class TestOrientation:
    """In the plane of its walls, or out of it."""

    def share(self, blocks, direction, velocities):
        model = model_of(blocks, joint(0.7), push=direction)
        assembly = model.assembly
        velocity = np.zeros((assembly.n_bodies, 3))
        velocity[1:] = velocities
        shape = SimpleNamespace(
            labels=np.where(assembly.fixed, AT_REST, 0),
            mass=np.where(assembly.fixed, 0.0, assembly.mass[:, 0]),
            field=SimpleNamespace(velocity=velocity),
        )
        return share_out_of_plane(assembly, shape, np.array(direction))

    def wall(self, direction):
        """Of 3.0 x 0.5 x 2.0 m in four blocks of two courses."""
        blocks = [box("base", (-1, -1, -0.2), (4, 2, 0), support=True)]
        for course in range(2):
            for column in range(2):
                low = (1.5 * column, 0.0, float(course))
                high = (1.5 * (column + 1), 0.5, course + 1.0)
                blocks.append(box(f"{course}{column}", low, high))
        return self.share(blocks, direction, direction)

    def test_a_wall_along_itself_and_across(self):
        assert self.wall([1.0, 0.0, 0.0]) == 0.0
        assert self.wall([0.0, 1.0, 0.0]) == 1.0

    def test_a_facade_that_takes_parts_of_its_returns_along(self):
        """6 m of façade 0.5 m thick, and of two returns 2 m that turn with it."""
        base = box("base", (-1, -1, -0.2), (7, 7, 0), support=True)
        front = box("front", (0, 0, 0), (6, 0.5, 4))
        sides = [box("l", (0, 0.5, 2), (0.5, 2.5, 4)), box("r", (5.5, 0.5, 2), (6, 2.5, 4))]
        found = self.share([base, front, *sides], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0])
        assert found == pytest.approx(12.0 / (12.0 + 4.0))

    def test_walls_of_a_building_count_each_for_itself(self):
        """The same four walls as a box that goes along the shorter side of its plan: the two that
        lie along the load are in their plane, though the plan is longer across."""
        base = box("base", (-1, -1, -0.2), (9, 7, 0), support=True)
        across = [box("w", (0, 0, 0), (0.5, 8, 3)), box("e", (5.5, 0, 0), (6, 8, 3))]
        along = [box("s", (0.5, 0, 0), (5.5, 0.5, 3)), box("n", (0.5, 7.5, 0), (5.5, 8, 3))]
        found = self.share([base, *across, *along], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0])
        assert found == pytest.approx(8.0 / (8.0 + 5.0))

    def test_in_the_plane_the_thickness_tells(self):
        assert reduced(turning(stack(3), ANGLES), stack(3)).as_dict()["out_of_plane"] == 1.0
        wide = replace(stack(3), assembly=replace(stack(3).assembly, thickness=0.2))
        assert reduced(turning(wide, ANGLES), wide).as_dict()["out_of_plane"] == 0.0


class TestSliding:
    """What of the load's work friction takes: nothing of a block that rocks, all of one that
    slides, but for what it tips over the rim with in the end."""

    @pytest.mark.parametrize("direction", [1.0, -1.0])
    @pytest.mark.parametrize(("friction", "least", "most"), [(0.7, -0.01, 0.01), (0.1, 0.95, 1.01)])
    def test_a_block_that_rocks_or_slides(self, friction, direction, least, most):
        blocks = [
            box("base", (-1, -1, -0.2), (2, 2, 0), support=True),
            box("block", (0, 0, 0), (0.3, 0.5, 1.0)),
        ]
        model = model_of(blocks, joint(friction, 1e10), push=[direction, 0.0, 0.0])
        found = reduced(ds.pushover(model, engine="equilibrium"), model)
        assert least <= found.as_dict()["friction"] <= most

    def test_a_load_above_the_centroid_does_its_work_there(self):
        """A force at the top of a block that rocks, and a weight on it that sinks as it leans."""
        blocks = [
            box("base", (-1, -1, -0.2), (2, 2, 0), support=True),
            box("block", (0, 0, 0), (0.3, 0.5, 1.0)),
        ]
        model = model_of(blocks, joint(0.9, 1e10), push=[1.0, 0.0, 0.0])
        top = (0.15, 0.25, 1.0)
        push = ds.PointForce(block="block", point=top, force=np.array([100.0, 0.0, 0.0]))
        on_it = ds.ForceLoad(
            block="block", point=top, force=np.array([0.0, 0.0, -1500.0]), mass=False
        )
        model = replace(model, load=ds.ForcesPattern(entries=(push,)), dead_loads=(on_it,))
        found = reduced(ds.pushover(model, engine="equilibrium"), model)
        assert found.as_dict()["friction"] == pytest.approx(0.0, abs=0.02)
