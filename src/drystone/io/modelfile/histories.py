"""[control] history: displacements to reach one after another, listed or in a file."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from drystone.common.ranges import found
from drystone.model.construction.contents import Held, file_named, read_bytes, within
from drystone.model.construction.errors import ModelError
from drystone.model.history import History, history_of

if TYPE_CHECKING:
    from drystone.io.modelfile.schema import ControlSection


def history_in(
    section: ControlSection,
    folder: str,
    problems: list[str],
    files: Mapping[str, str] | None = None,
) -> tuple[History | None, tuple[str, ...]]:
    """The history that [control] asks for, and the digest of its file where there is one; what is
    wrong is added to ``problems``.

    Parameters
    ----------
    folder
        From which a file of displacements is named.
    files
        Texts of files by their names, of a model that results hold.
    """
    targets, amplitudes, cycles = section.history, section.amplitudes, section.cycles
    if cycles is not None and amplitudes is None:
        problems.append("control.cycles: needs amplitudes: give amplitudes = [...] in m as well")
        return None, ()
    digests: tuple[str, ...] = ()
    try:
        if isinstance(targets, str):
            contents, path = _bytes(targets, folder, files)
            digests = (hashlib.sha256(contents).hexdigest(),)
            targets = _numbers(contents, path)
        for key, value in (("history", targets), ("amplitudes", amplitudes)):
            if value is not None and not isinstance(value, list):
                what = f"must be a list of displacements in m, it is {found(value)}"
                raise ModelError([f"control.{key}: {what}"])
        return history_of(targets, amplitudes, 1 if cycles is None else cycles), digests
    except ModelError as error:
        problems += error.problems
        return None, ()


def _bytes(name: str, folder: str, files: Mapping[str, str] | None) -> tuple[bytes, str | Path]:
    """What the file of that name in the model's folder holds, and its path; raises `ModelError`
    where it lies outside, or cannot be read."""
    try:
        file = within(Path(folder), name) if files is None else file_named(name, folder, files)
    except ModelError as error:
        raise ModelError([f"control.history: {error.problems[0]}"]) from None
    path = file.name if isinstance(file, Held) else file
    try:
        return read_bytes(file, "a file of displacements"), path
    except ModelError as error:
        raise ModelError([f"control.history: {path} {error.problems[0]}"]) from None


def _numbers(contents: bytes, path: str | Path) -> list[float]:
    """Displacements [m] of a text file, one a line; what follows a # is left out."""
    try:
        text = contents.decode("utf-8")
    except UnicodeDecodeError:
        raise ModelError(
            [f"control.history: {path} is not a text: give a number in each line"]
        ) from None
    values = []
    for k, line in enumerate(text.splitlines(), 1):
        word = line.split("#")[0].strip()
        if not word:
            continue
        try:
            values.append(float(word))
        except ValueError:
            what = f"{path}, line {k}: must be one number, a displacement in m, it is {found(word)}"
            raise ModelError([f"control.history: {what}"]) from None
    return values
