"""Pictures of structures in space: what is seen, by rays without a depth buffer; what is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import spaced
import synthetic
from matplotlib.collections import LineCollection
from matplotlib.image import imread

import solids
from drystone.geometry.motion import moved_points
from drystone.model.assembly import Assembly
from drystone.report import canvas, draw_mechanism, plot_mechanism, plot_model
from drystone.report.camera import Camera
from drystone.report.joints import Joints
from drystone.report.mechanism import Drawn, Mechanism, readable_magnification
from drystone.report.mechanism_figure import plot_mechanism as plot_on
from drystone.report.raster import NOTHING, Frame, look, reduced
from drystone.report.solid_joints import SolidJoints
from drystone.results.shapes import MovingShapes


def wall(displacement: float) -> tuple[Mechanism, Mechanism]:
    """The made-up wall in the plane and in space."""
    plane, model = spaced.wall_model()
    flat = synthetic.pose_at(plane, displacement)
    pair = ((plane, flat), (model, spaced.pose_of(flat)))
    first, second = (
        Mechanism(
            assembly=m.assembly,
            pose=pose,
            load_direction=m.load.direction,
            control_point=m.control_point,
        )
        for m, pose in pair
    )
    return first, second


def labels(axes) -> set[str]:
    return set(axes.get_legend_handles_labels()[1])


# the camera


@pytest.mark.parametrize("sides", [(2.0, 0.2, 1.4), (0.2, 2.0, 1.4), (1.0, 1.0, 3.0)])
@pytest.mark.parametrize("angle", [0.0, 37.0, 90.0, 200.0, 270.0])
def test_load_pushes_to_the_right_and_nearer_seen_from_above(sides, angle):
    load = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
    camera = Camera.before(np.array(sides), load)
    axes = np.column_stack((camera.right, camera.up, camera.towards))
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    right, _, nearer = camera.seen(load)
    # Turned by 34 to 68 degrees: their sine, and the cosine over the camera's height of 24.
    assert 0.55 < right < 0.93 and 0.34 < nearer < 0.76
    assert camera.seen(np.array([0.0, 0.0, 1.0]))[0] == pytest.approx(0.0, abs=1e-15)
    assert camera.seen(np.array([0.0, 0.0, 1.0]))[1] > 0.9


def test_a_vertical_load_is_seen_from_before_the_long_side():
    for load in (None, np.array([0.0, 0.0, -1.0])):
        assert Camera.before(np.array([2.0, 0.2, 1.0]), load).towards[1] < -0.5
        assert Camera.before(np.array([0.2, 2.0, 1.0]), load).towards[0] > 0.5


# hidden surfaces


def first_hit(assembly: Assembly, vertices: np.ndarray, place: np.ndarray) -> int:
    """Block that a ray along -z in the camera's axes meets first at ``place`` (2,), or -1.

    Inside a convex part all outward distances are negative: of each part the ray's stretch is
    what its faces leave, and the nearest one's beginning counts.
    """
    solids_, best, found = assembly.polyhedra, -np.inf, NOTHING
    for p in range(len(solids_.body)):
        high, low = np.inf, -np.inf
        for f in range(solids_.part_faces[p], solids_.part_faces[p + 1]):
            own = vertices[solids_.rows[solids_.face_offset[f] : solids_.face_offset[f + 1]]]
            normal = np.cross(own[1] - own[0], own[2] - own[0])
            rest = normal @ own[0] - normal[:2] @ place
            if normal[2] > 1e-12:
                high = min(high, rest / normal[2])
            elif normal[2] < -1e-12:
                low = max(low, rest / normal[2])
            elif rest < 0.0:
                high = -np.inf
        if high > low and high > best:
            best, found = high, int(solids_.body[p])
    return found


def heap(seed: int, n: int = 12) -> Assembly:
    """Boxes turned at random, near each other and into each other."""
    random = np.random.default_rng(seed)
    blocks = []
    for i in range(n):
        block = solids.box(f"b{i}", -0.5 * random.uniform(0.2, 1.0, 3), random.uniform(0.1, 0.5, 3))
        pose = np.append(random.uniform(-0.6, 0.6, 3), random.normal(size=4))[None]
        pose[0, 3:] /= np.linalg.norm(pose[0, 3:])
        owner, origin = np.zeros(8, np.int64), np.zeros((1, 3))
        blocks.append(block.with_vertices(moved_points(block.vertices, owner, origin, pose)))
    return Assembly.build(blocks, joint=solids.joint(0.6))


@pytest.mark.parametrize("seed", range(2))
def test_every_pixel_shows_what_a_ray_meets_first(seed):
    """Also where boxes overlap.  At the rim of a face a pixel may go either way by rounding: as
    random boxes have theirs nowhere near a pixel's centre, none does."""
    assembly = heap(seed)
    packed = assembly.polyhedra
    camera = Camera.before(np.ones(3), np.array([0.3, -1.0, 0.0]))
    places = camera.seen(packed.vertices)
    frame = Frame(low=np.array([-1.3, -1.3]), pixel=2.6 / 25, shape=(25, 25))
    faces = np.arange(len(packed.face_offset) - 1)
    seen = look(places, packed.rows, packed.face_offset, frame, faces)
    body = np.append(np.repeat(packed.body, np.diff(packed.part_faces)), NOTHING)[seen.face]
    expected = [
        [first_hit(assembly, places, frame.low + (np.array([j, i]) + 0.5) * frame.pixel)
         for j in range(25)]
        for i in range(25)
    ]  # fmt: skip
    np.testing.assert_array_equal(body, expected)
    assert len(set(body.ravel().tolist())) > 5  # several are seen, and the paper


def test_points_before_and_behind_a_wall():
    """One face, a unit square at nearness 1, seen straight on."""
    square = np.array([[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    frame = Frame(low=np.array([-0.5, -0.5]), pixel=0.02, shape=(100, 100))
    rows, offset = np.arange(4), np.array([0, 4])
    seen = look(square, rows, offset, frame, np.array([0]))
    assert np.count_nonzero(seen.face == 0) == 50 * 50
    points = np.array(
        [[0.5, 0.5, 1.1], [0.5, 0.5, 0.9], [1.2, 0.5, 0.0], [0.5, 0.0, 0.5], [9.0, 9.0, 9.0]]
    )
    # Before it, behind it, beside it, behind its rim (which counts as seen), out of the picture.
    assert seen.before(points, 0.01).tolist() == [True, False, True, True, False]
    backwards = look(square[::-1], rows, offset, frame, np.array([0]))
    assert np.all(backwards.face == NOTHING)


def test_smaller_pictures_are_means():
    picture = np.random.default_rng(3).random((6, 4, 3)).astype(np.float32)
    small = reduced(picture, 2)
    assert small.shape == (3, 2, 3)
    # Of four single-precision numbers below 1.
    np.testing.assert_allclose(small[1, 1], picture[2:4, 2:4].mean(axis=(0, 1)), atol=1e-6)


# joints and motion


def test_joints_open_as_in_the_plane():
    flat, space = wall(0.1)
    plane, solid = Joints.of(flat.assembly), SolidJoints.of(space.assembly)
    for since in (False, True):
        states = [wall(0.05)[k].pose if since else None for k in (0, 1)]
        opening, slip = plane.opening_and_slip(flat.pose, states[0])
        found, slid = solid.opening_and_slip(space.pose, states[1])
        order = np.lexsort((plane.designed.block_b, plane.designed.block_a))
        other = np.lexsort((solid.designed.block_b, solid.designed.block_a))
        # Differences of coordinates of the order of 1 m.
        np.testing.assert_allclose(found[other], opening[order], rtol=0, atol=1e-14)
        np.testing.assert_allclose(slid[other], slip[order], rtol=0, atol=1e-14)


def test_rates_open_joints_by_their_first_order():
    """A block that turns about an edge at 0.2: its joint of 0.4 m opens by 0.08, linearly."""
    model = solids.one_block()
    rates = model.assembly.no_motion()
    pivot, spin = np.array([0.4, 0.3, 0.0]), np.array([0.0, 0.2, 0.0])
    rates[1, :3] = np.cross(spin, model.assembly.centroid[1] - pivot)
    rates[1, 3:] = spin
    joints = SolidJoints.of(model.assembly, linear=True)
    opening, slip = joints.opening_and_slip(rates)
    assert opening == pytest.approx([0.08], abs=1e-15)
    assert slip == pytest.approx([0.0], abs=1e-15)


def test_magnified_blocks_stay_rigid():
    """Displacements grow by the factor, rotations too, and edges keep their lengths."""
    _, space = wall(1e-3)
    drawn = Drawn.of(replace(space, magnification=50.0))
    assembly, shapes = space.assembly, drawn.shapes
    np.testing.assert_allclose(drawn.pose[:, :3], 50.0 * space.pose[:, :3], rtol=1e-12)
    once, often = (assembly.difference(p, assembly.design_pose()) for p in (space.pose, drawn.pose))
    np.testing.assert_allclose(often[:, 3:], 50.0 * once[:, 3:], atol=1e-14)
    moved = shapes.split(shapes.moved(drawn.pose))
    for before, after in zip(shapes.split(shapes.vertices), moved, strict=True):
        assert np.ptp(np.linalg.norm(after - after.mean(axis=0), axis=1)) < 1e-14
        np.testing.assert_allclose(
            np.linalg.norm(np.diff(after, axis=0), axis=1),
            np.linalg.norm(np.diff(before, axis=0), axis=1),
            atol=1e-14,
        )


def test_displacements_are_those_of_the_plane():
    flat, space = wall(0.1)
    plane, solid = MovingShapes.of(flat.assembly), MovingShapes.of(space.assembly)
    np.testing.assert_allclose(
        solid.displacement(space.pose), plane.displacement(flat.pose), rtol=0, atol=1e-15
    )
    small_flat, small = wall(1e-3)
    assert readable_magnification(small.assembly, small.pose) == readable_magnification(
        small_flat.assembly, small_flat.pose
    )


# the picture


def test_legend_is_that_of_the_plane():
    flat, space = wall(0.1)
    axes = [canvas.new_figure(4, 4).subplots() for _ in range(2)]
    for one, mechanism in zip(axes, (flat, space), strict=True):
        plot_on(one, mechanism)
    assert labels(axes[0]) == labels(axes[1]) >= {"open joint", "moving", "support", "as designed"}
    assert not axes[1].axison and axes[1].get_aspect() == 1.0


def test_slid_joints_are_drawn_where_they_are_seen():
    _, space = wall(0.0)
    pose = space.assembly.design_pose()
    pose[4:, 0] = 0.05  # the upper courses slide as one
    axes = canvas.new_figure(4, 4).subplots()
    plot_on(axes, replace(space, pose=pose))
    assert "slid joint" in labels(axes) and "open joint" not in labels(axes)
    (slid,) = [c for c in axes.collections if isinstance(c, LineCollection)]
    ends = np.concatenate(slid.get_segments())
    # On the lines of the bed joint at 0.175 m around the wall: x from 0 to 1.05, y 0 and 1.
    camera = Camera.before(np.array([1.0, 1.0, 0.7]), space.load_direction)
    low = camera.seen(np.array([[x, y, 0.175] for x in (0.0, 1.05) for y in (0.0, 1.0)]))[:, :2]
    assert np.all(ends >= low.min(axis=0) - 0.01) and np.all(ends <= low.max(axis=0) + 0.01)


@pytest.mark.parametrize(
    "direction", [(1, 0, 0), (0, -1, 0), (0, 0, 1), (0.6, 0, -0.8), (-0.6, 0.8, 0)]
)
def test_arrow_of_the_load_is_in_the_picture(direction):
    _, space = wall(0.1)
    along = np.array(direction, float)
    axes = canvas.new_figure(4, 4).subplots()
    plot_on(axes, replace(space, load_direction=along))
    arrows = [t for t in axes.texts if getattr(t, "arrow_patch", None) and t.get_text() == ""]
    load = max(arrows, key=lambda t: np.linalg.norm(np.array(t.xy) - t.get_position()))
    camera = Camera.before(np.array([1.0, 1.0, 0.7]), along)
    way = np.array(load.xy) - np.array(load.get_position())
    np.testing.assert_allclose(way, 0.24 * camera.seen(along)[:2], atol=1e-12)
    for end in (load.xy, load.get_position()):
        assert axes.get_xlim()[0] <= end[0] <= axes.get_xlim()[1]
        assert axes.get_ylim()[0] <= end[1] <= axes.get_ylim()[1]


def test_scale_is_said():
    _, space = wall(0.1)
    axes = canvas.new_figure(4, 4).subplots()
    plot_on(axes, space)
    texts = {text.get_text() for text in axes.texts}
    assert {"x", "y", "z", "0.1 m each"} <= texts  # of 0.16 m, a sixth of the longest side, 1 m


@pytest.mark.parametrize("linear", [False, True])
def test_pictures_are_written(tmp_path, linear):
    _, space = wall(0.1)
    if linear:
        rates = space.assembly.no_motion()
        rates[4:, 0], rates[4:, 4] = 0.1, 0.1
        space = replace(space, pose=rates, linear=True)
    departed = np.zeros(13, bool)
    departed[-1] = True
    for name, one in (("all", space), ("departed", replace(space, departed=departed))):
        draw_mechanism(one, tmp_path / f"{name}.png", title="wall")
    pictures = [imread(tmp_path / f"{name}.png")[..., :3] for name in ("all", "departed")]
    assert all(float(picture.std()) > 0.05 for picture in pictures)
    assert pictures[0].shape != pictures[1].shape or np.any(pictures[0] != pictures[1])


def test_colours_say_what_moves():
    """Of the pixels of the picture some have the hue of moving blocks, and at rest none."""
    model = solids.one_block()
    for angle, moving in ((0.0, False), (0.3, True)):
        pose = model.assembly.design_pose()
        pose[1, 3:] = [np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0]
        axes = canvas.new_figure(4, 4).subplots()
        plot_on(axes, Mechanism(assembly=model.assembly, pose=pose))
        picture = np.asarray(axes.images[0].get_array())
        sand = np.mean(picture[..., 0] - picture[..., 2] > 0.1)  # red over blue
        assert (sand > 0.02) == moving  # most of the picture is its base, which is whole
        assert moving or sand == 0.0


def test_plotting_on_axes_of_ones_own():
    _, model = spaced.wall_model()
    axes = canvas.new_figure(4, 4).subplots()
    assert plot_model(model, axes) is axes
    _, space = wall(0.1)
    plot_mechanism(model, space.pose, axes)
    with pytest.raises(ValueError, match=r"\(13, 7\)"):
        plot_mechanism(model, space.pose[:, :3])
