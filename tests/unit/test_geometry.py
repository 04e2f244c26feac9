"""Polygons: closed forms, and what must not change when a polygon is moved."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drystone.geometry import GeometryError
from drystone.geometry.plane.outlines import Outlines
from drystone.geometry.plane.polygon import (
    chamfered_core,
    check_convex,
    mass_properties,
    rounded_core,
    sharp_core,
    signed_area,
)

# Sums of a few dozen products of numbers of order one: some hundred rounding errors at most.
ROUNDING = 1e-13


def rectangle(width, height, x=0.0, y=0.0):
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


@st.composite
def convex_polygons(draw):
    """Points of an ellipse at least 5 degrees apart, in order: convex by construction."""
    steps = draw(st.lists(st.integers(0, 71), min_size=3, max_size=12, unique=True))
    angle = np.radians(5.0 * np.sort(steps))
    half_axes = draw(st.tuples(st.floats(0.1, 10.0), st.floats(0.1, 10.0)))
    return np.column_stack((np.cos(angle), np.sin(angle))) * half_axes


def overlap_depth(a, b):
    (depth,) = Outlines.pack([[a], [b]]).overlap_depths(np.array([0]), np.array([1]))
    return depth


def moved(vertices, angle, shift):
    c, s = np.cos(angle), np.sin(angle)
    return vertices @ np.array([[c, -s], [s, c]]).T + shift


angles = st.floats(-np.pi, np.pi)
shifts = st.tuples(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))


class TestClosedForms:
    def test_rectangle(self):
        # A = bh, centroid in the middle, J = bh (b^2 + h^2) / 12 about it.
        b, h = 0.4, 0.175
        properties = mass_properties(rectangle(b, h, x=3.0, y=-2.0))
        assert properties.area == pytest.approx(b * h, rel=ROUNDING)
        assert properties.centroid == pytest.approx([3.0 + b / 2, -2.0 + h / 2], rel=ROUNDING)
        assert properties.polar_moment == pytest.approx(b * h * (b**2 + h**2) / 12.0, rel=ROUNDING)

    def test_right_triangle(self):
        # A = bh/2, centroid at a third of the legs, J = bh (b^2 + h^2) / 36 about it.
        b, h = 0.6, 0.9
        properties = mass_properties(np.array([[0.0, 0.0], [b, 0.0], [0.0, h]]))
        assert properties.area == pytest.approx(b * h / 2, rel=ROUNDING)
        assert properties.centroid == pytest.approx([b / 3, h / 3], rel=ROUNDING)
        assert properties.polar_moment == pytest.approx(b * h * (b**2 + h**2) / 36.0, rel=ROUNDING)

    @pytest.mark.parametrize("n", [3, 4, 6, 60])
    def test_regular_polygon(self, n):
        # With circumradius 1: A = n/2 sin(2 pi/n), J = A (2 + cos(2 pi/n)) / 6.
        angle = 2.0 * np.pi * np.arange(n) / n
        properties = mass_properties(np.column_stack((np.cos(angle), np.sin(angle))))
        area = 0.5 * n * np.sin(2.0 * np.pi / n)
        assert properties.area == pytest.approx(area, rel=10 * ROUNDING)
        assert properties.centroid == pytest.approx([0.0, 0.0], abs=ROUNDING)
        assert properties.polar_moment == pytest.approx(
            area * (2.0 + np.cos(2.0 * np.pi / n)) / 6.0, rel=10 * ROUNDING
        )

    def test_area_is_negative_when_clockwise(self):
        assert signed_area(rectangle(2.0, 3.0)[::-1]) == pytest.approx(-6.0, rel=ROUNDING)


class TestInvariance:
    # Moving by up to 100 m rounds vertices by 1e-14 m; the smallest polygons have areas of about
    # 1e-5 m2 and widths of 1e-3 m, so that their moments keep some eight digits.
    TOLERANCE = 1e-7

    @given(convex_polygons(), angles, shifts)
    def test_mass_properties(self, vertices, angle, shift):
        before = mass_properties(vertices)
        after = mass_properties(moved(vertices, angle, shift))
        size = np.ptp(vertices, axis=0).max()
        assert after.area == pytest.approx(before.area, rel=self.TOLERANCE)
        assert after.polar_moment == pytest.approx(before.polar_moment, rel=self.TOLERANCE)
        centroid = moved(before.centroid, angle, shift)
        assert after.centroid == pytest.approx(centroid, abs=self.TOLERANCE * size)

    @given(convex_polygons())
    def test_any_first_vertex_will_do(self, vertices):
        before, after = mass_properties(vertices), mass_properties(np.roll(vertices, 1, axis=0))
        assert after.polar_moment == pytest.approx(before.polar_moment, rel=self.TOLERANCE)

    @given(convex_polygons(), convex_polygons(), angles, shifts)
    def test_overlap_depth(self, a, b, angle, shift):
        # Both moved together; normals of edges of 0.01 m turn by the rounding over their length.
        depth = overlap_depth(a, b)
        together = overlap_depth(moved(a, angle, shift), moved(b, angle, shift))
        assert together == pytest.approx(depth, abs=1e-9)
        assert overlap_depth(b, a) == pytest.approx(depth, abs=1e-12)

    @given(convex_polygons(), angles, shifts)
    def test_moved_polygons_pass_the_check(self, vertices, angle, shift):
        check_convex(moved(vertices, angle, shift))


class TestCheckConvex:
    def test_vertices_along_an_edge_are_allowed(self):
        check_convex(np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))

    @pytest.mark.parametrize(
        ("vertices", "said"),
        [
            ([[0, 0], [1, 0]], "at least 3 vertices, it has 2"),
            ([[0, 0], [1, 0], [2, 0]], "encloses no area"),
            ([[0, 0], [1, 1], [1, 0], [0, 1]], "crosses itself"),
            ([[0, 0], [2, 2], [2, 0], [0, 1]], "crosses itself"),
            ([[0, 0], [0, 1], [1, 1], [1, 0]], "clockwise"),
            ([[0, 0], [1, 0], [0.2, 0.2], [0, 1]], r"not convex at vertex 3 \(0.2, 0.2\)"),
            ([[0, 0], [1, 0], [1, 0], [1, 1]], "vertices 2 and 3 are the same point"),
            ([[0, 0], [1, np.nan], [1, 1]], "finite"),
            ([[0, 0], [1, np.inf], [1, 1]], "finite"),
            ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], "pairs"),
        ],
    )
    def test_says_what_is_wrong(self, vertices, said):
        with pytest.raises(GeometryError, match=said):
            check_convex(np.array(vertices, dtype=float))

    def test_pentagram_crosses_itself_though_it_always_turns_left(self):
        angle = 2.0 * np.pi * np.arange(5) * 2 / 5
        with pytest.raises(GeometryError, match="crosses itself"):
            check_convex(np.column_stack((np.cos(angle), np.sin(angle))))


class TestCores:
    def test_sharp_core_is_the_outline(self):
        core = sharp_core(rectangle(0.4, 0.2))
        assert np.array_equal(core.vertices, rectangle(0.4, 0.2))
        assert core.radius == 0.0
        assert not core.setback.any()

    def test_rounded_rectangle(self):
        # A right corner sets the core back by r along both edges: tan(45 deg) = 1.
        core = rounded_core(rectangle(0.4, 0.2), 0.02)
        assert core.vertices == pytest.approx(rectangle(0.36, 0.16, 0.02, 0.02), abs=ROUNDING)
        assert core.setback == pytest.approx(np.full((4, 2), 0.02), rel=ROUNDING)

    @given(convex_polygons(), st.floats(1e-4, 1e-3))
    def test_rounded_core_lies_a_radius_inside_every_edge(self, vertices, radius):
        try:
            core = rounded_core(vertices, radius)
        except GeometryError:
            return  # too sharp a polygon for this radius
        edges = np.roll(vertices, -1, axis=0) - vertices
        normal = np.column_stack((edges[:, 1], -edges[:, 0]))
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        distance = np.sum(normal * (core.vertices - vertices), axis=1)
        assert distance == pytest.approx(np.full(len(vertices), -radius), abs=1e-12)
        following = np.sum(normal * (np.roll(core.vertices, -1, axis=0) - vertices), axis=1)
        assert following == pytest.approx(np.full(len(vertices), -radius), abs=1e-10)

    def test_chamfered_rectangle(self):
        # Four triangles of half a leg squared are cut off.
        core = chamfered_core(rectangle(0.4, 0.2), 0.02)
        assert len(core.vertices) == 8
        assert signed_area(core.vertices) == pytest.approx(0.08 - 4 * 0.5 * 0.02**2, rel=ROUNDING)
        assert core.radius == 0.0
        check_convex(core.vertices)

    @pytest.mark.parametrize("core", [rounded_core, chamfered_core])
    def test_too_large(self, core):
        with pytest.raises(GeometryError, match="take a smaller"):
            core(rectangle(0.4, 0.2), 0.1)


class TestOverlapDepth:
    @pytest.mark.parametrize("shift", [-0.3, -0.001, 0.0, 0.001, 0.3])
    def test_rectangles_side_by_side(self, shift):
        a, b = rectangle(1.0, 1.0), rectangle(1.0, 1.0, x=1.0 + shift)
        assert overlap_depth(a, b) == pytest.approx(-shift, abs=ROUNDING)

    @given(st.lists(convex_polygons(), min_size=2, max_size=6), angles, shifts)
    def test_many_at_once_are_the_same_as_one_by_one(self, polygons, angle, shift):
        polygons = [moved(p, angle * i, np.array(shift) * 0.01 * i) for i, p in enumerate(polygons)]
        outlines = Outlines.pack([[polygon] for polygon in polygons])
        a, b = np.triu_indices(len(polygons), k=1)
        one_by_one = [overlap_depth(polygons[i], polygons[j]) for i, j in zip(a, b, strict=True)]
        assert outlines.overlap_depths(a, b) == pytest.approx(one_by_one, abs=1e-10)


def test_rounded_corner_at_the_tip_of_a_needle():
    """The edges run back on themselves, to rounding: nothing is left, and nothing is divided."""
    needle = np.array([[0.0, 0.0], [1.0, 0.0], [1e9, 1e-9], [0.0, 1.0]])
    with np.errstate(all="raise"), pytest.raises(GeometryError, match="leaves nothing"):
        rounded_core(needle, 0.1)
