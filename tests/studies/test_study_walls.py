"""Studies of walls: rows are those of `ds.pushover`, imperfect blocks fit, samples run again."""

from __future__ import annotations

import json
import math
import tomllib
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

import drystone as ds
from drystone.cli.study import report
from drystone.model.assembly import Block, Corner
from drystone.model.builders import coursed_wall
from drystone.studies.conduct import extremes_of, run_again
from drystone.studies.errors import StudyError
from drystone.studies.imperfections import imperfect
from drystone.studies.read import read_study
from drystone.studies.study import Imperfection
from studied import BASE, HEAD, assert_same, command, written

WALL = (
    HEAD
    + """
[corner]
radius = 0.02
[wall]
unit = [0.4, 0.175]
courses = ["h1h", "11"]
repeat = 2
base = true
[load]
pattern = "mass"
direction = [1.0, 0.0]
[analysis]
max_displacement = 0.02
"""
)
STUDY = """
    model = "wall.toml"
    design = "lhs"
    samples = 4
    outputs = ["curve", "limit"]
    points = 16
    [[parameter]]
    path = "joint.friction_coefficient"
    range = [0.5, 0.8]
    [[parameter]]
    path = "wall.unit[2]"
    apply = "multiply"
    range = [0.9, 1.1]
    [imperfection]
    unit_sizes = 0.05
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "wall.toml").write_text(WALL)
    return lambda text=STUDY: written(tmp_path, text)


def test_rows_are_those_of_pushover(study, tmp_path):
    frame = ds.study(study(STUDY.replace("[imperfection]\n    unit_sizes = 0.05", "")),
                     out=tmp_path / "out", workers=2)  # fmt: skip
    row = frame.iloc[2]
    text = WALL.replace("0.65", repr(float(row["joint.friction_coefficient"])))
    text = text.replace("0.175", repr(0.175 * float(row["wall.unit[2]"])))
    (tmp_path / "one.toml").write_text(text)
    curve = ds.pushover(ds.read_model(tmp_path / "one.toml"), progress=False)
    assert row["peak_multiplier"] == curve.peak.load_multiplier
    assert row["max_residual"] == curve.residual.max()
    assert row["status"] == curve.status
    curves = pd.read_parquet(tmp_path / "out" / "curves.parquet")
    own = curves[curves["sample"] == 2]
    assert len(own) == 16
    assert own["control_displacement"].iloc[-1] == curve.control_displacement[-1]
    assert (tmp_path / "out" / "bands.png").exists()


def test_directions_and_control_blocks_are_parameters(study, tmp_path):
    """A grid of both: what is no number stands in its column as JSON."""
    text = STUDY[: STUDY.index("[[parameter]]")].replace(', "limit"', "")
    text = text.replace('"lhs"', '"grid"').replace("samples = 4", "")
    for path, values in (
        ("load.direction", [[1.0, 0.0], [-1.0, 0.0]]),
        ("control.block", ["c4u1", "c4u2"]),
    ):
        text += f"    [[parameter]]\n    path = '{path}'\n    values = {json.dumps(values)}\n"
    frame = ds.study(study(text), out=tmp_path / "out", workers=1, figures=False)
    assert frame["load.direction"].tolist() == ["[1.0, 0.0]"] * 2 + ["[-1.0, 0.0]"] * 2
    for row in frame.to_dict("records"):
        data = tomllib.loads(WALL)
        data["load"]["direction"] = json.loads(row["load.direction"])
        data["control"] = {"block": row["control.block"]}
        (tmp_path / "one.json").write_text(json.dumps(data))
        curve = ds.pushover(ds.read_model(tmp_path / "one.json"), progress=False)
        assert row["peak_displacement"] == curve.peak.control_displacement


def test_imperfect_walls_are_the_same_whatever_the_workers_and_run_again_alone(study, tmp_path):
    file = study()
    frame = ds.study(file, out=tmp_path / "one", workers=1, figures=False)
    ds.study(file, out=tmp_path / "two", workers=2, figures=False)
    assert_same(tmp_path / "one", tmp_path / "two")
    assert frame["certified"].sum() == 4 or set(frame["status"]) == {"stopped"}
    process = command(file, "--out", tmp_path / "one", "--sample", 3, "--json")
    out, told = process.communicate()
    assert process.returncode == 0, told
    summary = json.loads((tmp_path / "one" / "sample_3" / "summary.json").read_text())
    assert json.loads(out)["directory"].endswith("sample_3")
    assert summary["peak_multiplier"] == frame["peak_multiplier"][3]
    again = ds.read_model(tmp_path / "one" / "sample_3" / "model.toml")
    assert again.assembly.n_blocks == 10


SEARCH = """
    [imperfection]
    unit_sizes = 0.05
    [target]
    output = "peak_multiplier"
    value = 0.55
    tolerance = 0.1
    [[target.parameter]]
    path = "joint.friction_coefficient"
    range = [0.3, 0.8]
"""


def summary_of(folder, sample):
    return json.loads((folder / f"sample_{sample}" / "summary.json").read_text())


@pytest.mark.parametrize("design", ["saltelli", "target"])
def test_samples_of_one_seed_are_of_one_wall_and_run_again_alone(study, tmp_path, design):
    """Rows of matrix A, and runs of a search; the numbers are those of the stored seed."""
    text = STUDY.replace(', "limit"', "").replace("lhs", "saltelli").replace("4", "1", 1)
    if design == "target":
        kept = [line for line in text.splitlines() if "design" not in line and "samp" not in line]
        text = "\n".join(kept[: kept.index("    [[parameter]]")]) + SEARCH
    file, out = study(text), tmp_path / "out"
    frame = ds.study(file, out=out, workers=1, figures=False)
    first = frame[frame["seed"] == frame["seed"][0]]
    assert len(first) == (3 if design == "saltelli" else len(frame)) > 2
    asked = read_study(file)
    for sample in (1, len(frame) - 1):
        run_again(asked, out, sample)
        assert summary_of(out, sample)["peak_multiplier"] == frame["peak_multiplier"][sample]
        assert asked.task.seed_at(sample) == frame["seed"][sample]
    with pytest.raises(StudyError, match=f"samples 0 to {len(frame) - 1}: give one"):
        run_again(asked, out, len(frame))


def test_a_sample_of_another_study_is_not_run_again_beside_it(study, tmp_path):
    file, out = study(STUDY.replace("samples = 4", "samples = 1")), tmp_path / "out"
    ds.study(file, out=out, workers=1, figures=False)
    (tmp_path / "wall.toml").write_text(WALL.replace("0.65", "0.7"))
    process = command(file, "--out", out, "--sample", 0)
    _, told = process.communicate()
    assert process.returncode != 0 and "they differ in the model: choose another folder" in told
    assert not (out / "sample_0").exists()


def test_extremes_are_those_of_the_stored_seeds(study, tmp_path):
    """As of a folder whose seeds an earlier version derived in another way."""
    text = STUDY.replace(', "limit"', "").replace("samples = 4", "samples = 1")
    out = tmp_path / "out"
    frame = ds.study(study(text), out=out, workers=1, figures=False)
    frame.assign(seed=frame["seed"] + 1).to_parquet(out / "samples.parquet")
    (own,) = extremes_of(out)
    again = json.loads((own / "summary.json").read_text())["peak_multiplier"]
    assert again != frame["peak_multiplier"][0]


def test_a_model_that_cannot_be_built_is_recorded_with_its_model(study, tmp_path):
    text = STUDY.replace("range = [0.5, 0.8]", "values = [0.6, -1.0]")
    frame = ds.study(study(text), out=tmp_path / "out", workers=1, figures=False)
    failed = pd.read_parquet(tmp_path / "out" / "failures.parquet")
    assert (frame["status"] == "failed").sum() == 2 == len(failed)
    assert "friction_coefficient" in failed["reason"][0]
    assert json.loads(failed["model"][0])["joint"]["friction_coefficient"] == -1.0


def test_a_sample_that_takes_too_long_is_stopped(study, tmp_path):
    text = STUDY.replace("points = 16", "timeout = 1e-6")
    frame = ds.study(study(text), out=tmp_path / "out", workers=1, figures=False)
    assert set(frame["status"]) == {"stopped"}
    assert frame["reason"].str.contains("took longer than the timeout").all()
    assert not frame["certified"].any()


def blocks():
    return coursed_wall(unit=(0.4, 0.2), courses=["h11h", "111"], unit_weight=1.0, repeat=2,
                        base=True)  # fmt: skip


def test_uneven_units_fill_their_courses():
    made = imperfect(blocks(), Imperfection(unit_sizes=0.05), seed=4)
    courses = {}
    for block in made[1:]:
        courses.setdefault(block.id.split("u")[0], []).append(block.vertices)
    top = 0.0
    for own in courses.values():
        low, high = np.array(own).min(axis=(0, 1)), np.array(own).max(axis=(0, 1))
        assert (low[0], high[0]) == pytest.approx((0.0, 1.2)) and low[1] == top
        assert abs((high[1] - low[1]) / 0.2 - 1.0) <= 0.05
        for left, right in pairwise(own):
            assert left[1, 0] == right[0, 0]
        top = high[1]
    lengths = np.array([np.ptp(v[:, 0]) for v in courses["c2"]])
    assert np.ptp(lengths) > 0.001
    assert (made[0].vertices == blocks()[0].vertices).all()


def test_missing_and_loose_blocks_are_as_many_as_asked():
    many = [b for k in range(60) for b in imperfect(blocks(), Imperfection(missing=0.2), k)]
    assert len(many) / (60 * 15) == pytest.approx(1 - 0.2 * 14 / 15, abs=0.04)
    (one,) = [b for b in imperfect(blocks(), Imperfection(loose=1.0, loose_gap=0.01), 1)
              if b.id == "c1u2"]  # fmt: skip
    assert one.vertices.min(axis=0) == pytest.approx([0.21, 0.0])
    assert one.vertices.max(axis=0) == pytest.approx([0.59, 0.19])


def test_worn_corners_overlap_nothing_and_leave_joints_where_they_are():
    before = {block.id: block.vertices for block in blocks()}
    for block in imperfect(blocks(), Imperfection(vertices=0.002), 1)[1:]:
        old, new = before[block.id], block.vertices
        assert len(new) == 8  # two of each corner, one on each of its edges
        low, high = old.min(axis=0), old.max(axis=0)
        assert ((new >= low) & (new <= high)).all()
        assert (((new == low) | (new == high)).sum(axis=1) == 1).all()


def test_outlines_that_run_clockwise_are_worn_as_the_others():
    drawn = [Block(id=b.id, vertices=b.vertices[::-1], unit_weight=1.0) for b in blocks()[1:]]
    for block in imperfect(drawn, Imperfection(vertices=0.002), 1):
        assert len(block.vertices) == 8 and block.figure().volume > 0.0
    line = Block(id="line", vertices=[[0, 0], [1, 0], [2, 0]], unit_weight=1.0)
    with pytest.raises(StudyError, match='block "line": the outline encloses no area'):
        imperfect([line], Imperfection(vertices=0.002), 1)


def test_corners_that_are_rounded_off_by_more_stay():
    """A right corner of radius r takes off what a cut of r (2 - sqrt 2) does."""
    kept = 0.02 * (2.0 - 2.0**0.5)
    sharp = imperfect(blocks(), Imperfection(vertices=0.01), 1)
    rounded = imperfect(blocks(), Imperfection(vertices=0.01), 1, Corner(radius=0.02))
    cuts = [abs(block.vertices[k] - block.vertices[k + 1]).max()
            for block in sharp[1:] for k in range(0, 8, 2)]  # fmt: skip
    left = sum(len(block.vertices) - 4 for block in rounded[1:])
    assert 0 < left == sum(cut > kept for cut in cuts) < len(cuts)
    with pytest.raises(StudyError, match="chamfer: take one of them"):
        imperfect(blocks(), Imperfection(vertices=0.01), 1, Corner(chamfer=0.02))


ALONE = (
    BASE.replace("0.65", "2.0").replace("1e8", "1e12").replace("1e11", "1e12")
    + """
[[block]]
id = "b1"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 1.0], [-0.2, 1.0]]
[load]
pattern = "mass"
direction = [1.0, 0.0]
[analysis]
max_displacement = 0.02
"""
)


def test_a_block_turns_about_its_worn_toe(tmp_path):
    """Peak: from the centre of mass to the toe, over the height of the centre of mass."""
    (tmp_path / "wall.toml").write_text(ALONE)
    text = STUDY.replace("unit_sizes = 0.05", "vertices = 0.02").replace(', "limit"', "")
    text = text[: text.index("[[parameter]]")] + text[text.index("[imperfection]") :]
    file = written(tmp_path, text.replace('"lhs"', '"random"'))
    frame = ds.study(file, out=tmp_path / "out", workers=1, figures=False)
    designed = ds.read_model(tmp_path / "wall.toml")
    base, block = designed.assembly.blocks
    for seed, peak in zip(frame["seed"], frame["peak_multiplier"], strict=True):
        _, own = imperfect([base, block], Imperfection(vertices=0.02), seed)
        centre = own.figure().centroid
        toe = own.vertices[own.vertices[:, 1] == 0.0][:, 0].max()
        assert toe < 0.2 and peak == pytest.approx((toe - centre[0]) / centre[1], rel=1e-3)


def test_uneven_units_are_of_courses():
    leaning = Block(id="a", vertices=[[0, 0], [1, 0], [1.2, 1], [0, 1]], unit_weight=1.0)
    with pytest.raises(StudyError, match="courses of rectangles"):
        imperfect([leaning], Imperfection(unit_sizes=0.1), 1)


def test_peaks_that_no_curve_passes_are_told(study, tmp_path):
    """Of walls that are pushed by 0.1 mm."""
    file = study()
    text = (tmp_path / "wall.toml").read_text()
    (tmp_path / "wall.toml").write_text(text.replace("= 0.02\n", "= 1e-4\n"))
    process = command(file, "--out", tmp_path / "out", "--workers", 1)
    told, _ = process.communicate(timeout=120)
    assert process.returncode == 0
    assert "not passed in 4 of 4: there peak_multiplier is the highest so far" in told
    assert not pd.read_parquet(tmp_path / "out" / "samples.parquet")["peak_passed"].any()


def test_a_study_of_which_nothing_is_finished_says_why(study, tmp_path):
    text = (tmp_path / "wall.toml").read_text()
    (tmp_path / "wall.toml").write_text(text.replace("max_displacement = 0.02", "max_steps = 2"))
    process = command(study(), "--out", tmp_path / "out", "--workers", 1)
    told, _ = process.communicate(timeout=120)
    assert process.returncode == 3
    assert "4 times: the limit of 2 steps was reached" in told


SINKING = (
    BASE
    + """
[[block]]
id = "far"
vertices = [[-2.4, -0.2], [-2.0, -0.2], [-2.0, 0.0], [-2.4, 0.0]]
support = true
[[block]]
id = "b"
vertices = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.3], [-0.2, 0.3]]
[settlement]
blocks = ["base"]
direction = [0.0, -1.0]
max = 0.05
[[tie]]
name = "rod"
from = { block = "b", point = [-0.2, 0.15] }
to = { block = "ground", point = [-2.2, 0.15] }
stiffness = 1e7
yield_force = 100.0
compression = false
"""
)


def test_where_supports_move_the_reactions_are_the_outputs(tmp_path):
    """The rod takes of the weight what its slope lifts.  Such samples had a peak of one, which was
    said not to be passed."""
    (tmp_path / "wall.toml").write_text(SINKING)
    study = written(
        tmp_path,
        """
        model = "wall.toml"
        design = "grid"
        [[parameter]]
        path = "tie.rod.yield_force"
        values = [100.0, 400.0]
        """,
    )
    frame = ds.study(study, out=tmp_path / "out", workers=1)
    slope = 0.05 / math.hypot(2.0, 0.05)
    expected = 0.12 * 10e3 - slope * np.array([100.0, 400.0])
    assert frame["least_reaction"].to_numpy() == pytest.approx(expected, rel=1e-5)
    assert frame["stands"].tolist() == [True, True]
    assert frame["peak_multiplier"].isna().all()
    said = report(json.loads((tmp_path / "out" / "study.json").read_text()), tmp_path / "out")
    assert "peak" not in said
    assert "least_reaction" in said
