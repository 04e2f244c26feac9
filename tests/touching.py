"""Pairs of solids that touch, what detection finds of them and what brute force says."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from drystone.common import tolerances
from drystone.contact.contacts import KIND, NONE, PLANE_NORMAL_3, Pairs, Slots
from drystone.contact.space import manifold, points, shapes
from drystone.contact.space.rows import gradients_in_space
from drystone.contact.space.solids import pack
from drystone.geometry.motion import design_pose

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
        self.world = shapes.World.of(self.shapes)
        self.pose = design_pose(n, 3)
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
        points.follow(self.shapes, pose, self.world, self.pairs, known, slots)
        return slots

    def rows(self, slots):
        """Gradients of the slots found or followed last."""
        pairs, (which, value) = self.pairs, slots
        rows = np.zeros((pairs.n_slots, 3, 12))
        for k in np.flatnonzero(which[:, KIND] != NONE):
            a, b = pairs.which[pairs.of_slot[k], :2]
            gradients_in_space(value, k, self.world.axes, a, b, rows, k)
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


def in_contact(n, start=0, **settings):
    """Random scenes with contacts, and their slots."""
    for i in range(n):
        scene = random_scene(np.random.default_rng(start + i), **settings)
        slots = scene.find()
        if len(used(slots)):
            yield scene, slots


def crossing_edges(scene, slots):
    """Whether the only contact is one of two edges that cross, on a normal of its own."""
    k = used(slots)
    normal = slots.value[k, PLANE_NORMAL_3 : PLANE_NORMAL_3 + 3]
    of_faces = scene.shapes.plane[slots.edges[k].ravel(), :3]
    return len(k) == 1 and np.abs(of_faces @ normal[0]).max() < 1.0 - 1e-9


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
    return max(area, tolerances.LEAST_AREA * least)
