"""Joints that soften, are crushed and close: their keys in files, and what does not go together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_modelfile import changed, problems, read, with_pair

from builders import stack
from drystone.analysis.driver import pushover
from drystone.io.modelfile import read_model, write_model
from drystone.model.construction.checks import law_problems
from drystone.model.joint_law import JointLaw

LAW = JointLaw(
    friction_coefficient=0.65,
    normal_stiffness=1e9,
    shear_stiffness=1e9,
    cohesion=2e4,
    tensile_strength=1e4,
    tensile_fracture_energy=5.0,
    shear_fracture_energy=20.0,
    residual_friction_coefficient=0.5,
    compressive_strength=5e5,
    compressive_fracture_energy=800.0,
)
KEYS = {
    key: value
    for key, value in vars(LAW).items()
    if value not in (None, np.inf, 0.0) and key != "friction_coefficient"
}


def lines(keys):
    return [f"{key} = {value}" for key, value in keys.items()]


def test_the_same_in_files_and_in_python(tmp_path):
    text = with_pair('"base b1"', *lines(KEYS))
    assembly = read(tmp_path, text).assembly
    assert assembly.joint_between[frozenset({"base", "b1"})] == LAW


@pytest.mark.parametrize("points", [2, 9])
def test_a_model_that_is_written_is_read_as_it_was(tmp_path, points):
    model = stack((0.5, 1.0), joint=LAW, points=points)
    write_model(model, tmp_path / "model.toml")
    again = read_model(tmp_path / "model.toml").assembly
    assert again.joint == LAW
    assert again.points == points


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"shear_fracture_energy": None}, "shear_fracture_energy: is missing beside"),
        ({"tensile_fracture_energy": None}, "tensile_fracture_energy: is missing beside"),
        ({"tensile_strength": 0.0}, "tensile_fracture_energy: there is no tensile_strength"),
        ({"cohesion": 0.0}, "shear_fracture_energy: there is no cohesion"),
        ({"tensile_fracture_energy": 0.09}, "tensile_fracture_energy: 0.09 N/m is less than"),
        ({"shear_fracture_energy": 0.3}, "shear_fracture_energy: 0.3 N/m is less than"),
        ({"compressive_fracture_energy": 200.0}, "compressive_fracture_energy: 200 N/m is less"),
        ({"compressive_strength": np.inf}, "compressive_fracture_energy: there is no"),
        ({"residual_friction_coefficient": 0.7}, "residual_friction_coefficient: 0.7 is more"),
        ({"residual_slip": 1e-3}, "residual_slip: friction falls as the bond softens"),
        ({"dilatancy_angle": 5.0}, "dilatancy_angle: joints that soften do not dilate"),
        ({"greatest_closure": 1e-3}, "greatest_closure: joints that are crushed close linearly"),
        ({"logarithmic_closure": 1e-3}, "logarithmic_closure: joints that are crushed close lin"),
        (
            {"tensile_fracture_energy": None, "shear_fracture_energy": None},
            "cohesion: joints that are crushed have no brittle bonds",
        ),
    ],
)
def test_what_does_not_go_together(values, said):
    found = law_problems(replace(LAW, **values))
    assert any(problem.startswith(said) for problem in found), found


def test_a_law_that_goes_together_has_no_problem():
    assert law_problems(LAW) == []
    slips = JointLaw(
        friction_coefficient=0.6,
        normal_stiffness=1e9,
        shear_stiffness=1e9,
        residual_friction_coefficient=0.4,
        residual_slip=1e-3,
        greatest_closure=1e-3,
    )
    assert law_problems(slips) == []
    assert law_problems(replace(slips, residual_slip=None)) != []


def test_files_name_the_place(tmp_path):
    text = changed("shear_stiffness = 1e11\n", "shear_stiffness = 1e11\nresidual_slip = 1e-3\n")
    (found,) = problems(tmp_path, text)
    assert found.startswith("joint.residual_slip: there is no residual_friction_coefficient")


@pytest.mark.parametrize("points", [1, 65])
def test_numbers_of_points(tmp_path, points):
    text = changed("[corner]", f"[contact]\npoints = {points}\n\n[corner]")
    assert problems(tmp_path, text) == [
        f"contact.points: must be from 2 to 64 in the plane, it is {points}"
    ]


def test_a_structure_ten_times_as_large_has_the_same_curve():
    """Lengths and strengths times ten, fracture energies times a hundred, stiffnesses as they are:
    with weights that grow with the volume all ratios of forces stay."""

    def curve(scale):
        law = replace(
            LAW,
            cohesion=LAW.cohesion * scale,
            tensile_strength=LAW.tensile_strength * scale,
            tensile_fracture_energy=LAW.tensile_fracture_energy * scale**2,
            shear_fracture_energy=LAW.shear_fracture_energy * scale**2,
            compressive_strength=LAW.compressive_strength * scale,
            compressive_fracture_energy=LAW.compressive_fracture_energy * scale**2,
        )
        model = stack((0.5 * scale, 1.0 * scale), joint=law, points=5)
        return pushover(model, max_displacement=2e-3 * scale)

    small, large = curve(1.0), curve(10.0)
    assert small.peak.load_multiplier > 0.6
    for name, scale in (("load_multiplier", 1.0), ("control_displacement", 10.0)):
        # Frames are decimal numbers: the same problem but for their last digits.
        assert large.column(name) == pytest.approx(scale * small.column(name), rel=1e-5, abs=1e-9)
