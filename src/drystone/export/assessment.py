"""``assessment.json`` and the pictures beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from drystone.export.folder import in_a_sentence, whole_file
from drystone.export.own_files import ASSESSMENT, OF_ASSESSMENT
from drystone.export.summary import package_version, write_summary


def write_assessment(
    folder: Path,
    result: Mapping[str, Any],
    pictures: Mapping[str, Callable[[Path], None]],
) -> None:
    """Write the result, and pictures by their file names; those of another assessment go.

    Raises
    ------
    OutputError
        The folder cannot be written.
    """

    def write() -> None:
        folder.mkdir(parents=True, exist_ok=True)
        write_summary({**result, "version": package_version()}, folder / ASSESSMENT)
        for name, draw in pictures.items():
            with whole_file(folder / name) as draft:
                draw(draft)
        for name in OF_ASSESSMENT:
            if name != ASSESSMENT and name not in pictures:
                (folder / name).unlink(missing_ok=True)

    in_a_sentence(write)
