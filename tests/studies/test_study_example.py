"""The study of the examples is read, and is what its page says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drystone.studies.read import read_study

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "wall1_study.toml"


def test_the_example_draws_friction_as_it_says():
    """Of 64 draws the standard error of the mean is 0.01."""
    study = read_study(EXAMPLE)
    assert study.count == 64 and study.task.names == ("friction",)
    assert study.task.imperfection is not None and study.task.imperfection.unit_sizes == 0.05
    assert abs(np.mean(study.values[0]) - 0.65) < 0.03
