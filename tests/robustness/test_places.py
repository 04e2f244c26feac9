"""Places that take no results: full disks, folders that are read only, in use, or removed.

Each ends in a sentence; what was there before is untouched, and what was reached goes on.
"""

from __future__ import annotations

import random
import shutil
import subprocess
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from typer.testing import CliRunner

import drystone as ds
import killed
from drystone.cli import app
from drystone.io.results.folder import FolderLock, OutputError

EXAMPLES = Path(__file__).parents[2] / "examples"
MODEL = EXAMPLES / "two_blocks.toml"
STUDY = """
model = "{model}"
design = "grid"
seed = 1
[[parameter]]
path = "joint.friction_coefficient"
values = [0.5, 0.6]
"""


def drystone(*arguments: object) -> tuple[int, str]:
    """Exit status of a command, and what it says."""
    told = CliRunner().invoke(app, [*map(str, arguments), "--quiet"])
    assert told.exception is None or isinstance(told.exception, SystemExit), told.output
    return told.exit_code, told.output


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """Results of a run that nothing stopped."""
    folder = tmp_path_factory.mktemp("whole") / "out"
    assert drystone("run", MODEL, "--out", folder)[0] == 0
    return folder


class Disk:
    """A small disk of its own, in memory; whoever tests must be allowed to mount it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def mount(self, options: str) -> None:
        command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(self.path)]
        if shutil.which("mount") is None or subprocess.run(command, capture_output=True).returncode:
            pytest.skip("no disk can be mounted here")

    def change(self, options: str) -> None:
        subprocess.run(["mount", "-o", f"remount,{options}", str(self.path)], check=True)

    def fill(self) -> None:
        """Leave no space."""
        with suppress(OSError), (self.path / "filler").open("wb", buffering=0) as file:
            while True:
                file.write(bytes(4096))

    def free(self) -> None:
        (self.path / "filler").unlink()

    def unmount(self) -> None:
        subprocess.run(["umount", "--lazy", str(self.path)], check=True)


@pytest.fixture
def disk(tmp_path):
    folder = tmp_path / "disk"
    folder.mkdir()
    found = Disk(folder)
    found.mount("size=16m")
    yield found
    found.unmount()


def filled_at(disk: Disk, points: list[int], wanted: object) -> None:
    """Fill the disk as a run has come to a point, make space, and go on; for several points."""
    for at in points:
        folder = disk.path / "out"

        def seen(point: ds.CurvePoint, at: int = at) -> None:
            if point.step == at:
                disk.fill()

        recorder = ds.ResultsDirectory(folder)
        try:
            curve = ds.pushover(ds.read_model(MODEL), recorder=recorder, progress=seen)
        except OutputError as error:  # no space for the short files either
            said = str(error)
        else:
            assert curve.status == "stopped"
            said = curve.reason
        assert "cannot be written (No space left on device)" in said, at
        stored = ds.load_results(folder).curve
        assert stored.status != "finished" and 0 < len(stored.points) <= at + 1
        disk.free()
        ds.resume(folder)
        assert killed.digest(folder) == wanted, at
        shutil.rmtree(folder)


@pytest.mark.usefixtures("often")
def test_a_disk_that_fills_as_a_run_goes_on(disk, whole):
    filled_at(disk, [0, 20], killed.digest(whole))


@pytest.mark.slow
@pytest.mark.usefixtures("often")
def test_a_disk_that_fills_at_twenty_moments(disk, whole):
    n = len(ds.load_results(whole).curve.points)
    filled_at(disk, sorted(random.Random(1).sample(range(n - 1), 20)), killed.digest(whole))


def test_a_disk_without_space_for_the_first_point(disk, whole):
    """Earlier results stay as they were."""
    folder = disk.path / "out"
    shutil.copytree(whole, folder)
    disk.fill()
    before = contents(folder)
    for more in ((), ("--directions", "both")):
        code, said = drystone("run", MODEL, "--out", folder, *more)
        assert code == 2 and "No space left on device" in said
        assert contents(folder) == before
        code, said = drystone("run", MODEL, "--out", disk.path / "new", *more)
        assert code == 2 and not (disk.path / "new").exists()


#: Commands that write into a folder, of a model file and of a study file.
COMMANDS: list[Callable[[Path, Path], tuple[object, ...]]] = [
    lambda folder, study: ("run", MODEL, "--out", folder),
    lambda folder, study: ("run", MODEL, "--out", folder, "--directions", "both"),
    lambda folder, study: ("run", "--resume", folder, "--extend", "stop_multiplier=0.005"),
    lambda folder, study: ("assess", EXAMPLES / "wall_at_a_site.toml", "--out", folder),
    lambda folder, study: ("study", study, "--out", folder),
    lambda folder, study: ("report", folder),
    lambda folder, study: ("view", folder),
]


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    shutil.copy(MODEL, tmp_path / "model.toml")
    path.write_text(STUDY.format(model="model.toml"))
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_a_folder_that_nobody_may_write_in(disk, whole, study, command):
    """Root may write anywhere but on a disk that is read only."""
    folder = disk.path / "out"
    shutil.copytree(whole, folder)
    before = contents(folder)
    disk.change("ro")
    code, said = drystone(*command(folder, study))
    assert code in (2, 3) and "Read-only file system" in said, said
    assert str(folder) in said and contents(folder) == before


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_in_place_of_the_folder(tmp_path, whole, study, command):
    folder = tmp_path / "out"
    folder.write_text("mine")
    code, said = drystone(*command(folder, study))
    assert code == 2 and str(folder) in said and folder.read_text() == "mine"


@pytest.mark.parametrize("command", COMMANDS[:5])
def test_a_folder_that_another_run_writes_in(tmp_path, whole, study, command):
    folder = tmp_path / "out"
    shutil.copytree(whole, folder)
    before, lock = contents(folder), FolderLock(folder)
    try:
        code, said = drystone(*command(folder, study))
    finally:
        lock.release()
    assert code == 2 and "another run is writing" in said, said
    assert contents(folder) == before


def test_a_folder_that_is_removed_meanwhile(tmp_path):
    """At each of some points; nothing is written elsewhere, and another run finds its way."""
    folder = tmp_path / "out"
    for at in (0, 1, 10, 30):

        def seen(point: ds.CurvePoint, at: int = at) -> None:
            if point.step == at:
                shutil.rmtree(folder)

        with pytest.raises(OutputError, match="was removed"):
            ds.pushover(ds.read_model(MODEL), recorder=ds.ResultsDirectory(folder), progress=seen)
        assert not list(tmp_path.iterdir())
    assert drystone("run", MODEL, "--out", tmp_path / "out")[0] == 0
