"""Models as input files of other programs, and readers that check what was written.

A writer takes a model and gives the file's text with notes on what the target cannot express; a
reader rebuilds the model from such a file.  The readers know the grammar that our writers use, not
every file of those programs.  Files of modelling programs, which hold blocks and no models, are
read by `drystone.io.drawings`; `from_drawing` makes a model file of one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from drystone.io.convert import drawings, lmgc90, threedec, udec, vtk
from drystone.io.convert.common import Written
from drystone.io.drawings.registry import FORMATS
from drystone.model.construction.contents import read_bytes
from drystone.model.construction.errors import ModelError
from drystone.model.model import Model


@dataclass(frozen=True, kw_only=True)
class Target:
    """A program that we write for."""

    name: str
    endings: tuple[str, ...]  # of file names that mean it
    write: Callable[[Model, str], Written]  # model and file name -> text and notes
    read: Callable[[str], Model] | None  # text -> model


#: Programs that take a whole model.
PROGRAMS = {
    target.name: target
    for target in (
        Target(name="udec", endings=(".dat", ".udat"), write=udec.write, read=udec.read),
        Target(name="3dec", endings=(".3ddat",), write=threedec.write, read=threedec.read),
        Target(name="lmgc90", endings=(".py",), write=lmgc90.write, read=lmgc90.read),
        Target(name="vtk", endings=(".vtk", ".vtu"), write=vtk.write, read=None),
    )
}


def targets() -> dict[str, Target]:
    """All that we write for: programs, then formats of drawings that are written."""
    return PROGRAMS | {
        name: Target(
            name=name,
            endings=one.endings,
            write=lambda model, _, one=one: drawings.write(one, model),  # type: ignore[misc]
            read=None,
        )
        for name, one in FORMATS.loaded()
        if one.write is not None and name not in PROGRAMS
    }


def target_of(
    path: str | PathLike[str], name: str | None = None, *, beside: Sequence[str] = ()
) -> Target:
    """The target of that name, or else the one that the file's ending means.

    ``beside`` are what the caller writes by itself, for the message on a name that is none.

    Raises
    ------
    ModelError
        There is none.
    """
    every = targets()
    if name is not None:
        if name not in every:
            known = ", ".join((*beside, *every))
            raise ModelError([f'there is no target "{name}": take one of {known}'])
        return every[name]
    ending = Path(path).suffix.lower()
    for target in every.values():
        if ending in target.endings:
            return target
    known = ", ".join(f"{t.endings[0]} ({t.name})" for t in every.values())
    raise ModelError(
        [f'{path}: its ending "{ending}" belongs to no program: end it in {known}, or say --to']
    )


def convert(model: Model, path: str | PathLike[str], target: str | None = None) -> tuple[str, ...]:
    """Write a model as another program's input.

    Parameters
    ----------
    path
        Of the file to write.
    target
        One of `targets`; by default what the file's ending means.

    Returns
    -------
    tuple of str
        What the target cannot express, a sentence each.

    Raises
    ------
    ModelError
        There is no such target, or it cannot take the model at all.
    """
    written = target_of(path, target).write(model, Path(path).name)
    Path(path).write_text(written.text, encoding="utf-8", newline="\n")
    return written.notes


def read(path: str | PathLike[str], target: str | None = None) -> Model:
    """Rebuild the model of a file that `convert` wrote; names and numbers come from the file.

    Raises
    ------
    ModelError
        The file is not of the kind that `convert` writes, or the target has no reader.
    """
    found = target_of(path, target)
    if found.read is None:
        raise ModelError([f"{path}: a file for {found.name} holds no model, only its geometry"])
    try:
        return found.read(_text(read_bytes(Path(path), "the file")))
    except ModelError as error:
        raise ModelError(f"{path}: {problem}" for problem in error.problems) from None


def _text(contents: bytes) -> str:
    """A file of ours as text; raises `ModelError`."""
    try:
        return contents.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ModelError(
            [f"is not a file that drystone wrote (byte {error.start + 1} is not UTF-8)"]
        ) from None


__all__ = ["PROGRAMS", "Target", "convert", "read", "target_of", "targets"]
