"""Contact reactions as vectors, in the plane and in space."""

from __future__ import annotations

import numpy as np
import pytest

from drystone.contact.forces import ContactForces

ROWS = {"block_a": np.zeros(2, int), "block_b": np.ones(2, int), "gap": np.zeros(2)}
REST = {"area": np.ones(2), "status": np.ones(2, int), "normal_reaction": np.array([5.0, 2.0])}


def test_in_the_plane_the_tangent_is_the_normal_turned_clockwise():
    normal = np.array([[0.0, 1.0], [0.6, 0.8]])
    shear = np.array([[1.0], [-1.0]])
    forces = ContactForces(
        position=normal, normal=normal, tangential_reaction=shear, **ROWS, **REST
    )
    assert forces.tangent.shape == (2, 0)
    # (0, 5) + (1, 0);  2 (0.6, 0.8) - (0.8, -0.6)
    assert forces.vectors() == pytest.approx(np.array([[1.0, 5.0], [0.4, 2.2]]))


def test_in_space_the_second_tangent_is_the_normal_across_the_first():
    normal, tangent = np.array([[0, 0, 1.0], [1.0, 0, 0]]), np.array([[1.0, 0, 0], [0, 0, 1.0]])
    shear = np.array([[3.0, 4.0], [0.5, 0.25]])
    forces = ContactForces(
        position=normal, normal=normal, tangential_reaction=shear, tangent=tangent, **ROWS, **REST
    )
    # z across x is y;  x across z is -y.
    assert forces.vectors() == pytest.approx(np.array([[3.0, 4.0, 5.0], [2.0, -0.25, 0.5]]))


def test_in_space_a_tangent_is_needed():
    normal = np.eye(3)[:2]
    with pytest.raises(ValueError, match="tangent"):
        ContactForces(
            position=normal, normal=normal, tangential_reaction=np.zeros((2, 2)), **ROWS, **REST
        )
