"""Contents of files that users name."""

from __future__ import annotations

from pathlib import Path

from drystone.builders.errors import ModelError


def read_bytes(path: Path, what: str) -> bytes:
    """Contents of a file; raises `ModelError` where there is none to read.

    ``what`` is named where the path is that of a folder.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise ModelError(["there is no such file: check the path"]) from None
    except IsADirectoryError:
        raise ModelError([f"is a folder: name {what} in it"]) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError([f"cannot be read ({reason}): check path and permissions"]) from None
