"""The report of a folder of results: what it says, of which folders, and what it holds."""

import json
import re
import shutil
import tomllib
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import drystone as ds
from drystone.cli import app
from drystone.common.language import words
from drystone.model.loading.dead import KINDS
from drystone.model.loading.targets import POINTS
from drystone.model.ties import STATES
from drystone.report.document import figures
from drystone.report.document.judged import Judged
from drystone.report.document.report import render
from drystone.report.folder.results import load_results
from drystone.report.marks import TIES
from drystone.report.viewer.folder import Folder
from pages import text_of, unfolded
from sites import TABLES

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
DATE = datetime(2024, 5, 6, 7, 8, tzinfo=UTC)


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """Results of a block on a base whose model file asks for an assessment."""
    folder = tmp_path_factory.mktemp("asked")
    file = folder / "model.toml"
    file.write_text((EXAMPLES / "two_blocks.toml").read_text() + TABLES)
    model = ds.read_model(file)
    ds.save_results(ds.pushover(model), model, folder / "out")
    return folder / "out"


@pytest.fixture
def plain(tmp_path):
    """Results of the same block, with no assessment asked for."""
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    ds.save_results(ds.pushover(model), model, tmp_path / "out")
    return tmp_path / "out"


def test_everything_that_the_report_owes_is_there(asked):
    found = Folder.read(asked)
    page = render(found, date=DATE)
    seen = text_of(page)
    t = words()
    # There are neither notes, ties, dead loads nor cycles, and no supports that move.
    left_out = (
        *("notes", "outcome", "reaction", "states_shown", "ties", "ties_at", "dead_loads"),
        "cycles",
    )
    for key, name in t["section"].items():
        assert name in seen or key in left_out, name
    curve, model = found.results.curve, found.results.model
    for value in (
        f"{curve.peak.load_multiplier:.4g}",
        f"{curve.residual.max():.2g}",
        f"{model.assembly.joint.friction_coefficient:.4g}",
        model.sha256,
        "2024-05-06 07:08 UTC",
        "Circ. 7/2019",
        ds.__version__,
        curve.reason,
    ):
        assert value in seen, value
    # Peak, limit states and the last state at rest.
    assert page.count("<figcaption>") >= 1 + 3
    for name in t["engineer"].values():
        assert name in seen


def test_the_assessment_is_made_where_the_model_asks_for_one(asked):
    from drystone.assessment.verdict import verdict_on

    found = Folder.read(asked)
    assert not found.assessment
    verdict = verdict_on(found.results.curve, found.results.model)
    page = text_of(render(found, date=DATE))
    assert verdict.sentence in page.replace("&lt;", "<").replace("&gt;", ">").replace("&#39;", "'")
    for state in verdict.limit_states:
        assert state.name in page
        if state.limit_displacement is not None:
            assert f"{state.limit_displacement:.4g}" in page
    for sentence in (*verdict.assessment.assumptions, *verdict.assessment.uncertain):
        assert sentence[:40].split("'")[0] in page


def test_a_folder_s_own_assessment_goes_before(asked, tmp_path):
    shutil.copy(asked / "results.h5", tmp_path)
    data = {"sentence": "decided elsewhere", "satisfied": False, "method": "by hand"}
    data["model_sha256"] = load_results(asked).sha256
    (tmp_path / "assessment.json").write_text(json.dumps(data))
    page = render(Folder.read(tmp_path), date=DATE)
    assert 'class="verdict fails"' in page and "decided elsewhere" in page
    # One that holds, but by a method that is not meant for the mechanism, is not shown as good.
    data |= {"satisfied": True, "caution": "the mechanism is out of plane"}
    (tmp_path / "assessment.json").write_text(json.dumps(data))
    assert 'class="verdict none"' in render(Folder.read(tmp_path), date=DATE)


def test_without_an_assessment_it_says_so_and_what_to_do(plain):
    page = text_of(render(Folder.read(plain), date=DATE))
    assert "drystone assess" in page
    assert words()["section"]["hazard"] not in page


def test_a_curve_that_does_not_go_far_enough_has_no_verdict_and_a_reason(asked, tmp_path):
    shutil.copy(asked / "results.h5", tmp_path)
    _shorten(tmp_path / "results.h5", 3)
    judged = Judged.of(Folder.read(tmp_path))
    assert judged.reason and not judged.verdict
    page = text_of(render(Folder.read(tmp_path), date=DATE))
    assert "There is no verdict" in page
    assert words()["text"]["running"] in page


def _shorten(path, n_points):
    """What a run that was killed after so many points leaves."""
    with h5py.File(path, "a") as file:
        file.attrs["status"] = "running"
        for name in ("settlement", "wall_time", "compile_time"):
            del file.attrs[name]
        del file["blocks_left"]
        file["contacts/offset"].resize(n_points + 1, axis=0)


@pytest.mark.parametrize("n_points", [0, 1, 5])
def test_a_folder_that_a_killed_run_left(plain, n_points):
    _shorten(plain / "results.h5", n_points)
    for name in ("summary.json", "curve.csv", "curve.png", "mechanism.png"):
        (plain / name).unlink()
    shutil.rmtree(plain / "paraview")
    page = render(Folder.read(plain), date=DATE)
    assert words()["text"]["running"] in text_of(page)
    assert ("<svg" in unfolded(page)) == (n_points > 0)


def test_a_model_that_cannot_be_read_leaves_what_the_results_say(plain):
    with h5py.File(plain / "results.h5", "a") as file:
        file.attrs["model"] = "from another time"
    page = text_of(render(Folder.read(plain), date=DATE))
    assert words()["text"]["unreadable"] in page
    assert words()["section"]["curve"] in page


def test_texts_of_the_user_are_letters_not_markup(tmp_path):
    text = (EXAMPLES / "two_blocks.toml").read_text()
    title = "<b>x</b> & </script><script>alert(1)</script>"
    file = tmp_path / "model.toml"
    file.write_text(re.sub(r'^title = ".*?"', f"title = '{title}'", text, flags=re.M))
    model = ds.read_model(file)
    assert model.title == title
    ds.save_results(ds.pushover(model), model, tmp_path / "out")
    page = render(Folder.read(tmp_path / "out"), date=DATE)
    assert "<script>alert" not in page and "<b>x</b>" not in page
    assert page.count("</script>") == 2


def test_words_are_all_used_and_all_there():
    """A key that nothing asks for is left over; one that is missing is an error of the template."""
    source = "".join(
        path.read_text(encoding="utf-8")
        for path in (ROOT / "src/drystone/report/document").rglob("*")
        if path.suffix in (".py", ".j2")
    )
    put_together = {  # of kinds, states and places, whose names are elsewhere
        *STATES, *(f"kind_{kind}" for kind in KINDS), *(f"at_{point}" for point in POINTS),
        *(name.replace(" ", "_") for _, _, name in TIES.values()), "on_block", "on_group",
        *(f"reaction_{name}" for name in ("first", "least", "greatest", "last")),
    }  # fmt: skip
    data = tomllib.loads(
        (ROOT / "src/drystone/common/language/en/report.toml").read_text(encoding="utf-8")
    )
    for name, section in data.items():
        # Of engineers' remarks and of cycles all words are asked for.
        if isinstance(section, dict) and name not in ("engineer", "cycles"):
            for key in set(section) - put_together:
                asked = re.search(rf"\b{key}\b", source)
                assert asked, f"[{name}] {key}"
    with pytest.raises(ValueError, match="there are no words"):
        words("xx")


def test_both_senses_are_drawn_and_the_one_that_governs_is_named(asked, tmp_path):
    shutil.copytree(asked, tmp_path / "out")
    shutil.copytree(asked, tmp_path / "out" / "opposite")
    digest = load_results(asked).sha256
    with h5py.File(tmp_path / "out" / "opposite" / "results.h5", "a") as file:
        file.attrs["part_of"] = digest
    data = {
        "model_sha256": digest,
        "sentence": "s", "governing_sense": "against the load",
        "limit_states": {"SLV": {"limit_control_displacement": 0.05}},
        "senses": {"along the load": {"limit_states": {}}},
    }  # fmt: skip
    (tmp_path / "out" / "assessment.json").write_text(json.dumps(data))
    judged = Judged.of(Folder.read(tmp_path / "out"))
    assert judged.governing.results.path.name == "opposite"
    assert not judged.folder.limit_marks  # its own sense has none
    (mark,) = judged.governing.limit_marks
    assert mark.name == "SLV"
    page = text_of(render(Folder.read(tmp_path / "out"), date=DATE))
    assert "against the load governs" in page
    assert "SLV: control displacement" in page


def test_the_picture_of_a_state_has_the_colours_of_its_bodies(asked):
    from drystone.report import Mechanism
    from drystone.report.mechanism import BODIES, RESTING

    results = Folder.read(asked).results
    model, pose = results.model, results.poses[-3]
    bodies = np.arange(model.assembly.n_bodies) - 1
    mechanism = Mechanism(
        assembly=model.assembly, pose=pose, initial=results.poses[0], bodies=bodies
    )
    picture = figures.state_picture(mechanism, 'a "state"')
    assert 'alt="a &quot;state&quot;"' in picture
    data = unfolded(picture)
    fixed = model.assembly.fixed
    wanted = {RESTING if k < 0 else BODIES[k % len(BODIES)] for k in bodies[~fixed].tolist()}
    for colour in wanted:
        assert f"fill: {colour}" in data
    assert figures.state_picture(mechanism, 'a "state"') == picture  # the same in every run


def test_the_commands_write_report_and_view(plain, tmp_path):
    run = CliRunner().invoke
    for command in ("report", "view"):
        result = run(app, [command, str(plain), "--json"])
        assert result.exit_code == 0
        told = json.loads(result.stdout)
        assert Path(told["file"]) == plain / f"{command}.html"
        assert told["bytes"] == (plain / f"{command}.html").stat().st_size
        other = tmp_path / f"{command}.html"
        assert run(app, [command, str(plain), "--out", str(other), "--quiet"]).output == ""
        assert other.is_file()
        wrong = run(app, [command, str(tmp_path), "--json"])
        assert wrong.exit_code == 2
        assert "results.h5 cannot be read" in json.loads(wrong.stdout)["problems"][0]
        taken = run(app, [command, str(plain), "--out", str(plain / "results.h5")])
        assert taken.exit_code == 2
    assert (plain / "results.h5").stat().st_size > 1000


def test_show_writes_a_page_of_a_model_at_rest(tmp_path):
    page = tmp_path / "model.html"
    model = str(EXAMPLES / "two_blocks.toml")
    result = CliRunner().invoke(app, ["show", model, "--out", str(page), "--json"])
    assert result.exit_code == 0 and json.loads(result.stdout)["file"] == str(page)
    assert 'class="dimension-2 still"' in page.read_text(encoding="utf-8")
    wrong = CliRunner().invoke(app, ["show", model, "--out", str(tmp_path / "x.gif")])
    assert wrong.exit_code == 2 and ".html" in wrong.output


def test_a_new_analysis_takes_the_assessment_of_the_last_one_away(plain):
    for name in ("assessment.json", "adrs.svg", "adrs.png"):
        (plain / name).write_text("{}")
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    ds.save_results(ds.pushover(model), model, plain)
    assert not (plain / "assessment.json").exists() and not list(plain.glob("adrs.*"))


@pytest.mark.parametrize("language", ["en", "it"])
def test_a_report_of_cycles_tells_each_of_them(tmp_path, language):
    model = ds.read_model(EXAMPLES / "gate.toml")
    model = model.with_history([0.002, -0.002, 0.003, -0.003, 0.0])
    curve = ds.pushover(model, keep_poses=True, keep_contacts=True)
    ds.save_results(curve, model, tmp_path / "out")
    text = text_of(render(Folder.read(tmp_path / "out"), language=language))
    t = words(language)
    assert len(curve.cycles) == 2 and t["section"]["cycles"] in text
    assert t["text"]["sense_cyclic"] in text and t["text"]["sense_without"] not in text
    assert all(head in text for head in t["cycles"].values())
