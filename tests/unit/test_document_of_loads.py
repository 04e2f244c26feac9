"""The report of structures with ties and dead loads, and of supports that move."""

from __future__ import annotations

import re
from datetime import UTC, datetime

import numpy as np
import pytest

import drystone as ds
from drystone.report.document.report import render
from drystone.report.viewer.folder import Folder
from pages import text_of, unfolded
from piers import piers

DATE = datetime(2024, 5, 6, 7, 8, tzinfo=UTC)


def folder_of(model, path):
    ds.save_results(ds.pushover(model), model, path)
    return Folder.read(path)


@pytest.fixture(scope="module", params=["plane", "space"])
def loaded(request, tmp_path_factory):
    model = piers(title="Piers", control_block="left")
    model = ds.extruded(model) if request.param == "space" else model
    model = model.with_analysis(max_displacement=0.02)
    return folder_of(model, tmp_path_factory.mktemp("loaded") / request.param)


def test_ties_are_in_the_tables(loaded):
    seen = text_of(render(loaded, date=DATE))
    curve, model = loaded.results.curve, loaded.results.model
    assert "Ties and springs" in seen
    assert "1e+07 N/m" in seen and "1 kN" in seen  # stiffness and strength
    assert "ground (-3," in seen and "left (0," in seen
    # What it carries at the peak and at the end, where it yields.
    row = curve.points.index(curve.peak)
    force = f"{curve.ties.force[row, 0] / 1e3:.4g} kN, {curve.ties.state(row, 0)}"
    assert f"anchor {force}" in seen
    assert curve.ties.state(-1, 0) == "yielding" and "1 kN, yielding" in seen
    assert len(model.ties) == 1


def test_dead_loads_are_in_the_tables(loaded):
    seen = text_of(render(loaded, date=DATE))
    up = "-1, 0, 0" if loaded.results.model.assembly.dimension == 3 else "-1, 0"
    assert "roof surcharge block “right”, at the top 40 kN down 1 no" in seen
    assert f"4 kN ({up}) 1 no" in seen


def test_pictures_show_ties_and_dead_loads_with_a_legend(loaded):
    page = render(loaded, date=DATE)
    states = re.search(r'<div class="states">(.*?)</div>', page, flags=re.S)[1]
    signs = text_of(re.search(r'<p class="legend">(.*?)</p>', page, flags=re.S)[1])
    assert "dead load" in signs and "yielding tie" in signs
    if loaded.results.model.assembly.dimension == 2:
        assert "stroke: #e07b00" in unfolded(states)  # the tie that yields
        assert unfolded(states).count("fill: #7a4b9a") >= 2  # arrows
    else:
        assert states.count("data:image/png") >= 2


def spreading(**more) -> ds.Model:
    """Two blocks that lean on each other, on supports of which one moves."""
    settlement = ds.Settlement(blocks=("g2",), **more)
    corners = {
        "g1": [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.0], [-1.0, 0.0]],
        "g2": [[1.0, -0.5], [3.0, -0.5], [3.0, 0.0], [1.0, 0.0]],
        "b": [[0.5, 0.0], [1.5, 0.0], [1.5, 0.5], [0.5, 0.5]],
    }
    blocks = [
        ds.Block(id=name, vertices=np.array(v), unit_weight=2e4, support=name != "b")
        for name, v in corners.items()
    ]
    joint = ds.JointLaw(friction_coefficient=0.6, normal_stiffness=1e9, shear_stiffness=1e9)
    return ds.make_model(blocks, joint=joint, thickness=1.0, settlement=settlement, title="Spread")


@pytest.mark.parametrize(
    ("motion", "unit", "force"),
    [
        ({"direction": np.array([0.0, -1.0]), "max": 0.05}, "[m]", "[N]"),
        ({"centre": np.array([1.0, 0.0]), "clockwise": True, "max": 3.0}, "[°]", "[N m]"),
    ],
    ids=["along", "about"],
)
def test_a_report_of_supports_that_move_speaks_of_them(tmp_path, motion, unit, force):
    found = folder_of(spreading(**motion), tmp_path / "out")
    page = render(found, date=DATE)
    seen = text_of(page)
    assert "Report of an analysis of supports that move" in seen
    assert f"motion of the supports {unit}" in seen and f"support reaction {force}" in seen
    for name in ("reaction at first", "least reaction", "greatest reaction", "reaction at last"):
        assert name in seen
    assert "as far as asked" in seen
    for other in (
        "peak",
        "λ",
        "stop multiplier",
        "sense of the load",
        "drystone assess",
        "Verdict",
    ):
        assert other not in seen, other


def test_the_same_in_italian(loaded, tmp_path):
    """Nothing of the tables is left in English, and decimals have their comma."""
    seen = text_of(render(loaded, language="it", date=DATE))
    for words in ("Tiranti e molle", "terreno (-3;", "snervato", "in sommità", "verso il basso"):
        assert words in seen, words
    moves_supports = folder_of(
        spreading(direction=np.array([0.0, -1.0]), max=0.05), tmp_path / "out"
    )
    seen = text_of(render(moves_supports, language="it", date=DATE))
    # Half a millimetre more or less of the 0.05 m asked for would be written otherwise.
    assert re.search(r"appoggi spostati di (0,050 m|50,00 mm)", seen)
    assert "reazione minima" in seen
