"""Contacts between convex parts in space: points, gaps, areas, exact derivatives, identity.

Overlaps and separations are judged by brute force, derivatives by central differences.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from drystone.contact.solids import pack
from drystone.geometry.broad import candidate_pairs
from drystone.geometry.motion import moved, rest
from drystone.kernels import manifold, overlap, separation
from drystone.kernels.contacts import (
    BALL_3,
    NONE,
    PLACE_3,
    PLANE_NORMAL_3,
    POINT_3,
    VERTEX_B,
    Pairs,
    Slots,
)
from drystone.kernels.spatial_rows import slot_rows_in_space
from drystone.kernels.succession import carried, find_predecessors

pytestmark = pytest.mark.kernels

BOX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
# Sums of products of lengths below 10 m: a few rounding errors of 1e-15.
ROUNDING = 1e-12


def box(lower, upper):
    """Vertices and faces of a box."""
    (x0, y0, z0), (x1, y1, z1) = lower, upper
    around = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return np.array([(x, y, z) for z in (z0, z1) for x, y in around], float), BOX


def hull(points):
    """Vertices and faces, all triangles, of the hull of points in general position."""
    found = ConvexHull(points)
    row = np.zeros(len(points), int)
    row[found.vertices] = np.arange(len(found.vertices))
    faces = []
    for simplex, outward in zip(found.simplices, found.equations, strict=True):
        a, b, c = points[simplex]
        order = simplex if np.cross(b - a, c - a) @ outward[:3] > 0 else simplex[::-1]
        faces.append(tuple(row[order].tolist()))
    return points[found.vertices], tuple(faces)


def rotation(vector):
    """Matrix of a rotation vector."""
    x, y, z = vector
    angle = np.linalg.norm(vector)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    if angle == 0.0:
        return np.eye(3)
    return np.eye(3) + np.sin(angle) / angle * k + (1 - np.cos(angle)) / angle**2 * k @ k


def quaternion(vector):
    """Unit quaternion of a rotation vector."""
    angle = np.linalg.norm(vector)
    share = 0.5 * np.sinc(0.5 * angle / np.pi)
    return np.array([np.cos(0.5 * angle), *(share * np.asarray(vector))])


class Scene:
    """Solids, each a body of one part, and what detection finds between all of them."""

    def __init__(self, solids, *, radius=0.0, points=4, reach=0.05, axes=None):
        n = len(solids)
        self.solids, self.points, self.reach = solids, points, reach
        centroid = np.array([vertices.mean(axis=0) for vertices, _ in solids])
        cores = [(v - c, faces) for (v, faces), c in zip(solids, centroid, strict=True)]
        self.axes = np.tile(np.eye(3), (n, 1, 1)) if axes is None else axes
        untreated = np.zeros(sum(len(face) for _, faces in cores for face in faces))
        self.shapes = pack(cores, np.arange(n), np.full(n, radius), untreated, centroid, self.axes)
        self.world = manifold.World.of(self.shapes)
        self.pose = rest(n, 3)
        a, b = np.triu_indices(n, 1)
        n_slots = manifold.slots_of(self.shapes, points, a, b)
        self.pairs = Pairs.of((a, b, a, b, 0 * a), n_slots, self.pose)
        self.slots = Slots.empty(self.pairs.n_slots, 3)

    def find(self, pose=None, *, before=None):
        """Slots anew; those ``before`` say which faces were used."""
        slots = before.copied() if before else Slots.empty(self.pairs.n_slots, 3)
        pose = self.pose if pose is None else pose
        manifold.find(self.shapes, pose, self.world, self.pairs, self.reach, self.points, slots)
        return slots

    def follow(self, known, pose):
        """Known slots in another pose."""
        slots = Slots.empty(self.pairs.n_slots, 3)
        manifold.follow(self.shapes, pose, self.world, self.pairs, known, slots)
        return slots

    def rows(self, slots):
        """Gradients of the slots found or followed last."""
        rows = np.zeros((self.pairs.n_slots, 3, 12))
        pairs = self.pairs
        slot_rows_in_space(slots, pairs.of_slot, pairs.which, self.world.axes, rows)
        return rows

    def vertices(self, i, pose):
        """Where those of body i are in a pose, from scratch."""
        w, *v = pose[i, 3:]
        angle = 2 * np.arctan2(np.linalg.norm(v), w)
        turn = rotation(angle * np.array(v) / max(np.linalg.norm(v), 1e-300))
        c = self.shapes.centroid[i]
        return (self.solids[i][0] - c) @ turn.T + c + pose[i, :3]


def used(slots):
    """Rows of the slots in use."""
    return np.flatnonzero(slots.kind != NONE)


def flush(width=1.0, depth=1.0, **settings):
    """Two boxes with the same faces, one on top of the other, touching at z = 0."""
    lower, upper = box((0, 0, -1), (width, depth, 0)), box((0, 0, 0), (width, depth, 1))
    return Scene([lower, upper], **settings)


def random_scene(rng, **settings):
    """Two random solids of about 1 m that press on or just miss each other, anywhere in space."""
    solids = []
    for _ in range(2):
        if rng.random() < 0.4:
            half = rng.uniform(0.1, 0.6, 3)
            vertices, faces = box(-half, half)
        else:
            points = rng.normal(size=(int(rng.integers(5, 12)), 3))
            points /= np.linalg.norm(points, axis=1)[:, None]
            vertices, faces = hull(points * rng.uniform(0.3, 0.6, 3))
        turn = rotation(rng.normal(size=3) * rng.choice([0.0, 0.05, 2.0]))
        solids.append((vertices @ turn.T, faces))
    along = rng.normal(size=3)
    along /= np.linalg.norm(along)
    (p, faces_p), (q, faces_q) = solids
    far = q + 4.0 * along
    low, high = 0.0, 4.0  # how far to move q back
    for _ in range(40):
        middle = 0.5 * (low + high)
        if brute_separation(p, faces_p, far - middle * along, faces_q)[0] > 0.0:
            low = middle
        else:
            high = middle
    off = rng.choice([-0.01, -1e-3, -1e-5, 1e-3, 0.01])
    q = far - (low + off) * along
    shift = rng.uniform(-3, 3, 3)
    axes = np.array([rotation(rng.normal(size=3)) for _ in range(2)])
    return Scene([(p + shift, faces_p), (q + shift, faces_q)], axes=axes, **settings)


def planes(vertices, faces):
    """Outward unit normals (n, 3) and offsets (n,) of faces."""
    normals = []
    for face in faces:
        v = vertices[list(face)]
        n = np.cross(v, np.roll(v, -1, axis=0)).sum(axis=0)
        normals.append(n / np.linalg.norm(n))
    normals = np.array(normals)
    return normals, np.einsum("ij,ij->i", normals, vertices[[face[0] for face in faces]])


def edges_of(faces):
    """Pairs of vertices."""
    return sorted({tuple(sorted(e)) for f in faces for e in zip(f, f[1:] + f[:1], strict=True)})


def brute_separation(p, faces_p, q, faces_q):
    """Largest separation over normals of faces and cross products of edges; that of faces alone,
    of each solid (from p's faces, from q's)."""
    normals_p, offsets_p = planes(p, faces_p)
    normals_q, offsets_q = planes(q, faces_q)
    of_p = ((q @ normals_p.T).min(axis=0) - offsets_p).max()
    of_q = ((p @ normals_q.T).min(axis=0) - offsets_q).max()
    u, v = (
        np.array([x[j] - x[i] for i, j in edges_of(f)]) for x, f in ((p, faces_p), (q, faces_q))
    )
    axes = np.cross(u[:, None], v[None]).reshape(-1, 3)
    size = np.linalg.norm(axes, axis=1)
    axes = axes[size > 1e-9] / size[size > 1e-9, None]
    axes = np.vstack((axes, -axes, np.eye(3)))
    across = ((q @ axes.T).min(axis=0) - (p @ axes.T).max(axis=0)).max()
    return max(of_p, of_q, across), of_p, of_q


def brute_overlap(p, q):
    """Area and centroid of what two convex polygons (n, 2), counter-clockwise, have in common."""

    def inside(points, polygon, slack=1e-12):
        e = np.roll(polygon, -1, axis=0) - polygon
        d = points[:, None] - polygon
        return np.all(e[:, 0] * d[..., 1] - e[:, 1] * d[..., 0] >= -slack, axis=1)

    found = [p[inside(p, q)], q[inside(q, p)]]
    for a, b in zip(p, np.roll(p, -1, axis=0), strict=True):
        for c, d in zip(q, np.roll(q, -1, axis=0), strict=True):
            system = np.column_stack((b - a, c - d))
            if abs(np.linalg.det(system)) > 1e-14:
                s, t = np.linalg.solve(system, c - a)
                if 0 <= s <= 1 and 0 <= t <= 1:
                    found.append((a + s * (b - a))[None])
    points = np.vstack(found)
    if len(points) < 3 or np.linalg.matrix_rank(points - points[0], tol=1e-9) < 2:
        return 0.0, None
    corners = points[ConvexHull(points).vertices]
    x, y = (corners - corners[0]).T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    moment = [(cross * (c + np.roll(c, -1))).sum() / 6 for c in (x, y)]
    area = 0.5 * cross.sum()
    return area, corners[0] + np.array(moment) / area


def convex_polygon(rng):
    n = int(rng.integers(3, 9))
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    around = np.column_stack((np.cos(angle), np.sin(angle))) * rng.uniform(0.2, 1.0, 2)
    return around + rng.uniform(-0.7, 0.7, 2)


class TestOverlap:
    @pytest.mark.parametrize("seed", range(60))
    def test_area_and_centroid_equal_brute_force(self, seed):
        rng = np.random.default_rng(seed)
        p, q = convex_polygon(rng), convex_polygon(rng)
        corner, name = np.zeros((2, 40, 2)), np.zeros((2, 40, 4), np.int64)
        half, count = overlap.clip(q, len(q), p, len(p), 0.0, corner, name)
        area, cx, cy, _ = overlap.measure(corner, half, count)
        wanted, centroid = brute_overlap(p, q)
        assert area == pytest.approx(wanted, abs=ROUNDING)
        if area > 1e-6:  # a centroid is as precise as rounding over the area
            assert (cx, cy) == pytest.approx(centroid, abs=1e-8)

    @pytest.mark.parametrize("points", [4, 9, 16])
    @pytest.mark.parametrize("seed", range(20))
    def test_points_have_the_area_and_its_centre(self, seed, points):
        """Their weights are positive, and a uniform pressure has no moment about the centroid."""
        rng = np.random.default_rng(seed)
        p, q = convex_polygon(rng), convex_polygon(rng)
        area, centroid = brute_overlap(p, q)
        if area < 1e-3:
            q, (area, centroid) = p.copy(), brute_overlap(p, p)
        corner, name = np.zeros((2, 40, 2)), np.zeros((2, 40, 4), np.int64)
        half, count = overlap.clip(q, len(q), p, len(p), 0.0, corner, name)
        width = overlap.width_of(area, overlap.measure(corner, half, count)[3])
        near, short = overlap.CLIP * width, overlap.MERGE * width
        overlap.name_corners(corner, name, half, count, q, len(q), p, len(p), near)
        count = overlap.merge_corners(corner, name, half, count, short, near)
        n = overlap.n_spread(count, points, 100)
        assert n == {4: count, 9: 2 * count + 1, 16: 4 * count}[points]
        point, mark, weight = np.zeros((100, 2)), np.zeros((100, 4), np.int64), np.zeros(100)
        overlap.spread(corner, name, half, count, *centroid, n, point, mark, weight)
        overlap.scale(point, n, *centroid, area, weight)
        assert weight[:n].min() > 0.0
        assert weight.sum() == pytest.approx(area, rel=1e-12)
        assert weight[:n] @ (point[:n] - centroid) == pytest.approx(0.0, abs=1e-12)

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


def in_contact(n, start=0, **settings):
    """Random scenes with contacts, and their slots."""
    for i in range(n):
        scene = random_scene(np.random.default_rng(start + i), **settings)
        slots = scene.find()
        if len(used(slots)):
            yield scene, slots


def crossing_edges(scene, slots):
    """Whether the only contact is one of two edges that cross."""
    k = used(slots)
    first, last = len(scene.shapes.local), len(scene.shapes.local) + len(scene.shapes.edge)
    feature = slots.feature[k]
    return len(k) == 1 and feature.min() >= first and feature.max() < last


def brute_area(scene, slots):
    """Overlap of the two faces that meet, seen along the normal of the one that separates more."""
    k = used(slots)[0]
    flat = []
    for i, (vertices, faces) in enumerate(scene.solids):
        normals, offsets = planes(vertices, faces)
        f = slots.edges[k, i] - scene.shapes.first[i, 1]
        other = scene.solids[1 - i][0]
        flat.append((vertices[list(faces[f])], normals[f], (other @ normals[f]).min() - offsets[f]))
    (p, n, of_p), (q, m, of_q) = flat
    if of_q > of_p:
        p, n, q = q, m, p
    t = (p[1] - p[0]) / np.linalg.norm(p[1] - p[0])
    axes = np.column_stack((t, np.cross(n, t)))
    area, _ = brute_overlap((p - p[0]) @ axes, ((q - p[0]) @ axes)[::-1])
    least = min(0.5 * np.linalg.norm(np.cross(x, np.roll(x, -1, 0)).sum(axis=0)) for x in (p, q))
    return max(area, manifold.LEAST_SHARE * least)


class TestRandomPairs:
    """Convex solids that press on each other, or all but touch, by any of their features."""

    @pytest.mark.parametrize("block", range(2))
    def test_gaps_equal_brute_force(self, block):
        """Each is the distance of its point from its plane, and the smallest that of the solids."""
        seen = set()
        for scene, slots in in_contact(12, 100 * block):
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
            # Faces are taken for edges that separate the solids by no more than MARGIN more.
            margin = (0.0 if edges else 2.0 * manifold.MARGIN) * shapes.size.min() + 1e-9
            assert abs(slots.gap[used(slots)].min() - best) <= margin
        assert seen == {True, False}

    @pytest.mark.parametrize("block", range(2))
    def test_areas_add_up_to_the_overlap(self, block):
        for scene, slots in in_contact(12, 1000 + 100 * block, reach=np.inf):
            if not crossing_edges(scene, slots):
                assert slots.size[used(slots)].sum() == pytest.approx(
                    brute_area(scene, slots), rel=1e-9
                )

    @pytest.mark.parametrize("block", range(2))
    @pytest.mark.parametrize("radius", [0.0, 0.02])
    def test_gradients_equal_central_differences(self, block, radius):
        # The error of a central difference is some h^2 + rounding / h.
        h = 1e-5
        for scene, slots in in_contact(4, 2000 + 100 * block, radius=radius):
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
        for scene, slots in in_contact(8, 3000):
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
        for i, (scene, slots) in enumerate(in_contact(8, 4000, points=9)):
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
        for scene, slots in in_contact(6, 5000):
            after = scene.follow(slots, scene.pose)
            k = used(slots)
            assert np.array_equal(after.value[k], slots.value[k])


class TestFlush:
    @pytest.mark.parametrize("shift", [(0.0, 0.0), (0.4, 0.0), (0.3, 0.2), (0.999, 0.0)])
    def test_corners_and_areas(self, shift):
        lower, upper = box((0, 0, -1), (1, 1, 0)), box((*shift, 0), (1 + shift[0], 1 + shift[1], 1))
        scene = Scene([lower, upper])
        slots = scene.find()
        k = used(slots)
        wide, deep = 1 - shift[0], 1 - shift[1]
        assert len(k) == 4
        area = max(wide * deep, manifold.LEAST_SHARE)
        assert slots.size[k] == pytest.approx(area / 4, rel=1e-9)
        place = scene.shapes.centroid[0] + slots.arm_a[k]
        corners = {tuple(x) for x in np.round(place, 9) + 0.0}
        assert corners == {(x, y, 0) for x in (shift[0], 1) for y in (shift[1], 1)}
        assert slots.normal[k] == pytest.approx(np.tile([0, 0, 1], (4, 1)), abs=1e-15)
        assert slots.gap[k] == pytest.approx(0.0, abs=1e-15)

    @pytest.mark.parametrize("shift", [(0.0, 0.0), (0.5, 0.0), (0.0, 0.25), (0.31, 0.27)])
    def test_noise_changes_no_feature(self, shift):
        """A resting pile keeps its contacts, whatever rounding and settling do to its blocks."""
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
        assert slots.size[k] == pytest.approx(manifold.LEAST_SHARE * 2 * np.sqrt(2), rel=1e-9)

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
            assert b.gap[k] == pytest.approx(a.gap[k] - 2 * radius, abs=ROUNDING)
            # At the surface of the body that has the point.
            v = np.where(a.kind[k] == VERTEX_B, -1.0, 1.0)[:, None]
            assert b.arm_a[k] == pytest.approx(a.arm_a[k] + v * radius * a.normal[k], abs=ROUNDING)
            assert b.value[k, BALL_3] == pytest.approx(radius)

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
        lost = carried(old, new, source, force, after)
        gone_on = np.flatnonzero(source >= 0)
        for i in gone_on:
            was = force[source[i]] @ old.tangents[source[i]]
            assert after[i] @ new.tangents[i] == pytest.approx(was, abs=ROUNDING)
        left = np.setdiff1d(used(old), source[gone_on])
        assert len(left) >= 1
        assert lost == pytest.approx(np.linalg.norm(force[left], axis=1).sum(), rel=1e-12)


class TestBroadPhase:
    @pytest.mark.parametrize("seed", range(10))
    def test_equals_brute_force_in_space(self, seed):
        rng = np.random.default_rng(seed)
        lower = rng.uniform(-3, 3, (60, 3)).round(1)
        upper = lower + rng.uniform(0, [2.0, 0.5, 4.0], (60, 3)).round(1)
        meet = np.all(lower[:, None] <= upper, axis=2) & np.all(lower <= upper[:, None], axis=2)
        a, b = candidate_pairs(lower, upper)
        assert np.column_stack((a, b)).tolist() == np.argwhere(np.triu(meet, 1)).tolist()


def test_edges_that_cross_separate_as_brute_force_says():
    """Where edges count, no other axis says more, and all the others are not missed."""
    found = 0
    for seed in range(16):
        scene = random_scene(np.random.default_rng(7000 + seed))
        (p, faces_p), (q, faces_q) = scene.solids
        best, of_p, of_q = brute_separation(p, faces_p, q, faces_q)
        manifold.place(scene.shapes, scene.pose, scene.world)
        first, edge, world = scene.shapes.first, scene.shapes.edge, scene.world
        *_, across = separation.best_edges(
            first, edge, world.vertex, world.normal, 0, 1, np.zeros((5, 3))
        )
        if best > max(of_p, of_q) + 1e-3 and abs(best) < 0.02:
            assert across == pytest.approx(best, abs=1e-9)
            found += 1
        elif across > -np.inf:
            assert across <= best + 1e-9
    assert found > 3
