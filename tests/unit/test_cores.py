"""Contact shapes of solids and of parts: how far they reach, and what they came from."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_convex_parts import DOVETAIL, L_OUTLINE
from test_solids import random_hulls

from drystone.geometry import GeometryError
from drystone.geometry.cores import (
    chamfered_outline,
    chamfered_solid,
    rounded_outline,
    rounded_solid,
    sharp_solid,
)
from drystone.geometry.plane import polygon
from drystone.geometry.plane.parts import convex_outlines, outline_seams, touched_corners
from drystone.geometry.space.parts import solid_seams, touched_edges
from drystone.geometry.space.solid import (
    box,
    check,
    extruded,
    face_planes,
    hull,
    is_convex,
    mass_properties,
)
from solids import extruded_parts

CUBE = box([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
PYRAMID = hull(np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0], [0, 0, 1]], float))


def check_core(core):
    check(core.vertices, core.faces)
    # Corners nearer to a plane than 1e-9 of the size are taken to lie on it.
    assert is_convex(core.vertices, core.faces, 1e-8)
    assert len(core.origin) == len(core.faces)


def reach(core, normal):
    """How far a core, swept with its ball, reaches along directions (n, 3) [m]."""
    return (core.vertices @ normal.T).max(axis=0) + core.radius


class TestSharp:
    def test_is_the_solid_itself(self):
        core = sharp_solid(*CUBE)
        assert np.array_equal(core.vertices, CUBE[0])
        assert core.faces == CUBE[1]
        assert core.origin.tolist() == list(range(6))
        assert core.radius == 0.0


class TestRounded:
    def test_a_box_keeps_its_faces(self):
        vertices, faces = box([[0.0, 1.0, 2.0], [0.4, 1.3, 2.2]])
        core = rounded_solid(vertices, faces, 0.02)
        expected, _ = box([[0.02, 1.02, 2.02], [0.38, 1.28, 2.18]])
        assert core.vertices == pytest.approx(expected, abs=1e-15)
        assert core.faces == faces
        assert core.origin.tolist() == list(range(6))

    def test_where_four_faces_meet(self):
        # The square pyramid with faces at 45 degrees: its base goes up by r, and its top down by
        # sqrt(2) r, so that it is smaller by the factor 1 - (1 + sqrt(2)) r.
        r = 0.1
        core = rounded_solid(*PYRAMID, r)
        check_core(core)
        assert mass_properties(core.vertices, core.faces).volume == pytest.approx(
            4.0 / 3.0 * (1.0 - (1.0 + np.sqrt(2.0)) * r) ** 3, rel=1e-12
        )
        assert sorted(core.origin) == [0, 1, 2, 3, 4]

    def test_a_ridge_from_a_top(self):
        # On an oblong base five units of four faces would not meet in a point again: an edge comes.
        top = hull(np.array([[2, 1, 0], [-2, 1, 0], [-2, -1, 0], [2, -1, 0], [0, 0, 1]], float))
        core = rounded_solid(*top, 0.1)
        check_core(core)
        assert len(core.vertices) == 6

    @settings(deadline=None)
    @given(random_hulls(), st.floats(0.001, 0.02))
    def test_random_hulls(self, points, radius):
        vertices, faces = hull(points)
        try:
            core = rounded_solid(vertices, faces, radius)
        except GeometryError as error:
            assert "leaves nothing of face" in str(error)
            return
        check_core(core)
        normal, offset = face_planes(vertices, faces)
        # Swept with the ball it reaches to every face, and beyond none.
        assert reach(core, normal) == pytest.approx(offset, abs=1e-9)
        inner, _ = face_planes(core.vertices, core.faces)
        assert np.sum(inner * normal[core.origin], axis=1) == pytest.approx(1.0, abs=1e-9)
        assert sorted(core.origin) == list(range(len(faces)))

    def test_seams_stay(self):
        seam = np.array([True, False, False, False, False, False])
        core = rounded_solid(*CUBE, 0.1, seam)
        expected, _ = box([[0.1, 0.1, 0.0], [0.9, 0.9, 0.9]])
        assert core.vertices == pytest.approx(expected, abs=1e-15)

    def test_parts_of_a_dovetail_fill_it(self):
        # Swept, the parts cover the flat of every face of the block, across the seam too.
        parts = extruded_parts(DOVETAIL, (0.0, 1.0))
        radius = 0.05
        cores = [
            rounded_solid(part.vertices, part.faces, radius, seam)
            for part, seam in zip(parts, solid_seams(parts), strict=True)
        ]
        neck = np.column_stack((np.linspace(1.6, 2.4, 9), np.full(9, 0.5), np.full(9, 1.0)))
        assert (distance(neck, cores) <= radius).all()

    @pytest.mark.parametrize("radius", [0.5, 0.6, 5.0])
    def test_nothing_left(self, radius):
        with pytest.raises(GeometryError, match=r"radius .* leaves nothing of face \d \[.*smaller"):
            rounded_solid(*CUBE, radius)

    def test_a_face_that_vanishes(self):
        # A cube with a corner cut off by 0.1: its small triangle vanishes 0.0789 (1.1547 r)
        # inwards.
        vertices, faces = hull(
            np.vstack((CUBE[0][:6], CUBE[0][7:], [[0.9, 1, 1], [1, 0.9, 1], [1, 1, 0.9]]))
        )
        check_core(rounded_solid(vertices, faces, 0.07))
        with pytest.raises(GeometryError, match="leaves nothing of face"):
            rounded_solid(vertices, faces, 0.08)


def distance(points, cores):
    """An upper bound of how far points are from the nearest core [m]."""
    from scipy.optimize import nnls

    found = np.full(len(points), np.inf)
    for core in cores:
        for k, point in enumerate(points):
            # The nearest convex combination of the corners: least squares, with a sum of one.
            a = np.vstack(((core.vertices - point).T, 1e3 * np.ones(len(core.vertices))))
            weights, _ = nnls(a, np.array([0.0, 0.0, 0.0, 1e3]))
            weights /= weights.sum()
            found[k] = min(found[k], np.linalg.norm(weights @ (core.vertices - point)))
    return found


class TestChamfered:
    def test_a_cube(self):
        c = 0.1
        core = chamfered_solid(*CUBE, c)
        check_core(core)
        # Squares of 1 - 2c, 12 cuts, and 8 corners where three cuts meet at c/2 from each face.
        assert len(core.faces) == 18 and len(core.vertices) == 32
        assert sorted(core.origin) == [-1] * 12 + list(range(6))
        assert np.count_nonzero(np.isclose(core.vertices, c / 2).all(axis=1)) == 1
        # Each cut takes a prism of c^2/2.  Of the cube of side c at a corner three of them take
        # x + y < c or y + z < c or x + z < c: all but a quarter.
        removed = 12 * 0.5 * c * c * (1.0 - 2.0 * c) + 8 * 0.75 * c**3
        volume = mass_properties(core.vertices, core.faces).volume
        assert volume == pytest.approx(1.0 - removed, rel=1e-12)

    @settings(deadline=None)
    @given(random_hulls(), st.floats(0.001, 0.02))
    def test_random_hulls(self, points, leg):
        vertices, faces = hull(points)
        try:
            core = chamfered_solid(vertices, faces, leg)
        except GeometryError as error:
            assert "leaves nothing of face" in str(error)
            return
        check_core(core)
        normal, offset = face_planes(vertices, faces)
        assert reach(core, normal) == pytest.approx(offset, abs=1e-9)
        inner, _ = face_planes(core.vertices, core.faces)
        kept = core.origin >= 0
        assert np.sum(inner[kept] * normal[core.origin[kept]], axis=1) == pytest.approx(1.0)
        # What is left of a face is at least the leg from each of its edges.
        for i, face in enumerate(core.faces):
            if core.origin[i] >= 0:
                around = faces[core.origin[i]]
                corners = vertices[list(around)]
                for k in range(len(around)):
                    along = corners[k] - corners[k - 1]
                    inward = np.cross(normal[core.origin[i]], along / np.linalg.norm(along))
                    off = (core.vertices[list(face)] - corners[k]) @ inward
                    assert off.min() >= leg - 1e-9

    def test_edges_that_stay(self):
        core = chamfered_solid(*CUBE, 0.1, {(0, 1)})
        check_core(core)
        assert list(core.origin).count(-1) == 11

    def test_parts_of_an_l(self):
        # Cut are the block's own edges: 6 x 3 of the prism but the one at the reflex corner, of
        # which the two that run on across the seam are cut in each part.
        parts = extruded_parts(L_OUTLINE, (0.0, 1.0))
        cores = [
            chamfered_solid(part.vertices, part.faces, 0.05, uncut)
            for part, uncut in zip(parts, touched_edges(parts), strict=True)
        ]
        for core in cores:
            check_core(core)

    @pytest.mark.parametrize("leg", [0.5, 0.7, 3.0])
    def test_nothing_left(self, leg):
        with pytest.raises(GeometryError, match=r"chamfer .* leaves nothing of face \d .* smaller"):
            chamfered_solid(*CUBE, leg)


class TestOutlines:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)

    def test_without_seams_they_are_those_of_polygons(self):
        none = np.zeros(4, bool)
        for mine, theirs in (
            (rounded_outline(self.square, 0.1, none), polygon.rounded_core(self.square, 0.1)),
            (chamfered_outline(self.square, 0.1, none), polygon.chamfered_core(self.square, 0.1)),
        ):
            assert np.array_equal(mine.vertices, theirs.vertices)
            assert np.array_equal(mine.setback, theirs.setback)

    def test_rounded(self):
        core = rounded_outline(self.square, 0.1, np.array([False, True, False, False]))
        expected = [[0.1, 0.1], [1.0, 0.1], [1.0, 0.9], [0.1, 0.9]]
        assert core.vertices == pytest.approx(np.array(expected), abs=1e-15)
        setback = [[0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.1, 0.1]]
        assert core.setback == pytest.approx(np.array(setback), abs=1e-15)

    def test_rounded_with_a_vertex_on_an_edge(self):
        outline = np.array([[0, 0], [0.5, 0], [1, 0], [1, 1], [0, 1]], float)
        core = rounded_outline(outline, 0.1, np.array([False, False, False, True, False]))
        expected = [[0.1, 0.1], [0.5, 0.1], [0.9, 0.1], [0.9, 1.0], [0.1, 1.0]]
        assert core.vertices == pytest.approx(np.array(expected), abs=1e-15)

    def test_chamfered(self):
        core = chamfered_outline(self.square, 0.1, np.array([True, False, False, True]))
        expected = [[0, 0], [0.9, 0], [1, 0.1], [1, 0.9], [0.9, 1], [0, 1]]
        assert core.vertices == pytest.approx(np.array(expected), abs=1e-15)
        setback = [[0, 0.1], [0, 0], [0.1, 0.1], [0, 0], [0.1, 0], [0, 0]]
        assert core.setback == pytest.approx(np.array(setback), abs=1e-15)

    def test_of_concave_outlines(self):
        parts = convex_outlines(DOVETAIL)
        for part, seam, uncut in zip(
            parts, outline_seams(parts), touched_corners(parts), strict=True
        ):
            rounded = rounded_outline(part, 0.05, seam)
            polygon.check_convex(rounded.vertices)
            polygon.check_convex(chamfered_outline(part, 0.05, uncut).vertices)
            edge = np.roll(part, -1, axis=0) - part
            inner = np.roll(rounded.vertices, -1, axis=0) - rounded.vertices
            length = np.linalg.norm(edge, axis=1) - rounded.setback.sum(axis=1)
            assert np.linalg.norm(inner, axis=1) == pytest.approx(length, rel=1e-12)

    def test_nothing_left(self):
        seam = np.array([True, False, False, False])
        with pytest.raises(GeometryError, match="leaves nothing of the edge of 1 m after vertex"):
            rounded_outline(self.square, 0.6, seam)
        with pytest.raises(GeometryError, match="leaves nothing of the edge of 1 m after vertex"):
            chamfered_outline(self.square, 0.6, seam)


def test_a_prism_as_wide_as_its_part_has_the_core_of_the_plane():
    outline = convex_outlines(L_OUTLINE)[0]
    core = rounded_solid(*extruded(outline, (0.0, 1.0)), 0.05)
    plane = polygon.rounded_core(outline, 0.05)
    assert core.vertices[: len(outline), [0, 2]] == pytest.approx(plane.vertices, abs=1e-15)
