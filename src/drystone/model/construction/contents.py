"""Contents of files that users name."""

from __future__ import annotations

import stat
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from drystone.common.ranges import LARGEST
from drystone.model.construction.errors import ModelError
from drystone.model.construction.words import quoted


@dataclass(frozen=True)
class Held:
    """A file that a model of results names: they hold its text, or None where it was not there."""

    name: str
    text: str | None


def file_named(name: str, folder: str, files: Mapping[str, str] | None) -> Path | Held:
    """The file of a name: in a folder, or one of the texts that results hold by their names."""
    return Path(folder) / name if files is None else Held(name, files.get(name))


def name_of(path: str | Path | Held) -> str:
    """The last part of a file's path."""
    return Path(path.name if isinstance(path, Held) else path).name


def read_bytes(path: Path | Held, what: str) -> bytes:
    """Contents of a file; raises `ModelError` where there is none to read.

    Only files of a disk are opened, none of pipes and devices, which may have no end, and only up
    to a size.  ``what`` is named where the path is that of a folder.
    """
    if isinstance(path, Held):
        if path.text is None:
            raise ModelError(
                [
                    "is not stored in these results, and no other file is read for them: "
                    "analyse the model again"
                ]
            )
        return path.text.encode()
    try:
        about = path.stat()
        if stat.S_ISDIR(about.st_mode):
            raise IsADirectoryError
        if not stat.S_ISREG(about.st_mode):
            raise ModelError(["is a pipe or a device: save what it gives as a file, and name that"])
        if about.st_size > LARGEST["file"]:
            raise ModelError([_too_large(about.st_size)])
        with path.open("rb") as file:
            found = file.read(LARGEST["file"] + 1)  # some files give more than they say
    except FileNotFoundError:
        raise ModelError(["there is no such file: check the path"]) from None
    except IsADirectoryError:
        raise ModelError([f"is a folder: name {what} in it"]) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError([f"cannot be read ({reason}): check path and permissions"]) from None
    if len(found) > LARGEST["file"]:
        raise ModelError([_too_large(len(found))])
    return found


def within(folder: Path, name: str) -> Path:
    """The file that a model in a folder names; raises `ModelError` where that is outside of it.

    A model of somebody else may name any file of whoever runs it: its own are those in its folder
    and below, wherever links lead.
    """
    if is_outside(folder, name):
        raise ModelError(
            [
                f"{quoted(name)} lies outside of the model file's folder, and a model may name "
                "files in its own folder and below only: copy it there"
            ]
        )
    return folder / name


def is_outside(folder: Path, name: str) -> bool:
    """Whether a name leads out of a folder; raises `ModelError` where it is no path of a file."""
    try:
        return not (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):
        raise ModelError([f"{quoted(name)} is not the path of a file: correct it"]) from None


def _too_large(size: int) -> str:
    return (
        f"has {size / 1e6:.0f} MB, and {LARGEST['file'] / 1e6:.0f} MB are the most that are read: "
        "take a part of it"
    )
