"""[control] history: displacements to reach one after another, listed or in a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from drystone.common.ranges import found
from drystone.model.construction.contents import read_bytes, within
from drystone.model.construction.errors import ModelError
from drystone.model.history import History, history_of

if TYPE_CHECKING:
    from drystone.io.modelfile.schema import ControlSection


def history_in(section: ControlSection, folder: str, problems: list[str]) -> History | None:
    """The history that [control] asks for; what is wrong is added to ``problems``.

    Parameters
    ----------
    folder
        From which a file of displacements is named.
    """
    targets, amplitudes, cycles = section.history, section.amplitudes, section.cycles
    if cycles is not None and amplitudes is None:
        problems.append("control.cycles: is of amplitudes: give amplitudes = [...] in m as well")
        return None
    try:
        if isinstance(targets, str):
            targets = _read(_within(Path(folder), targets))
        for key, value in (("history", targets), ("amplitudes", amplitudes)):
            if value is not None and not isinstance(value, list):
                what = f"must be a list of displacements in m, it is {found(value)}"
                raise ModelError([f"control.{key}: {what}"])
        return history_of(targets, amplitudes, 1 if cycles is None else cycles)
    except ModelError as error:
        problems += error.problems
        return None


def _within(folder: Path, name: str) -> Path:
    """The file of that name in the model's folder; raises `ModelError` where it lies outside."""
    try:
        return within(folder, name)
    except ModelError as error:
        raise ModelError([f"control.history: {error.problems[0]}"]) from None


def _read(path: Path) -> list[float]:
    """Displacements [m] of a text file, one a line; what follows a # is left out."""
    try:
        text = read_bytes(path, "a file of displacements").decode("utf-8")
    except ModelError as error:
        raise ModelError([f"control.history: {path} {error.problems[0]}"]) from None
    except UnicodeDecodeError:
        raise ModelError([f"control.history: {path} is no text: give one number a line"]) from None
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
