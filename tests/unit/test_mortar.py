"""Mortar as stiffness: k_n = E / t, k_s = G / t, the same in files and in Python."""

import pytest
from test_modelfile import changed, problems, read, with_pair

import drystone as ds

MORTAR = "[joint.mortar]\nthickness = 0.01\nyoung_modulus = 2e9\n"
STIFFNESS = "normal_stiffness = 1e8\nshear_stiffness = 1e11\n"


def with_mortar(*lines):
    return changed(STIFFNESS, "").replace("[corner]", MORTAR + "\n".join([*lines, "", "[corner]"]))


@pytest.mark.parametrize(
    ("key", "given", "shear"),
    [("shear_modulus", 8e8, 8e10), ("poisson_ratio", 0.25, 8e10), ("poisson_ratio", 0.0, 1e11)],
)
def test_by_hand_and_from_a_file(tmp_path, key, given, shear):
    """G = E / 2 (1 + nu) = 0.8 GPa at nu = 0.25; over 10 mm 2e11 and 8e10 Pa/m."""
    joint = read(tmp_path, with_mortar(f"{key} = {given}")).assembly.joint
    assert (joint.normal_stiffness, joint.shear_stiffness) == pytest.approx((2e11, shear))
    mortar = ds.Mortar(thickness=0.01, young_modulus=2e9, **{key: given})
    assert ds.JointLaw(friction_coefficient=0.65, **mortar.stiffnesses) == joint


def test_of_a_pair_goes_before_stiffnesses_of_all_joints(tmp_path):
    lines = ["thickness = 0.02", "young_modulus = 1e9", "shear_modulus = 4e8"]
    text = with_pair('"base b1".mortar', *lines)
    assembly = read(tmp_path, text).assembly
    law = assembly.joint_between[frozenset({"base", "b1"})]
    assert (law.normal_stiffness, law.shear_stiffness) == pytest.approx((5e10, 2e10))
    assert assembly.joint.normal_stiffness == 1e8


def test_what_is_refused(tmp_path):
    both = with_mortar("shear_modulus = 1e9", "poisson_ratio = 0.2")
    assert problems(tmp_path, both) == [
        "joint.mortar: has both shear_modulus [Pa] and poisson_ratio: give one of them"
    ]
    twice = changed("[corner]", MORTAR + "poisson_ratio = 0.2\n\n[corner]")
    assert problems(tmp_path, twice) == [
        "joint: has both mortar and normal_stiffness: leave one of them out"
    ]
    with pytest.raises(ValueError, match="neither shear_modulus"):
        ds.Mortar(thickness=0.01, young_modulus=2e9)
    with pytest.raises(ValueError, match="thickness: must be greater than 0"):
        ds.Mortar(thickness=0.0, young_modulus=2e9, poisson_ratio=0.2)
