"""Assessment as an output of studies, of one sense and of both, as `drystone assess` has it."""

from __future__ import annotations

import json

import pandas as pd
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from studied import BASE, written

#: Upright at its right, leaning at its left: it turns over more easily towards its upright side.
LEANING = (
    BASE
    + """
[[block]]
id = "b1"
vertices = [[-0.4, 0.0], [0.2, 0.0], [0.2, 1.5], [0.0, 1.5]]
[load]
pattern = "mass"
direction = [-1.0, 0.0]
[site]
code = "ntc2018"
ag = 0.35
F0 = 2.45
TC_star = 0.32
soil = "A"
topography = "T1"
[assessment]
method = "ntc2018-local"
confidence_factor = 1.0
"""
)
STUDY = """
    model = "wall.toml"
    outputs = ["senses"]
    [[parameter]]
    path = "joint.friction_coefficient"
    values = [0.65]
    [[parameter]]
    path = "material.stone.unit_weight"
    values = [18e3, 20e3]
"""


def test_both_senses_are_those_of_assess(tmp_path):
    (tmp_path / "wall.toml").write_text(LEANING.replace("10e3", "20e3"))
    frame = ds.study(written(tmp_path, STUDY), out=tmp_path / "out", workers=1, figures=False)
    row = frame.iloc[1]
    done = CliRunner().invoke(
        app, ["assess", str(tmp_path / "wall.toml"), "--out", str(tmp_path / "one"), "--json"]
    )
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert row["governing_sense"] == found["governing_sense"] == "against the load"
    assert row["governing_safety_index"] == found["safety_index"]
    assert row["safety_index_against"] < row["safety_index"]
    for sense, ending in (("along the load", ""), ("against the load", "_against")):
        own = found["senses"][sense]
        for name in ("safety_index", "satisfied", "activation_multiplier"):
            assert row[name + ending] == own[name], name + ending
        for state, told in own["limit_states"].items():
            name = f"ground_acceleration_capacity_{state}{ending}"
            assert row[name] == told["ground_acceleration_capacity"]
    opposite = pd.read_csv(tmp_path / "one" / "opposite" / "curve.csv", comment="#")
    assert row["peak_multiplier_against"] == pytest.approx(
        opposite["load_multiplier"].max(), rel=1e-9
    )
    columns = json.loads((tmp_path / "out" / "study.json").read_text())["columns"]
    assert columns["governing_safety_index"]["n"] == 2


def test_where_the_other_sense_has_no_verdict_none_governs(tmp_path):
    """It ends before it says what it is capable of: the row says so, and keeps the first sense."""
    stop = "[analysis]\nmax_displacement = 0.55\n"
    (tmp_path / "wall.toml").write_text(
        LEANING.replace("direction = [-1.0", "direction = [1.0") + stop
    )
    frame = ds.study(written(tmp_path, STUDY), out=tmp_path / "out", workers=1, figures=False)
    row = frame.iloc[0]

    assert row["safety_index"] > 0.0
    assert row["reason"].count("against the load: ") == 1
    assert pd.isna(row["governing_sense"]) and pd.isna(row["governing_safety_index"])


def test_a_sample_without_a_verdict_keeps_its_curve_and_its_limit(tmp_path):
    (tmp_path / "wall.toml").write_text(LEANING + "[analysis]\nmax_displacement = 0.05\n")
    study = STUDY.replace('outputs = ["senses"]', 'outputs = ["curve", "limit", "assess"]')
    out = tmp_path / "out"
    frame = ds.study(written(tmp_path, study), out=out, workers=1, figures=False)
    for _, row in frame.iterrows():
        assert row["status"] == "finished" and "no verdict: " in row["reason"]
        assert pd.isna(row["safety_index"])
        assert 0.99 < row["peak_multiplier"] / row["limit_associative"] < 1.0
