"""Compiled kernels are thrown away when any of their sources changes."""

from __future__ import annotations

import os
import subprocess
import sys

import synthetic
from numba.core.caching import IndexDataCacheFile

import drystone.common.compiled  # noqa: F401 - names files of the cache by process
from drystone.common.kernel_cache import STAMP, discard_outdated
from drystone.common.shipped_kernels import digest_of


def compiled(folder):
    return sorted(path.name for path in folder.glob("*.nb?"))


def test_kernels_of_other_sources_are_discarded(tmp_path):
    """Also where only a file that others call has changed."""
    sources = [tmp_path / "caller.py", tmp_path / "called.py"]
    for source in sources:
        source.write_text("first\n")
    folder = tmp_path / "cache"
    folder.mkdir()
    (folder / "caller.nbi").write_text("left by a version that had no stamp")
    discard_outdated(folder, digest_of(sources))
    assert compiled(folder) == []

    (folder / "caller.nbi").write_text("index")
    (folder / "caller.1.nbc").write_text("code")
    discard_outdated(folder, digest_of(sources))
    assert compiled(folder) == ["caller.1.nbc", "caller.nbi"]

    sources[1].write_text("second\n")
    discard_outdated(folder, digest_of(sources))
    assert compiled(folder) == []
    discard_outdated(folder, digest_of(sources))
    (folder / "called.nbi").write_text("index")
    discard_outdated(folder, digest_of(sources))
    assert compiled(folder) == ["called.nbi"]


def test_a_folder_that_cannot_be_written_is_left_alone(tmp_path):
    source = tmp_path / "kernel.py"
    source.write_text("text\n")
    discard_outdated(tmp_path / "missing", digest_of([source]))
    assert not (tmp_path / "missing" / STAMP).exists()


def test_processes_side_by_side_do_not_take_each_others_code(tmp_path, monkeypatch):
    """Both have seen an empty list; the later writer of the list is not that of the code."""
    process = {"first": 11, "second": 12}

    def cache(name):
        monkeypatch.setattr(os, "getpid", lambda: process[name])
        return IndexDataCacheFile(str(tmp_path), "kernel", "source")

    write = IndexDataCacheFile._save_data

    def second_comes_between(self, name, data):
        monkeypatch.setattr(IndexDataCacheFile, "_save_data", write)
        other = cache("second")
        monkeypatch.setattr(other, "_load_index", dict)
        other.save("integers", "code for integers")
        monkeypatch.undo()
        write(self, name, data)

    monkeypatch.setattr(IndexDataCacheFile, "_save_data", second_comes_between)
    cache("first").save("floats", "code for floats")
    found = IndexDataCacheFile(str(tmp_path), "kernel", "source")
    assert found.load("integers") == "code for integers"
    assert found.load("floats") is None  # and is compiled again


KERNELS = """
import sys
import numpy as np
import drystone as ds
from drystone.common.compiled import njit

@njit(cache=True)
def doubled(x):
    out = np.empty(len(x))
    for i in range(len(x)):
        out[i] = 2.0 * x[i]
    return out

@njit(cache=True)
def refused(n):
    if n < 0:
        raise ValueError("it is negative")
    return n + 1

@njit(cache=True)
def summed(x):
    return doubled(x).sum() + refused(1)

if __name__ == "__main__":
    with ds.Compilation() as compilation:
        if sys.argv[1] == "parts":
            assert doubled(np.arange(3.0)).tolist() == [0.0, 2.0, 4.0] and refused(4) == 5
            try:
                refused(-1)
            except ValueError as error:
                assert str(error) == "it is negative"
            else:
                raise AssertionError
        else:
            assert summed(np.arange(3.0)) == 8.0
    print(compilation.n_kernels, "numba.np.linalg" in sys.modules)
"""


def test_kept_kernels_run_and_are_compiled_into_others(tmp_path, monkeypatch):
    """Loaded, they allocate and raise as compiled, without the compiler's libraries of functions;
    a kernel that is compiled later takes them in as they were kept."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    file = tmp_path / "kernels.py"
    file.write_text(KERNELS)
    for what in ("parts", "whole"):
        compiled, libraries = python(file, what)
        assert int(compiled) > 0 and libraries == "True"
        assert python(file, what) == ["0", "False"]


def python(file, what):
    done = subprocess.run(
        [sys.executable, str(file), what], env=synthetic.environment(),
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout.split()
