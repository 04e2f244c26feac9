"""``drystone assess`` and ``compare``: files, tables, exit statuses, what wrong input is told."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from builders import stack, stiff_joint
from drystone.assessment.errors import AssessmentError
from drystone.assessment.methods.base import Settings
from drystone.assessment.spectra.ntc2018 import NtcSpectrum
from drystone.cli import app
from drystone.io.modelfile import write_model
from drystone.model.site import Site
from drystone.report.document.report import render
from drystone.report.folder.directory import ResultsDirectory
from drystone.report.viewer.folder import Folder
from drystone.verification.blocks import on_base
from rigid_walls import HEIGHT, WIDTH, evenly, wall_in_courses
from sites import TABLES

NTC = {"ag": 0.172, "F0": 2.458, "TC_star": 0.285, "soil": "B", "topography": "T1"}
FLAGS = (
    *("--method", "ntc2018-local", "--confidence-factor", "1.35", "--code", "ntc2018"),
    *("--ag", "0.172", "--F0", "2.458", "--TC-star", "0.285", "--soil", "B"),
    *("--topography", "T1"),
)
#: What scripts rely on.
KEYS = {
    "method",
    "reading",
    "activation_multiplier",
    "participating_mass_ratio",
    "participating_mass",
    "participation_factor",
    "activation_acceleration",
    "collapse_displacement",
    "safety_index",
    "satisfied",
    "limit_states",
}
STATES = ("SLO", "SLD", "SLV", "SLC")
STATE_KEYS = {
    "limit_displacement",
    "limit_acceleration",
    "limit_period",
    "displacement_demand",
    "ground_acceleration_capacity",
    "ground_acceleration_demand",
    "satisfied",
}


def drystone(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """A model file of a rocking wall in two courses, and its folder of results."""
    folder = tmp_path_factory.mktemp("assess")
    write_model(wall_in_courses(evenly(2), displacement_step=0.02), folder / "wall.toml")
    result = drystone("run", folder / "wall.toml", "--out", folder / "wall", "--quiet")
    assert result.exit_code == 0, result.output
    return folder


@pytest.fixture
def results(made, tmp_path) -> Path:
    """A copy of the folder of results."""
    return Path(shutil.copytree(made / "wall", tmp_path / "wall"))


def test_a_folder_is_assessed_by_what_the_command_line_says(results):
    result = drystone("assess", results, *FLAGS, "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert set(found) >= KEYS
    assert set(found["limit_states"]) == {"SLD", "SLV", "SLC"}
    for state in found["limit_states"].values():
        assert set(state) >= STATE_KEYS
    # The wall of 4.0 x 0.5 m of the worked example: lambda_0 = 0.125 less 1e-6 for stiffness,
    # e* = 1, Gamma = 2, a0 = 0.9083 m/s2, d0 = 0.2481 m at finite rotation, SLV fails.
    assert found["activation_multiplier"] == pytest.approx(0.125, rel=1e-5)
    assert found["participating_mass_ratio"] == pytest.approx(1.0, rel=1e-8)
    assert found["activation_acceleration"] == pytest.approx(0.9083, rel=1e-4)
    assert found["collapse_displacement"] == pytest.approx(0.2481, rel=1e-3)
    assert found["participating_mass"] == pytest.approx(3669.7, rel=1e-4)
    assert found["collapse_extrapolated"] is False  # one body that turns about its toe
    assert found["satisfied"] is False and found["safety_index"] < 1.0
    assert set(found["readings"]) == {"base_shear", "energy", "literal_ec8"}
    written = json.loads((results / "assessment.json").read_text())
    assert written["safety_index"] == found["safety_index"]
    picture = ElementTree.parse(results / "adrs.svg").getroot()
    told = " ".join(text.text or "" for text in picture.iter("{http://www.w3.org/2000/svg}text"))
    for name, state in found["limit_states"].items():
        if state["limit_displacement"] is not None:
            assert f"{name}: limit {state['limit_displacement']:.4g} m" in told
            assert f"demand {state['displacement_demand']:.4g} m" in told
    assert "damping 8 %" in told and "capacity, reading base_shear over FC = 1.35" in told


def test_pictures_in_other_formats_where_they_are_asked_for(results):
    found = drystone("assess", results, *FLAGS, "--figures", "png", "--figures", "pdf")
    assert found.exit_code == 0 and "assessment.json, adrs.svg, adrs.png, adrs.pdf" in found.stdout
    assert (results / "adrs.png").read_bytes().startswith(b"\x89PNG")
    assert (results / "adrs.pdf").read_bytes().startswith(b"%PDF")
    assert drystone("assess", results, *FLAGS).exit_code == 0
    assert [path.name for path in results.glob("adrs.*")] == ["adrs.svg"]  # others would be old


def test_the_screen_shows_table_and_sentence(results):
    result = drystone("assess", results, *FLAGS)
    assert result.exit_code == 0
    assert "SLV NO" in result.stdout and "zeta_E by reading" in result.stdout
    assert result.stdout.strip().splitlines()[-1].startswith("ntc2018-local: not satisfied; SLV")


def test_rows_that_are_no_part_of_the_verdict_have_no_yes_and_no_no(results):
    told = drystone("assess", results, *FLAGS).stdout
    rows = {line.split()[0]: line for line in told.splitlines() if line.lstrip()[:3] in STATES}
    assert rows["SLV"].split()[1] == "NO"
    for name in ("SLD", "SLC"):
        assert rows[name].split()[1] == "*", rows[name]
    picture = (results / "adrs.svg").read_text()
    assert re.search(r"SLC: limit [0-9.]+ m, not part of the verdict; demand", picture)


def test_readings_beside_that_of_the_code_are_marked(results):
    told = drystone("assess", results, *FLAGS).stdout
    (line,) = (line for line in told.splitlines() if "zeta_E by reading" in line)
    own, beside = line.split("; for comparison, not of the code: ")
    assert "base_shear" in own and "energy" in beside and "literal_ec8" in beside
    stored = json.loads((results / "assessment.json").read_text())["readings"]
    assert {name: found["of_the_code"] for name, found in stored.items()} == {
        "base_shear": True,
        "energy": False,
        "literal_ec8": False,
    }
    told = drystone("assess", results, *FLAGS, "--reading", "energy").stdout
    assert "base_shear (0." in told and "for comparison, not of the code: energy" in told


class TestOneSense:
    SAID = "Only one sense of the load was traced"

    def test_on_the_screen_and_first_among_the_assumptions(self, results):
        told = drystone("assess", results, *FLAGS).stdout
        assert "senses             only one, along the load: the other was not traced" in told
        notes = [line for line in told.splitlines() if line.startswith("  note:")]
        assert notes[0].startswith(f"  note: {self.SAID}, along the load:")

    def test_of_two_where_one_has_no_verdict(self, results):
        """The curve against the load was killed: what is known is one sense, and why."""
        other = results / "opposite"
        model = ds.load_results(results).model
        turned = model.with_load(direction=(-model.load_along).tolist())
        with ResultsDirectory(other, part_of=model.sha256) as recorder:
            ds.pushover(turned, recorder=recorder)
        cut(other, 10)
        told = drystone("assess", results, *FLAGS).stdout
        notes = [line for line in told.splitlines() if line.startswith("  note:")]
        assert notes[0].startswith("  note: Only one sense of the load has a verdict, along")
        assert "against the load there is no verdict" in notes[0]

    def test_in_python_and_in_a_report_of_a_run(self, results):
        found = ds.load_results(results)
        settings = Settings(method="ntc2018-local", confidence_factor=1.35)
        verdict = found.curve.assess(
            found.model, site=Site(code="ntc2018", values=NTC), settings=settings
        )
        assert verdict.assessment.assumptions[0].startswith(self.SAID)


class TestHazard:
    """V_N = 50 years, class II: V_R = 50 years, T_R = -50/ln(1 - P_VR)."""

    LIFE = ("--set", "site.nominal_life=50", "--set", "site.use=II")

    def test_what_each_state_asks_and_what_is_missing(self, results):
        found = json.loads(drystone("assess", results, *FLAGS, *self.LIFE, "--json").stdout)
        asked = {motion["state"]: motion for motion in found["hazard"]}
        periods = [asked[name]["return_period"] for name in ("SLD", "SLV", "SLC")]
        assert periods == pytest.approx([50.29, 474.56, 974.79], abs=0.01)
        assert asked["SLV"]["ground_acceleration"] == pytest.approx(0.172 * 9.81)
        assert asked["SLD"]["ground_acceleration"] is None
        assert any("[site.SLD], [site.SLC]" in said for said in found["assumptions"])
        told = drystone("assess", results, *FLAGS, *self.LIFE).stdout
        assert "SLD  P_VR = 63 %  T_R =   50.3 years  a_g = not given: [site.SLD]" in told
        assert "SLV  P_VR = 10 %  T_R =  474.6 years  a_g = 0.172 g" in told

    def test_motions_of_their_own(self, results):
        own = ("--set", "site.SLD.ag=0.07", "--set", "site.SLC.ag=0.22")
        found = json.loads(drystone("assess", results, *FLAGS, *self.LIFE, *own, "--json").stdout)
        given = [motion["ground_acceleration"] for motion in found["hazard"]]
        assert given == pytest.approx([0.07 * 9.81, 0.172 * 9.81, 0.22 * 9.81])
        assert not any("has no ground motion" in said for said in found["assumptions"])

    def test_a_motion_of_another_return_period_is_not_that_of_the_state(self, results):
        other = (*self.LIFE, "--set", "site.return_period=100")
        found = json.loads(drystone("assess", results, *FLAGS, *other, "--json").stdout)
        assert all(motion["ground_acceleration"] is None for motion in found["hazard"])

    def test_without_them_nothing_is_said(self, results):
        assert json.loads(drystone("assess", results, *FLAGS, "--json").stdout)["hazard"] == []


def test_methods_for_walls_in_their_plane_say_so_of_mechanisms_out_of_it(tmp_path):
    """A plane strip of a wall, half a metre thick and a metre wide: no verdict without a remark."""
    model = wall_in_courses(evenly(1), displacement_step=0.02).with_joint(normal_stiffness=1e8)
    ds.save_results(ds.pushover(model), model, tmp_path / "out")
    flags = ("--method", "ntc2018-global", *FLAGS[4:], "--ag", "0.01")
    told = drystone("assess", tmp_path / "out", *flags).stdout
    last = told.strip().splitlines()[-1]
    assert (
        "satisfied, but the mechanism is out of plane, for which this method is not meant" in last
    )
    assert any("100 per cent of the momentum" in line for line in told.splitlines())
    local = drystone("assess", tmp_path / "out", *FLAGS, "--ag", "0.01").stdout
    assert "out of plane" not in local
    more = ("effective_mass_factor=1.0", "near_fault=false", 'site_class="C"')
    more += ("displacement_limits.CP=0.15",)
    sets = [word for key in more for word in ("--set", f"assessment.{key}")]
    asce = drystone("assess", tmp_path / "out", *flags, "--method", "asce41", *sets, "--json")
    assert "the mechanism is out of plane" in json.loads(asce.stdout)["caution"], asce.output


def test_tables_of_a_model_file_and_flags_over_them(results, tmp_path, made):
    other = tmp_path / "site.toml"
    other.write_text((made / "wall.toml").read_text() + TABLES)
    by_file = json.loads(drystone("assess", results, "--model", other, "--json").stdout)
    by_flags = json.loads(drystone("assess", results, *FLAGS, "--json").stdout)
    assert by_file["limit_states"] == by_flags["limit_states"]
    stronger = drystone("assess", results, "--model", other, "--ag", "0.3", "--json")
    demand = json.loads(stronger.stdout)["limit_states"]["SLV"]["ground_acceleration_demand"]
    assert demand == pytest.approx(0.3 * 9.81)
    own = drystone("assess", results, "--model", other, "--set", "site.SLD.ag=0.05", "--json")
    states = json.loads(own.stdout)["limit_states"]
    assert states["SLD"]["ground_acceleration_demand"] == pytest.approx(0.05 * 9.81)
    assert "SLC" not in states  # it has no motion of its own, where others have


def test_a_model_is_traced_in_both_senses_and_the_worse_governs(made, tmp_path):
    """Its control point lies at the side that the load leads to: rotations the other way differ in
    what the point does, not in the wall."""
    path = tmp_path / "wall.toml"
    path.write_text((made / "wall.toml").read_text() + TABLES)
    out = tmp_path / "out"
    result = drystone("assess", path, "--out", out, "--json", "--quiet")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    along, against = found["senses"]["along the load"], found["senses"]["against the load"]
    assert along["activation_multiplier"] == pytest.approx(0.125, rel=1e-4)
    # Against the load the wall turns about its other toe: the same wall.
    assert against["activation_multiplier"] == pytest.approx(0.125, rel=1e-4)
    least = min(along["safety_index"], against["safety_index"])
    assert found["safety_index"] == least
    assert (out / "results.h5").is_file() and (out / "opposite" / "results.h5").is_file()
    again = json.loads(drystone("assess", out, "--json").stdout)  # both senses are found again
    assert again["safety_index"] == pytest.approx(least, rel=1e-12)
    assert again["governing_sense"] == found["governing_sense"]


def test_a_control_point_that_was_moved_on_its_block_is_that_of_the_folder(tmp_path):
    """A tie holds the top, so that the foot slides: displacements are those of the foot."""
    held = ds.TieEnd(point=np.array([0.0, 1.8]), block="b1")
    tie = ds.Tie(
        start=held,
        end=ds.TieEnd(point=np.array([-2.0, 1.8])),
        stiffness=1e6,
        yield_force=2e4,
        compression=False,
    )
    model = stack((0.4, 2.0), joint=stiff_joint(0.7), ties=[tie])
    write_model(model, path := tmp_path / "tied.toml")
    out = tmp_path / "out"
    of_model = drystone("assess", path, *FLAGS, "--out", out, "--quiet", "--json")
    assert of_model.exit_code == 0, of_model.output
    assert ds.load_results(out).model.control_point.point[1] < 1.8
    of_folder = drystone("assess", out, *FLAGS, "--json")
    assert of_folder.exit_code == 0, of_folder.output
    first, again = (json.loads(told.stdout) for told in (of_model, of_folder))
    assert again["safety_index"] == first["safety_index"]
    assert list(again["senses"]) == ["along the load", "against the load"]


def test_what_is_missing_is_said_before_anything_is_traced(made, tmp_path):
    out = tmp_path / "out"
    result = drystone("assess", made / "wall.toml", *FLAGS[:2], *FLAGS[4:], "--out", out)
    assert result.exit_code == 2 and '"confidence_factor"' in result.stderr
    assert not out.exists()


def test_files_of_the_site_go_with_the_results(made, tmp_path, monkeypatch):
    """The folder of results holds them, so that nothing outside of it is read."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "spectrum.csv").write_text("T,Se\n0,0.2\n0.1,0.5\n0.5,0.5\n2.0,0.1\n")
    table = '[site]\ncode = "csv"\nfile = "spectrum.csv"\nunit = "g"\ndamping = 5.0\n'
    asked = (
        '[assessment]\nmethod = "ntc2018-local"\nconfidence_factor = 1.35\nelastic_period = 0.0\n'
    )
    (tmp_path / "wall.toml").write_text((made / "wall.toml").read_text() + table + asked)
    monkeypatch.chdir(tmp_path)
    assert drystone("run", "wall.toml", "--out", "out", "--quiet").exit_code == 0
    (tmp_path / "wall.toml").unlink()
    (tmp_path / "spectrum.csv").rename(tmp_path / "elsewhere/other.csv")
    monkeypatch.chdir(tmp_path / "elsewhere")
    result = drystone("assess", tmp_path / "out", "--json")
    assert result.exit_code == 0, result.output
    demand = json.loads(result.stdout)["limit_states"]["SLV"]["displacement_demand"]
    assert demand > 0.0
    more = ("--set", "site.damping=2.0")  # over what the results hold
    changed = json.loads(drystone("assess", tmp_path / "out", *more, "--json").stdout)
    assert changed["limit_states"]["SLV"]["displacement_demand"] < demand
    more = ("--spectrum", "other.csv", "--unit", "m/s2")  # the command's own file
    changed = json.loads(drystone("assess", tmp_path / "out", *more, "--json").stdout)
    assert changed["limit_states"]["SLV"]["displacement_demand"] < demand
    model = ds.load_results(tmp_path / "out").model
    ds.write_model(model, tmp_path / "elsewhere/model.toml")  # with its file
    again = ds.read_model(tmp_path / "elsewhere/model.toml")
    assert (tmp_path / "elsewhere/spectrum.csv").read_text().startswith("T,Se")
    assert again.site.values["file"] == "spectrum.csv"
    ds.save_results(ds.load_results(tmp_path / "out").curve, model, tmp_path / "copy")
    assert drystone("assess", tmp_path / "copy").exit_code == 0


def test_results_of_somebody_else_read_no_file_of_mine(made, tmp_path, monkeypatch):
    """Whatever their model names, and wherever they say it was."""
    import h5py

    secret = tmp_path / "secret.csv"
    secret.write_text("T,Se\n0,0.2\n0.1,0.5\n0.5,0.5\n2.0,0.1\n")
    (tmp_path / "history.txt").write_text("0.001\n")
    out = tmp_path / "theirs/out"
    assert drystone("run", made / "wall.toml", "--out", out, "--quiet").exit_code == 0
    monkeypatch.chdir(tmp_path)
    given = (made / "wall.toml").read_text()
    asked = '[assessment]\nmethod = "ntc2018-local"\nconfidence_factor = 1.35\n'
    for name in ("secret.csv", "../secret.csv", str(secret)):
        site = f'[site]\ncode = "csv"\nfile = "{name}"\nunit = "g"\ndamping = 5.0\n'
        with h5py.File(out / "results.h5", "r+") as file:
            file.attrs["model"] = given + site + asked
            file.attrs["model_source"] = str(tmp_path / "wall.toml")
            file.attrs["model_folder"] = str(tmp_path)
        for more in ((), ("--set", "site.damping=4.0")):
            result = drystone("assess", out, *more)
            assert result.exit_code == 2 and "is not stored in these results" in result.stderr
    with h5py.File(out / "results.h5", "r+") as file:
        file.attrs["model"] = given + '[control]\nhistory = "history.txt"\n'
    assert ds.load_results(out).model is None


def test_an_interrupted_trace_is_kept_and_is_status_130(made, tmp_path, monkeypatch):
    class Stops:
        def __enter__(self):
            return self

        def __exit__(self, *error):
            return None

        def __call__(self, point):
            if point.step == 20:
                raise KeyboardInterrupt

    monkeypatch.setattr("drystone.common.progress.progress_for", lambda *a, **k: Stops())
    out = tmp_path / "out"
    result = drystone("assess", made / "wall.toml", *FLAGS, "--out", out, "--json")
    assert result.exit_code == 130
    assert json.loads(result.stdout)["status"] == "interrupted"
    assert len(ds.load_results(out).curve.points) == 21
    assert drystone("assess", out, *FLAGS).exit_code == 3  # nothing of it is a collapse


def test_one_sense_is_enough_where_it_is_asked_for(made, tmp_path):
    path = tmp_path / "wall.toml"
    path.write_text((made / "wall.toml").read_text() + TABLES + "opposite = false\n")
    result = drystone("assess", path, "--out", tmp_path / "out", "--json", "--quiet")
    assert list(json.loads(result.stdout)["senses"]) == ["along the load"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "assessment.method is missing: choose one of"),
        (("--method", "ntc2018-local"), "site is missing: say what the ground does"),
        (("--method", "ntc"), 'there is no method "ntc"'),
        ((*FLAGS, "--reading", "half"), "assessment.reading: must not be"),
        ((*FLAGS[:4], *FLAGS[4:6]), "site: ag is missing"),
        ((*FLAGS, "--soil", "F"), "site.soil: must not be"),
        ((*FLAGS, "--set", "ag=0.1"), "write it as site.KEY=VALUE"),
        ((*FLAGS, "--set", "site.agg=0.1"), 'unknown key "agg": did you mean "ag"?'),
        (("--method", "rocking"), "site is missing"),
        (("--method", "ntc2018-local", *FLAGS[4:]), '"confidence_factor"'),
        (("--method", "asce41", *FLAGS[4:]), '"site_class"'),
        (
            ("--method", "ntc2018-global", *FLAGS[4:], "--set", "assessment.procedure=B"),
            '"dissipation"',
        ),
    ],
)
def test_missing_or_wrong_input_is_status_2_with_the_mend(results, arguments, said):
    result = drystone("assess", results, *arguments)
    assert result.exit_code == 2, result.output
    assert said in result.stderr and "Traceback" not in result.stderr


@pytest.fixture(scope="module")
def short(tmp_path_factory) -> Path:
    """The folder of a curve of the wall that ends long before the collapse."""
    folder = tmp_path_factory.mktemp("short")
    wall = wall_in_courses(evenly(2), displacement_step=0.02, max_displacement=0.05)
    write_model(wall, folder / "wall.toml")
    drystone("run", folder / "wall.toml", "--out", folder / "wall", "--quiet")
    return folder / "wall"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--method", "rocking", *FLAGS[4:]), 'needs "records" or "pulses"'),
        (("--method", "ntc2018-local", *FLAGS[4:]), '"confidence_factor"'),
        ((*FLAGS, "--set", 'assessment.limit_states=["SLO"]'), '"SLO" is to be verified'),
    ],
)
def test_what_is_missing_is_status_2_of_a_short_curve_too(short, arguments, said):
    """It was 3, with the end of the curve as the reason: no longer curve would have mended it."""
    result = drystone("assess", short, *arguments)
    assert result.exit_code == 2 and result.output.count(said) == 1, result.output
    assert "The curve is" not in result.output
    assert drystone("assess", short, *FLAGS).exit_code == 3


def test_bad_spectra_and_folders_are_status_2(results, tmp_path):
    spectrum = tmp_path / "spectrum.csv"
    spectrum.write_text("T,Se\n0,0.2\n0.5,-0.1\n")
    csv = ("--code", "csv", "--spectrum", spectrum, "--unit", "g", "--damping", "5")
    result = drystone("assess", results, *FLAGS[:4], *csv)
    assert result.exit_code == 2 and "spectrum.csv" in result.stderr
    assert drystone("assess", tmp_path / "none", *FLAGS).exit_code == 2
    result = drystone("assess", tmp_path, *FLAGS)
    assert result.exit_code == 2 and "name a folder that a run" in result.stderr


def cut(folder: Path, n_points: int) -> None:
    """Leave a folder as a run that was killed after some points does."""
    for name in ("summary.json", "curve.csv", "curve.png", "mechanism.png"):
        (folder / name).unlink()
    with h5py.File(folder / "results.h5", "a") as file:
        file.attrs["status"] = "running"
        file["contacts/offset"].resize(n_points + 1, axis=0)
        file["poses"].resize(n_points, axis=0)
        for name in file["curve"]:
            file["curve"][name].resize(n_points, axis=0)


def test_a_killed_run_is_assessed_as_far_as_it_goes(results):
    curve = ds.load_results(results).curve
    past = curve.nearest(0.25)  # half the way down
    cut(results, past)
    result = drystone("assess", results, *FLAGS, "--json")
    assert result.exit_code == 3, result.output
    found = json.loads(result.stdout)
    assert set(found) >= KEYS and found["limit_states"] == {} and found["satisfied"] is None
    assert found["activation_multiplier"] == pytest.approx(0.125, rel=1e-4)
    assert found["collapse_displacement"] is None
    assert "trace it further" in found["reason"]
    assert json.loads((results / "assessment.json").read_text())["activation_multiplier"] > 0.12
    # Of the activation multiplier alone there is a verdict.
    linear = drystone("assess", results, *FLAGS, "--set", "assessment.kinematics=linear")
    assert linear.exit_code == 0, linear.output
    assert "q = 2" in linear.stdout


def test_a_run_that_was_killed_before_its_first_point(results):
    cut(results, 0)
    result = drystone("assess", results, *FLAGS)
    assert result.exit_code == 3 and "the curve has too few points, 0" in result.stderr


def test_of_a_folder_of_directions_one_is_to_be_named(results, tmp_path):
    shutil.copytree(results, tmp_path / "all" / "direction-180")
    result = drystone("assess", tmp_path / "all", *FLAGS)
    assert result.exit_code == 2 and "one of the directions in it, direction-180" in result.stderr


def test_a_run_that_was_killed_before_its_peak_has_no_mechanism(results):
    cut(results, 3)
    result = drystone("assess", results, *FLAGS, "--json")
    assert result.exit_code == 3
    found = json.loads(result.stdout)
    assert set(found) >= KEYS and found["activation_multiplier"] is None
    assert "not passed its peak" in found["reason"]


def test_the_same_in_python(results):
    found = ds.load_results(results)
    site = Site(code="ntc2018", values=NTC)
    verdict = found.curve.assess(
        found.model, site=site, method="ntc2018-local", confidence_factor=1.35
    )
    assert verdict.satisfied is False
    assert verdict.state("SLV").displacement_demand == pytest.approx(0.1007, rel=0.01)
    spectrum = NtcSpectrum(
        ground_acceleration=0.172 * 9.81,
        amplification=2.458,
        reference_corner=0.285,
        soil="B",
        topography="T1",
    )
    settings = Settings(method="ntc2018-local", confidence_factor=1.35)
    same = found.curve.assess(found.model, settings=settings, spectra=spectrum)
    assert same.safety_index == verdict.safety_index
    with pytest.raises(AssessmentError, match="not both"):
        found.curve.assess(found.model, settings=settings, method="asce41")
    assert "SLV" in repr(verdict)


class TestCompare:
    def test_curves_of_folders_in_one_picture(self, results, made, tmp_path):
        for ending, beginning in ((".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")):
            path = tmp_path / f"picture{ending}"
            result = drystone("compare", results, made / "wall", "--out", path)
            assert result.exit_code == 0, result.output
            assert path.read_bytes().startswith(beginning)
        assert "0.1250" in result.stdout and "finished" in result.stdout

    def test_what_it_says_in_json(self, results, made, tmp_path):
        cut(results, 30)
        out = tmp_path / "picture.png"
        result = drystone("compare", results, made / "wall", "--out", out, "--json")
        rows = json.loads(result.stdout)["curves"]
        assert len({row["name"] for row in rows}) == 2  # folders of one name are told apart
        assert [row["status"] for row in rows] == ["running", "finished"]
        # The wall stands at lambda = 0 where its centroid is above its toe, at 0.4961 m.
        assert rows[1]["ultimate_displacement"] == pytest.approx(
            HEIGHT * np.sin(np.arctan(WIDTH / HEIGHT)), rel=0.01
        )

    def test_wrong_endings_and_folders(self, results, tmp_path):
        assert drystone("compare", results, "--out", tmp_path / "a.bmp").exit_code == 2
        assert drystone("compare", tmp_path, "--out", tmp_path / "a.png").exit_code == 2


class TestAnimation:
    def test_a_gif_has_its_frames(self, results, tmp_path):
        from PIL import Image

        from drystone.report.animation import animate

        found = ds.load_results(results)
        animate(found.curve, found.model, tmp_path / "fail.gif", n_frames=3)
        with Image.open(tmp_path / "fail.gif") as picture:
            assert 3 <= picture.n_frames <= 4  # the peak is one of them, or one more
            assert picture.size[0] % 2 == picture.size[1] % 2 == 0

    def test_the_command_writes_it_in_place_of_a_page(self, results, tmp_path, monkeypatch):
        from PIL import Image

        from drystone.report import animation

        whole = animation.animate
        monkeypatch.setattr(
            animation, "animate", lambda curve, model, path: whole(curve, model, path, n_frames=2)
        )
        path = tmp_path / "fall down.GIF"
        result = drystone("view", results, "--out", path, "--json")
        assert result.exit_code == 0 and json.loads(result.stdout)["file"] == str(path)
        with Image.open(path) as picture:
            assert picture.format == "GIF" and picture.n_frames >= 2
        assert not list(tmp_path.glob(".*"))  # no draft is left

    def test_places_and_endings_that_are_wrong(self, results, tmp_path):
        for command, name, said in (
            ("view", "fall.avi", "must end in .html, .gif or .mp4"),
            ("view", "none/fall.gif", "there is no folder"),
            ("view", "none/fall.html", "there is no folder"),
            ("report", "none/report.html", "there is no folder"),
            ("report", "", "is a folder: name a file in it"),
            ("compare", "none/curves.png", "there is no folder"),
        ):
            result = drystone(command, results, "--out", tmp_path / name)
            assert result.exit_code == 2 and said in result.stderr, (command, name)

    def test_what_cannot_be_written_is_said(self, results, tmp_path, monkeypatch):
        import sys

        from drystone.report.animation import animate

        found = ds.load_results(results)
        with pytest.raises(ds.ModelError, match="must end in"):
            animate(found.curve, found.model, tmp_path / "fail.avi")
        monkeypatch.setitem(sys.modules, "imageio", None)  # as if it were not installed
        with pytest.raises(ds.ModelError, match=r"drystone\[animation\]"):
            animate(found.curve, found.model, tmp_path / "fail.mp4")


def test_run_writes_pictures_in_other_formats_as_well(made, tmp_path):
    out = tmp_path / "out"
    result = drystone("run", made / "wall.toml", "--out", out, "--figures", "svg", "--quiet")
    assert result.exit_code == 0
    assert {"curve.png", "curve.svg", "mechanism.svg"} <= {path.name for path in out.iterdir()}
    drystone("run", made / "wall.toml", "--out", out, "--quiet")
    assert not (out / "curve.svg").exists()  # of another run


@pytest.fixture(scope="module")
def cyclic(made) -> Path:
    """The folder of the same wall, pushed to and fro and then over."""
    model = ds.read_model(made / "wall.toml").with_history([0.05, -0.05, 0.15, -0.1, 1.2 * WIDTH])
    write_model(model, made / "cyclic.toml")
    result = drystone("run", made / "cyclic.toml", "--out", made / "cyclic", "--quiet")
    assert result.exit_code == 0, result.output
    return made / "cyclic"


def test_of_a_cyclic_curve_the_envelope_is_assessed(made, cyclic):
    """As the curve that goes one way, as nothing is lost to and fro; and the verdict says so."""
    one_way = json.loads(drystone("assess", made / "wall", *FLAGS, "--json").stdout)
    told = json.loads(drystone("assess", cyclic, *FLAGS, "--json").stdout)
    assert told["safety_index"] == pytest.approx(one_way["safety_index"], rel=1e-2)
    assert told["collapse_displacement"] == pytest.approx(
        one_way["collapse_displacement"], rel=1e-2
    )
    assert any("envelope in the sense of the load" in said for said in told["assumptions"])
    spoken = drystone("assess", cyclic, *FLAGS, "--language", "it")
    assert "La curva è ciclica" in spoken.output


def test_a_cyclic_curve_that_does_not_collapse_is_told_what_would_mend_it(made):
    """Farther targets: no max_displacement leads beyond them."""
    model = ds.read_model(made / "wall.toml").with_history([0.05, -0.05, 0.1])
    write_model(model, made / "short.toml")
    drystone("run", made / "short.toml", "--out", made / "short", "--quiet")
    told = drystone("assess", made / "short", *FLAGS)
    assert told.exit_code == 3
    said = " ".join(told.output.split())
    assert "give [control] history farther targets" in said and "max_displacement" not in said
    spoken = drystone("assess", made / "short", *FLAGS, "--language", "it").output
    assert "La curva è arrestata" in spoken and "stopped" not in spoken
    # Of methods that need a part of it only, too.
    flags = list(FLAGS)
    flags[flags.index("--method") + 1] = "ntc2018-global"
    said = " ".join(drystone("assess", made / "short", *flags).output.split())
    assert "Farther targets of [control] history trace it further" in said


def test_a_history_that_is_over_is_extended_by_no_other_end(made):
    model = ds.read_model(made / "wall.toml").with_history([0.02, -0.02])
    write_model(model, made / "over.toml")
    drystone("run", made / "over.toml", "--out", made / "over", "--quiet")
    for more in ((), ("--extend", "max_displacement=0.1")):
        told = drystone("run", "--resume", made / "over", *more)
        said = " ".join(told.output.split())
        assert told.exit_code == (2 if more else 0)
        assert "run the model again with more of them" in said and "--extend" not in said


@pytest.fixture(scope="module")
def leaning(made) -> Path:
    """The folder of a block 0.5 m wide and 4 m high on a plane that falls to the left by 0.01 rad,
    pushed to where next to nothing is borne, in both senses."""
    model = on_base(WIDTH, (HEIGHT,), friction=0.7, stiffness=1e11, slope=-0.01)
    model = model.with_history([0.5 * WIDTH, -0.5 * WIDTH, 0.97 * WIDTH, -0.833 * WIDTH])
    write_model(model, made / "leaning.toml")
    result = drystone("run", made / "leaning.toml", "--out", made / "leaning", "--quiet")
    assert result.exit_code == 0, result.output
    return made / "leaning"


def test_both_senses_of_a_cyclic_curve_are_assessed_and_the_worse_governs(made, leaning):
    """To the left it bears tan(atan(b / h) - 0.01) only, to the right tan(atan(b / h) + 0.01)."""
    found = json.loads(drystone("assess", leaning, *FLAGS, "--json").stdout)
    assert list(found["senses"]) == ["along the load", "against the load"]
    along, against = found["senses"].values()
    for sense, lean in ((along, 0.01), (against, -0.01)):
        exact = np.tan(np.arctan(WIDTH / HEIGHT) + lean)
        assert sense["activation_multiplier"] == pytest.approx(exact, rel=1e-4)
    assert found["governing_sense"] == "against the load"
    assert found["safety_index"] == against["safety_index"] < along["safety_index"]
    assert any("against the sense of the load" in said for said in against["assumptions"])
    # It is the verdict on the wall that is pushed to the left in the first place.
    model = ds.read_model(made / "leaning.toml").with_load(direction=[-1.0, 0.0])
    write_model(replace(model, history=None), made / "left.toml")
    left = drystone(
        "assess", made / "left.toml", *FLAGS, "--one-sense", "--json", "--quiet",
        "--out", made / "left",
    )  # fmt: skip
    assert against["safety_index"] == pytest.approx(
        json.loads(left.stdout)["safety_index"], rel=2e-2
    )
    told = drystone("assess", leaning, *FLAGS).stdout
    assert "along the load" in told and "against the load" in told and "governs" in told


def test_of_a_cyclic_curve_one_sense_alone_can_be_asked_for(leaning):
    found = json.loads(drystone("assess", leaning, *FLAGS, "--one-sense", "--json").stdout)
    assert list(found["senses"]) == ["along the load"]


def test_limit_states_against_the_load_are_marked_on_the_left_of_a_cyclic_curve(leaning):
    drystone("assess", leaning, *FLAGS)
    folder = Folder.read(leaning)
    assert folder.governs and folder.limit_marks
    for mark in folder.limit_marks:
        assert mark.control_displacement < 0.0 and mark.load_multiplier < 0.0
    page = render(folder)
    assert "against the load governs" in page


def test_a_cyclic_curve_that_does_not_go_far_enough_has_no_verdict(made, tmp_path):
    model = ds.read_model(made / "wall.toml").with_history([0.02, -0.02, 0.0])
    write_model(model, tmp_path / "short.toml")
    drystone("run", tmp_path / "short.toml", "--out", tmp_path / "short", "--quiet")
    result = drystone("assess", tmp_path / "short", *FLAGS)
    assert result.exit_code == 3 and "3 displacements of the history" in result.output
    assert "stopped: in this sense the curve goes to 0.02 m" in result.output


def test_of_a_cyclic_curve_the_sense_that_goes_far_enough_has_the_verdict(made, tmp_path):
    """The same of the model file and of its folder; along the load it turns back too early."""
    model = ds.read_model(made / "wall.toml").with_history([0.02, -1.2 * WIDTH])
    write_model(model, tmp_path / "one.toml")
    of_model = drystone(
        "assess", tmp_path / "one.toml", *FLAGS, "--out", tmp_path / "out", "--json"
    )
    of_folder = drystone("assess", tmp_path / "out", *FLAGS, "--json")
    assert of_model.exit_code == of_folder.exit_code == 0, of_model.output
    assert not (tmp_path / "out" / "opposite").exists()  # both senses are on one curve
    for told in map(json.loads, (of_model.stdout, of_folder.stdout)):
        assert told["governing_sense"] == "against the load"
        assert told["senses"]["along the load"]["status"] == "no verdict"
        assert told["satisfied"] is not None
        assert "along the load there is no verdict" in told["assumptions"][0]


def test_the_outward_curve_has_what_happened_up_to_each_point(cyclic):
    curve = ds.load_results(cyclic).curve
    outward = curve.outward()
    x = outward.control_displacement
    assert x[0] == 0.0 and np.all(np.diff(x) > 0.0) and not outward.is_cyclic
    assert [point.step for point in outward.points] == list(range(len(x)))
    assert len(outward.poses) == len(x) and outward.status == "finished"
    known = dict(zip(curve.control_displacement, curve.load_multiplier, strict=True))
    assert all(known[a] == b for a, b in zip(x, outward.load_multiplier, strict=True))


def test_supports_that_move_are_not_assessed(tmp_path):
    """It is said before anything is traced."""
    path = tmp_path / "model.toml"
    sinks = ds.Settlement(blocks=("base",), direction=(0.0, -1.0), max=0.01)
    write_model(stack((0.4, 1.0)).with_settlement(sinks), path)
    done = CliRunner().invoke(app, ["assess", str(path), *FLAGS, "--out", str(tmp_path / "out")])
    assert done.exit_code == 2 and "give a [load] to assess" in done.output
    assert not (tmp_path / "out").exists()


def test_a_slender_wall_has_a_verdict(tmp_path):
    """lambda_0 = b / h = 0.05; nothing is carried any more where the top has moved by b."""
    write_model(on_base(0.3, (6.0,), friction=0.7, stiffness=1e11), tmp_path / "slender.toml")
    told = drystone(
        "assess", tmp_path / "slender.toml", *FLAGS, "--out", tmp_path / "out", "--json"
    )
    assert told.exit_code == 0, told.output
    found = json.loads(told.stdout)
    assert found["activation_multiplier"] == pytest.approx(0.05, rel=1e-3)
    # d0* = d_C0 / Gamma, and Gamma = 2 at the top of one body.
    assert found["collapse_displacement"] == pytest.approx(0.15, rel=5e-3)
    assert found["safety_index"] > 0.0


#: A strip 0.30 m thick and 6 m high in twelve blocks, which a spring holds near its top.
HELD = """
dimension = 2
thickness = 1.0
[material.stone]
unit_weight = 18e3
[joint]
friction_coefficient = 0.6
normal_stiffness = 5e10
shear_stiffness = 2e10
[[block]]
id = "ground"
vertices = [[-1.0, -0.5], [2.0, -0.5], [2.0, 0.0], [-1.0, 0.0]]
support = true
[[build]]
kind = "column"
name = "w"
width = 0.30
height = 6.0
n_blocks = 12
[[spring]]
name = "floor"
from = {block = "w/b12", point = [0.0, 5.75]}
to = {block = "ground", point = [-4.0, 5.75]}
stiffness = 1e7
[load]
pattern = "mass"
direction = [1.0, 0.0]
"""


class TestControlPointThatGoesBackwards:
    """The wall bends between its foot and the spring: its top, held below, goes backwards."""

    def assessed(self, folder, control=""):
        (folder / "held.toml").write_text(HELD + control)
        where = ("--out", folder / "out", "--one-sense")
        return drystone("assess", folder / "held.toml", *FLAGS, *where, "--json")

    def test_where_nobody_names_one_it_goes_to_what_moves(self, tmp_path):
        found = json.loads(self.assessed(tmp_path).stdout)
        named = json.loads(self.assessed(tmp_path, '[control]\nblock = "w/b8"\n').stdout)
        # Virtual work of two bodies with a hinge in a joint of the blocks, the lowest of eleven.
        assert found["activation_multiplier"] == pytest.approx(0.1447, rel=1e-3)
        for key in ("activation_multiplier", "participating_mass_ratio", "safety_index"):
            assert found[key] == pytest.approx(named[key], rel=2e-2), key
        assert found["participating_mass_ratio"] > 0.98

    def test_one_that_is_named_there_gives_no_verdict(self, tmp_path):
        """The jump, with the top held, says next to nothing of how the wall moves over it."""
        told = self.assessed(tmp_path, '[control]\nblock = "w/b12"\n')
        assert told.exit_code == 2
        assert "control point stands still in the mechanism" in told.stderr


def test_a_caution_of_the_other_sense_goes_with_the_verdict(tmp_path):
    """A block on slippery ground before a heavy one slides along the load; against it, it rocks."""
    outlines = {"b": "[[0.0, 0.0], [0.4, 0.0], [0.4, 1.0], [0.0, 1.0]]"}
    outlines["stop"] = "[[-0.2, 0.0], [0.0, 0.0], [0.0, 0.05], [-0.2, 0.05]]"
    blocks = [f'[[block]]\nid = "{k}"\nvertices = {v}\n' for k, v in outlines.items()]
    ground = "[[-2.0, -0.5], [3.0, -0.5], [3.0, 0.0], [-2.0, 0.0]]"
    (tmp_path / "one.toml").write_text(
        "dimension = 2\nthickness = 1.0\n[material.stone]\nunit_weight = 20e3\n"
        "[joint]\nfriction_coefficient = 0.3\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n"
        + f'[[block]]\nid = "g"\nsupport = true\nvertices = {ground}\n'
        + blocks[0]
        + blocks[1]
        + "support = true\n"
        + '[load]\npattern = "mass"\ndirection = [1.0, 0.0]\n[analysis]\nmax_displacement = 5.0\n'
    )
    told = drystone("assess", tmp_path / "one.toml", *FLAGS, "--out", tmp_path / "out", "--json")
    assert told.exit_code == 0, told.output
    found = json.loads(told.stdout)
    along, against = found["senses"]["along the load"], found["senses"]["against the load"]
    assert "the mechanism slides" in along["caution"]
    assert found["governing_sense"] == "against the load"
    assert against["caution"].startswith("along the load the mechanism slides")
    assert "but along the load the mechanism slides" in found["sentence"]


def test_bonds_that_bend_at_two_points_are_said_to_carry_too_much(tmp_path):
    model = on_base(0.3, (6.0,), friction=0.7, stiffness=1e11)
    write_model(
        model.with_joint(cohesion=1e5, tensile_strength=5e4, normal_stiffness=1e10),
        tmp_path / "b.toml",
    )
    told = drystone("assess", tmp_path / "b.toml", *FLAGS, "--out", tmp_path / "out")
    assert told.exit_code == 0, told.output
    assert "Bonds in bending: with 2 contact points a joint may carry three times" in told.stdout
