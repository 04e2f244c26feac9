"""The viewer without a browser: what is packed, and what its JavaScript makes of it, by node."""

import importlib
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import drystone as ds
from drystone.geometry.motion import moved_points
from drystone.io.results.results_reader import ResultsReader
from drystone.report.folder.results import load_results
from drystone.report.viewer import contents_of_folder, contents_of_model, page
from drystone.report.viewer.codec import Pack, round_to_integers
from drystone.report.viewer.folder import Folder
from drystone.report.viewer.page import MODULES, asset, script
from piers import piers

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples"
NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")


def decoded(header, pack, points=None):
    """What the viewer's own code makes of a header and its streams."""
    given = {"header": {**header, "streams": pack.table}, "streams": pack.text(), "points": points}
    done = subprocess.run(
        [NODE, HERE / "decode.mjs"], input=json.dumps(given), capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@needs_node
def test_the_tests_of_its_own():
    files = sorted(map(str, HERE.glob("*.test.mjs")))
    done = subprocess.run(
        [NODE, "--test", *files], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stdout[-5000:]
    assert int(re.search(r"^# pass (\d+)$", done.stdout, re.M)[1]) >= 36


@needs_node
def test_streams_come_back_as_they_were():
    rng = np.random.default_rng(3)
    pack = Pack()
    sent = {
        "floats": (rng.standard_normal((5, 3, 7)), "f4", True),
        "still": (rng.standard_normal(4), "f4", False),
        "short": (rng.integers(-32767, 32767, (6, 11)), "i2", True),
        "bytes": (rng.integers(0, 255, (3, 5)), "u1", True),
        "none": (np.zeros((0, 2)), "f4", True),
        "rows": (rng.integers(0, 2**31, 9), "u4", False),
    }
    for name, (values, kind, varying) in sent.items():
        pack.put(name, values, kind, varying=varying)
    back = decoded({}, pack)
    for name, (values, kind, _) in sent.items():
        # To the last bit: differences are those of the bits.
        assert np.array_equal(np.array(back[name], kind), values.astype(kind).ravel()), name


def test_rounded_values_are_off_by_half_a_step():
    rng = np.random.default_rng(5)
    values = rng.standard_normal((4, 50, 3)) * 10.0 ** rng.integers(-6, 6, (4, 1, 3))
    for bits in (12, 16):
        numbers, scale = round_to_integers(values, bits)
        assert np.abs(numbers).max() <= 2 ** (bits - 1) - 1
        gap = np.abs(numbers * scale[:, None] - values).max(axis=1)
        assert (gap <= 0.5 * scale * (1.0 + 1e-9)).all()


@pytest.fixture(scope="module", params=["two_blocks.toml", "solids.toml"])
def folder(request, tmp_path_factory):
    """Results of a small model of the plane, and of one in space."""
    model = ds.read_model(EXAMPLES / request.param)
    curve = ds.pushover(model)
    path = tmp_path_factory.mktemp("folder")
    ds.save_results(curve, model, path)
    return path


@needs_node
@pytest.mark.parametrize("many", [False, True])
def test_states_are_those_of_the_analysis(folder, many, monkeypatch):
    """Every vertex and every joint's force and place, against the poses and contacts themselves."""
    from drystone.report.viewer import contents

    if many:  # rounded, as large structures are
        monkeypatch.setattr(contents, "MOST_FLOATS", 0)
    results = load_results(folder)
    packed = contents_of_folder(results)
    n = len(results.curve.points)
    points = [0, n // 2, n - 1]
    told = decoded(packed.header, packed.pack, points)
    dim = packed.header["dimension"]
    origin = np.array(packed.header["origin"])
    assembly = results.model.assembly
    bodies = _bodies(results)
    # Floats have 24 bits; rounded, a pose is off by 1.5e-5 of the largest displacement.
    reach = max(np.ptp(bodies.vertices), np.abs(results.poses[..., :dim]).max())
    for k, vertices, forces in zip(points, told["vertices"], told["forces"], strict=True):
        pose = results.poses[k]
        moved = moved_points(bodies.vertices, bodies.owner, assembly.centroid, pose) - origin
        assert np.abs(np.array(vertices)[:, :dim] - moved).max() < (1e-4 if many else 2e-6) * reach
        contacts = results.contacts[k]
        force = contacts.vectors()
        heavy = max(np.abs(force).max(), 1.0)
        pairs = {tuple(joint["pair"]) for joint in forces}
        for a, b in pairs:
            own = (contacts.block_a == a) & (contacts.block_b == b)
            other = (contacts.block_a == b) & (contacts.block_b == a)
            total = force[own].sum(axis=0) - force[other].sum(axis=0)
            shown = sum(np.array(j["force"])[:dim] for j in forces if tuple(j["pair"]) == (a, b))
            assert np.abs(shown - total).max() < (2e-4 if many else 1e-5) * heavy * len(
                contacts.gap
            )
        for joint in forces:
            own = (contacts.block_a == joint["pair"][0]) & (contacts.block_b == joint["pair"][1])
            press = np.maximum(contacts.normal_reaction[own], 0.0)
            alone = sum(j["pair"] == joint["pair"] for j in forces) == 1
            if not alone or press.sum() <= 0.0 or len(set(map(tuple, contacts.normal[own]))) > 1:
                continue
            centre = press @ contacts.position[own] / press.sum() - origin
            # The place lies in the joint's plane; contact points may be off it by a penetration.
            off = np.array(joint["place"])[:dim] - centre
            normal = contacts.normal[own][0]
            off -= (off @ normal) * normal
            assert np.abs(off).max() < (2e-3 if many else 1e-4) * reach


def _bodies(results):
    from drystone.report.viewer.contents import _Blocks

    with ResultsReader(results.path / "results.h5") as reader:
        return _Blocks.stored(reader.blocks(), results.model).bodies


def test_triangles_cover_blocks_and_solids_are_closed(folder):
    """Areas add up to those of the outlines; of solids, volumes by the divergence theorem."""
    results = load_results(folder)
    bodies = _bodies(results)
    assembly = results.model.assembly
    p = bodies.vertices[bodies.triangles]
    owner = bodies.owner[bodies.triangles[:, 0]]
    if assembly.dimension == 2:
        e, f = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        size = 0.5 * (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]) * assembly.thickness
    else:
        size = np.einsum("ti,ti->t", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
    total = np.bincount(owner, size, minlength=assembly.n_bodies)
    assert np.allclose(total, assembly.volume, rtol=1e-9)


def test_edges_where_parts_of_a_block_merely_meet_are_not_drawn():
    # Two boxes side by side as one block of 2 x 1 x 1: 12 edges, those along x in two pieces.
    from drystone.geometry.space.polyhedra import Polyhedra
    from drystone.geometry.space.solid import box
    from drystone.report.viewer.bodies import Bodies

    parts = [box([[0, 0, 0], [1, 1, 1]]), box([[1, 0, 0], [2, 1, 1]])]
    bodies = Bodies.of_solids(Polyhedra.pack([parts]))
    assert len(bodies.edges) == 8 + 2 * 4
    step = [box([[0, 0, 0], [1, 1, 1]]), box([[1, 0, 0], [2, 1, 0.5]])]
    kept = Bodies.of_solids(Polyhedra.pack([step]))
    assert len(kept.edges) > len(bodies.edges)


def test_points_are_left_out_of_what_is_too_large(folder, monkeypatch):
    from drystone.report.viewer import contents

    monkeypatch.setattr(contents, "MOST_NUMBERS", 1)
    monkeypatch.setattr(contents, "FEWEST_POINTS", 20)
    results = load_results(folder)
    header = contents_of_folder(results).header
    curve = header["curve"]
    assert curve["n_points"] == len(results.curve.points)
    assert len(curve["step"]) <= 20 < curve["n_points"]
    assert {0, curve["n_points"] - 1} <= set(curve["step"])
    peak = header["marks"][0]
    assert curve["step"][peak["point"]] == results.curve.peak.step


def test_a_folder_that_a_killed_run_left_is_shown(folder, tmp_path):
    shutil.copy(folder / "results.h5", tmp_path)
    import h5py

    with h5py.File(tmp_path / "results.h5", "a") as file:
        file.attrs["status"], file.attrs["model"] = "running", "not a model"
        del file["blocks_left"]
    packed = Folder.read(tmp_path).contents()
    assert packed.header["status"] == "running"
    assert "killed" in packed.header["reason"]
    assert "control" not in packed.header  # its model cannot be read
    assert len(packed.header["curve"]["step"]) > 2
    assert "results" in page(packed)


def test_limit_states_are_marked_beyond_the_peak(folder, tmp_path):
    shutil.copy(folder / "results.h5", tmp_path)
    curve = load_results(folder).curve
    far = 0.5 * (curve.peak.control_displacement + curve.points[-1].control_displacement)
    states = {
        "SLV": {"limit_control_displacement": far},
        "SLC": {"limit_control_displacement": 1e3},  # the curve does not reach it
        "SLD": {"limit_control_displacement": None},
    }
    (tmp_path / "assessment.json").write_text(
        json.dumps({"limit_states": states, "model_sha256": load_results(folder).sha256})
    )
    marks = Folder.read(tmp_path).contents().header["marks"]
    (mark,) = [mark for mark in marks if mark["kind"] == "limit"]
    assert mark["name"] == "SLV"
    near = curve.control_displacement[mark["point"]]
    assert abs(near - far) <= np.diff(np.sort(curve.control_displacement)).max()


def test_a_page_holds_everything_and_ends_no_element_early():
    model = ds.read_model(EXAMPLES / "two_blocks.toml")
    from dataclasses import replace

    text = page(contents_of_model(replace(model, title='<script>alert("x")</script> & <!--')))
    assert "<script>alert" not in text
    assert text.count("</script>") == 3
    assert not re.findall(r'(?:src|href)="', text)
    outside = re.findall(r"https?://[^\s\"'`)]+", text)
    known = ("http://www.w3.org/", "https://threejs.org", "https://github.com", "https://jcgt.org")
    assert all(url.startswith(known) for url in outside), outside
    header = re.search(r'id="header">(.*?)</script>', text, re.S)[1]
    assert json.loads(header)["title"].startswith("<script>")


def test_modules_are_joined_in_the_order_of_their_imports():
    assert "</script" not in script().lower()
    assert not re.search(r"^(import|export)\b", script(), re.M)
    files = {
        path.name for path in (HERE.parents[1] / "src/drystone/report/viewer/assets").glob("*.js")
    }
    assert set(MODULES) == files
    for place, name in enumerate(MODULES):
        needed = re.findall(r'from "\./([\w.]+)"', asset(name))
        assert set(needed) <= set(MODULES[:place]), name


def test_forms_of_import_that_are_not_known_are_an_error(monkeypatch):
    module = importlib.import_module("drystone.report.viewer.page")
    monkeypatch.setattr(module, "MODULES", ("odd.js",))
    monkeypatch.setattr(module, "asset", lambda name: 'import odd from "./odd.js";\n')
    module.script.cache_clear()
    try:
        with pytest.raises(ValueError, match=r"odd\.js"):
            module.script()
    finally:
        module.script.cache_clear()


def test_a_page_knows_ties_and_dead_loads(tmp_path):
    """Where they are as designed, and what ties carry at every point that is shown."""
    model = piers(control_block="left").with_analysis(max_displacement=0.02)
    curve = ds.pushover(model)
    ds.save_results(curve, model, tmp_path / "out")
    found = Folder.read(tmp_path / "out")
    made = contents_of_folder(found.results)
    curve = found.results.curve
    (tie,) = made.header["ties"]
    origin = np.array(made.header["origin"])
    assert (tie["name"], tie["strength"]) == ("anchor", 1e3)
    assert tie["from"]["block"] == 1 and tie["to"]["block"] == -1
    assert origin + tie["to"]["point"] == pytest.approx([-3.0, 1.5])
    assert [load["name"] for load in made.header["dead_loads"]] == ["roof", "load 2"]
    assert [arrow["block"] for arrow in made.header["arrows"]] == [2, 1]
    assert origin + made.header["arrows"][0]["tip"] == pytest.approx([2.25, 2.0])
    streams = {stream["name"]: stream for stream in made.pack.table}
    n = len(curve.points)
    assert streams["tie_force"]["shape"] == streams["tie_state"]["shape"] == [n, 1]
    assert contents_of_model(model).header["ties"] == made.header["ties"]
