"""Studies of solids: rows are those of `ds.pushover`, imperfect solids stand, a target is met."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pandas as pd
import pytest

import drystone as ds
from drystone.geometry.space.solid import Part
from drystone.model.assembly import Block, Corner
from drystone.studies.errors import StudyError
from drystone.studies.imperfections import imperfect
from drystone.studies.study import Imperfection
from studied import assert_same, written

#: A pier of two storeys of two blocks each on a base; 0.4 m deep, 1.2 m high.
PIER = """
title = "Pier"
dimension = 3
[material.stone]
unit_weight = 20e3
[joint]
friction_coefficient = 0.6
normal_stiffness = 1e9
shear_stiffness = 1e9
[[block]]
id = "base"
box = [[-1.0, -1.0, -0.2], [1.6, 1.4, 0.0]]
support = true
""" + "".join(
    f"""
[[block]]
id = "c{row}u{column}"
box = [[{0.3 * column}, 0.0, {0.6 * row}], [{0.3 * column + 0.3}, 0.4, {0.6 * row + 0.6}]]
groups = ["row{row}"]
"""
    for row in range(2)
    for column in range(2)
)
LOAD = """
[load]
pattern = "mass"
direction = [0.0, 1.0, 0.0]
[control]
block = "c1u0"
point = "top"
direction = [0.0, 1.0, 0.0]
[analysis]
max_displacement = 0.05
"""
STUDY = """
    model = "pier.toml"
    design = "lhs"
    samples = 3
    points = 16
    [[parameter]]
    path = "joint.friction_coefficient"
    name = "friction"
    range = [0.5, 0.8]
    [[parameter]]
    path = ['block."c1*".box[2][2]']
    name = "depth"
    range = [0.3, 0.4]
"""
IMPERFECT = """
    [imperfection]
    vertices = 0.001
    loose = 0.3
    loose_gap = 0.002
    blocks = ["row1"]
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "pier.toml").write_text(PIER + LOAD)
    return lambda text: written(tmp_path, text)


def test_rows_of_solids_are_those_of_pushover(study, tmp_path):
    frame = ds.study(study(STUDY), out=tmp_path / "out", workers=2, figures=False)
    assert frame["certified"].all()
    for row in frame.itertuples():
        data = tomllib.loads(PIER + LOAD)
        data["joint"]["friction_coefficient"] = row.friction
        for block in data["block"][3:]:
            block["box"][1][1] = row.depth
        (tmp_path / "one.json").write_text(json.dumps(data))
        curve = ds.pushover(ds.read_model(tmp_path / "one.json"), progress=False)
        assert row.peak_multiplier == curve.peak.load_multiplier
        assert row.max_residual == curve.residual.max()


def test_imperfect_solids_are_the_same_whatever_the_workers_and_run_again_alone(study, tmp_path):
    file = study(STUDY + IMPERFECT)
    frame = ds.study(file, out=tmp_path / "one", workers=1, figures=False)
    ds.study(file, out=tmp_path / "two", workers=2, figures=False)
    assert_same(tmp_path / "one", tmp_path / "two")
    assert frame["certified"].all() and frame["peak_multiplier"].nunique() == 3
    from drystone.studies.conduct import run_again
    from drystone.studies.read import read_study

    own = run_again(read_study(file), tmp_path / "one", 1)
    summary = json.loads((own / "summary.json").read_text())
    assert summary["peak_multiplier"] == frame["peak_multiplier"][1]
    assert ds.read_model(own / "model.toml").assembly.n_blocks == 4


def box(low, high, **more):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    low, high = np.array(low), np.array(high)
    return Block(id="b", vertices=low + corners * (high - low), unit_weight=1.0, **more)


def test_worn_solids_lie_within_those_designed_and_leave_joints_where_they_are():
    """Three vertices of each corner, at a half normal distance along its edges."""
    low, high = np.zeros(3), np.array([0.6, 0.4, 0.3])
    cuts = []
    for seed in range(60):
        (worn,) = imperfect([box(low, high)], Imperfection(vertices=0.002), seed)
        new = worn.vertices
        assert len(worn.figure().parts) == 1 and ((new >= low) & (new <= high)).all()
        on_sides = np.isclose(new, low, atol=1e-12) | np.isclose(new, high, atol=1e-12)
        assert set(on_sides.sum(axis=1)) <= {2, 3}  # on an edge; a corner that is hardly worn
        ends = np.minimum(new - low, high - new).max(axis=1)
        cuts.extend(ends[on_sides.sum(axis=1) == 2])
    # of 480 corners the mean of |N(0, s)| has a deviation of 0.03 s
    assert np.mean(cuts) == pytest.approx(0.002 * np.sqrt(2.0 / np.pi), rel=0.12)


def test_a_worn_pyramid_is_closed():
    """Its apex is of four edges: the cut is flat all the same."""
    corners = np.array([[0, 0, 0], [0.4, 0, 0], [0.4, 0.4, 0], [0, 0.4, 0], [0.1, 0.2, 0.3]])
    pyramid = Block(id="p", vertices=corners, unit_weight=1.0)
    for seed in range(20):
        for corner in (Corner(), Corner(radius=0.003)):
            (worn,) = imperfect([pyramid], Imperfection(vertices=0.005), seed, corner)
            figure = worn.figure()
            assert figure.volume <= pyramid.figure().volume
            corner.cores(figure)


def test_blocks_of_several_parts_are_refused():
    parts = [Part(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) + [x, 0]) for x in (0.0, 1.0)]
    with pytest.raises(StudyError, match="is concave or of several parts"):
        imperfect([Block.of_parts(parts, id="b", unit_weight=1.0)], Imperfection(vertices=0.01), 1)


def test_a_loose_solid_is_free_by_the_gap_but_on_its_bed():
    (loose,) = imperfect(
        [box([0.0, 1.0, 2.0], [0.6, 1.4, 2.3])], Imperfection(loose=1.0, loose_gap=0.01), 1
    )
    assert loose.vertices.min(axis=0) == pytest.approx([0.01, 1.01, 2.0])
    assert loose.vertices.max(axis=0) == pytest.approx([0.59, 1.39, 2.29])


def test_missing_solids_leave_the_rest(study, tmp_path):
    text = STUDY.replace("samples = 3", "samples = 12") + (
        '    [imperfection]\n    missing = 0.4\n    blocks = ["c1u1"]\n'
    )
    frame = ds.study(study(text), out=tmp_path / "out", workers=2, figures=False)
    from drystone.studies.conduct import run_again
    from drystone.studies.read import read_study

    assert frame["certified"].all()
    counts = {
        ds.read_model(
            run_again(read_study(study(text)), tmp_path / "out", k) / "model.toml"
        ).assembly.n_blocks
        for k in range(3)
    }
    assert counts == {3, 4}


def test_a_target_of_solids_is_that_of_the_closed_form(tmp_path):
    """One block overturns at depth over height: 0.2 at a depth of 0.24 m, less what joints give."""
    one = PIER.split("\n[[block]]")[:2]
    wall = '\nid = "wall"\nbox = [[0.0, 0.0, 0.0], [0.6, 0.4, 1.2]]\n'
    text = (
        "\n[[block]]".join([*one, wall])
        .replace("1e9", "1e13")
        .replace("0.6\nnormal", "2.0\nnormal")
    )
    load = LOAD.replace("c1u0", "wall")
    (tmp_path / "pier.toml").write_text(text + load)
    file = written(
        tmp_path,
        """
    model = "pier.toml"
    [target]
    output = "peak_multiplier"
    value = 0.2
    [[target.parameter]]
    path = 'block.wall.box[2][2]'
    name = "depth"
    range = [0.1, 0.6]
    """,
    )
    frame = ds.study(file, out=tmp_path / "out", figures=False)
    found = json.loads((tmp_path / "out" / "study.json").read_text())
    assert found["value"] == pytest.approx(0.24, rel=1e-3)
    assert len(frame) == found["n_runs"] <= 8
    assert isinstance(frame, pd.DataFrame)
