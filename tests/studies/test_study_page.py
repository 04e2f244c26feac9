"""The report of a study, and its extremes beside each other."""

from __future__ import annotations

import json

from test_study_findings import ISHIGAMI
from test_study_walls import STUDY, WALL
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from studied import written


def test_indices_are_reported_with_their_confidence(tmp_path):
    out = tmp_path / "out"
    file = written(tmp_path, ISHIGAMI.replace("1024", "16"))
    done = CliRunner().invoke(app, ["study", str(file), "--out", str(out), "--workers", "1"])
    assert done.exit_code == 0, done.output
    found = json.loads((out / "study.json").read_text())["indices"]["y"]
    own = found["parameters"]["b"]
    told = f"first {own['first']:.3g} ± {own['first_confidence']:.2g}, total {own['total']:.3g} ± "
    assert told in done.stdout
    assert CliRunner().invoke(app, ["report", str(out)]).exit_code == 0
    page = (out / "report.html").read_text()
    assert page.count("± 95 %") == 3 and f"{own['total_confidence']:.5g}" in page
    assert "Second-order indices of y" in page and "a with c" in page


def test_a_study_is_reported_and_its_extremes_are_compared(tmp_path):
    (tmp_path / "wall.toml").write_text(WALL)
    out = tmp_path / "out"
    ds.study(written(tmp_path, STUDY), out=out, workers=2)
    done = CliRunner().invoke(app, ["report", str(out)])
    assert done.exit_code == 0, done.output
    page = (out / "report.html").read_text()
    assert "Effects on peak_multiplier" in page and page.count("data:image/png") == 2
    picture = tmp_path / "compare.png"
    done = CliRunner().invoke(app, ["compare", str(out), "--out", str(picture), "--json"])
    assert done.exit_code == 0, done.output
    peaks = [curve["peak_multiplier"] for curve in json.loads(done.stdout)["curves"]]
    summary = json.loads((out / "study.json").read_text())["columns"]["peak_multiplier"]
    assert peaks == [summary["least"], summary["greatest"]]
