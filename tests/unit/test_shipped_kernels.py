"""Kernels that a wheel carries are found by the compiler where they fit, and only there."""

from __future__ import annotations

import json
import pickle

import numba
import pytest
from numba.core import config
from numba.core.caching import IndexDataCacheFile
from numba.core.registry import cpu_target

from drystone.common import shipped_kernels
from drystone.common.shipped_kernels import MANIFEST, Shipped, collect, fits, processor_features

FEATURE = sorted(processor_features())[0]
TYPES = (numba.float64, numba.int64)
KERNEL = ("bytes", "closure")


@pytest.fixture
def made(tmp_path, monkeypatch):
    """A package with a kernel that was compiled for a baseline, as a wheel carries it."""
    monkeypatch.setattr(config, "CPU_NAME", "baseline")
    monkeypatch.setattr(config, "CPU_FEATURES", f"+{FEATURE}")
    baseline = ("triple", "baseline", f"+{FEATURE}")
    monkeypatch.setattr(shipped_kernels, "_processor", lambda: list(baseline))
    package = tmp_path / "package"
    (package / "law").mkdir(parents=True)
    cache = tmp_path / "built"
    cache.mkdir()
    kept = IndexDataCacheFile(str(cache), "table.kernel-3.py311", "stamp where it was built")
    kept.save((TYPES, baseline, KERNEL), "code")
    count = collect({package / "law": cache}, package, package / "kernels", "sources")
    assert count == 1
    monkeypatch.setattr(config, "CPU_NAME", None)
    monkeypatch.setattr(config, "CPU_FEATURES", None)
    monkeypatch.setattr(config, "DISABLE_JIT", 0)
    return package


def shipped(package, cache) -> Shipped | None:
    return Shipped.of({package / "law": cache}, package, "sources")


def test_the_compiler_finds_what_was_shipped(made, tmp_path):
    found = shipped(made, tmp_path / "cache")
    index = IndexDataCacheFile(str(tmp_path / "cache"), "table.kernel-3.py311", "any stamp")
    here = cpu_target.target_context.codegen().magic_tuple()
    assert found.load(index, (TYPES, here, KERNEL)) == "code"
    assert found.load(index, ((numba.int64,), here, KERNEL)) is None
    assert found.load(index, (TYPES, here, ("other bytes", "closure"))) is None
    other = IndexDataCacheFile(str(tmp_path / "other"), "table.kernel-3.py311", "any stamp")
    assert found.load(other, (TYPES, here, KERNEL)) is None


@pytest.mark.parametrize("key", ["numba", "python", "system", "machine", "sources"])
def test_what_was_made_for_something_else_is_left(made, key):
    assert fits(made / "kernels", "sources")
    file = made / "kernels" / MANIFEST
    values = json.loads(file.read_text())
    file.write_text(json.dumps({**values, key: "another"}))
    assert not fits(made / "kernels", "sources")


def test_a_processor_without_the_instructions_compiles(made, monkeypatch, tmp_path):
    monkeypatch.setattr(shipped_kernels, "processor_features", set)
    assert shipped(made, tmp_path / "cache") is None


def test_who_has_chosen_a_processor_compiles(made, monkeypatch):
    monkeypatch.setattr(config, "CPU_NAME", "generic")
    assert not fits(made / "kernels", "sources")


def test_a_torn_list_is_no_error(made, tmp_path):
    (made / "kernels" / "law" / "table.kernel-3.py311.nbi").write_bytes(pickle.dumps("0.1")[:-1])
    index = IndexDataCacheFile(str(tmp_path / "cache"), "table.kernel-3.py311", "any stamp")
    here = cpu_target.target_context.codegen().magic_tuple()
    assert shipped(made, tmp_path / "cache").load(index, (TYPES, here, KERNEL)) is None


def test_a_package_without_kernels_has_none(tmp_path):
    assert not fits(tmp_path / "kernels", "sources")
