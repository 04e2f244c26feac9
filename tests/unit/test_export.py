"""Results as files: what is written is what was computed, and readers of others can read it."""

from __future__ import annotations

import csv
import json
import math
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import fields, replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic

from drystone.cli.run import remarks
from drystone.contact.forces import ContactForces
from drystone.io.results import results_writer
from drystone.io.results.csv import LEADING, write_curve, write_ties
from drystone.io.results.folder import OutputError
from drystone.io.results.results_reader import ResultsReader
from drystone.io.results.results_writer import ResultsWriter
from drystone.io.results.summary import plain, summarise, to_json
from drystone.limit.beside import Beside
from drystone.report.folder.directory import ResultsDirectory
from drystone.report.folder.pictures import mechanism_row
from drystone.results.curve import COLUMNS, SETTLEMENT
from drystone.results.events import Event, EventKind
from drystone.results.forces import TieRecord
from drystone.results.frames import rows_along

FILES = {"summary.json", "curve.csv", "curve.png", "mechanism.png", "results.h5", "paraview"}
PROMISED = {
    *("engine", "status", "reason", "n_blocks", "n_steps", "peak_multiplier", "peak_displacement"),
    *("ultimate_displacement", "max_residual", "max_penetration", "wall_time", "version"),
    "model_sha256",
}


@pytest.fixture
def model():
    return synthetic.wall_model()


@pytest.fixture
def curve():
    return synthetic.curve()


@pytest.fixture
def folder(tmp_path, model, curve):
    """Of a whole analysis."""
    synthetic.record(ResultsDirectory(tmp_path / "out"), model, curve)
    return tmp_path / "out"


# csv


def test_curve_csv_gives_every_number_back(tmp_path):
    third = replace(synthetic.point(1, 1 / 3, np.float64(0.1)), residual=math.nan)
    curve = replace(synthetic.curve(), points=(synthetic.point(0, 0.0, 0.0), third))
    write_curve(curve, tmp_path / "curve.csv")
    with (tmp_path / "curve.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert tuple(lines[0])[: len(LEADING)] == LEADING and set(lines[0]) == set(COLUMNS)
    assert float(lines[1]["control_displacement"]) == 1 / 3
    assert lines[1]["load_multiplier"] == "0.1"
    assert math.isnan(float(lines[1]["residual"]))
    assert (lines[1]["step"], lines[1]["status"]) == ("1", "static")


def test_names_of_ties_are_no_formulas(tmp_path):
    """Spreadsheets calculate what begins with one of = + - @; numbers below zero stay numbers."""
    names = "=1+1", "+a", "-a", "@a", "\ta", "rod"
    force = np.full((1, len(names)), -2.5)
    branch = np.zeros(force.shape, np.int64)
    ties = TieRecord(names=names, force=force, elongation=force, branch=branch)
    curve = replace(synthetic.curve(), points=(synthetic.point(0, 0.0, 0.0),))
    write_ties(curve, ties, tmp_path / "ties.csv")
    with (tmp_path / "ties.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert [line["tie"] for line in lines] == ["'=1+1", "'+a", "'-a", "'@a", "'\ta", "rod"]
    assert {line["force"] for line in lines} == {"-2.5"}


# summary


def test_summary_holds_what_is_promised(folder, model, curve):
    summary = json.loads((folder / "summary.json").read_text())
    assert set(summary) >= PROMISED
    assert summary["n_blocks"] == 12 and summary["n_steps"] == len(curve.points) - 1
    assert summary["peak_multiplier"] == curve.peak.load_multiplier
    assert summary["ultimate_displacement"] == curve.ultimate_displacement
    assert summary["peak"]["penetration"] == 1e-5
    assert not (folder / "summary.json.part").exists()


def test_summary_has_null_for_what_there_is_none_of(model):
    points = tuple(replace(p, residual=math.nan) for p in synthetic.points(end=0.1))
    summary = summarise(replace(synthetic.curve(), points=points), model)
    assert summary["ultimate_displacement"] is None and summary["max_residual"] is None


def test_json_takes_numpy_and_no_nan():
    value = {"a": np.float64(math.inf), "b": np.arange(2), "c": (np.bool_(True), math.nan)}
    assert plain(value) == {"a": None, "b": [0, 1], "c": [True, None]}
    assert json.loads(to_json(value)) == plain(value)


# HDF5


def test_results_read_back_to_the_last_bit(folder, model, curve):
    with ResultsReader(folder / "results.h5") as results:
        assert results.points() == curve.points
        assert results.attribute("status") == "finished"
        for k in (0, 30, results.n_points - 1):
            pose = synthetic.pose_at(model, curve.points[k].control_displacement)
            np.testing.assert_array_equal(results.pose(k), pose)
            expected = synthetic.contacts_at(model, pose)
            found = results.contacts(k)
            for field in fields(ContactForces):
                np.testing.assert_array_equal(
                    getattr(found, field.name), getattr(expected, field.name)
                )


def test_results_describe_themselves(tmp_path):
    source = synthetic.write_model(tmp_path)
    model = synthetic.wall_model(source=str(source))
    ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement").close()
    with h5py.File(tmp_path / "r.h5") as file:
        assert file.attrs["model"] == source.read_text()
        assert file.attrs["status"] == "running" and file.attrs["model_sha256"] == model.sha256
        assert file["blocks/id"].asstr()[:].tolist() == list(model.assembly.ids)
        assert file["blocks/vertices"].attrs["unit"] == "m"
        assert file["curve/penetration"].attrs["unit"] == "m"
        assert file["contacts/normal_reaction"].attrs["unit"] == "N"


def test_contacts_may_come_and_go(tmp_path, model):
    """From one point to the next their number changes, also to none."""
    full = synthetic.contacts_at(model, model.assembly.design_pose())
    none = ContactForces(**{f.name: getattr(full, f.name)[:0] for f in fields(ContactForces)})
    writer = ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement")
    for k, contacts in enumerate((none, full, none, full)):
        writer.append(synthetic.point(k, 0.0, 0.0), model.assembly.design_pose(), contacts)
    writer.close()
    with ResultsReader(tmp_path / "r.h5") as results:
        assert [results.contacts(k).n_contacts for k in range(4)] == [0, 24, 0, 24]


def test_large_assemblies_are_compressed(tmp_path, monkeypatch, model, curve):
    monkeypatch.setattr(results_writer, "MANY_BODIES", 1)
    synthetic.record(ResultsDirectory(tmp_path / "out"), model, curve)
    with h5py.File(tmp_path / "out/results.h5") as file:
        assert file["poses"].compression == "gzip"
    with ResultsReader(tmp_path / "out/results.h5") as results:
        assert results.points() == curve.points


def test_much_data_does_not_wait_for_the_clock(tmp_path, monkeypatch, model):
    monkeypatch.setattr(results_writer, "BYTES", 1)
    writer = ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement")
    pose = model.assembly.design_pose()
    writer.append(synthetic.point(0, 0.0, 0.0), pose, synthetic.contacts_at(model, pose))
    with ResultsReader(tmp_path / "r.h5") as results:  # still open for writing
        assert results.n_points == 1
    writer.close()


def test_killed_process_leaves_its_points(tmp_path):
    """Killed without any chance to tidy up: what was flushed is there."""
    code = (
        "import sys, time, synthetic; from drystone.io.results import results_writer\n"
        "results_writer.SECONDS = results_writer.TIMES = 0.0\n"
        "from drystone.report.folder.directory import ResultsDirectory\n"
        "m = synthetic.wall_model(); d = ResultsDirectory(sys.argv[1]); d.begin(m, 'nscd', 'd')\n"
        "for p in synthetic.points():\n"
        "    pose = synthetic.pose_at(m, p.control_displacement)\n"
        "    d.point(p, pose, synthetic.contacts_at(m, pose))\n"
        "print('ready', flush=True); time.sleep(60)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "out")],
        stdout=subprocess.PIPE,
        env=synthetic.environment(),
    ) as child:
        assert child.stdout is not None and child.stdout.readline() == b"ready\n"
        child.send_signal(signal.SIGKILL)
    with ResultsReader(tmp_path / "out/results.h5") as results:
        assert results.points() == tuple(synthetic.points())
        assert results.attribute("status") == "running"


# ParaView


def test_frames_are_even_along_the_way_not_in_step():
    # Nine tenths of the points lie in the first tenth of the way.
    x = np.concatenate((np.linspace(0.0, 0.1, 900), np.linspace(0.1, 1.0, 101)[1:]))
    frames = rows_along(x, 11, keep=[17])
    assert frames[0] == 0 and frames[-1] == len(x) - 1 and 17 in frames
    rest = [row for row in frames if row != 17]
    np.testing.assert_allclose(x[rest], np.linspace(0.0, 1.0, 11), atol=1e-2)  # spacing of x


def test_frames_of_a_curve_that_turns_back():
    """Its way back was left out, at displacements that it had been at before."""
    x = np.array([0.0, 0.1, 0.2, 0.15, 0.2, 0.3, 0.25])
    assert rows_along(x, 100, keep=[2]) == list(range(7))
    to_and_fro = np.concatenate((np.linspace(0.0, 2.0, 101), np.linspace(2.0, 0.0, 101)[1:]))
    assert rows_along(to_and_fro, 5) == [0, 50, 100, 150, 200]


@pytest.mark.parametrize("x", [[], [0.0], [0.0, 0.0], [0.0, 1e-9]])
def test_frames_of_next_to_nothing(x):
    assert rows_along(np.array(x), 100) == list(range(len(x)))


def series(path: Path) -> list[tuple[float, str]]:
    entries = ET.parse(path).getroot().iter("DataSet")
    return [(float(e.attrib["timestep"]), e.attrib["file"]) for e in entries]


def test_series_name_files_that_exist(folder, curve):
    for name in ("blocks", "contacts"):
        entries = series(folder / f"paraview/{name}.pvd")
        assert all((folder / "paraview" / file).is_file() for _, file in entries)
        times = [time for time, _ in entries]
        assert times[0] == 0.0 and times[-1] == curve.points[-1].step
        assert curve.peak.step in times


def test_time_of_a_series_never_goes_back(tmp_path, model, curve):
    """Where the control displacement does, ParaView would show the frames out of order."""
    x = 0.05 + 0.05 * np.sin(0.3 * np.arange(len(curve.points)))
    points = tuple(
        replace(p, control_displacement=float(d)) for p, d in zip(curve.points, x, strict=True)
    )
    synthetic.record(ResultsDirectory(tmp_path), model, replace(curve, points=points))
    times = [time for time, _ in series(tmp_path / "paraview/blocks.pvd")]
    assert len(times) > 10 and np.all(np.diff(times) > 0.0)


def test_paraview_reads_the_blocks(folder, model, curve):
    pyvista = pytest.importorskip("pyvista")
    reader = pyvista.get_reader(folder / "paraview/blocks.pvd")
    reader.set_active_time_value(reader.time_values[-1])
    grid = reader.read()[0]
    pose = synthetic.pose_at(model, curve.points[-1].control_displacement)
    assert grid.n_cells == model.assembly.n_bodies
    for i in range(grid.n_cells):
        np.testing.assert_allclose(
            grid.get_cell(i).points[:, :2], model.assembly.outline(i, pose), atol=1e-14
        )
    np.testing.assert_array_equal(grid["displacement"][:, :2], pose[:, :2])
    np.testing.assert_array_equal(grid["rotation"], pose[:, 2])
    assert grid["is_support"].tolist() == [1] + [0] * 12
    assert grid["moving"].tolist() == [0] * 4 + [1] * 9
    assert grid.field_data["load_multiplier"][0] == curve.points[-1].load_multiplier


def test_paraview_reads_the_contacts(folder, model, curve):
    pyvista = pytest.importorskip("pyvista")
    file = series(folder / "paraview/contacts.pvd")[-1][1]
    grid = pyvista.read(folder / "paraview" / file)
    contacts = synthetic.contacts_at(
        model, synthetic.pose_at(model, curve.points[-1].control_displacement)
    )
    np.testing.assert_array_equal(grid.points[:, :2], contacts.position)
    np.testing.assert_array_equal(grid["reaction"][:, :2], contacts.vectors())
    np.testing.assert_array_equal(grid["gap"], contacts.gap)
    np.testing.assert_array_equal(grid["status"], contacts.status)


def test_paraview_reads_large_arrays_and_empty_ones(tmp_path, model):
    """Arrays of several compressed pieces, and of none."""
    pyvista = pytest.importorskip("pyvista")
    from drystone.io.results import vtu
    from drystone.io.results.paraview import write_contacts

    n = vtu.PIECE // 8 + 3  # of 24 bytes each: three whole pieces and a part
    points = np.random.default_rng(1).normal(size=(n, 3))
    rows = np.arange(n)
    cells = vtu.cells(rows, rows + 1, vtu.VERTEX)
    vtu.write_vtu(tmp_path / "large.vtu", points=points, n_cells=n, cells=cells)
    np.testing.assert_array_equal(pyvista.read(tmp_path / "large.vtu").points, points)

    whole = points[: vtu.PIECE // 8]  # exactly three pieces, no part
    cells = vtu.cells(rows[: len(whole)], rows[: len(whole)] + 1, vtu.VERTEX)
    vtu.write_vtu(tmp_path / "whole.vtu", points=whole, n_cells=len(whole), cells=cells)
    np.testing.assert_array_equal(pyvista.read(tmp_path / "whole.vtu").points, whole)

    full = synthetic.contacts_at(model, model.assembly.design_pose())
    none = ContactForces(**{f.name: getattr(full, f.name)[:0] for f in fields(ContactForces)})
    write_contacts(tmp_path / "none.vtu", none)
    assert pyvista.read(tmp_path / "none.vtu").n_points == 0


# the folder


def test_folder_is_complete(folder):
    assert {path.name for path in folder.iterdir()} == FILES


@pytest.mark.parametrize("end", [0.0, 1e-3])
def test_folder_of_a_curve_cut_short_is_complete(tmp_path, model, end):
    """Interrupted at rest, and before the peak."""
    curve = synthetic.curve(end=end, status="interrupted")
    synthetic.record(ResultsDirectory(tmp_path), model, curve)
    assert {path.name for path in tmp_path.iterdir()} == FILES
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["status"] == "interrupted" and summary["ultimate_displacement"] is None
    assert len(series(tmp_path / "paraview/blocks.pvd")) >= 1


def test_nothing_is_written_before_the_first_point(tmp_path, model, curve):
    results = ResultsDirectory(tmp_path / "deep/down")
    results.begin(model, "nscd", "displacement")
    results.end(replace(curve, points=()))
    results.close()
    assert not results.begun and list(tmp_path.iterdir()) == []


def test_old_results_are_replaced_and_nothing_else(folder, model):
    (folder / "notes.txt").write_text("mine")
    (folder / "paraview/view.pvsm").write_text("mine")
    before = len(list((folder / "paraview").iterdir()))
    results = ResultsDirectory(folder)
    assert (folder / "summary.json").exists()  # until there is something to replace it
    short = synthetic.curve(end=0.0)
    results.begin(model, "nscd", "displacement")
    pose = model.assembly.design_pose()
    results.point(short.points[0], pose, synthetic.contacts_at(model, pose))
    assert not (folder / "summary.json").exists()
    results.end(short)
    assert {path.name for path in folder.iterdir()} == FILES | {"notes.txt"}
    left = {path.name for path in (folder / "paraview").iterdir()}
    assert left == {
        *("blocks.pvd", "blocks_0000.vtu", "contacts.pvd", "contacts_0000.vtu", "view.pvsm")
    }
    assert before > len(left)


def test_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file", tmp_path / "file/below"):
        with pytest.raises(OutputError, match="folder"):
            ResultsDirectory(path)
    with pytest.raises(OutputError, match="cannot be written"):
        ResultsDirectory("/proc/results")  # no one may write there, root neither


def test_no_folder_is_made_before_the_first_point(tmp_path, monkeypatch):
    """Several analyses that write beside each other would remove each other's."""
    monkeypatch.setattr(Path, "mkdir", None)
    ResultsDirectory(tmp_path / "all" / "one")
    assert not list(tmp_path.iterdir())


def test_full_disk_is_a_sentence(tmp_path, model, curve, monkeypatch):
    results = ResultsDirectory(tmp_path)

    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("drystone.io.results.csv.write_curve", refuse)
    with pytest.raises(OutputError, match="No space left"):
        synthetic.record(results, model, curve)


FULL_DISK = """
import resource, sys, synthetic
from dataclasses import replace
from drystone.io.results import results_writer
from drystone.report.folder.directory import ResultsDirectory
from drystone.io.results.folder import OutputError

results_writer.SECONDS = results_writer.TIMES = 0.0  # every point goes to the disk at once
folder, limit = sys.argv[1], int(sys.argv[2])
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
model = synthetic.wall_model()
curve = synthetic.curve(600)
results = ResultsDirectory(folder)
results.begin(model, "nscd", "displacement")
reached = []
for p in curve.points:
    pose = synthetic.pose_at(model, p.control_displacement)
    try:
        results.point(p, pose, synthetic.contacts_at(model, pose))
    except OutputError as error:
        print(error)
        break
    reached.append(p)
try:
    results.end(replace(curve, points=tuple(reached), status="stopped"))
except OutputError as error:
    print(error)
results.close()
print(len(reached))
"""


def kept_of_a_full_disk(folder: Path, limit: int) -> int:
    """Run `FULL_DISK`; number of points in its ``results.h5``, all of which are those reached."""
    done = synthetic.python(FULL_DISK, str(folder), str(limit))  # fails if it ends by a signal
    *sentences, n_reached = done.stdout.splitlines()
    assert sentences and all("cannot be written" in line for line in sentences)
    with ResultsReader(folder / "results.h5") as results:
        assert results.attribute("status") == "running"
        assert results.points() == tuple(synthetic.points(600)[: results.n_points])
        assert results.n_points == int(n_reached) > 0
        results.contacts(results.n_points - 1)
    return int(n_reached)


def test_full_disk_leaves_readable_results(tmp_path):
    """A limit on the size of files stands for the disk: HDF5 ended the process by a signal."""
    pytest.importorskip("resource")
    # The first chunks take 1.37 MB, 64 poses another 20 kB each.
    n_reached = kept_of_a_full_disk(tmp_path / "out", 1_450_000)
    with (tmp_path / "out/curve.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == n_reached  # it is small, and fits
    assert json.loads((tmp_path / "out/summary.json").read_text())["status"] == "stopped"


def test_full_disk_of_its_own(tmp_path):
    """A disk that is full to the last byte, where that can be had."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1500k", "tmpfs", str(disk)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("no disk can be mounted here")
    try:
        kept_of_a_full_disk(disk / "out", 0)
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_full_disk_at_the_end_does_not_say_finished(tmp_path, model, curve, monkeypatch):
    """The last write fails: neither the file of results nor the summary may say finished."""
    results = ResultsDirectory(tmp_path / "out")
    results.begin(model, "nscd", "displacement")
    for p in curve.points:
        pose = synthetic.pose_at(model, p.control_displacement)
        results.point(p, pose, synthetic.contacts_at(model, pose))

    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("drystone.io.results.diskfile.DiskFile.commit", refuse)
    with pytest.raises(OutputError, match="No space left"):
        results.end(curve)
    with ResultsReader(tmp_path / "out/results.h5") as kept:
        assert kept.attribute("status") == "running"
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary["status"] == "stopped" and "No space left" in summary["reason"]


@pytest.fixture
def heard():
    """SIGINT as at a terminal: what a shell puts into the background ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heard")
def test_interrupted_write_is_finished_first(tmp_path, model, curve, monkeypatch):
    """The signal comes in the middle of a write, and is heard after it."""
    monkeypatch.setattr(results_writer, "SECONDS", 0.0)
    monkeypatch.setattr(results_writer, "TIMES", 0.0)
    commit = results_writer.DiskFile.commit

    def interrupted(self):
        signal.raise_signal(signal.SIGINT)
        commit(self)

    monkeypatch.setattr(results_writer.DiskFile, "commit", interrupted)
    pose = model.assembly.design_pose()
    writer = None
    with pytest.raises(KeyboardInterrupt):
        writer = ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement")
    assert writer is None and not (tmp_path / "r.h5").exists()
    monkeypatch.setattr(results_writer.DiskFile, "commit", commit)
    writer = ResultsWriter(tmp_path / "r.h5", model, "nscd", "displacement")
    monkeypatch.setattr(results_writer.DiskFile, "commit", interrupted)
    with pytest.raises(KeyboardInterrupt):
        writer.append(curve.points[0], pose, synthetic.contacts_at(model, pose))
    monkeypatch.setattr(results_writer.DiskFile, "commit", commit)
    writer.close(curve)
    with ResultsReader(tmp_path / "r.h5") as results:
        assert results.points() == curve.points[:1]


def test_two_runs_into_one_folder(tmp_path, model, curve):
    """The second is told at once, and may go on once the first has ended."""
    pose = model.assembly.design_pose()
    contacts = synthetic.contacts_at(model, pose)
    first, second = ResultsDirectory(tmp_path / "out"), ResultsDirectory(tmp_path / "out")
    for results in (first, second):
        results.begin(model, "nscd", "displacement")
    first.point(curve.points[0], pose, contacts)
    with pytest.raises(OutputError, match="another run is writing"):
        second.point(curve.points[0], pose, contacts)
    assert not second.begun
    with pytest.raises(OutputError, match="another run is writing"):
        ResultsDirectory(tmp_path / "out")
    first.end(synthetic.curve(end=0.0))
    synthetic.record(ResultsDirectory(tmp_path / "out"), model, curve)


def test_lock_of_a_killed_run_does_not_last(tmp_path, model, curve):
    code = (
        "import sys, time; from pathlib import Path\n"
        "from drystone.io.results.folder import FolderLock\n"
        "lock = FolderLock(Path(sys.argv[1])); print('ready', flush=True); time.sleep(60)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        stdout=subprocess.PIPE,
        env=synthetic.environment(),
    ) as child:
        assert child.stdout is not None and child.stdout.readline() == b"ready\n"
        with pytest.raises(OutputError, match="another run is writing"):
            ResultsDirectory(tmp_path)
        child.send_signal(signal.SIGKILL)
    synthetic.record(ResultsDirectory(tmp_path), model, curve)


def test_mechanism_is_at_the_displacement_asked_for(tmp_path, model, curve, monkeypatch):
    titles = []

    def draw(mechanism, path, *, title, format):
        titles.append(title)
        path.touch()

    monkeypatch.setattr("drystone.report.mechanism_figure.draw_mechanism", draw)
    synthetic.record(ResultsDirectory(tmp_path), model, curve)
    synthetic.record(ResultsDirectory(tmp_path, mechanism_displacement=0.1), model, curve)
    option = synthetic.wall_model(mechanism_displacement=0.3)
    synthetic.record(ResultsDirectory(tmp_path), option, curve)
    at = [float(title.split("= ")[1].split(" m")[0]) for title in titles]
    # The points of the curve are 9 mm apart.
    assert at == pytest.approx([0.2, 0.1, 0.3], abs=0.0046)


def test_mechanism_of_a_curve_that_ends_before(curve):
    short = synthetic.curve(end=0.1)
    assert mechanism_row(short, 0.2) == len(short.points) - 1


def test_a_series_of_unstable_points_is_told():
    """A single one says little: a stable equilibrium nearly always lies within micrometres."""

    def marked(*rows):
        found = synthetic.curve()
        flagged = [replace(p, unstable=p.step in rows) for p in found.points]
        return replace(found, points=tuple(flagged))

    assert marked().unstable_branch is None
    assert marked(*range(0, 60, 2)).unstable_branch is None
    branch = marked(3, *range(20, 32))
    x = branch.control_displacement
    assert branch.unstable_branch == (x[20], x[31])
    model = synthetic.wall_model()
    (said,) = (s for s in remarks(branch, model, Beside()) if "unstable branch" in s)
    assert said.startswith(f"From {x[20]:.4g} m to {x[31]:.4g} m the curve is an unstable branch")


def test_a_control_point_that_stays_behind_is_told_unless_supports_move():
    """The displacements are then those of the supports, which show every collapse."""
    model, curve = synthetic.wall_model(), synthetic.curve()
    place = {"step": 20, "control_displacement": 0.1, "load_multiplier": 0.3}
    fallen = Event(kind=EventKind.BLOCK_FALLEN, blocks=("1.1",), **place)
    loaded = replace(curve, events=(fallen,))
    said = [remarks(c, model, Beside()) for c in (loaded, replace(loaded, strategy=SETTLEMENT))]
    assert ["does not take part" in " ".join(each) for each in said] == [True, False]


def test_a_part_that_comes_loose_elsewhere_is_not_the_end():
    """The control point moves back while the multiplier falls to nothing, and then on again: that
    was told as the ultimate displacement, before the peak."""
    path = [
        (0.0, 0.0),
        (1e-3, 0.25),
        (9e-4, 0.2),
        (3e-4, 0.005),
        (9e-4, 0.2),
        (0.1, 0.1),
        (0.2, 0.005),
    ]
    points = tuple(synthetic.point(k, *place) for k, place in enumerate(path))
    curve = replace(synthetic.curve(), points=points, poses=None, contacts=None)
    assert curve.stop_multiplier == 0.01
    assert curve.ultimate_displacement == pytest.approx(0.1 + 0.1 * 0.09 / 0.095, rel=1e-12)
    # Where nothing is carried any more afterwards it is the end.
    ended = replace(curve, points=points[:4])
    assert ended.ultimate_displacement == pytest.approx(9e-4 - 6e-4 * 0.19 / 0.195, rel=1e-12)
