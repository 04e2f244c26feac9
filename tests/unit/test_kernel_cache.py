"""Compiled kernels are thrown away when any of their sources changes."""

from __future__ import annotations

import os

from numba.core.caching import IndexDataCacheFile

import drystone.common.compiled  # noqa: F401 - names files of the cache by process
from drystone.common.kernel_cache import STAMP, discard_outdated


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
    discard_outdated(folder, sources)
    assert compiled(folder) == []

    (folder / "caller.nbi").write_text("index")
    (folder / "caller.1.nbc").write_text("code")
    discard_outdated(folder, sources)
    assert compiled(folder) == ["caller.1.nbc", "caller.nbi"]

    sources[1].write_text("second\n")
    discard_outdated(folder, sources)
    assert compiled(folder) == []
    discard_outdated(folder, sources)
    (folder / "called.nbi").write_text("index")
    discard_outdated(folder, sources)
    assert compiled(folder) == ["called.nbi"]


def test_a_folder_that_cannot_be_written_is_left_alone(tmp_path):
    source = tmp_path / "kernel.py"
    source.write_text("text\n")
    discard_outdated(tmp_path / "missing", [source])
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
