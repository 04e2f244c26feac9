"""Where compiled kernels are kept, and when they are thrown away.

The compiler notices when the file of a kernel changes, but not when one that it calls does, in
another file.  So all of them go when any of their sources has changed.

Nor does it see to processes that compile side by side, as for several directions of the load: two
that save one kernel for different types at once would both call its code by the next free number,
and the one that wins the list of what there is may lose the file.  So names of files end with the
process that wrote them; what is lost is compiled again.
"""

from __future__ import annotations

import os
import stat
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba.core import config
from numba.core.caching import CompileResultCacheImpl, IndexDataCacheFile

from drystone.common.shipped_kernels import CODE, FOLDER, LIST, Shipped, digest_of

#: What a user should know of it; None where the compiler finds a place by itself.
note: str | None = None

#: Folder of the package.
PACKAGE = Path(__file__).parents[1]

#: What a file says that holds kernels.
IMPORT = b"from drystone.common.compiled import njit"

#: What kernels take their numbers from, as constants of theirs, and what says how they are kept.
BESIDE = ("tolerances.py", "kept_code.py")

#: File beside the compiled kernels that tells what sources they were made from.
STAMP = "kernels.sha256"


def provide() -> None:
    """Let the compiler keep its results in a folder for temporary files, if nowhere else.

    It refuses to compile at all where it finds no place for them.
    """
    global note
    IndexDataCacheFile._data_name = _name_by_process
    kernels = sources()
    made_from = digest_of(_made_from(kernels))
    try:
        folders = _folders(kernels)
    except RuntimeError:
        folder = _own_folder()
        os.environ["NUMBA_CACHE_DIR"] = config.CACHE_DIR = str(folder)
        note = (
            f"compiled kernels are kept in {folder}, as neither the package's folder nor home can "
            "be written: set NUMBA_CACHE_DIR to keep them elsewhere"
        )
        folders = _folders(kernels)
    for folder in folders.values():
        discard_outdated(folder, made_from)
    if (PACKAGE / FOLDER).is_dir():  # of a wheel that was built so
        _look_into(Shipped.of(folders, PACKAGE, made_from))


@cache
def sources() -> list[Path]:
    """Files of the package that hold kernels."""
    # Each command reads all files of the package here: `Path.rglob` would take three times as long.
    names = [os.path.join(top, name) for top, _, files in os.walk(PACKAGE) for name in files]
    return sorted(Path(name) for name in names if name.endswith(".py") and _holds_kernels(name))


def _holds_kernels(file: str) -> bool:
    with open(file, "rb", buffering=0) as stream:
        return IMPORT in stream.read()


def modules() -> list[str]:
    """Names of the modules that hold kernels."""
    above = Path(__file__).parents[2]
    return [".".join(p.relative_to(above).with_suffix("").parts) for p in sources()]


def kept_here() -> tuple[dict[Path, Path], str]:
    """Where the compiler keeps the kernels of each folder, and the digest of their sources."""
    kernels = sources()
    return _folders(kernels), digest_of(_made_from(kernels))


def is_empty() -> bool:
    """Whether no kernel is kept on this machine, nor came with the package: all are compiled."""
    shipped = PACKAGE / FOLDER
    if config.DISABLE_JIT or shipped.is_dir():
        return False
    return not any(any(folder.glob(LIST)) for folder in _folders(sources()).values())


def _made_from(kernels: list[Path]) -> list[Path]:
    """Files whose change makes what was compiled of kernels outdated."""
    return [*kernels, *(Path(__file__).with_name(name) for name in BESIDE)]


def _folders(kernels: list[Path]) -> dict[Path, Path]:
    """Where the compiler keeps what it makes of sources, by the folders that these are in;
    `RuntimeError` if nowhere."""
    found = {source.parent: source for source in kernels}
    return {folder: Path(_locator(found[folder]).get_cache_path()) for folder in found}


def _locator(source: Path) -> Any:
    """What finds the place of a source's kernels."""
    for locator in CompileResultCacheImpl._locator_classes:
        found = locator.from_function(provide, str(source))
        if found is not None:
            return found
    raise RuntimeError(f"no place for what is compiled from {source}")


def _look_into(shipped: Shipped | None) -> None:
    """Let the compiler look for what it has not kept among the kernels of a wheel."""
    if shipped is None:
        return
    kept = IndexDataCacheFile.load

    def load(cache: Any, key: Any) -> Any:
        found = kept(cache, key)
        return shipped.load(cache, key) if found is None else found

    IndexDataCacheFile.load = load


def discard_outdated(folder: Path, digest: str) -> None:
    """Delete the kernels compiled into a folder, unless they were made from the sources that have
    this digest, see `digest_of`."""
    stamp = folder / STAMP
    with suppress(OSError):  # what cannot be written cannot be out of date either
        if stamp.is_file() and stamp.read_text() == digest:
            return
        for ending in (LIST, CODE):
            for compiled in folder.glob(ending):
                compiled.unlink(missing_ok=True)
        stamp.write_text(digest)


def _name_by_process(cache: Any, number: int) -> str:
    """File of a kernel's compiled code that no other process writes."""
    base, ending = os.path.splitext(cache._data_name_pattern.format(number=number))
    return f"{base}-{os.getpid()}{ending}"


def _own_folder() -> Path:
    """A folder that no one else can write: what lies in it is run."""
    user = getattr(os, "getuid", lambda: "user")()
    folder = Path(tempfile.gettempdir()) / f"drystone-kernels-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
        private = stat.S_ISDIR(found.st_mode) and not found.st_mode & 0o022
        if private and (os.name == "nt" or found.st_uid == user):
            return folder
    except OSError:
        pass  # something else of that name is there
    return Path(tempfile.mkdtemp(prefix="drystone-kernels-"))
