"""Plane models as solids."""

import numpy as np
import pytest

import drystone as ds


def test_an_extruded_wall_weighs_and_reaches_as_much():
    plane = ds.published_wall(1)
    solid = ds.extruded(plane)
    assert solid.assembly.dimension == 3
    assert solid.assembly.weight == pytest.approx(plane.assembly.weight, rel=1e-12)
    assert solid.assembly.centroid[:, [0, 2]] == pytest.approx(plane.assembly.centroid, abs=1e-12)
    assert np.ptp(solid.assembly.blocks[1].vertices[:, 1]) == plane.assembly.thickness
    assert solid.control_point.point[[0, 2]] == pytest.approx(plane.control_point.point)
    assert solid.load.direction == pytest.approx([1.0, 0.0, 0.0])


def test_only_plane_models_are_extruded():
    with pytest.raises(ValueError, match="one of space already"):
        ds.extruded(ds.extruded(ds.published_wall(1)))
