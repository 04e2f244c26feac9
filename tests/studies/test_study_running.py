"""Studies that run: the same numbers whoever computes them, killed or not; failures are told."""

from __future__ import annotations

import json
import random
import shutil
import signal
import subprocess
import sys
import time
from functools import partial

import numpy as np
import pandas as pd
import pytest

import drystone as ds
from drystone.io.results.folder import OutputError
from drystone.studies import tables
from drystone.studies.sample import Outcome
from studied import assert_same, command, rows, written

WAVE = """
    function = "FUNCTIONS:wave"
    design = "random"
    samples = 400
    seed = 7
    [[parameter]]
    path = "a"
    range = [0.0, 1.0]
"""


def test_the_same_numbers_whatever_the_workers(tmp_path):
    file = written(tmp_path, WAVE)
    one = ds.study(file, out=tmp_path / "one", workers=1, figures=False)
    ds.study(file, out=tmp_path / "two", workers=2, figures=False)
    assert_same(tmp_path / "one", tmp_path / "two")
    assert one["sample"].tolist() == list(range(400))
    assert one["seed"].is_unique
    assert set(one["status"]) == {"finished"}
    np.testing.assert_array_equal(one["z"], one["a"] ** 2)


def test_a_longer_study_begins_as_the_shorter_one_and_goes_on_with_it(tmp_path):
    short = written(tmp_path, WAVE.replace("400", "100"), "short.toml")
    long = written(tmp_path, WAVE)
    ds.study(short, out=tmp_path / "grown", workers=1, figures=False)
    ds.study(long, out=tmp_path / "grown", workers=1, figures=False, resume=True)
    ds.study(long, out=tmp_path / "whole", workers=1, figures=False)
    assert_same(tmp_path / "grown", tmp_path / "whole")


def test_a_shorter_study_is_cut_from_the_longer_one(tmp_path):
    short = written(tmp_path, WAVE.replace("400", "100"), "short.toml")
    long = written(tmp_path, WAVE)
    ds.study(long, out=tmp_path / "cut", workers=1, figures=False)
    frame = ds.study(short, out=tmp_path / "cut", workers=1, figures=False, resume=True)
    ds.study(short, out=tmp_path / "whole", workers=1, figures=False)
    assert_same(tmp_path / "cut", tmp_path / "whole")
    told = json.loads((tmp_path / "cut" / "study.json").read_text())
    assert len(frame) == told["n_samples"] == told["columns"]["y"]["n"] == 100
    ds.study(long, out=tmp_path / "cut", workers=1, figures=False, resume=True)
    assert len(rows(tmp_path / "cut")) == 400


def some_are_there(folder):
    """Wait until a study has stored some of its samples."""
    for _ in range(600):
        time.sleep(0.1)
        if list(folder.glob("parts/samples-*.parquet")):
            return


def killed_then_finished(file, folder, waits):
    """A study that is killed after each of the waits, and then goes on to its end."""
    for wait in waits:
        more = ["--resume"] if (folder / "study.json").exists() else []
        process = command(file, "--out", folder, "--workers", 2, *more, WAVE_SECONDS="0.01")
        wait()
        assert process.poll() is None, process.communicate()
        process.send_signal(signal.SIGKILL)
        process.communicate()
    more = ["--resume"] if (folder / "study.json").exists() else []
    process = command(file, "--out", folder, "--workers", 2, *more)
    _, told = process.communicate(timeout=120)
    assert process.returncode == 0, told


def test_killed_it_goes_on_with_what_is_missing(tmp_path, monkeypatch):
    file = written(tmp_path, WAVE.replace("400", "1500"))
    killed = tmp_path / "killed"
    killed_then_finished(file, killed, [partial(some_are_there, killed)])
    ds.study(file, out=tmp_path / "whole", workers=2, figures=False)
    assert_same(tmp_path / "killed", tmp_path / "whole")


@pytest.mark.slow
def test_killed_at_twenty_random_moments(tmp_path):
    file = written(tmp_path, WAVE.replace("400", "30000"))
    chance = random.Random(1)
    waits = [partial(time.sleep, chance.uniform(0.5, 12.0)) for _ in range(20)]
    killed_then_finished(file, tmp_path / "killed", waits)
    ds.study(file, out=tmp_path / "whole", workers=2, figures=False)
    assert_same(tmp_path / "killed", tmp_path / "whole")


def test_interrupted_what_was_reached_is_kept(tmp_path):
    file = written(tmp_path, WAVE.replace("400", "5000"))
    folder = tmp_path / "out"
    process = command(file, "--out", folder, "--workers", 1, WAVE_SECONDS="0.01")
    some_are_there(folder)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=60)
    assert process.returncode == 130 and "what was reached is kept" in told
    done = tables.Parts(folder).done(5000)
    assert 0 < done.sum() < 5000


def test_a_folder_is_not_written_over(tmp_path):
    file = written(tmp_path, WAVE.replace("400", "5"))
    ds.study(file, out=tmp_path / "out", workers=1, figures=False)
    with pytest.raises(OutputError, match="--resume, or choose another folder"):
        ds.study(file, out=tmp_path / "out", figures=False)
    other = written(tmp_path, WAVE.replace("seed = 7", "seed = 8"), "other.toml")
    with pytest.raises(OutputError, match="another study"):
        ds.study(other, out=tmp_path / "out", resume=True, figures=False)
    with pytest.raises(OutputError, match="no study to resume"):
        ds.study(file, out=tmp_path / "new", resume=True, figures=False)


HELPED = "from helper import twice\n\ndef f(x):\n    return {'y': twice(x['a'])}\n"
HELPER = "def twice(a):\n    return 2.0 * a\n"


@pytest.mark.parametrize("changed", ["own.py", "helper.py"])
def test_a_function_that_has_changed_is_another_study(tmp_path, changed):
    file = written(tmp_path, WAVE.replace("FUNCTIONS:wave", "own:f").replace("400", "5"))
    (tmp_path / "own.py").write_text(HELPED)
    (tmp_path / "helper.py").write_text(HELPER)
    ds.study(file, out=tmp_path / "out", workers=1, figures=False)
    ds.study(file, out=tmp_path / "out", workers=1, figures=False, resume=True)
    (tmp_path / changed).write_text((tmp_path / changed).read_text() + "\n\nONE = 1\n")
    with pytest.raises(OutputError, match=f'another study .* they differ in "{changed}": choose'):
        ds.study(file, out=tmp_path / "out", workers=1, figures=False, resume=True)


def test_a_folder_of_an_earlier_version_is_told(tmp_path):
    file = written(tmp_path, WAVE.replace("400", "5"))
    ds.study(file, out=tmp_path / "out", workers=1, figures=False)
    record = tmp_path / "out" / "study.json"
    held = json.loads(record.read_text())
    del held["digests"]
    record.write_text(json.dumps(held | {"fingerprint": "0" * 64}))
    with pytest.raises(OutputError, match=r"is of an earlier version, .*: choose another folder"):
        ds.study(file, out=tmp_path / "out", workers=1, figures=False, resume=True)


def test_a_sample_that_fails_is_told_and_the_study_goes_on(tmp_path):
    file = written(tmp_path, WAVE.replace(":wave", ":sometimes"))
    frame = ds.study(file, out=tmp_path / "out", workers=1, figures=False)
    failed = frame[frame["status"] == "failed"]
    assert (frame["a"] > 0.75).equals(frame["status"] == "failed")
    assert set(failed["reason"]) == {"ValueError: too much"}


def test_a_sample_that_ends_its_process_is_told_and_the_study_goes_on(tmp_path):
    """Others of its chunk, which went with the process, are computed again."""
    file = written(tmp_path, WAVE.replace(":wave", ":dies").replace("400", "100"))
    frame = ds.study(file, out=tmp_path / "out", workers=2, figures=False)
    dies = frame["a"].between(0.5, 0.55, inclusive="neither")
    assert 0 < dies.sum() < 10
    assert (frame["status"] == "failed").equals(dies)
    assert frame["reason"][dies].str.contains("ended with status 9").all()


@pytest.mark.parametrize("name", ["peak_passed", "found_by_a_method", "word"])
def test_parts_in_which_no_sample_has_a_value_fit_those_in_which_some_have(tmp_path, name):
    """As where all samples of a part have failed, and a column holds truth values or words."""
    value = "along" if name == "word" else True
    parts = tables.Parts(tmp_path)
    for sample, own in ((0, None), (1, value)):
        row = {"sample": sample, "status": "finished", "reason": "", name: own, "nothing": None}
        parts.write([Outcome(row=row)])
    parts.merge()
    frame = tables.read_samples(tmp_path)
    assert frame[name].isna().tolist() == [True, False] and frame[name][1] == value
    assert frame["nothing"].dtype == float and frame["nothing"].isna().all()


def test_parts_become_one_table_in_order(tmp_path, monkeypatch):
    """Whatever the order in which samples came, and with columns that only some have."""
    monkeypatch.setattr(tables, "WINDOW", 7)
    order = np.random.default_rng(1).permutation(50).tolist()
    parts = tables.Parts(tmp_path)
    curve = np.arange(8.0).reshape(2, 4)
    for begin in range(0, 50, 8):
        parts.write(
            [
                Outcome(
                    row={"sample": k, "status": "finished", "y": float(k)}
                    | ({"more": 1.0} if k % 5 == 0 else {}),
                    curve=curve + k,
                )
                for k in order[begin : begin + 8]
            ]
        )
    parts.merge()
    frame = pd.read_parquet(tmp_path / "samples.parquet")
    assert frame["sample"].tolist() == list(range(50))
    assert frame["more"].notna().sum() == 10
    curves = pd.read_parquet(tmp_path / "curves.parquet")
    assert curves["sample"].tolist() == sorted(list(range(50)) * 4)
    np.testing.assert_array_equal(curves["load_multiplier"][4:8], curve[1] + 1)
    assert not (tmp_path / "parts").exists()


def test_tables_that_were_merged_beside_their_parts_hold_samples_once(tmp_path):
    """Killed before any part was removed, or after some of them, or while a table was moved."""
    parts = tables.Parts(tmp_path / "done")
    curve = np.arange(8.0).reshape(2, 4)
    for begin in range(0, 12, 4):
        row = {"status": "failed", "reason": "none"}
        parts.write(
            [Outcome(row={"sample": k, **row}, curve=curve + k, model="{}")
             for k in range(begin, begin + 4)]
        )  # fmt: skip
    shutil.copytree(tmp_path / "done" / "parts", tmp_path / "kept")
    parts.merge()
    removed = [path.name for kind in tables.KINDS
               for path in sorted((tmp_path / "kept").glob(f"{kind[:-8]}-*"))]  # fmt: skip
    assert len(removed) == 9
    names = [kind for kind in tables.KINDS if (tmp_path / "done" / kind).exists()]
    assert len(names) == 3
    for n in range(len(removed) + 1):
        own = tmp_path / f"removed-{n}"
        shutil.copytree(tmp_path / "done", own)
        shutil.copytree(tmp_path / "kept", own / "parts")
        for name in removed[:n]:
            (own / "parts" / name).unlink()
    for n in range(len(names)):
        own = tmp_path / f"moved-{n}"
        shutil.copytree(tmp_path / "done", own)
        (own / "parts").mkdir()
        for name in names[:n]:
            (own / name).rename(own / "parts" / f"{name[:-8]}-000000.parquet")
    for own in [*tmp_path.glob("removed-*"), *tmp_path.glob("moved-*")]:
        tables.Parts(own).reopen()
        assert tables.Parts(own).done(12).all()
        tables.Parts(own).merge()
        for name in names:
            frame, whole = (pd.read_parquet(folder / name) for folder in (own, tmp_path / "done"))
            pd.testing.assert_frame_equal(frame, whole)


def test_killed_before_parts_were_removed_it_goes_on(tmp_path, monkeypatch):
    file = written(tmp_path, WAVE.replace("400", "20"))
    ds.study(file, out=tmp_path / "whole", workers=1, figures=False)
    with monkeypatch.context() as patched:
        patched.setattr(tables.Parts, "discard", lambda self: sys.exit(9))
        with pytest.raises(SystemExit):
            ds.study(file, out=tmp_path / "killed", workers=1, figures=False)
    assert (tmp_path / "killed" / "samples.parquet").exists()
    assert list((tmp_path / "killed" / "parts").glob("samples-*"))
    ds.study(file, out=tmp_path / "killed", workers=1, figures=False, resume=True)
    assert_same(tmp_path / "whole", tmp_path / "killed")


def test_what_was_half_written_is_computed_again(tmp_path):
    file = written(tmp_path, WAVE.replace("400", "20"))
    ds.study(file, out=tmp_path / "whole", workers=1, figures=False)
    ds.study(file, out=tmp_path / "torn", workers=1, figures=False)
    tables.Parts(tmp_path / "torn").reopen()
    parts = tmp_path / "torn" / "parts"
    (parts / "curves-000005.parquet").write_bytes(b"curves of samples that were not written")
    (parts / "samples-000006.parquet.part").write_bytes(b"half a file")
    ds.study(file, out=tmp_path / "torn", workers=1, figures=False, resume=True)
    assert_same(tmp_path / "whole", tmp_path / "torn")
    assert len(rows(tmp_path / "torn")) == 20


# Its largest memory [MiB]; that of `resource` counts what the process was before it began this.
DRIVER = """
import sys
from pathlib import Path
from drystone.studies.conduct import conduct
from drystone.studies.read import read_study
conduct(read_study(sys.argv[1]), Path(sys.argv[2]), workers=1)
status = Path("/proc/self/status").read_text()
print(int(status.partition("VmHWM:")[2].split()[0]) / 1024)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="read from /proc")
def test_the_process_that_conducts_1e5_samples_takes_300_mebibytes(tmp_path):
    file = written(tmp_path, WAVE.replace("400", "100000"))
    done = subprocess.run(
        [sys.executable, "-c", DRIVER, str(file), str(tmp_path / "out")],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert float(done.stdout) < 300.0
    assert len(rows(tmp_path / "out")) == 100_000
