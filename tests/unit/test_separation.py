"""How far convex solids are apart: closed forms, and linear programs as a second opinion."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.optimize import linprog
from test_solids import random_hulls, rotation, seeds

from drystone.geometry.space.polyhedra import Polyhedra
from drystone.geometry.space.solid import box, face_planes, hull


def depth(p, q):
    solids = Polyhedra.pack([[p], [q]])
    (found,) = solids.overlap_depths(np.array([0]), np.array([1]))
    return found


CUBE = box([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])


def moved(solid, shift, turn=None):
    vertices, faces = solid
    return vertices @ (np.eye(3) if turn is None else turn).T + shift, faces


@given(seeds)
def test_cubes_at_any_angle(seed):
    rng = np.random.default_rng(seed)
    turn, far = rotation(rng), rng.uniform(-20.0, 20.0, 3)
    for shift, expected in [
        ((1.0, 0.0, 0.0), 0.0),
        ((0.9, 0.5, 0.2), 0.1),
        ((1.2, 0.5, 0.2), -0.2),
        ((0.4, 0.3, 0.8), 0.2),
    ]:
        p, q = moved(CUBE, far, turn), moved(moved(CUBE, shift), far, turn)
        assert depth(p, q) == pytest.approx(expected, abs=1e-12)
        assert depth(q, p) == pytest.approx(expected, abs=1e-12)


def test_edge_against_edge():
    # Two cubes turned by 45 degrees about x and about y: edges cross where they come near along z.
    s = np.sqrt(0.5)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, s, -s], [0.0, s, s]])
    about_y = np.array([[s, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, s]])
    centred = CUBE[0] - 0.5, CUBE[1]
    lower = moved(centred, (0.0, 0.0, 0.0), about_x)
    for gap in (-0.05, 1e-9, 0.02):
        upper = moved(centred, (0.0, 0.0, 2.0 * s + gap), about_y)
        assert depth(lower, upper) == pytest.approx(-gap, abs=1e-12)


@settings(deadline=None, max_examples=50)
@given(random_hulls(), random_hulls(), seeds)
def test_random_hulls_overlap_where_they_share_a_ball(one, other, seed):
    shift = np.random.default_rng(seed).uniform(-1.5, 1.5, 3)
    other = other - other.mean(axis=0) + one.mean(axis=0) + shift
    p, q = hull(one), hull(other)
    planes = [face_planes(*solid) for solid in (p, q)]
    # The largest ball in both: maximise r with n . x + r <= d for all faces.
    a = np.hstack((np.vstack([n for n, _ in planes]), np.ones((len(p[1]) + len(q[1]), 1))))
    d = np.concatenate([offset for _, offset in planes])
    found = linprog([0, 0, 0, -1.0], A_ub=a, b_ub=d, bounds=[(None, None)] * 4)
    by = depth(p, q)
    if abs(found.x[3]) > 1e-6:
        assert (by > 0.0) == (found.x[3] > 0.0)


def test_a_ridge_upon_a_ridge_across_it():
    """The normals of both bases lie along the axis that keeps both apart, but turned away."""
    roof = hull(np.array([
        [-1.0, -1.0, -1.0], [1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, -1.0],
        [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0],
    ]))  # fmt: skip
    upside_down = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    for gap in (-0.05, 0.0, 1e-9, 0.02):
        other = moved(roof, (0.0, 0.0, gap), upside_down)
        assert depth(roof, other) == pytest.approx(-gap, abs=1e-12)
        assert depth(other, roof) == pytest.approx(-gap, abs=1e-12)
