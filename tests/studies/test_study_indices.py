"""Indices of a wall: as good with half as many samples, and the same whenever they are computed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import drystone as ds
from drystone.studies import indices
from drystone.studies.read import read_study
from studied import written

WALL = Path(__file__).parents[2] / "examples" / "wall1.toml"
#: Base samples of the finer of two estimates; each has five runs.
N = 512
STUDY = f"""
    model = "wall1.toml"
    design = "saltelli"
    samples = {N}
    seed = 1
    [[parameter]]
    path = "joint.friction_coefficient"
    name = "friction"
    range = [0.4, 0.9]
    [[parameter]]
    path = "wall.unit[2]"
    name = "height"
    range = [0.14, 0.21]
    [[parameter]]
    path = "joint.normal_stiffness"
    name = "stiffness"
    range = [0.5e8, 2e8]
"""
#: m, beyond every peak of the study.
FAR = 0.03


@pytest.mark.slow
def test_sobol_indices_of_wall_1_are_stable_from_n_to_2n(tmp_path):
    """The first half of a Sobol sequence is a design of its own."""
    text = WALL.read_text().replace("[analysis]", f"[analysis]\nmax_displacement = {FAR}")
    (tmp_path / "wall1.toml").write_text(text)
    file = written(tmp_path, STUDY)
    frame = ds.study(file, out=tmp_path / "out", figures=False)
    assert frame["certified"].all()
    assert frame["peak_displacement"].max() < 0.8 * FAR
    asked = read_study(file)
    peaks = frame["peak_multiplier"].to_numpy()
    whole = indices.sobol(asked, peaks)
    half = indices.sobol(replace(asked, n=N // 2), peaks[: len(peaks) // 2])
    for name, own in whole["parameters"].items():
        for key in ("first", "total"):
            assert abs(own[key] - half["parameters"][name][key]) < 0.02, (name, key)
            assert 0.0 < own[f"{key}_confidence"] < half["parameters"][name][f"{key}_confidence"]
    total = {name: own["total"] for name, own in whole["parameters"].items()}
    assert total["friction"] > total["height"] > 100.0 * total["stiffness"]
