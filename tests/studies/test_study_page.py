"""The report of a study, and its extremes beside each other."""

from __future__ import annotations

import json
import re

import pytest
from test_study_findings import ISHIGAMI
from test_study_walls import STUDY, WALL
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from drystone.common.language import speaking
from drystone.studies.figures import indices, tornado
from studied import BASE, written


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


ITALIAN = """
[assessment]
method = "ntc2018-local"
language = "it"
"""
#: The block stands where it is at least 0.2 m wide: samples without a number are left out.
BLOCK = (
    BASE
    + """
[[block]]
id = "b"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.9], [-0.2, 0.9]]
[load]
pattern = "mass"
direction = [1.0, 0.0]
[analysis]
max_displacement = 0.02
"""
)
FRAGILE = """
    model = "block.toml"
    design = "grid"
    [[parameter]]
    path = "block.b.vertices[1][1]"
    range = [-0.2, 0.15]
    steps = 16
    [[fragility]]
    name = "peak"
    method = "capacity"
    capacity = "peak_multiplier"
    [[fragility]]
    name = "nothing"
    method = "capacity"
    capacity = "nothing"
"""


def text_of(page):
    """What a reader sees, but for the study file."""
    page = re.sub(r"<(style|pre)\b.*?</\1>", " ", page, flags=re.S)
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))


def test_a_report_tells_what_a_fragility_curve_leaves_out_and_why_there_is_none(tmp_path):
    (tmp_path / "block.toml").write_text(BLOCK)
    out = tmp_path / "out"
    ds.study(written(tmp_path, FRAGILE), out=out, workers=2, figures=False)
    peak, nothing = json.loads((out / "study.json").read_text())["fragility"]
    assert peak["n_left_out"] > 0
    assert CliRunner().invoke(app, ["report", str(out)]).exit_code == 0
    page = text_of((out / "report.html").read_text())
    assert f"peak capacity {peak['n']} {peak['n_left_out']} " in page
    assert f"not fitted: {nothing['reason'].replace(chr(34), '&#34;')}" in page


def test_a_report_is_in_the_language_that_the_model_asks_for(tmp_path):
    (tmp_path / "block.toml").write_text(BLOCK + ITALIAN)
    out, file = tmp_path / "out", written(tmp_path, FRAGILE)
    done = CliRunner().invoke(app, ["study", str(file), "--out", str(out), "--workers", "2"])
    assert "mediana" in done.stdout and "campioni esclusi" in done.stdout
    assert not re.search("median |samples|left out|not fitted|there is", done.stdout)
    assert CliRunner().invoke(app, ["report", str(out)]).exit_code == 0
    page = (out / "report.html").read_text()
    assert '<html lang="it">' in page
    told = text_of(page)
    assert "Effetti su peak_multiplier" in told and "la struttura non sta in piedi sotto" in told
    assert not re.search(r"\b(the|of|with|samples|reason|no equilibrium)\b", told)
    assert re.search(r"\b0,\d", told) and not re.search(r"[^0-9.]\d+\.\d+[^0-9.+]", told)

    english = tmp_path / "english.html"
    command = ["report", str(out), "--language", "en", "--out", str(english)]
    assert CliRunner().invoke(app, command).exit_code == 0
    assert "Effects on peak_multiplier" in english.read_text()
    pictures = [re.findall(r"data:image/png[^\"]*", p) for p in (page, english.read_text())]
    assert len(pictures[0]) == len(pictures[1]) > 1  # drawn again in that language
    assert not set(pictures[0]) & set(pictures[1])


def test_bars_of_figures_have_the_names_of_parameters_in_every_language():
    one = {"low_value": 0.5, "low": 1.0, "high_value": 0.8, "high": 2.0, "first": 0.5, "total": 0.6}
    one |= {"first_confidence": 0.1, "total_confidence": 0.1}
    found = {
        "effects": {"y": {"a": one}},
        "columns": {"y": {"mean": 1.5}},
        "indices": {"y": {"parameters": {"a": one}}},
    }
    with speaking("it"):
        for figure, axis in ((tornado(found, ""), "y"), (indices(found, ""), "x")):
            labels = getattr(figure.axes[0], f"get_{axis}ticklabels")()
            assert [label.get_text() for label in labels] == ["a"]


def test_a_search_that_has_found_a_jump_is_finished(tmp_path):
    search = """
    function = "FUNCTIONS:step"
    [target]
    output = "y"
    value = 3.0
    [[target.parameter]]
    path = "a"
    range = [0.0, 10.0]
    """
    out = tmp_path / "out"
    ds.study(written(tmp_path, search), out=out)
    assert json.loads((out / "study.json").read_text())["status"] == "jump"
    command = ["report", str(out), "--language", "it"]
    assert CliRunner().invoke(app, command).exit_code == 0
    page = text_of((out / "report.html").read_text())
    assert "y salta oltre 3: è 0 con a = " in page and "non è concluso" not in page


def test_what_hardly_changes_an_output_is_not_drawn_as_a_change():
    effect = {"low": 1.0 - 1e-6, "high": 1.0 + 1e-6, "low_value": 0.5, "high_value": 0.8}
    found = {
        "effects": {"peak_multiplier": {"friction": effect}},
        "columns": {"peak_multiplier": {"mean": 1.0}},
    }
    low, high = tornado(found, "").axes[0].get_xlim()
    assert high - low == pytest.approx(0.01)
    effect["low"], effect["high"] = 0.9, 1.5
    low, high = tornado(found, "").axes[0].get_xlim()
    assert high - low == pytest.approx(0.6 * 1.24)
