"""Contents of files that users name."""

from __future__ import annotations

import stat
from pathlib import Path

from drystone.common.ranges import LARGEST
from drystone.model.construction.errors import ModelError


def read_bytes(path: Path, what: str) -> bytes:
    """Contents of a file; raises `ModelError` where there is none to read.

    Only files of a disk are opened, none of pipes and devices, which may have no end, and only up
    to a size.  ``what`` is named where the path is that of a folder.
    """
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


def _too_large(size: int) -> str:
    return (
        f"has {size / 1e6:.0f} MB, and {LARGEST['file'] / 1e6:.0f} MB are the most that are read: "
        "take a part of it"
    )
