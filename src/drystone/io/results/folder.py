"""Folders of results: whether they can be written, one writer at a time, no file half written."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from drystone.results.curve import RecorderError

T = TypeVar("T")


class OutputError(RecorderError):
    """The folder of results cannot be made or written; the message is for the user."""


class FolderLock:
    """Holds a folder, which exists, for one writer.

    The lock is the operating system's and ends with the process, however that ends.  Where a file
    system knows no locks there is none.

    Raises
    ------
    OutputError
        Another process, or this one, writes there already.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock_file = _lock(folder)

    def release(self) -> None:
        """Let others write.  May be called twice."""
        if self._lock_file is not None:
            os.close(self._lock_file)
            self._lock_file = None


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Make a folder and hold it while files are written; `OutputError` where that fails.

    A folder that was made and into which nothing was written goes again.
    """
    lock, made = None, not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = FolderLock(folder)
        yield
    except OSError as error:
        raise as_output_error(error) from error
    finally:
        if lock is not None:
            lock.release()
        if made:
            with suppress(OSError):  # something is in it
                folder.rmdir()


if sys.platform == "win32":
    import msvcrt

    def _lock(folder: Path) -> int | None:
        """A handle that holds a lock file in the folder, which goes as the handle is closed."""
        try:
            flags = os.O_RDWR | os.O_CREAT | os.O_TEMPORARY
            handle = os.open(folder / ".lock", flags)
        except PermissionError:  # it is open with another process
            raise _taken(folder) from None
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            os.close(handle)
            raise _taken(folder) from None
        return handle

else:
    import fcntl

    def _lock(folder: Path) -> int | None:
        """A handle that holds a lock on the folder itself, which leaves no file behind."""
        handle = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise _taken(folder) from None
        except OSError:
            os.close(handle)
            return None
        return handle


def _taken(folder: Path) -> OutputError:
    return OutputError(
        f"another run is writing its results into {folder}: wait for its end, or choose another "
        "folder with --out"
    )


def check_writable(path: Path) -> None:
    """Raise `OutputError` unless files can be made in folder ``path``; leaves nothing behind.

    Where it is missing, the nearest of its parents is asked.  No folder is made: processes that
    write beside each other would remove each other's.
    """
    try:
        if path.exists() and not path.is_dir():
            raise OutputError(
                f"{path} is a file, not a folder: choose another folder for the results"
            )
        there = next(folder for folder in (path, *path.parents) if folder.exists())
        handle, name = tempfile.mkstemp(dir=there)
        os.close(handle)
        os.unlink(name)
        if there == path:
            FolderLock(path).release()
    except OSError as error:
        raise OutputError(
            f"the folder of results {path} cannot be written ({error.strerror}): choose another one"
        ) from None


def check_apart(source: Path | str | None, files: Iterable[Path]) -> None:
    """Raise `OutputError` where one of the ``files`` to be written is the model file itself."""
    if source is None:
        return
    for file in files:
        if file.exists() and Path(source).exists() and file.samefile(source):
            raise OutputError(
                f"{file} is the model file itself, and would be overwritten: write to another name"
                " or folder"
            )


def check_place(path: Path) -> None:
    """Raise `OutputError` where no file ``path`` can be made: a folder, or in a folder that is
    none."""
    if path.is_dir():
        raise OutputError(f"{path} is a folder: name a file in it")
    if not path.parent.is_dir():
        raise OutputError(f"{path} cannot be written, there is no folder {path.parent}: make it")


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A draft to write, which becomes ``path`` once it is whole; else nothing is left of it."""
    draft = path.with_name(path.name + ".part")
    try:
        yield draft
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)


def sync_folder(folder: Path) -> None:
    """Bring names that have changed in a folder to the disk, where the system has a way to."""
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def as_output_error(error: OSError) -> OutputError:
    """What the operating system refused, in a sentence."""
    if error.filename and not Path(error.filename).parent.is_dir():
        return OutputError(
            f"the folder of results {Path(error.filename).parent} was removed while the run wrote "
            "into it: run the model again"
        )
    where = f" {str(error.filename).removesuffix('.part')}" if error.filename else ""
    return OutputError(
        f"the results{where} cannot be written ({error.strerror or error}): "
        "free some space or choose another folder"
    )


def in_a_sentence(action: Callable[[], T]) -> T:
    """Do it; what the operating system refuses becomes an `OutputError`."""
    try:
        return action()
    except OSError as error:
        raise as_output_error(error) from error
