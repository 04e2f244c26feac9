"""Random convex solids in contact, in any way they can: brute force, differences, balance."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.common.tolerances import EDGES_MARGIN
from drystone.contact.contacts import PLACE_3, PLANE_NORMAL_3, POINT_3, VERTEX_B
from drystone.contact.space import separation
from drystone.contact.space.shapes import place
from drystone.geometry.motion import moved
from touching import (
    ROUNDING,
    brute_area,
    brute_separation,
    crossing_edges,
    in_contact,
    planes,
    quaternion,
    random_scene,
    rotation,
    used,
)

#: Parts of the random pairs; all of them take half a minute.
BLOCKS = [0, 1, *(pytest.param(block, marks=pytest.mark.slow) for block in range(2, 6))]


class TestRandomPairs:
    """Convex solids that press on each other, or all but touch, by any of their features."""

    @pytest.mark.parametrize("block", BLOCKS)
    def test_gaps_equal_brute_force(self, block):
        """Each is the distance of its point from its plane, and the smallest that of the solids."""
        seen = set()
        for scene, slots in in_contact(50, 100 * block):
            shapes, value = scene.shapes, slots.value
            for i in used(slots):
                b_is_v = slots.kind[i] == VERTEX_B
                v, f = (1, 0) if b_is_v else (0, 1)
                point = shapes.centroid[v] + value[i, POINT_3 : POINT_3 + 3]
                plane = shapes.centroid[f] + value[i, PLACE_3 : PLACE_3 + 3]
                normal = value[i, PLANE_NORMAL_3 : PLANE_NORMAL_3 + 3]
                assert slots.gap[i] == pytest.approx(normal @ (point - plane), abs=ROUNDING)
                assert shapes.centroid[0] + slots.arm_a[i] == pytest.approx(point, abs=ROUNDING)
                assert shapes.centroid[1] + slots.arm_b[i] == pytest.approx(point, abs=ROUNDING)
                assert slots.normal[i] == pytest.approx(normal if b_is_v else -normal, abs=1e-15)
                for body, at in ((v, point), (f, plane)):
                    normals, offsets = planes(*scene.solids[body])
                    assert (normals @ at - offsets).max() == pytest.approx(0.0, abs=ROUNDING)
            (p, faces_p), (q, faces_q) = scene.solids
            best, *_ = brute_separation(p, faces_p, q, faces_q)
            edges = crossing_edges(scene, slots)
            seen.add(edges)
            # Faces are taken for edges that separate the solids by no more than EDGES_MARGIN more.
            margin = (0.0 if edges else 2.0 * EDGES_MARGIN) * shapes.size.min() + 1e-9
            assert abs(slots.gap[used(slots)].min() - best) <= margin
        assert seen == {True, False}

    @pytest.mark.parametrize("block", BLOCKS)
    def test_areas_add_up_to_the_overlap(self, block):
        for scene, slots in in_contact(30, 1000 + 100 * block, reach=np.inf):
            if not crossing_edges(scene, slots):
                assert slots.size[used(slots)].sum() == pytest.approx(
                    brute_area(scene, slots), rel=1e-9
                )

    @pytest.mark.parametrize("block", range(6))
    @pytest.mark.parametrize("radius", [0.0, 0.02])
    def test_gradients_equal_central_differences(self, block, radius):
        # The error of a central difference is some h^2 + rounding / h.
        h = 1e-5
        for scene, slots in in_contact(5, 2000 + 100 * block, radius=radius):
            rng = np.random.default_rng(block)
            pose = moved(scene.pose, 0.1 * rng.normal(size=(2, 6)), scene.axes)
            now = scene.follow(slots, pose)
            rows, k = scene.rows(now), used(now)
            for column in range(12):
                after = []
                for step in (h, -h):
                    increment = np.zeros((2, 6))
                    increment[column // 6, column % 6] = step
                    after.append(scene.follow(slots, moved(pose, increment, scene.axes)))
                ahead, back = after
                assert (ahead.gap[k] - back.gap[k]) / (2 * h) == pytest.approx(
                    rows[k, 0, column], abs=1e-7
                )
                if radius > 0.0:
                    continue  # a ball rolls: what slides is not what the arm's end does
                # Of a point fixed to v in the frame of f: it slides with the change of its place.
                for i in k:
                    sign = 1.0 if now.kind[i] == VERTEX_B else -1.0
                    arm = "arm_a" if sign > 0 else "arm_b"
                    body = 0 if sign > 0 else 1
                    place = []
                    for there in after:
                        # In f's frame now: the tangents turn with f.
                        axes = np.column_stack((there.tangents[i][0], there.tangents[i][1]))
                        place.append(getattr(there, arm)[i] @ axes)
                    slid = sign * (place[0] - place[1]) / (2 * h)
                    assert slid == pytest.approx(rows[i, 1:, column], abs=1e-7), body

    def test_forces_balance(self):
        """What acts on a acts on b, reversed, in force and in moment about the origin."""
        for scene, slots in in_contact(60, 3000):
            pose = moved(scene.pose, 0.1 * np.ones((2, 6)), scene.axes)
            slots = scene.follow(slots, pose)
            rows = scene.rows(slots)
            centre = scene.shapes.centroid + pose[:, :3]
            for i in used(slots):
                for row in rows[i]:
                    force, moment = row.reshape(2, 2, 3).transpose(1, 0, 2)
                    about = np.einsum("nij,nj->ni", scene.world.axes, moment)
                    total = (np.cross(centre, force) + about).sum(axis=0)
                    assert force.sum(axis=0) == pytest.approx(0.0, abs=ROUNDING)
                    assert total == pytest.approx(0.0, abs=ROUNDING)

    def test_a_motion_of_the_whole_changes_nothing(self):
        for i, (scene, slots) in enumerate(in_contact(60, 4000, points=9)):
            rng = np.random.default_rng(i)
            vector, shift = rng.normal(size=3), rng.uniform(-5, 5, 3)
            turn = rotation(vector)
            c = scene.shapes.centroid
            pose = scene.pose.copy()
            pose[:, :3] = c @ turn.T - c + shift
            pose[:, 3:] = quaternion(vector)
            after = scene.find(pose)
            assert np.array_equal(after.which, slots.which)
            k = used(slots)
            assert after.gap[k] == pytest.approx(slots.gap[k], abs=1e-9)
            assert after.size[k] == pytest.approx(slots.size[k], abs=1e-9)
            for name in ("normal", "arm_a", "arm_b"):
                was, now = getattr(slots, name)[k], getattr(after, name)[k]
                assert now == pytest.approx(was @ turn.T, abs=1e-9)
            assert after.tangents[k] == pytest.approx(slots.tangents[k] @ turn.T, abs=1e-9)

    def test_following_to_the_same_pose_is_finding(self):
        for scene, slots in in_contact(30, 5000):
            after = scene.follow(slots, scene.pose)
            k = used(slots)
            assert np.array_equal(after.value[k], slots.value[k])


def test_edges_that_cross_separate_as_brute_force_says():
    """Where edges count, no other axis says more, and all the others are not missed."""
    found = 0
    for seed in range(60):
        scene = random_scene(np.random.default_rng(7000 + seed))
        (p, faces_p), (q, faces_q) = scene.solids
        best, of_p, of_q = brute_separation(p, faces_p, q, faces_q)
        place(scene.shapes, scene.pose, scene.world)
        first, edge, world = scene.shapes.first, scene.shapes.edge, scene.world
        *_, across = separation.best_edges(
            first, edge, world.vertex, world.normal, 0, 1, np.zeros((5, 3))
        )
        if best > max(of_p, of_q) + 1e-3 and abs(best) < 0.02:
            assert across == pytest.approx(best, abs=1e-9)
            found += 1
        elif across > -np.inf:
            assert across <= best + 1e-9
    assert found > 10
