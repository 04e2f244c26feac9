"""``assessment.json`` and the pictures beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from drystone.common.language import Saying, current
from drystone.common.version import package_version
from drystone.io.results.folder import in_a_sentence, whole_file
from drystone.io.results.own_files import ASSESSMENT, OF_ASSESSMENT
from drystone.io.results.summary import write_summary


def written(result: Mapping[str, Any]) -> dict[str, Any]:
    """The result in the language that is spoken, with what sayings are made of.

    ``said`` has key and fields of every sentence by its text, so that a report can say it in
    another language; keys and numbers stay what they are.
    """
    said: dict[str, Any] = {}

    def plain(value: Any) -> Any:
        if isinstance(value, Saying):
            text = value.spoken
            if text:
                said[text] = value.as_dict()
            return text
        if isinstance(value, Mapping):
            return {key: plain(item) for key, item in value.items()}
        return [plain(item) for item in value] if isinstance(value, list | tuple) else value

    whole = plain(result)
    return {**whole, "language": current(), "said": said}


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
