"""Settings of all tests.  This file's folder is where they import `builders` from."""

from pathlib import Path

import pytest
from hypothesis import settings

from drystone.cli import compiler
from drystone.io.results import results_writer
from drystone.limit.beside import Beside
from drystone.report.folder import directory, resume

# A first call may compile for seconds; the examples are the same in every run.
settings.register_profile("drystone", deadline=None, derandomize=True)
settings.load_profile("drystone")


#: Names of tests that are slow by measurement.
SLOW = {
    line
    for line in (Path(__file__).parent / "slow.txt").read_text(encoding="utf-8").splitlines()
    if not line.startswith("#")
}


# Before `-m` is looked at.
@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    for item in items:
        if item.nodeid in SLOW:
            item.add_marker(pytest.mark.slow)


@pytest.fixture(autouse=True)
def untold(monkeypatch):
    """What a command says does not depend on whether its kernels were compiled before."""
    monkeypatch.setattr(compiler, "tell", lambda sentences: None)
    monkeypatch.setattr(compiler, "_processors", lambda: 1)


@pytest.fixture
def bare(monkeypatch):
    """Folders of results without pictures, ParaView files and limit analysis, which take most of
    the time of a run of a few blocks."""
    monkeypatch.setattr(directory, "write_long", lambda done, aside: None)
    monkeypatch.setattr(resume, "limits_beside", lambda model: Beside())


@pytest.fixture
def often(monkeypatch):
    """A checkpoint before every step, and every point on the disk at once."""
    for module in (directory, results_writer):
        monkeypatch.setattr(module, "SECONDS", 0.0)
        monkeypatch.setattr(module, "TIMES", 0.0)
