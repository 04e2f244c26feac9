"""What studies say: indices of a published function, fragility of known data, bands, extremes."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import drystone as ds
from drystone.studies import figures, fragility, indices
from drystone.studies.errors import StudyError
from drystone.studies.read import read_study
from drystone.studies.sample import resampled
from studied import written

ISHIGAMI = """
    function = "FUNCTIONS:ishigami"
    design = "saltelli"
    samples = 1024
    second_order = true
""" + "".join(
    f"""
    [[parameter]]
    path = "{name}"
    range = [-{math.pi!r}, {math.pi!r}]
"""
    for name in "abc"
)
#: First and total indices of the Ishigami function with a = 7, b = 0.1 in closed form (Ishigami &
#: Homma 1990): V1 = (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = b^2 pi^8 (1/18 - 1/50).
V1, V2, V13 = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2, 49 / 8, 0.01 * math.pi**8 * (1 / 18 - 1 / 50)
V = V1 + V2 + V13
FIRST = {"a": V1 / V, "b": V2 / V, "c": 0.0}
TOTAL = {"a": (V1 + V13) / V, "b": V2 / V, "c": V13 / V}


def record(folder):
    return json.loads((folder / "study.json").read_text())


def test_sobol_indices_are_the_published_ones_within_their_confidence(tmp_path):
    ds.study(written(tmp_path, ISHIGAMI), out=tmp_path / "out", workers=1)
    found = record(tmp_path / "out")["indices"]["y"]
    for name, own in found["parameters"].items():
        assert own["first"] == pytest.approx(FIRST[name], abs=own["first_confidence"])
        assert own["total"] == pytest.approx(TOTAL[name], abs=own["total_confidence"])
        assert own["first_confidence"] < 0.1
    second = {(a, b): (value, confidence) for a, b, value, confidence in found["second"]}
    assert second["a", "c"][0] == pytest.approx(V13 / V, abs=second["a", "c"][1])
    assert (tmp_path / "out" / "indices.png").stat().st_size > 5000


def test_intervals_of_indices_follow_from_the_seed_alone(tmp_path):
    """Whatever else draws numbers meanwhile; the indices themselves follow from the samples."""
    asked = read_study(written(tmp_path, ISHIGAMI.replace("1024", "64")))
    values = np.random.default_rng(5).random(asked.count)
    first = indices.sobol(asked, values)
    np.random.seed(99)
    assert indices.sobol(asked, values) == first
    other = replace(asked, task=replace(asked.task, seed=2))
    again = indices.sobol(other, values)
    for name, own in first["parameters"].items():
        assert again["parameters"][name]["total"] == own["total"]
        assert again["parameters"][name]["total_confidence"] != own["total_confidence"]


def test_morris_effects_of_a_linear_function_are_its_slopes(tmp_path):
    text = ISHIGAMI.replace(":ishigami", ":linear").replace("saltelli", "morris")
    text = text.replace("1024", "10").replace("second_order = true", "")
    text = text.replace(f"[-{math.pi!r}, {math.pi!r}]", "[0.0, 2.0]")
    ds.study(written(tmp_path, text), out=tmp_path / "out", workers=1, figures=False)
    found = record(tmp_path / "out")["indices"]["y"]["parameters"]
    assert [found[k]["mu_star"] for k in "abc"] == pytest.approx([6.0, 2.0, 0.0], abs=1e-9)
    assert [found[k]["sigma"] for k in "abc"] == pytest.approx([0.0] * 3, abs=1e-9)
    assert [found[k]["mu_star_confidence"] for k in "abc"] == pytest.approx([0.0] * 3, abs=1e-9)


def test_morris_intervals_hold_the_mean_absolute_effect(tmp_path):
    """Known from a hundred times as many trajectories; two half intervals are four deviations."""
    text = ISHIGAMI.replace("saltelli", "morris").replace("second_order = true", "")
    many, few = (text.replace("1024", str(n)) for n in (4000, 40))
    for name, own in (("many", many), ("few", few)):
        ds.study(written(tmp_path, own), out=tmp_path / name, workers=1, figures=name == "few")
    found, known = (
        record(tmp_path / name)["indices"]["y"]["parameters"] for name in ("few", "many")
    )
    for name in "abc":
        apart = abs(found[name]["mu_star"] - known[name]["mu_star"])
        assert 0.0 < apart < 2.0 * found[name]["mu_star_confidence"]
    assert (tmp_path / "few" / "indices.png").stat().st_size > 5000


NOISY = """
    function = "FUNCTIONS:noisy"
    design = "saltelli"
    samples = 1024
    second_order = true
    [[parameter]]
    path = "a"
    range = [0.0, 1.0]
    [[parameter]]
    path = "b"
    range = [0.0, 1.0]
"""


def test_what_the_seed_makes_is_credited_to_no_parameter(tmp_path):
    """y = a u, with u uniform by the seed and b without effect.  V = 1/9 - 1/16 = 7/144,
    V_a = E[u]^2/12 = 1/48, V_b = V_ab = 0, and E[Var(y | u, b)] = E[u^2]/12 = 1/36."""
    ds.study(written(tmp_path, NOISY), out=tmp_path / "out", workers=1, figures=False)
    told = record(tmp_path / "out")["indices"]["y"]
    a, b = (told["parameters"][name] for name in "ab")
    assert a["first"] == pytest.approx(3 / 7, abs=a["first_confidence"])
    assert a["total"] == pytest.approx(4 / 7, abs=a["total_confidence"])
    assert a["first_confidence"] < 0.11  # far from 4/7, which one seed for A and B gives
    assert b["first"] == b["total"] == 0.0
    ((_, _, second, confidence),) = told["second"]
    assert second == pytest.approx(0.0, abs=confidence)


def test_what_the_seed_makes_is_no_elementary_effect(tmp_path):
    """An effect of a is u: one half in the mean, with a deviation of the root of 1/12."""
    text = NOISY.replace("saltelli", "morris").replace("second_order = true", "")
    text = text.replace("1024", "400")
    ds.study(written(tmp_path, text), out=tmp_path / "out", workers=1, figures=False)
    found = record(tmp_path / "out")["indices"]["y"]["parameters"]
    assert found["b"]["mu_star"] == found["b"]["sigma"] == 0.0
    assert found["a"]["mu"] == found["a"]["mu_star"]
    assert found["a"]["mu_star"] == pytest.approx(0.5, abs=found["a"]["mu_star_confidence"])
    assert found["a"]["sigma"] == pytest.approx(12**-0.5, rel=0.1)


def test_base_samples_with_a_failure_are_left_out_of_indices(tmp_path):
    text = ISHIGAMI.replace(":ishigami", ":sometimes").replace("1024", "64")
    text = text.replace(f"[-{math.pi!r}, {math.pi!r}]", "[0.0, 0.76]")
    frame = ds.study(written(tmp_path, text), out=tmp_path / "out", workers=1, figures=False)
    found = record(tmp_path / "out")["indices"]["y"]
    blocks = (frame["status"] == "failed").to_numpy().reshape(64, 8).any(axis=1)
    assert 0 < found["n_left_out"] == blocks.sum() < 64
    assert found["parameters"]["a"]["first"] == pytest.approx(1.0, abs=0.2)


MEDIAN, BETA = 0.25, 0.4


N_TRIALS = 100


def covered(fit):
    """Shares of data sets whose 95 % intervals hold the median and beta they were drawn with.

    Of 100 data sets, 88 or fewer would be three standard deviations below 95.
    """
    found = [fit(np.random.default_rng(seed)) for seed in range(N_TRIALS)]
    medians = np.array([one["median_confidence"] for one in found])
    betas = np.array([one["beta_confidence"] for one in found])
    assert np.mean([one["median"] for one in found]) == pytest.approx(MEDIAN, rel=0.02)
    assert np.mean([one["beta"] for one in found]) == pytest.approx(BETA, rel=0.03)
    return [
        ((pair[:, 0] <= true) & (true <= pair[:, 1])).mean()
        for pair, true in ((medians, MEDIAN), (betas, BETA))
    ]


def test_fragility_of_capacities_recovers_median_and_beta():
    def fit(rng):
        return fragility.of_capacities(MEDIAN * np.exp(BETA * rng.standard_normal(200)))

    assert min(covered(fit)) > 0.88


def test_fragility_of_stripes_recovers_median_and_beta():
    intensity = np.repeat([0.08, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6], 100)

    def fit(rng):
        capacity = MEDIAN * np.exp(BETA * rng.standard_normal(len(intensity)))
        return fragility.of_stripes(intensity, intensity > capacity)

    assert min(covered(fit)) > 0.88


def test_fragility_of_a_cloud_recovers_median_and_beta():
    """ln d = 1.5 ln(im/median) + 1.5 beta N, against a threshold of 1."""

    def fit(rng):
        intensity = rng.uniform(0.05, 0.8, 200)
        demand = (intensity / MEDIAN) ** 1.5 * np.exp(1.5 * BETA * rng.standard_normal(200))
        found = fragility.of_cloud(intensity, demand, 1.0, seed=1)
        assert found["slope"] == pytest.approx(1.5, abs=0.25)
        return found

    assert min(covered(fit)) > 0.88


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_stripes_that_say_nothing_are_refused(share):
    with pytest.raises(StudyError, match="no run exceeds the threshold, or all do"):
        fragility.of_stripes(np.arange(1.0, 9.0), np.full(8, bool(share)))


def test_fragility_of_a_study(tmp_path):
    text = f"""
    function = "FUNCTIONS:capacity"
    design = "lhs"
    samples = 500
    [[parameter]]
    path = "a"
    distribution = "lognorm"
    shapes = {{ s = {BETA}, scale = {MEDIAN} }}
    [[fragility]]
    method = "capacity"
    capacity = "capacity"
    [[fragility]]
    method = "capacity"
    capacity = "nothing"
    """
    ds.study(written(tmp_path, text), out=tmp_path / "out", workers=1)
    found, none = record(tmp_path / "out")["fragility"]
    # a Latin hypercube of 500 has the moments of the distribution to well below 1 %
    assert found["median"] == pytest.approx(MEDIAN, rel=0.01)
    assert found["beta"] == pytest.approx(BETA, rel=0.01)
    assert none["reason"] == 'there is no column "nothing"'
    assert (tmp_path / "out" / "fragility.png").exists()


def test_bands_are_quantiles_of_the_curves():
    """Straight curves 1 - d/D of ends D from 1 to 2: at d = 0.5 they lie at 1 - 0.5/D."""
    ends = np.linspace(1.0, 2.0, 201)
    displacement = ends[:, np.newaxis] * np.linspace(0.0, 1.0, 11)
    multiplier = np.tile(np.linspace(1.0, 0.0, 11), (201, 1))
    at, (low, middle, high) = figures.bands_of(displacement, multiplier)
    k = int(np.argmin(abs(at - 0.5)))
    for band, share in ((low, 0.05), (middle, 0.5), (high, 0.95)):
        assert band[k] == pytest.approx(1 - at[k] / (1.0 + share), abs=1e-9)


def test_curves_keep_their_shape():
    """To a peak, down, and back again: places are along the way, ends are exact."""
    displacement = np.array([0.0, 0.1, 1.0, 0.5])
    multiplier = np.array([0.0, 1.0, 0.2, 0.4])
    d, m = resampled(displacement, multiplier, 64)
    assert (d[0], m[0], d[-1], m[-1]) == (0.0, 0.0, 0.5, 0.4)
    assert d.max() == pytest.approx(1.0, abs=0.05) and m.max() == pytest.approx(1.0, abs=0.05)


def test_tables_are_read_in_one_line(tmp_path):
    file = written(tmp_path, ISHIGAMI.replace("1024", "8"))
    frame = ds.study(file, out=tmp_path / "out", workers=1, figures=False)
    read = pd.read_parquet(tmp_path / "out" / "samples.parquet")
    assert list(read) == list(frame) and frame.attrs["folder"] == str(tmp_path / "out")
    assert {"sample", "seed", "status", "reason", "seconds", "version", "digest"} <= set(read)
