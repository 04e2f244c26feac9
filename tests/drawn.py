"""Blocks as other people draw them: rounded, bent, doubled; and joints by brute force."""

from __future__ import annotations

from itertools import combinations

import numpy as np

BOX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(low, high):
    """Vertices and faces of a box, outward."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    around = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return np.array([(x, y, z) for z in (z0, z1) for x, y in around], float), BOX


def bent_dome(rings=3, around=6, inner=4.7, outer=5.0, lowest=10.0, step=12.0):
    """Rings of blocks that are bent in the middle, each over the joint of two below.

    Points lie on two spheres about the origin, at heights and azimuths in steps: beds are planes
    through the centre, sides meridians; all faces are flat but the outer and the inner one, which
    are two quadrilaterals each, given as one of six corners.
    """

    def at(radius, height, azimuth):
        e, a = np.radians(height), np.radians(azimuth)
        return radius * np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])

    blocks = []
    half = 180.0 / around
    for ring in range(rings):
        low, high = lowest + step * ring, lowest + step * (ring + 1)
        for k in range(around):
            angles = [half * (2 * k + ring + i) for i in range(3)]
            vertices = [at(r, h, a) for r in (inner, outer) for h in (low, high) for a in angles]
            # Rows: inner low 0-2, inner high 3-5, outer low 6-8, outer high 9-11.
            faces = (
                (6, 7, 8, 11, 10, 9),  # outside, bent
                (3, 4, 5, 2, 1, 0),  # inside, bent
                (0, 1, 7, 6), (1, 2, 8, 7),  # below
                (9, 10, 4, 3), (10, 11, 5, 4),  # above
                (6, 9, 3, 0), (2, 5, 11, 8),  # sides
            )  # fmt: skip
            blocks.append((f"r{ring}b{k}", np.array(vertices), faces))
    return blocks


def brick_wall(rng=None, noise=0.0, decimals=None):
    """Six boxes in two courses of half bond, turned by 20 degrees; then disturbed and rounded."""
    c, s = np.cos(np.radians(20.0)), np.sin(np.radians(20.0))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    blocks = []
    for course in range(3):
        for k in range(2):
            x = k * 0.4 + 0.2 * (course % 2)
            vertices, faces = box((x, 0.0, 0.2 * course), (x + 0.4, 0.15, 0.2 * course + 0.2))
            vertices = vertices @ turn.T + [3.0, 7.0, 0.0]
            if noise:
                vertices = vertices + rng.uniform(-noise, noise, vertices.shape)
            if decimals is not None:
                vertices = np.round(vertices, decimals)
            blocks.append((f"c{course}u{k}", vertices, faces))
    return blocks


def obj_text(blocks, decimals=None, twice=False):
    """An OBJ file, an object each, faces once or twice."""
    lines, first = [], 1
    for name, vertices, faces in blocks:
        lines.append(f"o {name}")
        for row in vertices.tolist():
            numbers = map(repr, row) if decimals is None else (f"{x:.{decimals}f}" for x in row)
            lines.append("v " + " ".join(numbers))
        for face in faces * (1 + twice):
            lines.append("f " + " ".join(str(first + i) for i in face))
        first += len(vertices)
    return "\n".join(lines) + "\n"


# --- brute force ------------------------------------------------------------------------------


def _clip(polygon, a, b):
    """What of a plane polygon lies to the left of the way from a to b."""
    kept = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        hp = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
        hq = (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0])
        if hp >= 0.0:
            kept.append(p)
        if (hp >= 0.0) != (hq >= 0.0):
            share = hp / (hp - hq)
            kept.append((p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])))
    return kept


def _area(polygon):
    pairs = zip(polygon, polygon[1:] + polygon[:1], strict=True)
    return 0.5 * sum(p[0] * q[1] - q[0] * p[1] for p, q in pairs)


def shared_area(one, other, off, tilt=0.05):
    """Area that two triangles (3, 3) share which look at each other, within ``off`` [m]; else 0."""
    n = np.cross(one[1] - one[0], one[2] - one[0])
    m = np.cross(other[1] - other[0], other[2] - other[0])
    lengths = np.linalg.norm(n), np.linalg.norm(m)
    if min(lengths) == 0.0 or n @ m > -np.cos(tilt) * lengths[0] * lengths[1]:
        return 0.0
    n = n / lengths[0]
    if np.abs((other - one[0]) @ n).max() > off:
        return 0.0
    u = (one[1] - one[0]) / np.linalg.norm(one[1] - one[0])
    axes = np.column_stack((u, np.cross(n, u)))
    p = [tuple(row) for row in (one - one[0]) @ axes]
    q = [tuple(row) for row in (other - one[0]) @ axes]
    for a, b in zip(p, p[1:] + p[:1], strict=True):
        q = _clip(q, a, b)
        if len(q) < 3:
            return 0.0
    return abs(_area(q))


def joints_by_brute_force(blocks, off):
    """Area shared by each pair of blocks, {(i, j): m2}, every triangle against every other one.

    ``blocks`` are lists of triangles (3, 3), outward.
    """
    found = {}
    for (i, one), (j, other) in combinations(enumerate(blocks), 2):
        low = np.min([t.min(axis=0) for t in one], axis=0) - off
        high = np.max([t.max(axis=0) for t in one], axis=0) + off
        near = [t for t in other if (t.max(axis=0) > low).all() and (t.min(axis=0) < high).all()]
        area = sum(shared_area(s, t, off) for s in one for t in near)
        if area > 0.0:
            found[i, j] = area
    return found
