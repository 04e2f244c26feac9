"""Concave blocks cut into convex parts: areas and volumes, no overlap, seams."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_solids import DOVETAIL, L_OUTLINE, U_OUTLINE, rotation, seeds

from drystone.geometry import GeometryError
from drystone.geometry.plane.parts import convex_outlines, outline_seams, touched_corners
from drystone.geometry.plane.polygon import check_convex, check_outline, signed_area
from drystone.geometry.space.parts import convex_parts, solid_seams, touched_edges
from drystone.geometry.space.solid import (
    box,
    check,
    extruded,
    face_planes,
    is_plain,
    mass_properties,
    sum_of,
)
from solids import extruded_parts

T_OUTLINE = np.array([[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [0, 2], [0, 1], [1, 1]], float)
CROSS = np.array(
    [
        [1, 0],
        [2, 0],
        [2, 1],
        [3, 1],
        [3, 2],
        [2, 2],
        [2, 3],
        [1, 3],
        [1, 2],
        [0, 2],
        [0, 1],
        [1, 1],
    ],
    float,
)
#: Fewest convex parts: each cut takes away one reflex corner, or two where it ends on another.
FEWEST = {"L": (L_OUTLINE, 2), "U": (U_OUTLINE, 3), "T": (T_OUTLINE, 2), "cross": (CROSS, 3)}
FEWEST["dovetail"] = (DOVETAIL, 2)


@st.composite
def stars(draw):
    """Outlines around the origin, at random distances from it: as concave as can be."""
    rng = np.random.default_rng(draw(seeds))
    n = draw(st.integers(5, 14))
    angle = np.sort((np.arange(n) + rng.uniform(0.1, 0.9, n)) * 2.0 * np.pi / n)
    return rng.uniform(0.2, 1.0, n)[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))


def in_outlines(points, outlines):
    """In how many convex outlines each point is."""
    count = np.zeros(len(points), int)
    for p in outlines:
        edge = np.roll(p, -1, axis=0) - p
        arm = points[:, None] - p
        count += np.all(edge[:, 0] * arm[..., 1] - edge[:, 1] * arm[..., 0] >= 0.0, axis=1)
    return count


def in_solids(points, parts):
    count = np.zeros(len(points), int)
    for part in parts:
        normal, offset = face_planes(part.vertices, part.faces)
        count += np.all(points @ normal.T <= offset, axis=1)
    return count


def crossings(points, outline):
    """Whether points lie in a concave outline, by the edges that a ray to the right crosses."""
    a, b = outline, np.roll(outline, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    spans = (a[:, 1] <= y) != (b[:, 1] <= y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return np.count_nonzero(spans & (at > x), axis=1) % 2 == 1


class TestOutlines:
    @pytest.mark.parametrize("name", FEWEST)
    def test_fewest_parts_at_any_angle(self, name):
        outline, fewest = FEWEST[name]
        for angle in (0.0, 0.3, 2.0):
            c, s = np.cos(angle), np.sin(angle)
            turned = outline @ np.array([[c, s], [-s, c]])
            parts = convex_outlines(turned)
            assert len(parts) == fewest
            for part in parts:
                check_convex(part)
            assert sum(map(signed_area, parts)) == pytest.approx(signed_area(outline), rel=1e-12)

    def test_a_convex_one_stays_as_it_is(self):
        square = np.array([[0, 0], [1, 0], [1, 1], [0.5, 1], [0, 1]], float)
        (part,) = convex_outlines(square)
        assert np.array_equal(part, square)

    def test_given_vertices_keep_their_coordinates(self):
        outline = DOVETAIL / 3.0
        kept = {tuple(v) for part in convex_outlines(outline) for v in part}
        assert kept >= {tuple(v) for v in outline}

    @settings(deadline=None)
    @given(stars())
    def test_random_outlines(self, outline):
        check_outline(outline)
        parts = convex_outlines(outline)
        for part in parts:
            check_convex(part)
        points = np.random.default_rng(0).uniform(-1.0, 1.0, (2000, 2))
        # Points within rounding of a seam do not come up among two thousand.
        assert np.array_equal(in_outlines(points, parts), crossings(points, outline).astype(int))

    def test_seams(self):
        parts = convex_outlines(L_OUTLINE)
        seams = outline_seams(parts)
        found = {
            tuple(map(tuple, (p[i], p[(i + 1) % len(p)])))
            for p, seam in zip(parts, seams, strict=True)
            for i in np.flatnonzero(seam)
        }
        # The upper part stands on the lower with all of its lower edge, which has more beside it.
        assert found == {((0.0, 1.0), (1.0, 1.0))}

    def test_seams_of_given_parts(self):
        # A square in three: the edge of the large one is covered by those of two.
        parts = [
            np.array([[0, 0], [1, 0], [1, 2], [0, 2]], float),
            np.array([[1, 0], [2, 0], [2, 1], [1, 1]], float),
            np.array([[1, 1], [2, 1], [2, 2], [1, 2]], float),
        ]
        assert [seam.tolist() for seam in outline_seams(parts)] == [
            [False, True, False, False],
            [False, False, True, True],
            [True, False, False, True],
        ]
        assert [t.tolist() for t in touched_corners(parts)] == [
            [False, True, True, False],
            [True, False, True, True],
            [True, True, False, True],
        ]

    @pytest.mark.parametrize(
        ("outline", "sentence"),
        [
            ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], "touches itself at vertex 4"),
            ([[0, 0], [4, 0], [4, 3], [1, 3], [2, -1], [3, 2], [0, 2]], "crosses itself"),
            ([[0, 0], [2, 0], [2, 1], [3, 1], [2, 1.0], [2, 2], [0, 2]], "turns back|touches"),
            ([[0, 0], [0, 1], [1, 1], [1, 0]], "run clockwise"),
        ],
    )
    def test_what_is_wrong_is_said(self, outline, sentence):
        with pytest.raises(GeometryError, match=sentence):
            convex_outlines(np.array(outline, float))


def check_parts(vertices, faces, parts):
    """What must hold of parts whatever the solid."""
    whole = mass_properties(vertices, faces)
    for part in parts:
        check(part.vertices, part.faces)
        assert is_plain(part.vertices, part.faces)
    together = sum_of([mass_properties(part.vertices, part.faces) for part in parts])
    size = np.ptp(vertices, axis=0).max()
    assert together.volume == pytest.approx(whole.volume, rel=1e-9)
    assert together.centroid == pytest.approx(whole.centroid, abs=1e-9 * size)
    scale = float(np.trace(whole.inertia))
    assert together.inertia == pytest.approx(whole.inertia, abs=1e-8 * scale)


class TestSolids:
    @pytest.mark.parametrize("name", FEWEST)
    @pytest.mark.parametrize("seed", [None, 1, 2])
    def test_fewest_parts_at_any_angle(self, name, seed):
        outline, fewest = FEWEST[name]
        vertices, faces = extruded(outline, (0.3, 0.8))
        if seed is not None:
            rng = np.random.default_rng(seed)
            vertices = vertices @ rotation(rng).T + rng.uniform(-3.0, 3.0, 3)
        parts = convex_parts(vertices, faces)
        assert len(parts) == fewest
        check_parts(vertices, faces, parts)

    @settings(deadline=None, max_examples=25)
    @given(stars(), seeds)
    def test_random_extrusions(self, outline, seed):
        turn = rotation(np.random.default_rng(seed))
        vertices, faces = extruded(outline, (-0.2, 0.3))
        parts = convex_parts(vertices @ turn.T, faces)
        check_parts(vertices @ turn.T, faces, parts)
        points = np.random.default_rng(0).uniform(-1.0, 1.0, (1000, 3)) * [1.0, 0.5, 1.0]
        inside = crossings(points[:, [0, 2]], outline) & (np.abs(points[:, 1] - 0.05) < 0.25)
        assert np.array_equal(in_solids(points @ turn.T, parts), inside.astype(int))
        check_parts(vertices, faces, extruded_parts(outline, (-0.2, 0.3)))

    @settings(deadline=None, max_examples=25)
    @given(seeds, st.integers(2, 7))
    def test_random_unions_of_boxes(self, seed, n):
        # A heap of unit cubes, each next to one before: its surface are the squares that show.
        rng = np.random.default_rng(seed)
        cubes = heap(rng, n)
        vertices, faces = surface(cubes)
        check(vertices, faces)
        turn = rotation(rng)
        parts = convex_parts(vertices @ turn.T, faces)
        assert len(parts) <= n
        check_parts(vertices @ turn.T, faces, parts)
        points = rng.uniform(-1.0, n, (1000, 3))
        inside = [tuple(np.floor(p).astype(int)) in cubes for p in points]
        assert np.array_equal(in_solids(points @ turn.T, parts), np.array(inside, int))

    def test_a_dent(self):
        # A cube with a pyramid of height 1/2 taken out of its top: 1 - 1/6.
        vertices, faces = box([[0, 0, 0], [1, 1, 1]])
        vertices = np.vstack((vertices, [[0.5, 0.5, 0.5]]))
        dented = (faces[0], *faces[2:], (4, 5, 8), (5, 6, 8), (6, 7, 8), (7, 4, 8))
        check(vertices, dented)
        parts = convex_parts(vertices, dented)
        assert sum(mass_properties(p.vertices, p.faces).volume for p in parts) == pytest.approx(
            5.0 / 6.0, rel=1e-12
        )
        check_parts(vertices, dented, parts)
        assert len(parts) <= 5

    def test_a_frame_with_a_hole(self):
        cubes = {(x, 0, z) for x in range(3) for z in range(3)} - {(1, 0, 1)}
        vertices, faces = surface(cubes)
        check(vertices, faces)
        parts = convex_parts(vertices, faces)
        assert len(parts) == 4
        check_parts(vertices, faces, parts)

    def test_crossing_faces_are_found_out(self):
        # Two boxes that pass through each other, as one surface: the volume counts twice.
        (v, f), (w, g) = box([[0, 0, 0], [2, 1, 1]]), box([[1, 0.5, 0.5], [3, 2, 2]])
        faces = (*f, *(tuple(i + 8 for i in face) for face in g))
        with pytest.raises(GeometryError, match="miss its volume"):
            convex_parts(np.vstack((v, w)), faces)

    def test_seams(self):
        parts = convex_parts(*extruded(L_OUTLINE, (0.0, 1.0)))
        upper, lower = sorted(
            zip(parts, solid_seams(parts), touched_edges(parts), strict=True),
            key=lambda part: -part[0].vertices[:, 2].max(),
        )
        (seam,) = np.flatnonzero(upper[1])
        assert upper[0].vertices[list(upper[0].faces[seam]), 2] == pytest.approx(1.0)
        assert not lower[1].any()
        # The four edges of the upper part's foot, and of the lower part's top the one below it and
        # halves of two more, whose middles just lie at the seam's end.
        assert len(upper[2]) == 4
        assert len(lower[2]) == 3

    def test_seams_of_many_parts(self):
        parts = convex_parts(*surface(heap(np.random.default_rng(4), 7)))
        for k, (part, seam) in enumerate(zip(parts, solid_seams(parts), strict=True)):
            normal, _ = face_planes(part.vertices, part.faces)
            others = [other for m, other in enumerate(parts) if m != k]
            rng = np.random.default_rng(k)
            for i, face in enumerate(part.faces):
                corners = part.vertices[list(face)]
                share = rng.dirichlet(np.ones(len(face)), 50)
                before = share @ corners + 1e-3 * normal[i]
                assert (in_solids(before, others) > 0).all() == seam[i]


def heap(rng, n):
    cubes = {(0, 0, 0)}
    while len(cubes) < n:
        x, y, z = sorted(cubes)[rng.integers(len(cubes))]
        axis, step = rng.integers(3), rng.choice([-1, 1])
        cube = [x, y, z]
        cube[axis] += step
        if manifold(cubes | {tuple(cube)}):
            cubes.add(tuple(cube))
    return cubes


def squares(cubes):
    """Faces of cubes that show, by their corners."""
    vertices, faces = box([[0, 0, 0], [1, 1, 1]])
    normal, _ = face_planes(vertices, faces)
    for cube in sorted(cubes):
        for n, face in zip(np.rint(normal).astype(int), faces, strict=True):
            if tuple(np.array(cube) + n) not in cubes:
                yield [tuple((np.array(cube) + vertices[i]).astype(int)) for i in face]


def manifold(cubes):
    """Whether no edge has four faces: cubes that touch along an edge alone are no solid."""
    edges = [frozenset((face[k - 1], face[k])) for face in squares(cubes) for k in range(len(face))]
    return all(edges.count(edge) == 2 for edge in set(edges))


def surface(cubes):
    faces = list(squares(cubes))
    corners = sorted({corner for face in faces for corner in face})
    row = {corner: i for i, corner in enumerate(corners)}
    return np.array(corners, float), tuple(tuple(row[c] for c in face) for face in faces)
