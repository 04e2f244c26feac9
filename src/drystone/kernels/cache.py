"""Where compiled kernels are kept, where neither the package's folder nor home can be written."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from numba.core import config
from numba.core.caching import CompileResultCacheImpl

#: What a user should know of it; None where the compiler finds a place by itself.
note: str | None = None


def provide() -> None:
    """Let the compiler keep its results in a folder for temporary files, if nowhere else.

    It refuses to compile at all where it finds no place for them.
    """
    global note
    try:
        CompileResultCacheImpl(provide)
    except RuntimeError:
        folder = _own_folder()
        os.environ["NUMBA_CACHE_DIR"] = config.CACHE_DIR = str(folder)
        note = (
            f"compiled kernels are kept in {folder}, as neither the package's folder nor home can "
            "be written: set NUMBA_CACHE_DIR to keep them elsewhere"
        )


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
