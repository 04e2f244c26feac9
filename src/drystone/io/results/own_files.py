"""What the program itself has written into a folder of results, and how it goes."""

from __future__ import annotations

from collections.abc import Container, Iterator
from contextlib import suppress
from pathlib import Path

from drystone.io.results.checkpoint import CHECKPOINT, PLAN
from drystone.io.results.folder import FolderLock
from drystone.io.results.journal import journal_of
from drystone.io.results.names import PARAVIEW, RESULTS
from drystone.io.results.outputs import file_names
from drystone.io.results.paraview import remove_series
from drystone.io.results.senses import DIRECTION, OPPOSITE_FOLDER

#: What an assessment writes beside the results, and what says nothing of new ones.
ASSESSMENT = "assessment.json"
OF_ASSESSMENT = (ASSESSMENT, "adrs.svg", "adrs.png", "adrs.pdf")
#: What several directions have in common.
OF_DIRECTIONS = ("directions.csv", "directions.png")
#: Pages of the commands ``report`` and ``view``; a page of someone else has no such mark in it.
PAGES = ("report.html", "view.html")
MARK, WITHIN = b'name="generator" content="drystone', 4096


def clear(folder: Path, *, keep: Container[str] = ()) -> None:
    """Remove what runs, assessments, reports and viewers have left, folders of other senses and
    directions included.  Files of other names, and pages of someone else, stay.

    Parameters
    ----------
    keep
        Names of folders of directions that stay, emptied: others are about to write there.
    """
    for name in (CHECKPOINT, PLAN, RESULTS, journal_of(Path(RESULTS)).name):
        (folder / name).unlink(missing_ok=True)
    clear_derived(folder)
    for inner in list(_folders(folder)):
        clear(inner)
        if inner.name not in keep:
            _remove_empty(inner)
    _remove_empty(folder / PARAVIEW)


def _remove_empty(folder: Path) -> None:
    with suppress(OSError):  # of something else that is in it
        folder.rmdir()


def check_free(folder: Path) -> None:
    """Raise `OutputError` where a run of its own writes in a folder of a sense or a direction."""
    for inner in _folders(folder):
        FolderLock(inner).release()


def clear_derived(folder: Path) -> None:
    """Remove from a folder what is made of ``results.h5``, which goes on."""
    for name in (*file_names(), *OF_ASSESSMENT, *OF_DIRECTIONS):
        (folder / name).unlink(missing_ok=True)
    for name in PAGES:
        if _is_ours(folder / name):
            (folder / name).unlink()
    remove_series(folder / PARAVIEW)


def _folders(folder: Path) -> Iterator[Path]:
    """Folders of other senses and directions that hold results; not where links lead elsewhere."""
    for inner in (folder / OPPOSITE_FOLDER, *sorted(folder.glob(f"{DIRECTION}*"))):
        if inner.is_dir() and not inner.is_symlink():
            yield inner


def _is_ours(page: Path) -> bool:
    if not page.is_file():
        return False
    with page.open("rb") as file:
        return MARK in file.read(WITHIN)
