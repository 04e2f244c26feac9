"""Contacts between convex parts in space: points, gaps, areas, exact derivatives, identity.

Overlaps are judged by brute force, and everything by closed forms; random solids of every kind meet
in the verification tests.
"""

from __future__ import annotations

import numpy as np
import pytest

from drystone.common import tolerances
from drystone.contact.contacts import (
    BALL_3,
    FEATURE_A,
    FEATURE_B,
    GAP,
    KIND,
    NONE,
    PLANE_TANGENT_3,
    VERTEX_B,
    Slots,
)
from drystone.contact.measures import left_behind
from drystone.contact.space import overlap
from drystone.contact.space.edges import edge_on_edge
from drystone.contact.space.shapes import place, scene_of
from drystone.contact.space.succession import carried, find_predecessors
from drystone.geometry.broad import candidate_pairs
from drystone.geometry.motion import moved
from touching import (
    BOX,
    ROUNDING,
    Scene,
    box,
    brute_overlap,
    brute_separation,
    flush,
    hull,
    quaternion,
    random_scene,
    rotation,
    used,
)

pytestmark = pytest.mark.kernels


def convex_polygon(rng):
    n = int(rng.integers(3, 9))
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    around = np.column_stack((np.cos(angle), np.sin(angle))) * rng.uniform(0.2, 1.0, 2)
    return around + rng.uniform(-0.7, 0.7, 2)


def mirrored(faces):
    """Of a solid that is mirrored."""
    return tuple(face[::-1] for face in faces)


class TestOverlap:
    @pytest.mark.parametrize("seed", range(60))
    def test_area_and_centroid_equal_brute_force(self, seed):
        rng = np.random.default_rng(seed)
        p, q = convex_polygon(rng), convex_polygon(rng)
        corner, name = np.zeros((2, 40, 2)), np.zeros((2, 40, overlap.N_NAME), np.int64)
        half, count = overlap.clip(q, len(q), p, len(p), 0.0, corner, name)
        area, cx, cy, _ = overlap.measure(corner, half, count)
        wanted, centroid = brute_overlap(p, q)
        assert area == pytest.approx(wanted, abs=ROUNDING)
        if area > 1e-6:  # a centroid is as precise as rounding over the area
            assert (cx, cy) == pytest.approx(centroid, abs=1e-8)

    @pytest.mark.parametrize("points", [4, 9, 16, 25, 81])
    @pytest.mark.parametrize("seed", range(20))
    def test_points_have_the_area_and_its_centre(self, seed, points):
        """Their weights are positive, and a uniform pressure has no moment about the centroid."""
        rng = np.random.default_rng(seed)
        p, q = convex_polygon(rng), convex_polygon(rng)
        area, centroid = brute_overlap(p, q)
        if area < 1e-3:
            q, (area, centroid) = p.copy(), brute_overlap(p, p)
        corner, name = np.zeros((2, 40, 2)), np.zeros((2, 40, overlap.N_NAME), np.int64)
        half, count = overlap.clip(q, len(q), p, len(p), 0.0, corner, name)
        width = overlap.width_of(area, overlap.measure(corner, half, count)[3])
        near, short = tolerances.CLIP * width, tolerances.MERGE * width
        same = tolerances.SUMS * width
        overlap.name_corners(corner, name, half, count, q, len(q), p, len(p), near, same)
        count = overlap.merge_corners(corner, name, half, count, short, near, (0.0, 0.0))
        n = overlap.n_spread(count, points, 200)
        net = {25: 6 * count + 1, 81: 20 * count + 1}
        assert n == {4: count, 9: 2 * count + 1, 16: 4 * count, **net}[points]
        point, mark, weight = np.zeros((200, 2)), np.zeros((200, 4), np.int64), np.zeros(200)
        overlap.spread(corner, name, half, count, *centroid, n, point, mark, weight)
        overlap.scale(point, n, *centroid, area, weight)
        assert weight[:n].min() > 0.0
        assert weight.sum() == pytest.approx(area, rel=1e-12)
        assert weight[:n] @ (point[:n] - centroid) == pytest.approx(0.0, abs=1e-12)

    def test_points_on_a_line_beside_the_centroid_share_the_area(self):
        """No change of weights that is linear in the place leaves them a first moment of zero."""
        point, weight = np.array([[1.0, 0.0], [1.0, 1.0]]), np.array([1.0, 1.0])
        overlap.scale(point, 2, 0.0, 0.0, 3.0, weight)
        assert weight.tolist() == [1.5, 1.5]

    def test_a_short_side_keeps_both_ends_a_little_longer(self):
        """A corner that a rim cuts off: its two ends are one point sooner if they were one before.

        A force at a point that comes and goes with the motion that it makes would find no rest.
        """
        scene = flush()
        turn = quaternion((0.0, 0.0, 0.25 * np.pi))

        def count(cut, before=None):
            """Points where the corner is cut off over the length ``cut``, and what was found."""
            pose = scene.pose.copy()
            pose[1, 0], pose[1, 3:] = 0.5 + 0.5 * cut - np.sqrt(0.5), turn
            found = scene.find(pose, before=before)
            return len(used(found)), found

        cuts, most = np.linspace(0.01, 0.09, 81), tolerances.MERGE
        up, down, found = [], [], None
        for cut in cuts:
            number, found = count(cut, found)
            up.append(number)
        for cut in cuts[::-1]:
            number, found = count(cut, found)
            down.append(number)
        fresh = [count(cut)[0] for cut in cuts]
        assert up == fresh and set(up) == set(down) and np.ptp(up) == 1
        parts, joins = cuts[np.argmax(up)], cuts[::-1][np.argmin(down)]
        assert parts > most * 0.7  # of the width of the overlap, a part of the square
        assert joins == pytest.approx(tolerances.MERGED_AGAIN * parts, abs=3e-3)

    @pytest.mark.parametrize(("tilt", "carries"), [(0.02, 0.0), (-0.02, 0.03)])
    @pytest.mark.parametrize("lower_first", [True, False])
    def test_of_a_short_side_the_end_that_is_nearer_stays(self, tilt, carries, lower_first):
        """A rim, x = 0, cuts off a corner of the upper box, along 0.03 of it: one end is left.

        The side of that box runs nearly along the rim, and rises or goes down along it.
        """
        out, turn = 1.5e-3, 0.05
        lean = rotation((tilt, 0, 0)) @ rotation((0, 0, turn))
        vertices, faces = box((-1, 0, 0), (0, 1, 1))
        both = [
            box((-2, -1, -1), (0, 2, 0)),
            (vertices @ lean.T + (out, 0.0, 0.005 if tilt > 0 else 0.025), faces),
        ]
        scene = Scene(both if lower_first else both[::-1])
        slots = scene.find()
        place = scene.shapes.centroid[0] + slots.arm_a[used(slots)]
        on_rim = np.abs(place[:, 0]) < 2.0 * out
        assert place[on_rim, 1] == pytest.approx([carries], abs=1e-3)

    @pytest.mark.parametrize("turned", [0.0, 3e-4, 0.7])
    def test_gaps_are_continuous_where_a_tilted_block_slides_over_a_rim(self, turned):
        """The lowest edge of the block leaves the face below it, as it is or ``turned`` [rad]."""
        scene, tilt, step = flush(), 0.02, 1e-4
        least, before = [], None
        for out in np.arange(-10, 60) * step:
            pose = scene.pose.copy()
            pose[1, 3:] = quaternion((0.0, tilt, turned))
            corners = scene.vertices(1, pose)[:4]
            pose[1, 0] = 1.0 + out - corners[:, 0].max()
            pose[1, 2] = -corners[:, 2].min()
            before = scene.find(pose, before=before)
            least.append(before.gap[used(before)].min())
        assert np.abs(np.diff(least)).max() < 2.0 * tilt * step

    @pytest.mark.parametrize("lower_first", [True, False])
    def test_a_corner_near_a_vertex_is_where_the_faces_end(self, lower_first):
        """A block that overhangs by less than a thousandth of its width is not carried beyond the
        face below it, nor by a face that ends before its own end."""
        out = 4e-4
        both = [box((0, 0, -1), (1, 1, 0)), box((out, 0, 0), (1 + out, 1, 1))]
        scene = Scene(both if lower_first else both[::-1])
        slots = scene.find()
        place = scene.shapes.centroid[0] + slots.arm_a[used(slots)]
        assert sorted(place[:, 0]) == pytest.approx([out, out, 1.0, 1.0], abs=ROUNDING)

    # Per area and half the side: sum of w r over its integral 0.7652 (mean distance from the
    # centre of a square of half side 1), sum of w r^2 over 2/3, sum of w x^2 over 1/3.
    @pytest.mark.parametrize(
        ("points", "strength", "stiffness", "bending"),
        [(4, 1.85, 3.0, 3.0), (9, 1.12, 1.5, 1.5), (16, 1.09, 1.22, 1.22)],
    )
    def test_stiffness_and_strength_of_a_square(self, points, strength, stiffness, bending):
        """Against a uniform joint, in twist and in bending; closed forms of sums of weights."""
        scene = flush(2.0, 2.0, points=points)
        slots = scene.find()
        k = used(slots)
        assert len(k) == points
        w, arm = slots.size[k] / 4.0, slots.arm_a[k]
        r = np.hypot(arm[:, 0], arm[:, 1])
        mean = (np.sqrt(2) + np.log(1 + np.sqrt(2))) / 3
        assert w @ r / mean == pytest.approx(strength, abs=6e-3)  # digits of the table
        assert w @ r**2 / (2 / 3) == pytest.approx(stiffness, abs=3e-3)
        assert w @ arm[:, 0] ** 2 / (1 / 3) == pytest.approx(bending, abs=3e-3)

    @pytest.mark.parametrize("n", [5, 7])
    def test_a_square_has_a_grid_with_the_weights_of_the_trapezium_rule(self, n):
        scene = flush(2.0, 2.0, points=n * n)
        slots = scene.find()
        k = used(slots)
        rule = np.full(n, 2.0 / (n - 1))
        rule[[0, -1]] /= 2.0
        place = np.linspace(-1.0, 1.0, n)
        expected = {
            (round(x, 9), round(y, 9)): v * w
            for x, v in zip(place, rule, strict=True)
            for y, w in zip(place, rule, strict=True)
        }
        arms = slots.arm_a[k, :2]
        found = {
            (round(x, 9) + 0.0, round(y, 9) + 0.0): w
            for (x, y), w in zip(arms, slots.size[k], strict=True)
        }
        assert found == pytest.approx(expected, rel=1e-12)
        assert len({tuple(f) for f in slots.feature[k]}) == n * n


class TestFlush:
    @pytest.mark.parametrize("shift", [(0.0, 0.0), (0.4, 0.0), (0.3, 0.2), (0.999, 0.0)])
    def test_corners_and_areas(self, shift):
        lower, upper = box((0, 0, -1), (1, 1, 0)), box((*shift, 0), (1 + shift[0], 1 + shift[1], 1))
        scene = Scene([lower, upper])
        slots = scene.find()
        k = used(slots)
        wide, deep = 1 - shift[0], 1 - shift[1]
        assert len(k) == 4
        area = max(wide * deep, tolerances.LEAST_AREA)
        assert slots.size[k] == pytest.approx(area / 4, rel=1e-9)
        place = scene.shapes.centroid[0] + slots.arm_a[k]
        corners = {tuple(x) for x in np.round(place, 9) + 0.0}
        assert corners == {(x, y, 0) for x in (shift[0], 1) for y in (shift[1], 1)}
        assert slots.normal[k] == pytest.approx(np.tile([0, 0, 1], (4, 1)), abs=1e-15)
        assert slots.gap[k] == pytest.approx(0.0, abs=1e-15)

    @pytest.mark.parametrize("shift", [(0.0, 0.0), (0.5, 0.0), (0.0, 0.25), (0.31, 0.27)])
    def test_noise_changes_no_feature(self, shift):
        """A resting pile keeps its contacts, whatever rounding and sinking do to its blocks."""
        solids = [
            box((i * shift[0], i * shift[1], i), (1 + i * shift[0], 1 + i * shift[1], i + 1))
            for i in range(4)
        ]
        scene = Scene(solids)
        first = scene.find()
        assert len(used(first)) == 12
        rng = np.random.default_rng(0)
        before = first
        for _ in range(50):
            pose = moved(scene.pose, 1e-9 * rng.normal(size=(4, 6)), scene.axes)
            slots = scene.find(pose, before=before)
            assert np.array_equal(used(slots), used(first))
            assert np.array_equal(slots.which[used(slots)], first.which[used(first)])
            assert slots.size[used(slots)] == pytest.approx(first.size[used(first)], abs=1e-7)
            before = slots

    def test_unused_slots_keep_nothing_of_other_poses(self):
        """Whoever finds again into the same slots may have set what was used, and not the rest."""
        scene = flush()
        pose = scene.pose.copy()
        pose[1, 2] = -0.02
        slots = scene.find(pose)
        assert slots.gap[used(slots)] == pytest.approx(-0.02, abs=ROUNDING)
        slots.which[:, KIND] = NONE
        apart = scene.find(scene.pose + (0, 0, 1, 0, 0, 0, 0) * np.array([[0], [1]]), before=slots)
        assert len(used(apart)) == 0
        assert np.all(apart.value[:, GAP] == np.inf)

    @pytest.mark.parametrize("points", [4, 9, 16])
    def test_a_face_inside_another(self, points):
        plate, block = box((-2, -2, -1), (2, 2, 0)), box((0, 0, 0), (0.5, 0.25, 1))
        for solids in ([plate, block], [block, plate]):
            scene = Scene(solids, points=points)
            slots = scene.find()
            k = used(slots)
            assert len(k) == points
            assert slots.size[k].sum() == pytest.approx(0.125, rel=1e-12)
            assert slots.gap[k] == pytest.approx(0.0, abs=1e-15)

    @pytest.mark.parametrize("turn", [0.001, 0.05, 0.3, np.pi / 4])
    def test_a_twisted_pile(self, turn):
        """The overlap of two equal squares is that of brute force, with 4 to 8 points."""
        scene = flush()
        pose = scene.pose.copy()
        pose[1, 3:] = quaternion((0, 0, turn))
        slots = scene.find(pose)
        square = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
        area, _ = brute_overlap(square, square @ rotation((0, 0, turn))[:2, :2].T)
        k = used(slots)
        assert 4 <= len(k) <= 8
        assert slots.size[k].sum() == pytest.approx(area, rel=1e-9)
        assert slots.size[k] @ slots.arm_a[k] == pytest.approx((0, 0, 0.5 * area), abs=1e-9)

    def test_gaps_are_as_precise_as_displacements_however_far_away(self):
        """A joint closes by a millionth of the rounding of its place, and the gap says so."""
        far = np.array([1e3, -7e2, 3e2])
        scene = Scene(
            [(v + far, f) for v, f in (box((0, 0, -1), (1, 1, 0)), box((0, 0, 0), (1, 1, 1)))]
        )
        before = scene.find()
        down, tilt = 1e-10, 1e-10
        pose = moved(scene.pose, np.array([np.zeros(6), [0, 0, -down, tilt, 0, 0]]), scene.axes)
        after = scene.find(pose)
        k = used(before)
        assert np.array_equal(after.which, before.which)
        change = after.gap[k] - before.gap[k] - (tilt * after.arm_b[k, 1] - down)
        # The second order of the motion, and the spacing of doubles at the designed gap.
        assert np.abs(change).max() < 1e-19 + np.spacing(np.abs(before.gap[k]).max())


class TestTilted:
    @pytest.mark.parametrize("angle", [1e-6, 1e-3, 0.02, 0.1, 0.4])
    @pytest.mark.parametrize("narrow", [False, True])
    def test_a_block_that_rocks_on_an_edge(self, angle, narrow):
        """It touches at two points of the edge; those that open are known, with their gap; the
        normal is that of the face that supports, and the area that of the overlap from above."""
        base = box((-1, -1, -1), (2, 2, 0)) if not narrow else box((0, 0, -1), (1, 1, 0))
        scene = Scene([base, box((0, 0, 0), (1, 1, 1))], reach=0.5)
        pose = scene.pose.copy()
        turn = rotation((0, angle, 0))  # about the edge x = 1, which comes down
        pose[1, 3:] = quaternion((0, angle, 0))
        corner = np.array([0.5, 0.0, -0.5])
        pose[1, :3] = corner - turn @ corner
        slots = scene.find(pose, before=scene.find())
        k = used(slots)
        assert len(k) == 4
        assert np.sort(slots.gap[k]) == pytest.approx(
            [0, 0, np.sin(angle), np.sin(angle)], abs=ROUNDING
        )
        assert slots.normal[k] == pytest.approx(np.tile([0, 0, 1], (4, 1)), abs=ROUNDING)
        assert slots.size[k].sum() == pytest.approx(np.cos(angle), rel=1e-9)

    def test_a_block_on_its_corner(self):
        """A cube on its vertex: one point, upright, with a share of what is seen from above."""
        cube, faces = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
        axis = np.cross([1, 1, 1], [0, 0, 1])
        upright = rotation(axis / np.linalg.norm(axis) * np.arccos(1 / np.sqrt(3)))
        cube = cube @ upright.T
        scene = Scene([box((-2, -2, -1), (2, 2, 0)), (cube - (0, 0, cube[:, 2].min()), faces)])
        slots = scene.find()
        k = used(slots)
        assert len(k) == 1  # the face's other corners are 0.5 m above and more
        assert slots.gap[k] == pytest.approx(0.0, abs=ROUNDING)
        assert slots.normal[k] == pytest.approx(np.array([[0, 0, 1]]), abs=ROUNDING)
        assert slots.kind[k] == VERTEX_B
        assert 0.1 / np.sqrt(3) < slots.size[k[0]] < 0.5 / np.sqrt(3)

    def test_ridges_that_cross(self):
        """Two roofs, ridge on ridge: one point, its normal across both, a least area."""
        roof = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, 0, 1), (1, 0, 1.0)])
        faces = ((0, 3, 2, 1), (0, 1, 5, 4), (2, 3, 4, 5), (1, 2, 5), (3, 0, 4))
        turned = roof @ rotation((np.pi, 0, 0)).T @ rotation((0, 0, np.pi / 3)).T + (0, 0, 1.99)
        scene = Scene([(roof, faces), (turned, faces)])
        slots = scene.find()
        k = used(slots)
        assert len(k) == 1
        assert slots.gap[k] == pytest.approx(-0.01, abs=ROUNDING)
        assert slots.normal[k] == pytest.approx(np.array([[0, 0, 1]]), abs=ROUNDING)
        assert slots.size[k] == pytest.approx(tolerances.LEAST_FACE * 2 * np.sqrt(2), rel=1e-9)

    def test_edges_that_cross_after_a_face_was_tried(self):
        """A box leans against another one's edge.  The edge of one lies nearly on a face of the
        other, which makes no points as far away; the normal is still across both edges."""
        turn = rotation((0, 0, 0.272)) @ rotation((0.631, -0.459, -0.139))
        lower = box((-1, -1, -1), (1, 1, 0))
        vertices, faces = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
        scene = Scene([lower, (vertices @ turn.T + (1.411, 0.172, 0.081), faces)])
        slots = scene.find()
        (k,) = used(slots)
        shapes, n_vertices = scene.shapes, len(scene.shapes.local)
        for feature in slots.which[k, [FEATURE_A, FEATURE_B]]:
            first, last = shapes.local[shapes.edge[feature - n_vertices, :2]]
            assert slots.normal[k] @ (last - first) == pytest.approx(0.0, abs=1e-12)
        wanted, *_ = brute_separation(*scene.solids[0], *scene.solids[1])
        assert slots.gap[k] == pytest.approx(wanted, abs=ROUNDING)

    @pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-4])
    def test_touching_by_less_than_a_face(self, noise):
        """Side along side, corner on corner, end on end: finite values, whatever is found."""
        needle = box((0, 0, 0), (1e-3, 1e-3, 2))
        base = box((-1, -1, -1), (0, 0, 0))
        others = [
            box((0, 0, 0), (1, 1, 1)),
            box((0, -1, 0), (1, 0, 1)),
            box((-0.7, 0, 0), (1, 1, 1)),
            needle,
            (needle[0] - (1e-3, 1e-3, 0), BOX),
            hull(np.array([(0, 0, 0), (1, 0.1, 0.5), (0.2, 1, 0.6), (0.1, 0.3, 1)])),
            hull(np.array([(0, 0, 0), (1e-3, 0, 1), (0, 1e-3, 1), (-1e-3, -1e-3, 1)])),
        ]
        for i, other in enumerate(others):
            for radius in (0.0, 0.01):
                for points in (4, 9, 16):
                    scene = Scene([base, other], points=points, radius=radius)
                    increment = noise * np.random.default_rng(i).normal(size=(2, 6))
                    slots = scene.find(moved(scene.pose, increment, scene.axes))
                    k = used(slots)
                    assert np.isfinite(slots.value[k]).all()
                    assert np.all(slots.size[k] > 0.0)
                    assert np.abs(slots.gap[k]).min(initial=0.0) < 0.03
                    length = np.linalg.norm(slots.normal[k], axis=1)
                    assert length == pytest.approx(1.0, abs=ROUNDING)


class TestTies:
    """Solids that meet in less than a face are separated alike by faces of several directions."""

    BASE = box((-0.4, -0.3, -0.2), (0, 0, 0))
    ROOF = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, 0.3, 1), (1, 0.3, 1.0)])
    ROOF_FACES = ((0, 3, 2, 1), (0, 1, 5, 4), (2, 3, 4, 5), (1, 2, 5), (3, 0, 4))
    #: What touches it in a corner, along an edge, and by an edge on a ridge.
    SCENES = (
        (BASE, box((0, 0, 0), (0.4, 0.2, 0.2))),
        (BASE, box((0, 0, 0), (0.2, 0.2, 0.2))),
        (BASE, box((0, -0.3, 0), (0.4, 0.2, 0.2))),
        (BASE, box((-0.1, 0, 0), (0.4, 0.2, 0.2))),
        ((ROOF, ROOF_FACES), (ROOF * (0.5, 0.4, -1) + (0.0, 0.18, 2.0), mirrored(ROOF_FACES))),
    )

    @pytest.mark.parametrize("solids", SCENES)
    def test_rounding_decides_nothing(self, solids):
        """The same features and areas wherever the solids are, however they are turned, and where
        they have come nearer or moved apart by what rounding does to places."""
        expected, rng = Scene(solids).find(), np.random.default_rng(0)
        assert 1 <= len(used(expected)) <= 2
        for _ in range(20):
            turn, shift = rotation(rng.normal(size=3)), rng.uniform(-3, 3, 3)
            noise = 1e-12 * rng.normal(size=3)
            moved_ = [(v @ turn.T + shift, f) for v, f in solids]
            found = Scene([moved_[0], (moved_[1][0] + noise, moved_[1][1])]).find()
            assert np.array_equal(found.which, expected.which)
            assert found.size == pytest.approx(expected.size, rel=1e-9)

    @pytest.mark.parametrize(
        ("upper", "pairs"),
        [
            # Smaller faces of the pairs along x, y and z [m2].
            (box((0, 0, 0), (0.4, 0.2, 0.1)), (0.2 * 0.1, 0.4 * 0.1, 0.4 * 0.2)),
            (box((0, 0, 0), (0.2, 0.6, 0.3)), (0.3 * 0.2, 0.2 * 0.3, 0.2 * 0.6)),
            # Along an edge there are two.
            (box((0, -0.3, 0), (0.4, 0, 0.1)), (0.3 * 0.1, np.inf, 0.4 * 0.3)),
            (box((-0.4, 0, 0), (0, 0.1, 0.6)), (np.inf, 0.4 * 0.2, 0.4 * 0.1)),
        ],
    )
    def test_what_only_touches_has_the_smallest_interface(self, upper, pairs):
        slots = Scene([self.BASE, upper]).find()
        k = used(slots)
        assert slots.size[k].sum() == pytest.approx(tolerances.LEAST_AREA * min(pairs), rel=1e-9)
        along = np.eye(3)[np.argmin(pairs)]
        assert slots.normal[k] == pytest.approx(np.tile(along, (len(k), 1)), abs=ROUNDING)

    def test_an_incident_face_is_no_matter_of_rounding(self):
        """A cube on its edge has two faces that are opposed alike to what it stands on."""
        cube, faces = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
        upright = cube @ rotation((np.pi / 4, 0, 0)).T + (0, 0, np.sqrt(0.5))
        solids, rng = [box((-1, -1, -1), (1, 1, 0)), (upright, faces)], np.random.default_rng(0)
        expected = Scene(solids).find()
        for _ in range(20):
            turn = rotation(rng.normal(size=3))
            found = Scene([(v @ turn.T, f) for v, f in solids]).find()
            assert np.array_equal(found.which, expected.which)


#: A slab whose lower edge lies on the top of a leaning hexagonal drum, and overlaps it by a sliver:
#: some 13 mm wide as seen from above, and as deep as 2.7 mm.
DRUM = (
    [(0.66955, 0.30805, 0.23452), (0.53721, 0.28538, 0.22258), (0.50685, 0.16782, 0.22239)]
    + [(0.56972, 0.09459, 0.22996), (0.68079, 0.10118, 0.24025), (0.73183, 0.23529, 0.24202)]
    + [(0.63927, 0.30558, 0.47161), (0.52197, 0.28549, 0.46104), (0.49506, 0.18128, 0.46086)]
    + [(0.55078, 0.11638, 0.46757), (0.64923, 0.12222, 0.47670), (0.69447, 0.24108, 0.47826)]
)
SIX_SIDES = (
    ((0, 5, 4, 3, 2, 1), (6, 7, 8, 9, 10, 11), (0, 1, 7, 6), (1, 2, 8, 7), (2, 3, 9, 8))
    + ((3, 4, 10, 9), (4, 5, 11, 10), (5, 0, 6, 11))
)  # fmt: skip
SLAB = (
    [(-0.85174, -0.52874, 0.46183), (0.49067, -0.56301, 0.45980), (0.51424, 0.36037, 0.45987)]
    + [(-0.82817, 0.39464, 0.46190), (-0.85148, -0.52876, 0.63683), (0.49093, -0.56303, 0.63480)]
    + [(0.51451, 0.36035, 0.63487), (-0.82791, 0.39462, 0.63690)]
)


class TestRims:
    @staticmethod
    def sliver():
        return Scene([(np.array(DRUM), SIX_SIDES), (np.array(SLAB), BOX)], points=9)

    def test_a_sliver_is_as_deep_as_edges_say(self):
        """The slab's side separates the two best of all faces, and has points that are as deep."""
        scene = self.sliver()
        deepest, of_drum, of_slab = brute_separation(*scene.solids[0], *scene.solids[1])
        assert max(of_drum, of_slab) < -0.014 < -0.003 < deepest < -0.002
        slots = scene.find()
        k = used(slots)
        # As deep on a plane inclined by EDGE_FLAT to the axis, but for 1 - cos of it.
        assert slots.gap[k].min() == pytest.approx(deepest, rel=2e-3)
        # The drum's top leans by 0.096, and so does the axis by no more than that and EDGE_FLAT.
        assert slots.normal[k, 2].min() > np.cos(0.096 + 0.05)
        # A line across the drum: the slab's edge, x = 0.511 and 0.509, enters and leaves its top at
        # y = 0.1813 + 0.1042 0.0159 / 0.0269 and y = 0.1813 - 0.0649 0.0139 / 0.0557.
        place = scene.shapes.centroid[0] + slots.arm_a[k]
        assert np.ptp(place[:, 1]) == pytest.approx(0.0778, abs=2e-3)  # of the digits of x

    @pytest.mark.parametrize("twist", [0.0, 0.01, 0.03])
    @pytest.mark.parametrize("far", [1.0, 10.0])
    def test_what_tilts_over_a_rim_rests_on_both_ends(self, twist, far):
        """However far the rim goes on beyond the block, and the block be turned about its slope."""
        tilt, sunk = 0.3, 0.005
        vertices, faces = box((-0.5, -0.5, 0), (0.5, 0.5, 0.5))
        lean = rotation((0, tilt, 0)) @ rotation((twist, 0, 0))
        base = box((-2.0, -far, -0.5), (0, far, 0))
        lowest = (vertices[:4] @ lean.T)[:, 2].min()
        # Put on the rim in its middle, where the slope passes, and sunk there.
        slots = (scene := Scene([base, (vertices @ lean.T - (0, 0, sunk), faces)])).find()
        assert lowest < -0.1
        k = used(slots)
        place = scene.shapes.centroid[0] + slots.arm_a[k]
        on_rim = np.abs(place[:, 0]) < 0.02
        assert np.count_nonzero(on_rim) == 2
        assert np.ptp(place[on_rim, 1]) == pytest.approx(1.0, abs=0.02)
        # The normal of the face, and along it as deep as its points are at each end.
        normal = lean @ (0, 0, 1)
        assert slots.normal[k][on_rim] == pytest.approx(np.tile(normal, (2, 1)), abs=1e-12)
        ends = np.sort(slots.gap[k][on_rim])
        across = sunk * np.cos(tilt) * np.cos(twist)
        end = 0.5 * np.sin(twist)
        assert ends == pytest.approx((-across - end, -across + end), abs=0.02 * end + 1e-9)
        assert slots.gap[k].min() == ends[0]


class TestRounded:
    @pytest.mark.parametrize("radius", [0.01, 0.05])
    def test_gaps_are_less_by_both_radii(self, radius):
        for seed in range(5):
            sharp, round_ = (
                random_scene(np.random.default_rng(seed), radius=r) for r in (0, radius)
            )
            a, b = sharp.find(), round_.find()
            k = used(a)
            if len(k) < 3 or not np.array_equal(a.which[k], b.which[k]):
                continue
            # At the surface of the body that has the point.
            v = np.where(a.kind[k] == VERTEX_B, -1.0, 1.0)[:, None]
            surface = a.arm_a[k] + v * radius * a.normal[k]
            # Where sides cross, a point of a side that the other part tilts about is on that part's
            # face: here the faces tilt by less than 2e-3.
            crosses = (a.which[k][:, [FEATURE_A, FEATURE_B]] >= len(sharp.shapes.local)).all(axis=1)
            tilt, apart = 2e-3, np.abs(a.gap[k]).max()
            for which, gaps, places in (
                (~crosses, ROUNDING, ROUNDING),
                (crosses, tilt**2 * apart, tilt * apart),
            ):
                wanted = a.gap[k][which] - 2 * radius
                assert b.gap[k][which] == pytest.approx(wanted, abs=gaps)
                assert b.arm_a[k][which] == pytest.approx(surface[which], abs=places)
            assert b.value[k, BALL_3] == pytest.approx(radius)

    @pytest.mark.parametrize("points", [4, 9])
    @pytest.mark.parametrize("rims", [False, True], ids=["rim on face", "rim on rim"])
    def test_what_tilts_about_a_side_rests_on_all_its_points(self, rims, points):
        """One end of the side is a vertex, the other is where a side of the upper box crosses it.

        The upper face goes on beyond the rim x = 1 that it tilts about, past the foot of that rim
        on it, or less far: then both rims touch.
        """
        radii, tilt, beyond = 0.1, 0.1, 0.002
        turn = rotation((0, tilt, 0))
        vertices, faces = box((-2.0, -0.5, 0.0), (beyond, 1.5, 1.0))
        shift = radii * turn @ (0.0, 0.0, 1.0)
        if rims:  # the upper one out and down by this from where the box turns
            out, down = beyond * np.cos(tilt), beyond * np.sin(tilt)
            shift = np.array([0.0, 0.0, np.sqrt(radii**2 - out**2) + down])
        upper = vertices @ turn.T + (1.0, 0.0, 0.0) + shift
        scene = Scene(
            [box((-1, -1, -1), (1, 1, 0)), (upper, faces)], radius=radii / 2, points=points
        )
        slots = scene.find()
        k = used(slots)
        place = scene.shapes.centroid[0] + slots.arm_a[k]
        on_side = place[:, 0] > 0.9
        assert np.count_nonzero(on_side) == (2 if points == 4 else 3)
        assert np.sort(place[on_side, 1])[[0, -1]] == pytest.approx((-0.5, 1.0), abs=1e-9)
        assert slots.gap[k][on_side] == pytest.approx(0.0, abs=1e-9)

    @pytest.mark.parametrize("turn", [0.0, 1e-5, -1e-5])
    def test_a_corner_past_a_rim_rests_beside_it_whatever_its_turn(self, turn):
        """The upper face ends past a side of the lower one, by less than corners are told apart.

        Seen from the vertex the rim is nearest a little beside the upper face or above it, as the
        box is turned, and there both faces touch.  A normal from the rim to the vertex would be
        tilted, and the gap open by `past` squared over twice the radii.
        """
        radii, past = 0.1, 4e-4
        vertices, faces = box((0.0, -past, radii), (0.8, 0.9, radii + 1.0))
        upper = vertices @ rotation((0.0, 0.0, turn)).T + (-0.4, -1.0, 0.0)
        scene = Scene([box((-1, -1, -1), (1, 1, 0)), (upper, faces)], radius=radii / 2)
        slots = scene.find()
        k = used(slots)
        assert len(k) == 4
        within = past * abs(turn)
        assert slots.gap[k] == pytest.approx(0.0, abs=within**2 / radii + ROUNDING)
        assert slots.normal[k][:, 2] == pytest.approx(1.0, abs=(within / radii) ** 2 + ROUNDING)

    def test_corner_by_corner(self):
        """Balls at two vertices: distance less radii, along the line from one to the other."""
        radius = 0.1
        a, b = box((-1, -1, -1), (0, 0, 0)), box((0.1, 0.05, 0.08), (1, 1, 1))
        slots = Scene([a, b], radius=radius).find()
        k = used(slots)
        between = np.array([0.1, 0.05, 0.08])
        assert len(k) == 1
        assert slots.gap[k] == pytest.approx(np.linalg.norm(between) - 2 * radius, abs=ROUNDING)
        assert slots.normal[k[0]] == pytest.approx(between / np.linalg.norm(between), abs=ROUNDING)


class TestSuccession:
    def test_resting_points_go_on_with_themselves(self):
        scene = flush(points=9)
        slots = scene.find()
        source = np.zeros(len(slots.kind), np.int64)
        find_predecessors(scene.pairs, slots, slots, source)
        own = np.where(slots.kind != NONE, np.arange(len(source)), -1)
        assert np.array_equal(source, own)

    def test_changed_features_go_on_with_the_nearest_point_once(self):
        """A block slides past the corner of its support; a twist makes crossings of vertices."""
        scene = flush()
        before = scene.find()
        pose = scene.pose.copy()
        pose[1, 3:] = quaternion((0, 0, 0.05))
        now = scene.find(pose, before=before)
        source = np.zeros(len(now.kind), np.int64)
        find_predecessors(scene.pairs, before, now, source)
        k = used(now)
        assert not np.array_equal(now.feature[k], before.feature[k])
        assert sorted(source[k][source[k] >= 0]) == used(before).tolist()
        reached = source[k] >= 0
        apart = now.arm_a[k][reached] - before.arm_a[source[k][reached]]
        assert np.linalg.norm(apart, axis=1).max() < 0.05

    def test_forces_keep_their_direction_in_space(self):
        """Between any two frames; what lies in both planes is kept, and the rest is said."""
        rng = np.random.default_rng(0)
        scene = flush()
        before = scene.find()
        pose = scene.pose.copy()
        pose[1, 3:] = quaternion((0, 0, 0.05))
        now = scene.find(pose)
        n = len(now.kind)
        source = np.zeros(n, np.int64)
        find_predecessors(scene.pairs, before, now, source)
        old, new = scene.follow(before, pose), now
        force, after = rng.normal(size=(n, 2)), np.zeros((n, 2))
        source[np.flatnonzero(source >= 0)[0]] = -1
        force[old.kind == 0] = 0.0
        carried(old, new, source, force, after)
        kept_on = np.flatnonzero(source >= 0)
        for i in kept_on:
            was = force[source[i]] @ old.tangents[source[i]]
            assert after[i] @ new.tangents[i] == pytest.approx(was, abs=ROUNDING)
        left = np.setdiff1d(used(old), source[kept_on])
        assert len(left) >= 1
        lost = np.linalg.norm(force[left], axis=1).sum()
        assert left_behind(source, force) == pytest.approx(lost, rel=1e-12)


class TestBroadPhase:
    @pytest.mark.parametrize("seed", range(10))
    def test_equals_brute_force_in_space(self, seed):
        rng = np.random.default_rng(seed)
        lower = rng.uniform(-3, 3, (60, 3)).round(1)
        upper = lower + rng.uniform(0, [2.0, 0.5, 4.0], (60, 3)).round(1)
        meet = np.all(lower[:, None] <= upper, axis=2) & np.all(lower <= upper[:, None], axis=2)
        a, b = candidate_pairs(lower, upper)
        assert np.column_stack((a, b)).tolist() == np.argwhere(np.triu(meet, 1)).tolist()


@pytest.mark.parametrize("across", ["edge", "tangent", "neither"])
def test_tangent_of_edges_whatever_their_normal_lies_along(across):
    # Where corners meet, the normal may lie along an edge of a, which then is no tangent.
    scene = flush()
    shapes, world = scene.shapes, scene.world
    place(shapes, scene.pose, world)
    kernel_scene, edge = scene_of(shapes, scene.pose, world), shapes.edge
    a, b = 0, len(edge) // 2
    along = shapes.local[edge[a, 1]] - shapes.local[edge[a, 0]]
    face = next(f for f in edge[a, 2:4])
    normal = {
        "edge": along / np.linalg.norm(along),
        "tangent": shapes.plane[face, 3:],
        "neither": np.array([0.6, 0.48, 0.64]),
    }[across]
    slots, work = Slots.empty(scene.pairs.n_slots, 3), np.zeros((5, 3))
    work[0], work[1, :2] = normal, 0.5
    edge_on_edge(kernel_scene, work, (0, 1, 0, 4), (a, b), (face, edge[b, 2]), 0.0, *slots)
    tangent = slots.value[0, PLANE_TANGENT_3 : PLANE_TANGENT_3 + 3]
    assert np.linalg.norm(tangent) == pytest.approx(1.0, abs=1e-14)
    assert tangent @ normal == pytest.approx(0.0, abs=1e-14)
