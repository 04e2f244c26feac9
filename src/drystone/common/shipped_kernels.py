"""Compiled kernels that a wheel carries: found by the compiler where they fit.

A wheel made by ``tools/release.py --kernels`` has a folder `FOLDER` with the compiler's own files
of analyses that ran where the wheel was built, for a baseline of processors.  A kernel that is not
in the cache of this machine is looked for there.  Where anything differs, the version of the
compiler, of Python, a source, or an instruction that the processor has not, kernels are compiled.
"""

from __future__ import annotations

import hashlib
import json
import pickle
import platform
import shutil
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numba
from numba.core import config
from numba.core.caching import IndexDataCacheFile

#: Folder of the package that holds them, and the file in it that says what they were made for.
FOLDER, MANIFEST = "kernels", "manifest.json"

#: What the compiler's cache consists of: lists of kernels, and their code.
LIST, CODE = "*.nbi", "*.nbc"


def digest_of(sources: Iterable[Path]) -> str:
    """What tells one state of the sources of kernels from another."""
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.name.encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()


def collect(caches: Mapping[Path, Path], package: Path, into: Path, sources: str) -> int:
    """Copy what the compiler has kept into a folder for a wheel; the number of kernels.

    Parameters
    ----------
    caches
        Of each folder of the package with kernels, where the compiler keeps what it makes of them.
    package
        Folder of the package.
    sources
        Digest of the sources, see `digest_of`.

    Raises
    ------
    ValueError
        Nothing has been compiled, or not for a baseline (`NUMBA_CPU_NAME`, `NUMBA_CPU_FEATURES`).
    """
    if not config.CPU_NAME or not config.CPU_FEATURES:
        raise ValueError("set NUMBA_CPU_NAME and NUMBA_CPU_FEATURES before anything is compiled")
    count = 0
    for folder, cache in caches.items():
        there = into / folder.relative_to(package)
        for file in (*cache.glob(LIST), *cache.glob(CODE)):
            there.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, there / file.name)
            count += file.suffix == ".nbc"
    if not count:
        raise ValueError("nothing has been compiled")
    manifest: dict[str, Any] = {
        **_here(),
        "sources": sources,
        "cpu": config.CPU_NAME,
        "features": _wanted(),
    }
    manifest["processor"] = _processor()
    (into / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
    return count


@dataclass(frozen=True, kw_only=True)
class Shipped:
    """The kernels of a wheel, which fit."""

    folders: Mapping[str, Path]  # where they lie, by the place where the compiler looks for them
    processor: tuple[Any, ...]  # what the compiler called the baseline

    @classmethod
    def of(cls, caches: Mapping[Path, Path], package: Path, sources: str) -> Self | None:
        """Those of a package; None where there are none, or where they do not fit.

        Parameters are those of `collect`.
        """
        shipped = package / FOLDER
        if not fits(shipped, sources):
            return None
        manifest = json.loads((shipped / MANIFEST).read_text(encoding="utf-8"))
        folders = {
            str(cache): shipped / folder.relative_to(package) for folder, cache in caches.items()
        }
        return cls(folders=folders, processor=tuple(manifest["processor"]))

    def load(self, cache: IndexDataCacheFile, key: tuple[Any, ...]) -> Any:
        """A kernel for the types of a key of the compiler's; None where the wheel has it not.

        A list is the version of the compiler, then a stamp of the source and the names of files of
        code by types, processor and kernel.
        """
        folder = self.folders.get(str(cache._cache_path))
        if folder is None:
            return None
        with suppress(OSError, pickle.PickleError, EOFError, ValueError, AttributeError):
            with (folder / cache._index_name).open("rb") as stream:
                pickle.load(stream)
                _, names = pickle.load(stream)
            name = names.get((key[0], self.processor, *key[2:]))
            return None if name is None else pickle.loads((folder / name).read_bytes())
        return None


def fits(shipped: Path, sources: str) -> bool:
    """Whether the kernels of a folder may run here."""
    try:
        manifest = json.loads((shipped / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    same = all(manifest.get(key) == value for key, value in _here().items())
    chosen = config.CPU_NAME is not None or config.DISABLE_JIT  # somebody wants other code
    return bool(
        same
        and not chosen
        and manifest.get("sources") == sources
        and set(manifest.get("features", ())) <= processor_features()
    )


def processor_features() -> set[str]:
    """Sets of instructions that this processor has, by LLVM's names."""
    import llvmlite.binding as llvm

    with suppress(RuntimeError):
        return {name for name, there in llvm.get_host_cpu_features().items() if there}
    return set()


def _here() -> dict[str, str]:
    """What compiled code depends on beside its sources and the processor."""
    return {
        "numba": numba.__version__,
        "python": f"{sys.implementation.cache_tag}{getattr(sys, 'abiflags', '')}",
        "system": platform.system(),
        "machine": platform.machine(),
    }


def _wanted() -> list[str]:
    """Features that were asked for, as "+avx2,+fma"."""
    return [name[1:] for name in config.CPU_FEATURES.split(",") if name.startswith("+")]


def _processor() -> list[Any]:
    """What the compiler calls the processor that it compiles for."""
    from numba.core.registry import cpu_target

    return list(cpu_target.target_context.codegen().magic_tuple())
