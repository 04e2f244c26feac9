"""A folder of results from Python: the same as the command's, and read again."""

import json
from dataclasses import fields, replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic

import drystone as ds
from builders import stack
from drystone.contact.forces import ContactForces
from drystone.io.convert import convert
from drystone.io.modelfile.write import to_toml
from drystone.io.results.results_reader import ResultsReader
from drystone.io.results.results_writer import ResultsWriter
from drystone.limit import limits_beside
from drystone.model.construction.describe import model_to_dict
from drystone.results.curve import COLUMNS, BlockLeft

#: What two runs of the same model differ in.
TIMES = {"wall_time", "compile_time"}


@pytest.fixture
def model():
    return synthetic.wall_model()


@pytest.fixture
def curve(model):
    return synthetic.pushover(model, keep_poses=True, keep_contacts=True)


def contents(folder: Path) -> dict[str, object]:
    """Every file of a folder of results, but for times and what a run goes on from."""
    found: dict[str, object] = {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix not in {".h5", ".json", ".png", ".npz"}
    }
    summary = json.loads((folder / "summary.json").read_text())
    found["summary"] = {key: value for key, value in summary.items() if key not in TIMES}
    found["pictures"] = sorted(path.name for path in folder.glob("*.png"))
    with h5py.File(folder / "results.h5") as file:
        found["attributes"] = {k: v for k, v in file.attrs.items() if k not in {*TIMES, "run"}}
        file.visititems(
            lambda name, item: (
                found.update({name: np.asarray(item).tolist()})
                if isinstance(item, h5py.Dataset)
                else None
            )
        )
    return found


def test_saved_folder_is_that_of_a_recorded_run(tmp_path):
    """With limit analysis beside, as the command has it; the wall is a real one, and short."""
    model = stack((0.4, 0.9)).with_analysis(max_displacement=0.02)
    with ds.ResultsDirectory(tmp_path / "run", beside=limits_beside(model)) as recorder:
        ds.pushover(model, recorder=recorder)
    summary = ds.save_results(ds.pushover(model), model, tmp_path / "saved")
    assert summary == json.loads((tmp_path / "saved/summary.json").read_text())
    assert contents(tmp_path / "saved") == contents(tmp_path / "run")


def test_what_was_saved_is_loaded_to_the_bit(tmp_path, model, curve):
    ds.save_results(curve, model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out")
    for name in COLUMNS:
        np.testing.assert_array_equal(loaded.curve.column(name), curve.column(name))
    np.testing.assert_array_equal(loaded.poses, curve.poses)
    assert len(loaded.contacts) == len(curve.points)
    for k in (0, 7, -1):
        for field in fields(ContactForces):
            np.testing.assert_array_equal(
                getattr(loaded.contacts[k], field.name), getattr(curve.contacts[k], field.name)
            )
    assert [c.n_contacts for c in loaded.contacts[:3]] == [c.n_contacts for c in curve.contacts[:3]]
    for name in ("engine", "strategy", "status", "reason", "stop_multiplier", "wall_time"):
        assert getattr(loaded.curve, name) == getattr(curve, name)
    assert loaded.summary["peak_multiplier"] == curve.peak.load_multiplier
    with pytest.raises(IndexError):
        loaded.contacts[len(curve.points)]


def test_the_capacity_of_a_loaded_curve_is_told_without_its_contacts(
    tmp_path, model, curve, monkeypatch
):
    """They are read when they are asked for: all together they may be gigabytes."""
    ds.save_results(curve, model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out").curve
    monkeypatch.setattr(ResultsReader, "contacts", None)
    assert len(loaded.first(3).contacts) == 3
    with pytest.raises(TypeError):
        loaded.first(3).contacts[0]


def test_files_without_a_later_column_are_loaded(tmp_path, model, curve):
    """Whether points were reached in a jump was not kept once."""
    ds.save_results(curve, model, tmp_path / "out")
    with h5py.File(tmp_path / "out/results.h5", "a") as file:
        del file["curve/jumped"]
    assert ds.load_results(tmp_path / "out").curve.points == curve.points


def test_blocks_that_left_are_loaded(tmp_path, model, curve):
    left = (
        BlockLeft(block=model.assembly.ids[3], step=4, control_displacement=0.1),
        BlockLeft(block=model.assembly.ids[2], step=6, control_displacement=0.2),
    )
    ds.save_results(replace(curve, blocks_left=left), model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out").curve
    assert loaded.blocks_left == left
    assert loaded.departed(model.assembly.ids, 5).sum() == 1


def test_model_is_loaded_with_its_digest(tmp_path, model, curve):
    """Made in Python, so that the file holds its description."""
    ds.save_results(curve, model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out")
    assert loaded.model.assembly.ids == model.assembly.ids
    assert loaded.model.sha256 == loaded.summary["model_sha256"] == model.sha256


def test_model_of_a_file_is_loaded_with_the_files_digest(tmp_path):
    path = tmp_path / "stack.toml"
    ds.write_model(stack((0.4, 0.9)), path)
    model = ds.read_model(path).with_analysis()  # nothing changed: still the file's
    ds.save_results(ds.pushover(model, max_steps=2), model, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out")
    assert loaded.model.source == str(path)
    assert loaded.model.sha256 == ds.read_model(path).sha256


def test_groups_are_loaded(tmp_path, model, curve):
    blocks = [
        replace(block, groups=("all",) + ("odd/1",) * (i % 2))
        for i, block in enumerate(model.assembly.blocks)
    ]
    grouped = replace(model, assembly=replace(model.assembly, blocks=tuple(blocks)))
    ds.save_results(curve, grouped, tmp_path / "out")
    loaded = ds.load_results(tmp_path / "out")
    n = len(blocks)
    assert {name: rows.tolist() for name, rows in loaded.groups.items()} == {
        "all": list(range(n)),
        "odd/1": list(range(1, n, 2)),
    }
    assert [block.groups for block in loaded.model.assembly.blocks] == [b.groups for b in blocks]


def test_models_that_import_are_loaded_as_they_were_read(tmp_path):
    pytest.importorskip("ezdxf")
    plain = stack((0.4, 0.9))
    convert(plain, tmp_path / "stack.dxf", "dxf")
    data = {key: v for key, v in model_to_dict(plain).items() if key not in ("block", "control")}
    name = next(iter(data["material"]))
    data["import"] = [{"file": "stack.dxf", "material": name}]
    path = tmp_path / "stack.toml"
    path.write_text(to_toml(data))
    model = ds.read_model(path)
    ds.save_results(ds.pushover(model, max_steps=2), model, tmp_path / "out")
    # Another drawing of the same name is another model, and not the one that was analysed.
    convert(stack((0.4, 0.8)), tmp_path / "stack.dxf", "dxf")
    assert ds.read_model(path).sha256 != model.sha256
    loaded = ds.load_results(tmp_path / "out")
    assert loaded.model.sha256 == model.sha256 == loaded.summary["model_sha256"]
    assert [b.vertices.tolist() for b in loaded.model.assembly.blocks] == [
        b.vertices.tolist() for b in model.assembly.blocks
    ]
    # Also when they are saved once more.
    ds.save_results(loaded.curve, loaded.model, tmp_path / "again")
    again = ds.load_results(tmp_path / "again").model
    assert [b.vertices.tolist() for b in again.assembly.blocks] == [
        b.vertices.tolist() for b in model.assembly.blocks
    ]


def test_loaded_results_can_be_saved_again(tmp_path, model, curve):
    ds.save_results(curve, model, tmp_path / "a")
    loaded = ds.load_results(tmp_path / "a")
    ds.save_results(loaded.curve, loaded.model, tmp_path / "b")
    assert contents(tmp_path / "b") == contents(tmp_path / "a")


def test_loaded_results_do_not_replace_themselves(tmp_path, model, curve):
    ds.save_results(curve, model, tmp_path / "a")
    before = contents(tmp_path / "a")
    with pytest.raises(ValueError, match="name another folder"):
        ds.save_results(ds.load_results(tmp_path / "a").curve, model, tmp_path / "b/../a")
    assert contents(tmp_path / "a") == before


def test_killed_run_is_loaded_as_far_as_it_came(tmp_path, model, curve):
    """Nothing but results.h5 is there, without an end."""
    (tmp_path / "out").mkdir()
    writer = ResultsWriter(tmp_path / "out/results.h5", model, "nscd", "displacement")
    for point, pose, contacts in zip(curve.points[:9], curve.poses, curve.contacts, strict=False):
        writer.append(point, pose, contacts)
    writer.flush()
    loaded = ds.load_results(tmp_path / "out")  # while it is still open
    writer.close()
    again = ds.load_results(tmp_path / "out")
    for results in (loaded, again):
        assert results.curve.status == "running" and "killed" in results.curve.reason
        assert len(results.curve.points) == len(results.poses) == len(results.contacts) == 9
        assert results.curve.stop_multiplier == model.analysis.stop_multiplier
        assert results.summary["n_points"] == 9 and results.summary["wall_time"] is None
        assert len(repr(results)) < 300


@pytest.mark.parametrize("torn", [None, b"", b"no HDF5"])
def test_what_cannot_be_loaded_is_a_sentence(tmp_path, torn):
    if torn is not None:
        (tmp_path / "results.h5").write_bytes(torn)
    with pytest.raises(ds.OutputError, match=r"results\.h5 cannot be read"):
        ds.load_results(tmp_path)


def test_curve_without_states_is_not_saved(tmp_path, model, curve):
    with pytest.raises(ValueError, match="keep_poses=True"):
        ds.save_results(replace(curve, contacts=None), model, tmp_path / "out")
    assert not (tmp_path / "out").exists()
