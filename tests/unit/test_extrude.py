"""Plane models as solids."""

import numpy as np
import pytest

import drystone as ds
from builders import rectangle


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
    with pytest.raises(ValueError, match="already in space"):
        ds.extruded(ds.extruded(ds.published_wall(1)))


def test_outlines_that_are_no_solids_are_refused():
    """Of an outline 200 km wide, two corners 0.2 m apart are one on the face of a solid."""
    base = np.array([[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]])
    wide = np.array([[-0.2, 0.0], [0.0002, 0.0], [0.2, 0.9], [-2e5, 0.9]])
    plane = ds.make_model(
        [
            ds.Block(id="base", vertices=base, unit_weight=2e4, support=True),
            ds.Block(id="b1", vertices=wide, unit_weight=2e4),
        ],
        joint=ds.JointLaw(friction_coefficient=0.65, normal_stiffness=1e9, shear_stiffness=1e9),
        thickness=1.0,
        load_direction=[1.0, 0.0],
    )
    with pytest.raises(ds.ModelError, match=r'as a solid, block "b1": face .* encloses no area'):
        ds.extruded(plane)


def test_a_control_point_that_nobody_named_may_move_in_space_too():
    """The thin wall falls at b/h; it was followed at the pier, which stands on to 0.75."""
    outlines = {"thin": rectangle(0.0, 0.0, 0.2, 1.5), "pier": rectangle(3.0, 0.0, 1.5, 2.0)}
    blocks = [
        ds.Block(
            id="base", vertices=rectangle(-1.0, -0.5, 7.0, 0.5), unit_weight=2e4, support=True
        ),
        *(ds.Block(id=name, vertices=v, unit_weight=2e4) for name, v in outlines.items()),
    ]
    joint = ds.JointLaw(friction_coefficient=0.8, normal_stiffness=1e10, shear_stiffness=1e10)
    plane = ds.make_model(blocks, joint=joint, thickness=1.0, load_direction=(1.0, 0.0))
    for model in (plane, ds.extruded(plane)):
        curve = ds.pushover(model)
        assert curve.peak.load_multiplier == pytest.approx(0.2 / 1.5, rel=1e-3)
        assert curve.control_point.block == model.assembly.index("thin")
