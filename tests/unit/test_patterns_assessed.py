"""Load patterns as ground accelerations: what the reading of the base shear makes of each."""

from __future__ import annotations

import numpy as np
import pytest

import drystone as ds
from builders import rectangle
from drystone.assessment.errors import AssessmentError
from drystone.assessment.mechanism import reduced
from drystone.model.assembly import GRAVITY

RIGHT = np.array([1.0, 0.0])
WIDTH, HEIGHT = 0.5, 4.0
JOINT = ds.JointLaw(friction_coefficient=0.8, normal_stiffness=1e11, shear_stiffness=1e11)


def wall(load, courses=1, joint=JOINT, **more):
    """A wall of several courses that turns about its toe as one."""
    base = rectangle(-1.0, -0.5, 3.0, 0.5)
    blocks = [ds.Block(id="base", vertices=base, unit_weight=18e3, support=True)]
    for k in range(courses):
        outline = rectangle(0.0, HEIGHT * k / courses, WIDTH, HEIGHT / courses)
        blocks.append(ds.Block(id=f"b{k}", vertices=outline, unit_weight=18e3))
    return ds.make_model(blocks, joint=joint, thickness=1.0, load=load, **more)


def capacity_of(model, grouping="blocks"):
    curve = ds.pushover(model, keep_poses=True)
    return curve, reduced(curve, model, grouping=grouping, course=False).capacities["base_shear"]


def test_a_mass_pattern_is_divided_by_e_star():
    curve, capacity = capacity_of(wall(ds.MassPattern(direction=RIGHT), courses=4))
    ratio = capacity.participating_mass_ratio
    assert ratio == pytest.approx(3 * 16 / (4 * 16 - 1), rel=1e-3)
    peak = curve.peak.load_multiplier
    assert capacity.spectral_acceleration.max() == pytest.approx(peak * GRAVITY / ratio, rel=1e-12)


def test_forces_in_proportion_to_mass_and_shape_are_those_of_the_codes():
    """F*/m* = F_b/(Gamma m*), which is phi F/m*; F_b counted 1/e* twice."""
    model = wall(ds.TriangularPattern(direction=RIGHT), courses=4)
    curve, capacity = capacity_of(model)
    base_shear = curve.peak.load_multiplier * model.load_force
    wanted = base_shear / (capacity.participation_factor * capacity.equivalent_mass)
    # A course's own height is no part of its shape, by which its force is triangular: 1e-3.
    assert capacity.spectral_acceleration.max() == pytest.approx(wanted, rel=2e-3)
    whole = capacity_of(wall(ds.MassPattern(direction=RIGHT), courses=4))[1]
    assert capacity.spectral_acceleration.max() < 0.8 * whole.spectral_acceleration.max()


def test_accelerations_that_are_one_are_in_proportion_to_mass():
    every = tuple(ds.Acceleration(block=f"b{k}", acceleration=0.5 * RIGHT) for k in range(4))
    one = capacity_of(wall(ds.AccelerationPattern(entries=every), courses=4))[1]
    mass = capacity_of(wall(ds.MassPattern(direction=RIGHT), courses=4))[1]
    wanted = mass.spectral_acceleration.max()
    assert one.spectral_acceleration.max() == pytest.approx(wanted, rel=1e-6)


def test_of_one_body_every_pattern_gives_the_same_acceleration():
    """b/h g, of forces at the top as well: what counts is the work."""
    push = ds.PointForce(block="b0", force=1e4 * RIGHT, point=np.array([0.0, HEIGHT]))
    patterns = (
        ds.MassPattern(direction=RIGHT),
        ds.TriangularPattern(direction=RIGHT),
        ds.TiltPattern(direction=RIGHT),
        ds.ForcesPattern(entries=(push,)),
    )
    for pattern in patterns:
        capacity = capacity_of(wall(pattern), grouping="macro_blocks")[1]
        level = capacity.spectral_acceleration.max()
        assert level == pytest.approx(WIDTH / HEIGHT * GRAVITY, rel=2e-3), pattern.name


@pytest.mark.parametrize("what", ["a tie", "a load without mass", "a bond"])
def test_a_table_that_tilts_is_no_ground_where_something_does_not_turn(what):
    """A rod of 8 kN: the table tips at tan a = 0.657, the ground at b/h + T y/(W h) = 0.569."""
    more, joint = {}, JOINT
    if what == "a tie":
        more["ties"] = [
            ds.Tie(
                start=ds.TieEnd(block="b0", point=np.array([0.0, HEIGHT])),
                end=ds.TieEnd(point=np.array([-1.0, HEIGHT])),
                stiffness=2e8,
                yield_force=8e3,
                compression=False,
            )
        ]
    elif what == "a load without mass":
        push = {"force": np.array([0.0, -1e4]), "point": np.array([0.25, HEIGHT])}
        more["dead_loads"] = [ds.ForceLoad(block="b0", mass=False, **push)]
    else:
        joint = ds.JointLaw(
            friction_coefficient=0.8, normal_stiffness=1e11, shear_stiffness=1e11, cohesion=1e4,
            tensile_strength=1e4,
        )  # fmt: skip
    model = wall(ds.TiltPattern(direction=RIGHT), joint=joint, **more)
    with pytest.raises(AssessmentError, match="its multiplier is no ground acceleration here"):
        capacity_of(model)
