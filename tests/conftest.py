"""Settings of all tests.  This file's folder is where they import `builders` from."""

import pytest
from hypothesis import settings

from drystone.cli import compiler

# A first call may compile for seconds; the examples are the same in every run.
settings.register_profile("drystone", deadline=None, derandomize=True)
settings.load_profile("drystone")


@pytest.fixture(autouse=True)
def untold(monkeypatch):
    """What a command says does not depend on whether its kernels were compiled before."""
    monkeypatch.setattr(compiler, "tell", lambda sentences: None)
    monkeypatch.setattr(compiler, "_processors", lambda: 1)
