"""[target]: the value for which an output is reached, runs that are kept, and where none is."""

from __future__ import annotations

import json
import math
import random
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import drystone as ds
from drystone.studies import target
from drystone.studies.errors import StudyError
from studied import written

LINE = """
    function = "FUNCTIONS:line"
    [target]
    output = "y"
    value = 3.0
    tolerance = 1e-6
    [[target.parameter]]
    path = "a"
    range = [0.0, 10.0]
"""


def record(folder):
    return json.loads((folder / "study.json").read_text())


def test_a_line_is_met_where_it_lies(tmp_path):
    frame = ds.study(written(tmp_path, LINE), out=tmp_path / "out")
    found = record(tmp_path / "out")
    assert found["value"] == pytest.approx(1.5, rel=1e-6)
    assert found["n_runs"] == len(frame) <= 6
    assert (tmp_path / "out" / "target.png").exists()


def test_the_tolerance_is_of_the_parameter_and_the_sentence_tells_the_output_there(tmp_path):
    """An output a³ is off by three times as much; the same runs go on with a smaller tolerance."""
    off, cube = [], LINE.replace(":line", ":cube")
    for tolerance in (1e-2, 1e-6):
        file = written(tmp_path, cube.replace("1e-6", f"{tolerance:g}"))
        ds.study(file, out=tmp_path / "out", figures=False, resume=tolerance < 1e-2)
        found = record(tmp_path / "out")
        assert found["value"] == pytest.approx(3.0 ** (1.0 / 3.0), rel=tolerance)
        assert found["reached"] == pytest.approx(3.0, rel=3.05 * tolerance)
        assert found["sentence"].endswith(f", where the run gives {found['reached']:.6g}")
        off.append(abs(found["reached"] - 3.0))
    assert off[1] < off[0]


def test_runs_are_kept(tmp_path):
    file = written(tmp_path, LINE)
    first = ds.study(file, out=tmp_path / "out", figures=False)
    again = ds.study(file, out=tmp_path / "out", figures=False, resume=True)
    pd.testing.assert_frame_equal(first, again)


def test_a_search_that_runs_out_of_runs_says_how_far_it_is(tmp_path):
    text = LINE.replace(":line", ":step").replace("value = 3.0", "value = 3.0\n    most_runs = 5")
    ds.study(written(tmp_path, text), out=tmp_path / "out", figures=False)
    found = record(tmp_path / "out")
    assert found["status"] == "stopped" and found["n_runs"] == 5
    assert "stopped after 5 runs, with 0 at a = " in found["sentence"]
    assert " and 5 at " in found["sentence"]
    # As the sentence advises: it goes on with what it has.
    more = written(tmp_path, text.replace("most_runs = 5", "most_runs = 100"))
    ds.study(more, out=tmp_path / "out", figures=False, resume=True)
    found = record(tmp_path / "out")
    assert found["status"] == "jump" and found["n_runs"] > 5


def test_where_no_value_does_a_sentence_says_so(tmp_path):
    ds.study(written(tmp_path, LINE.replace("value = 3.0", "value = 21.0")), out=tmp_path / "out")
    found = record(tmp_path / "out")
    assert found["status"] == "none" and found["n_runs"] == 9
    assert found["sentence"] == (
        "no value of a from 0 to 10 gives y = 21: the nearest of 9 runs is 20 at 10"
    )


def test_a_jump_over_the_value_is_no_answer(tmp_path):
    """As where another mechanism takes over: 0 below a = 4, 5 above."""
    file = written(tmp_path, LINE.replace(":line", ":step"))
    ds.study(file, out=tmp_path / "out")
    found = record(tmp_path / "out")
    assert found["status"] == "jump" and found["value"] is None
    a, b = found["jump_at"]
    assert a < 4.0 <= b and b - a <= 2e-6 * 10.0
    assert found["sentence"].startswith("y jumps over 3: it is 0 at a = ")


def searched(output, tolerance=1e-3):
    """What a search of 0 to 10 for an output of 3 finds, and its runs."""
    runs = Tried(output)
    try:
        return target._root(runs, (0.0, 10.0), 3.0, tolerance, 10.0), runs
    except target._JumpError as jump:
        return jump.bracket, runs


class Tried:
    """Runs of a function, as a search knows them."""

    def __init__(self, output):
        self.output, self.known = output, {}
        self.output_at(0.0), self.output_at(10.0)

    def output_at(self, x):
        return self.known.setdefault(x, self.output(x))

    def pairs(self):
        return sorted(self.known.items())


def test_a_jump_is_located_in_twelve_runs():
    """Two ends, and nine halvings to 10/512, which is within plus or minus 1e-3 of the range."""
    chance = random.Random(3)
    for _ in range(200):
        place, low, high = chance.uniform(0, 10), chance.uniform(0, 2.9), chance.uniform(3.1, 6)
        slope = chance.uniform(-0.05, 0.05) * (high - low) / 10.0
        found, runs = searched(
            lambda x, p=place, a=low, b=high, s=slope: (b if x >= p else a) + s * (x - p)
        )
        a, b = found
        assert a < place <= b and b - a <= 0.02 and len(runs.known) <= 12


@pytest.mark.parametrize("width", [0.03, 0.3, 3.0])
def test_what_is_steep_is_no_jump(width):
    """3 + tanh((x - 10/3)/width) has the value, however steep it is beside the range."""
    found, runs = searched(lambda x: 3.0 + math.tanh((x - 10 / 3) / width))
    assert found == pytest.approx(10 / 3, rel=1e-3) and len(runs.known) <= 14


def test_an_unknown_output_says_the_nearest(tmp_path):
    with pytest.raises(StudyError, match="there is no"):
        ds.study(written(tmp_path, LINE.replace('"y"', '"x"')), out=tmp_path / "out")


def test_two_parameters_are_a_map(tmp_path):
    second = '    [[target.parameter]]\n    path = "b"\n    range = [0.0, 2.0]\n    steps = 5\n'
    ds.study(written(tmp_path, LINE + second), out=tmp_path / "out", workers=1)
    found = record(tmp_path / "out")
    assert found["n_runs"] == 9 * 5
    assert found["contour"] and all(2.0 * a + b == pytest.approx(3.0) for a, b in found["contour"])


def test_all_runs_of_a_search_have_the_seed_of_the_study(tmp_path):
    """y = a u, with u by the seed: a function of a, and of the study's seed."""
    text = LINE.replace(":line", ":noisy").replace("value = 3.0", "value = 0.1")
    frame = ds.study(written(tmp_path, text), out=tmp_path / "out", figures=False)
    assert frame["seed"].nunique() == 1
    slope = (int(frame["seed"][0]) % 2**20) / 2**20
    assert record(tmp_path / "out")["value"] == pytest.approx(0.1 / slope, rel=1e-6)
    other = written(tmp_path, "    seed = 2\n" + text, "other.toml")
    assert ds.study(other, out=tmp_path / "two", figures=False)["seed"][0] != frame["seed"][0]
    second = '    [[target.parameter]]\n    path = "b"\n    range = [0.0, 2.0]\n    steps = 3\n'
    both = written(tmp_path, text + second, "map.toml")
    frame = ds.study(both, out=tmp_path / "map", workers=1, figures=False)
    np.testing.assert_array_equal(frame["y"], frame["a"] * slope)


X, Y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")


@pytest.mark.parametrize(
    ("z", "line"),
    [
        (X, [[1.5, 0.0], [1.5, 1.0], [1.5, 2.0]]),
        (Y, [[0.0, 1.5], [1.0, 1.5], [2.0, 1.5], [3.0, 1.5]]),
        (X + Y, [[0.0, 1.5], [0.5, 1.0], [1.0, 0.5], [1.5, 0.0]]),
        (1.5 * X, [[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]]),
        (np.where(X == 2.0, np.nan, X), []),
    ],
    ids=["first parameter", "second parameter", "both", "through points", "no number"],
)
def test_the_line_on_a_map_is_found_along_either_parameter(z, line):
    assert target._crossings(X, Y, z, 1.5) == line


BLOCK = """
    title = "One block with a tie"
    outputs = ["curve", "assess"]
    [model]
    dimension = 2
    thickness = 1.0
    [model.material.stone]
    unit_weight = 20e3
    [model.joint]
    friction_coefficient = 2.0
    normal_stiffness = 1e13
    shear_stiffness = 1e13
    [[model.block]]
    id = "base"
    vertices = [[-2.0, -0.5], [2.0, -0.5], [2.0, 0.0], [-2.0, 0.0]]
    support = true
    [[model.block]]
    id = "wall"
    vertices = [[-0.05, 0.0], [0.05, 0.0], [0.05, 3.0], [-0.05, 3.0]]
    [[model.tie]]
    name = "rod"
    from = { block = "wall", point = [-0.05, 2.5] }
    to = { block = "ground", point = [-5.05, 2.5] }
    stiffness = 1e9
    yield_force = 5e3
    compression = false
    [model.load]
    pattern = "mass"
    direction = [1.0, 0.0]
    [model.site]
    code = "ntc2018"
    ag = 0.35
    F0 = 2.45
    TC_star = 0.32
    soil = "A"
    topography = "T1"
    [model.assessment]
    method = "ntc2018-local"
    confidence_factor = 1.0
    kinematics = "linear"
    [target]
    output = "safety_index"
    value = 1.0
    [[target.parameter]]
    path = "tie.rod.yield_force"
    range = [100.0, 10000.0]
"""


def test_the_tie_force_for_safety_index_1_is_that_of_the_closed_form(tmp_path):
    """Moments about the toe: lambda W h/2 = W b/2 + T z, and lambda = a_g S/q with S = 1, q = 2."""
    weight, width, height, z = 20e3 * 0.1 * 3.0, 0.1, 3.0, 2.5
    force = (0.35 / 2.0 * weight * height / 2.0 - weight * width / 2.0) / z
    ds.study(written(tmp_path, BLOCK), out=tmp_path / "out", figures=False)
    found = record(tmp_path / "out")
    assert found["value"] == pytest.approx(force, rel=1e-3)
    assert found["n_runs"] <= 12


#: The block again: what else than a force may be looked for, by its place in the model file.
LEVER = """
    path = ["tie.rod.from.point[2]", "tie.rod.to.point[2]"]
    name = "height of the tie"
    range = [0.5, 3.0]
"""
TOP = """
    path = "dead_load.roof.weight"
    range = [1e3, 30e3]
"""
ROOF = """
    [[model.dead_load]]
    kind = "surcharge"
    mass = false
    name = "roof"
    block = "wall"
    point = "top"
    weight = 1e3
    [target]"""


@pytest.mark.parametrize(
    ("parameter", "peak", "value"),
    [
        # lambda W h/2 = W b/2 + T z, with T = 500 N
        (LEVER, 0.15, (0.15 * 6000.0 * 1.5 - 6000.0 * 0.05) / 500.0),
        # lambda W h/2 = (W + P) b/2 + T z: the roof has no mass
        (TOP, 0.25, (0.25 * 6000.0 * 1.5 - 500.0 * 2.5) / 0.05 - 6000.0),
    ],
    ids=["tie height", "surcharge"],
)
def test_other_parameters_are_those_of_the_closed_form(tmp_path, parameter, peak, value):
    text = BLOCK.replace('outputs = ["curve", "assess"]', "").replace("5e3", "500.0")
    text = text[: text.index("    [[target.parameter]]")] + "    [[target.parameter]]" + parameter
    text = text.replace('"safety_index"', '"peak_multiplier"').replace(
        "= 1.0\n    [[t", f"= {peak}\n    [[t"
    )
    if parameter is TOP:
        text = text.replace("    [target]", ROOF, 1)
    ds.study(written(tmp_path, text), out=tmp_path / "out", figures=False)
    found = record(tmp_path / "out")
    assert found["value"] == pytest.approx(value, rel=1e-3)
    assert found["n_runs"] <= 12


FACADE = """
    model = "facade_tie.toml"
    outputs = ["curve", "assess"]
    [target]
    output = "safety_index"
    value = 1.5
    [[target.parameter]]
    path = "tie.catena.yield_force"
    range = [{low}, {high}]
"""
MODEL = Path(__file__).parents[1] / "cases" / "facade_tie.toml"


@pytest.mark.slow
def test_the_tie_of_a_facade_is_found_in_twelve_runs(tmp_path):
    """9.0 kN; from 13.8 kN on another mechanism takes over, and the index falls at once."""
    shutil.copy(MODEL, tmp_path)
    text = FACADE.format(low=1e3, high=20e3)
    ds.study(written(tmp_path, text), out=tmp_path / "out", figures=False)
    found = record(tmp_path / "out")
    assert found["status"] == "finished" and found["n_runs"] <= 12
    assert found["reached"] == pytest.approx(1.5, abs=1e-3)
    text = FACADE.format(low=10e3, high=60e3)
    ds.study(written(tmp_path, text, "jump.toml"), out=tmp_path / "jump", figures=False)
    found = record(tmp_path / "jump")
    assert found["status"] == "jump" and found["n_runs"] <= 12
    a, b = found["jump_at"]
    assert 10e3 < a < b < 20e3 and b - a <= 2e-3 * 50e3
    outputs = dict(map(tuple, found["curve"]))
    assert outputs[a] > 1.5 > outputs[b]
